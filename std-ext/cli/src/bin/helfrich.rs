//! The program `helfrich`: see the library of this package.

use std::process::ExitCode;

fn main() -> ExitCode {
    helfrich_cli::program()
}
