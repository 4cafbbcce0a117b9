//! What a run leaves, and what it says of its bodies.

mod deformation;
mod files;
mod plots;
