//! Forces are the negative gradient of the energy, and have neither sum nor torque.

use super::{
    Candidate, ConservativeCandidate, ConservativeLaw, Evaluate, bound, energy, forces, largest,
};
use crate::meshes::{Mesh, SplitMix64, cross, dot, norm};
use crate::tolerance::{self, Tolerance};
use autodiff::F1;
use helfrich::{Conservative, Energy, Finding, Prepared, Surface, TriangleMesh};

/// Forces against fourth-order central differences, relative to the largest force.
const GRADIENT_DIFFERENCE: Tolerance = Tolerance::new(
    1e-6,
    "a step of 1e-4 edges leaves 1e-9 of truncation and 1e-16/1e-4 of rounding, times the roughness; one \
     64 times shorter leaves 1e-10 of rounding",
);

/// Bounds of the net torque for methods that exceed [`BALANCE`], by their names in the law suite.
const TORQUE: &[(&str, Tolerance)] = &[
    (
        "Hamann",
        Tolerance::new(
            1e-10,
            "the torque of a fit vanishes as far as its normal equations are solved: to ε times their \
             condition number, at most 1e6 for accepted fits",
        ),
    ),
    (
        "Galerkin",
        Tolerance::new(1e-12, "as for Hamann's method, with conditions of 1e4"),
    ),
];

/// Bounds for methods that exceed [`tolerance::GRADIENT_DUAL`], by their names in the law suite.
const DUAL: &[(&str, Tolerance)] = &[(
    "Galerkin",
    Tolerance::new(
        1e-11,
        "normal equations of 27 coefficients on meshes of a few dozen vertices lose up to four digits, in \
         other places of the energy and of the force",
    ),
)];

/// Directions in which a gradient is tested: first some single coordinates, then random directions of all
/// vertices.
fn trials(vertices: usize, seed: u64) -> Vec<Vec<[f64; 3]>> {
    let mut random = SplitMix64::new(seed);
    let mut trials = Vec::new();
    for _ in 0..12 {
        let mut direction = vec![[0.0; 3]; vertices];
        direction[random.below(vertices)][random.below(3)] = 1.0;
        trials.push(direction);
    }
    trials.extend((0..4).map(|_| random.directions(vertices)));
    trials
}

/// −F·d, the expected derivative of the energy along d.
fn along(force: &[[f64; 3]], direction: &[[f64; 3]]) -> f64 {
    let work = |(&f, &d): (&[f64; 3], &[f64; 3])| dot(f, d);
    -force.iter().zip(direction).map(work).sum::<f64>()
}

/// Sum of |d| over the vertices. Times the largest force, it bounds |F·d|.
fn extent(direction: &[[f64; 3]]) -> f64 {
    direction.iter().map(|&d| norm(d)).sum()
}

/// Vectors whose derivatives are the directions.
pub fn with_derivatives(vectors: &[[f64; 3]], directions: &[[f64; 3]]) -> Vec<[F1; 3]> {
    let both = vectors.iter().zip(directions);
    both.map(|(x, d)| [0, 1, 2].map(|k| F1::new(x[k], d[k])))
        .collect()
}

/// Forces are the negative derivatives of an energy of the positions, along some directions.
///
/// # Panics
/// If they are not.
pub fn check_work(
    force: &[[f64; 3]],
    positions: &[[f64; 3]],
    bound: Tolerance,
    name: &str,
    mut energy: impl FnMut(&[[F1; 3]]) -> F1,
) {
    let largest = largest(force);
    for direction in trials(positions.len(), 1) {
        let derivative = energy(&with_derivatives(positions, &direction)).dx;
        let scale = largest * extent(&direction);
        bound.assert(along(force, &direction), derivative, scale, name);
    }
}

/// F = −∂E/∂x with the derivative by dual numbers; and force and energy in one evaluation agree with
/// separate evaluations.
#[derive(Clone, Copy, Debug)]
pub struct ForceIsGradient<'a>(pub &'a Mesh);

impl ConservativeLaw for ForceIsGradient<'_> {
    fn check<C: ConservativeCandidate>(&mut self, candidate: C) {
        let mesh = &self.0.connectivity;
        let name = ConservativeCandidate::name(candidate);
        let method = || Prepared::new(ConservativeCandidate::method(candidate, 1.0), mesh);
        let dual = ConservativeCandidate::method(candidate, F1::cst(1.0));
        let mut dual = Prepared::new(dual, mesh);
        self.check_dual(name, &mut method(), &mut |surface| dual.energy(surface));

        let (surface, vertices) = (self.0.surface(), self.0.positions.len());
        let [mut together, mut force] = [(); 2].map(|()| vec![[0.0; 3]; vertices]);
        let sum = method().add_force_and_energy(surface, &mut together);
        method().add_force(surface, &mut force);
        assert_eq!(together, force, "{name}: forces with and without energy");
        let alone = method().energy(surface);
        assert_eq!(sum, alone, "{name}: energy with and without forces");
    }
}

impl ForceIsGradient<'_> {
    fn check_dual(
        &self,
        name: &str,
        method: &mut dyn Evaluate<f64>,
        dual: &mut dyn FnMut(Surface<'_, F1>) -> F1,
    ) {
        let Mesh {
            connectivity: mesh,
            positions,
        } = self.0;
        let mut force = vec![[0.0; 3]; positions.len()];
        method.add_force(self.0.surface(), &mut force);
        let bound = bound(DUAL, name, tolerance::GRADIENT_DUAL);
        check_work(&force, positions, bound, name, |moved| {
            dual(Surface::new(mesh, moved).expect("finite positions"))
        });
    }
}

/// F = −∂E/∂x, the derivative by finite differences with the best of three steps.
#[derive(Clone, Copy, Debug)]
pub struct ForceIsDifference<'a>(pub &'a Mesh);

impl ConservativeLaw for ForceIsDifference<'_> {
    fn check<C: ConservativeCandidate>(&mut self, candidate: C) {
        if candidate.switches_at_right_angles() && self.0.distance_from_right_angle() < 2e-3 {
            return;
        }
        let method = ConservativeCandidate::method(candidate, 1.0);
        let mut method = Prepared::new(method, &self.0.connectivity);
        self.check_method(Candidate::name(candidate), &mut method);
    }
}

impl ForceIsDifference<'_> {
    fn check_method(&self, name: &str, method: &mut dyn Evaluate<f64>) {
        let Mesh {
            connectivity: mesh,
            positions,
        } = self.0;
        // The steps are shorter on rough meshes, because the slope of the energy changes over short distances
        // where a dual area nearly vanishes; and there are shorter ones, because it does so where a fit is
        // hardly determined, too. The difference with a force that is no gradient stays in all of them.
        let longest = 1e-4 * self.0.edge_length() / self.0.roughness();
        let steps = [1.0, 0.125, 1.0 / 64.0].map(|part| part * longest);
        let mut force = vec![[0.0; 3]; positions.len()];
        method.add_force(self.0.surface(), &mut force);
        // A point on a jet that is no graph stays where it is: the energy jumps there, and says so.
        let mut jumps = false;
        method.inspect(self.0.surface(), &mut |finding| {
            jumps |= matches!(finding, Finding::NoGraph { .. });
        });
        if jumps {
            return;
        }
        let largest = largest(&force);
        for direction in trials(positions.len(), 2) {
            let mut at = |distance: f64| {
                let moved = positions.iter().zip(&direction);
                let moved = moved.map(|(x, d)| [0, 1, 2].map(|k| x[k] + distance * d[k]));
                let moved = Vec::from_iter(moved);
                method.energy(Surface::new(mesh, &moved).expect("finite positions"))
            };
            let found = along(&force, &direction);
            let scale = largest * extent(&direction);
            let mut nearest = f64::INFINITY;
            for step in steps {
                let near = at(step) - at(-step);
                let far = at(2.0 * step) - at(-2.0 * step);
                let derivative = (8.0 * near - far) / (12.0 * step);
                if (derivative - found).abs() < (nearest - found).abs() {
                    nearest = derivative;
                }
                if (nearest - found).abs() <= GRADIENT_DIFFERENCE.value * scale {
                    break;
                }
            }
            GRADIENT_DIFFERENCE.assert(found, nearest, scale, name);
        }
    }
}

/// Σ F = 0 and Σ x × F = 0.
#[derive(Clone, Copy, Debug)]
pub struct Balanced<'a>(pub &'a Mesh);

impl ConservativeLaw for Balanced<'_> {
    fn check<C: ConservativeCandidate>(&mut self, candidate: C) {
        let Mesh {
            connectivity: mesh,
            positions,
        } = self.0;
        let name = ConservativeCandidate::name(candidate);
        let method = ConservativeCandidate::method(candidate, 1.0);
        let (net, torque) = imbalance(positions, &forces(method, mesh, positions));
        tolerance::BALANCE.assert(net, 0.0, 1.0, &format!("{name}: Σ F"));
        let bound = bound(TORQUE, name, tolerance::BALANCE);
        bound.assert(torque, 0.0, 1.0, &format!("{name}: Σ x × F"));
    }
}

/// Forces are the negative derivatives of the energy with respect to every coordinate, by dual numbers
/// and, for some coordinates, by central differences; they have neither sum nor torque. `dual` is the
/// same method with dual numbers.
///
/// # Panics
/// If a law is broken.
pub fn check_gradient<M, D>(method: &M, dual: D, mesh: &TriangleMesh, positions: &[[f64; 3]])
where
    M: Conservative<f64> + Clone,
    D: Energy<F1>,
{
    let force = forces(method.clone(), mesh, positions);
    assert!(energy(method.clone(), mesh, positions).is_finite());
    let largest = largest(&force);

    let mut dual = Prepared::new(dual, mesh);
    let constant = |x: &[f64; 3]| x.map(F1::cst);
    let mut variable: Vec<[F1; 3]> = positions.iter().map(constant).collect();
    let mut moved = positions.to_vec();
    for vertex in 0..positions.len() {
        for axis in 0..3 {
            let x = positions[vertex][axis];
            variable[vertex][axis] = F1::var(x);
            let surface = Surface::new(mesh, &variable).expect("finite positions");
            let derivative = dual.energy(surface).deriv();
            variable[vertex][axis] = F1::cst(x);
            let found = force[vertex][axis];
            tolerance::GRADIENT_DUAL.assert(found, -derivative, largest, "force");
            if vertex % 7 == 0 {
                let mut at = |x: f64| {
                    moved[vertex][axis] = x;
                    energy(method.clone(), mesh, &moved)
                };
                let step = 1e-5;
                let difference = (at(x + step) - at(x - step)) / (2.0 * step);
                at(x);
                GRADIENT_DIFFERENCE.assert(found, -difference, largest, "force");
            }
        }
    }
    let [sum, torque] = net(&force, positions);
    for axis in 0..3 {
        tolerance::NO_NET_FORCE.assert(sum[axis], 0.0, largest, "net force");
        tolerance::NO_NET_FORCE.assert(torque[axis], 0.0, largest, "net torque");
    }
}

/// Σ F and Σ x × F.
pub fn net(force: &[[f64; 3]], positions: &[[f64; 3]]) -> [[f64; 3]; 2] {
    let mut sums = [[0.0; 3]; 2];
    for (&f, &x) in force.iter().zip(positions) {
        let torque = cross(x, f);
        for axis in 0..3 {
            sums[0][axis] += f[axis];
            sums[1][axis] += torque[axis];
        }
    }
    sums
}

/// |Σ F| / Σ |F| and |Σ x × F| / Σ |x||F|.
pub fn imbalance(positions: &[[f64; 3]], force: &[[f64; 3]]) -> (f64, f64) {
    let mut scales = [f64::MIN_POSITIVE; 2];
    for (&x, &f) in positions.iter().zip(force) {
        scales[0] += norm(f);
        scales[1] += norm(x) * norm(f);
    }
    let [sum, torque] = net(force, positions);
    (norm(sum) / scales[0], norm(torque) / scales[1])
}
