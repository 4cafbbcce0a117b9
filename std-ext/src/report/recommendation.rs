//! A recommendation in words.

use crate::recommend::{Candidate, RESOLVED, Recommendation};
use std::io::{self, Write};

/// Writes which method to take on a mesh, and what the others would do.
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
        reference_error,
        is_resolved,
        choice,
        nearest,
        vertices_needed,
        candidates,
    } = found;
    let symbol = quantity.symbol();
    let which = match *norm {
        "max" => "at every vertex",
        _ => "on average",
    };
    let target = percent(*target);
    let describe = |candidate: &Candidate| {
        format!(
            "{} in {}: error of {symbol} about {} {which}, {} an evaluation of {vertices} vertices",
            candidate.method,
            candidate.scalar,
            percent(candidate.expected),
            time(candidate.seconds)
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
                    "This mesh is too coarse or too rough to say: jets of degrees 4, 6 and 8 differ by more than {} of {symbol} at the worst vertex, and where they agree they may be wrong.",
                    percent(RESOLVED)
                )?;
            }
            if let Some(needed) = vertices_needed {
                writeln!(
                    out,
                    "By the order that theory gives it, j6 in f64 needs about {needed:.1e} vertices on the same surface."
                )?;
            }
        }
        (None, None) => writeln!(out, "No method that was asked says anything of {symbol}.")?,
    }
    writeln!(
        out,
        "\nmax and mean are distances from jets of degree 8, since nothing is known exactly; by how far degrees 6 and 4 are from those, {} is not known.",
        percent(*reference_error)
    )?;
    if compared < vertices {
        writeln!(
            out,
            "Compared at {compared} of {vertices} vertices: not at a boundary, nor where there are too few neighbours."
        )?;
    }
    writeln!(
        out,
        "\n{:13} {:8} {:>10} {:>10} {:>10}  {:>9}",
        "method", "scalar", "max", "mean", "expected", "time"
    )?;
    writeln!(out, "{}", "─".repeat(66))?;
    for candidate in candidates {
        writeln!(
            out,
            "{:13} {:8} {:>10} {:>10} {:>10}  {:>9}{}",
            candidate.method,
            candidate.scalar,
            percent(candidate.max),
            percent(candidate.mean),
            percent(candidate.expected),
            time(candidate.seconds),
            if candidate.reaches { "  ✓" } else { "" }
        )?;
    }
    Ok(())
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

fn time(seconds: f64) -> String {
    match seconds {
        seconds if seconds < 1e-3 => format!("{:.1} µs", 1e6 * seconds),
        seconds if seconds < 1.0 => format!("{:.1} ms", 1e3 * seconds),
        seconds => format!("{seconds:.2} s"),
    }
}
