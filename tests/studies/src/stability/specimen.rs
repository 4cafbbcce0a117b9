//! Surfaces of the hard cases.

use glam::DVec3;
use helfrich::TriangleMesh;
use helfrich::shapes::{Discocyte, ExactPoint, Shape};
use helfrich_std::generate::random::Random;
use helfrich_std::generate::{AnyShape, Family, GenerateError, GeneratedMesh, generate};
use helfrich_std::io::MeshFile;
use helfrich_std::subdivide::{Target, subdivide};
use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Number of vertices of a specimen, unless its case is about this number.
const VERTICES: usize = 642;

/// Distance between disturbed vertices or triangles, in their numbering.
const STRIDE: usize = 50;

/// A surface of size about 1, and its exact values.
#[derive(Clone, Debug)]
pub(super) struct Specimen {
    pub(super) mesh: TriangleMesh,
    pub(super) positions: Vec<[f64; 3]>,
    /// Exact surface at each vertex; empty if it is not known.
    pub(super) exact: Vec<ExactPoint<f64>>,
    /// Factor applied to positions before the evaluation.
    pub(super) scale: f64,
    /// Offset added to each coordinate before scaling, in units of the scale.
    pub(super) offset: f64,
}

/// The reason why a specimen cannot be made.
#[derive(Debug, thiserror::Error)]
pub(super) enum SpecimenError {
    #[error(transparent)]
    Generate(#[from] GenerateError),
    #[error(transparent)]
    Mesh(#[from] helfrich::MeshError),
    #[error(transparent)]
    Subdivide(#[from] helfrich_std::subdivide::SubdivideError),
    #[error(transparent)]
    Shape(#[from] helfrich::shapes::ShapeError),
}

type Made = Result<Specimen, SpecimenError>;

impl Specimen {
    /// A specimen with vertices on an exact shape.
    fn on(shape: &AnyShape, mesh: TriangleMesh, preimages: &[DVec3]) -> Self {
        let exact = preimages.iter().map(|p| shape.at(p.to_array()));
        let exact = Vec::from_iter(exact);
        Self {
            positions: exact.iter().map(|point| point.position).collect(),
            exact,
            ..Self::unknown(mesh, Vec::new())
        }
    }

    /// A specimen without exact values.
    fn unknown(mesh: TriangleMesh, positions: Vec<[f64; 3]>) -> Self {
        Self {
            mesh,
            positions,
            exact: Vec::new(),
            scale: 1.0,
            offset: 0.0,
        }
    }

    pub(super) fn scaled(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    pub(super) fn moved(self, offset: f64) -> Self {
        Self { offset, ..self }
    }
}

/// A shape with a mesh and the preimages of its vertices.
type Base = (AnyShape, TriangleMesh, Vec<DVec3>);

/// The surface that most cases disturb: smooth, with three different axes and a mesh without symmetry.
fn base() -> Result<Base, SpecimenError> {
    static MADE: OnceLock<Base> = OnceLock::new();
    if let Some(base) = MADE.get() {
        return Ok(base.clone());
    }
    let shape = AnyShape::Ellipsoid(helfrich::shapes::Ellipsoid::new([1.0, 0.8, 0.6])?);
    let GeneratedMesh {
        mesh, preimages, ..
    } = generate(&shape, Family::Relaxed, VERTICES, 1)?;
    let preimages = preimages.into_iter().map(DVec3::from).collect();
    let base = (shape, mesh, preimages);
    Ok(MADE.get_or_init(|| base).clone())
}

/// Well-spaced random points on the shape of the base.
pub(super) fn irregular() -> Made {
    let (shape, ..) = base()?;
    let GeneratedMesh {
        mesh, preimages, ..
    } = generate(&shape, Family::Irregular, VERTICES, 1)?;
    let preimages = Vec::from_iter(preimages.into_iter().map(DVec3::from));
    Ok(Specimen::on(&shape, mesh, &preimages))
}

/// The undisturbed base.
pub(super) fn clean() -> Made {
    let (shape, mesh, preimages) = base()?;
    Ok(Specimen::on(&shape, mesh, &preimages))
}

/// The base with about one vertex in fifty moved along an edge, until its distance from the neighbour is this
/// fraction of the edge. Each moved vertex makes two needles.
pub(super) fn needles(part: f64) -> Made {
    let (shape, mesh, mut preimages) = base()?;
    for vertex in apart(&mesh) {
        let onto = preimages[mesh.one_ring(vertex)[0] as usize];
        let moved = onto + part * (preimages[vertex] - onto);
        // Exactly at the neighbour, not only up to rounding.
        preimages[vertex] = if part == 0.0 { onto } else { moved.normalize() };
    }
    Ok(Specimen::on(&shape, mesh, &preimages))
}

/// The base with three vertices in one triangle of fifty, so close together that the surface is flat there: a
/// cap of 179.98°, and needles around it.
pub(super) fn caps() -> Made {
    let (shape, mesh, mut preimages) = base()?;
    let mut triangles = mesh.triangles().to_vec();
    for triangle in (0..mesh.triangles().len()).step_by(STRIDE) {
        let [a, b, c] = mesh.triangles()[triangle];
        let [from, to, top] = [a, b, c].map(|v| preimages[v as usize]);
        let centre = (from + to + top) / 3.0;
        // Half of the cap's base, so short that the arc over it rises by less than the height of the cap.
        let along = (to - from).normalize() * 1e-4;
        let up = (top - centre).reject_from(along).normalize() * 1.75e-8;
        let first = preimages.len() as u32;
        let [left, right, middle] = [first, first + 1, first + 2];
        for point in [centre - along, centre + along, centre + up] {
            preimages.push(point.normalize());
        }
        triangles[triangle] = [left, right, middle];
        triangles.extend([
            [a, b, right],
            [a, right, left],
            [b, c, right],
            [c, a, left],
            [c, left, middle],
            [c, middle, right],
        ]);
    }
    let mesh = TriangleMesh::new(preimages.len(), triangles)?;
    Ok(Specimen::on(&shape, mesh, &preimages))
}

/// The base with every second neighbour of about one vertex in fifty pulled close to it, so that all
/// triangles around the vertex are obtuse at a neighbour and its Voronoi area is negative.
pub(super) fn obtuse_fans() -> Made {
    let (shape, mesh, mut preimages) = base()?;
    for vertex in apart(&mesh) {
        let centre = preimages[vertex];
        for &neighbour in mesh.one_ring(vertex).iter().step_by(2) {
            let moved = centre + 0.1 * (preimages[neighbour as usize] - centre);
            preimages[neighbour as usize] = moved.normalize();
        }
    }
    Ok(Specimen::on(&shape, mesh, &preimages))
}

/// About every fiftieth vertex, with valence 6 and without common neighbours.
fn apart(mesh: &TriangleMesh) -> Vec<usize> {
    let mut taken = vec![false; mesh.vertex_count()];
    let mut chosen = Vec::new();
    for vertex in (0..mesh.vertex_count()).step_by(7) {
        let ring = mesh.one_ring(vertex);
        let around = |v: u32| mesh.one_ring(v as usize).iter();
        let near = Vec::from_iter(ring.iter().flat_map(|&v| around(v)).copied());
        if ring.len() == 6
            && chosen.len() < VERTICES / STRIDE
            && near.iter().all(|&v| !taken[v as usize])
        {
            chosen.push(vertex);
            near.into_iter().for_each(|v| taken[v as usize] = true);
        }
    }
    chosen
}

/// Circles of latitude between two poles of valence 20, with a vertex of valence 3 in one triangle of seven.
pub(super) fn valences() -> Made {
    const AROUND: u32 = 20;
    const CIRCLES: u32 = 19;
    let (shape, ..) = base()?;
    let mut preimages = vec![DVec3::Z];
    for circle in 1..=CIRCLES {
        let (sine, cosine) = libm::sincos(PI * f64::from(circle) / f64::from(CIRCLES + 1));
        for step in 0..AROUND {
            // Each circle is rotated by half a step against the previous one.
            let turn = 2.0 * (f64::from(step) + 0.5 * f64::from(circle)) / f64::from(AROUND);
            let (v, u) = libm::sincos(PI * turn);
            preimages.push(DVec3::new(sine * u, sine * v, cosine));
        }
    }
    preimages.push(-DVec3::Z);
    let last = preimages.len() as u32 - 1;
    let number = |circle: u32, step: u32| 1 + (circle - 1) * AROUND + step % AROUND;
    let mut triangles = Vec::new();
    for step in 0..AROUND {
        triangles.push([0, number(1, step), number(1, step + 1)]);
        for circle in 1..CIRCLES {
            let [a, b] = [step, step + 1].map(|step| number(circle, step));
            let [c, d] = [step, step + 1].map(|step| number(circle + 1, step));
            triangles.extend([[a, c, b], [b, c, d]]);
        }
        triangles.push([number(CIRCLES, step + 1), number(CIRCLES, step), last]);
    }
    for triangle in (0..triangles.len()).step_by(7) {
        let [a, b, c] = triangles[triangle];
        let sum: DVec3 = [a, b, c].map(|v| preimages[v as usize]).into_iter().sum();
        let middle = preimages.len() as u32;
        preimages.push(sum.normalize());
        triangles[triangle] = [a, b, middle];
        triangles.extend([[b, c, middle], [c, a, middle]]);
    }
    let mesh = TriangleMesh::new(preimages.len(), triangles)?;
    Ok(Specimen::on(&shape, mesh, &preimages))
}

/// The regular tetrahedron.
pub(super) fn four_vertices() -> Made {
    let positions = [
        [1.0; 3],
        [1.0, -1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
    ];
    let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    Ok(Specimen::unknown(
        TriangleMesh::new(4, triangles)?,
        positions.to_vec(),
    ))
}

/// A torus with approximately this number of vertices.
pub(super) fn torus(vertices: usize) -> Made {
    let shape = AnyShape::Torus(helfrich::shapes::Torus::new(2.0, 1.0)?);
    let GeneratedMesh {
        mesh, preimages, ..
    } = generate(&shape, Family::Regular, vertices, 1)?;
    let preimages = Vec::from_iter(preimages.into_iter().map(DVec3::from));
    Ok(Specimen::on(&shape, mesh, &preimages))
}

/// The disc of Evans and Fung with the thickness C0 at its centre, in radii.
pub(super) fn disc(thickness: f64) -> Made {
    let coefficients = [thickness, 2.002558, -1.122762];
    let shape = AnyShape::Discocyte(Discocyte::with_coefficients(1.0, coefficients)?);
    let GeneratedMesh {
        mesh, preimages, ..
    } = generate(&shape, Family::Relaxed, VERTICES, 1)?;
    let preimages = Vec::from_iter(preimages.into_iter().map(DVec3::from));
    Ok(Specimen::on(&shape, mesh, &preimages))
}

/// A drop with a cusp at its tip: the radius falls as the distance to the power of 3/2.
pub(super) fn cusp() -> Made {
    let (_, mesh, preimages) = base()?;
    let axis = preimages[0];
    let position = |p: &DVec3| {
        let height = p.dot(axis);
        let outward = *p - height * axis;
        (height * axis + 0.5 * (1.0 - height) * outward).to_array()
    };
    let positions = preimages.iter().map(position).collect();
    Ok(Specimen::unknown(mesh, positions))
}

/// A plate with this many holes, rounded by Loop subdivision.
pub(super) fn plate(holes: usize) -> Made {
    let (columns, rows) = (2 * holes as i32 + 1, 3);
    let solid = |[x, y, z]: [i32; 3]| {
        let inside = (0..columns).contains(&x) && (0..rows).contains(&y) && z == 0;
        inside && !(x % 2 == 1 && y == 1)
    };
    let mut numbers = HashMap::new();
    let mut positions = Vec::new();
    let mut number = |corner: [i32; 3]| {
        *numbers.entry(corner).or_insert_with(|| {
            positions.push(corner.map(|x| 0.3 * f64::from(x)));
            positions.len() as u32 - 1
        })
    };
    let mut triangles = Vec::new();
    for (x, y) in (0..columns).flat_map(|x| (0..rows).map(move |y| (x, y))) {
        let cell = [x, y, 0];
        if !solid(cell) {
            continue;
        }
        for axis in 0..3 {
            for side in [0, 1] {
                let mut beside = cell;
                beside[axis] += 2 * side - 1;
                if solid(beside) {
                    continue;
                }
                let corner = |u: i32, v: i32| {
                    let mut corner = cell;
                    corner[axis] += side;
                    corner[(axis + 1) % 3] += u;
                    corner[(axis + 2) % 3] += v;
                    corner
                };
                let mut quad = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[u, v]| number(corner(u, v)));
                if side == 0 {
                    quad.reverse();
                }
                let [a, b, c, d] = quad;
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    let mesh = TriangleMesh::new(positions.len(), triangles)?;
    let file = MeshFile::new(positions, mesh);
    let MeshFile {
        positions, mesh, ..
    } = subdivide(file, 2, Target::Limit)?;
    Ok(Specimen::unknown(mesh, positions))
}

/// The base with every vertex displaced at random by up to this many edge lengths.
pub(super) fn crumpled(amplitude: f64) -> Made {
    let specimen = clean()?;
    let edge = (4.0 * PI / VERTICES as f64).sqrt();
    let mut random = Random::new(7);
    let displaced = |x: &[f64; 3]| x.map(|x| x + amplitude * edge * (2.0 * random.unit() - 1.0));
    let positions = specimen.positions.iter().map(displaced).collect();
    Ok(Specimen::unknown(specimen.mesh, positions))
}

/// The base with a random error in every coordinate, whose standard deviation is this many mean edge lengths:
/// the sum of twelve uniform numbers.
pub(super) fn noisy(deviation: f64) -> Made {
    let specimen = clean()?;
    let edges = specimen.mesh.edges();
    let length = |&[a, b]: &[u32; 2]| {
        let [a, b] = [a, b].map(|vertex| DVec3::from(specimen.positions[vertex as usize]));
        a.distance(b)
    };
    let edge = edges.iter().map(length).sum::<f64>() / edges.len() as f64;
    let mut random = Random::new(7);
    let mut error = || (0..12).map(|_| random.unit()).sum::<f64>() - 6.0;
    let displaced = |x: &[f64; 3]| x.map(|x| x + deviation * edge * error());
    let positions = specimen.positions.iter().map(displaced).collect();
    Ok(Specimen {
        positions,
        ..specimen
    })
}
