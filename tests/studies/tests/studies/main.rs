//! Studies: hard cases, the capsule in flow, and the program that makes their tables.

mod double_double;
mod flow;
mod program;
mod stability;
