//! The methods to which laws apply, for any scalar: those of the program's list, and further variants.

use helfrich::bending::{Hinge, OverHinges};
use helfrich::element::{Corners, ElementEnergy};
use helfrich::{
    Bandwidth, Conservative, ControlPoints, Cotangent, DualArea, Energy, Force, GompperKroll,
    HeatKernel, KantorNelson, LoopSubdivision, MaterialParameter, Paraboloid, ParameterError, Real,
    StrongForm, TriangleMesh,
};
use helfrich_std::method::{
    BendingMethod, Description, ListedEnergy, ListedOperator, MethodOptions, Settings,
};
use std::any::type_name;
use std::sync::LazyLock;

/// A bending method that can be made for any scalar.
pub trait Candidate: Copy {
    /// The method for the scalar T.
    type Method<T: Real>: Energy<T> + Force<T>;
    /// Name in messages of failures.
    fn name(self) -> &'static str;
    /// Words of the method's type name, among which are the modules of the library whose formulas it runs.
    fn modules(self) -> Vec<&'static str> {
        let names = type_name::<Self::Method<f64>>().split(['<', ',', '>', ' ']);
        names.flat_map(|name| name.split("::")).collect()
    }
    /// The method with this bending modulus.
    fn method<T: Real>(self, modulus: T) -> Self::Method<T>;
    /// Whether its force is the gradient of its energy.
    fn is_gradient(self) -> bool {
        false
    }
    /// Whether the method chooses neighbours or polynomial degrees by thresholds. At a threshold, rounding
    /// decides, and on a coarse mesh some vertex is always at one.
    fn chooses_by_threshold(self) -> bool {
        let modules = self.modules();
        ["jet", "paraboloid"]
            .iter()
            .any(|fit| modules.contains(fit))
    }
}

/// A bending method whose force is the gradient of its energy, and that can be made for any scalar.
pub trait ConservativeCandidate: Copy {
    /// The method for the scalar T.
    type ConservativeMethod<T: Real>: Conservative<T>;
    /// See [`Candidate::name`].
    fn name(self) -> &'static str;
    /// See [`Candidate::method`].
    fn method<T: Real>(self, modulus: T) -> Self::ConservativeMethod<T>;
    /// Whether the formula changes at right angles, which finite differences must therefore avoid.
    fn switches_at_right_angles(self) -> bool {
        false
    }
}

impl<C: ConservativeCandidate> Candidate for C {
    type Method<T: Real> = C::ConservativeMethod<T>;
    fn name(self) -> &'static str {
        ConservativeCandidate::name(self)
    }
    fn method<T: Real>(self, modulus: T) -> Self::Method<T> {
        ConservativeCandidate::method(self, modulus)
    }
    fn is_gradient(self) -> bool {
        true
    }
}

/// Settings from which methods of the list are made, with this bending modulus.
pub(super) fn settings<T: Real>(modulus: T) -> Settings<'static, T> {
    static OPTIONS: LazyLock<MethodOptions> = LazyLock::new(MethodOptions::default);
    // Only the method that the mesh selects reads the mesh.
    static MESH: LazyLock<TriangleMesh> = LazyLock::new(|| {
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        TriangleMesh::new(4, triangles).expect("a tetrahedron")
    });
    Settings {
        modulus: modulus.into(),
        spontaneous_curvature: MaterialParameter::default(),
        options: &OPTIONS,
        mesh: &MESH,
    }
}

/// Method with an energy, from the program's list or your own.
#[derive(Clone, Copy, Debug)]
pub struct Listed<M>(pub M);

impl<M: ListedEnergy + Copy> ConservativeCandidate for Listed<M> {
    type ConservativeMethod<T: Real> = M::Method<T>;
    fn name(self) -> &'static str {
        let Description { title, .. } = M::DESCRIPTION;
        title
    }
    fn method<T: Real>(self, modulus: T) -> M::Method<T> {
        M::method(settings(modulus))
    }
    fn switches_at_right_angles(self) -> bool {
        M::DESCRIPTION.name == BendingMethod::GompperKroll.name()
    }
}

/// Method in strong form, from the program's list or your own.
#[derive(Clone, Copy, Debug)]
pub struct ListedStrong<M>(pub M);

impl<M: ListedOperator + Copy> Candidate for ListedStrong<M> {
    type Method<T: Real> = StrongForm<T, M::Operator<T>>;
    fn name(self) -> &'static str {
        let Description { title, .. } = M::DESCRIPTION;
        title
    }
    fn method<T: Real>(self, modulus: T) -> Self::Method<T> {
        M::method(settings(modulus))
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
            Self::Forces => "Kantor–Nelson",
            Self::OppositeGaussianModulus => "Kantor–Nelson, opposite Gaussian modulus",
            Self::SphereEnergy => "Kantor–Nelson, sphere energy",
        }
    }
    fn method<T: Real>(self, modulus: T) -> KantorNelson<T> {
        match self {
            Self::Forces => KantorNelson::new(modulus),
            Self::OppositeGaussianModulus => KantorNelson::with_opposite_gaussian_modulus(modulus),
            Self::SphereEnergy => KantorNelson::with_sphere_energy(modulus),
        }
    }
}

/// Method A as a formula of one hinge.
#[derive(Clone, Copy, Debug)]
pub struct HingeFormula;

/// Energy `k̃ (1 − cos θ)`, of which each end of the edge has half.
#[derive(Clone, Copy, Debug)]
pub struct CosineOfHinge<T>(pub T);

impl<T: Real> ElementEnergy<T, 4> for CosineOfHinge<T> {
    fn evaluate(&self, _element: usize, corners: &Corners<T, 4>) -> ([[T; 3]; 4], [T; 4]) {
        let hinge = Hinge::new(corners);
        let modulus = self.0 * hinge.presence;
        // 1 − cos θ = ½ |chord|², which does not cancel at small angles.
        let chord = [hinge.cosine - T::one(), hinge.sine];
        let half = T::constant(0.25) * modulus * (chord[0] * chord[0] + chord[1] * chord[1]);
        let forces = hinge.forces(corners, modulus * hinge.sine);
        (forces, [half, half, T::zero(), T::zero()])
    }

    fn check(&self) -> Result<(), ParameterError> {
        let limit = T::constant(4.0) * ParameterError::largest_modulus();
        ParameterError::unless_within("modulus of an edge", self.0, limit)
    }
}

impl ConservativeCandidate for HingeFormula {
    type ConservativeMethod<T: Real> = OverHinges<CosineOfHinge<T>>;
    fn name(self) -> &'static str {
        "Kantor–Nelson, formula of a hinge"
    }
    fn method<T: Real>(self, modulus: T) -> Self::ConservativeMethod<T> {
        OverHinges(CosineOfHinge(KantorNelson::new(modulus).edge_modulus))
    }
}

/// Method B with each kind of area.
#[derive(Clone, Copy, Debug)]
pub struct SquaredLaplacian(pub DualArea);

impl ConservativeCandidate for SquaredLaplacian {
    type ConservativeMethod<T: Real> = GompperKroll<T>;
    fn name(self) -> &'static str {
        match self.0 {
            DualArea::Voronoi => "Gompper–Kroll, Voronoi areas",
            DualArea::Mixed => "Gompper–Kroll",
            DualArea::Barycentric => "Gompper–Kroll, barycentric areas",
        }
    }
    fn method<T: Real>(self, modulus: T) -> GompperKroll<T> {
        GompperKroll::with_areas(modulus, self.0)
    }
    fn switches_at_right_angles(self) -> bool {
        self.0 == DualArea::Mixed
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
    fn method<T: Real>(self, modulus: T) -> StrongForm<T, Cotangent> {
        StrongForm::new(modulus, Cotangent::new(self.0))
    }
}

/// Method D with the published bandwidth.
#[derive(Clone, Copy, Debug)]
pub struct PublishedHeatKernel;

impl Candidate for PublishedHeatKernel {
    type Method<T: Real> = StrongForm<T, HeatKernel<T>>;
    fn name(self) -> &'static str {
        "Belkin, published bandwidth"
    }
    fn method<T: Real>(self, modulus: T) -> Self::Method<T> {
        let operator = HeatKernel::new(Bandwidth::MixedArea(T::one()));
        StrongForm::new(modulus, operator)
    }
}

/// Method E with guarded fits.
#[derive(Clone, Copy, Debug)]
pub struct GuardedParaboloid;

impl Candidate for GuardedParaboloid {
    type Method<T: Real> = StrongForm<T, Paraboloid>;
    fn name(self) -> &'static str {
        "Farutin, guarded"
    }
    fn method<T: Real>(self, modulus: T) -> Self::Method<T> {
        StrongForm::new(modulus, Paraboloid::guarded())
    }
}
