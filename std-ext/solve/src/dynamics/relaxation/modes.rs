//! Normal modes of an equilibrium.
//!
//! For displacements u along the directions in which vertices are free to move, the energy of an equilibrium changes by
//! `½ uᵀHu`, with H the second derivatives of `E − Σ λ C` at the multipliers λ of the constraints C. Modes
//! solve `H u = μ M u`, with M the areas of the vertices, among the displacements that keep the constrained
//! values. H is never stored: its products are central differences of gradients.

use super::point::{RelaxationPoint, SPHERE};
use super::{Failure, Relaxation, SetupError};
use crate::dynamics::lobpcg::{Goal, Operator, Pair, smallest};
use crate::dynamics::multipliers::multipliers;
use crate::dynamics::place::reciprocal_or_zero;
use crate::dynamics::vector::{self, Vector};
use crate::dynamics::{Membrane, Problem, Settings};
use helfrich::Components;
use serde::Serialize;

/// A mode of a membrane in equilibrium.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mode {
    /// μ: the force per area that resists the mode, per displacement, in units of energy over length⁴. The
    /// equilibrium is unstable if any is below 0.
    pub stiffness: f64,
    /// Bound of the numerical error of μ: some eigenvalue of H is no farther away.
    pub residual: f64,
    /// The part of the squared displacement, from 0 to 1, that is a rigid motion of a body.
    pub rigid: f64,
}

impl Mode {
    /// Whether the mode is mostly a rigid motion, so that its stiffness says nothing about the stability of the
    /// shape. On a fluid membrane it need not be 0: tangential forces, which are errors of
    /// the discretisation, do work in a rigid motion of second order.
    pub fn is_rigid(&self) -> bool {
        self.rigid > 0.5
    }
}

/// Reason why modes cannot be found.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModesError {
    /// The forces are not the gradient of an energy, so that their derivatives need not be symmetric.
    #[error("modes need an energy, and the forces have none")]
    NoEnergy,
    /// On this shape the gradient of a constraint is a combination of those of the others, so that no displacement
    /// keeps all values to second order.
    #[error(
        "constraint {constraint} depends on the others on this shape, as area and volume do on a sphere: no \
         other shape near it has these values, and there are no modes; leave one constraint out"
    )]
    Dependent {
        /// The constraint, counted from 0.
        constraint: usize,
    },
    /// The membranes cannot be relaxed.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// Forces at the equilibrium or next to it cannot be evaluated.
    #[error(transparent)]
    Failure(#[from] Failure),
}

/// Displacements of difference quotients, root mean square, in mean edges. Larger ones leave errors of truncation in
/// the shortest waves, which hide the longest: at 1e-4 some modes do not converge.
const DISPLACEMENT: f64 = 1e-6;

/// The largest residual of a mode, in units of κ/R⁴ + K/R². The error of a separate eigenvalue is of its square.
const RESIDUAL: f64 = 1e-3;

/// The largest number of iterations.
const ITERATIONS: usize = 100;

/// The fraction of a rigid motion that has to be along free directions, as those of a sphere's rotations are not.
const LEAST_FREE: f64 = 0.05;

/// The modes of least stiffness of membranes in equilibrium, by rising stiffness; fewer than `count` if there are fewer
/// degrees of freedom. `positions` have to satisfy the constraints.
///
/// # Errors
/// If the problem has no energy, constraints depend on each other, the membranes cannot be relaxed, or forces are
/// not finite.
pub fn modes(
    membranes: Vec<Membrane>,
    positions: Vec<Vector>,
    problem: &mut dyn Problem,
    count: usize,
) -> Result<Vec<Mode>, ModesError> {
    if !problem.is_conservative() {
        return Err(ModesError::NoEnergy);
    }
    let mut relaxation = Relaxation::new(membranes, positions.clone(), Settings::default())?;
    let here = relaxation.evaluate(problem, positions, false);
    let here = here.map_err(|(failure, _)| failure)?;
    relaxation.refresh_preconditioners(&here.positions);
    let mut stiffness = Stiffness::new(relaxation, problem, here)?;
    // The last ones of a block converge slowly.
    let width = count + 4 + count / 4;
    let start = (0..width).map(|k| stiffness.start(k as u64)).collect();
    let goal = Goal {
        count,
        residual: RESIDUAL * stiffness.scale(),
        iterations: ITERATIONS,
    };
    let pairs = smallest(&mut stiffness, start, goal)?;
    let rigid = stiffness.rigid_motions();
    let mode = |pair: Pair| {
        let parts = rigid
            .iter()
            .map(|motion| stiffness.inner(motion, &pair.vector).powi(2));
        Mode {
            stiffness: pair.value,
            residual: pair.residual,
            rigid: parts.sum::<f64>().min(1.0),
        }
    };
    Ok(pairs.into_iter().map(mode).collect())
}

/// The operator H on the numbers of a frame.
struct Stiffness<'a> {
    relaxation: Relaxation,
    problem: &'a mut dyn Problem,
    here: RelaxationPoint,
    /// λ of each constraint and group.
    multipliers: Vec<Vec<f64>>,
    /// The area of each number's vertex.
    mass: Vec<f64>,
}

impl<'a> Stiffness<'a> {
    fn new(
        relaxation: Relaxation,
        problem: &'a mut dyn Problem,
        here: RelaxationPoint,
    ) -> Result<Self, ModesError> {
        let areas = &here.coordinates.areas;
        let mut mass = Vec::new();
        for place in &relaxation.places {
            let own = areas[place.vertices()].iter();
            mass.extend(own.flat_map(|area| std::iter::repeat_n(*area, place.width)));
        }
        let mut stiffness = Self {
            relaxation,
            problem,
            here,
            multipliers: Vec::new(),
            mass,
        };
        stiffness.multipliers = stiffness.balance()?;
        Ok(stiffness)
    }

    /// The multipliers with which constraints balance the forces.
    fn balance(&mut self) -> Result<Vec<Vec<f64>>, ModesError> {
        let count = self.problem.constraint_count();
        if count == 0 {
            return Ok(Vec::new());
        }
        let positions = &self.here.positions;
        let mut force = vec![[0.0; 3]; positions.len()];
        self.problem.evaluate(positions, &mut force);
        let mut gradients = vec![vec![[0.0; 3]; positions.len()]; count];
        self.problem.constraint_gradients(positions, &mut gradients);
        let Relaxation { frame, places, .. } = &self.relaxation;
        let reduce = |field: &Vec<Vector>| frame.reduce(places, positions, field);
        let force: Vec<f64> = reduce(&force).iter().map(|entry| -entry).collect();
        let gradients: Vec<_> = gradients.iter().map(reduce).collect();
        // The group of each number.
        let mut owners = Vec::new();
        for place in places {
            let own = self.problem.groups()[place.vertices()].iter();
            owners.extend(own.flat_map(|group| std::iter::repeat_n(*group, place.width)));
        }
        let groups = owners.iter().max().map_or(0, |&last| last + 1);
        let mut found = vec![Vec::new(); count];
        for group in 0..groups {
            let dot = |a: &[f64], b: &[f64]| {
                let terms = a.iter().zip(b).zip(&self.mass).zip(&owners);
                let own = terms.filter(|(_, owner)| **owner == group);
                own.map(|(((a, b), area), _)| a * b * reciprocal_or_zero(*area))
                    .sum::<f64>()
            };
            let all = self.problem.groups().iter();
            let vertices = all.filter(|own| **own == group).count();
            let multipliers = multipliers(&gradients, &force, vertices, dot);
            for (constraint, (found, multiplier)) in found.iter_mut().zip(multipliers).enumerate() {
                found.push(multiplier.ok_or(ModesError::Dependent { constraint })?);
            }
        }
        Ok(found)
    }

    /// The gradient of `E − Σ λ C`.
    fn gradient(&mut self, positions: &[Vector]) -> Result<Vec<Vector>, Failure> {
        let mut force = vec![[0.0; 3]; positions.len()];
        self.problem.evaluate(positions, &mut force);
        if let Some(failure) = self.relaxation.not_finite(&force) {
            return Err(failure);
        }
        let mut gradients = vec![vec![[0.0; 3]; positions.len()]; self.multipliers.len()];
        if !gradients.is_empty() {
            self.problem.constraint_gradients(positions, &mut gradients);
        }
        let groups = self.problem.groups();
        let mut sum: Vec<Vector> = force
            .iter()
            .map(|force| vector::scale(-1.0, *force))
            .collect();
        for (multipliers, gradient) in self.multipliers.iter().zip(&gradients) {
            for ((sum, entry), group) in sum.iter_mut().zip(gradient).zip(groups) {
                *sum = vector::sub(*sum, vector::scale(multipliers[*group as usize], *entry));
            }
        }
        Ok(sum)
    }

    /// The stiffness of the longest waves, κ/R⁴ + K/R²; the largest among the membranes.
    fn scale(&self) -> f64 {
        let relaxation = &self.relaxation;
        let parts = relaxation.membranes.iter().zip(&relaxation.places);
        let stiffnesses = parts.map(|(membrane, place)| {
            let areas = &self.here.coordinates.areas[place.vertices()];
            let shift = SPHERE / areas.iter().sum::<f64>();
            shift * (membrane.bending_modulus * shift + membrane.in_plane_modulus)
        });
        stiffnesses.fold(0.0, f64::max)
    }

    fn inner(&self, a: &[f64], b: &[f64]) -> f64 {
        let terms = a.iter().zip(b).zip(&self.mass);
        terms.map(|((a, b), mass)| mass * a * b).sum()
    }

    /// A smooth vector that is the same in every run.
    fn start(&mut self, seed: u64) -> Vec<f64> {
        let noise = |number: usize| {
            // SplitMix64: G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014.
            let mut state = (number as u64 + (seed << 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            state = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            state = (state ^ (state >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((state ^ (state >> 31)) >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let forces = (0..self.mass.len()).map(|number| self.mass[number] * noise(number));
        let forces = forces.collect();
        self.precondition(forces)
    }

    /// The rigid motions of each body that has no fixed vertex, as far as they are free, orthonormal.
    fn rigid_motions(&self) -> Vec<Vec<f64>> {
        let Relaxation {
            frame,
            places,
            membranes,
            ..
        } = &self.relaxation;
        let positions = &self.here.positions;
        let mut motions: Vec<Vec<f64>> = Vec::new();
        for (membrane, place) in membranes.iter().zip(places) {
            if membrane.has_support() {
                continue;
            }
            let components = Components::new(&membrane.mesh);
            for component in 0..components.count() as u32 {
                let own = |k: usize| components.of_vertex()[k] == component;
                let vertices = || place.vertices().enumerate().filter(|(k, _)| own(*k));
                let count = vertices().count();
                let sum = vertices().fold([0.0; 3], |sum, (_, v)| vector::add(sum, positions[v]));
                let centre = vector::scale((count as f64).recip(), sum);
                for motion in 0..6 {
                    let mut axis = [0.0; 3];
                    axis[motion % 3] = 1.0;
                    let mut numbers = vec![0.0; self.mass.len()];
                    let mut whole = 0.0;
                    for (k, vertex) in vertices() {
                        let arm = vector::sub(positions[vertex], centre);
                        let moved = if motion < 3 {
                            axis
                        } else {
                            vector::cross(axis, arm)
                        };
                        let first = place.first_number + place.width * k;
                        whole += self.here.coordinates.areas[vertex] * vector::dot(moved, moved);
                        if place.width == 1 {
                            numbers[first] = vector::dot(moved, frame.directions()[vertex]);
                        } else {
                            numbers[first..first + 3].copy_from_slice(&moved);
                        }
                    }
                    frame.restrict(places, &mut numbers);
                    for _ in 0..2 {
                        for other in &motions {
                            let part = self.inner(other, &numbers);
                            vector::add_scaled(&mut numbers, -part, other);
                        }
                    }
                    let size = self.inner(&numbers, &numbers);
                    if size > LEAST_FREE * LEAST_FREE * whole {
                        numbers.iter_mut().for_each(|entry| *entry /= size.sqrt());
                        motions.push(numbers);
                    }
                }
            }
        }
        motions
    }
}

impl Operator for Stiffness<'_> {
    type Error = Failure;

    fn apply(&mut self, numbers: &[f64]) -> Result<Vec<f64>, Failure> {
        let Relaxation { frame, places, .. } = &self.relaxation;
        let displacement = frame.expand(places, &self.here.positions, numbers);
        let squares: f64 = displacement.iter().map(|d| vector::dot(*d, *d)).sum();
        if squares == 0.0 {
            return Ok(vec![0.0; numbers.len()]);
        }
        let area: f64 = self.here.coordinates.areas.iter().sum();
        // Sums over vertices of squared displacements and of squared edges.
        let step = DISPLACEMENT * (area / squares).sqrt();
        let moved = |step: f64| -> Vec<Vector> {
            let pairs = self.here.positions.iter().zip(&displacement);
            pairs
                .map(|(x, d)| vector::add(*x, vector::scale(step, *d)))
                .collect()
        };
        let [ahead, behind] = [moved(step), moved(-step)];
        let [ahead, behind] = [self.gradient(&ahead)?, self.gradient(&behind)?];
        let rises = ahead.iter().zip(&behind);
        let over = (2.0 * step).recip();
        let rises: Vec<_> = rises
            .map(|(a, b)| vector::scale(over, vector::sub(*a, *b)))
            .collect();
        let Relaxation { frame, places, .. } = &self.relaxation;
        let mut image = frame.reduce(places, &self.here.positions, &rises);
        let groups = self.problem.groups();
        self.here.coordinates.take_out(places, groups, &mut image);
        Ok(image)
    }

    fn precondition(&mut self, residual: Vec<f64>) -> Vec<f64> {
        let problem = &*self.problem;
        let mut found = self
            .relaxation
            .preconditioned(problem, &self.here, &residual);
        for (entry, mass) in found.iter_mut().zip(&self.mass) {
            if *mass <= 0.0 {
                *entry = 0.0;
            }
        }
        found
    }

    fn mass(&self) -> &[f64] {
        &self.mass
    }
}

#[cfg(test)]
mod tests {
    use super::{Mode, ModesError, modes};
    use crate::dynamics::{Evaluation, Held, Membrane, Motion, Problem};
    use helfrich::{
        AnyFunctional, Constraint, Constraints, LoopSubdivision, Prepared, Surface, SurfaceTension,
        TriangleMesh,
    };
    use helfrich_mesh::generate::{AnyShape, Family, generate};
    use std::sync::Arc;

    /// A membrane with bending and tension, and possibly a given volume.
    struct Sphere {
        mesh: Arc<TriangleMesh>,
        effects: Prepared<f64, (LoopSubdivision<f64>, SurfaceTension<f64>)>,
        held: Held,
        conservative: bool,
    }

    impl Problem for Sphere {
        fn is_conservative(&self) -> bool {
            self.conservative
        }

        fn evaluate(&mut self, positions: &[[f64; 3]], force: &mut [[f64; 3]]) -> Evaluation {
            force.fill([0.0; 3]);
            let surface = Surface::new(&self.mesh, positions).expect("finite");
            Evaluation::new(self.effects.add_force_and_energy(surface, force))
        }

        fn constraint_count(&self) -> usize {
            self.held.count()
        }

        fn groups(&self) -> &[u32] {
            self.held.groups()
        }

        fn constraint_gradients(
            &mut self,
            positions: &[[f64; 3]],
            gradients: &mut [Vec<[f64; 3]>],
        ) {
            for (index, gradient) in gradients.iter_mut().enumerate() {
                self.held.gradient(index, positions, gradient);
            }
        }
    }

    impl Sphere {
        fn membrane(&self) -> Membrane {
            Membrane {
                mesh: Arc::clone(&self.mesh),
                bending_modulus: 1.0,
                in_plane_modulus: 0.0,
                motion: Motion::AlongNormals,
                fixed: Vec::new(),
            }
        }
    }

    fn sphere(radius: f64, tension: f64, held: &[AnyFunctional]) -> (Sphere, Vec<[f64; 3]>) {
        let shape: AnyShape = format!("sphere:{radius}").parse().expect("a shape");
        let sphere = generate(&shape, Family::Regular, 642, 0).expect("a mesh");
        let mesh = Arc::new(sphere.mesh);
        let hold = |&functional: &AnyFunctional| Constraint {
            functional,
            targets: 1.0.into(),
        };
        let constraints = Constraints {
            constraints: held.iter().map(hold).collect(),
        };
        let effects = (LoopSubdivision::new(1.0), SurfaceTension::new(tension));
        let problem = Sphere {
            effects: Prepared::new(effects, &mesh),
            held: Held::new(Arc::clone(&mesh), constraints),
            mesh,
            conservative: true,
        };
        (problem, sphere.positions)
    }

    fn of_sphere(radius: f64, tension: f64, held: &[AnyFunctional], count: usize) -> Vec<Mode> {
        let (mut problem, positions) = sphere(radius, tension, held);
        let membranes = vec![problem.membrane()];
        modes(membranes, positions, &mut problem, count).expect("modes")
    }

    /// μ of a sphere for displacements by a harmonic of degree l: W. Helfrich, J. Phys. France 47 (1986) 321, with
    /// the pressure 2σ/R.
    fn expected(l: f64, radius: f64, tension: f64) -> f64 {
        let bending = l * (l + 1.0) + tension * radius * radius;
        (l - 1.0) * (l + 2.0) * bending / radius.powi(4)
    }

    /// The error of S and of the area of flat triangles on 642 vertices, which grows with the degree.
    const ERROR: f64 = 2e-2;

    #[test]
    fn spheres_have_the_modes_of_theory() {
        for (radius, tension) in [(1.0, 0.0), (2.0, 5.0), (0.5, 30.0)] {
            let found = of_sphere(radius, tension, &[AnyFunctional::Volume], 24);
            assert_eq!(found.len(), 24);
            let mut rest = found.iter();
            for l in 1..=4_usize {
                let theory = expected(l as f64, radius, tension);
                for mode in rest.by_ref().take(2 * l + 1) {
                    let scale = expected(2.0, radius, tension).max(theory);
                    let error = (mode.stiffness - theory).abs() / scale;
                    assert!(error < ERROR, "l = {l}: {mode:?} {theory}");
                    // Translations are the rigid motions of a sphere that are not along it.
                    let rigid = if l == 1 { 1.0 } else { 0.0 };
                    assert!((mode.rigid - rigid).abs() < 1e-3, "l = {l}: {mode:?}");
                    assert!(mode.residual < 1e-2 * scale, "l = {l}: {mode:?}");
                }
            }
        }
    }

    /// Without a given volume and without the pressure that the tension needs, a sphere of bending alone has the
    /// same energy at any radius: one more mode without stiffness, which is no rigid motion.
    #[test]
    fn a_mode_without_stiffness_is_told_from_a_rigid_motion() {
        let found = of_sphere(1.0, 0.0, &[], 9);
        let soft: Vec<_> = found
            .iter()
            .filter(|mode| mode.stiffness < ERROR * 24.0)
            .collect();
        assert_eq!(soft.len(), 4, "{found:?}");
        let rigid = found.iter().filter(|mode| mode.is_rigid()).count();
        assert_eq!(rigid, 3, "{found:?}");
    }

    /// No shape near a sphere has its area and its volume.
    #[test]
    fn a_sphere_of_given_area_and_volume_has_no_modes() {
        let held = [AnyFunctional::Area, AnyFunctional::Volume];
        let (mut problem, positions) = sphere(1.0, 0.0, &held);
        let membranes = vec![problem.membrane()];
        let found = modes(membranes, positions, &mut problem, 3);
        assert_eq!(found, Err(ModesError::Dependent { constraint: 1 }));
    }

    #[test]
    fn forces_without_an_energy_have_no_modes() {
        let (mut problem, positions) = sphere(1.0, 0.0, &[]);
        problem.conservative = false;
        let membranes = vec![problem.membrane()];
        let found = modes(membranes, positions, &mut problem, 3);
        assert_eq!(found, Err(ModesError::NoEnergy));
    }
}
