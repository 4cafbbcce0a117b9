//! Texts about the findings of methods.

use helfrich::Finding;
use std::mem::discriminant;

/// The number of findings of each kind, with a description of the first.
pub fn first_of_each_kind(findings: &[Finding]) -> Vec<(usize, String)> {
    let words = |finding: &Finding| match finding {
        Finding::ZeroArea { vertex } => {
            format!("a vertex with area 0, left out (the first is vertex {vertex})")
        }
        Finding::NegativeArea { vertex } => {
            format!("a vertex with negative area, used as it is (the first is vertex {vertex})")
        }
        Finding::DegenerateTriangle { triangle } => {
            format!("a triangle without area, contributing nothing (the first is {triangle})")
        }
        Finding::Overstretched { triangle } => format!(
            "a triangle stretched beyond what this number type can hold (the first is {triangle})"
        ),
        Finding::ThinTriangle { triangle } => format!(
            "a triangle so thin that errors are amplified around it (the first is {triangle})"
        ),
        Finding::SmallArea { vertex } => {
            format!("a vertex whose area all but cancels (the first is vertex {vertex})")
        }
        Finding::ClampedArea { vertex } => format!(
            "a vertex whose area is not positive, replaced by a mixed one (the first is vertex {vertex})"
        ),
        Finding::Amplified { vertex } => {
            format!(
                "a vertex whose neighbours hardly determine a fit (the first is vertex {vertex})"
            )
        }
        Finding::NoGraph { vertex } => format!(
            "a vertex around which no graph over the triangles fits, which are taken as flat instead \
             (the first is vertex {vertex})"
        ),
        Finding::Unresolved { vertex } => format!(
            "a vertex where the mesh does not resolve the surface: choose a finer one (the first is \
             vertex {vertex})"
        ),
        Finding::Rows { vertex } => format!(
            "a vertex whose neighbours lie in rows and do not determine the fit: remesh the surface with \
             triangles as long as they are wide (the first is vertex {vertex})"
        ),
        Finding::Crease { vertex } => format!(
            "a vertex at a crease, corner or tip, where curvatures are not defined (the first is vertex {vertex})"
        ),
        Finding::Outlier { vertex } => format!(
            "a vertex far off the surface of its neighbours: correct or remove it (the first is vertex {vertex})"
        ),
        Finding::SmallComponent { vertex } => format!(
            "a vertex of a component with too few vertices to tell errors (the first is vertex {vertex})"
        ),
        Finding::Grid { vertex } => format!(
            "a vertex on an edge of a grid: ripples of a mask cannot be told from the shape, and error bars \
             include both (the first is vertex {vertex})"
        ),
        Finding::Uneven { vertex } => {
            format!("a vertex with edges of very different lengths (the first is vertex {vertex})")
        }
        Finding::UnusualValence { vertex } => format!(
            "a vertex with fewer than four or more than nine neighbours (the first is vertex {vertex})"
        ),
        Finding::Folded { vertex } => {
            format!("a vertex where the surface folds back (the first is vertex {vertex})")
        }
        Finding::RoundedPosition { vertex } => format!(
            "a vertex whose position is stored with too few digits for a fourth derivative \
             (the first is vertex {vertex})"
        ),
        Finding::NoisyPosition { vertex } => format!(
            "a vertex where a fourth derivative is lost in noise of the positions \
             (the first is vertex {vertex})"
        ),
        Finding::OutOfRange { vertex } => format!(
            "a vertex whose triangles are too small for a fourth derivative in this number type: \
             choose a smaller unit of length, or f64 (the first is vertex {vertex})"
        ),
        Finding::ReducedDegree { vertex, degree } => {
            format!("a vertex with a fit of lower degree (the first is vertex {vertex}: {degree})")
        }
        Finding::TooFewNeighbours { vertex } => {
            format!("a vertex with too few neighbours, left out (the first is vertex {vertex})")
        }
        other => format!("{other:?}"),
    };
    let mut kinds: Vec<(usize, &Finding)> = Vec::new();
    for finding in findings {
        let same = |kind: &&mut (usize, &Finding)| discriminant(kind.1) == discriminant(finding);
        match kinds.iter_mut().find(same) {
            Some(kind) => kind.0 += 1,
            None => kinds.push((1, finding)),
        }
    }
    kinds
        .into_iter()
        .map(|(count, first)| (count, words(first)))
        .collect()
}
