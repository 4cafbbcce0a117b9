//! The text of a recommendation.

use super::{SCATTERED, about_scatter, noise_of_positions};
use crate::answer::Norm;
use crate::recommend::{Candidate, RESOLVED, Recommendation};
use std::io::{self, Write};

/// Writes the recommended method for a mesh, and the results of the others.
///
/// # Errors
/// If `out` cannot be written to.
pub fn recommendation(found: &Recommendation, out: &mut dyn Write) -> io::Result<()> {
    let Recommendation {
        vertices,
        compared,
        quantity,
        norm,
        target,
        noise,
        noise_error,
        reference_error,
        is_resolved,
        choice,
        nearest,
        vertices_needed: _,
        candidates,
    } = found;
    let symbol = quantity.symbol();
    let which = match *norm {
        "max" => Norm::Max,
        _ => Norm::Mean,
    };
    let which = which.in_words();
    let target = percent(*target);
    let describe = |candidate: &Candidate| {
        format!(
            "{} in {}: error of {symbol} {} {} {which}, {} an evaluation of {vertices} vertices",
            candidate.method,
            candidate.scalar,
            if candidate.is_bound {
                "at most"
            } else {
                "about"
            },
            percent(candidate.expected),
            time(candidate)
        )
    };
    match (choice, nearest) {
        (Some(choice), _) => writeln!(out, "For {target} take {}.", describe(choice))?,
        (None, Some(nearest)) => {
            if *is_resolved {
                writeln!(
                    out,
                    "Nothing is known to reach {target} on this mesh. Nearest is {}.",
                    describe(nearest)
                )?;
            } else {
                writeln!(
                    out,
                    "This mesh is too coarse or too rough to say: {symbol} of j6 may be off by more than {} at the worst vertex, or nothing shows its error.",
                    percent(RESOLVED)
                )?;
            }
            remedy(found, out)?;
        }
        (None, None) => writeln!(out, "None of the chosen methods computes {symbol}.")?,
    }
    if noise.is_seen() {
        writeln!(
            out,
            "\nNoise of positions {} causes errors of {} in {symbol} of j6 {which}. The exact values are unknown: max and mean are distances from fits that average the noise (jet).",
            noise_of_positions(noise),
            percent(*noise_error)
        )?;
    } else {
        writeln!(
            out,
            "\nThe exact values are unknown: max and mean are distances from jets of degree 8. By its distances from these and from j4, the error of j6 is {}.",
            percent(*reference_error)
        )?;
    }
    if compared < vertices {
        writeln!(
            out,
            "Compared at {compared} of {vertices} vertices: not at a boundary, nor where there are too few neighbours."
        )?;
    }
    writeln!(
        out,
        "{symbol}: {}. Shares are of its largest value: at the worst vertex (max), on average (mean), and what the error is expected to be.",
        quantity.in_words()
    )?;
    writeln!(
        out,
        "\n{:13} {:8} {:>10} {:>10} {:>12}  {:>9}     idea",
        "method", "scalar", "max", "mean", "expected", "time"
    )?;
    writeln!(out, "{}", "─".repeat(110))?;
    for candidate in candidates {
        let sign = if candidate.is_bound { "≤ " } else { "" };
        writeln!(
            out,
            "{:13} {:8} {:>10} {:>10} {:>12}  {:>9}  {} {}",
            candidate.method,
            candidate.scalar,
            percent(candidate.max),
            percent(candidate.mean),
            format!("{sign}{}", percent(candidate.expected)),
            time(candidate),
            if candidate.reaches { "✓" } else { " " },
            candidate.method.idea(),
        )?;
    }
    about_scatter(candidates.iter().any(Candidate::is_scattered), out)
}

/// The remedy if no method reaches the target.
fn remedy(found: &Recommendation, out: &mut dyn Write) -> io::Result<()> {
    // Squares of errors due to noise and due to the mesh add up.
    let rules = 2.0 * found.noise_error.powi(2) > found.reference_error.powi(2);
    match found.vertices_needed {
        Some(needed) if needed < found.vertices as f64 => writeln!(
            out,
            "Noise dominates, and more vertices with the same noise are worse: j6 in f64 needs a coarser mesh, of about {needed:.1e} vertices on the same surface, or smoother positions."
        ),
        Some(needed) => writeln!(
            out,
            "By the order that theory gives it, j6 in f64 needs about {needed:.1e} vertices on the same surface."
        ),
        None if rules => writeln!(
            out,
            "Noise dominates, and no number of vertices with the same noise reaches it: smooth the positions, or measure them with less."
        ),
        None => Ok(()),
    }
}

fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent == 0.0 || (1e-3..1e4).contains(&percent) {
        let decimals = (1.0 - percent.max(1e-3).log10().floor()).clamp(0.0, 5.0) as usize;
        format!("{percent:.decimals$} %")
    } else {
        format!("{percent:.1e} %")
    }
}

fn time(candidate: &Candidate) -> String {
    let time = match candidate.seconds {
        seconds if seconds < 1e-3 => format!("{:.1} µs", 1e6 * seconds),
        seconds if seconds < 1.0 => format!("{:.1} ms", 1e3 * seconds),
        seconds => format!("{seconds:.2} s"),
    };
    if candidate.is_scattered() {
        format!("{SCATTERED}{time}")
    } else {
        time
    }
}
