//! Drivers: relaxation, integration in time, and capsules in flow.

mod capsules;
mod immersed;
mod integrators;
mod relaxation;
mod scenes;
