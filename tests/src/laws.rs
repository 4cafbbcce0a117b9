//! The laws of the traits, each written once and run over every implementation.
//!
//! [`check_conservative`] and [`check`] run a method of your own through them. Every method and
//! operator of the program's list is in the suite automatically; each variant that is not in the list
//! needs one line in [`for_each`], [`for_each_conservative`] or [`for_each_operator`].

use crate::meshes::Mesh;
use crate::tolerance::Tolerance;
use helfrich::{
    Bandwidth, ControlPoints, Cotangent, Curvatures, DualArea, Energy, Finding, Force, HeatKernel,
    LaplaceBeltrami, Paraboloid, Prepared, Real, Surface, TriangleMesh,
};
use helfrich_std::method::{
    ListVisitor, ListedCurvatures, ListedEnergy, ListedOperator, Of, for_each_listed,
};

mod candidates;
mod finite;
mod gradient;
mod invariance;
mod operators;
mod subject;

pub use candidates::{
    Candidate, ConservativeCandidate, CosineOfHinge, GuardedParaboloid, HingeFormula, Hinged,
    Listed, ListedStrong, PublishedHeatKernel, SquaredLaplacian, StrongCotangent, Subdivided, Sum,
};
pub use finite::Finite;
pub use gradient::{
    Balanced, ForceIsDifference, ForceIsGradient, check_gradient, check_work, imbalance, net,
    with_derivatives,
};
pub use invariance::{Invariant, InvariantFits, ScaleFree, ScaleFreeSingle};
pub use operators::{
    ConstantsVanish, CurvatureFollows, LaplacianFollows, MatrixAgrees, Measured, RowsAgree,
    check_operator, findings_on_small_meshes,
};
pub use subject::{Evaluate, Subject};

/// Number of vertices above which methods that choose by thresholds make their preferred choice at nearly
/// every vertex.
const FEWEST_VERTICES: usize = 600;

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

/// A law of every method that computes curvatures at vertices, operators included.
pub trait CurvatureLaw {
    /// Fails if the method breaks the law.
    fn check<M: Curvatures<f64> + Copy>(&mut self, name: &str, method: M);
}

/// The bound of a method in a list of exceptions, by its name in the law suite, or the common one.
fn bound(exceptions: &[(&str, Tolerance)], name: &str, common: Tolerance) -> Tolerance {
    let own = exceptions.iter().find(|(method, _)| *method == name);
    own.map_or(common, |&(_, bound)| bound)
}

/// Applies a law to every method whose force is a gradient.
pub fn for_each_conservative(law: &mut impl ConservativeLaw) {
    struct Energies<'a, L>(&'a mut L);
    impl<L: ConservativeLaw> ListVisitor for Energies<'_, L> {
        fn energy<const PLACE: usize>(&mut self, method: Of<PLACE>)
        where
            Of<PLACE>: ListedEnergy,
        {
            self.0.check(Listed(method));
        }
    }
    for_each_listed(&mut Energies(law));
    law.check(Hinged::OppositeGaussianModulus);
    law.check(Hinged::SphereEnergy);
    law.check(HingeFormula);
    law.check(SquaredLaplacian(DualArea::Voronoi));
    law.check(SquaredLaplacian(DualArea::Barycentric));
    law.check(Subdivided(ControlPoints::Nodes));
    law.check(Subdivided(ControlPoints::Interpolated));
    law.check(Subdivided(ControlPoints::Sharpened));
    law.check(Sum(Hinged::Forces, SquaredLaplacian(DualArea::Voronoi)));
}

/// Applies a law to every method.
pub fn for_each(law: &mut impl Law) {
    struct AsLaw<'a, L>(&'a mut L);
    impl<L: Law> ConservativeLaw for AsLaw<'_, L> {
        fn check<C: ConservativeCandidate>(&mut self, candidate: C) {
            self.0.check(candidate);
        }
    }
    struct StrongForms<'a, L>(&'a mut L);
    impl<L: Law> ListVisitor for StrongForms<'_, L> {
        fn strong_form<const PLACE: usize>(&mut self, method: Of<PLACE>)
        where
            Of<PLACE>: ListedOperator,
        {
            self.0.check(ListedStrong(method));
        }
    }
    for_each_conservative(&mut AsLaw(law));
    for_each_listed(&mut StrongForms(law));
    law.check(StrongCotangent(DualArea::Voronoi));
    law.check(StrongCotangent(DualArea::Barycentric));
    law.check(PublishedHeatKernel);
    law.check(GuardedParaboloid);
}

/// Applies a law to every Laplace–Beltrami operator.
pub fn for_each_operator(law: &mut impl OperatorLaw) {
    struct Operators<'a, L>(&'a mut L);
    impl<L: OperatorLaw> ListVisitor for Operators<'_, L> {
        fn strong_form<const PLACE: usize>(&mut self, method: Of<PLACE>)
        where
            Of<PLACE>: ListedOperator,
        {
            let listed = ListedStrong(method);
            let name = Candidate::name(listed);
            self.0.check(name, listed.method(1.0).operator);
        }
    }
    for_each_listed(&mut Operators(law));
    law.check("cotangent, Voronoi", Cotangent::new(DualArea::Voronoi));
    law.check(
        "cotangent, barycentric",
        Cotangent::new(DualArea::Barycentric),
    );
    let published = HeatKernel::new(Bandwidth::MixedArea(1.0));
    law.check("heat kernel, published bandwidth", published);
    law.check("paraboloid, guarded", Paraboloid::guarded());
}

/// Applies a law to every Laplace–Beltrami operator and to every operator for curvatures only.
pub fn for_each_curvatures(law: &mut impl CurvatureLaw) {
    struct AsLaw<'a, L>(&'a mut L);
    impl<L: CurvatureLaw> OperatorLaw for AsLaw<'_, L> {
        fn check<O: LaplaceBeltrami<f64> + Copy>(&mut self, name: &str, operator: O) {
            self.0.check(name, operator);
        }
    }
    impl<L: CurvatureLaw> ListVisitor for AsLaw<'_, L> {
        fn curvatures<const PLACE: usize>(&mut self, _method: Of<PLACE>)
        where
            Of<PLACE>: ListedCurvatures,
        {
            let method = <Of<PLACE> as ListedCurvatures>::method(candidates::settings(1.0));
            self.0.check(Of::<PLACE>::METHOD.title(), method);
        }
    }
    for_each_operator(&mut AsLaw(law));
    for_each_listed(&mut AsLaw(law));
}

/// Checks every law of methods on one mesh.
///
/// # Panics
/// If the method breaks a law.
pub fn check(method: impl Candidate, mesh: &Mesh) {
    let law = ScaleFree {
        mesh,
        scale: 1e-5,
        modulus: 1e-19,
    };
    Law::check(&mut Finite(mesh), method);
    Law::check(&mut Invariant { mesh, seed: 1 }, method);
    Law::check(&mut ScaleFreeSingle(law), method);
    let (mut law, scale, modulus) = (law, 2.0_f64.powi(-17), 2.0_f64.powi(-63));
    Law::check(&mut law, method);
    (law.scale, law.modulus) = (scale, modulus);
    Law::check(&mut law, method);
}

/// Checks every law of methods with an energy on one mesh, which include those of [`check`].
///
/// # Panics
/// If the method breaks a law.
pub fn check_conservative(method: impl ConservativeCandidate, mesh: &Mesh) {
    check(method, mesh);
    ForceIsGradient(mesh).check(method);
    ForceIsDifference(mesh).check(method);
    Balanced(mesh).check(method);
}

/// The energy of a surface.
///
/// # Panics
/// If the positions do not fit the mesh.
pub fn energy<T: Real>(method: impl Energy<T>, mesh: &TriangleMesh, positions: &[[T; 3]]) -> T {
    let surface = Surface::new(mesh, positions).expect("one finite position a vertex");
    Prepared::new(method, mesh).energy(surface)
}

/// The nodal forces of a surface.
///
/// # Panics
/// If the positions do not fit the mesh.
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

/// Findings of a method after an evaluation of forces.
pub fn findings(method: impl Force<f64>, mesh: &Mesh) -> Vec<Finding> {
    let mut prepared = Prepared::new(method, &mesh.connectivity);
    prepared.add_force(mesh.surface(), &mut vec![[0.0; 3]; mesh.positions.len()]);
    let mut findings = Vec::new();
    prepared.inspect(mesh.surface(), &mut |finding| findings.push(finding));
    findings
}
