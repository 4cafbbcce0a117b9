//! Drivers: relaxation, integration in time, and capsules in flow.

mod capsules;
mod integrators;
mod relaxation;
