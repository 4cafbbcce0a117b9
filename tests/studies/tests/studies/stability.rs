//! The stability table: every row passes, and no row is missing. Besides the table: accepted surfaces give
//! finite numbers, and each kind of finding is reported.

use helfrich::{
    DualArea, Finding, GompperKroll, Jet, KantorNelson, Prepared, Quality, StrongForm, Surface,
    TriangleMesh,
};
use helfrich_std::method::{BendingMethod, Evaluated, Evaluator};
use helfrich_std::run::End;
use helfrich_std::scalar::Scalar;
use helfrich_studies::stability::{Bound, Course, Evaluation, Group, Outcome, Row, Stability};
use helfrich_tests::meshes::{
    Inscribed, Mesh, SplitMix64, hemisphere, icosahedron, icosphere, octahedron, sheet, tetrahedron,
};
use std::collections::{HashMap, HashSet};
use std::sync::LazyLock;
use std::thread;

/// The table without its largest mesh, computed once for all tests, its groups at the same time.
static TABLE: LazyLock<Vec<Row>> = LazyLock::new(|| {
    let rows = |group| {
        let table = Stability {
            large: false,
            group: Some(group),
        };
        let rows = table.run(&mut |_| ());
        rows.expect("every mesh of the table can be made")
    };
    thread::scope(|scope| {
        let groups = Group::ALL.map(|group| scope.spawn(move || rows(group)));
        let groups = groups.map(|rows| rows.join().expect("no group panics"));
        groups.into_iter().flatten().collect()
    })
});

fn failures(rows: &[Row]) -> Vec<String> {
    let failed = rows.iter().filter(|row| !row.passed);
    failed.map(Row::to_string).collect()
}

#[test]
fn every_row_passes() {
    let failed = failures(&TABLE);
    assert!(
        failed.is_empty(),
        "{} rows:\n{}",
        failed.len(),
        failed.join("\n")
    );
}

/// The mesh of a million vertices takes half an hour: `cargo test --release --package helfrich-studies --
/// --ignored`, or `helfrich-studies stability --group geometry --large`. It is not part of `.ci/run`;
/// CONTRIBUTING says when to run it.
#[test]
#[ignore = "half an hour: by .ci/long"]
fn a_million_nodes() {
    let table = Stability {
        large: true,
        group: Some(Group::Geometry),
    };
    let rows = table.run(&mut |_| ()).expect("meshes");
    let rows = Vec::from_iter(
        rows.into_iter()
            .filter(|row| row.case == "a million vertices"),
    );
    assert_eq!(rows.len(), BendingMethod::ALL.len() * Scalar::ALL.len());
    assert_eq!(failures(&rows), Vec::<String>::new());
}

#[test]
fn every_case_has_every_method_in_every_number_type() {
    let mut cases: HashMap<&str, HashSet<(&str, Scalar)>> = HashMap::new();
    for row in TABLE.iter().filter(|row| row.group == Group::Geometry) {
        let new = cases
            .entry(row.case)
            .or_default()
            .insert((row.subject, row.scalar));
        assert!(new, "twice: {row}");
    }
    assert!(cases.len() >= 18, "{} cases", cases.len());
    let all = BendingMethod::ALL.into_iter();
    let all = all.flat_map(|method| Scalar::ALL.map(|scalar| (method.name(), scalar)));
    let all = HashSet::from_iter(all);
    for (case, found) in cases {
        assert_eq!(found, all, "{case}");
    }
}

/// Errors due to noise are proportional to it, because noise is small against edges and all methods are
/// linear in small displacements: ten times the noise gives ten times the error, where the error without
/// noise is negligible.
#[test]
fn errors_grow_in_proportion_to_noise() {
    let mut compared = 0;
    for row in TABLE.iter().filter(|row| row.case == "noise of 1e-2 edges") {
        let less = |other: &&Row| {
            other.case == "noise of 1e-3 edges"
                && (other.subject, other.scalar) == (row.subject, row.scalar)
        };
        let less = TABLE.iter().find(less).expect("the same with less noise");
        let without = |other: &&Row| {
            other.case == "clean" && (other.subject, other.scalar) == (row.subject, row.scalar)
        };
        let without = TABLE.iter().find(without).expect("the same without noise");
        let of = |row: &Row| match row.outcome {
            Outcome::Evaluated(found) => found.error.expect("an exact f"),
            ref other => panic!("{row}: {other:?}"),
        };
        let [error, small, clean] = [row, less, without].map(of);
        assert!(error <= 1.25 * 10.0 * small, "{row}");
        if small > 4.0 * clean {
            assert!(error >= 10.0 * (small - clean) / 1.25, "{row}");
            compared += 1;
        }
    }
    assert!(compared >= 15, "{compared}");
}

/// These cases must be in the table, whatever else it contains.
#[test]
fn every_hard_run_is_there() {
    let rows = TABLE.iter().filter(|row| row.group == Group::Dynamics);
    let cases: HashSet<&str> = rows.map(|row| row.case).collect();
    for case in [
        "low Ca without bending",
        "high Ca",
        "bending from 1e-4 to 1",
        "viscosity ratio from 0.05 to 50",
        "100 γ̇t of tank-treading",
        "fixed steps at the limit",
        "methods on an irregular mesh in flow",
        "methods on slivers in flow",
        "a mode that grows, and one that is too stiff",
        "capsules pressed together",
        "vesicle of reduced volume 0.6",
        "restart in mid-run",
        "contradictory demands",
        "energy of a relaxation",
        "volume without correction",
        "momentum and torque",
        "on a lattice",
    ] {
        assert!(cases.contains(case), "no case `{case}`");
    }
    for case in [
        "methods on an irregular mesh in flow",
        "methods on slivers in flow",
        "momentum and torque",
    ] {
        let of_case = TABLE.iter().filter(|row| row.case == case);
        let subjects = Vec::from_iter(of_case.map(|row| row.subject));
        // Hamann's steps become tiny there.
        let stiff = (case == "methods on an irregular mesh in flow").then_some("hamann");
        let expected = BendingMethod::ALL.into_iter().map(BendingMethod::name);
        let expected = Vec::from_iter(expected.filter(|&name| Some(name) != stiff));
        assert_eq!(subjects, expected, "{case}");
    }
    let threads = TABLE.iter().filter(|row| row.group == Group::Threads);
    assert!(threads.count() >= 5);
}

/// Capsules that are stiffer or more viscous inside deform less.
#[test]
fn deformations_fall_as_capsules_resist_more() {
    for case in ["bending from 1e-4 to 1", "viscosity ratio from 0.05 to 50"] {
        let rows = TABLE.iter().filter(|row| row.case == case);
        let deformations = Vec::from_iter(rows.map(|row| match &row.outcome {
            Outcome::Ran(course) => course.deformation.expect("a flow"),
            other => panic!("{case}: {other:?}"),
        }));
        assert!(deformations.len() >= 4, "{case}");
        assert!(
            deformations.is_sorted_by(|a, b| a > b),
            "{case}: {deformations:?}"
        );
    }
}

#[test]
fn bounds_refuse_runs_that_break_them() {
    let good = Course {
        end: End::Completed,
        message: "the end is reached".to_owned(),
        warnings: Vec::new(),
        finite: true,
        volume_change: 1e-15,
        deformation: Some(0.2),
        unsteadiness: Some(0.01),
        error: Some(0.05),
    };
    let all = [
        Bound::Runs { volume: 1e-12 },
        Bound::RunsInSilence { volume: 1e-12 },
        Bound::Steady { most: 0.02 },
        Bound::RunsNear { most: 0.1 },
        Bound::RunsNearOrSays {
            most: 0.1,
            why: "too stiff",
        },
        Bound::Says("the end"),
    ];
    let stops = Bound::Stops("too stiff");
    let allows = |bound: Bound, course: &Course| bound.allows(&Outcome::Ran(course.clone()));
    for bound in all {
        assert!(allows(bound, &good), "{bound:?}");
        let infinite = Course {
            finite: false,
            ..good.clone()
        };
        assert!(!allows(bound, &infinite), "{bound:?}");
        assert!(!bound.allows(&Outcome::Refused("the end".into())));
    }
    let stopped = Course {
        end: End::Failed,
        message: "the forces are too stiff".to_owned(),
        ..good.clone()
    };
    for bound in all {
        let told = matches!(bound, Bound::RunsNearOrSays { .. });
        assert_eq!(allows(bound, &stopped), told, "{bound:?}");
    }
    assert!(allows(stops, &stopped));
    assert!(!allows(stops, &good));
    let wrong = [
        Course {
            volume_change: f64::NAN,
            ..good.clone()
        },
        Course {
            warnings: vec!["doubtful".to_owned()],
            ..good.clone()
        },
        Course {
            unsteadiness: Some(0.03),
            ..good.clone()
        },
        Course {
            error: Some(f64::NAN),
            ..good.clone()
        },
        Course {
            error: None,
            ..good.clone()
        },
        Course {
            message: String::new(),
            ..good.clone()
        },
        // There is a warning, but not the one that explains the difference.
        Course {
            end: End::Failed,
            message: "the step became too short".to_owned(),
            warnings: vec!["doubtful".to_owned()],
            error: Some(0.9),
            ..good
        },
    ];
    let pairs = [
        (0, 0),
        (1, 0),
        (1, 1),
        (2, 2),
        (3, 3),
        (3, 4),
        (4, 3),
        (4, 4),
        (4, 6),
        (5, 5),
    ];
    for (bound, course) in pairs {
        let (bound, course) = (all[bound], &wrong[course]);
        assert!(!allows(bound, course), "{bound:?} allows {course:?}");
    }
    assert!(Bound::RefusedForBoth("a", "b").allows(&Outcome::Refused("b, a".into())));
    assert!(!Bound::RefusedForBoth("a", "b").allows(&Outcome::Refused("a".into())));
}

/// Bounds refuse outcomes that violate them.
#[test]
fn bounds_refuse_what_breaks_them() {
    let good = Evaluation {
        finite: true,
        error: Some(0.3),
        unflagged_error: Some(0.1),
        slope: Some(0.9),
        moved: Some(0.0),
        scaled: Some(0.0),
        findings: 3,
        flagged: 4,
        vertices: 40,
        checksum: 0,
    };
    let allows = |bound: Bound, found| bound.allows(&Outcome::Evaluated(found));
    let near = |error, slope, flagged| Bound::Near {
        error,
        slope,
        flagged,
    };
    let close = near(0.1, 0.11, 0.1);
    let finite = Bound::Finite { flagged: 0.1 };
    for bound in [close, finite, Bound::Reported] {
        assert!(allows(bound, good), "{bound:?}");
    }
    for bound in [
        near(0.0999, 0.11, 0.1),
        near(0.1, 0.09, 0.1),
        near(0.1, 0.11, 0.0999),
        Bound::Finite { flagged: 0.0999 },
    ] {
        assert!(!allows(bound, good), "{bound:?}");
    }
    let all = Evaluation {
        unflagged_error: None,
        flagged: 40,
        ..good
    };
    assert!(allows(near(0.3, 0.11, 1.0), all));
    assert!(!allows(near(0.2, 0.11, 1.0), all), "flags excuse no error");
    let wrong_sign = Evaluation {
        slope: Some(-0.9),
        ..good
    };
    assert!(!allows(close, wrong_sign));
    for bound in [close, finite, Bound::Reported] {
        let bad = [
            Evaluation {
                finite: false,
                ..good
            },
            Evaluation {
                moved: Some(1e-16),
                ..good
            },
            Evaluation {
                scaled: Some(f64::NAN),
                ..good
            },
        ];
        for found in bad {
            assert!(!allows(bound, found), "{bound:?} allows {found:?}");
        }
        assert!(!bound.allows(&Outcome::Refused("no".into())));
    }
    for found in [
        Evaluation {
            unflagged_error: Some(f64::NAN),
            ..good
        },
        Evaluation {
            slope: Some(f64::NAN),
            ..good
        },
        Evaluation {
            slope: None,
            ..good
        },
    ] {
        assert!(!allows(close, found), "{found:?}");
    }
    let silent = Evaluation {
        findings: 0,
        ..good
    };
    assert!(!allows(Bound::Reported, silent));
    assert!(!Bound::Refused("why").allows(&Outcome::Refused("because".into())));
    assert!(!Bound::AtMost(1.0).allows(&Outcome::Measured(f64::NAN)));
}

/// Coordinates of every size in the range of the type, some of them equal.
fn wild(random: &mut SplitMix64, count: usize, exponents: [i32; 2]) -> Vec<[f64; 3]> {
    let [low, high] = exponents;
    // A few sizes per surface, so that some edges are far shorter than others.
    let sizes = [0; 3].map(|_| low + random.below((high - low) as usize) as i32);
    let mut coordinate = || {
        let size = sizes[random.below(3)];
        match random.below(8) {
            0 => 0.0,
            1 => 2.0_f64.powi(size),
            _ => random.symmetric() * 2.0_f64.powi(size),
        }
    };
    let mut positions =
        Vec::from_iter((0..count).map(|_| [coordinate(), coordinate(), coordinate()]));
    for _ in 0..random.below(3) {
        positions[random.below(count)] = positions[random.below(count)];
    }
    positions
}

fn assert_finite<T: Evaluated>(mesh: &TriangleMesh, positions: &[[T; 3]], what: &str) {
    let Ok(surface) = Surface::new(mesh, positions) else {
        return;
    };
    for method in BendingMethod::ALL {
        let mut evaluator = Evaluator::<T>::new(method, T::one(), mesh);
        let fields = evaluator.fields(surface);
        let numbers = fields
            .mean
            .iter()
            .chain(&fields.gaussian)
            .chain(&fields.laplacian_of_mean);
        let vectors = fields
            .normal
            .iter()
            .chain(fields.force_density.iter().flatten());
        let vectors = vectors.chain(evaluator.force()).flatten();
        let mut all = numbers.flatten().chain(&fields.area).chain(vectors);
        assert!(
            all.all(|value| value.is_finite()),
            "{method}, {what}: {fields:?} {positions:?}"
        );
        evaluator.findings(surface);
        let energy = evaluator.energy(surface);
        assert!(
            energy.is_finite(),
            "{method}, {what}: energy {energy:?} {positions:?}"
        );
    }
}

/// Accepted surfaces give no infinity and no NaN.
#[test]
fn what_is_accepted_gives_finite_numbers() {
    let mut random = SplitMix64::new(2026);
    let meshes = [
        tetrahedron(),
        octahedron(),
        icosahedron(),
        icosphere(1),
        hemisphere(1),
        sheet(3),
    ];
    for trial in 0..300 {
        let mesh = &meshes[random.below(meshes.len())].connectivity;
        let vertices = mesh.vertex_count();
        let single = wild(&mut random, vertices, [-149, 29]);
        let single = Vec::from_iter(single.iter().map(|x| x.map(|x| x as f32)));
        assert_finite(mesh, &single, &format!("f32, trial {trial}"));
        let double = wild(&mut random, vertices, [-1074, 253]);
        assert_finite(mesh, &double, &format!("f64, trial {trial}"));
    }
}

fn quality_of(mesh: &Mesh, method: impl helfrich::Force<f64>) -> Quality {
    let mut prepared = Prepared::new(method, &mesh.connectivity);
    prepared.add_force(mesh.surface(), &mut vec![[0.0; 3]; mesh.positions.len()]);
    // None of these tests is about noise, which takes longer than all else.
    Quality::gather(&mesh.connectivity, |report| {
        prepared.inspect(mesh.surface(), report);
    })
}

/// A kind of finding.
type Kind = fn(&Finding) -> bool;

/// Each kind of bad triangle is found on a surface that has it, and not on others.
#[test]
fn bad_triangles_are_found() {
    let sphere = icosphere(3);
    let replaced = |vertex: usize, position: [f64; 3]| {
        let mut mesh = sphere.clone();
        mesh.positions[vertex] = position;
        mesh
    };
    let beside = sphere.connectivity.one_ring(100)[0];
    let near = |part: f64| {
        let (from, to) = (sphere.positions[100], sphere.positions[beside as usize]);
        replaced(
            100,
            [0, 1, 2].map(|axis| to[axis] + part * (from[axis] - to[axis])),
        )
    };
    let vertex: [(&str, Mesh, Kind); 4] = [
        ("uneven", near(0.1), |f| matches!(f, Finding::Uneven { .. })),
        ("thin", near(0.01), |f| {
            matches!(f, Finding::ThinTriangle { .. })
        }),
        ("degenerate", near(0.0), |f| {
            matches!(f, Finding::DegenerateTriangle { .. })
        }),
        ("folded", near(-1.5), |f| {
            matches!(f, Finding::Folded { .. })
        }),
    ];
    for (name, mesh, kind) in &vertex {
        let quality = quality_of(mesh, KantorNelson::new(1.0));
        assert!(
            quality.findings().iter().any(kind),
            "{name}: {:?}",
            quality.findings()
        );
        assert!(quality.flagged()[100], "{name}");
        let far = sphere.positions.iter().position(|x| {
            x.iter()
                .zip(&sphere.positions[100])
                .map(|(a, b)| a * b)
                .sum::<f64>()
                < -0.5
        });
        assert!(
            !quality.flagged()[far.expect("a sphere has an opposite side")],
            "{name}: far"
        );
    }
    for method in BendingMethod::ALL {
        let mut evaluator = Evaluator::new(method, 1.0, &sphere.connectivity);
        evaluator.evaluate(sphere.surface());
        assert_eq!(
            evaluator.findings(sphere.surface()),
            [],
            "{method} on a sphere"
        );
    }
}

/// Positions far from the origin, which f32 rounds, are reported.
#[test]
fn rounded_positions_are_found() {
    let sphere = icosphere(3);
    let (mesh, at) = (&sphere.connectivity, |offset: f32| {
        Vec::from_iter(
            sphere
                .positions
                .iter()
                .map(|x| x.map(|x| x as f32 + offset)),
        )
    });
    let rounded = |positions: &[[f32; 3]]| {
        let mut jets = Prepared::new(StrongForm::new(1.0, Jet::j4()), mesh);
        let surface = Surface::new(mesh, positions).expect("positions");
        jets.add_force(surface, &mut vec![[0.0; 3]; positions.len()]);
        jets.quality(surface).findings().len()
    };
    assert_eq!(rounded(&at(0.0)), 0);
    assert_eq!(rounded(&at(1e4)), sphere.positions.len());
}

/// Bad areas and fits are reported on surfaces that have them.
#[test]
fn bad_areas_and_fits_are_found() {
    let count =
        |quality: Quality, kind: Kind| quality.findings().iter().filter(|f| kind(f)).count();
    let few = quality_of(&tetrahedron(), GompperKroll::new(1.0));
    assert_eq!(
        count(few, |f| matches!(f, Finding::UnusualValence { .. })),
        4
    );

    // Random points on a sphere, with obtuse fans.
    let obtuse = Inscribed {
        seed: 11,
        amplitude: 0.9,
        refinement: 3,
        exponent: 0,
    };
    let obtuse = obtuse.mesh();
    let clamped = |quality| count(quality, |f| matches!(f, Finding::ClampedArea { .. }));
    let negative = |quality| count(quality, |f| matches!(f, Finding::NegativeArea { .. }));
    let mixed = quality_of(&obtuse, GompperKroll::new(1.0));
    let voronoi = quality_of(&obtuse, GompperKroll::with_areas(1.0, DualArea::Voronoi));
    assert!(clamped(mixed.clone()) > 0, "mixed areas");
    assert_eq!(
        clamped(mixed),
        negative(voronoi.clone()),
        "the same vertices"
    );
    assert!(count(voronoi, |f| matches!(f, Finding::SmallArea { .. })) > 0);
    let fits = quality_of(&obtuse, StrongForm::farutin(1.0));
    assert!(count(fits, |f| matches!(f, Finding::Amplified { .. })) > 0);
    let small = quality_of(&tetrahedron(), StrongForm::j6(1.0));
    assert_eq!(
        count(small, |f| matches!(f, Finding::TooFewNeighbours { .. })),
        4
    );
    let coarse = quality_of(&icosahedron(), StrongForm::j6(1.0));
    assert_eq!(
        count(coarse, |f| matches!(f, Finding::ReducedDegree { .. })),
        12
    );
}
