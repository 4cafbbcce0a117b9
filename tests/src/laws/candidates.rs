//! The methods that laws are about, to be made for any scalar.

use helfrich::{
    Bandwidth, Conservative, ControlPoints, Cotangent, DualArea, Energy, Force, GompperKroll,
    Hamann, HeatKernel, Jet, Juelicher, KantorNelson, LoopSubdivision, Paraboloid, Real,
    StrongForm,
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
            DualArea::Voronoi => "Gompper-Kroll, Voronoi areas",
            DualArea::Mixed => "Gompper-Kroll",
            DualArea::Barycentric => "Gompper-Kroll, barycentric areas",
        }
    }
    fn modules(self) -> &'static [&'static str] {
        &["gompper_kroll"]
    }
    fn method<T: Real>(self, modulus: T) -> GompperKroll<T> {
        GompperKroll::with_areas(modulus, self.0)
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

/// Hamann's method.
#[derive(Clone, Copy, Debug)]
pub struct AveragedNormal;

impl ConservativeCandidate for AveragedNormal {
    type ConservativeMethod<T: Real> = Hamann<T>;
    fn name(self) -> &'static str {
        "Hamann"
    }
    fn modules(self) -> &'static [&'static str] {
        &["area_vectors", "hamann"]
    }
    fn method<T: Real>(self, modulus: T) -> Hamann<T> {
        Hamann::new(modulus)
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

/// Method D, as published or with the bandwidth with which it converges.
#[derive(Clone, Copy, Debug)]
pub struct StrongHeatKernel {
    /// See [`Bandwidth::MixedArea`].
    pub published: bool,
}

impl Candidate for StrongHeatKernel {
    type Method<T: Real> = StrongForm<T, HeatKernel<T>>;
    fn name(self) -> &'static str {
        if self.published {
            "Belkin, published bandwidth"
        } else {
            "Belkin"
        }
    }
    fn modules(self) -> &'static [&'static str] {
        &["strong_form", "heat_kernel"]
    }
    fn method<T: Real>(self, modulus: T) -> Self::Method<T> {
        if self.published {
            let operator = HeatKernel::new(Bandwidth::MixedArea(T::one()));
            StrongForm::new(modulus, operator)
        } else {
            StrongForm::belkin(modulus)
        }
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
