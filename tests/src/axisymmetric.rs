//! Axisymmetric vesicles: equilibria of the bending energy at given area and volume, without
//! spontaneous curvature, to ten and more digits. References for relaxations of meshes.
//!
//! The profile has the tangent angle ψ, from 0 at one pole to π at the other, arc length s, distance x from
//! the axis, and height z: x′ = cos ψ, z′ = −sin ψ. Its curvatures are ψ′ and sin ψ/x, and
//!
//! ```text
//! E/8πκ = ⅛ ∫ (ψ′ + sin ψ/x)² x ds,   v = 3/√2 ∫ x² sin ψ ds / (∫ x ds)^(3/2),   ∫ cos ψ ds = 0
//! ```
//!
//! where v is the reduced volume, and the last condition closes the profile. The ansatz
//!
//! ```text
//! ψ = πt + Σ a_k sin kπt,   ln ds/dt = Σ b_k cos kπt,   0 ≤ t ≤ 1
//! ```
//!
//! has both poles' symmetry, so that coefficients a of a smooth shape fall faster than any power. The b are
//! given numbers, which put nodes where curvatures are large, as in the neck of a stomatocyte: they
//! follow from the curvatures of an earlier solution. Newton's method makes the energy stationary.
//!
//! U. Seifert, K. Berndl, R. Lipowsky, Phys. Rev. A 44 (1991) 1182: the branches. W.-M. Zheng and J. Liu, Phys. Rev.
//! E 48 (1993) 2856: the first integral of the shape equation.

use std::collections::BTreeMap;
use std::f64::consts::{PI, SQRT_2};
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

mod newton;
mod rings;

/// A family of stationary shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// Elongated, symmetric about the equator.
    Prolate,
    /// Flattened, symmetric about the equator; biconcave at small reduced volumes.
    Oblate,
    /// Cup-shaped, up to reduced volumes of about 0.66.
    Stomatocyte,
}

/// Reason why there is no such vesicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Error {
    /// The reduced volume is not between 0 and 1.
    ReducedVolume(f64),
    /// Newton's method does not converge on the way to the shape, at this reduced volume.
    NotConverged(Branch, f64),
    /// The stationary shape of this reduced volume belongs to another branch, or its energy is below that of a
    /// sphere, the least of all closed surfaces: the coefficients are too few.
    OtherBranch(Branch, f64),
    /// The shape of this reduced volume intersects itself.
    Intersects(Branch, f64),
}

impl fmt::Display for Error {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ReducedVolume(v) => {
                write!(
                    formatter,
                    "a reduced volume of {v}: above 0 and below 1 is right"
                )
            }
            Self::NotConverged(branch, v) => write!(
                formatter,
                "{branch:?}: no convergence at a reduced volume of {v}: the branch ends there, or its neck has become too narrow"
            ),
            Self::OtherBranch(branch, v) => write!(
                formatter,
                "{branch:?}: another shape was found at a reduced volume of {v}: more coefficients are needed"
            ),
            Self::Intersects(branch, v) => write!(
                formatter,
                "{branch:?}: the shape of reduced volume {v} intersects itself: the branch ends above it"
            ),
        }
    }
}

impl std::error::Error for Error {}

/// Coefficients of the shapes on the way along a branch.
const COARSE: usize = 24;

/// Length of a step along a branch, in reduced volume.
const STRIDE: f64 = 0.02;

/// The reduced volume at which the branch of stomatocytes is entered.
const CUP: f64 = 0.6;

/// An axisymmetric vesicle in equilibrium.
#[derive(Clone, Debug)]
pub struct Vesicle {
    branch: Branch,
    reduced_volume: f64,
    shape: Shape,
}

/// A profile by its coefficients, and the multipliers of its constraints.
#[derive(Clone, Debug)]
struct Shape {
    /// Between the indices of the coefficients: 2 for shapes that are symmetric about the equator.
    stride: usize,
    angle: Vec<f64>,
    density: Vec<f64>,
    /// ∂E/∂(∫ cos ψ ds) and ∂E/∂ ln v.
    multipliers: [f64; 2],
    energy: f64,
}

/// The nodes t = (j + ½)/N and linear maps between functions at these nodes.
#[derive(Clone, Debug)]
struct Grid {
    nodes: usize,
    /// Sine and cosine of πk/2N.
    trigonometric: Vec<[f64; 2]>,
    /// ∫₀ᵗ f, for even f without a mean.
    integral: Vec<Vec<f64>>,
    /// Weights of ∫₀¹ f, for odd f.
    weights: Vec<f64>,
}

/// Functions at the nodes.
#[derive(Clone, Debug)]
struct Curve {
    /// ψ, ψ′, ds/dt and x.
    angle: Vec<f64>,
    rate: Vec<f64>,
    density: Vec<f64>,
    radius: Vec<f64>,
}

impl Grid {
    /// The grid of this number of nodes, made once.
    fn of(nodes: usize) -> Arc<Self> {
        static GRIDS: Mutex<BTreeMap<usize, Arc<Grid>>> = Mutex::new(BTreeMap::new());
        let mut grids = GRIDS.lock().unwrap_or_else(PoisonError::into_inner);
        let grid = grids.entry(nodes);
        grid.or_insert_with(|| Arc::new(Self::new(nodes))).clone()
    }

    fn new(nodes: usize) -> Self {
        let count = nodes as f64;
        let trigonometric = (0..4 * nodes)
            .map(|k| (PI * k as f64 / (2.0 * count)).sin_cos().into())
            .collect();
        let mut grid = Self {
            nodes,
            trigonometric,
            integral: vec![vec![0.0; nodes]; nodes],
            weights: vec![0.0; nodes],
        };
        for j in 0..nodes {
            for k in 1..nodes {
                let [sine, _] = grid.at(k, j);
                let share = 2.0 / count * sine / (PI * k as f64);
                if k % 2 == 1 {
                    grid.weights[j] += 2.0 * share;
                }
                for i in 0..nodes {
                    grid.integral[j][i] += share * grid.at(k, i)[1];
                }
            }
        }
        grid
    }

    /// sin kπt and cos kπt at a node.
    fn at(&self, k: usize, node: usize) -> [f64; 2] {
        self.trigonometric[k * (2 * node + 1) % (4 * self.nodes)]
    }

    fn t(&self, node: usize) -> f64 {
        (node as f64 + 0.5) / self.nodes as f64
    }

    fn integrate(&self, even: &[f64]) -> Vec<f64> {
        self.integral.iter().map(|row| dot(row, even)).collect()
    }

    /// ∫₀ᵗ f over ∫₀¹ f, and the latter, for even f.
    fn fractions(&self, even: &[f64]) -> (Vec<f64>, f64) {
        let mean = self.mean(even.iter().copied());
        let waves = self.integrate(even);
        let fractions = waves.iter().enumerate();
        (
            fractions.map(|(j, wave)| self.t(j) + wave / mean).collect(),
            mean,
        )
    }

    fn mean(&self, even: impl Iterator<Item = f64>) -> f64 {
        even.sum::<f64>() / self.nodes as f64
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Shape {
    /// A start of a branch, at a reduced volume.
    fn start(branch: Branch, reduced_volume: f64) -> (Self, f64) {
        let mut shape = Self {
            stride: 2,
            angle: vec![0.0; COARSE],
            density: Vec::new(),
            multipliers: [0.0, -2.0],
            energy: 1.0,
        };
        if branch == Branch::Stomatocyte {
            shape.stride = 1;
            shape.angle = cup(2 * COARSE);
            return (shape, CUP);
        }
        let at = reduced_volume.max(0.95);
        // Of second order in the amplitude of the ellipsoid.
        let amplitude = 1.3 * (1.0 - at).sqrt();
        shape.angle[0] = match branch {
            Branch::Prolate => amplitude,
            _ => -amplitude,
        };
        (shape, at)
    }

    /// The highest frequency, and a grid that resolves the integrands.
    fn grid(&self) -> Arc<Grid> {
        Grid::of(2 * self.stride * self.angle.len())
    }

    fn density(&self, grid: &Grid) -> Vec<f64> {
        let at = |node| {
            let terms = self.density.iter().enumerate();
            let sum = terms.map(|(k, b)| b * grid.at(self.stride * (k + 1), node)[1]);
            sum.sum::<f64>().exp()
        };
        (0..grid.nodes).map(at).collect()
    }

    fn curve(&self, grid: &Grid) -> Curve {
        let density = self.density(grid);
        let (mut angle, mut rate) = (Vec::new(), Vec::new());
        for (node, density) in density.iter().enumerate() {
            let (mut psi, mut by_t) = (PI * grid.t(node), PI);
            for (k, a) in self.angle.iter().enumerate() {
                let k = self.stride * (k + 1);
                let [sine, cosine] = grid.at(k, node);
                psi += a * sine;
                by_t += a * PI * k as f64 * cosine;
            }
            angle.push(psi);
            rate.push(by_t / density);
        }
        let inward = angle.iter().zip(&density).map(|(psi, d)| d * psi.cos());
        let radius = grid.integrate(&inward.collect::<Vec<_>>());
        Curve {
            angle,
            rate,
            density,
            radius,
        }
    }

    /// Puts nodes where curvatures are large, and takes this number of coefficients.
    fn refine(&mut self, coefficients: usize) {
        if self.stride == 2 {
            // Symmetric shapes have no neck, and need none.
            self.angle.resize(coefficients, 0.0);
            return;
        }
        let grid = Grid::of(4 * coefficients.max(self.angle.len()));
        let curve = self.curve(&grid);
        let length = grid.mean(curve.density.iter().copied());
        let curvature = |j: usize| {
            let around = curve.angle[j].sin() / curve.radius[j];
            (PI / length).hypot(curve.rate[j]).hypot(around)
        };
        let curvatures: Vec<f64> = (0..grid.nodes).map(curvature).collect();
        let share = curvatures.iter().zip(&curve.density);
        let share: Vec<f64> = share.map(|(curvature, d)| curvature * d).collect();
        let (wanted, total) = grid.fractions(&share);
        let transform = |k: usize, function: &dyn Fn(usize) -> f64| {
            let term = |j: usize| function(j) * (PI * k as f64 * wanted[j]).cos() * share[j];
            2.0 * grid.mean((0..grid.nodes).map(term)) / total
        };
        let logarithm = |j: usize| -curvatures[j].ln();
        // Higher frequencies would need more coefficients of ψ.
        self.density = (1..=coefficients / 3)
            .map(|k| transform(k, &logarithm))
            .collect();

        // The cut series has the same arc lengths at slightly other t.
        let density = self.density(&grid);
        let (arcs, _) = grid.fractions(&curve.density);
        let moved = grid.mean(density.iter().copied());
        let lengths = Sines::of_integral(&grid, &density, moved);
        let t: Vec<f64> = arcs
            .iter()
            .zip(&wanted)
            .map(|(arc, t)| lengths.invert(*arc, *t))
            .collect();
        let coefficient = |k: usize| {
            let term = |j: usize| {
                let differential = curve.density[j] / length / lengths.at(t[j])[1];
                (curve.angle[j] - PI * t[j]) * (PI * k as f64 * t[j]).sin() * differential
            };
            2.0 * grid.mean((0..grid.nodes).map(term))
        };
        self.angle = (1..=coefficients).map(coefficient).collect();
        self.multipliers[0] *= length / moved;
    }
}

/// t + Σ c_k sin kπt.
struct Sines(Vec<f64>);

impl Sines {
    /// ∫₀ᵗ f over its mean, for even f.
    fn of_integral(grid: &Grid, even: &[f64], mean: f64) -> Self {
        let coefficient = |k: usize| {
            let term = |j: usize| even[j] * grid.at(k, j)[1];
            2.0 * grid.mean((0..grid.nodes).map(term)) / (PI * k as f64 * mean)
        };
        Self((1..grid.nodes).map(coefficient).collect())
    }

    /// The value and the derivative.
    fn at(&self, t: f64) -> [f64; 2] {
        self.0
            .iter()
            .zip(1..)
            .fold([t, 1.0], |[value, slope], (c, k)| {
                let (sine, cosine) = (PI * f64::from(k) * t).sin_cos();
                [value + c * sine, slope + c * PI * f64::from(k) * cosine]
            })
    }

    /// The place of a value of this rising function, by Newton's method from nearby, kept in an interval.
    fn invert(&self, value: f64, near: f64) -> f64 {
        let (mut below, mut above, mut t) = (0.0, 1.0, near);
        for _ in 0..60 {
            let [found, slope] = self.at(t);
            if found > value {
                above = t;
            } else {
                below = t;
            }
            let next = t - (found - value) / slope;
            let next = if next > below && next < above {
                next
            } else {
                0.5 * (below + above)
            };
            if (next - t).abs() <= f64::EPSILON {
                return next;
            }
            t = next;
        }
        t
    }
}

/// A cup with a rounded rim: ψ falls along the inner sphere, rises around the rim, and again along the outer
/// sphere.
fn cup(coefficients: usize) -> Vec<f64> {
    let (inner, rim, outer, opening) = (0.55, 0.2, 1.0, 2.2);
    let lengths = [inner * opening, rim * PI, outer * opening];
    let total: f64 = lengths.iter().sum();
    let psi = |t: f64| {
        let s = t * total;
        if s < lengths[0] {
            -s / inner
        } else if s < lengths[0] + lengths[1] {
            -opening + (s - lengths[0]) / rim
        } else {
            PI - (total - s) / outer
        }
    };
    let grid = Grid::of(8 * coefficients);
    let coefficient = |k: usize| {
        let term = |j: usize| (psi(grid.t(j)) - PI * grid.t(j)) * grid.at(k, j)[0];
        // Rounds the kinks.
        let smooth = (-(k as f64 / 15.0).powi(2)).exp();
        2.0 * smooth * grid.mean((0..grid.nodes).map(term))
    };
    (1..=coefficients).map(coefficient).collect()
}

impl Vesicle {
    /// The vesicle of a branch with this reduced volume, by this number of coefficients a.
    ///
    /// # Errors
    /// If the branch has no such shape, see [`Error`].
    pub fn new(branch: Branch, reduced_volume: f64, coefficients: usize) -> Result<Self, Error> {
        if !(reduced_volume > 0.0 && reduced_volume < 1.0) {
            return Err(Error::ReducedVolume(reduced_volume));
        }
        let (mut shape, mut at) = Shape::start(branch, reduced_volume);
        let lost = |at: f64| Error::NotConverged(branch, at);
        let start = if shape.stride == 1 { 1.0 } else { 0.0 };
        shape.solve(at, start).ok_or(lost(at))?;
        while at != reduced_volume {
            let left = reduced_volume - at;
            at = if left.abs() <= STRIDE {
                reduced_volume
            } else {
                at + STRIDE.copysign(left)
            };
            shape.refine(2 * COARSE / shape.stride);
            shape.solve(at, 0.0).ok_or(lost(at))?;
        }
        // A second time: the first map is that of a coarser solution.
        for _ in 0..2 {
            shape.refine(coefficients);
            shape.solve(at, 0.0).ok_or(lost(at))?;
        }
        let vesicle = Self {
            branch,
            reduced_volume,
            shape,
        };
        vesicle.checked()
    }

    fn checked(self) -> Result<Self, Error> {
        let grid = self.shape.grid();
        let curve = self.shape.curve(&grid);
        let profile = self.profile();
        let widest = profile.iter().map(|[x, _]| 2.0 * x).fold(0.0, f64::max);
        let heights = profile.iter().map(|[_, z]| *z);
        let tallest = heights.clone().fold(f64::MIN, f64::max) - heights.fold(f64::MAX, f64::min);
        let belongs = match self.branch {
            Branch::Prolate => tallest > widest,
            Branch::Oblate => tallest < widest,
            // Oblates are concave at both poles.
            Branch::Stomatocyte => curve.rate[0] < 0.0 && curve.rate[grid.nodes - 1] > 0.0,
        };
        if !belongs || self.energy() < 1.0 {
            return Err(Error::OtherBranch(self.branch, self.reduced_volume));
        }
        if profile.iter().any(|[x, _]| *x <= 0.0) || intersects(&profile) {
            return Err(Error::Intersects(self.branch, self.reduced_volume));
        }
        Ok(self)
    }

    /// E/8πκ.
    pub fn energy(&self) -> f64 {
        self.shape.energy
    }

    /// d(E/8πκ)/dv along the branch, from the multiplier of the reduced volume.
    pub fn slope(&self) -> f64 {
        self.shape.multipliers[1] / self.reduced_volume
    }

    /// Points (x, z) of the profile from one pole to the other, without the poles; the area is 4π.
    pub fn profile(&self) -> Vec<[f64; 2]> {
        let grid = self.shape.grid();
        let curve = self.shape.curve(&grid);
        let scale = (2.0 / curve.area(&grid)).sqrt();
        let falls: Vec<f64> = (0..grid.nodes)
            .map(|j| curve.angle[j].sin() * curve.density[j])
            .collect();
        let coefficients: Vec<f64> = (1..grid.nodes)
            .map(|k| 2.0 * grid.mean((0..grid.nodes).map(|j| falls[j] * grid.at(k, j)[0])))
            .collect();
        let height = |j: usize| -> f64 {
            let terms = coefficients.iter().zip(1..);
            terms
                .map(|(c, k)| c * grid.at(k, j)[1] / (PI * k as f64))
                .sum()
        };
        (0..grid.nodes)
            .map(|j| [scale * curve.radius[j], scale * height(j)])
            .collect()
    }

    /// The largest residual of the first integral of the shape equation, relative to its largest term:
    ///
    /// ```text
    /// κ/2 x (ψ′² − (sin ψ/x)²) − Σx − ½P x² sin ψ + γ cos ψ = 0,
    /// γ′ = κ/2 (ψ′² − (sin ψ/x)²) + Σ + P x sin ψ,   γ = 0 at both poles,
    /// ```
    ///
    /// with the tension Σ = −∂E/∂A and the pressure P = −∂E/∂V. It holds at every point of a solution of the
    /// Euler–Lagrange equations, and only there.
    pub fn first_integral(&self) -> f64 {
        let grid = self.shape.grid();
        let curve = self.shape.curve(&grid);
        let Curve {
            angle,
            rate,
            density,
            radius,
        } = &curve;
        // In units of κ: E = 8πκ e(v) with v = V/A^(3/2), A = 2π∫x ds, V = π∫x² sin ψ ds.
        let by_volume = 8.0 * PI * self.shape.multipliers[1];
        let tension = 1.5 * by_volume / (2.0 * PI * curve.area(&grid));
        let pressure = -by_volume / (PI * curve.volume(&grid));
        let squares = |j: usize| 0.5 * (rate[j].powi(2) - (angle[j].sin() / radius[j]).powi(2));
        let by_s = |j: usize| squares(j) + tension + pressure * radius[j] * angle[j].sin();
        let by_t: Vec<f64> = (0..grid.nodes).map(|j| by_s(j) * density[j]).collect();
        let mut largest = grid.mean(by_t.iter().copied()).abs();
        let gamma = grid.integrate(&by_t);
        let mut scale = 0.0f64;
        for j in 0..grid.nodes {
            let x = radius[j];
            let terms = [
                x * squares(j),
                -tension * x,
                -0.5 * pressure * x * x * angle[j].sin(),
                gamma[j] * angle[j].cos(),
            ];
            largest = largest.max(terms.iter().sum::<f64>().abs());
            scale = terms.iter().map(|term| term.abs()).fold(scale, f64::max);
        }
        largest / scale
    }
}

impl Curve {
    /// ∫ x ds.
    fn area(&self, grid: &Grid) -> f64 {
        self.sum(grid, |j| self.radius[j])
    }

    /// ∫ x² sin ψ ds.
    fn volume(&self, grid: &Grid) -> f64 {
        self.sum(grid, |j| self.radius[j].powi(2) * self.angle[j].sin())
    }

    /// ∫ f ds of a function that is odd at both poles.
    fn sum(&self, grid: &Grid, odd: impl Fn(usize) -> f64) -> f64 {
        let term = |j: usize| grid.weights[j] * self.density[j] * odd(j);
        (0..grid.nodes).map(term).sum()
    }

    /// 3/√2 ∫ x² sin ψ ds / (∫ x ds)^(3/2).
    fn reduced_volume(&self, grid: &Grid) -> f64 {
        3.0 / SQRT_2 * self.volume(grid) / self.area(grid).powf(1.5)
    }
}

/// Whether two segments of a polyline cross.
fn intersects(points: &[[f64; 2]]) -> bool {
    let side = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    };
    let segments = || points.windows(2).map(|ends| (ends[0], ends[1]));
    segments().enumerate().any(|(first, (a, b))| {
        segments().skip(first + 2).any(|(c, d)| {
            side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
        })
    })
}
