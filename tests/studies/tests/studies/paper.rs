//! The page that remakes the article: its data, its measurements, its verdicts.

use crate::flow::row;
use helfrich::shapes::{Discocyte, Shape};
use helfrich_paper::curvature::{ALONG, CellStudy, METHODS, QUANTITIES, as_published};
use helfrich_paper::flow::{BENDING, CAPILLARY_NUMBER, Solver};
use helfrich_paper::literature::{DIGITISED, Mesh, computed, prototype, steady};
use helfrich_paper::report::deviations::Agreement;
use helfrich_paper::report::{CellResults, Page};
use helfrich_std::generate::{AnyShape, Family};
use helfrich_std::method::{AnyMethod, BendingMethod};
use helfrich_std::provenance::{Build, Provenance};
use helfrich_std::report::page::Origin;
use helfrich_std::scalar::Scalar;
use helfrich_std::study::Session;
use helfrich_tests::tolerance::Tolerance;
use std::time::SystemTime;

/// Values of jets on 642 vertices, relative to the largest exact value.
const MERIDIAN: Tolerance = Tolerance::new(
    0.1,
    "the largest error of f of J6 on the regular mesh of 642 vertices is 8 %",
);

/// Lengths along the meridian, relative.
const ARC: Tolerance = Tolerance::new(1e-5, "chords of 1024 parts of a quarter of the meridian");

fn study(methods: &[BendingMethod], families: &[Family], vertices: &[usize]) -> CellStudy {
    CellStudy {
        shape: AnyShape::Discocyte(Discocyte::new(1.0).expect("a radius")),
        families: families.to_vec(),
        vertices: vertices.to_vec(),
        methods: methods.iter().copied().map(AnyMethod::from).collect(),
        seed: 1,
    }
}

fn rows(study: &CellStudy) -> Vec<helfrich_std::study::Row> {
    let mut session = Session {
        progress: &mut |_| (),
        interrupted: &|| false,
        cache: None,
        allocated: None,
        timed: false,
    };
    study.rows(&[Scalar::F64], &mut session).expect("meshes")
}

/// Every line of the data is read, with the parameters of its publication.
#[test]
fn published_data_are_complete() {
    assert_eq!(prototype().len(), 5);
    let found = steady();
    let count = |capillary: f64, bending: f64| {
        let same = found.iter();
        same.filter(|row| (row.capillary, row.bending) == (capillary, bending))
            .count()
    };
    // The article, five others, two theories and the prototype.
    assert_eq!(count(CAPILLARY_NUMBER, BENDING), 9);
    assert_eq!([0.15, 0.3, 0.6].map(|ca| count(ca, 0.0)), [2, 3, 3]);
    let on = |mesh| Vec::from_iter(computed(mesh).map(|row| row.deformation));
    assert_eq!(on(Mesh::Coarse), [0.1352, 0.3924, 0.3968, 0.5207]);
    assert_eq!(on(Mesh::Fine), [0.1338, 0.3932, 0.3976, 0.5221]);
    assert!(found[0].source.contains("Guckenberger"), "{found:?}");
    assert_eq!(found[0].deformation, 0.1334);
}

/// Each option acts on the method that was published with it, and rows are in the order of families and methods.
#[test]
fn methods_have_the_options_of_their_publications() {
    let methods = [
        BendingMethod::GompperKroll,
        BendingMethod::Meyer,
        BendingMethod::Belkin,
    ];
    let families = [Family::Irregular, Family::Regular];
    let rows = rows(&study(&methods, &families, &[92]));
    for row in &rows {
        assert_eq!(row.options, as_published(row.method), "{}", row.method);
        assert!(!row.is_timed());
    }
    let mut kinds = Vec::from_iter(rows.iter().map(|row| (row.family, row.method.name())));
    kinds.dedup();
    let names = methods.map(BendingMethod::name);
    let expected = ["irregular", "regular"].map(|family| names.map(|name| (family, name)));
    assert_eq!(kinds, expected.concat());
    let options = methods.map(|method| as_published(method.into()).to_string());
    assert_eq!(options[1], "", "{options:?}");
    assert!(options[0].contains("voronoi") && options[2].contains("published"));
}

/// Values of an accurate method lie on the exact line, whose length is that of the meridian.
#[test]
fn jets_follow_the_exact_line() {
    let study = study(&[BendingMethod::J6], &[Family::Regular], &[642]);
    let exact = study.meridian();
    let [length, ..] = exact[exact.len() - 1];
    // Twice as many chords, by the shape itself.
    let at = |step: u32| {
        let (sine, cosine) = (std::f64::consts::FRAC_PI_2 * f64::from(step) / 4096.0).sin_cos();
        study.shape.position([sine, 0.0, cosine])
    };
    let chord = |step: u32| {
        let [a, b] = [at(step), at(step + 1)];
        (a[0] - b[0]).hypot(a[2] - b[2])
    };
    let expected = (0..4096).map(chord).sum::<f64>();
    ARC.assert(length, expected, expected, "length");
    let found = study.nodes(642, None, &mut |_, _| ()).expect("a mesh");
    let nodes = &found[0].nodes;
    assert!((30..90).contains(&nodes.len()), "{}", nodes.len());
    for (place, quantity) in QUANTITIES.into_iter().enumerate() {
        let scale = exact.iter().map(|point| point[place + 1].abs());
        let scale = scale.fold(0.0, f64::max);
        for node in nodes {
            let after = exact.iter().position(|point| point[0] >= node.arc);
            let line = exact[after.expect("on the meridian")][place + 1];
            MERIDIAN.assert(node.values[place], line, scale, quantity.symbol());
        }
    }
}

/// The largest error over vertices with six neighbours and over the others is that of the study.
#[test]
fn errors_at_vertices_are_those_of_the_study() {
    let methods = [BendingMethod::Meyer, BendingMethod::Farutin];
    let study = study(&methods, &[Family::Regular, Family::Relaxed], &[162]);
    let rows = rows(&study);
    let nodes = study.nodes(162, None, &mut |_, _| ()).expect("meshes");
    assert_eq!(nodes.len(), 4);
    for found in &nodes {
        assert_eq!(found.nodes.is_empty(), !ALONG.contains(&found.family));
        for (place, quantity) in QUANTITIES.into_iter().enumerate() {
            let spread = found.spreads[place].expect("both methods define it");
            let other = spread.other.expect("twelve vertices with five neighbours");
            let same = |row: &&helfrich_std::study::Row| {
                (row.family, row.method) == (found.family.name(), found.method)
                    && row.quantity == quantity
            };
            let row = rows.iter().find(same).expect("a row");
            let largest = spread.six.max(other);
            assert_eq!(largest, row.max, "{} {quantity:?}", found.method);
            assert_eq!(spread.valence == 6, spread.six > other);
        }
    }
}

/// The three verdicts, with their bounds.
#[test]
fn verdicts_follow_their_bounds() {
    for (difference, expected) in [
        (0.002, Agreement::Agrees),
        (-0.0021, Agreement::Near),
        (0.0066, Agreement::Near),
        (-0.0068, Agreement::Differs),
        (f64::NAN, Agreement::Differs),
    ] {
        let found = Agreement::of(difference, 0.1334, DIGITISED);
        assert_eq!(found, expected, "{difference}");
    }
}

/// The page has what it promises: its figures, the rows of its tables, and the source of each datum.
#[test]
fn the_page_has_figures_rows_and_sources() {
    let study = study(&METHODS, &[Family::Regular, Family::Irregular], &[42, 162]);
    let (rows, nodes) = (rows(&study), study.nodes(162, None, &mut |_, _| ()));
    let nodes = nodes.expect("meshes");
    let mut exact = row(6.0, 7.0, 0.1334);
    exact.case.solver = Solver::BoundaryIntegral;
    let capsules = [exact, row(6.0, 7.0, 0.1434)];
    let provenance = Provenance::here(Build {
        commit: "0123456789ab",
        compiler: "rustc",
        profile: "dev",
        flags: "",
        target: "none",
    });
    let page = Page {
        cell: Some(CellResults {
            study: &study,
            rows: &rows,
            nodes: &nodes,
        }),
        capsules: Some(&capsules),
        precision: None,
        quick: true,
        origin: Origin {
            provenance: &provenance,
            command: "helfrich paper",
            when: SystemTime::UNIX_EPOCH,
            reused: 0,
        },
    };
    let mut html = Vec::new();
    let charts = page.write(&mut html).expect("memory");
    let html = String::from_utf8(html).expect("text");
    for (id, _) in &charts {
        let drawn = html.matches(&format!("id=\"{id}\" viewBox")).count();
        assert_eq!(drawn, 1, "{id}");
    }
    let of = |start: &str| {
        charts
            .iter()
            .filter(|(id, _)| id.starts_with(start))
            .count()
    };
    // Three quantities, two norms, two families; f of eight methods, H of seven and ΔH of four along the meridian.
    assert_eq!(of("error-vertices"), 3 * 2 * 2);
    assert_eq!(of("meridian"), 2 * (8 + 7 + 4));
    assert_eq!((of("flow"), of("review")), (2, 2));
    for source in steady() {
        assert!(
            html.contains(&source.source.replace('&', "&amp;")),
            "{source:?}"
        );
    }
    for part in [
        "id=\"published-deviations\"",
        "capsule-shear-published.csv",
        "not in this repository",
        "commit 0123456789ab",
        "N = 42 … 162",
        "quick form",
        "helfrich 0.1.0",
    ] {
        assert!(html.contains(part), "{part}");
    }
    let (_, table) = html
        .split_once("id=\"published-deviations\"")
        .expect("a table");
    let (table, _) = table.split_once("</table>").expect("its end");
    // The statement, two curves, and two rows of what is missing.
    assert_eq!(table.matches("<tr>").count(), 1 + 5);
    assert_eq!(
        html.matches("<section").count(),
        html.matches("</section>").count()
    );
    assert!(!html.contains("NaN"));
}
