//! Drivers: relaxation, integration in time, capsules and drops in flow, and open membranes.

mod at_rest;
mod axisymmetric;
mod capsules;
mod contact;
mod drops;
mod edges;
mod immersed;
mod integrators;
mod material;
mod relaxation;
mod scenes;
mod strong_form;
mod suspensions;
mod tubes;
mod vesicles;
