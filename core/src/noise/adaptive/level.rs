//! Fits with one number of neighbours around every vertex, and the effect of noise on them.

use super::kind::{FitKind, ONE_SIDED};
use super::{Ground, ONE_STAGE, QUANTITIES, REPLICAS, Values};
use crate::element::{Execution, SlotKernel, Slots, Strided};
use crate::fit::{Graph, force_density};
use crate::neighbourhood::Neighbourhood;
use crate::noise::doubt::{Doubt, Fields};
use crate::noise::fit::{HeightFit, Model, reach};
use crate::noise::{DEGREES, Spectrum};
use crate::real::Real;
use crate::vec3::Vec3;
use alloc::vec;
use alloc::vec::Vec;

/// The results of one degree, NaN where there is no fit: H, K and f, and the changes of each by
/// [`REPLICAS`] independent errors of standard deviation 1 in every height.
#[derive(Clone, Debug)]
pub(super) struct Estimates<T> {
    pub(super) values: [Vec<T>; QUANTITIES],
    pub(super) changes: [Vec<Values<T>>; QUANTITIES],
}

/// Fits around every vertex.
pub(super) struct Level<T> {
    pub(super) kind: FitKind<T>,
    /// Results of degrees 4 and 6.
    pub(super) of_degrees: [Estimates<T>; 2],
    /// Number of neighbours, 0 where there is no fit.
    pub(super) neighbours: Vec<u32>,
    /// Degree of the fits with the higher degree.
    pub(super) degrees: Vec<u8>,
    /// The contributions of the degrees in interpolating fits.
    pub(super) spectra: Vec<Spectrum<T>>,
}

/// Results of the first stage at a vertex.
#[derive(Clone, Copy)]
struct AtVertex<T> {
    /// H and K of both degrees.
    values: [[T; 2]; 2],
    changes: [[Values<T>; 2]; 2],
    /// 1/ρ².
    over_area: T,
    neighbours: u32,
    degree: u8,
    spectrum: Spectrum<T>,
    /// f and its changes, where f follows from one polynomial.
    force: Option<(T, Values<T>)>,
}

/// Memory of a worker.
#[derive(Debug)]
pub(super) struct LevelScratch<T> {
    pub(super) near: Neighbourhood<T>,
    pub(super) fit: HeightFit<T>,
    /// The normal over whose plane heights were fitted.
    pub(super) normal: Vec3<T>,
    pub(super) coefficients: Vec<T>,
    rows: [Vec<T>; 3],
    /// b of the inversion before the last fit, if any, in inverse lengths: see [`HeightFit::invert`].
    pub(super) bend: Option<Vec3<T>>,
}

impl<T: Real> Default for LevelScratch<T> {
    fn default() -> Self {
        Self {
            near: Neighbourhood::default(),
            fit: HeightFit::default(),
            normal: [T::zero(); 3],
            coefficients: Vec::new(),
            rows: [const { Vec::new() }; 3],
            bend: None,
        }
    }
}

impl<T: Real> LevelScratch<T> {
    /// Fits the surface around a vertex. Returns the number of neighbours, 0 if they do not determine
    /// the polynomial.
    #[inline(always)]
    pub(super) fn fit(
        &mut self,
        ground: &Ground<'_, T>,
        vertex: usize,
        kind: &FitKind<T>,
    ) -> usize {
        let surface = ground.surface;
        let [first, most] = kind.neighbours;
        let is_one_sided = kind.model.interpolates && ground.rings[vertex] == 0;
        let [more, than] = ONE_SIDED;
        // To one side, neighbours determine no polynomial as well as that.
        let in_any_order = kind.in_any_order && !is_one_sided;
        let mut wanted = if is_one_sided {
            first * more / than
        } else if kind.model.interpolates {
            first
        } else {
            ground.share(vertex, first)
        };
        loop {
            let near = &mut self.near;
            let count = reach(surface, &ground.normals, vertex as u32, wanted, near);
            self.fit
                .gather(surface, vertex as u32, &near.found[..count], &kind.model);
            self.normal = ground.upright[vertex];
            self.bend = None;
            let conditioning = self.fit.fit(&mut self.normal, &kind.model);
            let is_last = count < wanted || wanted == most;
            let least = T::constant(kind.conditioning[usize::from(is_last)]);
            // The bound is at most the entry, and takes longer.
            if conditioning >= least
                && (!in_any_order || self.fit.conditioning(&kind.model) >= least)
            {
                return count;
            }
            if is_last {
                return 0;
            }
            wanted = (wanted + wanted / 4).min(most);
        }
    }

    /// Fits the nearest neighbours of a vertex, as many as the jets of the library have. Returns their number, 0 if
    /// they do not determine the polynomial.
    pub(super) fn fit_nearest(
        &mut self,
        ground: &Ground<'_, T>,
        vertex: usize,
        model: &Model<T>,
        count: usize,
    ) -> usize {
        self.near.nearest(ground.surface, vertex as u32, count);
        self.fit
            .gather(ground.surface, vertex as u32, &self.near.found, model);
        self.normal = ground.upright[vertex];
        self.bend = None;
        // Also false for NaN.
        if self.fit.fit(&mut self.normal, model) > T::zero() {
            self.near.found.len()
        } else {
            0
        }
    }

    /// The doubt about the last fit, over `count` neighbours, by its coefficients of a degree and its row of Δ_S.
    pub(super) fn doubt(
        &mut self,
        ground: &Ground<'_, T>,
        vertex: usize,
        (model, degree, count): (&Model<T>, usize, usize),
        laplacian: &[T],
        fields: Fields<'_, T>,
    ) -> Doubt<T> {
        self.fit.coefficients(model, degree, &mut self.coefficients);
        Doubt::new(
            &self.fit,
            model,
            (degree, self.normal, &self.coefficients),
            (
                ground.surface.mesh().one_ring(vertex),
                &self.near.found[..count],
            ),
            laplacian,
            fields,
        )
    }

    /// The bending force by one interpolating polynomial, and its changes by errors of the heights. The
    /// changes are central differences whose relative step is the cube root of the machine precision.
    fn one_stage(
        &mut self,
        ground: &Ground<'_, T>,
        model: &Model<T>,
        vertices: &[u32],
    ) -> (T, Values<T>) {
        let radius = self.fit.radius();
        let over = (radius * radius * radius).recip();
        let step = T::epsilon().cbrt() * radius;
        let here = ground.errors(vertices[0]);
        let mut with = |replica: usize, factor: T| {
            let error =
                |row: usize| factor * (ground.errors(vertices[row + 1])[replica] - here[replica]);
            let coefficients = &mut self.coefficients;
            self.fit
                .coefficients_with(model, model.degree, error, coefficients);
            over * force_density(coefficients)
        };
        let value = with(0, T::zero());
        let changes = core::array::from_fn(|replica| {
            (with(replica, step) - with(replica, -step)) / (step + step)
        });
        (value, changes)
    }

    /// Takes H, K, f and their changes from the one-sided fit with the least standard error.
    fn take_one_sided(
        &mut self,
        ground: &Ground<'_, T>,
        vertex: usize,
        kind: &FitKind<T>,
        count: usize,
        at: &mut AtVertex<T>,
    ) {
        let (model, count) = self.flatten(ground, vertex, kind, count);
        at.neighbours = count as u32;
        at.degree = model.degree as u8;
        let others = self.near.found[..count].iter().map(|&(_, other)| other);
        let vertices = Vec::from_iter(core::iter::once(vertex as u32).chain(others));
        at.force = Some(self.one_stage(ground, &model, &vertices));
        // Not needed for one stage.
        let mut row = vec![0.0; vertices.len()];
        for which in 0..DEGREES.len() {
            self.take(ground, &model, which, &vertices, at, &mut row);
        }
    }

    /// The nearest vertices that the last fit used.
    pub(super) fn neighbours(&self, count: usize) -> &[(T, u32)] {
        &self.near.found[..count]
    }

    /// Takes H, K, their changes and the row of Δ_S from the fit.
    #[inline(always)]
    fn take(
        &mut self,
        ground: &Ground<'_, T>,
        model: &Model<T>,
        which: usize,
        vertices: &[u32],
        at: &mut AtVertex<T>,
        row: &mut [f32],
    ) {
        let degree = [DEGREES[0], model.degree][which];
        let own = usize::from(!model.interpolates);
        let radius = self.fit.radius();
        self.fit.coefficients(model, degree, &mut self.coefficients);
        let graph = Graph::in_radii(&self.coefficients[own..], radius.recip());
        at.values[which] = graph.curvatures();
        let [of_mean, mut of_gaussian] = graph.variations(radius);
        if let Some(bend) = self.bend {
            // The change of the normal is left out: the surface leans by less than 0.1.
            let more = self.subtracted(&graph, bend);
            let twice = more + more;
            let [mean, gaussian] = at.values[which];
            at.values[which] = [mean + more, gaussian + twice * mean + more * more];
            for (of_gaussian, of_mean) in of_gaussian.iter_mut().zip(of_mean) {
                *of_gaussian += twice * of_mean;
            }
        }
        let laplacian = graph
            .laplacian_in_radii(radius)
            .map(|factor| factor * radius * radius);
        self.fit.rows(
            model,
            degree,
            &[of_mean, of_gaussian, laplacian],
            &mut self.rows,
        );
        let [of_mean, of_gaussian, laplacian] = &self.rows;
        // The errors are those of heights relative to the vertex, unless the vertex has a sample of its
        // own.
        let here = ground.errors(vertices[0]);
        for (changes, row) in at.changes[which].iter_mut().zip([of_mean, of_gaussian]) {
            *changes = [T::zero(); REPLICAS];
            for (&vertex, &entry) in vertices[1 - own..].iter().zip(row) {
                let there = ground.errors(vertex);
                for ((change, &there), &here) in changes.iter_mut().zip(there).zip(here) {
                    let error = if own == 1 { there } else { there - here };
                    *change += entry * error;
                }
            }
        }
        for (entry, &value) in row[1 - own..].iter_mut().zip(laplacian) {
            *entry = value.to_f32().unwrap_or(f32::NAN);
        }
    }
}

/// The fits of a level.
struct LevelFits<'a, T> {
    ground: &'a Ground<'a, T>,
    kind: &'a FitKind<T>,
    /// Number of rings from a boundary beyond which there are no fits.
    rings: u8,
}

/// Results at a vertex, its neighbours, and the rows of both degrees.
type FitSlots<'a, T> = (&'a mut [AtVertex<T>], (Strided<'a, u32>, Strided<'a, f32>));

impl<'a, T: Real> SlotKernel<LevelScratch<T>, FitSlots<'a, T>> for LevelFits<'_, T> {
    #[inline(always)]
    fn set(&self, scratch: &mut LevelScratch<T>, start: usize, slots: FitSlots<'a, T>) {
        let Self {
            ground,
            kind,
            rings,
        } = *self;
        let room = kind.room();
        for (vertex, (at, (vertices, rows))) in (start..).zip(slots.into_slots()) {
            if ground.rings[vertex] >= rings {
                continue;
            }
            let count = scratch.fit(ground, vertex, kind);
            if count == 0 {
                continue;
            }
            if kind.model.interpolates && ground.rings[vertex] < ONE_STAGE {
                scratch.take_one_sided(ground, vertex, kind, count, at);
                continue;
            }
            at.degree = DEGREES[1] as u8;
            at.neighbours = count as u32;
            let radius = scratch.fit.radius();
            at.over_area = (radius * radius).recip();
            vertices[0] = vertex as u32;
            for (entry, &(_, neighbour)) in vertices[1..].iter_mut().zip(&scratch.near.found) {
                *entry = neighbour;
            }
            let vertices = &vertices[..=count];
            let is_smooth = ground.mark(vertex, &scratch.near.found[..count]).is_none();
            if kind.model.interpolates && is_smooth {
                at.spectrum = scratch.fit.spectrum(&kind.model);
            }
            for (which, row) in rows.chunks_exact_mut(room).enumerate() {
                scratch.take(ground, &kind.model, which, vertices, at, &mut row[..=count]);
            }
        }
    }
}

impl<T: Real> Level<T> {
    /// Fits around every vertex of a surface.
    pub(super) fn new(
        execution: &impl Execution,
        ground: &Ground<'_, T>,
        kind: &FitKind<T>,
    ) -> Self {
        Self::within(execution, ground, kind, u8::MAX)
    }

    /// Fits around the vertices less than `rings` from a boundary.
    pub(super) fn within(
        execution: &impl Execution,
        ground: &Ground<'_, T>,
        kind: &FitKind<T>,
        rings: u8,
    ) -> Self {
        let count = ground.normals.len();
        let room = kind.room();
        let none = AtVertex {
            values: [[T::nan(); 2]; 2],
            changes: [[[T::nan(); REPLICAS]; 2]; 2],
            over_area: T::nan(),
            neighbours: 0,
            degree: 0,
            spectrum: Spectrum::default(),
            force: None,
        };
        let mut all = vec![none; count];
        let mut vertices = vec![0_u32; count * room];
        let mut laplacians = vec![0.0_f32; count * 2 * room];
        let slots = (
            &mut all[..],
            (
                Strided::new(&mut vertices, room),
                Strided::new(&mut laplacians, 2 * room),
            ),
        );
        let fits = LevelFits {
            ground,
            kind,
            rings,
        };
        let mut scratch = Vec::new();
        execution.run(&mut scratch, slots, &fits);
        let of_degrees = [0, 1]
            .map(|which| Estimates::new(execution, &all, which, &vertices, &laplacians, room));
        Self {
            kind: *kind,
            of_degrees,
            neighbours: all.iter().map(|at| at.neighbours).collect(),
            degrees: all.iter().map(|at| at.degree).collect(),
            spectra: all.iter().map(|at| at.spectrum).collect(),
        }
    }
}

impl<T: Real> Estimates<T> {
    /// The second stage: f from Δ_S of the fitted H.
    fn new(
        execution: &impl Execution,
        all: &[AtVertex<T>],
        which: usize,
        vertices: &[u32],
        laplacians: &[f32],
        room: usize,
    ) -> Self {
        let two = T::constant(2.0);
        let mut forces = vec![(T::nan(), [T::nan(); REPLICAS]); all.len()];
        execution.map(&mut forces[..], |vertex, (force, changes)| {
            let at = &all[vertex];
            if at.neighbours == 0 {
                return;
            }
            if let Some(one_stage) = at.force {
                (*force, *changes) = one_stage;
                return;
            }
            let [mean, gaussian] = at.values[which];
            let [of_mean, of_gaussian] = &at.changes[which];
            let row = &laplacians[(2 * vertex + which) * room..][..=at.neighbours as usize];
            let others = &vertices[vertex * room..];
            let (mut sum, mut sums) = (T::zero(), [T::zero(); REPLICAS]);
            for (&other, &entry) in others.iter().zip(row) {
                let other = &all[other as usize];
                let entry = T::constant(f64::from(entry));
                sum += entry * (other.values[which][0] - mean);
                let there = &other.changes[which][0];
                for ((sum, &there), &here) in sums.iter_mut().zip(there).zip(of_mean) {
                    *sum += entry * (there - here);
                }
            }
            let by_mean = two * (T::constant(3.0) * mean * mean - gaussian);
            *force = two * (at.over_area * sum + two * mean * (mean * mean - gaussian));
            for (replica, (change, sum)) in changes.iter_mut().zip(sums).enumerate() {
                let along = by_mean * of_mean[replica] - two * mean * of_gaussian[replica];
                *change = two * (at.over_area * sum + along);
            }
        });
        let of = |quantity: usize| {
            let values = all.iter().map(|at| at.values[which][quantity]);
            let changes = all.iter().map(|at| at.changes[which][quantity]);
            (Vec::from_iter(values), Vec::from_iter(changes))
        };
        let ((mean, of_mean), (gaussian, of_gaussian)) = (of(0), of(1));
        let (force, of_force) = forces.into_iter().unzip();
        Self {
            values: [mean, gaussian, force],
            changes: [of_mean, of_gaussian, of_force],
        }
    }
}
