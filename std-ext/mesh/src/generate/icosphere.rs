//! The unit sphere, as an icosahedron refined by edge midpoints or by Loop's rules.

use super::Draft;
use glam::{DQuat, DVec3};
use helfrich::subdivision::{Subdivision, limit_positions};
use helfrich::{MeshError, Serial, TriangleMesh};
use std::f64::consts::TAU;

/// Number of vertices of the icosahedron.
pub(super) const LEAST_VERTICES: usize = 12;

/// The refinement level with this many vertices, 10·4^level + 2, if there is one.
pub(super) fn level(vertices: usize) -> Option<u32> {
    let count = |level: u32| 10 * (1usize << (2 * level)) + 2;
    let mut levels = (0..).take_while(|&level| count(level) <= vertices);
    levels.find(|&level| count(level) == vertices)
}

/// The icosahedron refined `level` times.
pub(super) fn icosphere(level: u32) -> Draft {
    let mut draft = icosahedron();
    for _ in 0..level {
        draft = refine(&draft, midpoint);
    }
    draft
}

/// The icosahedron refined `level` times by Loop's rules, with limit positions projected onto the sphere.
pub(super) fn smooth(level: u32) -> Result<Draft, MeshError> {
    let coarse = icosahedron();
    let mut controls = Vec::from_iter(coarse.preimages.iter().map(DVec3::to_array));
    let mut mesh = TriangleMesh::new(controls.len(), coarse.triangles)?;
    for _ in 0..level {
        let fine = Subdivision::new(&mesh, 1)?;
        controls = fine.refine(&controls);
        mesh = fine.into_mesh();
    }
    let mut limit = vec![[0.0; 3]; controls.len()];
    limit_positions(&mesh).apply(&Serial, &controls, &mut limit);
    let on_sphere = |point: &[f64; 3]| DVec3::from(*point).normalize();
    Ok(Draft {
        preimages: limit.iter().map(on_sphere).collect(),
        triangles: mesh.triangles().to_vec(),
    })
}

/// The middle of the arc between two points of the unit sphere.
pub(super) fn midpoint(a: DVec3, b: DVec3) -> DVec3 {
    (a + b).normalize()
}

/// Divides each triangle of a closed mesh into four by the midpoints of its edges.
///
/// The vertices keep their numbers; the midpoints follow, sorted by the ends of their edges.
pub(super) fn refine(draft: &Draft, midpoint: impl Fn(DVec3, DVec3) -> DVec3) -> Draft {
    let mut half_edges = Vec::with_capacity(3 * draft.triangles.len());
    for (t, triangle) in draft.triangles.iter().enumerate() {
        for corner in 0..3 {
            let (a, b) = (triangle[corner], triangle[(corner + 1) % 3]);
            half_edges.push((a.min(b), a.max(b), (3 * t + corner) as u32));
        }
    }
    half_edges.sort_unstable();

    let mut preimages = draft.preimages.clone();
    let mut midpoints = vec![[0u32; 3]; draft.triangles.len()];
    // After sorting, the two sides of an edge in a closed mesh are adjacent.
    for sides in half_edges.chunks_exact(2) {
        let (a, b, _) = sides[0];
        let added = preimages.len() as u32;
        preimages.push(midpoint(preimages[a as usize], preimages[b as usize]));
        for &(_, _, corner) in sides {
            midpoints[corner as usize / 3][corner as usize % 3] = added;
        }
    }
    let quarters = |(&[a, b, c], &[ab, bc, ca]): (&[u32; 3], &[u32; 3])| {
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    let parents = draft.triangles.iter().zip(&midpoints);
    Draft {
        preimages,
        triangles: parents.flat_map(quarters).collect(),
    }
}

/// Points on a spiral with equal areas, each rotated by the golden angle against the previous one.
pub(super) fn spiral(vertices: usize) -> Vec<DVec3> {
    let rotation = generic_rotation();
    let golden = TAU * (2.0 - (1.0 + 5f64.sqrt()) / 2.0);
    let point = |index: usize| {
        let z = 1.0 - (2 * index + 1) as f64 / vertices as f64;
        let (sin, cos) = libm::sincos(golden * index as f64);
        let across = ((1.0 - z) * (1.0 + z)).sqrt();
        (rotation * DVec3::new(across * cos, across * sin, z)).normalize()
    };
    Vec::from_iter((0..vertices).map(point))
}

/// Rotation without symmetry, because errors vanish on symmetric meshes that do not vanish on others.
fn generic_rotation() -> DQuat {
    DQuat::from_xyzw(0.35, -0.27, 0.41, 0.8).normalize()
}

/// The icosahedron in a generic rotation, with no vertex on a coordinate axis and no coordinate axis in a
/// mirror plane.
fn icosahedron() -> Draft {
    let rotation = generic_rotation();
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let rectangle = [
        (-1.0, golden),
        (1.0, golden),
        (-1.0, -golden),
        (1.0, -golden),
    ];
    let mut preimages = Vec::with_capacity(LEAST_VERTICES);
    for axis in 0..3 {
        for (short, long) in rectangle {
            let mut vertex = [0.0; 3];
            vertex[axis] = short;
            vertex[(axis + 1) % 3] = long;
            preimages.push((rotation * DVec3::from(vertex)).normalize());
        }
    }
    Draft {
        preimages,
        triangles: ICOSAHEDRON.to_vec(),
    }
}

/// Vertices 0 … 3 lie in the xy plane, 4 … 7 in yz, 8 … 11 in zx, each group in the order of
/// (short, long) = (−, +), (+, +), (−, −), (+, −).
const ICOSAHEDRON: [[u32; 3]; 20] = [
    [0, 5, 1],
    [0, 1, 7],
    [0, 11, 5],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [1, 8, 7],
    [1, 9, 8],
    [2, 3, 4],
    [2, 6, 3],
    [2, 4, 11],
    [2, 10, 6],
    [2, 11, 10],
    [3, 9, 4],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [4, 5, 11],
    [6, 7, 8],
    [6, 10, 7],
];

#[cfg(test)]
mod tests {
    use super::{icosahedron, level};

    #[test]
    fn levels() {
        assert_eq!(level(12), Some(0));
        assert_eq!(level(163842), Some(7));
        assert_eq!(level(700), None);
    }

    /// The icosahedron's mirror planes are those across its edges' midpoints.
    #[test]
    fn rotation_is_generic() {
        let draft = icosahedron();
        for vertex in &draft.preimages {
            assert!(vertex.abs().max_element() < 0.99);
        }
        for [a, b, _] in draft.triangles {
            let middle = draft.preimages[a as usize] + draft.preimages[b as usize];
            assert!(middle.normalize().abs().min_element() > 0.02);
        }
    }
}
