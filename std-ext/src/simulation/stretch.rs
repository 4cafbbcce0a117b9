//! A surface that is pulled by one load after the other.

use crate::scene;
use helfrich::{LoadError, PointLoads, Surface};

/// The loads of a stretched surface, one after the other.
#[derive(Debug)]
pub(super) struct Stretch {
    axis: [f64; 3],
    forces: Vec<f64>,
    loads: Vec<PointLoads<f64>>,
    current: usize,
}

impl Stretch {
    pub(super) fn new(
        surface: Surface<'_, f64>,
        scene: &scene::Stretching,
    ) -> Result<Self, LoadError> {
        let loads = scene
            .forces
            .iter()
            .map(|&force| PointLoads::opposite_ends(surface, scene.axis, scene.fraction, force));
        Ok(Self {
            axis: glam::DVec3::from_array(scene.axis).normalize().to_array(),
            forces: scene.forces.clone(),
            loads: loads.collect::<Result<_, _>>()?,
            current: 0,
        })
    }

    pub(super) fn axis(&self) -> [f64; 3] {
        self.axis
    }

    pub(super) fn force(&self) -> f64 {
        self.forces[self.current]
    }

    pub(super) fn count(&self) -> usize {
        self.forces.len()
    }

    /// The loads with this number, or the last.
    pub(super) fn set(&mut self, load: usize) -> PointLoads<f64> {
        self.current = load.min(self.count() - 1);
        self.loads[self.current].clone()
    }
}
