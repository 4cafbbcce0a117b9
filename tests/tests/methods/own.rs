//! Methods that are not in the list are measured, recommended and shown like listed ones.

use helfrich::{DualArea, GompperKroll, Real};
use helfrich_std::answer::Norm;
use helfrich_std::generate::{AnyShape, Family};
use helfrich_std::method::{
    AnyMethod, BendingMethod, Described, Description, ListedEnergy, MethodOptions, OwnMethod,
    Settings,
};
use helfrich_std::provenance::{Build, Provenance};
use helfrich_std::recommend::{Request, recommend};
use helfrich_std::report::page::Page;
use helfrich_std::scalar::Scalar;
use helfrich_std::study::{Quantity, Row, Study, StudyError};
use helfrich_std::verdict::verdicts;
use helfrich_tests::exact::{on_shapes, on_stars};
use helfrich_tests::meshes::cases;
use proptest::prelude::*;
use std::time::SystemTime;

/// Method B under another name and title.
#[derive(Clone, Copy, Debug)]
struct Mine;

impl Described for Mine {
    const DESCRIPTION: &'static Description = &Description {
        name: "mine",
        letter: None,
        label: "M<1>",
        title: "Mine & yours <b>",
        idea: "a < b",
        defines: [true, false, false],
    };
}

impl ListedEnergy for Mine {
    type Method<T: Real> = GompperKroll<T>;

    fn method<T: Real>(settings: Settings<'_, T>) -> GompperKroll<T> {
        GompperKroll {
            modulus: settings.modulus,
            spontaneous_curvature: settings.spontaneous_curvature,
            area: DualArea::Mixed,
        }
    }
}

const MINE: OwnMethod = OwnMethod::energy_and_curvatures::<Mine>();

fn study(methods: Vec<AnyMethod>) -> Study {
    Study {
        shape: "discocyte".parse::<AnyShape>().expect("a shape"),
        families: vec![Family::Irregular],
        vertices: vec![162, 642],
        methods,
        options: MethodOptions::default(),
        scalars: vec![Scalar::F32, Scalar::F64],
        modulus: 2.0,
        seed: 1,
    }
}

fn rows_of(rows: &[Row], method: AnyMethod) -> Vec<(Scalar, usize, Quantity, [f64; 2])> {
    let own = rows.iter().filter(|row| row.method == method);
    own.map(|row| (row.scalar, row.vertices, row.quantity, [row.max, row.mean]))
        .collect()
}

#[test]
fn they_are_measured_and_shown() {
    let methods = vec![BendingMethod::GompperKroll.into(), MINE.into()];
    let rows = study(methods.clone()).run(&mut |_| {}).expect("a study");
    let [listed, own] = [methods[0], methods[1]].map(|method| rows_of(&rows, method));
    // H and f on two meshes in two number types.
    assert_eq!((own.len(), &own), (8, &listed));
    let html = Page {
        rows: &rows,
        verdicts: &verdicts(&rows),
        errors: &[],
        sections: &[],
        provenance: &Provenance::here(Build {
            commit: "",
            compiler: "",
            profile: "",
            flags: "",
            target: "",
        }),
        command: "study",
        when: SystemTime::UNIX_EPOCH,
        reused: 0,
    };
    let mut page = Vec::new();
    html.write(&mut page).expect("memory");
    let page = String::from_utf8(page).expect("text");
    assert!(page.contains("Mine &amp; yours &lt;b&gt;"));
    for raw in ["yours <b>", "M<1>", "a < b"] {
        assert!(!page.contains(raw), "{raw} is not escaped");
    }
}

#[test]
fn they_are_recommended() {
    let (mesh, _) = helfrich_tests::exact::OnShape {
        shape: "ellipsoid:1,0.8,0.7".parse().expect("a shape"),
        family: Family::Regular,
        vertices: 642,
        seed: 1,
    }
    .mesh();
    let request = Request {
        quantity: Quantity::Mean,
        norm: Norm::Mean,
        target: 0.05,
        methods: vec![MINE.into()],
        options: MethodOptions::default(),
        scalars: vec![Scalar::F64],
    };
    let found = recommend(
        &mesh.connectivity,
        &mesh.positions,
        &request,
        &|| false,
        &mut |_| {},
    );
    let found = found.expect("a reference").expect("an answer");
    assert_eq!(found.choice.expect("a choice").method, AnyMethod::Own(MINE));
}

#[test]
fn one_name_is_not_given_to_two() {
    let twice = study(vec![MINE.into(), BendingMethod::Meyer.into(), MINE.into()]);
    let refused = twice.run(&mut |_| {});
    assert!(matches!(refused, Err(StudyError::Name(_))), "{refused:?}");
    let message = refused.expect_err("refused").to_string();
    assert!(message.contains("`mine`"), "{message}");
}

proptest! {
    #![proptest_config(cases(16))]

    /// Strategies of exact meshes place vertices on their surfaces.
    #[test]
    fn exact_meshes_are_on_their_shapes(shape in on_shapes(400), star in on_stars()) {
        for (mesh, exact) in [shape.mesh(), star.mesh()] {
            prop_assert_eq!(mesh.positions.len(), exact.len());
            for (position, point) in mesh.positions.iter().zip(&exact) {
                // Positions are rounded once, and lengths are of order 1.
                for (found, exact) in position.iter().zip(point.position) {
                    prop_assert!((found - exact).abs() < 1e-12);
                }
            }
            // Triangles are oriented outward; otherwise H would have the wrong sign.
            let volume = mesh.surface().volume();
            prop_assert!(volume.is_some_and(|volume| volume > 0.0));
        }
    }
}
