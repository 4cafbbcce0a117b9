//! Bending methods and their operators: common laws, and the behaviour of each.

use helfrich_tests::allocation::Counting;

mod allocation;
mod convergence;
mod corrected;
mod coverage;
mod execution;
mod finite_elements;
mod galerkin;
mod heat_kernel;
mod jets;
mod juelicher;
mod laplacian;
mod laws;
mod loop_subdivision;
mod material;
mod memory;
mod open;
mod own;
mod paraboloid;
mod points;
mod precision;
mod range;
mod run_time;
mod spontaneous;
mod workspaces;

#[global_allocator]
static ALLOCATOR: Counting = Counting;
