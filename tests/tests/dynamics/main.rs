//! Drivers: relaxation and integration in time.

mod integrators;
mod relaxation;
