//! Newton's method for stationary energies under constraints.

use super::{Curve, Grid, Shape, dot};
use std::f64::consts::PI;

/// The largest change of ψ in a step, in radians.
const LONGEST: f64 = 0.2;

/// The change of ψ below which a step is the last: Newton's method has squared what was left.
const LAST: f64 = 1e-10;

/// The largest number of steps.
const STEPS: usize = 60;

/// The derivatives of ψ, ψ′ and x at each node by the coefficients.
struct Rows {
    angle: Vec<Vec<f64>>,
    rate: Vec<Vec<f64>>,
    radius: Vec<Vec<f64>>,
}

impl Rows {
    fn new(shape: &Shape, grid: &Grid, curve: &Curve) -> Self {
        let count = shape.angle.len();
        let row = |entry: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (1..=count).map(|k| entry(shape.stride * k)).collect()
        };
        let all = |entry: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
            (0..grid.nodes).map(|j| row(&|k| entry(k, j))).collect()
        };
        let angle = all(&|k, j| grid.at(k, j)[0]);
        let rate = all(&|k, j| PI * k as f64 * grid.at(k, j)[1] / curve.density[j]);
        let radius = grid.integral.iter().map(|integral| {
            let mut sums = vec![0.0; count];
            for (i, share) in integral.iter().enumerate() {
                let factor = -share * curve.density[i] * curve.angle[i].sin();
                add(&mut sums, factor, &angle[i]);
            }
            sums
        });
        Self {
            radius: radius.collect(),
            angle,
            rate,
        }
    }

    /// Σ over nodes of the derivatives by ψ, ψ′ and x, times those by the coefficients.
    fn gradient(&self, derivatives: impl Fn(usize) -> [f64; 3]) -> Vec<f64> {
        let mut sums = vec![0.0; self.angle[0].len()];
        for j in 0..self.angle.len() {
            let [by_angle, by_rate, by_radius] = derivatives(j);
            add(&mut sums, by_angle, &self.angle[j]);
            add(&mut sums, by_rate, &self.rate[j]);
            add(&mut sums, by_radius, &self.radius[j]);
        }
        sums
    }
}

fn add(sums: &mut [f64], factor: f64, terms: &[f64]) {
    for (sum, term) in sums.iter_mut().zip(terms) {
        *sum += factor * term;
    }
}

/// Second derivatives of a density by ψ, ψ′ and x.
struct Second {
    angle: f64,
    rate: f64,
    radius: f64,
    angle_radius: f64,
    rate_radius: f64,
}

impl Shape {
    /// Makes the energy stationary at a reduced volume. A positive damping, which is halved in every full step,
    /// leads to a minimum from afar. `None` without convergence.
    pub(super) fn solve(&mut self, reduced_volume: f64, mut damping: f64) -> Option<()> {
        let grid = self.grid();
        for _ in 0..STEPS {
            let step = self.step(&grid, reduced_volume, damping)?;
            if step < LAST {
                let curve = self.curve(&grid);
                let circle = |j: usize| {
                    let around = curve.angle[j].sin().powi(2) / curve.radius[j];
                    0.125 * (curve.rate[j].powi(2) * curve.radius[j] + around)
                };
                // ∫ 2 ψ′ sin ψ ds = 4.
                self.energy = 0.5 + curve.sum(&grid, circle);
                return Some(());
            }
            if step < LONGEST {
                damping *= 0.5;
            }
        }
        None
    }

    /// One step; returns the largest change of ψ that it proposes.
    fn step(&mut self, grid: &Grid, reduced_volume: f64, damping: f64) -> Option<f64> {
        let curve = self.curve(grid);
        let rows = Rows::new(self, grid, &curve);
        let Curve {
            angle,
            rate,
            density,
            radius,
        } = &curve;
        let (area, volume) = (curve.area(grid), curve.volume(grid));
        let weight = |j: usize| grid.weights[j] * density[j];
        let by_energy = rows.gradient(|j| {
            let (sine, x) = (angle[j].sin(), radius[j]);
            [
                (2.0 * angle[j]).sin() / (8.0 * x),
                0.25 * rate[j] * x,
                0.125 * (rate[j].powi(2) - (sine / x).powi(2)),
            ]
            .map(|part| weight(j) * part)
        });
        let by_volume = rows.gradient(|j| {
            let (sine, cosine) = angle[j].sin_cos();
            let x = radius[j];
            [x * x * cosine, 0.0, 2.0 * x * sine].map(|part| weight(j) * part / volume)
        });
        let by_area = rows.gradient(|j| [0.0, 0.0, weight(j) / area]);
        let by_gap = rows.gradient(|j| {
            let each = density[j] / grid.nodes as f64;
            [-each * angle[j].sin(), 0.0, 0.0]
        });
        let count = self.angle.len();
        let by_reduced: Vec<f64> = (0..count)
            .map(|k| by_volume[k] - 1.5 * by_area[k])
            .collect();
        let [closing, holding] = self.multipliers;

        let mut matrix = self.hessian(grid, &curve, &rows);
        for (i, row) in matrix.iter_mut().enumerate() {
            add(row, holding * by_volume[i], &by_volume);
            add(row, -1.5 * holding * by_area[i], &by_area);
            row[i] += damping * ((i + 1) as f64).powi(2);
            row.extend([-by_gap[i], -by_reduced[i]]);
        }
        let mut right: Vec<f64> = (0..count)
            .map(|k| closing * by_gap[k] + holding * by_reduced[k] - by_energy[k])
            .collect();
        let negative = |row: &[f64]| -> Vec<f64> {
            row.iter().map(|entry| -entry).chain([0.0, 0.0]).collect()
        };
        matrix.push(negative(&by_gap));
        matrix.push(negative(&by_reduced));
        right.push(grid.mean((0..grid.nodes).map(|j| density[j] * angle[j].cos())));
        right.push((curve.reduced_volume(grid) / reduced_volume).ln());
        if self.stride == 2 {
            // Symmetry closes the profile.
            matrix[count][count] = 1.0;
            right[count] = 0.0;
        }
        let change = eliminate(matrix, right);
        let turns = rows
            .angle
            .iter()
            .map(|row| dot(row, &change[..count]).abs());
        let largest = turns.fold(0.0, f64::max);
        let part = (LONGEST / largest).min(1.0);
        add(&mut self.angle, part, &change[..count]);
        add(&mut self.multipliers, part, &change[count..]);
        largest.is_finite().then_some(largest)
    }

    /// Second derivatives of E − λ₁ ∫ cos ψ ds − λ₂ (V/V₀ − 3/2 A/A₀) by the coefficients, where V₀ and A₀ are the
    /// present volume and area.
    fn hessian(&self, grid: &Grid, curve: &Curve, rows: &Rows) -> Vec<Vec<f64>> {
        let [closing, holding] = self.multipliers;
        let (of_volume, of_area) = (
            -holding / curve.volume(grid),
            1.5 * holding / curve.area(grid),
        );
        let local = |j: usize| {
            let (sine, cosine) = curve.angle[j].sin_cos();
            let (rate, x) = (curve.rate[j], curve.radius[j]);
            let weight = grid.weights[j] * curve.density[j];
            let even = curve.density[j] / grid.nodes as f64;
            let by_radius =
                0.125 * (rate * rate - (sine / x).powi(2)) + 2.0 * of_volume * x * sine + of_area;
            let doubled = 2.0 * curve.angle[j];
            let second = Second {
                angle: weight * (doubled.cos() / (4.0 * x) - of_volume * x * x * sine)
                    + even * closing * cosine,
                rate: weight * 0.25 * x,
                radius: weight * (sine * sine / (4.0 * x.powi(3)) + 2.0 * of_volume * sine),
                angle_radius: weight
                    * (2.0 * of_volume * x * cosine - doubled.sin() / (8.0 * x * x)),
                rate_radius: weight * 0.25 * rate,
            };
            (second, weight * by_radius)
        };
        let mut locals: Vec<(Second, f64)> = (0..grid.nodes).map(local).collect();
        // x is not linear in the coefficients: its second derivatives are −cos ψ sin(kπt) sin(lπt), integrated.
        let mut transposed = vec![0.0; grid.nodes];
        for ((_, by_radius), integral) in locals.iter().zip(&grid.integral) {
            add(&mut transposed, *by_radius, integral);
        }
        for (j, (second, _)) in locals.iter_mut().enumerate() {
            second.angle -= transposed[j] * curve.density[j] * curve.angle[j].cos();
        }
        let count = self.angle.len();
        let mut matrix = vec![vec![0.0; count]; count];
        for (j, (second, _)) in locals.iter().enumerate() {
            let [angle, rate, radius] =
                [&rows.angle, &rows.rate, &rows.radius].map(|rows| &rows[j]);
            for (i, row) in matrix.iter_mut().enumerate() {
                let (a, r, x) = (angle[i], rate[i], radius[i]);
                add(row, second.angle * a + second.angle_radius * x, angle);
                add(row, second.rate * r + second.rate_radius * x, rate);
                let by_radius = second.radius * x + second.rate_radius * r;
                add(row, by_radius + second.angle_radius * a, radius);
            }
        }
        matrix
    }
}

/// The solution of a linear system, by elimination with partial pivoting.
fn eliminate(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let count = right.len();
    for k in 0..count {
        let size = |row: &usize| matrix[*row][k].abs();
        let pivot = (k..count).max_by(|a, b| size(a).total_cmp(&size(b)));
        let pivot = pivot.unwrap_or(k);
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        let (above, below) = matrix.split_at_mut(k + 1);
        for (row, i) in below.iter_mut().zip(k + 1..) {
            let factor = row[k] / above[k][k];
            add(&mut row[k..], -factor, &above[k][k..]);
            right[i] -= factor * right[k];
        }
    }
    for k in (0..count).rev() {
        let known = dot(&matrix[k][k + 1..], &right[k + 1..]);
        right[k] = (right[k] - known) / matrix[k][k];
    }
    right
}
