//! Errors that `recommend` expects at noisy positions, against true errors on shapes and meshes that were not
//! used to adjust the estimates.

use helfrich::shapes::{Discocyte, ExactPoint, Shape, Torus};
use helfrich::{AdaptiveJet, Noise, Surface, TriangleMesh};
use helfrich_std::answer::Norm;
use helfrich_std::generate::random::Random;
use helfrich_std::generate::{AnyShape, Family, generate};
use helfrich_std::measurement::Measurement;
use helfrich_std::method::{AnyMethod, BendingMethod, Evaluator, MethodOptions};
use helfrich_std::noise::noise_of;
use helfrich_std::recommend::{Candidate, Recommendation, Request, recommend};
use helfrich_std::scalar::Scalar;
use helfrich_std::study::Quantity;
use helfrich_tests::star::Star;

/// A mesh with the exact surface at its vertices.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) mesh: TriangleMesh,
    pub(crate) exact: Vec<ExactPoint<f64>>,
}

/// A star of five harmonics of degrees 2 to 5.
fn star(seed: u64) -> Star {
    let mut random = Random::new(1000 + seed);
    let term = |k: u64| {
        let degree = 2 + (k + seed) % 4;
        let amplitude = 0.25 * (random.unit() - 0.3) / (degree as f64 - 0.5);
        (amplitude, degree as usize, random.on_sphere().to_array())
    };
    Star {
        terms: (0..5).map(term).collect(),
    }
}

impl Case {
    pub(crate) fn of_star(seed: u64, family: Family, vertices: usize) -> Self {
        let sphere = "sphere".parse().expect("a shape");
        let made = generate(&sphere, family, vertices, seed).expect("a mesh");
        let star = star(seed);
        Self {
            name: format!("star {seed}, {family}, {vertices}"),
            mesh: made.mesh,
            exact: made.preimages.iter().map(|&at| star.at(at)).collect(),
        }
    }

    pub(crate) fn of_shape(shape: &AnyShape, family: Family, vertices: usize) -> Self {
        let made = generate(shape, family, vertices, 1).expect("a mesh");
        Self {
            name: format!("{shape}, {family}, {vertices}"),
            mesh: made.mesh,
            exact: made.preimages.iter().map(|&at| shape.at(at)).collect(),
        }
    }

    pub(crate) fn positions(&self) -> Vec<[f64; 3]> {
        self.exact.iter().map(|point| point.position).collect()
    }

    pub(crate) fn mean_edge(&self) -> f64 {
        let positions = self.positions();
        let surface = Surface::new(&self.mesh, &positions).expect("positions");
        let edges = self.mesh.edges().iter();
        let lengths = edges.map(|&[from, to]| {
            let [x, y, z] = surface.difference(from, to);
            x.hypot(y).hypot(z)
        });
        lengths.sum::<f64>() / self.mesh.edges().len() as f64
    }

    /// Positions with normally distributed errors of this standard deviation in every coordinate, by
    /// Marsaglia's polar form of the Box–Muller method.
    pub(crate) fn disturbed(&self, deviation: f64) -> Vec<[f64; 3]> {
        let mut random = Random::new(777);
        let mut error = || {
            let point = random.in_disc();
            let square = point.length_squared();
            deviation * point.x * (-2.0 * square.ln() / square).sqrt()
        };
        let positions = self.positions().into_iter();
        positions.map(|x| x.map(|x| x + error())).collect()
    }

    /// Mean error of a method at these positions, relative to the largest value on the shape.
    fn truth(&self, positions: &[[f64; 3]], method: BendingMethod, quantity: Quantity) -> f64 {
        let surface = Surface::new(&self.mesh, positions).expect("positions");
        let fields = match method {
            BendingMethod::Jet => {
                let jet = AdaptiveJet::default();
                let measured = Measurement::new(surface, &jet, &mut |_| true);
                measured.expect("not interrupted").fields(1.0)
            }
            _ => Evaluator::new(method, 1.0, &self.mesh).fields(surface),
        };
        let (mut errors, mut areas, mut largest) = (0.0, 0.0, 0.0_f64);
        for (vertex, exact) in self.exact.iter().enumerate() {
            let (error, size) = match quantity {
                Quantity::Mean => (fields.mean[vertex].expect("H") - exact.mean, exact.mean),
                _ => {
                    let density = exact.force_density(1.0);
                    let found = fields.force_density[vertex].expect("f");
                    let squares =
                        (0..3).map(|axis| (found[axis] - density * exact.normal[axis]).powi(2));
                    (squares.sum::<f64>().sqrt(), density)
                }
            };
            errors += fields.area[vertex] * error.abs();
            areas += fields.area[vertex];
            largest = largest.max(size.abs());
        }
        errors / areas / largest
    }

    fn recommendation(
        &self,
        positions: &[[f64; 3]],
        quantity: Quantity,
        methods: &[BendingMethod],
    ) -> Recommendation {
        let request = Request {
            quantity,
            norm: Norm::Mean,
            target: 0.01,
            methods: methods.iter().map(|&method| method.into()).collect(),
            options: MethodOptions::default(),
            scalars: vec![Scalar::F64],
        };
        let found = recommend(&self.mesh, positions, &request, &|| false, &mut |_| {});
        found.expect("a reference").expect("an answer")
    }

    /// Ratios of expected to true mean errors of J4 and J6, for noise of this fraction of the mean edge
    /// length.
    fn ratios(&self, part: f64, quantity: Quantity) -> ([f64; 2], Recommendation) {
        let positions = self.disturbed(part * self.mean_edge());
        let jets = [BendingMethod::J4, BendingMethod::J6];
        let found = self.recommendation(&positions, quantity, &jets);
        let ratios = jets.map(|method| {
            let mut candidates = found.candidates.iter();
            let candidate = candidates.find(|candidate| candidate.method == method);
            let expected = candidate.expect("a candidate").expected;
            expected / self.truth(&positions, method, quantity)
        });
        (ratios, found)
    }
}

pub(crate) fn torus(aspect: f64) -> AnyShape {
    AnyShape::Torus(Torus::new(1.0, aspect).expect("radii"))
}

/// Disc with other coefficients than a red blood cell's: its rim is half as wide.
pub(crate) fn disc() -> AnyShape {
    let disc = Discocyte::with_coefficients(1.0, [0.4, 1.0, -0.4]);
    AnyShape::Discocyte(disc.expect("coefficients"))
}

#[track_caller]
fn assert_expected(case: &Case, part: f64, quantity: Quantity) {
    let (ratios, found) = case.ratios(part, quantity);
    for ratio in ratios {
        assert!(
            (1.0 / 1.5..1.5).contains(&ratio),
            "{}, {part}, {}: {ratios:?}",
            case.name,
            quantity.symbol()
        );
    }
    // Where noise dominates f, more vertices would be worse.
    if quantity == Quantity::ForceDensity && found.noise_error > 0.5 {
        let needed = found.vertices_needed;
        let vertices = case.mesh.vertex_count() as f64;
        assert!(needed.is_none_or(|needed| needed < vertices), "{needed:?}");
    }
}

/// For any requested error, the answer has at most twice the true error of any cheaper method. The most
/// expensive method, `jet`, estimates its error as well as J4 and J6 do.
#[test]
fn no_cheaper_method_has_half_the_error_of_an_answer() {
    let shape = "ellipsoid:1,0.7,0.4".parse().expect("a shape");
    let case = Case::of_shape(&shape, Family::Relaxed, 2562);
    let positions = case.disturbed(1e-3 * case.mean_edge());
    // The heat kernel is left out, because it takes minutes.
    let mut methods = BendingMethod::ALL.to_vec();
    methods.retain(|&method| method != BendingMethod::Belkin);
    methods.push(BendingMethod::Jet);
    let quantity = Quantity::ForceDensity;
    let mut candidates = case
        .recommendation(&positions, quantity, &methods)
        .candidates;
    // The documented costs of methods are used, because measured times depend on the load of the machine.
    let listed = |candidate: &Candidate| match candidate.method {
        AnyMethod::Listed(method) => method,
        AnyMethod::Own(method) => panic!("{method:?} is not of the list"),
    };
    let cost = |candidate: &Candidate| match listed(candidate) {
        BendingMethod::Jet => f64::INFINITY,
        method => method.cost().relative,
    };
    candidates.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    let truths = candidates.iter();
    let truths = truths.map(|candidate| case.truth(&positions, listed(candidate), quantity));
    let truths = Vec::from_iter(truths);
    for (index, (answer, truth)) in candidates.iter().zip(&truths).enumerate() {
        let mut cheaper = candidates[..index].iter().zip(&truths);
        if cheaper
            .clone()
            .all(|(other, _)| other.expected > answer.expected)
        {
            let better = cheaper.find(|(_, other)| **other < 0.5 * truth);
            assert!(better.is_none(), "{better:?} {answer:?} {truth}");
        }
    }
    let (jet, truth) = (candidates.last(), truths.last());
    let (jet, truth) = jet.zip(truth).expect("candidates");
    let ratio = jet.expected / truth;
    assert_eq!(jet.method, BendingMethod::Jet);
    assert!((1.0 / 1.5..1.5).contains(&ratio), "{jet:?} {truth}");
}

/// The error of f is expected correctly, although f itself is lost in noise.
#[test]
fn the_force_of_a_star_with_noise() {
    let case = Case::of_star(1, Family::Irregular, 2562);
    assert_expected(&case, 1e-2, Quantity::ForceDensity);
}

/// On a narrow tube, fits are narrow as well, and their f is mostly noise; on a disc, f has larger errors at
/// the rim than elsewhere.
#[test]
fn the_force_of_tubes_and_rims_with_noise() {
    for shape in [torus(0.3), disc()] {
        let case = Case::of_shape(&shape, Family::Irregular, 2562);
        assert_expected(&case, 1e-2, Quantity::ForceDensity);
    }
}

/// Half of a flat ellipsoid is hardly resolved, but its noise is found nevertheless.
#[test]
fn errors_of_a_flat_ellipsoid_with_noise() {
    let shape = "ellipsoid:1,1,0.4".parse().expect("a shape");
    let case = Case::of_shape(&shape, Family::Regular, 2562);
    for quantity in [Quantity::Mean, Quantity::ForceDensity] {
        assert_expected(&case, 3e-4, quantity);
    }
}

/// At the tips of a spindle, jets of degree 8 are several times worse than those of degrees 4 and 6.
#[test]
fn errors_of_a_spindle_with_noise() {
    let shape = "ellipsoid:0.4,0.4,2".parse().expect("a shape");
    let case = Case::of_shape(&shape, Family::Irregular, 2562);
    assert_expected(&case, 3e-4, Quantity::Mean);
}

/// No noise is found in exact vertices, on shapes with many waves.
#[test]
fn exact_stars_have_no_noise() {
    for (seeds, vertices) in [(4, 162), (4, 642), (1, 2562)] {
        for seed in 1..=seeds {
            for family in Family::ALL {
                let case = Case::of_star(seed, family, vertices);
                let positions = case.positions();
                let surface = Surface::new(&case.mesh, &positions).expect("positions");
                let found = noise_of(surface);
                assert_eq!(found, Noise::default(), "{}", case.name);
            }
        }
    }
}

/// Bounds of the ratios of many cases, of one noise and quantity: the largest factor by which errors are expected wrongly,
/// and the number of cases in a hundred in which it is above 1.5.
///
/// Measured with 2562 vertices: at most 1.5 but for H at 1e-4 edges on a narrow torus, expected up to 1.68 times too
/// large, and for f at 1e-2 edges, where f is noise alone and expected between 0.33 and 1.83 times.
const BOUNDS: [(f64, Quantity, f64, usize); 6] = [
    (1e-4, Quantity::Mean, 1.75, 6),
    (1e-4, Quantity::ForceDensity, 1.5, 0),
    (1e-3, Quantity::Mean, 1.5, 0),
    (1e-3, Quantity::ForceDensity, 1.5, 0),
    (1e-2, Quantity::Mean, 1.5, 0),
    (1e-2, Quantity::ForceDensity, 3.1, 24),
];

/// All held-out shapes on a family of meshes.
fn held_out(family: Family, vertices: usize) -> Vec<Case> {
    let ellipsoids = [
        "ellipsoid:1,1,2.5",
        "ellipsoid:1,1,0.4",
        "ellipsoid:1,0.7,0.4",
    ];
    let mut cases = Vec::from_iter((1..=4).map(|seed| Case::of_star(seed, family, vertices)));
    let shapes = ellipsoids.map(|name| name.parse().expect("a shape"));
    let all = shapes.into_iter().chain([torus(0.3), torus(0.5), disc()]);
    cases.extend(all.map(|shape| Case::of_shape(&shape, family, vertices)));
    cases
}

/// Meshes of 642 vertices hardly resolve these shapes, so that noise is not found; those of 10 242 are of one family,
/// because each takes a minute.
#[test]
#[ignore = "half an hour: by .ci/long"]
fn everything_held_out() {
    let mut cases = Vec::from_iter(
        Family::ALL
            .iter()
            .flat_map(|&family| held_out(family, 2562)),
    );
    cases.extend(held_out(Family::Irregular, 10242));
    for (part, quantity, most, beyond) in BOUNDS {
        let factors = cases.iter().map(|case| {
            let ([a, b], _) = case.ratios(part, quantity);
            let factor = a.max(1.0 / a).max(b).max(1.0 / b);
            assert!(
                factor < most,
                "{}, {part}, {}: {factor}",
                case.name,
                quantity.symbol()
            );
            factor
        });
        let factors = Vec::from_iter(factors);
        let count = factors.iter().filter(|&&factor| factor > 1.5).count();
        let allowed = beyond * factors.len() / 100;
        assert!(count <= allowed, "{part}, {}: {count}", quantity.symbol());
    }
}
