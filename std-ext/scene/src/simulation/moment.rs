//! The first moment of the forces of membranes, from which their stress follows.

use super::{Acting, Body, Repulsions, Simulation};
use crate::contact::repel;
use crate::flow::Membranes;
use crate::rheology::{Tensor, moment};
use helfrich::{Images, Repulsion, Surface};
use std::array;

impl Simulation {
    /// `Σ F x` of all forces on the fluid, whose rows have the components of F, from the effects that
    /// [`Self::resolve`] returns and from the velocities of the material. It does not depend on the images of a periodic box
    /// by which positions name the surfaces.
    ///
    /// The forces of a surface on itself have no sum, so that its own positions suffice. Two surfaces that act on each other
    /// across the ends of the box do so at the distance of images: if f acts on the first, and the second acts from its image
    /// at the distance L, then `f x₁ − f (x₂ + L)` is the moment of the pair, and `−f L` has to be added to that of the
    /// positions. This holds pair by pair, because the energy of an interaction is a sum over pairs of surfaces.
    ///
    /// `None` if a position is not finite.
    pub fn moment(
        &mut self,
        acting: &[Acting],
        positions: &[[f64; 3]],
        material: &[[f64; 3]],
    ) -> Option<Tensor> {
        let mut sum = Tensor::default();
        for acting in acting {
            let own = moment(&acting.force, &positions[acting.vertices.clone()]);
            add(&mut sum, &own);
        }
        if self.are_viscous() {
            let mut forces = vec![[0.0; 3]; positions.len()];
            self.add_viscous_forces(positions, material, &mut forces);
            add(&mut sum, &moment(&forces, positions));
        }
        let surfaces = self.bodies.iter().map(|body| body.surface(positions));
        surfaces.collect::<Option<Vec<_>>>()?;
        if self.images.is_periodic() {
            for between in &mut self.between {
                between.add_images(&self.bodies, positions, &mut sum)?;
            }
        }
        Some(sum)
    }
}

fn add(sum: &mut Tensor, other: &Tensor) {
    let both = sum.as_flattened_mut().iter_mut().zip(other.as_flattened());
    both.for_each(|(sum, other)| *sum += other);
}

impl Repulsions {
    /// Adds `−f L` of all pairs of surfaces, and of surfaces with their own images, that act on each other across the ends of
    /// the box.
    fn add_images(
        &mut self,
        bodies: &[Body],
        positions: &[[f64; 3]],
        sum: &mut Tensor,
    ) -> Option<()> {
        let images = self.repulsion.images;
        let alone = Repulsion {
            parts: false,
            first_group: None,
            images: Images::none(),
            ..self.repulsion
        };
        let reach = alone.range;
        let own = |body: &usize| &positions[bodies[*body].vertices()];
        let boxes = Vec::from_iter(self.bodies.iter().map(|body| corners(own(body))));
        let number = self.bodies.len();
        let pairs =
            (0..number).flat_map(|first| (first..number).map(move |second| [first, second]));
        let pairs = pairs.filter(|&[first, second]| {
            (first != second || images.own) && self.repulsion.acts(first, second)
        });
        for [first, second] in pairs {
            let [low, high] = boxes[first];
            let [other_low, other_high] = boxes[second];
            let along = |axis: usize| {
                let shifts = images.shifts(
                    axis,
                    low[axis] - other_high[axis] - reach,
                    high[axis] - other_low[axis] + reach,
                );
                let period = images.period(axis).unwrap_or_default();
                let counts = shifts
                    .into_iter()
                    .flat_map(|[from, to]| from as i64..=to as i64);
                counts.map(move |count| count as f64 * period)
            };
            let plane = along(0).flat_map(|x| along(1).map(move |y| [x, y]));
            for shift in plane.flat_map(|[x, y]| along(2).map(move |z| [x, y, z])) {
                // A surface meets each of its images twice, from both sides.
                let is_counted = first != second || shift > [0.0; 3];
                if shift == [0.0; 3] || !is_counted {
                    continue;
                }
                let [mesh, other] = [first, second].map(|of| bodies[self.bodies[of]].mesh());
                let image = own(&self.bodies[second]).iter();
                let image = image.map(|at| array::from_fn(|axis| at[axis] + shift[axis]));
                let image = Vec::from_iter(image);
                let here = own(&self.bodies[first]);
                let surfaces = [
                    Surface::new(mesh, here).ok()?,
                    Surface::new(other, &image).ok()?,
                ];
                let mut forces = [vec![[0.0; 3]; here.len()], vec![[0.0; 3]; image.len()]];
                let [felt, back] = &mut forces;
                let slices = &mut [&mut felt[..], &mut back[..]];
                repel(&self.execution, &alone, &surfaces, &mut self.memory, slices);
                let force: [f64; 3] =
                    array::from_fn(|axis| felt.iter().map(|force| force[axis]).sum());
                add(sum, &moment(&[force.map(|component| -component)], &[shift]));
            }
        }
        Some(())
    }
}

/// Opposite corners of the bounding box of some points.
fn corners(points: &[[f64; 3]]) -> [[f64; 3]; 2] {
    let start = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    points.iter().fold(start, |[low, high], point| {
        [
            array::from_fn(|axis| low[axis].min(point[axis])),
            array::from_fn(|axis| high[axis].max(point[axis])),
        ]
    })
}
