//! Remarks about a surface and the curvatures of a method there.

use crate::measurement::Measurement;
use crate::method::{AnyMethod, BendingMethod, Evaluated, Fields};
use crate::noise::noise_seen;
use crate::report::{first_of_each_kind, noise_of_positions};
use helfrich::{Cause, Finding, Measured, Surface, Verdict};
use std::fmt;

/// A remark about a surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// Whether results suffer.
    pub is_warning: bool,
    /// The words.
    pub text: String,
}

impl Remark {
    fn note(text: String) -> Self {
        Self {
            is_warning: false,
            text,
        }
    }

    fn warning(text: String) -> Self {
        Self {
            is_warning: true,
            text,
        }
    }

    /// `warning` or `note`.
    pub fn kind(&self) -> &'static str {
        if self.is_warning { "warning" } else { "note" }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {}", self.kind(), self.text)
    }
}

/// The number of findings of each kind, with the first.
pub fn of_findings(findings: &[Finding]) -> Vec<Remark> {
    let kinds = first_of_each_kind(findings).into_iter();
    let remarks = kinds.map(|(count, first)| Remark::warning(format!("{count} × {first}")));
    remarks.collect()
}

/// Causes that concern another vertex than the one they are told of.
const BESIDE: [(Cause, &str); 2] = [
    (
        Cause::BesideCrease,
        "the fit includes a crease, corner or tip: error bars are not known",
    ),
    (
        Cause::BesideOutlier,
        "the fit includes a vertex far off the surface: error bars are not known",
    ),
];

const UNRESOLVED: &str = "the mesh does not resolve the shape: refine it";
const UNKNOWN: &str =
    "neighbours determine no fit, or do not show its error: no values, or no error bars";

/// The reason for the error bars of a vertex, in words; empty if nothing is doubtful.
pub fn of_vertex(at: &Measured<f64>, vertex: u32) -> String {
    if let Some(finding) = at.cause.and_then(|cause| cause.finding(vertex)) {
        let first = first_of_each_kind(&[finding]).into_iter().next();
        let (_, text) = first.unwrap_or_default();
        // The place is known to the caller.
        let words = text.split(" (the first is ").next();
        return words.unwrap_or_default().to_owned();
    }
    let beside = BESIDE.iter().find(|(cause, _)| at.cause == Some(*cause));
    let text = match (beside, at.verdict) {
        (Some((_, text)), _) => text,
        (_, Verdict::Unresolved) => UNRESOLVED,
        (_, Verdict::Unknown) => UNKNOWN,
        (_, Verdict::OneSided) => "at a boundary, or next to it: fits are one-sided",
        (_, Verdict::Noise) => "noise of the positions",
        (_, Verdict::Clean) => "",
    };
    text.to_owned()
}

/// The verdicts of a measurement about the mesh.
pub fn of_measurement(surface: Surface<'_, f64>, measured: &Measurement) -> Vec<Remark> {
    let mut remarks = of_findings(&measured.findings());
    let noise = measured.noise(surface);
    if noise.is_seen() {
        let seen = noise_of_positions(&noise);
        remarks.push(Remark::note(format!(
            "noise of positions {seen}, taken to be independent from vertex to vertex: error bars do not contain errors \
             that neighbours share"
        )));
    }
    let vertices = &measured.vertices;
    let all = vertices.len();
    let mut told = |message: &str, count: usize| {
        let text = format!("{count} of {all} vertices: {message}");
        remarks.push(Remark::warning(text));
    };
    for (cause, message) in BESIDE {
        let count = vertices.iter().filter(|at| at.cause == Some(cause)).count();
        if count > 0 {
            told(message, count);
        }
    }
    let unexplained = |verdict: Verdict| {
        let without = vertices.iter().filter(|at| at.cause.is_none());
        without.filter(|at| at.verdict == verdict).count()
    };
    let unresolved = unexplained(Verdict::Unresolved);
    // From 2 % on.
    if 50 * unresolved > all {
        told(UNRESOLVED, unresolved);
    }
    let unknown = unexplained(Verdict::Unknown);
    if unknown > 0 {
        told(UNKNOWN, unknown);
    }
    remarks
}

/// Whether f of a method does not converge at every vertex of every mesh: that of jets does, with G on all
/// meshes but hard ones. Nothing is known of methods outside the list.
fn has_undetermined_force(method: AnyMethod) -> bool {
    use BendingMethod::{Galerkin, J4, J6, J8, Jet};
    let determined = [Jet, J4, J6, J8, Galerkin].map(AnyMethod::from);
    let listed = BendingMethod::NAMED.map(AnyMethod::from);
    method.has_force() && listed.contains(&method) && !determined.contains(&method)
}

/// A remark about the results of a method whose f does not converge.
pub fn of_method<T: Evaluated>(method: AnyMethod, fields: &Fields<T>) -> Option<Remark> {
    if !has_undetermined_force(method) || fields.force_density.iter().all(Option::is_none) {
        return None;
    }
    let quantities = match method.description().defines {
        [.., true] => "f and LapH",
        _ => "f",
    };
    Some(Remark::warning(format!(
        "{method} does not determine {quantities}: errors do not fall on finer meshes, and may be many times the values: \
         take --method jet"
    )))
}

/// The noise of positions that no measurement has told.
pub fn of_noise(surface: Surface<'_, f64>) -> Vec<Remark> {
    let noise = noise_seen(surface);
    if !noise.is_seen() {
        return Vec::new();
    }
    let mut findings = Vec::new();
    noise.inspect(surface, &mut |finding| findings.push(finding));
    let mut remarks = of_findings(&findings);
    let seen = noise_of_positions(&noise);
    remarks.push(match findings.is_empty() {
        true => Remark::note(format!("noise of positions {seen}")),
        false => Remark::warning(format!(
            "noise of positions {seen}: finer meshes of the same noise are worse; smooth the positions, take a coarser \
             mesh, or let `helfrich recommend` measure what is left"
        )),
    });
    remarks
}
