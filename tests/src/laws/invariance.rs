//! Energies and forces of a surface that is translated, rotated, relabelled or scaled.

use super::{Candidate, FEWEST_VERTICES, Law, Subject, bound, largest};
use crate::meshes::{Mesh, SplitMix64, difference, norm, rotation, turned};
use crate::tolerance::{self, Tolerance};
use helfrich::Real;

/// Bound for rotation and relabelling of methods that fit polynomials, also on meshes of a few vertices.
const FIT_INVARIANCE: Tolerance = Tolerance::new(
    1e-8,
    "the worst accepted fits have a condition number of 1/√ε = 7e7, which multiplies the rounding of \
     positions of 1e-16",
);

/// Bound for scaling in f32, relative to the largest force times the mesh's roughness.
const INVARIANCE_SINGLE: Tolerance = Tolerance::new(5e-3, "as in f64, from a rounding of 6e-8");

/// Bounds of methods that exceed [`tolerance::INVARIANCE`], by their names in the law suite.
const ROUNDING: &[(&str, Tolerance)] = &[
    (
        "Hamann",
        Tolerance::new(
            1e-10,
            "normal equations multiply the rounding of positions, 1e-16, by up to 1e6 in accepted fits",
        ),
    ),
    (
        "Galerkin",
        Tolerance::new(
            1e-9,
            "as for Hamann's method, and the points of the patches multiply it by another ten",
        ),
    ),
];

/// Bounds of methods that exceed [`INVARIANCE_SINGLE`], by their names in the law suite.
const ROUNDING_SINGLE: &[(&str, Tolerance)] = &[
    (
        "Hamann",
        Tolerance::new(0.05, "as in f64, from a rounding of 6e-8"),
    ),
    (
        "Galerkin",
        Tolerance::new(0.2, "as in f64, from a rounding of 6e-8"),
    ),
];

/// Rotation, translation and relabelling of the surface leave the energy unchanged and transform the forces
/// likewise.
#[derive(Clone, Copy, Debug)]
pub struct Invariant<'a> {
    /// The surface.
    pub mesh: &'a Mesh,
    /// Seed of the motion.
    pub seed: u64,
}

impl Law for Invariant<'_> {
    fn check<C: Candidate>(&mut self, candidate: C) {
        let chooses = candidate.chooses_by_threshold();
        let turns = !chooses || self.mesh.positions.len() >= FEWEST_VERTICES;
        let rounding = bound(ROUNDING, candidate.name(), tolerance::INVARIANCE);
        self.check_within(&candidate, turns.then_some(rounding));
    }
}

/// [`Invariant`] for the methods that choose by thresholds, on a mesh of any size. The mesh must not have two
/// vertices that are equally far from a third one, to six digits, and of which only one is its neighbour: the
/// vertex numbers decide which one.
#[derive(Clone, Copy, Debug)]
pub struct InvariantFits<'a>(pub Invariant<'a>);

impl Law for InvariantFits<'_> {
    fn check<C: Candidate>(&mut self, candidate: C) {
        if candidate.chooses_by_threshold() {
            self.0.check_within(&candidate, Some(FIT_INVARIANCE));
        }
    }
}

impl Invariant<'_> {
    /// Checks translations to the last bit, and rotations and relabelling within `rounding`, if it is given.
    fn check_within(&self, candidate: &dyn Subject<f64>, rounding: Option<tolerance::Tolerance>) {
        let mut random = SplitMix64::new(self.seed);
        // Positions on a grid, so that a move by a multiple of the grid's pitch is not rounded.
        let pitch = 2.0_f64.powi(-40);
        let mesh = &self.mesh.map(|x| x.map(|x| (x / pitch).round() * pitch));
        let evaluate = |mesh: &Mesh| {
            let force = candidate.forces(1.0, &mesh.connectivity, &mesh.positions);
            let energy = candidate.energy(1.0, &mesh.connectivity, &mesh.positions);
            (force, energy)
        };
        let name = candidate.name();
        let (force, energy) = evaluate(mesh);
        let scale = largest(&force) * mesh.roughness();
        let energy_scale = energy.abs() + scale;
        let moved = evaluate(&mesh.map(|x| [x[0] + 5.0, x[1] - 2.25, x[2] + 0.125]));
        assert!(
            (&force, energy) == (&moved.0, moved.1),
            "{name}: translation changes a bit"
        );

        let Some(rounding) = rounding else {
            return;
        };
        let compare = |found: &[[f64; 3]], expected: &[[f64; 3]], what: &str| {
            for (found, expected) in found.iter().zip(expected) {
                let error = norm(difference(*found, *expected));
                rounding.assert(error, 0.0, scale, &format!("{name}: force, {what}"));
            }
        };
        let quaternion = [0; 4].map(|_| random.symmetric());
        let turn = rotation(quaternion);
        let (turned_force, turned_energy) = evaluate(&mesh.map(|x| turned(turn, x)));
        let expected = Vec::from_iter(force.iter().map(|&f| turned(turn, f)));
        compare(&turned_force, &expected, "rotation");
        let what = format!("{name}: energy, rotation");
        rounding.assert(turned_energy, energy, energy_scale, &what);

        let (relabelled, new_number) = mesh.relabelled(random.bits());
        let (relabelled_force, relabelled_energy) = evaluate(&relabelled);
        let expected = Vec::from_iter(new_number.iter().map(|&new| relabelled_force[new]));
        compare(&expected, &force, "relabelling");
        let what = format!("{name}: energy, relabelling");
        rounding.assert(relabelled_energy, energy, energy_scale, &what);
    }
}

/// E(s x) = E(x), F(s x) = F(x)/s, and both are proportional to κ; to the last bit where s and κ
/// are powers of two, to rounding otherwise.
#[derive(Clone, Copy, Debug)]
pub struct ScaleFree<'a> {
    /// The surface.
    pub mesh: &'a Mesh,
    /// s.
    pub scale: f64,
    /// κ.
    pub modulus: f64,
}

impl ScaleFree<'_> {
    /// Checks the law in the scalar `T`.
    pub fn check_in<T: Real>(&self, candidate: &dyn Subject<T>, rounding: tolerance::Tolerance) {
        let name = candidate.name();
        let connectivity = &self.mesh.connectivity;
        let positions = self.mesh.positions_in::<T>();
        let (scale, modulus) = (T::constant(self.scale), T::constant(self.modulus));
        let scaled = Vec::from_iter(positions.iter().map(|x| x.map(|x| x * scale)));
        let energy_pair = [
            candidate.energy(modulus, connectivity, &scaled),
            modulus * candidate.energy(T::one(), connectivity, &positions),
        ];
        let force_pair = [
            candidate.forces(modulus, connectivity, &scaled),
            candidate.forces(T::one(), connectivity, &positions),
        ];
        let expected = |f: T| f * (modulus / scale);
        let is_power_of_two = |x: f64| x.log2().fract() == 0.0;
        let what = format!("{name}, s = {:e}, κ = {:e}", self.scale, self.modulus);
        if is_power_of_two(self.scale) && is_power_of_two(self.modulus) {
            assert_eq!(energy_pair[0], energy_pair[1], "energy, {what}");
            for (found, &unscaled) in force_pair[0].iter().zip(&force_pair[1]) {
                assert_eq!(*found, unscaled.map(expected), "force, {what}");
            }
        } else if !candidate.chooses_by_threshold() || positions.len() >= FEWEST_VERTICES {
            let double = |x: T| x.to_f64().unwrap_or(f64::NAN);
            // The comparison is in double precision and divides by κ/s, so that it cannot underflow itself.
            let unscaled = Vec::from_iter(force_pair[1].iter().map(|f| f.map(double)));
            let force_scale = largest(&unscaled) * self.mesh.roughness();
            for (found, wanted) in force_pair[0].iter().zip(unscaled) {
                let found = found.map(|f| double(f) * self.scale / self.modulus);
                let error = norm(difference(found, wanted));
                rounding.assert(error, 0.0, force_scale, &format!("force, {what}"));
            }
            let [found, wanted] = energy_pair.map(|e| double(e) / self.modulus);
            let energy_scale = wanted.abs() + force_scale;
            rounding.assert(found, wanted, energy_scale, &format!("energy, {what}"));
        }
    }
}

impl Law for ScaleFree<'_> {
    fn check<C: Candidate>(&mut self, candidate: C) {
        let rounding = bound(ROUNDING, candidate.name(), tolerance::INVARIANCE);
        self.check_in::<f64>(&candidate, rounding);
    }
}

/// [`ScaleFree`] in f32.
#[derive(Clone, Copy, Debug)]
pub struct ScaleFreeSingle<'a>(pub ScaleFree<'a>);

impl Law for ScaleFreeSingle<'_> {
    fn check<C: Candidate>(&mut self, candidate: C) {
        // Mixed areas change their formula at right angles, and rounding decides on which side an
        // angle lies.
        if self.0.mesh.distance_from_right_angle() < 1e-4 {
            return;
        }
        let rounding = bound(ROUNDING_SINGLE, candidate.name(), INVARIANCE_SINGLE);
        self.0.check_in::<f32>(&candidate, rounding);
    }
}
