//! The mobility of membranes by local operators, and linearly implicit steps with it.

use super::{Gmres, Membranes};
use crate::dynamics::cholesky::{Factor, Pattern};
use crate::dynamics::cotangents::{self, Cotangents};
use crate::dynamics::vector::{Vector, add, cross, dot, scale, sub, unit};
use crate::dynamics::{Membrane, Motion};
use std::f64::consts::{FRAC_2_PI, PI};
use std::ops::Range;

/// The factor by which the mobility is taken too large: steps are stable if decay rates are between
/// 0.7 times and four times the true ones.
const EXCESS: f64 = 1.3;

/// The distance of poles in ln k; it approximates 1/k within 2 exp(−π²/2) = 1.4 %.
const SPACING: f64 = 2.0;

/// Displacements for difference quotients, root mean square, in mean edges: the square root of the
/// rounding.
const DISPLACEMENT: f64 = 1e-7;

/// Approximation `A = −B K` of the derivatives of velocities by positions, with K the stiffness
/// −∂F/∂x of the membranes and B a local approximation of their mobility.
///
/// A flat membrane in fluid of viscosity μ moves along its normal by 1/(4μk) times a force per area of
/// wave number k, and in the direction of k, too; across, by twice as much. B is 1/(4μ√(L + σ)) in
/// each direction, with the Laplacian −L of the mesh and σ = 1/(4R²), R the radius of the sphere of
/// the same area: on a sphere k is then l + 1/2. Where viscosities differ, μ is the mean of both
/// sides.
///
/// `1/√z ≈ Σ_j w_j/(z + s_j)` by the trapezoidal rule in ln s: each term is a sparse factorisation. K
/// is known by its products, which are differences of forces.
#[derive(Debug)]
pub(super) struct LocalMobility {
    parts: Vec<Part>,
    positions: Vec<Vector>,
    forces: Vec<Vector>,
    /// Mean edge of all membranes.
    edge: f64,
    solver: Gmres,
    /// Number of products with K so far.
    products: u64,
}

/// A membrane.
#[derive(Debug)]
struct Part {
    membrane: Membrane,
    vertices: Range<usize>,
    pattern: Pattern,
    /// 4μ over [`EXCESS`].
    drag: f64,
    normals: Vec<Vector>,
    cotangents: Option<Cotangents>,
    /// σ, and the largest eigenvalue of L + σ.
    range: [f64; 2],
    /// Weights, s_j, and factors of S + (σ + s_j) M.
    poles: Vec<(f64, f64, Factor)>,
    /// The constant term, which stands for the poles beyond the last.
    rest: f64,
    preconditioner: Option<Preconditioner>,
}

/// Approximate inverses of `4μ √(L + σ) M + c K`, along normals and along the surface.
#[derive(Debug)]
struct Preconditioner {
    /// c.
    step: f64,
    /// The factor q of `q (S + p M) M⁻¹ (S + p M)` with bending.
    squared: Option<f64>,
    normal: Factor,
    tangential: Option<Factor>,
}

impl LocalMobility {
    /// The mobility of membranes, with the mean viscosity of the fluid on both sides of each, and the
    /// relative residual of solutions.
    pub(super) fn new(membranes: Vec<Membrane>, viscosities: &[f64], tolerance: f64) -> Self {
        let mut first = 0;
        let parts = membranes.into_iter().zip(viscosities);
        let parts = parts.map(|(membrane, viscosity)| {
            let vertices = first..first + membrane.mesh.vertex_count();
            first = vertices.end;
            Part {
                pattern: Pattern::new(&membrane.mesh),
                membrane,
                vertices,
                drag: 4.0 * viscosity / EXCESS,
                normals: Vec::new(),
                cotangents: None,
                range: [1.0; 2],
                poles: Vec::new(),
                rest: 0.0,
                preconditioner: None,
            }
        });
        let parts = Vec::from_iter(parts);
        let mut solver = Gmres::new(tolerance);
        (solver.restart, solver.products) = (60, 120);
        Self {
            parts,
            positions: Vec::new(),
            forces: vec![[0.0; 3]; first],
            edge: 1.0,
            solver,
            products: 0,
        }
    }

    /// Number of products with K so far, each an evaluation of forces.
    pub(super) fn products(&self) -> u64 {
        self.products
    }

    /// Sets the positions at which A is taken.
    pub(super) fn set(
        &mut self,
        membranes: &mut dyn Membranes,
        positions: &[Vector],
    ) -> Result<(), String> {
        self.positions.clear();
        self.positions.extend_from_slice(positions);
        membranes.set_forces(positions, &mut self.forces)?;
        let (mut area, mut triangles) = (0.0, 0);
        for part in &mut self.parts {
            area += part.set(&positions[part.vertices.clone()])?;
            triangles += part.membrane.mesh.triangles().len();
        }
        // Of equilateral triangles.
        self.edge = (area / triangles as f64 * 4.0 / 3f64.sqrt()).sqrt();
        Ok(())
    }

    /// The difference y − r of the solution of `y − c A y = r`, for this r; along normals where vertices
    /// slide.
    pub(super) fn change(
        &mut self,
        membranes: &mut dyn Membranes,
        c: f64,
        field: &[Vector],
    ) -> Result<Vec<Vector>, String> {
        let Self {
            parts,
            positions,
            forces,
            edge,
            solver,
            products,
        } = self;
        for part in &mut *parts {
            part.prepare(c)?;
        }
        let count = field.len();
        let mut moved = vec![[0.0; 3]; count];
        let mut there = vec![[0.0; 3]; count];
        let mut drag = vec![[0.0; 3]; count];
        let mut failure = None;
        let mut right = vec![[0.0; 3]; count];
        for part in &mut *parts {
            let range = part.vertices.clone();
            let (field, right) = (&field[range.clone()], &mut right[range]);
            right.copy_from_slice(field);
            part.restrict(right);
            let own = right.to_vec();
            part.drag(&own, right);
            part.precondition(right);
        }
        let mut apply = |y: &[Vector], product: &mut [Vector]| {
            let squares: f64 = y.iter().map(|y| dot(*y, *y)).sum();
            let displacement = DISPLACEMENT * *edge * (count as f64 / squares).sqrt();
            for (moved, (x, y)) in moved.iter_mut().zip(positions.iter().zip(y)) {
                *moved = add(*x, scale(displacement, *y));
            }
            *products += 1;
            if let Err(reason) = membranes.set_forces(&moved, &mut there) {
                failure = Some(reason);
                product.fill([f64::NAN; 3]);
                return;
            }
            for part in &mut *parts {
                let range = part.vertices.clone();
                part.drag(&y[range.clone()], &mut drag[range.clone()]);
                for i in range.clone() {
                    let softening = sub(forces[i], there[i]);
                    product[i] = add(drag[i], scale(c / displacement, softening));
                }
                part.precondition(&mut product[range]);
            }
        };
        let mut solution = right.clone();
        let solved = solver.solve(&mut apply, &right, &mut solution);
        if let Some(reason) = failure {
            return Err(reason);
        }
        if !solved.converged {
            return Err(format!(
                "after {} products the displacements of an implicit step are still wrong by {:.1e} of \
                 their size",
                solved.products, solved.residual
            ));
        }
        let mut rest = field.to_vec();
        for part in &*parts {
            part.restrict(&mut rest[part.vertices.clone()]);
        }
        let pairs = solution.iter().zip(&rest);
        Ok(pairs.map(|(y, r)| sub(*y, *r)).collect())
    }

    /// The positions at which A is taken.
    pub(super) fn positions(&self) -> &[Vector] {
        &self.positions
    }
}

impl Part {
    /// Sets the geometry; returns the area.
    fn set(&mut self, positions: &[Vector]) -> Result<f64, String> {
        let mesh = &*self.membrane.mesh;
        let cotangents = Cotangents::new(mesh, positions);
        let mut normals = vec![[0.0; 3]; positions.len()];
        for triangle in mesh.triangles() {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
            let doubled = cross(sub(b, a), sub(c, a));
            for &vertex in triangle {
                let sum = &mut normals[vertex as usize];
                *sum = add(*sum, doubled);
            }
        }
        self.normals = normals.into_iter().map(unit).collect();
        let total = cotangents.total;
        let least = PI / total;
        let diagonal = cotangents::diagonal(mesh, &cotangents.areas, &cotangents.edges, [0.0, 1.0]);
        // Twice the largest entry on the diagonal bounds the eigenvalues of cotangents without
        // obtuse angles.
        let largest = diagonal.iter().zip(&cotangents.areas);
        let largest = largest.map(|(s, m)| 2.0 * s / m).fold(least, f64::max);
        self.range = [least, least + largest];
        self.poles.clear();
        self.preconditioner = None;
        let [low, high] = self.range.map(f64::sqrt);
        let count = 1 + ((high / low).ln() / SPACING).ceil() as usize;
        for k in 0..count {
            let node = low * (SPACING * k as f64).exp();
            let pole = node * node;
            let factor = self.factor(&cotangents, [least + pole, 1.0])?;
            self.poles.push((FRAC_2_PI * SPACING * node, pole, factor));
        }
        let next = low * (SPACING * count as f64).exp();
        self.rest = FRAC_2_PI * SPACING / (next * (1.0 - (-SPACING).exp()));
        self.cotangents = Some(cotangents);
        Ok(total)
    }

    /// Factorises `α M + β S`.
    fn factor(&self, cotangents: &Cotangents, factors: [f64; 2]) -> Result<Factor, String> {
        let edges = Vec::from_iter(cotangents.edges.iter().map(|value| factors[1] * value));
        let mesh = &self.membrane.mesh;
        let diagonal = cotangents::diagonal(mesh, &cotangents.areas, &cotangents.edges, factors);
        Factor::new(&self.pattern, &diagonal, &edges)
            .ok_or_else(|| "a Laplacian of the mesh is not positive".to_owned())
    }

    /// Prepares the preconditioner for this c.
    fn prepare(&mut self, step: f64) -> Result<(), String> {
        if self
            .preconditioner
            .as_ref()
            .is_some_and(|it| it.step == step)
        {
            return Ok(());
        }
        let Some(cotangents) = &self.cotangents else {
            return Err("a step has no positions".to_owned());
        };
        let [low, high] = self.range.map(f64::sqrt);
        let (bending, in_plane) = (
            self.membrane.bending_modulus,
            self.membrane.in_plane_modulus,
        );
        // √z ≈ (k0 + z/k0)/2 near k0, where drag and stiffness are equal.
        let linear = |stiffness: f64| {
            let k0 = (self.drag / stiffness).clamp(low, high);
            let k0 = if stiffness > 0.0 {
                k0
            } else {
                (low * high).sqrt()
            };
            let half = 0.5 * self.drag;
            self.factor(cotangents, [half * k0, half / k0 + stiffness])
        };
        let (squared, normal) = if bending > 0.0 {
            let k0 = (self.drag / (step * bending)).cbrt().min(high);
            let shift = (0.5 * self.drag * k0 / (step * bending)).sqrt();
            (Some(step * bending), self.factor(cotangents, [shift, 1.0])?)
        } else {
            (None, linear(step * in_plane)?)
        };
        let tangential = match self.membrane.motion {
            Motion::Free => Some(linear(step * in_plane)?),
            Motion::AlongNormals => None,
        };
        self.preconditioner = Some(Preconditioner {
            step,
            squared,
            normal,
            tangential,
        });
        Ok(())
    }

    /// Leaves the part of a field that A acts on.
    fn restrict(&self, field: &mut [Vector]) {
        if self.membrane.motion == Motion::AlongNormals {
            for (entry, normal) in field.iter_mut().zip(&self.normals) {
                *entry = scale(dot(*entry, *normal), *normal);
            }
        }
    }

    /// Sets nodal forces to `4μ √(L + σ)` times velocities, over [`EXCESS`].
    fn drag(&mut self, velocities: &[Vector], forces: &mut [Vector]) {
        let Some(Cotangents { areas, edges, .. }) = &self.cotangents else {
            return;
        };
        // z R(z) = rest z + Σ w (1 − s/(z + s)).
        let weights: f64 = self.poles.iter().map(|(weight, ..)| weight).sum();
        let alpha = weights + self.rest * self.range[0];
        for (force, (velocity, area)) in forces.iter_mut().zip(velocities.iter().zip(areas)) {
            *force = scale(alpha * area, *velocity);
        }
        for (&[a, b], value) in self.membrane.mesh.edges().iter().zip(edges) {
            let [a, b] = [a as usize, b as usize];
            let pull = scale(self.rest * value, sub(velocities[b], velocities[a]));
            forces[a] = add(forces[a], pull);
            forces[b] = sub(forces[b], pull);
        }
        let mut smooth = vec![[0.0; 3]; forces.len()];
        for (weight, pole, factor) in &mut self.poles {
            for (smooth, (velocity, area)) in smooth.iter_mut().zip(velocities.iter().zip(areas)) {
                *smooth = scale(*area, *velocity);
            }
            factor.solve(&self.pattern, smooth.as_flattened_mut(), 3);
            for (force, (smooth, area)) in forces.iter_mut().zip(smooth.iter().zip(areas)) {
                *force = sub(*force, scale(*weight * *pole * area, *smooth));
            }
        }
        for force in forces.iter_mut() {
            *force = scale(self.drag, *force);
        }
        self.restrict(forces);
    }

    /// Replaces nodal forces by velocities.
    fn precondition(&mut self, field: &mut [Vector]) {
        let (Some(cotangents), Some(parts)) = (&self.cotangents, &mut self.preconditioner) else {
            return;
        };
        let along = field.iter().zip(&self.normals);
        let mut along = Vec::from_iter(along.map(|(entry, normal)| dot(*entry, *normal)));
        let mut across = Vec::new();
        if let Some(factor) = &mut parts.tangential {
            let rest = field.iter().zip(along.iter().zip(&self.normals));
            across.extend(rest.map(|(entry, (along, normal))| sub(*entry, scale(*along, *normal))));
            factor.solve(&self.pattern, across.as_flattened_mut(), 3);
        }
        parts.normal.solve(&self.pattern, &mut along, 1);
        if let Some(modulus) = parts.squared {
            for (along, area) in along.iter_mut().zip(&cotangents.areas) {
                *along *= area / modulus;
            }
            parts.normal.solve(&self.pattern, &mut along, 1);
        }
        for (i, normal) in self.normals.iter().enumerate() {
            field[i] = scale(along[i], *normal);
            if let Some(across) = across.get(i) {
                let out = dot(*across, *normal);
                field[i] = add(field[i], sub(*across, scale(out, *normal)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{EXCESS, LocalMobility};
    use crate::dynamics::{Membrane, Motion};
    use crate::flow::Membranes;
    use helfrich_mesh::generate::{AnyShape, Family, generate};
    use std::sync::Arc;

    /// A Legendre polynomial, up to a factor.
    type Polynomial = fn(f64) -> f64;

    /// Vertices that are drawn to the origin by these forces over their distances.
    struct Springs(Vec<f64>);

    impl Membranes for Springs {
        fn set_forces(&mut self, x: &[[f64; 3]], forces: &mut [[f64; 3]]) -> Result<(), String> {
            for (i, force) in forces.iter_mut().enumerate() {
                *force = x[i].map(|x| -self.0[i] * x);
            }
            Ok(())
        }
    }

    /// Springs of k per area on a sphere: a field of degree l decays at the rate k/(4μ (l + 1/2)/R).
    #[test]
    fn harmonics_of_a_sphere_decay_as_they_should() {
        let (viscosity, spring, c) = (0.7, 3.0, 2.5);
        let shape: AnyShape = "sphere:2".parse().expect("a shape");
        let made = generate(&shape, Family::Regular, 642, 1).expect("a mesh");
        let (mesh, positions) = (Arc::new(made.mesh), made.positions);
        let membrane = Membrane {
            mesh,
            bending_modulus: 0.0,
            in_plane_modulus: 1.0,
            motion: Motion::Free,
            fixed: Vec::new(),
        };
        let mut mobility = LocalMobility::new(vec![membrane], &[viscosity], 1e-8);
        let mut springs = Springs(vec![0.0; positions.len()]);
        mobility.set(&mut springs, &positions).expect("positions");
        let areas = mobility.parts[0].cotangents.as_ref().map(|it| &it.areas);
        springs.0 = areas
            .expect("areas")
            .iter()
            .map(|area| spring * area)
            .collect();
        mobility.set(&mut springs, &positions).expect("positions");
        let harmonics: [(f64, Polynomial); 3] = [
            (2.0, |z| 3.0 * z * z - 1.0),
            (3.0, |z| z * (5.0 * z * z - 3.0)),
            (4.0, |z| z * z * (35.0 * z * z - 30.0) + 3.0),
        ];
        for (degree, polynomial) in harmonics {
            let field = positions.iter().map(|x| {
                let value = polynomial(0.5 * x[2]);
                [0.3 * value, -value, 0.5 * value]
            });
            let field = Vec::from_iter(field);
            let change = mobility
                .change(&mut springs, c, &field)
                .expect("a solution");
            let rate = EXCESS * spring / (4.0 * viscosity * (degree + 0.5) / 2.0);
            let expected = -c * rate / (1.0 + c * rate);
            let product = |a: &[[f64; 3]]| -> f64 {
                let pairs = a.as_flattened().iter().zip(field.as_flattened());
                pairs.map(|(a, b)| a * b).sum()
            };
            let found = product(&change) / product(&field);
            // The first pole takes the place of all that would be before it, whose share at l = 2
            // is 4 %, and less beyond.
            assert!(
                (found / expected - 1.0).abs() < 0.04,
                "degree {degree}: {found} instead of {expected}"
            );
        }
    }

    /// The drag is 4μ √(L + σ): applied twice it is that of the Laplacian, also of the shortest waves, which the
    /// constant term of the sum over poles carries.
    #[test]
    fn drag_is_the_square_root_of_the_laplacian() {
        let shape: AnyShape = "sphere:2".parse().expect("a shape");
        let made = generate(&shape, Family::Regular, 642, 1).expect("a mesh");
        let (mesh, positions) = (Arc::new(made.mesh), made.positions);
        let membrane = Membrane {
            mesh: mesh.clone(),
            bending_modulus: 0.0,
            in_plane_modulus: 1.0,
            motion: Motion::Free,
            fixed: Vec::new(),
        };
        let mut mobility = LocalMobility::new(vec![membrane], &[0.7], 1e-8);
        let mut still = Springs(vec![0.0; positions.len()]);
        mobility.set(&mut still, &positions).expect("positions");
        let part = &mut mobility.parts[0];
        let (drag, [shift, _]) = (part.drag, part.range);
        let cotangents = part.cotangents.take().expect("cotangents");
        let (areas, edges) = (cotangents.areas.clone(), cotangents.edges.clone());
        part.cotangents = Some(cotangents);
        // Along x a wave of l = 3, and along z the shortest waves: alternating signs.
        let field = positions.iter().enumerate();
        let field = field.map(|(i, x)| {
            let z = 0.5 * x[2];
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            [z * (5.0 * z * z - 3.0), 0.0, sign]
        });
        let field = Vec::from_iter(field);
        let mut once = vec![[0.0; 3]; field.len()];
        part.drag(&field, &mut once);
        for axis in [0, 2] {
            let squares = once.iter().zip(&areas);
            let found: f64 = squares.map(|(f, area)| f[axis] * f[axis] / area).sum();
            let sizes = field.iter().zip(&areas);
            let mut exact: f64 = sizes
                .map(|(v, area)| shift * area * v[axis] * v[axis])
                .sum();
            for (&[a, b], value) in mesh.edges().iter().zip(&edges) {
                let step = field[a as usize][axis] - field[b as usize][axis];
                exact -= value * step * step;
            }
            let ratio = (found / (drag * drag * exact)).sqrt();
            // 1.4 % by the spacing of poles, and less than 4 % by the first pole.
            assert!((ratio - 1.0).abs() < 0.05, "axis {axis}: {ratio}");
        }
    }
}
