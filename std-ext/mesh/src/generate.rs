//! Families of meshes on every exact shape, seeded and reproducible.
//!
//! A mesh depends only on its shape, family, number of vertices and seed: not on the machine, the
//! number of threads, or elementary functions of the platform.

mod any_shape;
mod carlson;
mod delaunay;
mod deviation;
mod hard;
mod icosphere;
mod irregular;
mod lattice;
pub mod random;
mod relaxed;

pub use any_shape::{AnyShape, ParseShapeError};
pub use deviation::ShapeDeviation;

use glam::DVec3;
use helfrich::shapes::{ExactPoint, Shape, Sphere};
use helfrich::{MeshError, TriangleMesh};
use std::fmt;
use std::str::FromStr;

/// The distribution of the vertices of a mesh over a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Family {
    /// An icosahedron refined by edge midpoints, in a generic rotation, mapped to the shape; on the
    /// torus a triangular lattice of its two angles. Independent of the seed.
    ///
    /// If the number of vertices is not 10·4^k + 2, sphere-like meshes of this family, of
    /// [`Smooth`](Self::Smooth) and of [`Hard`](Self::Hard) start with 12 to 44 points on a spiral
    /// instead of the icosahedron, have up to three more edges cut in each refinement, and are relaxed
    /// on the sphere: instead of a dozen vertices of valence 5 they have some dozens of valence 5 and
    /// 7.
    Regular,
    /// An icosahedron refined by Loop's rules, in a generic rotation: its limit positions are projected
    /// onto the sphere and mapped to the shape. It has the connectivity of the regular mesh, without
    /// the kinks that edge midpoints leave along the edges of the icosahedron; on the torus it is the
    /// regular mesh. Independent of the seed.
    Smooth,
    /// The regular mesh with its edges as springs, relaxed along the surface: edges become even and, on
    /// the torus, where each row keeps its number of vertices, triangles more equilateral. Springs are
    /// stiffer where the normals at the ends of an edge differ strongly, so that tips and rims keep their
    /// vertices. Independent of the seed.
    Relaxed,
    /// Well-spaced random points and their Delaunay triangulation: from 2562 vertices on, valences
    /// from 3 or 4 up to 9 or more, about 12, and some angles below 12°.
    Irregular,
    /// The regular mesh with every vertex displaced by up to 30 % of an edge, 1 % of them almost onto a
    /// neighbour (needles) and 1 % almost onto an edge (caps): angles from 0.7° to 176°. On coarse
    /// meshes, whose triangles are bent, there are fewer needles and caps.
    Hard,
}

impl Family {
    /// All families.
    pub const ALL: [Self; 5] = [
        Self::Regular,
        Self::Smooth,
        Self::Relaxed,
        Self::Irregular,
        Self::Hard,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Regular => "regular",
            Self::Smooth => "smooth",
            Self::Relaxed => "relaxed",
            Self::Irregular => "irregular",
            Self::Hard => "hard",
        }
    }
}

impl fmt::Display for Family {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

/// An unknown name of a family.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no mesh family `{name}`: choose regular, smooth, relaxed, irregular or hard")]
pub struct ParseFamilyError {
    /// The name.
    pub name: String,
}

impl FromStr for Family {
    type Err = ParseFamilyError;

    fn from_str(name: &str) -> Result<Self, ParseFamilyError> {
        let found = Self::ALL.into_iter().find(|family| family.name() == name);
        found.ok_or_else(|| ParseFamilyError { name: name.into() })
    }
}

/// Closed mesh, oriented outward, inscribed in an exact shape.
#[derive(Clone, Debug)]
pub struct GeneratedMesh {
    /// The connectivity.
    pub mesh: TriangleMesh,
    /// The vertices: exactly `shape.position(preimage)`.
    pub positions: Vec<[f64; 3]>,
    /// The vertices' pre-images, at which the shape gives the exact curvatures.
    pub preimages: Vec<[f64; 3]>,
    /// The shape on which the vertices lie.
    pub shape: AnyShape,
}

/// Reason why a mesh cannot be generated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// Fewer or more vertices than can be meshed.
    #[error(
        "{asked} vertices on the {shape} are out of range: between {least} and {most} are needed"
    )]
    OutOfRange {
        /// The shape's name.
        shape: &'static str,
        /// The requested number of vertices.
        asked: usize,
        /// The smallest number allowed.
        least: usize,
        /// The largest number allowed.
        most: usize,
    },
    /// The points are too few to resolve the shape of the surface.
    #[error("{vertices} vertices are too few for a mesh on the {shape}: {source}")]
    TooCoarse {
        /// The shape's name.
        shape: &'static str,
        /// The number of vertices placed.
        vertices: usize,
        /// The problem of the mesh.
        source: MeshError,
    },
    /// Coordinates that are not finite, or too large or small to be triangulated.
    #[error("the {shape}'s proportions are too extreme for its points to be triangulated in f64")]
    TooExtreme {
        /// The shape's name.
        shape: &'static str,
    },
    /// Exact values that are not finite.
    #[error(
        "exact values of {shape} are beyond the numbers of f64, such as those of 1/length³: choose another unit of \
         length"
    )]
    BeyondNumbers {
        /// The shape, with its parameters.
        shape: AnyShape,
    },
}

impl GeneratedMesh {
    /// The exact values at the vertices.
    ///
    /// # Errors
    /// If one of them is not finite, [`GenerateError::BeyondNumbers`].
    pub fn exact_points(&self) -> Result<Vec<ExactPoint<f64>>, GenerateError> {
        let shape = self.shape;
        let points = Vec::from_iter(self.preimages.iter().map(|&at| shape.at(at)));
        let values = |at: &ExactPoint<f64>| [at.mean, at.gaussian, at.force_density(1.0)];
        let mut values = points.iter().flat_map(values);
        let sizes = [shape.area(), shape.volume()];
        if values.all(f64::is_finite) && sizes.into_iter().all(f64::is_finite) {
            return Ok(points);
        }
        Err(GenerateError::BeyondNumbers { shape })
    }
}

/// The largest number of vertices of a mesh: a closed mesh has about twice as many triangles.
const MOST_VERTICES: usize = TriangleMesh::LIMIT / 2 - 4;

/// Generates the mesh of a family on a shape.
///
/// Sphere-like meshes have exactly this number of vertices, 12 or more; if it is 10·4^k + 2, they are
/// refined icosahedra. Meshes of the torus, except for [`Family::Irregular`], are lattices, whose number of
/// vertices is within 1 % of the requested one from 200 vertices on; [`GeneratedMesh::mesh`] has the number.
///
/// # Errors
/// If there is no mesh of that many vertices; see [`GenerateError`].
pub fn generate(
    shape: &AnyShape,
    family: Family,
    vertices: usize,
    seed: u64,
) -> Result<GeneratedMesh, GenerateError> {
    check(shape, vertices)?;
    let draft = match (family, shape) {
        (Family::Irregular, _) => irregular::scatter(shape, vertices, seed)?,
        (Family::Relaxed, AnyShape::Torus(torus)) => relaxed::lattice(torus, vertices),
        (_, AnyShape::Torus(torus)) => {
            let size = lattice::Size::nearest(torus, vertices);
            let [rows, columns] = [size.rows, size.columns].map(|count| count << size.level);
            lattice::lattice(torus, rows, columns)
        }
        _ => match (icosphere::level(vertices), family) {
            (Some(level), Family::Relaxed) => relaxed::icosphere(shape, level),
            (Some(level), Family::Smooth) => {
                icosphere::smooth(level).map_err(|source| GenerateError::TooCoarse {
                    shape: shape.name(),
                    vertices,
                    source,
                })?
            }
            (Some(level), _) => icosphere::icosphere(level),
            (None, Family::Relaxed) => relaxed::of_count(shape, vertices)?,
            (None, _) => relaxed::of_count(&UNIT_SPHERE, vertices)?,
        },
    };
    if family == Family::Hard {
        return hard::disturb(draft.finish(shape)?, seed);
    }
    draft.finish(shape)
}

/// Checks whether a mesh can have this number of vertices, without making the mesh.
///
/// # Errors
/// If there is no mesh of that many vertices; see [`GenerateError`].
pub fn check(shape: &AnyShape, vertices: usize) -> Result<(), GenerateError> {
    let torus = matches!(shape, AnyShape::Torus(_));
    let least = if torus {
        lattice::LEAST_VERTICES
    } else {
        icosphere::LEAST_VERTICES
    };
    if !(least..=MOST_VERTICES).contains(&vertices) {
        return Err(GenerateError::OutOfRange {
            shape: shape.name(),
            asked: vertices,
            least,
            most: MOST_VERTICES,
        });
    }
    Ok(())
}

/// Unit sphere, the pre-images of sphere-like shapes.
const UNIT_SPHERE: AnyShape = AnyShape::Sphere(Sphere { radius: 1.0 });

/// A mesh under construction: pre-images, and unchecked triangles.
struct Draft {
    preimages: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Draft {
    fn finish(self, shape: &AnyShape) -> Result<GeneratedMesh, GenerateError> {
        let vertices = self.preimages.len();
        let mesh = TriangleMesh::new(vertices, self.triangles).map_err(|source| {
            GenerateError::TooCoarse {
                shape: shape.name(),
                vertices,
                source,
            }
        })?;
        let preimages = Vec::from_iter(self.preimages.iter().map(DVec3::to_array));
        let positions = preimages.iter().map(|&p| shape.position(p)).collect();
        Ok(GeneratedMesh {
            mesh,
            positions,
            preimages,
            shape: *shape,
        })
    }
}

/// The position of a pre-image, as a vector.
fn position(shape: &impl Shape<f64>, preimage: DVec3) -> DVec3 {
    shape.position(preimage.to_array()).into()
}

/// The pre-image of a point near the surface, as a vector.
fn preimage(shape: &impl Shape<f64>, position: DVec3) -> DVec3 {
    shape.preimage(position.to_array()).into()
}
