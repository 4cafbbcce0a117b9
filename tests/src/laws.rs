//! The laws of the traits, each written once and run over every implementation.
//!
//! A method enters the suite by one line in [`for_each`] or [`for_each_conservative`], an operator
//! by one in [`for_each_operator`]; [`covered_modules`] is what the coverage tests compare with
//! the files of the library.

use crate::meshes::Mesh;
use helfrich::{
    Bandwidth, ControlPoints, Cotangent, DualArea, Energy, Finding, Force, HeatKernel, Jet,
    LaplaceBeltrami, Paraboloid, Prepared, Real, Surface, TriangleMesh,
};

mod candidates;
mod finite;
mod gradient;
mod invariance;
mod operators;

pub use candidates::{
    AveragedNormal, Candidate, ConservativeCandidate, Hinged, LengthTimesAngle, SquaredLaplacian,
    StrongCotangent, StrongHeatKernel, StrongJet, StrongParaboloid, Subdivided, Sum,
};
pub use finite::Finite;
pub use gradient::{Balanced, ForceIsDifference, ForceIsGradient, check_gradient, imbalance, net};
pub use invariance::{Invariant, InvariantFits, ScaleFree, ScaleFreeSingle};
pub use operators::{
    ConstantsVanish, CurvatureFollows, LaplacianFollows, Measured, RowsAgree, check_operator,
    findings_on_small_meshes,
};

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
    law.check(AveragedNormal);
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
    law.check(StrongHeatKernel { published: false });
    law.check(StrongHeatKernel { published: true });
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
    let published = HeatKernel::new(Bandwidth::MixedArea(1.0));
    law.check("heat kernel, published bandwidth", published);
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

/// What a method reports after an evaluation of forces.
pub fn findings(method: impl Force<f64>, mesh: &Mesh) -> Vec<Finding> {
    let mut prepared = Prepared::new(method, &mesh.connectivity);
    prepared.add_force(mesh.surface(), &mut vec![[0.0; 3]; mesh.positions.len()]);
    let mut findings = Vec::new();
    prepared.inspect(mesh.surface(), &mut |finding| findings.push(finding));
    findings
}
