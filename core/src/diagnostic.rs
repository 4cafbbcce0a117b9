//! Findings: reasons why an evaluation is less trustworthy, with their places.

use crate::mesh::TriangleMesh;
use alloc::vec::Vec;

/// Something that makes an evaluation less trustworthy than usual, and where.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Finding {
    /// The area that the method gives to this vertex is zero: the vertex was left out.
    ZeroArea {
        /// The vertex.
        vertex: u32,
    },
    /// The signed area that the method gives to this vertex is negative, and was used unchanged.
    NegativeArea {
        /// The vertex.
        vertex: u32,
    },
    /// The neighbours of this vertex do not determine a fit of the requested degree; a lower degree
    /// was fitted.
    ReducedDegree {
        /// The vertex.
        vertex: u32,
        /// The degree that was fitted.
        degree: u8,
    },
    /// The neighbours of this vertex do not determine any fit: the vertex was left out.
    TooFewNeighbours {
        /// The vertex.
        vertex: u32,
    },
    /// The signed area that the method gives to this vertex is less than a thirty-second of the
    /// area of the triangles around it. Division by this area amplifies errors.
    SmallArea {
        /// The vertex.
        vertex: u32,
    },
    /// The signed area of this vertex is zero or negative, and was replaced by a mixed one.
    ClampedArea {
        /// The vertex.
        vertex: u32,
    },
    /// The neighbours of this vertex determine the fit badly, as those near a conic section through it
    /// determine a paraboloid: deviations of the neighbours from the fit are amplified.
    Amplified {
        /// The vertex.
        vertex: u32,
    },
    /// The polynomial fitted around this vertex is no graph over the triangles at the vertex, as where the
    /// surface is folded or a neck is thin. Points that it does not define lie on the flat triangles
    /// instead.
    NoGraph {
        /// The vertex.
        vertex: u32,
    },
    /// The patches at this vertex meet at an angle of more than 10⁻³, which vanishes on a mesh that
    /// resolves the surface: the energy and the nodal forces have large errors. Choose a finer mesh.
    Unresolved {
        /// The vertex.
        vertex: u32,
    },
    /// The vertices around this one lie in rows, which do not determine the fit of the requested degree, or
    /// hardly: curvatures and forces have errors of up to their own size. Divide the surface into triangles
    /// that are as long as they are wide.
    Rows {
        /// The vertex.
        vertex: u32,
    },
    /// The surface has a crease, a corner or a tip at this vertex: curvatures are not defined there, and fits that
    /// include it have none.
    Crease {
        /// The vertex.
        vertex: u32,
    },
    /// This vertex lies far off the surface of its neighbours: correct or remove it.
    Outlier {
        /// The vertex.
        vertex: u32,
    },
    /// The connected component of this vertex has so few vertices that nothing shows the error of a fit.
    SmallComponent {
        /// The vertex.
        vertex: u32,
    },
    /// The vertices lie on the edges of a grid, as marching cubes put them. A surface around the voxels of a mask has
    /// ripples as long as several cells, blurred or not, which cannot be told from the shape: error bars include
    /// the distance to fits over many vertices.
    Grid {
        /// The vertex.
        vertex: u32,
    },
    /// The longest edge at this vertex is more than eight times the shortest. For methods with a
    /// wider stencil: this holds at a vertex within two edges, or a triangle there is thin.
    /// Formulas that assume an even mesh have errors that grow with powers of this ratio.
    Uneven {
        /// The vertex.
        vertex: u32,
    },
    /// This vertex has fewer than four or more than nine neighbours: formulas that are exact for six
    /// have an error there that refinement does not reduce.
    UnusualValence {
        /// The vertex.
        vertex: u32,
    },
    /// A triangle at this vertex faces the opposite way to the others around it: the surface is
    /// folded.
    Folded {
        /// The vertex.
        vertex: u32,
    },
    /// The rounding of the stored position is too large for the distance to the neighbours: the
    /// error of a fourth derivative is of the order of 1/R³, R the radius of the sphere with the
    /// same area. Keep positions near the origin, or store them in pairs: see
    /// [`Surface::with_remainders`](crate::Surface::with_remainders).
    RoundedPosition {
        /// The vertex.
        vertex: u32,
    },
    /// The noise of the positions is too large for the distance to the neighbours of this vertex,
    /// see [`Noise`](crate::Noise): the error of a fourth derivative is of the order of 1/R³ or
    /// larger, R the radius of the sphere with the same area. Finer meshes with the same noise are
    /// worse.
    NoisyPosition {
        /// The vertex.
        vertex: u32,
    },
    /// The triangles around this vertex are so small that a fourth derivative, of the order of the
    /// mean curvature over their area, overflows. It is unknown and set to 0. For method D, squares of
    /// areas anywhere on the surface are no normal numbers. Choose a unit of length nearer to the size of
    /// the surface.
    OutOfRange {
        /// The vertex.
        vertex: u32,
    },
    /// This triangle is stretched so far that the energy or the forces of an in-plane law overflow
    /// (they are infinite or NaN), or that the forces have lost half of their digits.
    Overstretched {
        /// The triangle.
        triangle: u32,
    },
    /// This triangle has no area and contributes nothing.
    DegenerateTriangle {
        /// The triangle.
        triangle: u32,
    },
    /// The height of this triangle is less than a thirty-second of its longest edge (a needle below
    /// 1.8°, a cap above 176.4°). Division by its area amplifies errors.
    ThinTriangle {
        /// The triangle.
        triangle: u32,
    },
}

/// The findings of one evaluation, with a flag for each vertex that they concern.
///
/// A vertex is flagged if a finding concerns the vertex, one of its triangles or one of its
/// neighbours, because its force depends on the curvatures of the neighbours.
///
/// ```
/// use helfrich::{Finding, GompperKroll, Prepared, Surface, TriangleMesh};
///
/// let mesh = TriangleMesh::new(4, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// // Two vertices almost in one place.
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1e-4, 1e-4]];
/// let surface = Surface::new(&mesh, &points)?;
/// let mut bending = Prepared::new(GompperKroll::new(1.0), &mesh);
/// bending.add_force_and_energy(surface, &mut [[0.0; 3]; 4]);
///
/// let quality = bending.quality(surface);
/// let first = quality.findings()[0];
/// assert_eq!(Finding::KINDS[first.bit().ilog2() as usize], "thin_triangle");
/// assert_eq!(quality.flags()[0] & first.bit(), first.bit());
/// assert!(quality.flagged()[0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quality {
    findings: Vec<Finding>,
    flagged: Vec<bool>,
    flags: Vec<u32>,
}

impl Quality {
    /// Gathers the findings that `inspect` reports of an evaluation on `mesh`.
    ///
    /// # Panics
    /// If a finding names a vertex or triangle that the mesh does not have.
    pub fn gather(mesh: &TriangleMesh, inspect: impl FnOnce(&mut dyn FnMut(Finding))) -> Self {
        let mut findings = Vec::new();
        inspect(&mut |finding| findings.push(finding));
        let mut flags = alloc::vec![0; mesh.vertex_count()];
        let mut flag = |vertex: u32, bit: u32| {
            flags[vertex as usize] |= bit;
            for &neighbour in mesh.one_ring(vertex as usize) {
                flags[neighbour as usize] |= bit;
            }
        };
        for finding in &findings {
            let bit = finding.bit();
            match finding.place() {
                FindingPlace::Vertex(vertex) => flag(vertex, bit),
                FindingPlace::Triangle(triangle) => {
                    let corners = mesh.triangles()[triangle as usize];
                    corners.into_iter().for_each(|corner| flag(corner, bit));
                }
            }
        }
        Self {
            findings,
            flagged: flags.iter().map(|&bits| bits != 0).collect(),
            flags,
        }
    }

    /// The findings, in the order in which the method reports them.
    pub fn findings(&self) -> &[Finding] {
        &self.findings
    }

    /// Whether each vertex is concerned.
    pub fn flagged(&self) -> &[bool] {
        &self.flagged
    }

    /// The kinds of findings that concern each vertex, as the sum of their bits: see [`Finding::bit`].
    pub fn flags(&self) -> &[u32] {
        &self.flags
    }
}

/// The place of a finding.
enum FindingPlace {
    Vertex(u32),
    Triangle(u32),
}

impl Finding {
    /// The names of the kinds of findings, in the order of their bits.
    pub const KINDS: [&'static str; 23] = [
        "zero_area",
        "negative_area",
        "reduced_degree",
        "too_few_neighbours",
        "small_area",
        "clamped_area",
        "amplified",
        "uneven",
        "unusual_valence",
        "folded",
        "rounded_position",
        "noisy_position",
        "out_of_range",
        "overstretched",
        "degenerate_triangle",
        "thin_triangle",
        "no_graph",
        "unresolved",
        "rows",
        "crease",
        "outlier",
        "small_component",
        "grid",
    ];

    /// The bit of the kind of finding, 1 for the first of [`Self::KINDS`].
    pub const fn bit(self) -> u32 {
        let kind = match self {
            Self::ZeroArea { .. } => 0,
            Self::NegativeArea { .. } => 1,
            Self::ReducedDegree { .. } => 2,
            Self::TooFewNeighbours { .. } => 3,
            Self::SmallArea { .. } => 4,
            Self::ClampedArea { .. } => 5,
            Self::Amplified { .. } => 6,
            Self::Uneven { .. } => 7,
            Self::UnusualValence { .. } => 8,
            Self::Folded { .. } => 9,
            Self::RoundedPosition { .. } => 10,
            Self::NoisyPosition { .. } => 11,
            Self::OutOfRange { .. } => 12,
            Self::Overstretched { .. } => 13,
            Self::DegenerateTriangle { .. } => 14,
            Self::ThinTriangle { .. } => 15,
            Self::NoGraph { .. } => 16,
            Self::Unresolved { .. } => 17,
            Self::Rows { .. } => 18,
            Self::Crease { .. } => 19,
            Self::Outlier { .. } => 20,
            Self::SmallComponent { .. } => 21,
            Self::Grid { .. } => 22,
        };
        1 << kind
    }

    fn place(self) -> FindingPlace {
        match self {
            Self::ZeroArea { vertex }
            | Self::NegativeArea { vertex }
            | Self::SmallArea { vertex }
            | Self::ClampedArea { vertex }
            | Self::ReducedDegree { vertex, .. }
            | Self::TooFewNeighbours { vertex }
            | Self::Amplified { vertex }
            | Self::NoGraph { vertex }
            | Self::Unresolved { vertex }
            | Self::Rows { vertex }
            | Self::Crease { vertex }
            | Self::Outlier { vertex }
            | Self::SmallComponent { vertex }
            | Self::Grid { vertex }
            | Self::Uneven { vertex }
            | Self::UnusualValence { vertex }
            | Self::Folded { vertex }
            | Self::OutOfRange { vertex }
            | Self::RoundedPosition { vertex }
            | Self::NoisyPosition { vertex } => FindingPlace::Vertex(vertex),
            Self::DegenerateTriangle { triangle }
            | Self::Overstretched { triangle }
            | Self::ThinTriangle { triangle } => FindingPlace::Triangle(triangle),
        }
    }
}
