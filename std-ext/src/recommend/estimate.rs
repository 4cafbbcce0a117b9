//! The best estimate of curvatures on a surface with noise, and its error.
//!
//! Methods are compared with the best of many estimates, made of the same positions: J6, and regression
//! jets of degrees 4 and 6 with ever more neighbours, averaged ever wider. Noise of the size that was found
//! is put on top of all of them alike; what it changes is the variance V of an estimate, and of the
//! distance of two. Each has a reference that the shape leaves alone more, B is how far they are apart
//! beyond what noise explains, extrapolated to no distance, and the least B² + V wins.

use crate::generate::random::Random;
use crate::method::{BendingMethod, Evaluator, Fields};
use crate::noise::{COPIES, averaged, regression, regression_fields};
use crate::study::{Quantity, Reference};
use helfrich::{Noise, RegressionFields, RegressionFits, Surface, SurfaceError, TriangleMesh};

/// Neighbours of regression jets: the error of the best of these is hardly larger than of any number.
const LADDER: [usize; 8] = [45, 64, 90, 128, 181, 256, 362, 512];

/// Neighbours from which on degree 4 has samples enough, and averages are taken.
const WIDE: usize = 64;

/// Part of a mesh that a neighbourhood may be.
const LARGEST_PART: f64 = 2.0 / 3.0;

/// By which factor neighbourhoods have to grow on average; less where the surface turns too far for more.
const LEAST_GROWTH: f64 = 1.17;

/// Neighbours of all fits together that may be kept: some gigabytes.
const MOST_ENTRIES: usize = 50_000_000;

/// Number of repeated averages; each doubles the number of averaging steps.
const DOUBLINGS: u32 = 5;

/// Part of the variance of a distance that it is known to at best.
const UNCERTAIN: f64 = 0.1;

type Values = [f64; COPIES];

/// One estimate of all quantities.
struct Candidate {
    /// H, K, Δ_S H and f, one entry a vertex; empty but for H and what is asked for.
    values: [Vec<Values>; 4],
    bias: Bias,
}

/// By how much the shape is off.
enum Bias {
    /// Taken as none: what others are compared with.
    Unknown,
    /// These times the distance from another, of H and K, and of Δ_S H and f.
    Distance { from: usize, factors: [f64; 2] },
    /// The same, and no less than of the other.
    AtLeast { from: usize, factor: f64 },
    /// The distance from another and what that is off.
    Added { to: usize },
}

/// The best estimate of one quantity.
pub(super) struct Estimate {
    /// Its values as what methods are compared with.
    pub(super) reference: Reference,
    /// Its errors by noise and by the shape, largest and mean, relative.
    pub(super) noise: [f64; 2],
    pub(super) bias: [f64; 2],
    /// Whether it is J6 itself.
    pub(super) is_j6: bool,
}

/// The place of J6 among candidates, after the jets of degree 8.
const J6: usize = 1;

/// Candidates, each with its distances from others known.
struct Candidates {
    quantity: Quantity,
    all: Vec<Candidate>,
    /// Areas of the vertices, 0 where nothing is known; their sum is 1.
    areas: Vec<f64>,
}

/// A candidate that was chosen.
struct Choice {
    index: usize,
    /// Squares of what the shape and noise make of it.
    bias: f64,
    variance: f64,
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
        let choice = candidates.choose(which, &candidates.areas);
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
        })
    }

    /// The size of both its errors.
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
        let mut candidates = Self {
            quantity,
            all: Vec::new(),
            areas,
        };
        candidates.add(jets(Evaluator::reference(1.0, mesh))?, Bias::Unknown);
        let sixth = jets(Evaluator::new(BendingMethod::J6, 1.0, mesh))?;
        let factors = [1.0; 2];
        candidates.add(sixth, Bias::Distance { from: 0, factors });
        candidates.climb(surface, &errors);
        Ok(candidates)
    }

    /// Adds regression jets, and averages of them.
    fn climb(&mut self, surface: Surface<'_, f64>, errors: &[Values]) {
        let vertices = surface.mesh().vertex_count();
        let mut widest: Option<(f64, RegressionFits<f64, COPIES>)> = None;
        let mut from = J6;
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
            let bias = Bias::Distance { from, factors };
            from = self.add(sixth, bias);
            if neighbours >= WIDE {
                let factor = 1.2;
                let bias = Bias::Distance {
                    from,
                    factors: [factor; 2],
                };
                let fourth = self.add(fourth, bias);
                for from in [from, fourth] {
                    let averages = self.average(from, &fits, 1);
                    self.add(averages, Bias::AtLeast { from, factor });
                }
            }
            widest = Some((reached, fits));
        }
        let Some((_, fits)) = widest.filter(|_| self.all.len() > J6 + 2) else {
            return;
        };
        for doubling in 0..DOUBLINGS {
            let to = self.all.len() - 1;
            let averages = self.average(to, &fits, 1 << doubling);
            self.add(averages, Bias::Added { to });
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
        self.all.push(Candidate { values, bias });
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

    /// The candidate with the least B² + V of a quantity, by these weights, whose sum is 1.
    fn choose(&self, which: usize, weights: &[f64]) -> Choice {
        let mut biases: Vec<f64> = Vec::new();
        let mut best: Option<Choice> = None;
        for (index, candidate) in self.all.iter().enumerate() {
            let values = &candidate.values[which];
            let apart = |from: usize| {
                let other = &self.all[from].values[which];
                let both = || values.iter().zip(other);
                let distance = mean_square(weights, both().map(|(a, b)| a[0] - b[0]));
                let by_noise = (1..COPIES).map(|copy| {
                    let changes = both().map(|(a, b)| a[copy] - a[0] - (b[copy] - b[0]));
                    mean_square(weights, changes)
                });
                let by_noise = by_noise.sum::<f64>() / (COPIES - 1) as f64;
                (distance - by_noise).max(0.0) + UNCERTAIN * by_noise
            };
            let bias = match candidate.bias {
                Bias::Unknown => 0.0,
                Bias::Distance { from, factors } => {
                    apart(from) * factors[usize::from(which > 1)].powi(2)
                }
                Bias::AtLeast { from, factor } => (apart(from) * factor * factor).max(biases[from]),
                Bias::Added { to } => (apart(to).sqrt() + biases[to].sqrt()).powi(2),
            };
            biases.push(bias);
            let changes =
                (1..COPIES).map(|copy| mean_square(weights, values.iter().map(|a| a[copy] - a[0])));
            let variance = changes.sum::<f64>() / (COPIES - 1) as f64;
            let is_less = |best: &Choice| bias + variance < best.bias + best.variance;
            let mut known = values.iter().zip(weights);
            let is_known = known.all(|(value, weight)| *weight == 0.0 || value[0].is_finite());
            if index >= J6 && is_known && best.as_ref().is_none_or(is_less) {
                best = Some(Choice {
                    index,
                    bias,
                    variance,
                });
            }
        }
        best.unwrap_or(Choice {
            index: J6,
            bias: 0.0,
            variance: 0.0,
        })
    }

    /// The largest size of a quantity on the surface without noise. The largest of an estimate is larger by
    /// its noise; more noise of the same size says by which factor.
    fn largest(&self, which: usize) -> f64 {
        let choice = self.choose(which, &self.areas);
        let found = &self.all[choice.index].values[which];
        // What matters is how far off estimates are where values are large.
        let squares = found.iter().zip(&self.areas);
        let squares = squares.map(|(value, area)| match *area {
            0.0 => 0.0,
            area => area * value[0] * value[0],
        });
        let mut weights = Vec::from_iter(squares);
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        let choice = self.choose(which, &weights);
        let found = &self.all[choice.index].values[which];
        let largest = |copy: usize| {
            let known = found.iter().zip(&self.areas);
            let known = known.filter(|(_, area)| **area > 0.0);
            known.fold(0.0_f64, |most, (value, _)| value[copy].abs().max(most))
        };
        let again = (1..COPIES).map(|copy| largest(copy).powi(2)).sum::<f64>();
        let again = (again / (COPIES - 1) as f64).sqrt();
        let here = largest(0);
        if again > here {
            here * here / again
        } else {
            here
        }
    }

    /// Largest and mean change by noise, root of the mean square over the copies.
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

/// Σ wᵢ xᵢ², without terms of weight 0 or NaN.
fn mean_square(weights: &[f64], values: impl Iterator<Item = f64>) -> f64 {
    let terms = weights.iter().zip(values);
    let terms = terms.filter(|(weight, value)| **weight > 0.0 && value.is_finite());
    terms.map(|(weight, value)| weight * value * value).sum()
}

fn values(fields: RegressionFields<f64, COPIES>) -> [Vec<Values>; 4] {
    [
        fields.mean,
        fields.gaussian,
        fields.laplacian_of_mean,
        fields.force_density,
    ]
}

/// A method on the surface and on its copies, whose vertices are moved along normals.
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
