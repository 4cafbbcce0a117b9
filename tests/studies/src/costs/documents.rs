//! The texts that state costs: tables of the guides, and the constants of the program.
//!
//! Between the lines [`START`] and [`END`] of a guide, cells of tables are filled by the method or family of their row
//! and the title of their column, and a line that begins with "Measured" names the measurement.

use super::Costs;
use helfrich_std::method::BendingMethod;
use helfrich_std::report::page::text::{digits, percent};
use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The measured costs, in the folder of the repository.
pub const DATA: &str = "docs/costs.json";

/// The guides that state costs.
pub const GUIDES: [&str; 3] = ["README.md", "docs/CHOOSING.md", "docs/GALERKIN.md"];

/// The source file with the constants of the program.
pub const CONSTANTS: &str = "std-ext/evaluate/src/method/relative.rs";

/// Mark of an escaped vertical line.
const ESCAPED: &str = "\u{1}";

/// First line of a part of a guide with costs.
pub const START: &str = "<!-- costs -->";

/// Last line of this part.
pub const END: &str = "<!-- end of costs -->";

/// Reads the measured costs of the repository in this folder.
///
/// # Errors
/// If there are none.
pub fn read(root: &Path) -> io::Result<Costs> {
    let path = root.join(DATA);
    let named =
        |error: &dyn std::fmt::Display| io::Error::other(format!("{}: {error}", path.display()));
    let text = fs::read_to_string(&path).map_err(|error| named(&error))?;
    serde_json::from_str(&text).map_err(|error| named(&error))
}

/// Every file of the repository in this folder that states costs, with the text that states these.
///
/// # Errors
/// If a guide cannot be read.
pub fn texts(root: &Path, costs: &Costs) -> io::Result<Vec<(PathBuf, String)>> {
    let mut texts = vec![
        (root.join(DATA), serde_json::to_string_pretty(costs)? + "\n"),
        (root.join(CONSTANTS), constants(costs)),
    ];
    for guide in GUIDES {
        let path = root.join(guide);
        let text = fs::read_to_string(&path);
        let text =
            text.map_err(|error| io::Error::other(format!("{}: {error}", path.display())))?;
        texts.push((path, filled(&text, costs)));
    }
    Ok(texts)
}

/// A guide with these costs.
pub fn filled(guide: &str, costs: &Costs) -> String {
    let mut text = String::with_capacity(guide.len());
    let mut inside = false;
    let mut titles = Vec::new();
    for line in guide.lines() {
        inside = match line {
            START => true,
            END => false,
            _ => inside,
        };
        // A vertical line inside a cell is escaped, and separates no cells.
        let escaped = line.replace("\\|", ESCAPED);
        let cells = escaped.split('|');
        let cells = Vec::from_iter(cells.map(|cell| cell.trim().replace(ESCAPED, "\\|")));
        if !inside {
            text.push_str(line);
        } else if line.starts_with("Measured") {
            let Costs {
                commit,
                date,
                build,
                machine,
                ..
            } = costs;
            let _ = write!(
                text,
                "Measured by `helfrich-studies costs`, one thread, f64: commit {commit}, {date}, {build}, {machine}."
            );
        } else if !line.starts_with('|') {
            titles.clear();
            text.push_str(line);
        } else if titles.is_empty() {
            titles = cells;
            text.push_str(line);
        } else {
            let costs = cells
                .iter()
                .zip(&titles)
                .map(|(_, title)| costs.cell(line, title));
            let costs = Vec::from_iter(costs);
            if costs.iter().all(Option::is_none) {
                text.push_str(line);
            } else {
                let row = costs.into_iter().zip(cells);
                let row = Vec::from_iter(row.map(|(cost, cell)| cost.unwrap_or(cell)));
                text.push_str(row.join(" | ").trim());
            }
        }
        text.push('\n');
    }
    text
}

impl Costs {
    /// The cell of a row under this title, if it is a cost.
    fn cell(&self, row: &str, title: &str) -> Option<String> {
        let is_of = |name: &str| row.contains(&format!("`{name}`"));
        let method = self.methods.iter().find(|cost| is_of(&cost.method));
        let family = self.galerkin.iter().find(|cost| is_of(&cost.family));
        match title {
            "time, B = 1" => Some(digits(method?.relative)),
            "ns/vertex" => Some(digits(method?.nanoseconds)),
            "bytes/vertex" => Some(digits(method?.bytes)),
            "of boundary integrals" => Some(method?.flow.map_or("–".to_owned(), percent)),
            "energy and gradient" => Some(digits(family?.energy)),
            "f" => Some(digits(family?.density)),
            _ => None,
        }
    }
}

/// The source file of the constants: two digits for each method.
fn constants(costs: &Costs) -> String {
    let mut text = "//! Times of the methods, written by `helfrich-studies costs --update`. A new method has 1 here until it is\n\
         //! measured.\n\n\
         use super::BendingMethod;\n\n\
         /// Time of an evaluation of f, or of H and K for operators without a force, relative to that of method B.\n\
         pub(super) const fn relative(method: BendingMethod) -> f64 {\n    match method {\n"
        .to_owned();
    for method in BendingMethod::NAMED {
        let mut own = costs
            .methods
            .iter()
            .filter(|cost| cost.method == method.name());
        let relative = own.next().map_or(1.0, |cost| constant(cost.relative));
        let _ = writeln!(text, "        BendingMethod::{method:?} => {relative:?},");
    }
    text.push_str("    }\n}\n");
    text
}

/// The constant of the program for a measured cost: its first two digits.
pub fn constant(cost: f64) -> f64 {
    format!("{cost:.1e}").parse().unwrap_or(cost)
}
