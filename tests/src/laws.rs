//! The laws of the traits, each written once and run over every implementation.
//!
//! A method enters the suite by one line in [`for_each`] or [`for_each_conservative`], an operator
//! by one in [`for_each_operator`]; [`covered_modules`] is what the coverage tests compare with
//! the files of the library.

use crate::meshes::{Mesh, SplitMix64, cross, difference, dot, norm, rotation, turned};
use crate::tolerance;
use autodiff::F1;
use helfrich::{
    Conservative, ControlPoints, Cotangent, Curvature, DualArea, Energy, Finding, Force,
    GompperKroll, HeatKernel, Jet, Juelicher, KantorNelson, LaplaceBeltrami, LoopSubdivision,
    Method, Paraboloid, Prepared, Real, Rows, Serial, StrongForm, Surface, TriangleMesh,
    VertexKind,
};

/// A bending method, to be made for any scalar.
pub trait Candidate: Copy {
    /// The method for the scalar T.
    type Method<T: Real>: Energy<T> + Force<T>;
    /// What failures call it.
    fn name(self) -> &'static str;
    /// The library's files whose formulas it runs.
    fn modules(self) -> &'static [&'static str];
    /// The method with this bending modulus.
    fn method<T: Real>(self, modulus: T) -> Self::Method<T>;
    /// Whether neighbours or degrees are chosen by thresholds: at one, rounding decides, and on a
    /// coarse mesh some vertex always is at one.
    fn chooses_by_threshold(self) -> bool {
        false
    }
}

/// A bending method whose force is the gradient of its energy, to be made for any scalar.
pub trait ConservativeCandidate: Copy {
    /// The method for the scalar T.
    type ConservativeMethod<T: Real>: Conservative<T>;
    /// See [`Candidate::name`].
    fn name(self) -> &'static str;
    /// See [`Candidate::modules`].
    fn modules(self) -> &'static [&'static str];
    /// See [`Candidate::method`].
    fn method<T: Real>(self, modulus: T) -> Self::ConservativeMethod<T>;
    /// Whether the formula changes at right angles, so that finite differences must stay away.
    fn switches_at_right_angles(self) -> bool {
        false
    }
}

impl<C: ConservativeCandidate> Candidate for C {
    type Method<T: Real> = C::ConservativeMethod<T>;
    fn name(self) -> &'static str {
        ConservativeCandidate::name(self)
    }
    fn modules(self) -> &'static [&'static str] {
        ConservativeCandidate::modules(self)
    }
    fn method<T: Real>(self, modulus: T) -> Self::Method<T> {
        ConservativeCandidate::method(self, modulus)
    }
}

/// Method A with each of its calibrations.
#[derive(Clone, Copy, Debug)]
pub enum Hinged {
    /// `k̃ = 2κ/√3`.
    Forces,
    /// `k̃ = √3 κ`.
    OppositeGaussianModulus,
    /// `k̃ = 2√3 κ`.
    SphereEnergy,
}

impl ConservativeCandidate for Hinged {
    type ConservativeMethod<T: Real> = KantorNelson<T>;
    fn name(self) -> &'static str {
        match self {
            Self::Forces => "Kantor-Nelson",
            Self::OppositeGaussianModulus => "Kantor-Nelson, opposite Gaussian modulus",
            Self::SphereEnergy => "Kantor-Nelson, sphere energy",
        }
    }
    fn modules(self) -> &'static [&'static str] {
        &["hinge", "kantor_nelson"]
    }
    fn method<T: Real>(self, modulus: T) -> KantorNelson<T> {
        match self {
            Self::Forces => KantorNelson::new(modulus),
            Self::OppositeGaussianModulus => KantorNelson::with_opposite_gaussian_modulus(modulus),
            Self::SphereEnergy => KantorNelson::with_sphere_energy(modulus),
        }
    }
}

/// Method B with each kind of area.
#[derive(Clone, Copy, Debug)]
pub struct SquaredLaplacian(pub DualArea);

impl ConservativeCandidate for SquaredLaplacian {
    type ConservativeMethod<T: Real> = GompperKroll<T>;
    fn name(self) -> &'static str {
        match self.0 {
            DualArea::Voronoi => "Gompper-Kroll",
            DualArea::Mixed => "Gompper-Kroll, mixed areas",
            DualArea::Barycentric => "Gompper-Kroll, barycentric areas",
        }
    }
    fn modules(self) -> &'static [&'static str] {
        &["gompper_kroll"]
    }
    fn method<T: Real>(self, modulus: T) -> GompperKroll<T> {
        let area = self.0;
        GompperKroll {
            area,
            ..GompperKroll::new(modulus)
        }
    }
    fn switches_at_right_angles(self) -> bool {
        self.0 == DualArea::Mixed
    }
}

/// Jülicher's method.
#[derive(Clone, Copy, Debug)]
pub struct LengthTimesAngle;

impl ConservativeCandidate for LengthTimesAngle {
    type ConservativeMethod<T: Real> = Juelicher<T>;
    fn name(self) -> &'static str {
        "Jülicher"
    }
    fn modules(self) -> &'static [&'static str] {
        &["hinge", "juelicher", "spontaneous_curvature"]
    }
    fn method<T: Real>(self, modulus: T) -> Juelicher<T> {
        Juelicher::new(modulus)
    }
}

/// Method S with each choice of control points.
#[derive(Clone, Copy, Debug)]
pub struct Subdivided(pub ControlPoints);

impl ConservativeCandidate for Subdivided {
    type ConservativeMethod<T: Real> = LoopSubdivision<T>;
    fn name(self) -> &'static str {
        match self.0 {
            ControlPoints::Nodes => "Loop, nodes",
            ControlPoints::Interpolated => "Loop, interpolated",
            ControlPoints::Sharpened => "Loop, sharpened",
            ControlPoints::Hybrid => "Loop",
        }
    }
    fn modules(self) -> &'static [&'static str] {
        &["loop_subdivision"]
    }
    fn method<T: Real>(self, modulus: T) -> LoopSubdivision<T> {
        LoopSubdivision::with_controls(modulus, self.0)
    }
}

/// The sum of two methods.
#[derive(Clone, Copy, Debug)]
pub struct Sum<A, B>(pub A, pub B);

impl<A: ConservativeCandidate, B: ConservativeCandidate> ConservativeCandidate for Sum<A, B> {
    type ConservativeMethod<T: Real> = (A::ConservativeMethod<T>, B::ConservativeMethod<T>);
    fn name(self) -> &'static str {
        "sum of two"
    }
    fn modules(self) -> &'static [&'static str] {
        &[]
    }
    fn method<T: Real>(self, modulus: T) -> Self::ConservativeMethod<T> {
        (self.0.method(modulus), self.1.method(modulus))
    }
    fn switches_at_right_angles(self) -> bool {
        self.0.switches_at_right_angles() || self.1.switches_at_right_angles()
    }
}

/// Method C with each kind of area.
#[derive(Clone, Copy, Debug)]
pub struct StrongCotangent(pub DualArea);

impl Candidate for StrongCotangent {
    type Method<T: Real> = StrongForm<T, Cotangent>;
    fn name(self) -> &'static str {
        match self.0 {
            DualArea::Mixed => "Meyer",
            DualArea::Voronoi => "Meyer, Voronoi areas",
            DualArea::Barycentric => "Meyer, barycentric areas",
        }
    }
    fn modules(self) -> &'static [&'static str] {
        &["strong_form", "cotangent"]
    }
    fn method<T: Real>(self, modulus: T) -> StrongForm<T, Cotangent> {
        StrongForm::new(modulus, Cotangent::new(self.0))
    }
}

/// Method D.
#[derive(Clone, Copy, Debug)]
pub struct StrongHeatKernel;

impl Candidate for StrongHeatKernel {
    type Method<T: Real> = StrongForm<T, HeatKernel<T>>;
    fn name(self) -> &'static str {
        "Belkin"
    }
    fn modules(self) -> &'static [&'static str] {
        &["strong_form", "heat_kernel"]
    }
    fn method<T: Real>(self, modulus: T) -> Self::Method<T> {
        StrongForm::belkin(modulus)
    }
}

/// Method E, as published or guarded.
#[derive(Clone, Copy, Debug)]
pub struct StrongParaboloid {
    /// See [`Paraboloid::guarded`].
    pub guarded: bool,
}

impl Candidate for StrongParaboloid {
    type Method<T: Real> = StrongForm<T, Paraboloid>;
    fn name(self) -> &'static str {
        if self.guarded {
            "Farutin, guarded"
        } else {
            "Farutin"
        }
    }
    fn modules(self) -> &'static [&'static str] {
        &["strong_form", "paraboloid", "least_squares"]
    }
    fn method<T: Real>(self, modulus: T) -> Self::Method<T> {
        let guarded = self.guarded;
        StrongForm::new(modulus, Paraboloid { guarded })
    }
    fn chooses_by_threshold(self) -> bool {
        true
    }
}

/// Method J of either degree.
#[derive(Clone, Copy, Debug)]
pub enum StrongJet {
    /// Degree 4.
    J4,
    /// Degree 6.
    J6,
}

impl Candidate for StrongJet {
    type Method<T: Real> = StrongForm<T, Jet<T>>;
    fn name(self) -> &'static str {
        match self {
            Self::J4 => "jets of degree 4",
            Self::J6 => "jets of degree 6",
        }
    }
    fn modules(self) -> &'static [&'static str] {
        &["strong_form", "jet", "least_squares"]
    }
    fn method<T: Real>(self, modulus: T) -> StrongForm<T, Jet<T>> {
        match self {
            Self::J4 => StrongForm::j4(modulus),
            Self::J6 => StrongForm::j6(modulus),
        }
    }
    fn chooses_by_threshold(self) -> bool {
        true
    }
}

/// So many vertices leave methods that choose by thresholds their first choice nearly everywhere.
const ROOM: usize = 600;

/// A law of methods.
pub trait Law {
    /// Fails if the method breaks the law.
    fn check<C: Candidate>(&mut self, candidate: C);
}

/// A law of methods whose force is a gradient.
pub trait ConservativeLaw {
    /// Fails if the method breaks the law.
    fn check<C: ConservativeCandidate>(&mut self, candidate: C);
}

/// A law of Laplace–Beltrami operators.
pub trait OperatorLaw {
    /// Fails if the operator breaks the law.
    fn check<L: LaplaceBeltrami<f64> + Copy>(&mut self, name: &str, operator: L);
}

/// Every method whose force is a gradient.
pub fn for_each_conservative(law: &mut impl ConservativeLaw) {
    law.check(Hinged::Forces);
    law.check(Hinged::OppositeGaussianModulus);
    law.check(Hinged::SphereEnergy);
    law.check(SquaredLaplacian(DualArea::Voronoi));
    law.check(SquaredLaplacian(DualArea::Mixed));
    law.check(SquaredLaplacian(DualArea::Barycentric));
    law.check(LengthTimesAngle);
    law.check(Subdivided(ControlPoints::Nodes));
    law.check(Subdivided(ControlPoints::Interpolated));
    law.check(Subdivided(ControlPoints::Sharpened));
    law.check(Subdivided(ControlPoints::Hybrid));
    law.check(Sum(Hinged::Forces, SquaredLaplacian(DualArea::Voronoi)));
}

/// Every method.
pub fn for_each(law: &mut impl Law) {
    struct AsLaw<'a, L>(&'a mut L);
    impl<L: Law> ConservativeLaw for AsLaw<'_, L> {
        fn check<C: ConservativeCandidate>(&mut self, candidate: C) {
            self.0.check(candidate);
        }
    }
    for_each_conservative(&mut AsLaw(law));
    law.check(StrongCotangent(DualArea::Mixed));
    law.check(StrongCotangent(DualArea::Voronoi));
    law.check(StrongCotangent(DualArea::Barycentric));
    law.check(StrongHeatKernel);
    law.check(StrongParaboloid { guarded: false });
    law.check(StrongParaboloid { guarded: true });
    law.check(StrongJet::J4);
    law.check(StrongJet::J6);
}

/// Every Laplace–Beltrami operator.
pub fn for_each_operator(law: &mut impl OperatorLaw) {
    law.check("cotangent, mixed", Cotangent::new(DualArea::Mixed));
    law.check("cotangent, Voronoi", Cotangent::new(DualArea::Voronoi));
    law.check(
        "cotangent, barycentric",
        Cotangent::new(DualArea::Barycentric),
    );
    law.check("heat kernel", HeatKernel::default());
    law.check("paraboloid", Paraboloid::default());
    law.check("paraboloid, guarded", Paraboloid::guarded());
    law.check("jet, degree 4", Jet::j4());
    law.check("jet, degree 6", Jet::j6());
}

/// The library's files that [`for_each`] runs through the laws of methods, and, as far as they are
/// operators, [`for_each_operator`] through those of operators.
pub fn covered_modules() -> Vec<&'static str> {
    struct Modules(Vec<&'static str>);
    impl Law for Modules {
        fn check<C: Candidate>(&mut self, candidate: C) {
            self.0.extend(candidate.modules());
        }
    }
    let mut modules = Modules(Vec::new());
    for_each(&mut modules);
    modules.0
}

/// The energy of a surface.
///
/// # Panics
/// If positions and mesh do not fit.
pub fn energy<T: Real>(method: impl Energy<T>, mesh: &TriangleMesh, positions: &[[T; 3]]) -> T {
    let surface = Surface::new(mesh, positions).expect("one finite position a vertex");
    Prepared::new(method, mesh).energy(surface)
}

/// The nodal forces of a surface.
///
/// # Panics
/// If positions and mesh do not fit.
pub fn forces<T: Real>(
    method: impl Force<T>,
    mesh: &TriangleMesh,
    positions: &[[T; 3]],
) -> Vec<[T; 3]> {
    let surface = Surface::new(mesh, positions).expect("one finite position a vertex");
    let mut force = vec![[T::zero(); 3]; positions.len()];
    Prepared::new(method, mesh).add_force(surface, &mut force);
    force
}

/// The largest absolute coordinate.
pub fn largest(vectors: &[[f64; 3]]) -> f64 {
    vectors
        .iter()
        .flatten()
        .fold(0.0, |most, x| most.max(x.abs()))
}

/// The directions in which a gradient is tried: some coordinates alone, then all at random.
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

/// −F·d, what the energy's derivative along d should be.
fn along(force: &[[f64; 3]], direction: &[[f64; 3]]) -> f64 {
    let work = |(&f, &d): (&[f64; 3], &[f64; 3])| dot(f, d);
    -force.iter().zip(direction).map(work).sum::<f64>()
}

/// |d| as the sum over vertices, so that the largest force times it bounds every term.
fn extent(direction: &[[f64; 3]]) -> f64 {
    direction.iter().map(|&d| norm(d)).sum()
}

/// F = −∂E/∂x, the derivative by dual numbers; and force and energy together are the two alone.
#[derive(Clone, Copy, Debug)]
pub struct ForceIsGradient<'a>(pub &'a Mesh);

impl ConservativeLaw for ForceIsGradient<'_> {
    fn check<C: ConservativeCandidate>(&mut self, candidate: C) {
        let Mesh {
            connectivity: mesh,
            positions,
        } = self.0;
        let name = ConservativeCandidate::name(candidate);
        let method = || ConservativeCandidate::method(candidate, 1.0);
        let force = forces(method(), mesh, positions);
        let largest = largest(&force);
        for direction in trials(positions.len(), 1) {
            let moved = positions.iter().zip(&direction);
            let moved = moved.map(|(x, d)| [0, 1, 2].map(|k| F1::new(x[k], d[k])));
            let dual = ConservativeCandidate::method(candidate, F1::cst(1.0));
            let derivative = energy(dual, mesh, &Vec::from_iter(moved)).dx;
            let scale = largest * extent(&direction);
            tolerance::GRADIENT_DUAL.assert(along(&force, &direction), derivative, scale, name);
        }

        let mut together = vec![[0.0; 3]; positions.len()];
        let sum =
            Prepared::new(method(), mesh).add_force_and_energy(self.0.surface(), &mut together);
        assert_eq!(together, force, "{name}: forces with and without energy");
        let alone = energy(method(), mesh, positions);
        assert_eq!(sum, alone, "{name}: energy with and without forces");
    }
}

/// F = −∂E/∂x, the derivative by finite differences.
#[derive(Clone, Copy, Debug)]
pub struct ForceIsDifference<'a>(pub &'a Mesh);

impl ConservativeLaw for ForceIsDifference<'_> {
    fn check<C: ConservativeCandidate>(&mut self, candidate: C) {
        let Mesh {
            connectivity: mesh,
            positions,
        } = self.0;
        let name = ConservativeCandidate::name(candidate);
        // Where an area nearly vanishes, the energy changes its slope over as short a way.
        let step = 1e-4 * self.0.edge_length() / self.0.roughness();
        if candidate.switches_at_right_angles() && self.0.distance_from_right_angle() < 2e-3 {
            return;
        }
        let method = || ConservativeCandidate::method(candidate, 1.0);
        let force = forces(method(), mesh, positions);
        let largest = largest(&force);
        for direction in trials(positions.len(), 2) {
            let at = |steps: f64| {
                let moved = positions.iter().zip(&direction);
                let moved = moved.map(|(x, d)| [0, 1, 2].map(|k| x[k] + steps * step * d[k]));
                energy(method(), mesh, &Vec::from_iter(moved))
            };
            let near = at(1.0) - at(-1.0);
            let far = at(2.0) - at(-2.0);
            let derivative = (8.0 * near - far) / (12.0 * step);
            let scale = largest * extent(&direction);
            tolerance::GRADIENT_DIFFERENCE.assert(
                along(&force, &direction),
                derivative,
                scale,
                name,
            );
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
        tolerance::BALANCE.assert(torque, 0.0, 1.0, &format!("{name}: Σ x × F"));
    }
}

/// |Σ F| / Σ |F| and |Σ x × F| / Σ |x||F|.
pub fn imbalance(positions: &[[f64; 3]], force: &[[f64; 3]]) -> (f64, f64) {
    let mut sums = [[0.0; 3]; 2];
    let mut scales = [f64::MIN_POSITIVE; 2];
    for (&x, &f) in positions.iter().zip(force) {
        let torque = cross(x, f);
        for axis in 0..3 {
            sums[0][axis] += f[axis];
            sums[1][axis] += torque[axis];
        }
        scales[0] += norm(f);
        scales[1] += norm(x) * norm(f);
    }
    (norm(sums[0]) / scales[0], norm(sums[1]) / scales[1])
}

/// Energies do not change and forces follow when the surface is turned, moved or relabelled.
#[derive(Clone, Copy, Debug)]
pub struct Invariant<'a> {
    /// The surface.
    pub mesh: &'a Mesh,
    /// Seed of the motion.
    pub seed: u64,
}

impl Law for Invariant<'_> {
    fn check<C: Candidate>(&mut self, candidate: C) {
        let mut random = SplitMix64::new(self.seed);
        // Positions on a grid, so that a move by a multiple of the grid's pitch is not rounded.
        let pitch = 2.0_f64.powi(-40);
        let mesh = &self.mesh.map(|x| x.map(|x| (x / pitch).round() * pitch));
        let evaluate = |mesh: &Mesh| {
            let force = forces(candidate.method(1.0), &mesh.connectivity, &mesh.positions);
            let energy = energy(candidate.method(1.0), &mesh.connectivity, &mesh.positions);
            (force, energy)
        };
        let name = candidate.name();
        let (force, energy) = evaluate(mesh);
        let scale = largest(&force) * mesh.roughness();
        let energy_scale = energy.abs() + scale;
        let compare = |found: &[[f64; 3]], expected: &[[f64; 3]], what: &str| {
            for (found, expected) in found.iter().zip(expected) {
                let error = norm(difference(*found, *expected));
                tolerance::INVARIANCE.assert(error, 0.0, scale, &format!("{name}: force, {what}"));
            }
        };

        let moved = evaluate(&mesh.map(|x| [x[0] + 5.0, x[1] - 2.25, x[2] + 0.125]));
        assert!(
            (&force, energy) == (&moved.0, moved.1),
            "{name}: translation changes a bit"
        );

        if candidate.chooses_by_threshold() && mesh.positions.len() < ROOM {
            return;
        }
        let quaternion = [0; 4].map(|_| random.symmetric());
        let turn = rotation(quaternion);
        let (turned_force, turned_energy) = evaluate(&mesh.map(|x| turned(turn, x)));
        let expected = Vec::from_iter(force.iter().map(|&f| turned(turn, f)));
        compare(&turned_force, &expected, "rotation");
        let what = format!("{name}: energy, rotation");
        tolerance::INVARIANCE.assert(turned_energy, energy, energy_scale, &what);

        let (relabelled, new_number) = mesh.relabelled(random.bits());
        let (relabelled_force, relabelled_energy) = evaluate(&relabelled);
        let expected = Vec::from_iter(new_number.iter().map(|&new| relabelled_force[new]));
        compare(&expected, &force, "relabelling");
        let what = format!("{name}: energy, relabelling");
        tolerance::INVARIANCE.assert(relabelled_energy, energy, energy_scale, &what);
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
    /// The law in one scalar.
    pub fn check_in<T: Real>(&self, candidate: impl Candidate, rounding: tolerance::Tolerance) {
        let name = candidate.name();
        let connectivity = &self.mesh.connectivity;
        let positions = self.mesh.positions_in::<T>();
        let (scale, modulus) = (T::constant(self.scale), T::constant(self.modulus));
        let scaled = Vec::from_iter(positions.iter().map(|x| x.map(|x| x * scale)));
        let unit = || candidate.method(T::one());
        let method = || candidate.method(modulus);
        let energy_pair = [
            energy(method(), connectivity, &scaled),
            modulus * energy(unit(), connectivity, &positions),
        ];
        let force_pair = [
            forces(method(), connectivity, &scaled),
            forces(unit(), connectivity, &positions),
        ];
        let expected = |f: T| f * (modulus / scale);
        let is_power_of_two = |x: f64| x.log2().fract() == 0.0;
        let what = format!("{name}, s = {:e}, κ = {:e}", self.scale, self.modulus);
        if is_power_of_two(self.scale) && is_power_of_two(self.modulus) {
            assert_eq!(energy_pair[0], energy_pair[1], "energy, {what}");
            for (found, &unscaled) in force_pair[0].iter().zip(&force_pair[1]) {
                assert_eq!(*found, unscaled.map(expected), "force, {what}");
            }
        } else if !candidate.chooses_by_threshold() || positions.len() >= ROOM {
            let double = |x: T| x.to_f64().unwrap_or(f64::NAN);
            // In double precision and divided by κ/s, so that the comparison itself cannot
            // underflow.
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
        self.check_in::<f64>(candidate, tolerance::INVARIANCE);
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
        self.0
            .check_in::<f32>(candidate, tolerance::INVARIANCE_SINGLE);
    }
}

/// Energies, forces and findings of a method on a surface that may be degenerate are finite, and
/// vertices in no triangle feel nothing.
#[derive(Clone, Copy, Debug)]
pub struct Finite<'a>(pub &'a Mesh);

impl Law for Finite<'_> {
    fn check<C: Candidate>(&mut self, candidate: C) {
        let Mesh {
            connectivity: mesh,
            positions,
        } = self.0;
        let name = candidate.name();
        let energy = energy(candidate.method(1.0), mesh, positions);
        assert!(energy.is_finite(), "{name}: energy {energy}");
        let forces = forces(candidate.method(1.0), mesh, positions);
        for (vertex, force) in forces.into_iter().enumerate() {
            let finite = force.iter().all(|f| f.is_finite());
            assert!(finite, "{name}: force {force:?} at vertex {vertex}");
            if mesh.vertex_kind(vertex) == VertexKind::Isolated {
                assert_eq!(force, [0.0; 3], "{name}: isolated vertex {vertex}");
            }
        }
    }
}

impl OperatorLaw for Finite<'_> {
    fn check<L: LaplaceBeltrami<f64> + Copy>(&mut self, name: &str, operator: L) {
        let measured = Measured::new(operator, self.0);
        for (vertex, curvature) in measured.curvature.iter().enumerate() {
            let kind = self.0.connectivity.vertex_kind(vertex);
            let Curvature {
                normal,
                mean,
                gaussian,
                area,
                ..
            } = *curvature;
            let values = [normal[0], normal[1], normal[2], mean, gaussian, area];
            let finite = values.iter().all(|value| value.is_finite());
            assert!(finite, "{name}: {curvature:?} at vertex {vertex}");
            assert_eq!(curvature.kind, kind, "{name}: kind of vertex {vertex}");
            if kind == VertexKind::Isolated {
                assert_eq!((normal, area), ([0.0; 3], 0.0), "{name}: vertex {vertex}");
            }
        }
        let laplacian = measured.apply(&self.0.positions);
        let finite = laplacian.iter().flatten().all(|value| value.is_finite());
        assert!(finite, "{name}: Δ_S x");
    }
}

/// What a method reports after an evaluation of forces.
pub fn findings(method: impl Force<f64>, mesh: &Mesh) -> Vec<Finding> {
    let mut prepared = Prepared::new(method, &mesh.connectivity);
    prepared.add_force(mesh.surface(), &mut vec![[0.0; 3]; mesh.positions.len()]);
    let mut findings = Vec::new();
    prepared.inspect(mesh.surface(), &mut |finding| findings.push(finding));
    findings
}

/// An operator that has measured a surface.
#[derive(Debug)]
pub struct Measured<'a, L: Method<f64>> {
    mesh: &'a Mesh,
    operator: L,
    plan: L::Plan,
    memory: L::Memory,
    /// n, H, K and A at each vertex.
    pub curvature: Vec<Curvature<f64>>,
}

impl<'a, L: LaplaceBeltrami<f64>> Measured<'a, L> {
    /// Measures.
    pub fn new(operator: L, mesh: &'a Mesh) -> Self {
        let plan = operator.plan(&mesh.connectivity);
        let mut memory = L::Memory::default();
        let mut curvature = vec![Curvature::default(); mesh.positions.len()];
        operator.measure(&Serial, &plan, mesh.surface(), &mut memory, &mut curvature);
        Self {
            mesh,
            operator,
            plan,
            memory,
            curvature,
        }
    }

    /// Δ_S of a field.
    pub fn apply<const D: usize>(&self, field: &[[f64; D]]) -> Vec<[f64; D]> {
        // Not zero before: the operator sets, it does not add.
        let mut laplacian = vec![[f64::NAN; D]; field.len()];
        let surface = self.mesh.surface();
        self.operator.apply(
            &Serial,
            &self.plan,
            surface,
            &self.memory,
            field,
            &mut laplacian,
        );
        laplacian
    }

    /// Δ_S of a scalar field.
    pub fn apply_to_scalar(&self, field: &[f64]) -> Vec<f64> {
        let mut laplacian = vec![f64::NAN; field.len()];
        let surface = self.mesh.surface();
        self.operator.apply_to_scalar(
            &Serial,
            &self.plan,
            surface,
            &self.memory,
            field,
            &mut laplacian,
        );
        laplacian
    }

    /// Fills the rows.
    pub fn assemble(&self, rows: &mut Rows<f64>) {
        self.operator
            .assemble(&self.plan, self.mesh.surface(), &self.memory, rows);
    }
}

/// Δ_S of a constant is zero, to the last bit, in every form.
#[derive(Clone, Copy, Debug)]
pub struct ConstantsVanish<'a>(pub &'a Mesh);

impl OperatorLaw for ConstantsVanish<'_> {
    fn check<L: LaplaceBeltrami<f64> + Copy>(&mut self, name: &str, operator: L) {
        let measured = Measured::new(operator, self.0);
        let vertices = self.0.positions.len();
        let zero = vec![0.0; vertices];
        let constant = vec![0.1; vertices];
        assert_eq!(measured.apply_to_scalar(&constant), zero, "{name}");
        let mut rows = Rows::new();
        measured.assemble(&mut rows);
        let mut result = vec![f64::NAN; vertices];
        rows.apply_to_scalar(&Serial, &constant, &mut result);
        assert_eq!(result, zero, "{name}: rows");
        let fields = measured.apply(&vec![[0.1, -7.0e30]; vertices]);
        assert_eq!(fields, vec![[0.0; 2]; vertices], "{name}: two fields");
    }
}

/// Rows do what the operator does; filled again for a moved surface, they keep their memory.
#[derive(Clone, Copy, Debug)]
pub struct RowsAgree<'a>(pub &'a Mesh);

impl OperatorLaw for RowsAgree<'_> {
    fn check<L: LaplaceBeltrami<f64> + Copy>(&mut self, name: &str, operator: L) {
        let mut measured = Measured::new(operator, self.0);
        let vertices = self.0.positions.len();
        let field = SplitMix64::new(3).directions(vertices);
        let mut rows = Rows::new();
        measured.assemble(&mut rows);
        assert_eq!(rows.len(), vertices, "{name}: one row a vertex");
        let agree = |rows: &Rows<f64>, expected: &[[f64; 3]], scalar: &[f64]| {
            let mut result = vec![[f64::NAN; 3]; vertices];
            rows.apply(&Serial, &field, &mut result);
            for vertex in 0..vertices {
                let scale = 2.0 * rows.row(vertex).1.iter().map(|c| c.abs()).sum::<f64>();
                let error = norm(difference(result[vertex], expected[vertex]));
                let scale = scale.max(f64::MIN_POSITIVE);
                tolerance::OPERATOR_ROUNDING.assert(error, 0.0, scale, name);
                assert_eq!(
                    scalar[vertex], expected[vertex][0],
                    "{name}: one field and three"
                );
            }
        };
        let first = Vec::from_iter(field.iter().map(|f| f[0]));
        agree(
            &rows,
            &measured.apply(&field),
            &measured.apply_to_scalar(&first),
        );

        let places = |rows: &Rows<f64>| {
            let (columns, coefficients) = rows.row(0);
            (columns.as_ptr(), coefficients.as_ptr())
        };
        let before = places(&rows);
        let moved = self.0.map(|[x, y, z]| [1.5 * x + 0.1 * y, y, z - 0.2 * x]);
        measured.mesh = &moved;
        let Measured {
            operator,
            plan,
            memory,
            curvature,
            ..
        } = &mut measured;
        operator.measure(&Serial, plan, moved.surface(), memory, curvature);
        measured.assemble(&mut rows);
        assert_eq!(
            places(&rows),
            before,
            "{name}: refilled rows moved in memory"
        );
        agree(
            &rows,
            &measured.apply(&field),
            &measured.apply_to_scalar(&first),
        );
        let mut fresh = Rows::new();
        measured.assemble(&mut fresh);
        for vertex in 0..vertices {
            assert_eq!(
                rows.row(vertex),
                fresh.row(vertex),
                "{name}: refilled rows and new ones"
            );
        }
    }
}

/// Curvatures follow: n turns, H, K and A stay; H and K scale as 1/length and its square. Turned
/// are only meshes that leave room for operators that choose by thresholds.
#[derive(Clone, Copy, Debug)]
pub struct CurvatureFollows<'a>(pub &'a Mesh);

impl OperatorLaw for CurvatureFollows<'_> {
    fn check<L: LaplaceBeltrami<f64> + Copy>(&mut self, name: &str, operator: L) {
        let pitch = 2.0_f64.powi(-40);
        let mesh = &self.0.map(|x| x.map(|x| (x / pitch).round() * pitch));
        let here = Measured::new(operator, mesh).curvature;
        let there =
            Measured::new(operator, &mesh.map(|x| [x[0] - 3.0, x[1], x[2] + 9.5])).curvature;
        assert_eq!(here, there, "{name}: translation");

        for exponent in [-40, 40] {
            let scale = 2.0_f64.powi(exponent);
            let scaled = mesh.map(|x| x.map(|x| scale * x));
            let scaled = Measured::new(operator, &scaled).curvature;
            let back = scaled.into_iter().map(|curvature| Curvature {
                mean: curvature.mean * scale,
                gaussian: curvature.gaussian * scale * scale,
                area: curvature.area / scale / scale,
                ..curvature
            });
            assert_eq!(Vec::from_iter(back), here, "{name}: scale 2^{exponent}");
        }

        if mesh.positions.len() < ROOM {
            return;
        }
        let turn = rotation(crate::meshes::GENERIC);
        let there = Measured::new(operator, &mesh.map(|x| turned(turn, x))).curvature;
        let largest = here.iter().map(|c| c.mean.abs()).fold(1.0, f64::max);
        for (here, there) in here.iter().zip(&there) {
            let normal = norm(difference(turned(turn, here.normal), there.normal));
            tolerance::INVARIANCE.assert(normal, 0.0, 1.0, name);
            tolerance::INVARIANCE.assert(there.mean, here.mean, largest, name);
            let square = largest * largest + here.gaussian.abs();
            tolerance::INVARIANCE.assert(there.gaussian, here.gaussian, square, name);
            tolerance::INVARIANCE.assert(there.area, here.area, here.area.abs() + 1e-3, name);
        }
    }
}
