//! The best estimate of curvatures on a surface with noise, and its error.
//!
//! Methods are compared with the best of many estimates from the same positions: J6, and regression
//! jets of degrees 4 and 6 with increasing numbers of neighbours, and averages of these. Noise of the
//! estimated size is added to the positions; the changes that it causes are the variance V of an
//! estimate, and of the distance between two. For each estimate there is another with less bias. The
//! bias B is the distance between the two, as far as noise does not explain it, extrapolated. Among
//! estimates of the same kind, a wider one loses more of the shape and has less noise: if the B of the
//! wider one is known to be smaller, it also bounds that of the narrower one. The estimate with the
//! least B² + V is chosen.

mod choice;
mod shape;

use crate::generate::random::Random;
use crate::method::{AnyMethod, BendingMethod, Evaluator, Fields};
use crate::noise::{COPIES, averaged, regression, regression_fields};
use crate::study::{Quantity, Reference};
use choice::FOURTH;
use helfrich::{Noise, RegressionFields, RegressionFits, Surface, SurfaceError, TriangleMesh};

/// Neighbours of regression jets: the best of these has hardly larger errors than the best of all
/// numbers.
const LADDER: [usize; 8] = [45, 64, 90, 128, 181, 256, 362, 512];

/// Least number of neighbours with which degree 4 has enough samples, and averages are taken.
const WIDE: usize = 64;

/// Largest part of a mesh that a neighbourhood may cover.
const LARGEST_PART: f64 = 2.0 / 3.0;

/// Least growth of neighbourhoods on average; they grow less where the surface turns away.
const LEAST_GROWTH: f64 = 1.17;

/// Largest number of neighbours of all fits together, which take some gigabytes.
const MOST_ENTRIES: usize = 50_000_000;

/// Largest number of doublings of the averages of the widest fits.
const DOUBLINGS: u32 = 8;

type Values = [f64; COPIES];

/// One estimate of all quantities.
struct Candidate {
    /// H, K, Δ_S H and f, one entry per vertex; all but H and the requested quantity are empty.
    values: [Vec<Values>; 4],
    bias: Bias,
    /// A wider estimate of the same kind, with more bias.
    wider: Option<usize>,
}

/// The rule for the bias of an estimate.
#[derive(Clone, Copy)]
enum Bias {
    /// Taken as zero: this estimate is the reference of others.
    Unknown,
    /// The distance from another estimate times a factor: one for H and K, and one for Δ_S H and f.
    Distance { from: usize, factors: [f64; 2] },
    /// [`FOURTH`] times the distance from another estimate, plus the bias of that estimate.
    Added { to: usize },
    /// For averages: from the distance to half as many averages, and from the fit that is averaged.
    Averages { half: usize, base: Base },
}

/// Fits that are averaged.
#[derive(Clone, Copy)]
enum Base {
    /// A fit of degree 6.
    Sixth(usize),
    /// A fit of degree 4, whose bias is its distance from as many averages of degree 6.
    Fourth(usize),
}

/// The best estimate of one quantity.
pub(super) struct Estimate {
    /// Its values, as the reference for methods.
    pub(super) reference: Reference,
    /// Its relative errors due to noise and due to the shape, largest and mean.
    pub(super) noise: [f64; 2],
    pub(super) bias: [f64; 2],
    /// Whether it is J6 itself.
    pub(super) is_j6: bool,
    /// Mean relative errors of J4 and J6 due to the shape, from their distances without the part of
    /// noise.
    by_shape: [f64; 2],
}

/// The places of the jets of degree 8 and of J6 among candidates.
const EIGHTH: usize = 0;
const J6: usize = 1;

/// The candidates, with the distances between them.
struct Candidates {
    quantity: Quantity,
    all: Vec<Candidate>,
    /// Values of J4 of the quantity.
    fourth: Vec<Values>,
    /// Areas of the vertices, 0 where nothing is known; their sum is 1.
    areas: Vec<f64>,
}

impl Estimate {
    /// The best estimate on positions with noise.
    pub(super) fn new(
        mesh: &TriangleMesh,
        positions: &[[f64; 3]],
        noise: Noise<f64>,
        quantity: Quantity,
    ) -> Result<Self, SurfaceError> {
        let surface = Surface::new(mesh, positions)?;
        let fields = Evaluator::new(BendingMethod::J6, 1.0, mesh).fields(surface);
        let candidates = Candidates::new(surface, &fields, noise, quantity)?;
        let which = quantity as usize;
        let choice = candidates.choose(which);
        let mut scales = [0.0; 4];
        for which in [Quantity::Mean as usize, which] {
            scales[which] = candidates.largest(which);
        }
        let values = &candidates.all[choice.index].values[which];
        let found = values.iter().zip(&fields.mean);
        // Vertices without a result of jets, at boundaries, are not compared.
        let found = found.map(|(value, known)| known.map_or(f64::NAN, |_| value[0]));
        let found = Vec::from_iter(found);
        let reference = Reference::estimated(quantity, found, &fields.normal, scales);
        let scale = reference.scale(quantity);
        let noise = candidates.norms(values).map(|norm| norm / scale);
        let larger = (choice.bias / choice.variance).sqrt();
        Ok(Self {
            reference,
            noise,
            bias: noise.map(|norm| norm * larger),
            is_j6: choice.index == J6,
            by_shape: candidates.by_shape().map(|error| error / scale),
        })
    }

    /// The mean relative error of J4 or J6 due to the shape.
    pub(super) fn by_shape(&self, method: AnyMethod) -> f64 {
        self.by_shape[usize::from(method == BendingMethod::J6)]
    }

    /// Both errors combined.
    pub(super) fn error(&self) -> [f64; 2] {
        [0, 1].map(|norm| self.bias[norm].hypot(self.noise[norm]))
    }
}

impl Candidates {
    fn new(
        surface: Surface<'_, f64>,
        fields: &Fields<f64>,
        noise: Noise<f64>,
        quantity: Quantity,
    ) -> Result<Self, SurfaceError> {
        let mesh = surface.mesh();
        let mut random = Random::new(3);
        let mut error = || noise.length * ((0..12).map(|_| random.unit()).sum::<f64>() - 6.0);
        let errors = (0..mesh.vertex_count())
            .map(|_| std::array::from_fn(|copy| if copy == 0 { 0.0 } else { error() }));
        let errors: Vec<Values> = errors.collect();
        let known = fields.mean.iter().zip(&fields.area);
        let areas = known.map(|(known, area)| known.map_or(0.0, |_| *area));
        let mut areas = Vec::from_iter(areas);
        let all: f64 = areas.iter().sum();
        areas.iter_mut().for_each(|area| *area /= all);
        let jets = |evaluator| jets(evaluator, surface, &fields.normal, &errors);
        let mut fourth = jets(Evaluator::new(BendingMethod::J4, 1.0, mesh))?;
        let mut candidates = Self {
            quantity,
            all: Vec::new(),
            fourth: std::mem::take(&mut fourth[quantity as usize]),
            areas,
        };
        candidates.add(jets(Evaluator::reference(1.0, mesh))?, Bias::Unknown);
        let sixth = jets(Evaluator::new(BendingMethod::J6, 1.0, mesh))?;
        let factors = [1.0; 2];
        candidates.add(
            sixth,
            Bias::Distance {
                from: EIGHTH,
                factors,
            },
        );
        candidates.climb(surface, &errors);
        Ok(candidates)
    }

    /// Adds regression jets, and averages of them.
    fn climb(&mut self, surface: Surface<'_, f64>, errors: &[Values]) {
        let vertices = surface.mesh().vertex_count();
        let mut widest: Option<(f64, RegressionFits<f64, COPIES>)> = None;
        let mut from = J6;
        let mut last: Option<usize> = None;
        for neighbours in LADDER {
            let part = neighbours as f64 / vertices as f64;
            if part > LARGEST_PART || neighbours * vertices > MOST_ENTRIES {
                break;
            }
            let fits = regression(surface, neighbours, errors);
            let reached = fits.neighbours();
            let factors = match &widest {
                None => [1.5; 2],
                Some((before, _)) if reached < LEAST_GROWTH * before => break,
                // A bias that grows as a power of the radius: the 6th in H and K, the 4th in Δ_S H.
                Some((before, _)) => {
                    [3, 2].map(|power| (1.0 - (before / reached).powi(power)).recip())
                }
            };
            let [fourth, sixth] = regression_fields(&fits).map(values);
            let wider = from;
            from = self.add(sixth, Bias::Distance { from, factors });
            if wider > J6 {
                self.all[wider].wider = Some(from);
            }
            if neighbours >= WIDE {
                let factors = [FOURTH; 2];
                let before = last.replace(self.add(fourth, Bias::Distance { from, factors }));
                if let Some(before) = before {
                    self.all[before].wider = last;
                }
                for from in last.into_iter().chain([from]) {
                    let averages = self.average(from, &fits, 1);
                    self.add(averages, Bias::Added { to: from });
                }
            }
            widest = Some((reached, fits));
        }
        if let (Some((_, fits)), Some(fourth)) = (widest, last) {
            self.average_again([from, fourth], &fits);
        }
    }

    /// Adds averages of degrees 6 and 4, each twice as many as before, until the bias exceeds the
    /// effect of noise.
    fn average_again(&mut self, bases: [usize; 2], fits: &RegressionFits<f64, COPIES>) {
        let mut half = bases;
        for doubling in 0..DOUBLINGS {
            let times = 1 << doubling.saturating_sub(1);
            let mut add = |place: usize, base| {
                let from = half[place];
                let averages = self.average(from, fits, times);
                let bias = Bias::Averages { half: from, base };
                half[place] = self.add(averages, bias);
                if from != bases[place] {
                    self.all[from].wider = Some(half[place]);
                }
                half[place]
            };
            let sixth = add(0, Base::Sixth(bases[0]));
            add(1, Base::Fourth(sixth));
            let which = self.quantity as usize;
            let bias = self.range(half[1], which, &self.areas).least;
            if bias > self.variance(half[1], which, &self.areas) {
                break;
            }
        }
    }

    fn add(&mut self, mut values: [Vec<Values>; 4], bias: Bias) -> usize {
        for (which, values) in values.iter_mut().enumerate() {
            if ![Quantity::Mean, self.quantity]
                .map(|q| q as usize)
                .contains(&which)
            {
                *values = Vec::new();
            }
        }
        self.all.push(Candidate {
            values,
            bias,
            wider: None,
        });
        self.all.len() - 1
    }

    /// A candidate after repeated averaging.
    fn average(
        &self,
        which: usize,
        fits: &RegressionFits<f64, COPIES>,
        times: usize,
    ) -> [Vec<Values>; 4] {
        let average = |values: &Vec<Values>| match values.is_empty() {
            true => Vec::new(),
            false => averaged(fits, values, times),
        };
        self.all[which].values.each_ref().map(average)
    }

    /// Largest and mean change due to noise, as root mean squares over the copies.
    fn norms(&self, values: &[Values]) -> [f64; 2] {
        let mut squares = [0.0; 2];
        for copy in 1..COPIES {
            let (mut largest, mut mean) = (0.0_f64, 0.0);
            for (value, area) in values.iter().zip(&self.areas) {
                if *area > 0.0 {
                    let change = (value[copy] - value[0]).abs();
                    largest = largest.max(change);
                    mean += area * change;
                }
            }
            for (square, norm) in squares.iter_mut().zip([largest, mean]) {
                *square += norm * norm / (COPIES - 1) as f64;
            }
        }
        squares.map(f64::sqrt)
    }
}

fn values(fields: RegressionFields<f64, COPIES>) -> [Vec<Values>; 4] {
    [
        fields.mean,
        fields.gaussian,
        fields.laplacian_of_mean,
        fields.force_density,
    ]
}

/// Results of a method on the surface and on its copies, whose vertices are displaced along normals.
fn jets(
    mut evaluator: Evaluator<f64>,
    surface: Surface<'_, f64>,
    normals: &[[f64; 3]],
    errors: &[Values],
) -> Result<[Vec<Values>; 4], SurfaceError> {
    let mut all = [(); 4].map(|()| vec![[f64::NAN; COPIES]; errors.len()]);
    for copy in 0..COPIES {
        let moved = surface.positions().iter().zip(normals).zip(errors);
        let moved = moved.map(|((position, normal), error)| {
            std::array::from_fn(|axis| position[axis] + error[copy] * normal[axis])
        });
        let moved: Vec<[f64; 3]> = moved.collect();
        let fields = evaluator.fields(Surface::new(surface.mesh(), &moved)?);
        for (all, found) in all.iter_mut().zip(along_normal(&fields)) {
            for (values, found) in all.iter_mut().zip(found) {
                values[copy] = found;
            }
        }
    }
    Ok(all)
}

/// H, K, Δ_S H and f along the normal; NaN where a method defines no value.
pub(super) fn along_normal(fields: &Fields<f64>) -> [Vec<f64>; 4] {
    let known = |values: &[Option<f64>]| {
        Vec::from_iter(values.iter().map(|value| value.unwrap_or(f64::NAN)))
    };
    let densities = fields.force_density.iter().zip(&fields.normal);
    let densities = densities.map(|(density, normal)| match density {
        Some(density) => (0..3).map(|axis| density[axis] * normal[axis]).sum(),
        None => f64::NAN,
    });
    [
        known(&fields.mean),
        known(&fields.gaussian),
        known(&fields.laplacian_of_mean),
        densities.collect(),
    ]
}
