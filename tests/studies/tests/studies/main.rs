//! Studies: hard cases, the capsule in flow, costs, and the program that makes their tables.

mod costs;
mod double_double;
mod flow;
mod paper;
mod program;
mod stability;
