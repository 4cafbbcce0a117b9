//! A mesh with positions.
