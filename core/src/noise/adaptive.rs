//! Curvatures and bending forces with error bars, by fits whose degree and number of neighbours are chosen
//! from the noise at each vertex.
//!
//! Candidates are the jet through the vertex, and regression jets of degrees 6 and 4 over ever more
//! neighbours. For each candidate, and each of H, K and f, two parts of the squared error are estimated
//! around the vertex: V, due to noise, from the effect of independent errors of the estimated size; and
//! B, due to the shape, from the distance to a candidate with less bias, as far as noise does not
//! explain this distance. The candidate with the least B + V is chosen. Without noise V is 0, and the
//! jet is chosen; its error is then estimated by its distance from a jet of another degree. Noise is
//! estimated from the residuals of the jets and, where these are due to the shape, from distances
//! between f of jets over fewer and more neighbours.
//!
//! O. V. Lepski, Theory Probab. Appl. 35 (1991) 454, chooses scales by distances between estimates; here
//! distances are averaged over neighbourhoods, and extrapolated by the order of each fit.

mod bias;
mod border;
mod choice;
mod deviation;
mod ground;
mod hidden;
mod jets;
mod kind;
mod level;
mod principal;
mod settle;

use crate::components::Components;
use crate::diagnostic::Finding;
use crate::element::Execution;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::Vec3;
use alloc::vec;
use alloc::vec::Vec;
use choice::{Candidate, Chosen};
use deviation::Deviations;
use ground::Ground;
use jets::Jets;
use kind::FitKind;
use level::{Estimates, Level};

/// Number of independent sets of errors of the heights whose effect on the fits is computed.
const REPLICAS: usize = 12;

/// One number for each replica.
type Values<T> = [T; REPLICAS];

/// H, K and f.
const QUANTITIES: usize = 3;

/// The place of f.
const FORCE: usize = QUANTITIES - 1;

/// Numbers of nearest vertices over which estimates are averaged: the largest, and a small one that shows where
/// estimates are larger than in the surroundings.
const POOL: usize = 100;
const LOCAL: usize = 12;

/// Marks an entry without a vertex.
const NONE: u32 = u32::MAX;

/// Numbers of neighbours of regression jets on meshes of [`LARGE`] vertices or more, with errors at most 1.5 times
/// those of [`AdaptiveJet::LADDER`].
const COARSE_LADDER: [usize; 5] = [45, 64, 128, 256, 512];
const LARGE: usize = 100_000;

/// Number of neighbours that follows those of [`AdaptiveJet::LADDER`] if the last of these is the best at more than
/// the fraction [`RISING`] of the vertices. On a discocyte of 40 962 vertices with noise of 0.03 edges, it divides
/// the errors of H and K by 2 and that of f by 4. Its fits take two thirds of the time of all others and 12 kB for
/// each vertex, too much for meshes of [`LARGE`]. A mesh needs [`NEIGHBOURHOODS`] times as many vertices, because
/// distances between fits over most of a mesh do not show their bias.
const WIDEST: usize = 1024;
const RISING: f64 = 0.9;
const NEIGHBOURHOODS: usize = 32;

/// Number of neighbours from which on degree 4 is a candidate: with fewer neighbours it is no better
/// than degree 6.
const FOURTH: usize = 64;

/// Number of rings at a boundary where Δ_S H is more accurate from the derivatives of one fit than from a
/// second fit, to the fitted H.
const ONE_STAGE: u8 = 2;

/// The search for more neighbours stops when fewer than this fraction of the vertices still improve.
const LEFT: f64 = 0.01;

/// Jets whose degree and number of neighbours are chosen at every vertex, with error bars.
///
/// Without noise of the positions, results are those of a [`Jet`](crate::Jet) except at boundaries: of degree 6; of
/// degree 8, if H of neighbouring fits disagrees at most half as much; or, on small meshes, of degree 4, if H
/// disagrees less. With noise, they are those of regression jets over as many neighbours as the shape allows: the
/// errors of H fall as the inverse of the number of neighbours, those of f faster.
///
/// At a boundary and one edge away, where neighbours lie to one side, heights are fitted after the inversion
/// `y = (x − b n |x|²)/(1 − 2 b n·x + b² |x|²)` of the positions x seen from the vertex, with its normal n. The
/// principal curvatures there decrease by −2b, and f stays the same, as bending energies are invariant under
/// inversions. b lies between 0 and −H/2, which turns a sphere into a plane, and is chosen for a small residual.
/// Fits at the boundary itself have degree 6 or 8, whichever gives f the smaller standard error if residuals
/// count as noise.
///
/// The errors of positions are assumed to be independent from vertex to vertex. Errors that neighbours
/// share cannot be distinguished from the shape, and error bars do not include them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptiveJet<T> {
    /// Known standard deviation σ of the positions along the normal, a length; it is a lower bound of
    /// the deviation at every vertex. If it is 0, the deviation is estimated from the positions alone.
    pub deviation: T,
    /// Extent of the fits: results are those of regression jets with this extent, of degree 4 or 6, wherever the
    /// neighbours determine them. With `None` the number of neighbours is chosen at every vertex.
    pub extent: Option<FitExtent<T>>,
}

/// The vertices that a regression jet is fitted to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FitExtent<T> {
    /// This number of nearest vertices, at least [`FitExtent::FEWEST`].
    Neighbours(usize),
    /// All vertices within this distance, a length above 0, but at least the [`FitExtent::FEWEST`] and at most the
    /// [`FitExtent::MOST`] nearest: [`Scale::neighbours`] tells their number.
    Radius(T),
}

impl<T> FitExtent<T> {
    /// The fewest neighbours that determine a polynomial of degree 6.
    pub const FEWEST: usize = 28;

    /// The most neighbours of a radius.
    pub const MOST: usize = 4096;
}

impl<T> AdaptiveJet<T> {
    /// Numbers of neighbours that are tried on a surface with noise, unless it has fewer vertices, or so many that
    /// about half of these numbers suffice.
    pub const LADDER: [usize; 8] = [45, 64, 90, 128, 181, 256, 362, 512];
}

impl<T: Real> Default for AdaptiveJet<T> {
    fn default() -> Self {
        Self {
            deviation: T::zero(),
            extent: None,
        }
    }
}

/// A value and its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<T> {
    /// The value; NaN where there is none.
    pub value: T,
    /// The error bar: the true error is estimated to be within it at 99 of 100 vertices.
    pub error: T,
    /// The expected error, as the root of the mean of its square; an upper estimate without noise.
    pub expected: T,
    /// The fit that gave the value.
    pub scale: Scale,
}

/// A fit of an [`AdaptiveJet`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Scale {
    /// Degree of the polynomial, 0 if there is none.
    pub degree: u8,
    /// Number of neighbours.
    pub neighbours: u32,
    /// Whether the polynomial passes through the vertex: a jet; otherwise it is a regression jet.
    pub interpolates: bool,
}

/// Quality of the mesh around a vertex, as judged from the fits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// The mesh resolves the shape, and no noise was found.
    Clean,
    /// The mesh resolves the shape down to the noise.
    Noise,
    /// The mesh does not resolve the shape: it has to be refined. The estimate of the noise is not
    /// reliable.
    Unresolved,
    /// The vertex is at a boundary, or next to it: fits are one-sided, and errors larger.
    OneSided,
    /// Neighbours determine no fit, or nothing shows its error: there are no values, or values with infinite
    /// error bars.
    #[default]
    Unknown,
}

/// Cause of a verdict; it makes error bars wider or infinite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Cause {
    /// Neighbours lie in rows, which determine the fit badly or not at all.
    Rows,
    /// A crease, corner or tip of the surface.
    Crease,
    /// The fit includes a crease.
    BesideCrease,
    /// The vertex lies far off the surface of its neighbours.
    Outlier,
    /// The fit includes an outlier.
    BesideOutlier,
    /// The component has too few vertices for an estimate of errors.
    SmallComponent,
    /// Vertices lie on the edges of a grid, whose ripples cannot be distinguished from the shape.
    Grid,
}

impl Cause {
    /// The finding about a vertex with this cause; `None` if the finding is about another vertex.
    pub fn finding(self, vertex: u32) -> Option<Finding> {
        match self {
            Self::Rows => Some(Finding::Rows { vertex }),
            Self::Crease => Some(Finding::Crease { vertex }),
            Self::Outlier => Some(Finding::Outlier { vertex }),
            Self::SmallComponent => Some(Finding::SmallComponent { vertex }),
            Self::Grid => Some(Finding::Grid { vertex }),
            Self::BesideCrease | Self::BesideOutlier => None,
        }
    }
}

/// Results at a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured<T> {
    /// Unit normal; 0 where it is undefined.
    pub normal: Vec3<T>,
    /// Mixed area.
    pub area: T,
    /// H, in 1/length, positive on a sphere.
    pub mean: Estimate<T>,
    /// K, in 1/length².
    pub gaussian: Estimate<T>,
    /// f = 2[Δ_S H + 2H(H² − K)] along the normal, for κ = 1, in 1/length³.
    pub force_density: Estimate<T>,
    /// The principal curvatures k₁ ≥ k₂ of the fit for H, in 1/length.
    pub principal: [Estimate<T>; 2],
    /// Unit vectors along which the surface has the principal curvatures; `None` near umbilics, that is,
    /// where the direction is uncertain by more than 0.2 radians (one standard deviation).
    pub directions: Option<[Vec3<T>; 2]>,
    /// The gradient of H on the surface, in 1/length².
    pub gradient_of_mean: Vec3<T>,
    /// The derivatives of k₁ and k₂ along their own directions, in 1/length²: 0 on ridges. The sign is
    /// that of the direction.
    pub extremalities: Option<[T; 2]>,
    /// Standard deviation σ of the position along the normal, a length; 0 if none was found.
    pub deviation: T,
    /// Quality of the mesh around the vertex.
    pub verdict: Verdict,
    /// Cause of the verdict, if it is known.
    pub cause: Option<Cause>,
}

impl<T: Real> Measured<T> {
    /// No results, as at an isolated vertex.
    pub fn unknown() -> Self {
        let nothing = Estimate {
            value: T::nan(),
            error: T::nan(),
            expected: T::nan(),
            scale: Scale::default(),
        };
        Self {
            normal: [T::zero(); 3],
            area: T::zero(),
            mean: nothing,
            gaussian: nothing,
            force_density: nothing,
            principal: [nothing; 2],
            directions: None,
            gradient_of_mean: [T::nan(); 3],
            extremalities: None,
            deviation: T::zero(),
            verdict: Verdict::Unknown,
            cause: None,
        }
    }
}

/// Data that are known before the choice of scales.
struct Begun<'s, T> {
    ground: Ground<'s, T>,
    jets: Jets<T>,
    deviations: Deviations<T>,
    chosen: Chosen<T>,
    ladder: Vec<usize>,
    /// The first level of the ladder.
    first: Option<Level<T>>,
}

/// Ranks of some vertices in the order of their names: a component keeps the order of the whole surface.
fn ranks(names: &[u32], vertices: &[u32]) -> Vec<u32> {
    let mut order = Vec::from_iter(0..vertices.len());
    order.sort_unstable_by_key(|&place| names[vertices[place] as usize]);
    let mut ranks = vec![0; vertices.len()];
    for (rank, place) in (0..).zip(order) {
        ranks[place] = rank;
    }
    ranks
}

impl<T: Real> AdaptiveJet<T> {
    /// Measures a surface: an entry for each vertex. `None` if `watch` returned false. `watch` is called
    /// between steps with the estimated fraction of the work that is done.
    ///
    /// `names` are numbers that stay with the vertices when these are reordered; `None` means the
    /// indices of the vertices. Error bars depend slightly on the names.
    ///
    /// # Panics
    /// If there are fewer names than vertices.
    pub fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        names: Option<&[u32]>,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Option<Vec<Measured<T>>> {
        Components::each(
            surface,
            Measured::unknown(),
            watch,
            &mut |part, vertices, watch| {
                let names = names.map(|names| ranks(names, vertices));
                self.measure_connected(execution, part, names.as_deref(), watch)
            },
        )
    }

    /// Measures a connected surface.
    fn measure_connected(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        names: Option<&[u32]>,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Option<Vec<Measured<T>>> {
        if !watch(0.0) {
            return None;
        }
        let Begun {
            ground,
            jets,
            deviations,
            mut chosen,
            ladder,
            mut first,
        } = self.begin(execution, surface, names);
        // The time of a fit is proportional to its number of neighbours.
        let work = |rungs: &[usize]| rungs.iter().sum::<usize>() as f64 + 56.0;
        for (rung, &neighbours) in ladder.iter().enumerate() {
            if !watch(work(&ladder[..rung]) / work(&ladder)) {
                return None;
            }
            let is_chosen = self.extent.is_none();
            if is_chosen && neighbours == WIDEST && chosen.rising() <= RISING {
                break;
            }
            let level = || Level::new(execution, &ground, &FitKind::regression(neighbours));
            let level = first.take().unwrap_or_else(level);
            chosen.add(execution, &ground, &deviations, level, neighbours >= FOURTH);
            if is_chosen && !ground.is_on_grid && chosen.gains() <= LEFT {
                break;
            }
        }
        watch(1.0);
        let is_fixed = self.extent.is_some();
        let (mut measured, doubts) =
            chosen.measured(execution, &ground, &deviations, is_fixed, &jets);
        settle::settle(&ground, &doubts, &mut measured);
        Some(measured)
    }

    /// The standard deviation σ of the position along the normal that [`Self::measure`] finds at every vertex, in a
    /// fraction of its time. `None` if `watch` returned false.
    ///
    /// # Panics
    /// As [`Self::measure`].
    pub fn deviations(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        names: Option<&[u32]>,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Option<Vec<T>> {
        Components::each(surface, T::zero(), watch, &mut |part, vertices, watch| {
            if !watch(0.0) {
                return None;
            }
            let names = names.map(|names| ranks(names, vertices));
            let begun = self.begin(execution, part, names.as_deref());
            let variances = begun.deviations.variances.iter();
            Some(variances.map(|variance| variance.sqrt()).collect())
        })
    }

    /// Computes the jets of a connected surface, the noise from their residuals, and, if there is noise, the first
    /// regression jets, which limit its estimate.
    fn begin<'s>(
        &self,
        execution: &impl Execution,
        surface: Surface<'s, T>,
        names: Option<&[u32]>,
    ) -> Begun<'s, T> {
        let mut jets = Jets::new(execution, surface);
        let mut ground = Ground::new(execution, surface, names, &jets.curvature);
        let is_free = self.deviation == T::zero() && self.extent.is_none();
        let is_smooth = ground.marks.is_empty() && !ground.is_on_grid;
        let is_quiet = is_free && is_smooth && jets.are_quiet(execution, &ground);
        if !is_quiet {
            ground.widen(execution);
        }
        if let Some(FitExtent::Radius(radius)) = self.extent {
            ground.count_within(execution, radius);
        }
        let ground = ground;
        let rings = if is_quiet { ONE_STAGE } else { u8::MAX };
        let level = |kind: FitKind<T>| Level::within(execution, &ground, &kind, rings);
        let twin = level(FitKind::interpolating());
        jets.take_one_sided(&ground, &twin);
        let (mut deviations, wider) = match is_quiet {
            true => (Deviations::none(&ground), Some(level(FitKind::wider()))),
            false => {
                let force = &jets.values[FORCE];
                Deviations::new(execution, &ground, &twin, force, self.deviation)
            }
        };
        let ladder = self.ladder(&deviations, &ground);
        let wider = wider.filter(|_| ladder.is_empty());
        let of_jets = jets.squared_errors(execution, &ground, wider.as_ref());
        let [_, Estimates { values, changes }] = twin.of_degrees;
        let candidate = Candidate::of_jets(execution, &ground, &deviations, &jets, &changes);
        let mut chosen = Chosen::new(candidate, changes, of_jets, wider.is_some());
        let first = ladder.first().map(|&neighbours| {
            let level = Level::new(execution, &ground, &FitKind::regression(neighbours));
            chosen.limit_noise(execution, &ground, &mut deviations, &values[FORCE], &level);
            level
        });
        Begun {
            ground,
            jets,
            deviations,
            chosen,
            ladder,
            first,
        }
    }

    /// The numbers of neighbours to try.
    fn ladder(&self, deviations: &Deviations<T>, ground: &Ground<'_, T>) -> Vec<usize> {
        let vertices = ground.normals.len();
        match self.extent {
            // Fits with fewer neighbours have less bias: distances from them show the bias.
            Some(extent) => {
                let neighbours = match extent {
                    FitExtent::Neighbours(neighbours) => neighbours,
                    FitExtent::Radius(_) => ground.most_within,
                };
                let neighbours = neighbours.max(FitExtent::<T>::FEWEST);
                let narrow = (neighbours as f64 / 1.42) as usize;
                let narrow = narrow.max(FitExtent::<T>::FEWEST);
                let mut ladder = vec![Self::LADDER[0], narrow, neighbours];
                ladder.sort_unstable();
                ladder.dedup();
                ladder.retain(|&rung| rung <= neighbours);
                ladder
            }
            // Without noise no fit is better than the jets.
            None if !deviations.is_seen() && !ground.is_on_grid => Vec::new(),
            None if vertices < NEIGHBOURHOODS * WIDEST => Self::LADDER.to_vec(),
            None if vertices < LARGE => Self::LADDER.iter().copied().chain([WIDEST]).collect(),
            None => COARSE_LADDER.to_vec(),
        }
    }
}
