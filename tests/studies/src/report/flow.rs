//! Tables of a study of flow.

use helfrich_paper::flow::{BENDING, FlowRow, Solver, boxes, deviation, published, resolved};
use helfrich_std::flow::lattice_boltzmann::limits::CAPSULE_BOX;
use helfrich_std::method::BendingMethod;
use helfrich_std::run::End;
use helfrich_std::scalar::Scalar;
use std::io::{self, Write};

/// Writes a study of flow as tables: every method with both solvers and the published results, then boxes,
/// resolutions and number types of the lattice.
///
/// # Errors
/// If `out` cannot be written to.
pub fn flow_tables(rows: &[FlowRow], out: &mut dyn Write) -> io::Result<()> {
    methods(rows, out)?;
    others(out)?;
    lattices(rows, out)?;
    precisions(rows, out)
}

fn methods(rows: &[FlowRow], out: &mut dyn Write) -> io::Result<()> {
    let paper = published().into_iter().next();
    writeln!(
        out,
        "Taylor deformation D of a neo-Hookean capsule in simple shear, Ca = μγ̇a/G = 0.15, κ/(a²G) = {BENDING}, λ = 1."
    )?;
    writeln!(
        out,
        "From the paper: largest difference of D(γ̇t) from its curve (methods C and S, digitised, ±0.002)."
    )?;
    writeln!(
        out,
        "\n{:13} {:>8}  {:34} {:>8} {:>6} {:>14} {:>8} {:>7}",
        "method", "vertices", "solver", "D", "θ", "from the paper", "volume", "s"
    )?;
    writeln!(out, "{}", "─".repeat(106))?;
    // Only the first lattice of each method; the other lattices have tables of their own.
    let mut shown: Vec<(BendingMethod, bool)> = Vec::new();
    for row in rows.iter().filter(|row| row.case.bending == BENDING) {
        let key = (row.case.method, row.case.solver == Solver::BoundaryIntegral);
        if shown.contains(&key) {
            continue;
        }
        shown.push(key);
        let deviation = paper.as_ref().and_then(|curve| deviation(row, curve));
        let deviation = deviation.map_or("–".to_owned(), |deviation| {
            format!("{:.4}", deviation.largest.abs())
        });
        writeln!(
            out,
            "{:13} {:>8}  {:34} {:>8.4} {:>5.1}° {deviation:>14} {:>8.0e} {:>7.1}{}",
            row.case.method,
            row.case.vertices,
            solver(row),
            row.outcome.deformation,
            row.outcome.inclination,
            row.outcome.volume_change.abs(),
            row.outcome.seconds,
            ending(row),
        )?;
    }
    Ok(())
}

fn others(out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "\nPublished steady values of the same case")?;
    for curve in published() {
        if let Some([_, steady]) = curve.points.last() {
            writeln!(out, "  {:44} {steady:>8.4}", curve.name)?;
        }
    }
    Ok(())
}

fn lattices(rows: &[FlowRow], out: &mut dyn Write) -> io::Result<()> {
    let boxes = boxes(rows);
    if boxes.is_empty() {
        return Ok(());
    }
    writeln!(
        out,
        "\nWithout the box: D(L) = D(∞) + c (a/L)³ by two cubes; {CAPSULE_BOX} is the paper's c. Then without the lattice: D + c h/a by two resolutions."
    )?;
    writeln!(
        out,
        "\n{:>8} {:>6} {:>15} {:>17} {:>6} {:>8} {:>8} {:>18} {:>6}",
        "κ/(a²G)",
        "a/h",
        "L/a",
        "D(L)",
        "c",
        "D(∞)",
        format!("by {CAPSULE_BOX}"),
        "boundary integral",
        ""
    )?;
    writeln!(out, "{}", "─".repeat(100))?;
    for found in &boxes {
        let [first, second] = found.sizes;
        let [d1, d2] = found.deformations;
        let exact = exact(rows, found.bending, found.vertices);
        writeln!(
            out,
            "{:>8} {:>6} {:>15} {:>17} {:>6.2} {:>8.4} {:>8.4} {:>18} {:>6}",
            found.bending,
            found.resolution,
            format!("{first}, {second}"),
            format!("{d1:.4}, {d2:.4}"),
            found.coefficient,
            found.unbounded,
            d1 - CAPSULE_BOX * first.powi(-3),
            exact.map_or("–".to_owned(), |exact| format!("{exact:.4}")),
            percent(found.unbounded, exact),
        )?;
    }
    for found in resolved(&boxes) {
        let [first, second] = found.resolutions;
        let [d1, d2] = found.deformations;
        let exact = exact(rows, found.bending, found.vertices);
        writeln!(
            out,
            "{:>8} {:>6} {:>15} {:>17} {:>6} {:>8.4} {:>8} {:>18} {:>6}",
            found.bending,
            "∞",
            format!("from {first}, {second}"),
            format!("{d1:.4}, {d2:.4}"),
            "",
            found.resolved,
            "",
            exact.map_or("–".to_owned(), |exact| format!("{exact:.4}")),
            percent(found.resolved, exact),
        )?;
    }
    Ok(())
}

/// Writes the runs in f32 beside the same runs in f64.
fn precisions(rows: &[FlowRow], out: &mut dyn Write) -> io::Result<()> {
    let single = rows.iter().filter(|row| precision(row) == Scalar::F32);
    let pairs = single.filter_map(|row| {
        let mut case = row.case;
        if let Solver::LatticeBoltzmann { precision, .. } = &mut case.solver {
            *precision = Scalar::F64;
        }
        Some((row, rows.iter().find(|other| other.case == case)?))
    });
    let pairs = Vec::from_iter(pairs);
    if pairs.is_empty() {
        return Ok(());
    }
    writeln!(
        out,
        "\n{:>8} {:>6} {:>6} {:>11} {:>11} {:>11} {:>8} {:>8}",
        "κ/(a²G)", "a/h", "L/a", "D, f32", "D, f64", "difference", "s, f32", "s, f64"
    )?;
    writeln!(out, "{}", "─".repeat(76))?;
    for (single, double) in pairs {
        let Solver::LatticeBoltzmann {
            resolution, size, ..
        } = single.case.solver
        else {
            continue;
        };
        writeln!(
            out,
            "{:>8} {resolution:>6} {size:>6} {:>11.7} {:>11.7} {:>11.0e} {:>8.1} {:>8.1}",
            single.case.bending,
            single.outcome.deformation,
            double.outcome.deformation,
            (single.outcome.deformation - double.outcome.deformation).abs(),
            single.outcome.seconds,
            double.outcome.seconds
        )?;
    }
    Ok(())
}

/// D with boundary integrals on the same mesh.
fn exact(rows: &[FlowRow], bending: f64, vertices: usize) -> Option<f64> {
    let same = |row: &&FlowRow| {
        row.case.solver == Solver::BoundaryIntegral
            && row.case.method == BendingMethod::GompperKroll
            && (row.case.bending, row.case.vertices) == (bending, vertices)
    };
    rows.iter().find(same).map(|row| row.outcome.deformation)
}

fn percent(value: f64, exact: Option<f64>) -> String {
    exact.map_or(String::new(), |exact| {
        format!("{:+.1} %", 100.0 * (value / exact - 1.0))
    })
}

fn precision(row: &FlowRow) -> Scalar {
    match row.case.solver {
        Solver::BoundaryIntegral => Scalar::F64,
        Solver::LatticeBoltzmann { precision, .. } => precision,
    }
}

fn solver(row: &FlowRow) -> String {
    match row.case.solver {
        Solver::BoundaryIntegral => "boundary integral".to_owned(),
        Solver::LatticeBoltzmann {
            resolution, size, ..
        } => format!("lattice, a = {resolution} h, L = {size} a"),
    }
}

fn ending(row: &FlowRow) -> String {
    match row.outcome.end {
        End::Completed => String::new(),
        _ => format!("  {}: {}", row.outcome.end.name(), row.outcome.message),
    }
}
