//! Any bytes as legacy VTK: an error of one line, or a mesh with finite positions.
#![no_main]

use helfrich_std::io::Format;
use helfrich_tests::invariants::check_reader;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| check_reader(bytes, Format::Vtk));
