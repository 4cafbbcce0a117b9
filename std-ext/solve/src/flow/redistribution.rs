//! Vertices of fluid membranes slide along them, so that meshes stay even in a flow.

use super::Effort;
use crate::dynamics::quadric::Quadric;
use crate::dynamics::vector::{self, Vector};
use helfrich::{TriangleMesh, VertexKind};
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

/// Redistribution of the vertices of fluid membranes, which need not follow the material.
///
/// Only the normal part of the velocities u changes the shape; the tangential motion of vertices
/// can be chosen for the mesh. Vertices move with `v = (u·n) n + t`, and the tangential field t
/// minimises
///
/// `Σ_e [d/dt ln|x_e| + k ln(|x_e|/ℓ)]² + ε/R² Σ_i |t_i − U_t|²`
///
/// in each connected component, summed over its edges e. Edges thus change as little as the shape
/// allows, and their deviations from the geometric mean ℓ decay at the rate k, the root mean square
/// of the rates at which the material would stretch them. The last term, with U the mean velocity,
/// determines motions that leave edges unchanged, such as the rotation of a sphere. A. Z.
/// Zinchenko, M. A. Rother and R. H. Davis, Phys. Fluids 9 (1997) 1493, use the rates of distances;
/// logarithms give all sizes the same weight. The mesh of a steadily tank-treading membrane is
/// stationary, while a rigid motion carries the mesh along.
///
/// Normals are those of quadrics fitted to the neighbours, which are of second order on every mesh.
/// Vertices at a boundary follow the material.
///
/// Results depend on positions and velocities alone, and sums are sequential.
#[derive(Debug, Default)]
pub struct Redistribution {
    sliding: Vec<Sliding>,
    tolerance: f64,
    effort: Effort,
}

/// ε, against the stiffness of the longest waves, which is of order 1.
const LEAST_STIFFNESS: f64 = 1e-3;

/// Iterations a solution may take, in units of the square root of the number of vertices.
const ITERATIONS: f64 = 20.0;

/// One component of a fluid membrane.
#[derive(Debug)]
struct Sliding {
    mesh: Arc<TriangleMesh>,
    /// The vertices of the mesh, among those of all meshes.
    vertices: Range<usize>,
    /// The vertices of the component by their index in the mesh; its edges by indices into `own`.
    own: Vec<u32>,
    edges: Vec<[u32; 2]>,
}

impl Redistribution {
    /// Redistributes the meshes that are `fluid`; all meshes follow one after the other. `tolerance` is
    /// the relative residual of t: the shape does not depend on it, but difference quotients of
    /// velocities do.
    pub fn new(
        meshes: &[Arc<TriangleMesh>],
        fluid: &dyn Fn(usize) -> bool,
        tolerance: f64,
    ) -> Self {
        let mut all = Vec::new();
        let mut first = 0;
        for (number, mesh) in meshes.iter().enumerate() {
            let vertices = first..first + mesh.vertex_count();
            first = vertices.end;
            if !fluid(number) {
                continue;
            }
            let (component_of, count) = mesh.components();
            let mut places = vec![0u32; mesh.vertex_count()];
            let mut parts = vec![(Vec::new(), Vec::new()); count];
            for (vertex, &component) in component_of.iter().enumerate() {
                let (own, _): &mut (Vec<u32>, Vec<[u32; 2]>) = &mut parts[component as usize];
                places[vertex] = own.len() as u32;
                own.push(vertex as u32);
            }
            for edge in mesh.edges() {
                let (_, edges) = &mut parts[component_of[edge[0] as usize] as usize];
                edges.push(edge.map(|vertex| places[vertex as usize]));
            }
            all.extend(parts.into_iter().map(|(own, edges)| Sliding {
                mesh: Arc::clone(mesh),
                vertices: vertices.clone(),
                own,
                edges,
            }));
        }
        Self {
            sliding: all,
            tolerance,
            effort: Effort::default(),
        }
    }

    /// Whether there is no fluid membrane.
    pub fn is_empty(&self) -> bool {
        self.sliding.is_empty()
    }

    /// Whether the mesh with these vertices is a fluid membrane.
    pub(super) fn moves(&self, vertices: &Range<usize>) -> bool {
        let start = |sliding: &Sliding| sliding.vertices.start;
        let found = (self.sliding).binary_search_by(|sliding| start(sliding).cmp(&vertices.start));
        found.is_ok()
    }

    /// The relative error of velocities after [`Self::slide`].
    pub fn precision(&self) -> f64 {
        if self.is_empty() {
            f64::EPSILON
        } else {
            self.tolerance
        }
    }

    /// The effort so far; none without a fluid membrane.
    pub fn effort(&self) -> Option<(&'static str, Effort)> {
        (!self.is_empty()).then_some(("redistribution", self.effort))
    }

    /// Replaces velocities of the material by velocities of the mesh.
    ///
    /// # Panics
    /// If there is not one position and one velocity per vertex.
    pub fn slide(&mut self, positions: &[[f64; 3]], velocities: &mut [[f64; 3]]) {
        self.run(positions, velocities, true);
    }

    /// As [`Self::slide`] for a change of velocities that leaves k as it is.
    pub(super) fn respond(&mut self, positions: &[[f64; 3]], change: &mut [[f64; 3]]) {
        self.run(positions, change, false);
    }

    fn run(&mut self, positions: &[[f64; 3]], velocities: &mut [[f64; 3]], evens: bool) {
        if self.is_empty() {
            return;
        }
        let start = Instant::now();
        for sliding in &self.sliding {
            let positions = &positions[sliding.vertices.clone()];
            let velocities = &mut velocities[sliding.vertices.clone()];
            sliding.slide(positions, velocities, self.tolerance, evens);
        }
        self.effort.add(start);
    }
}

/// An edge in tangential coordinates.
#[derive(Clone, Copy, Debug)]
struct Edge {
    /// Indices of its ends among the vertices of the component.
    ends: [u32; 2],
    /// `±x_e/|x_e|²` along both axes of both ends: of t at the ends, they give d/dt ln|x_e|.
    rate: [[f64; 2]; 2],
}

/// A tangential field, in components along the two axes of each vertex.
type Tangential = Vec<[f64; 2]>;

impl Sliding {
    /// `evens` is whether deviations of edges decay.
    fn slide(&self, positions: &[Vector], velocities: &mut [Vector], tolerance: f64, evens: bool) {
        let count = self.own.len() as f64;
        let mut mean = [0.0; 3];
        for &vertex in &self.own {
            mean = vector::add(mean, velocities[vertex as usize]);
        }
        let mean = vector::scale(count.recip(), mean);
        let normals = self.normals(positions);
        let axes = Vec::from_iter(normals.iter().map(|&normal| across(normal)));

        // ln ℓ and k are means over the edges.
        let material = Vec::from_iter(self.own.iter().map(|&v| velocities[v as usize]));
        let (mut logarithm, mut squares, mut known) = (0.0, 0.0, 0.0);
        for ends in &self.edges {
            let way = self.way(ends, positions);
            let square = vector::dot(way, way);
            if square > 0.0 {
                let rate = vector::dot(way, difference(&material, ends)) / square;
                logarithm += 0.5 * square.ln();
                squares += rate * rate;
                known += 1.0;
            }
        }
        let Some(per_edge) = (known > 0.0).then(|| f64::recip(known)) else {
            return;
        };
        let length = logarithm * per_edge;
        let decay = if evens {
            (squares * per_edge).sqrt()
        } else {
            0.0
        };

        let fixed = Vec::from_iter(
            self.own
                .iter()
                .map(|&vertex| self.mesh.vertex_kind(vertex as usize) != VertexKind::Interior),
        );
        // The rates of edges for t = U_t.
        let carried = material.iter().zip(&normals).zip(&fixed);
        let carried = carried.map(|((&u, &normal), &fixed)| {
            let across = vector::dot(vector::sub(u, mean), normal);
            let carried = vector::add(mean, vector::scale(across, normal));
            if fixed { u } else { carried }
        });
        let carried = Vec::from_iter(carried);

        let mut edges = Vec::with_capacity(self.edges.len());
        let mut right = vec![[0.0; 2]; self.own.len()];
        for ends in &self.edges {
            let way = self.way(ends, positions);
            let square = vector::dot(way, way);
            if square > 0.0 {
                let along = vector::scale(square.recip(), way);
                let [at, to] = ends.map(|end| axes[end as usize]);
                let rate = [
                    at.map(|axis| -vector::dot(along, axis)),
                    to.map(|axis| vector::dot(along, axis)),
                ];
                let edge = Edge { ends: *ends, rate };
                let change = vector::dot(along, difference(&carried, ends));
                let excess = 0.5 * square.ln() - length;
                edge.add(&mut right, -(change + decay * excess));
                edges.push(edge);
            }
        }
        // The area is that of as many equilateral triangles: 4πR² = N (√3/2) ℓ².
        let area = count * 0.5 * 3f64.sqrt() * (2.0 * length).exp();
        let system = System {
            fixed,
            edges,
            shift: LEAST_STIFFNESS * 4.0 * PI / area,
        };
        let along = system.solve(right, tolerance);
        for (place, &vertex) in self.own.iter().enumerate() {
            if system.fixed[place] {
                continue;
            }
            let [first, second] = axes[place];
            let [a, b] = along[place];
            let along = vector::add(vector::scale(a, first), vector::scale(b, second));
            velocities[vertex as usize] = vector::add(carried[place], along);
        }
    }

    /// From the first end of an edge to the second.
    fn way(&self, ends: &[u32; 2], positions: &[Vector]) -> Vector {
        let [a, b] = ends.map(|end| positions[self.own[end as usize] as usize]);
        vector::sub(b, a)
    }

    fn normals(&self, positions: &[Vector]) -> Vec<Vector> {
        let mut sums = vec![[0.0; 3]; positions.len()];
        for triangle in self.mesh.triangles() {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
            let doubled = vector::cross(vector::sub(b, a), vector::sub(c, a));
            for &vertex in triangle {
                let sum = &mut sums[vertex as usize];
                *sum = vector::add(*sum, doubled);
            }
        }
        let fitted = self.own.iter().map(|&vertex| {
            let normal = vector::unit(sums[vertex as usize]);
            let [first, second] = across(normal);
            let axes = [first, second, normal];
            Quadric::fit(&self.mesh, positions, vertex as usize, axes).normal()
        });
        fitted.collect()
    }
}

/// The field at the second end minus that at the first.
fn difference(field: &[Vector], ends: &[u32; 2]) -> Vector {
    let [a, b] = ends.map(|end| field[end as usize]);
    vector::sub(b, a)
}

/// Two unit vectors that are perpendicular to a third and to each other.
fn across(normal: Vector) -> [Vector; 2] {
    // T. Duff et al., J. Comput. Graph. Tech. 6 (2017) 1.
    let [x, y, z] = normal;
    let sign = 1f64.copysign(z);
    let a = -(sign + z).recip();
    let b = x * y * a;
    [
        [1.0 + sign * x * x * a, sign * b, -sign * x],
        [b, sign + y * y * a, -y],
    ]
}

impl Edge {
    /// d/dt ln|x_e| by a field along the surface.
    fn of(&self, field: &Tangential) -> f64 {
        let [at, to] = self.ends.map(|end| field[end as usize]);
        dot(self.rate[0], at) + dot(self.rate[1], to)
    }

    /// The transpose.
    fn add(&self, field: &mut Tangential, value: f64) {
        for (&end, rate) in self.ends.iter().zip(&self.rate) {
            let entry = &mut field[end as usize];
            *entry = [entry[0] + value * rate[0], entry[1] + value * rate[1]];
        }
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The normal equations of t.
struct System {
    edges: Vec<Edge>,
    /// ε/R².
    shift: f64,
    /// Vertices that do not slide.
    fixed: Vec<bool>,
}

impl System {
    /// Solved by conjugate gradients, preconditioned by the diagonal block of each vertex.
    fn solve(&self, mut residual: Tangential, tolerance: f64) -> Tangential {
        let count = residual.len();
        let inverses = self.inverses();
        let precondition = |residual: &Tangential| {
            let parts = residual.iter().zip(&inverses);
            Tangential::from_iter(
                parts.map(|(&r, &[xx, xy, yy])| [xx * r[0] + xy * r[1], xy * r[0] + yy * r[1]]),
            )
        };
        let inner = |a: &Tangential, b: &Tangential| -> f64 {
            a.iter().zip(b).map(|(&a, &b)| dot(a, b)).sum()
        };
        let add = |y: &mut Tangential, factor: f64, x: &Tangential| {
            for (y, x) in y.as_flattened_mut().iter_mut().zip(x.as_flattened()) {
                *y += factor * x;
            }
        };
        let mut solution = vec![[0.0; 2]; count];
        let mut direction = precondition(&residual);
        let mut size = inner(&residual, &direction);
        let enough = tolerance * tolerance * size;
        let limit = (ITERATIONS * (count as f64).sqrt()) as usize;
        for _ in 0..limit {
            // The caller that requested the velocities checks whether they are finite.
            if size <= enough || size.is_nan() {
                break;
            }
            let product = self.product(&direction);
            let step = size / inner(&direction, &product);
            add(&mut solution, step, &direction);
            add(&mut residual, -step, &product);
            let mut next = precondition(&residual);
            let before = size;
            size = inner(&residual, &next);
            add(&mut next, size / before, &direction);
            direction = next;
        }
        solution
    }

    fn product(&self, field: &Tangential) -> Tangential {
        let shifted = field.iter().map(|entry| entry.map(|x| self.shift * x));
        let mut product = Tangential::from_iter(shifted);
        for edge in &self.edges {
            edge.add(&mut product, edge.of(field));
        }
        product
    }

    /// The inverse of the diagonal block of each vertex: xx, xy, yy. 0 keeps a vertex fixed.
    fn inverses(&self) -> Vec<[f64; 3]> {
        let mut matrices = vec![[self.shift, 0.0, self.shift]; self.fixed.len()];
        for edge in &self.edges {
            for (&end, &[x, y]) in edge.ends.iter().zip(&edge.rate) {
                let [xx, xy, yy] = &mut matrices[end as usize];
                *xx += x * x;
                *xy += x * y;
                *yy += y * y;
            }
        }
        for (matrix, &fixed) in matrices.iter_mut().zip(&self.fixed) {
            let [xx, xy, yy] = *matrix;
            let over = if fixed {
                0.0
            } else {
                (xx * yy - xy * xy).recip()
            };
            *matrix = [over * yy, -over * xy, over * xx];
        }
        matrices
    }
}

#[cfg(test)]
mod tests {
    use super::Redistribution;
    use crate::dynamics::vector::{add, cross, dot, norm, root_mean_square, scale, sub, unit};
    use helfrich::TriangleMesh;
    use helfrich_mesh::generate::{AnyShape, Family, generate};
    use std::sync::Arc;

    type Field = Vec<[f64; 3]>;

    fn mesh(shape: &str, family: Family, vertices: usize) -> (Arc<TriangleMesh>, Field) {
        let shape: AnyShape = shape.parse().expect("a shape");
        let generated = generate(&shape, family, vertices, 1).expect("a mesh");
        (Arc::new(generated.mesh), generated.positions)
    }

    /// Velocities of the mesh, of those of the material at each position.
    fn slide(
        mesh: &Arc<TriangleMesh>,
        positions: &[[f64; 3]],
        material: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Field {
        let mut velocities = Field::from_iter(positions.iter().map(|&x| material(x)));
        let meshes = [Arc::clone(mesh)];
        Redistribution::new(&meshes, &|_| true, 1e-8).slide(positions, &mut velocities);
        velocities
    }

    /// On the ellipsoid x²/4 + y² + z² = 1, around z: tangential everywhere.
    fn treading([x, y, _]: [f64; 3]) -> [f64; 3] {
        [2.0 * y, -0.5 * x, 0.0]
    }

    /// But for turns about the axis of symmetry, which change no shape.
    #[test]
    fn the_whole_body_takes_its_mesh_along() {
        let (mesh, positions) = mesh("ellipsoid:2,1,1", Family::Irregular, 642);
        let moving = |x| add([0.3, -2.0, 1.0], cross([0.0, 0.1, 1.5], x));
        let found = slide(&mesh, &positions, moving);
        let away = found
            .iter()
            .zip(&positions)
            .map(|(&v, &x)| sub(v, moving(x)));
        let all = root_mean_square(positions.iter().map(|&x| moving(x)));
        let share = root_mean_square(away) / all;
        // What ε and the noise of the normals leave.
        assert!(share < 0.02, "{share}");
    }

    #[test]
    fn a_membrane_that_treads_leaves_its_mesh() {
        let (mesh, positions) = mesh("ellipsoid:2,1,1", Family::Relaxed, 642);
        let found = slide(&mesh, &positions, treading);
        let all = root_mean_square(positions.iter().map(|&x| treading(x)));
        let share = root_mean_square(found.into_iter()) / all;
        assert!(share < 0.1, "{share}");
    }

    /// The velocity through an ellipsoid, along which the material moves, on a mesh whose vertices
    /// slide against it.
    fn through(vertices: usize) -> f64 {
        let (mesh, positions) = mesh("ellipsoid:2,1,1", Family::Irregular, vertices);
        let found = slide(&mesh, &positions, treading);
        let through = found.iter().zip(&positions).map(|(&v, &[x, y, z])| {
            let normal = unit([0.25 * x, y, z]);
            scale(dot(v, normal), normal)
        });
        root_mean_square(through)
    }

    #[test]
    fn the_shape_stays_to_second_order() {
        let (coarse, fine) = (through(642), through(2562));
        // A second order is a factor 4.
        assert!(fine < coarse / 3.3, "{coarse:e} {fine:e}");
        assert!(coarse < 0.01, "{coarse:e}");
    }

    /// The root mean square of ln(|x_e|/ℓ).
    fn unevenness(mesh: &TriangleMesh, positions: &[[f64; 3]]) -> f64 {
        let logarithms = Vec::from_iter(mesh.edges().iter().map(|edge| {
            let [a, b] = edge.map(|vertex| positions[vertex as usize]);
            norm(sub(b, a)).ln()
        }));
        let mean = logarithms.iter().sum::<f64>() / logarithms.len() as f64;
        let squares = logarithms.iter().map(|l| (l - mean) * (l - mean));
        (squares.sum::<f64>() / logarithms.len() as f64).sqrt()
    }

    /// A sphere in a shear flow, where the material draws edges out; vertices that were shifted
    /// go back as long waves and short ones do, e-fold in 1/k.
    #[test]
    fn uneven_meshes_become_even() {
        let (mesh, even) = mesh("sphere:1", Family::Smooth, 642);
        let shifted = |[x, y, z]: [f64; 3]| unit([x + 0.25 * y * z, y, z + 0.25 * x]);
        let mut positions = Field::from_iter(even.iter().map(|&x| shifted(x)));
        let shear = |[_, y, _]: [f64; 3]| [y, 0.0, 0.0];
        // Along the sphere alone.
        let material = |x| sub(shear(x), scale(dot(shear(x), x), x));
        let rest = unevenness(&mesh, &even);
        let before = unevenness(&mesh, &positions) - rest;
        // k is 0.3 γ̇ here: 6 γ̇t is nearly two e-folds.
        for _ in 0..60 {
            let velocities = slide(&mesh, &positions, material);
            for (x, v) in positions.iter_mut().zip(velocities) {
                *x = unit(add(*x, scale(0.1, v)));
            }
        }
        let after = unevenness(&mesh, &positions) - rest;
        assert!(after < 0.3 * before, "{before} {after}");
    }

    /// Each component goes its own way, and what is not fluid stays as it is.
    #[test]
    fn only_fluid_membranes_slide() {
        let (mesh, positions) = mesh("ellipsoid:2,1,1", Family::Irregular, 162);
        let alone = slide(&mesh, &positions, treading);
        let meshes = [Arc::clone(&mesh), Arc::clone(&mesh)];
        let both = [positions.clone(), positions.clone()].concat();
        let material = Field::from_iter(both.iter().map(|&x| treading(x)));
        let mut velocities = material.clone();
        let mut redistribution = Redistribution::new(&meshes, &|number| number == 1, 1e-8);
        redistribution.slide(&both, &mut velocities);
        assert_eq!(velocities[..162], material[..162]);
        assert_eq!(velocities[162..], alone);
    }
}
