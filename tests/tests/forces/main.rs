//! Forces on membranes besides bending.

mod adhesion;
mod aspiration;
mod constraints;
mod dissipation;
mod domains;
mod edges;
mod elasticity;
mod functionals;
mod gravity;
mod interaction;
mod loads;
mod parameters;
