//! Results of the article that asked the question of this library, beside its own.
//!
//! A. Guckenberger, M. P. Schraml, P. G. Chen, M. Leonetti, S. Gekle, *On the bending algorithms for soft objects in
//! flows*, Comput. Phys. Commun. 207 (2016) 1–23, compares six bending methods on a red blood cell and in the flow
//! around a capsule.
//!
//! * [`curvature`]: the methods as published, and ours, on the exact cell; values along its meridian.
//! * [`flow`]: capsules in shear flow by both solvers, and their differences from published curves.
//! * [`literature`]: published deformations of capsules, with their sources.
//! * [`report`]: all of this as one page. Nothing is computed there.

pub mod curvature;
pub mod flow;
pub mod literature;
pub mod report;
