//! What acts on membranes besides bending.

mod constraints;
mod dissipation;
mod elasticity;
mod functionals;
mod gravity;
mod interaction;
mod loads;
