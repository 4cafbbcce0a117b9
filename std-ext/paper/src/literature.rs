//! Published deformations of neo-Hookean capsules in shear flow at viscosity ratio 1.

use crate::flow::{BENDING, CAPILLARY_NUMBER, published};
use helfrich_run::plots::{PublishedCurve, parsed};
use serde::Serialize;

/// The error of values that were digitised from figures.
pub const DIGITISED: f64 = 0.002;

/// The error of the values of [`prototype`].
pub const COMPUTED: f64 = 0.0005;

/// A steady deformation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Steady {
    /// Who published it.
    pub source: String,
    /// The file of this repository that has it, or the formula.
    pub from: &'static str,
    /// Ca = μγ̇a/G.
    pub capillary: f64,
    /// κ/(a²G).
    pub bending: f64,
    /// Taylor deformation.
    pub deformation: f64,
    /// The error of this number: of digitising a figure, or of the computation; 0 of a formula.
    pub error: f64,
}

/// A row of `capsules.csv`, which an independent prototype has computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Computed {
    /// The law of in-plane elasticity, as in scenes.
    pub law: String,
    /// Ca = μγ̇a/G.
    pub capillary: f64,
    /// κ/(a²G).
    pub bending: f64,
    /// Taylor deformation on 1280 and 5120 triangles, and extrapolated.
    pub deformations: [f64; 3],
    /// Inclination in degrees.
    pub inclination: f64,
}

/// Steady capsules by an independent prototype of boundary integrals.
pub fn prototype() -> Vec<Computed> {
    let text = include_str!("../data/capsules.csv");
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    let row = |line: &str| {
        let (law, numbers) = line.split_once(',')?;
        let numbers = numbers.split(',').map(str::parse);
        let numbers = numbers.collect::<Result<Vec<f64>, _>>().ok()?;
        let [capillary, bending, a, b, c, inclination] = numbers.try_into().ok()?;
        Some(Computed {
            law: law.to_owned(),
            capillary,
            bending,
            deformations: [a, b, c],
            inclination,
        })
    };
    // A test checks that every line is read.
    lines.filter_map(row).collect()
}

/// Meshes of [`prototype`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mesh {
    /// 1280 triangles.
    Coarse,
    /// 5120 triangles.
    Fine,
    /// Extrapolated from both.
    Extrapolated,
}

/// The neo-Hookean capsules of [`prototype`] on one mesh.
pub fn computed(mesh: Mesh) -> impl Iterator<Item = Steady> {
    let on = match mesh {
        Mesh::Coarse => "1280 triangles",
        Mesh::Fine => "5120 triangles",
        Mesh::Extrapolated => "extrapolated",
    };
    let own = prototype().into_iter();
    let own = own.filter(|row| row.law == "neo-hookean");
    own.map(move |row| Steady {
        source: format!("prototype of boundary integrals, independent, {on}"),
        from: "capsules.csv",
        capillary: row.capillary,
        bending: row.bending,
        deformation: row.deformations[mesh as usize],
        error: COMPUTED,
    })
}

/// All published steady deformations, the article's first of each pair of parameters.
pub fn steady() -> Vec<Steady> {
    let of = |curve: &PublishedCurve, from, [capillary, deformation]: [f64; 2], bending| Steady {
        source: curve.name.clone(),
        from,
        capillary,
        bending,
        deformation,
        error: DIGITISED,
    };
    let mut found = Vec::new();
    for curve in published() {
        // The curves are over time: the last value is the steady one.
        if let Some(&[_, steady]) = curve.points.last() {
            let at = [CAPILLARY_NUMBER, steady];
            found.push(of(&curve, crate::flow::PUBLISHED, at, BENDING));
        }
    }
    for (from, bytes, bending) in [
        (
            "with-bending.csv",
            &include_bytes!("../data/with-bending.csv")[..],
            BENDING,
        ),
        (
            "without-bending.csv",
            &include_bytes!("../data/without-bending.csv")[..],
            0.0,
        ),
    ] {
        // A test checks that they can be read.
        for curve in parsed(bytes).unwrap_or_default() {
            let points = curve.points.iter();
            found.extend(points.map(|&point| of(&curve, from, point, bending)));
        }
    }
    found.extend(computed(Mesh::Extrapolated));
    found.push(Steady {
        source: "theory of small deformations, Barthès-Biesel and Rallison 1981".to_owned(),
        from: "(25/12) Ca/(1 + 11 κ/(a²G))",
        capillary: CAPILLARY_NUMBER,
        bending: BENDING,
        deformation: 25.0 / 12.0 * CAPILLARY_NUMBER / (1.0 + 11.0 * BENDING),
        error: 0.0,
    });
    found
}
