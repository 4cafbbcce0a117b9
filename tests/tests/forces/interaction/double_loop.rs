//! Energy and forces of a repulsion by a double loop over all pairs.

use super::{Positions, law_with};
use helfrich::{Images, Repulsion, Surface, VertexKind};
use helfrich_tests::meshes::{Mesh, cross, difference, dot, norm, unit};

/// Vector to x from the nearest point of the convex hull of up to three points.
pub(super) fn apart(x: [f64; 3], hull: &[[f64; 3]]) -> [f64; 3] {
    let point = |a: [f64; 3]| difference(x, a);
    let along = |a: [f64; 3], b: [f64; 3]| {
        let edge = difference(b, a);
        let t = (dot(point(a), edge) / dot(edge, edge)).clamp(0.0, 1.0);
        [0, 1, 2].map(|k| x[k] - a[k] - t * edge[k])
    };
    match *hull {
        [a] => point(a),
        [a, b] => along(a, b),
        [a, b, c] => {
            let normal = cross(difference(b, a), difference(c, a));
            let sides = [[a, b], [b, c], [c, a]];
            let inside =
                |[a, b]: [[f64; 3]; 2]| dot(cross(difference(b, a), point(a)), normal) > 0.0;
            if sides.into_iter().all(inside) {
                let height = dot(point(a), normal) / dot(normal, normal);
                return normal.map(|n| height * n);
            }
            let feet = sides.map(|[a, b]| along(a, b));
            let nearer = |a: &&[f64; 3], b: &&[f64; 3]| norm(**a).total_cmp(&norm(**b));
            *feet.iter().min_by(nearer).unwrap()
        }
        _ => panic!("{} corners", hull.len()),
    }
}

/// Triangles and interior vertices with the sign +1, interior edges with −1, by inclusion and exclusion.
fn simplices(mesh: &Mesh) -> Vec<(f64, Vec<usize>)> {
    let mesh = &mesh.connectivity;
    let corners = |corners: &[u32]| Vec::from_iter(corners.iter().map(|&k| k as usize));
    let triangles = mesh.triangles().iter().map(|t| (1.0, corners(t)));
    let interior = |&edge: &usize| mesh.edge_triangles(edge).1.is_some();
    let edges = (0..mesh.edges().len()).filter(interior);
    let edges = edges.map(|edge| (-1.0, corners(&mesh.edges()[edge])));
    let inside = |&vertex: &usize| mesh.vertex_kind(vertex) == VertexKind::Interior;
    let vertices = (0..mesh.vertex_count()).filter(inside);
    let vertices = vertices.map(|vertex| (1.0, vec![vertex]));
    triangles.chain(edges).chain(vertices).collect()
}

/// The part of the triangles around a simplex that do not have this corner: triangles around a vertex do not act on it.
fn without(mesh: &Mesh, simplex: &[usize], corner: usize) -> f64 {
    let ring = mesh.connectivity.triangles().iter();
    let around = ring.filter(|t| simplex.iter().all(|&k| t.contains(&(k as u32))));
    let [mut all, mut others] = [0.0; 2];
    for triangle in around {
        all += 1.0;
        others += f64::from(u8::from(!triangle.contains(&(corner as u32))));
    }
    others / all
}

pub(super) fn areas(mesh: &Mesh, x: &Positions<f64>) -> Vec<f64> {
    let surface = Surface::new(&mesh.connectivity, x).unwrap();
    let mut areas = vec![0.0; x.len()];
    for (number, triangle) in mesh.connectivity.triangles().iter().enumerate() {
        for &corner in triangle {
            areas[corner as usize] += surface.triangle_area(number) / 3.0;
        }
    }
    areas
}

/// Unit normals of vertices, by the area vectors around them.
fn normals(mesh: &Mesh, x: &Positions<f64>) -> Positions<f64> {
    let mut normals = vec![[0.0; 3]; x.len()];
    for corners in mesh.connectivity.triangles() {
        let [a, b, c] = corners.map(|corner| x[corner as usize]);
        let doubled = cross(difference(b, a), difference(c, a));
        for &corner in corners {
            let sum = &mut normals[corner as usize];
            *sum = [0, 1, 2].map(|axis| sum[axis] + doubled[axis]);
        }
    }
    normals.iter().map(|&normal| unit(normal)).collect()
}

/// The share of a potential that is felt of the same surface in this direction from a vertex with this normal.
fn facing(normal: [f64; 3], apart: [f64; 3]) -> f64 {
    let cosine = dot(normal, unit(apart));
    let t = (2.0 * cosine * cosine - 0.5).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Double loop over all pairs and all images. Returns the energy, the sum of the magnitudes of its terms between parts of one
/// surface, which mostly cancel, and the forces on all surfaces at constant
/// vertex areas; the whole force on a triangle or edge is added to its first corner. Forces between parts of one surface,
/// which have no sum, are left out.
pub(super) fn by_pairs(
    repulsion: Repulsion<f64>,
    meshes: &[Mesh],
    positions: &[Positions<f64>],
) -> ([f64; 2], Vec<Positions<f64>>) {
    let areas = Vec::from_iter(meshes.iter().zip(positions).map(|(mesh, x)| areas(mesh, x)));
    let simplices = Vec::from_iter(meshes.iter().map(simplices));
    let Repulsion {
        modulus,
        range,
        attraction,
        parts,
        first_group,
        images,
    } = repulsion;
    let normals = Vec::from_iter(
        meshes
            .iter()
            .zip(positions)
            .map(|(mesh, x)| normals(mesh, x)),
    );
    let shifts = shifts(&images, range, positions);
    let bodies = 0..meshes.len();
    let pairs = bodies
        .clone()
        .flat_map(|a| bodies.clone().map(move |b| (a, b)));
    let (mut energy, mut of_parts) = (0.0, 0.0);
    let mut forces = Vec::from_iter(positions.iter().map(|x| vec![[0.0; 3]; x.len()]));
    for (a, b) in pairs {
        for &shift in &shifts {
            let own_parts = a == b && shift == [0.0; 3];
            let one_group = first_group.is_some_and(|first| a != b && (a < first) == (b < first));
            if one_group || own_parts && !parts || a == b && !own_parts && !images.own {
                continue;
            }
            for (i, &x) in positions[a].iter().enumerate() {
                let x = difference(x, shift);
                for (count, corners) in &simplices[b] {
                    let hull = Vec::from_iter(corners.iter().map(|&j| positions[b][j]));
                    let apart = apart(x, &hull);
                    let weight = 0.5 * areas[a][i] * modulus * count;
                    let law = law_with(attraction, range, norm(apart));
                    let [term, push] = law.map(|number| weight * number);
                    if own_parts {
                        let felt = facing(normals[a][i], apart);
                        if felt == 0.0 || term == 0.0 || corners.contains(&i) {
                            continue;
                        }
                        let term = felt * without(&meshes[b], corners, i) * term;
                        energy += term;
                        of_parts += term.abs();
                        continue;
                    }
                    energy += term;
                    for axis in 0..3 {
                        forces[a][i][axis] += push * apart[axis];
                        forces[b][corners[0]][axis] -= push * apart[axis];
                    }
                }
            }
        }
    }
    ([energy, of_parts], forces)
}

/// All translations by whole periods that can bring two of the positions within the range of each other.
fn shifts(images: &Images<f64>, range: f64, positions: &[Positions<f64>]) -> Vec<[f64; 3]> {
    let along = |axis: usize| {
        let coordinates = || positions.iter().flatten().map(|x| x[axis]);
        let [low, high] = [
            coordinates().fold(f64::INFINITY, f64::min),
            coordinates().fold(f64::NEG_INFINITY, f64::max),
        ];
        let period = images.period(axis);
        let count = period.map_or(0, |period| ((high - low + range) / period) as i32 + 1);
        let period = period.unwrap_or_default();
        Vec::from_iter((-count..=count).map(|count| f64::from(count) * period))
    };
    let [x, y, z] = [along(0), along(1), along(2)];
    let plane = x.iter().flat_map(|&x| y.iter().map(move |&y| [x, y]));
    plane
        .flat_map(|[x, y]| z.iter().map(move |&z| [x, y, z]))
        .collect()
}
