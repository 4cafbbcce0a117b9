//! Normal modes of an equilibrium: a table, and a statement about stability.

use super::{End, RunError};
use crate::dynamics::{Mode, modes};
use crate::io::replace_file;
use crate::scene::Relax;
use crate::simulation::Simulation;
use std::path::Path;

/// The table's name in its folder.
pub(super) const MODES: &str = "modes.csv";

/// The modes that the driver asks for, and a warning if there are none, or the shape is no equilibrium.
pub(super) fn found(
    relax: Relax,
    end: End,
    simulation: &mut Simulation,
    positions: &[[f64; 3]],
) -> (Vec<Mode>, Option<String>) {
    let count = usize::try_from(relax.modes).unwrap_or(usize::MAX);
    if count == 0 {
        return (Vec::new(), None);
    }
    let membranes = simulation.membranes();
    match modes(membranes, positions.to_vec(), simulation, count) {
        Ok(modes) => {
            let moving = !matches!(end, End::Converged | End::Unresolved);
            let warning = moving.then(|| {
                "`driver.modes`: the forces do not vanish, so that the modes are not those of an equilibrium"
                    .to_owned()
            });
            (modes, warning)
        }
        Err(error) => {
            let warning = format!("`driver.modes`: no modes were found: {error}");
            (Vec::new(), Some(warning))
        }
    }
}

/// Writes the table, or removes that of an earlier end.
pub(super) fn write(modes: &[Mode], folder: &Path) -> Result<(), RunError> {
    let path = folder.join(MODES);
    let written = if modes.is_empty() {
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        }
    } else {
        replace_file(&path, |out| {
            writeln!(out, "mode,stiffness,residual,rigid")?;
            for (mode, number) in modes.iter().zip(1..) {
                let Mode {
                    stiffness,
                    residual,
                    rigid,
                } = mode;
                writeln!(out, "{number},{stiffness:?},{residual:?},{rigid:?}")?;
            }
            Ok(())
        })
    };
    written.map_err(|source| RunError::Unwritable { path, source })
}

/// The stability of an equilibrium with these modes, in words.
pub fn stability(modes: &[Mode]) -> String {
    let rigid = modes.iter().filter(|mode| mode.is_rigid()).count();
    let shapes = || modes.iter().filter(|mode| !mode.is_rigid());
    let unstable = shapes()
        .filter(|mode| mode.stiffness < -mode.residual)
        .count();
    let undecided = shapes()
        .filter(|mode| mode.stiffness.abs() <= mode.residual)
        .count();
    let verdict = match (unstable, undecided) {
        (0, 0) if rigid == modes.len() => {
            "not decided: all modes are rigid motions, more are needed".to_owned()
        }
        (0, 0) => "stable".to_owned(),
        (0, undecided) => format!("not decided: {undecided} of no stiffness within their residual"),
        (unstable, _) => format!("unstable: {unstable} of negative stiffness"),
    };
    let count = modes.len();
    format!("{verdict} ({count} modes, of which rigid motions: {rigid})")
}
