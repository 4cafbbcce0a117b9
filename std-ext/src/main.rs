//! The `helfrich` program.
fn main() {}
