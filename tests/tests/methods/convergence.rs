//! Convergence of every method on every family of meshes: verdicts, orders, and published errors.

use helfrich::Surface;
use helfrich_std::execute::Parallel;
use helfrich_std::generate::{AnyShape, Family, generate};
use helfrich_std::method::BendingMethod::{
    self, Belkin, Corrected, CorrectedFit, Farutin, Galerkin, GompperKroll, Hamann, J4, J6, J8,
    Juelicher, KantorNelson, Loop, Meyer,
};
use helfrich_std::method::{AnyMethod, Evaluator, MethodOptions};
use helfrich_std::scalar::Scalar;
use helfrich_std::study::{Quantity, Row, Session, Study};
use helfrich_std::verdict::{Convergence, verdicts};
use helfrich_tests::quadrature::over_sphere_like;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;
use std::thread;

/// Methods, with the numbers of vertices of their meshes: the three finest meshes of `study`, and smaller ones
/// where methods cost more or orders show earlier.
const STUDIES: [(&[BendingMethod], [usize; 3]); 3] = [
    (
        &[
            KantorNelson,
            GompperKroll,
            Meyer,
            Farutin,
            Loop,
            Juelicher,
            Hamann,
            Corrected,
            CorrectedFit,
            J8,
        ],
        [2562, 10_242, 40_962],
    ),
    (&[J4, J6], [642, 2562, 10_242]),
    (&[Belkin, Galerkin], [642, 1281, 2562]),
];

/// A quantity of the table: the energy, or one of `study`.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Compared {
    Energy,
    AtVertices(Quantity),
}

use Compared::Energy as E;
const H: Compared = Compared::AtVertices(Quantity::Mean);
const K: Compared = Compared::AtVertices(Quantity::Gaussian);
const LAP_H: Compared = Compared::AtVertices(Quantity::LaplacianOfMean);
const F: Compared = Compared::AtVertices(Quantity::ForceDensity);

/// The convergence of one quantity of one method on one family.
#[derive(Debug)]
struct Found {
    family: Family,
    method: BendingMethod,
    compared: Compared,
    /// Orders of the largest and of the mean error.
    orders: [f64; 2],
    convergence: Convergence,
}

/// Everything that was measured.
#[derive(Default)]
struct Measured {
    rows: Vec<Row>,
    /// Relative errors of energies, with the numbers of vertices.
    energies: Vec<(Family, BendingMethod, usize, f64)>,
    found: Vec<Found>,
}

static MEASURED: LazyLock<Measured> = LazyLock::new(|| {
    let parts = thread::scope(|scope| {
        let families = Family::ALL.map(|family| scope.spawn(move || measured(family)));
        families.map(|family| family.join().expect("no family panics"))
    });
    let mut all = Measured::default();
    for part in parts {
        all.rows.extend(part.rows);
        all.energies.extend(part.energies);
        all.found.extend(part.found);
    }
    all
});

fn measured(family: Family) -> Measured {
    let shape: AnyShape = "discocyte".parse().expect("a shape");
    let exact = over_sphere_like(&shape, |point| 2.0 * point.mean.powi(2));
    let mut all = Measured::default();
    for (methods, vertices) in STUDIES {
        let study = Study {
            shape,
            families: vec![family],
            vertices: vertices.to_vec(),
            methods: methods.iter().map(|&method| method.into()).collect(),
            options: MethodOptions::default(),
            scalars: vec![Scalar::F64],
            modulus: 1.0,
            seed: 1,
        };
        let rows = study.run_in(&mut Session {
            progress: &mut |_| (),
            interrupted: &|| false,
            cache: None,
            allocated: None,
            timed: false,
        });
        all.rows.extend(rows.expect("every mesh can be made"));
        let meshes = vertices.map(|count| generate(&shape, family, count, 1).expect("a mesh"));
        // The energy of A is another one.
        let is_helfrich =
            |method: &&BendingMethod| method.is_conservative() && **method != KantorNelson;
        for &method in methods.iter().filter(is_helfrich) {
            let errors = meshes.each_ref().map(|made| {
                let (options, threads) = (MethodOptions::default(), Parallel::single());
                let mut evaluator =
                    Evaluator::with_options(method, &options, 1.0, &made.mesh, threads);
                let surface = Surface::new(&made.mesh, &made.positions).expect("positions");
                (evaluator.energy(surface) / exact - 1.0).abs()
            });
            // The slope of a line through three points at equal distances is that of the outer two.
            let order = (errors[0] / errors[2]).ln()
                / (vertices[2] as f64 / vertices[0] as f64).sqrt().ln();
            for (count, error) in vertices.into_iter().zip(errors) {
                all.energies.push((family, method, count, error));
            }
            all.found.push(Found {
                family,
                method,
                compared: E,
                orders: [order; 2],
                convergence: Convergence::of(order, order),
            });
        }
    }
    let listed = BendingMethod::ALL.into_iter();
    let mut listed = listed.chain(BendingMethod::CURVATURES);
    all.found
        .extend(verdicts(&all.rows).into_iter().map(|verdict| {
            Found {
                family,
                method: listed
                    .clone()
                    .find(|&method| verdict.method == AnyMethod::from(method))
                    .expect("a method of the list"),
                compared: Compared::AtVertices(verdict.quantity),
                orders: [verdict.order_max, verdict.order_mean],
                convergence: verdict.convergence,
            }
        }));
    let missing = listed.find(|&method| all.found.iter().all(|found| found.method != method));
    assert_eq!(missing, None, "a method without a study");
    all
}

fn guide(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../docs")
        .join(name);
    fs::read_to_string(path).expect("a guide")
}

/// The table of the guide: quantities that converge at every vertex, (in the mean only), and those that stall –
/// or diverge ↑.
fn table() -> String {
    let mut table = "| |".to_owned();
    for family in Family::ALL {
        table += &format!(" {family} |");
    }
    table += "\n|---|";
    table += &"---|".repeat(Family::ALL.len());
    for method in BendingMethod::ALL
        .into_iter()
        .chain(BendingMethod::CURVATURES)
    {
        table += &format!("\n| `{method}` |");
        for family in Family::ALL {
            let of = |(compared, name): (Compared, &str)| {
                let found = MEASURED.found.iter().find(|found| {
                    (found.family, found.method, found.compared) == (family, method, compared)
                })?;
                Some(match found.convergence {
                    Convergence::AtAllNodes => name.to_owned(),
                    Convergence::InTheMeanOnly => format!("({name})"),
                    Convergence::Stalls => format!("{name} –"),
                    Convergence::Diverges => format!("{name} ↑"),
                })
            };
            let names = [(E, "E"), (H, "H"), (K, "K"), (LAP_H, "ΔH"), (F, "f")];
            let cell = Vec::from_iter(names.into_iter().filter_map(of));
            table += &format!(" {} |", cell.join(", "));
        }
    }
    table
}

#[test]
fn the_guide_says_what_converges() {
    let table = table();
    let guide = guide("CHOOSING.md");
    assert!(
        guide.contains(&table),
        "docs/CHOOSING.md needs this table:\n{table}"
    );
}

/// Bounds of orders that theory gives.
struct Claim {
    methods: &'static [BendingMethod],
    families: &'static [Family],
    compared: &'static [Compared],
    /// Bounds of the order of the largest error, and of that of the mean error.
    orders: [[f64; 2]; 2],
    reason: &'static str,
}

use Family::{Regular, Relaxed, Smooth};

const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
const EVERY: &[Family] = &Family::ALL;
const EVEN: &[Family] = &[Regular, Smooth, Relaxed];

/// At least this order; half an order less is allowed, because three meshes are few.
const fn at_least(order: f64) -> [f64; 2] {
    [order - 0.5, f64::INFINITY]
}

/// The same at the worst vertices of random meshes, which are a matter of chance: whole orders less.
const fn at_worst(order: f64) -> [f64; 2] {
    [order - 1.0, f64::INFINITY]
}

/// About this order.
const fn about(order: f64) -> [f64; 2] {
    [order - 0.4, order + 0.4]
}

const CLAIMS: &[Claim] = &[
    Claim {
        methods: &[J4],
        families: EVERY,
        compared: &[H, K],
        orders: [at_worst(3.0), at_least(3.0)],
        reason: "a fit of degree d has an error of h^(d + 1), and second derivatives of h^(d − 1)",
    },
    Claim {
        methods: &[J4],
        families: EVERY,
        compared: &[LAP_H, F],
        orders: [at_least(1.0), at_least(1.0)],
        reason: "two derivatives more: h^(d − 3)",
    },
    Claim {
        methods: &[J4],
        families: EVEN,
        compared: &[LAP_H, F],
        orders: [at_least(2.0), at_least(2.0)],
        reason: "odd terms cancel where neighbours are symmetric about the vertex",
    },
    Claim {
        methods: &[J6],
        families: EVERY,
        compared: &[H, K],
        orders: [at_worst(5.0), at_least(5.0)],
        reason: "h^(d − 1)",
    },
    Claim {
        methods: &[J6],
        families: EVERY,
        compared: &[LAP_H, F],
        orders: [at_least(3.0), at_least(3.0)],
        reason: "h^(d − 3)",
    },
    Claim {
        methods: &[J6],
        families: &[Regular, Smooth],
        compared: &[LAP_H, F],
        orders: [at_least(4.0), at_least(4.0)],
        reason: "odd terms cancel, as for degree 4",
    },
    Claim {
        methods: &[J8],
        families: EVERY,
        compared: &[H, K],
        orders: [at_worst(7.0), at_least(7.0)],
        reason: "h^(d − 1)",
    },
    Claim {
        methods: &[J8],
        families: EVERY,
        compared: &[LAP_H, F],
        orders: [at_least(5.0), at_least(5.0)],
        reason: "h^(d − 3)",
    },
    Claim {
        methods: &[Galerkin],
        families: EVERY,
        compared: &[H, K],
        orders: [at_least(5.0), at_least(5.0)],
        reason: "jets of degree 4, 6 and 8 on these meshes: at least as fast as those of degree 6",
    },
    Claim {
        methods: &[Galerkin],
        families: EVERY,
        compared: &[F],
        orders: [at_least(3.0), at_least(3.0)],
        reason: "two derivatives more than H",
    },
    Claim {
        methods: &[Galerkin],
        families: EVERY,
        compared: &[E],
        orders: [at_least(8.0), ANY],
        reason: "twice the order r − 2 of the curvature of patches",
    },
    Claim {
        methods: &[CorrectedFit],
        families: EVERY,
        compared: &[H, K],
        orders: [at_least(1.0), at_least(1.0)],
        reason: "interpolated normals: first order on any mesh (Lachaud et al. 2020)",
    },
    Claim {
        methods: &[Belkin],
        families: EVERY,
        compared: &[H],
        orders: [ANY, about(1.0)],
        reason: "√h of the kernel is proportional to the root of the edge length",
    },
    Claim {
        methods: &[GompperKroll, Meyer, Juelicher],
        families: EVEN,
        compared: &[H],
        orders: [[f64::NEG_INFINITY, 1.0], about(2.0)],
        reason: "second order where one-rings are symmetric, none at vertices of valence 5",
    },
    Claim {
        methods: &[GompperKroll, Juelicher],
        families: EVEN,
        compared: &[E],
        orders: [about(2.0), ANY],
        reason: "the integral of the square of that H",
    },
    Claim {
        methods: &[Loop],
        families: &[Smooth],
        compared: &[E],
        orders: [about(4.0), ANY],
        reason: "second derivatives of quartic splines are of second order, and enter squared",
    },
    Claim {
        methods: &[KantorNelson, GompperKroll, Meyer, Loop, Juelicher, Hamann],
        families: EVEN,
        compared: &[F],
        orders: [[f64::NEG_INFINITY, -1.6], ANY],
        reason: "an error of H of order 0 at vertices of valence 5, of which f takes two derivatives",
    },
    Claim {
        methods: &[Farutin],
        families: &[Regular],
        compared: &[H, K],
        orders: [about(1.0), ANY],
        reason: "the third derivatives of an uneven one-ring enter H",
    },
];

#[test]
fn orders_are_those_of_theory() {
    let mut wrong = Vec::new();
    for claim in CLAIMS {
        let mut count = 0;
        for found in &MEASURED.found {
            let about = claim.methods.contains(&found.method)
                && claim.families.contains(&found.family)
                && claim.compared.contains(&found.compared);
            if !about {
                continue;
            }
            count += 1;
            for (order, [low, high]) in found.orders.into_iter().zip(claim.orders) {
                if !(low..=high).contains(&order) {
                    wrong.push(format!("{found:?}, not {low} to {high}: {}", claim.reason));
                }
            }
        }
        let combinations = claim.methods.len() * claim.families.len() * claim.compared.len();
        assert_eq!(count, combinations, "{}", claim.reason);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The errors of G that docs/GALERKIN.md publishes, which has two digits.
#[test]
fn published_errors_are_found() {
    let guide = guide("GALERKIN.md");
    let (mut compared, mut wrong) = (0, Vec::new());
    for row in guide
        .lines()
        .filter(|line| line.starts_with("| discocyte, "))
    {
        let cells = Vec::from_iter(row.split('|').map(str::trim));
        let [_, name, vertices, energy, _, max, mean, _] = cells[..] else {
            continue;
        };
        let family: Family = name["discocyte, ".len()..].parse().expect("a family");
        let vertices: usize = vertices.parse().expect("a number of vertices");
        let number = |text: &str| text.parse::<f64>().expect("a number");
        let mut check = |found: Option<f64>, published: &str| {
            if let Some(found) = found {
                let published = number(published).abs();
                if (found / published - 1.0).abs() > 0.06 {
                    wrong.push(format!("{row}: {found:.2e} for {published:.1e}"));
                }
                compared += 1;
            }
        };
        let energies = MEASURED.energies.iter();
        let mut energies = energies.filter(|(of, method, count, _)| {
            (*of, *method, *count) == (family, Galerkin, vertices)
        });
        check(energies.next().map(|(.., error)| *error), energy);
        let density = MEASURED.rows.iter().find(|row| {
            row.family == family.name()
                && row.method == AnyMethod::from(Galerkin)
                && row.vertices == vertices
                && row.quantity == Quantity::ForceDensity
        });
        check(density.map(|row| row.max), max);
        check(density.map(|row| row.mean), mean);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // Three numbers of two meshes of each family.
    assert!(compared >= 30, "{compared}");
}
