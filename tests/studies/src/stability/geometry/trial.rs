//! Evaluation of one method on one surface.

use super::is_single;
use crate::stability::specimen::Specimen;
use crate::stability::{Evaluation, Outcome};
use helfrich::{Finding, Quality, Real, Surface, SurfaceError, TriangleMesh};
use helfrich_std::method::{BendingMethod, Evaluated, Evaluator, Fields};
use helfrich_std::scalar::{HeldPositions, Scalar};
use std::cell::OnceCell;

/// One method on one surface in one number type.
#[derive(Clone, Copy)]
pub(super) struct Trial<'a> {
    pub(super) specimen: &'a Specimen,
    /// Findings about noise, which are the same for every method, once they are known.
    pub(super) noisy: &'a OnceCell<Vec<Finding>>,
    pub(super) method: BendingMethod,
    pub(super) scalar: Scalar,
    /// Whether the surface is also evaluated after a translation and a scaling.
    pub(super) invariance: bool,
}

impl Trial<'_> {
    pub(super) fn outcome(self) -> Outcome {
        let outcome = match self.scalar {
            Scalar::F32 | Scalar::F32Pair => self.evaluate::<f32>(),
            Scalar::F64 => self.evaluate::<f64>(),
        };
        outcome.map_or_else(
            |error| Outcome::Refused(error.to_string()),
            Outcome::Evaluated,
        )
    }

    fn evaluate<T: Evaluated>(self) -> Result<Evaluation, SurfaceError> {
        let Specimen {
            mesh,
            scale,
            offset,
            ..
        } = self.specimen;
        let mut evaluator = Evaluator::<T>::new(self.method, T::one(), mesh);
        let held = self.held(|x| scale * (x + offset));
        let surface = held.surface(mesh)?;
        let fields = evaluator.fields(surface);
        let quality = self.quality(&evaluator, surface);
        let energy = evaluator.energy(surface);
        let errors = self.errors(&fields);
        let error = largest_known(errors.iter().copied());
        let flags = quality.flagged();
        let flagged = flags.iter().filter(|flagged| **flagged).count();
        let counts = |vertex: usize| !flags[vertex] || flagged == flags.len();
        let unflagged = errors.iter().zip(flags);
        let unflagged = unflagged.filter(|(_, flagged)| !**flagged);
        let unflagged = largest_known(unflagged.map(|(&error, _)| error));
        let [mut moved, mut scaled] = [None, None];
        if self.invariance {
            scaled = Some(self.scaled(&mut evaluator, mesh, &fields)?);
            if (*scale, *offset) == (1.0, 0.0) {
                moved = Some(self.moved(&mut evaluator, mesh)?);
            }
        }
        let known = !errors.is_empty();
        Ok(Evaluation {
            finite: is_finite(&fields) && energy.is_finite(),
            error: known.then_some(error),
            unflagged_error: (known && flagged < flags.len()).then_some(unflagged),
            slope: known.then(|| self.slope(&fields, counts)),
            moved,
            scaled,
            findings: quality.findings().len(),
            flagged,
            vertices: flags.len(),
            checksum: checksum(&fields),
        })
    }

    /// [`Evaluator::quality`], with the noise of an earlier method on the same surface.
    fn quality<T: Evaluated>(self, evaluator: &Evaluator<T>, surface: Surface<'_, T>) -> Quality {
        let noisy = self.noisy.get_or_init(|| {
            let quality = evaluator.quality(surface);
            let is_noise = |finding: &Finding| matches!(finding, Finding::NoisyPosition { .. });
            let noisy = quality.findings().iter().copied();
            noisy.filter(is_noise).collect()
        });
        Quality::gather(surface.mesh(), |report| {
            let own = evaluator.findings(surface);
            own.into_iter()
                .chain(noisy.iter().copied())
                .for_each(report);
        })
    }

    /// Positions with `map` applied to each coordinate, in the number type.
    fn held<T: Real>(self, map: impl Fn(f64) -> f64) -> HeldPositions<T> {
        let positions = self.specimen.positions.iter().map(|x| x.map(&map));
        HeldPositions::new(self.scalar, &Vec::from_iter(positions))
    }

    /// |f − exact f| at each vertex, relative to the largest |exact f|. A vertex without a value has the whole
    /// exact f as its error. Empty if f is not known exactly.
    fn errors<T: Real>(self, fields: &Fields<T>) -> Vec<f64> {
        let exact = &self.specimen.exact;
        let scale = exact.iter().map(|point| point.force_density(1.0).abs());
        let scale = scale.fold(0.0, f64::max);
        // κ/L³ at the size L of the surface.
        let unit = self.specimen.scale.powi(3);
        let error = |(found, point): (&Option<[T; 3]>, &helfrich::shapes::ExactPoint<f64>)| {
            let value = point.force_density(1.0);
            let found = found.unwrap_or([T::zero(); 3]).map(double);
            let part = |axis: usize| unit * found[axis] - value * point.normal[axis];
            let [x, y, z] = [part(0), part(1), part(2)];
            x.hypot(y).hypot(z) / scale
        };
        fields.force_density.iter().zip(exact).map(error).collect()
    }

    /// Σ A f_found·n f/Σ A f² over the vertices that count; a vertex without a value has none.
    fn slope<T: Real>(self, fields: &Fields<T>, counts: impl Fn(usize) -> bool) -> f64 {
        let unit = self.specimen.scale.powi(3);
        let (mut product, mut square) = (0.0, 0.0);
        for (vertex, point) in self.specimen.exact.iter().enumerate() {
            if !counts(vertex) {
                continue;
            }
            let (area, exact) = (double(fields.area[vertex]), point.force_density(1.0));
            let found = fields.force_density[vertex].unwrap_or([T::zero(); 3]);
            let along = (0..3).map(|axis| double(found[axis]) * point.normal[axis]);
            product += area * unit * along.sum::<f64>() * exact;
            square += area * exact * exact;
        }
        product / square
    }

    /// Change of f if positions are multiplied by a power of two, relative to exact scaling.
    fn scaled<T: Evaluated>(
        self,
        evaluator: &mut Evaluator<T>,
        mesh: &TriangleMesh,
        fields: &Fields<T>,
    ) -> Result<f64, SurfaceError> {
        let Specimen { scale, offset, .. } = self.specimen;
        // A small surface is enlarged, a large one reduced.
        let exponent = if is_single(self.scalar) { 20 } else { 40 };
        let factor = 2.0_f64.powi(if *scale > 1.0 { -exponent } else { exponent });
        let held = self.held(|x| factor * (scale * (x + offset)));
        let there = evaluator.fields(held.surface(mesh)?);
        Ok(defect(fields, &there, factor.powi(3)))
    }

    /// Change of f if positions on a grid are moved by a multiple of its pitch.
    fn moved<T: Evaluated>(
        self,
        evaluator: &mut Evaluator<T>,
        mesh: &TriangleMesh,
    ) -> Result<f64, SurfaceError> {
        let pitch = 2.0_f64.powi(if is_single(self.scalar) { -20 } else { -49 });
        let grid = |x: f64| (x / pitch).round() * pitch;
        let (here, there) = (self.held(grid), self.held(|x| grid(x) + 5.0));
        let here = evaluator.fields(here.surface(mesh)?);
        let there = evaluator.fields(there.surface(mesh)?);
        Ok(defect(&here, &there, 1.0))
    }
}

fn double<T: Real>(value: T) -> f64 {
    value.to_f64().unwrap_or(f64::NAN)
}

/// Largest of non-negative numbers; infinity if any is NaN.
fn largest_known(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| {
        if value.is_nan() {
            f64::INFINITY
        } else {
            most.max(value)
        }
    })
}

/// Largest deviation of f from `factor` times the other f, relative to the largest |f|.
fn defect<T: Real>(fields: &Fields<T>, other: &Fields<T>, factor: f64) -> f64 {
    let vectors = |fields: &Fields<T>| {
        let vector = |f: &Option<[T; 3]>| f.map(|f| f.map(double)).unwrap_or_default();
        Vec::from_iter(fields.force_density.iter().flat_map(vector))
    };
    let (here, there) = (vectors(fields), vectors(other));
    let pairs = here.iter().zip(&there);
    let most = largest_known(here.iter().map(|f| f.abs()));
    let change = largest_known(pairs.map(|(here, there)| (here - factor * there).abs()));
    if change == 0.0 { 0.0 } else { change / most }
}

/// Fowler, Noll and Vo's hash (FNV-1a) of the bits of f.
fn checksum<T: Real>(fields: &Fields<T>) -> u64 {
    let vectors = fields.force_density.iter().flatten().flatten();
    let bytes = vectors.flat_map(|&f| double(f).to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

fn is_finite<T: Real>(fields: &Fields<T>) -> bool {
    let Fields {
        area,
        normal,
        mean,
        gaussian,
        laplacian_of_mean,
        force_density,
    } = fields;
    let scalars = [mean, gaussian, laplacian_of_mean];
    let scalars = scalars.into_iter().flatten().flatten();
    let vectors = normal.iter().chain(force_density.iter().flatten());
    let mut all = scalars.chain(area).chain(vectors.flatten());
    all.all(|value| value.is_finite())
}
