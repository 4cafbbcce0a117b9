//! Curvatures and bending forces with error bars, by fits whose degree and number of neighbours are chosen
//! from the noise at each vertex.
//!
//! Candidates are the jet through the vertex, and regression jets of degrees 6 and 4 over ever more
//! neighbours. For each candidate, and each of H, K and f, two parts of the squared error are estimated
//! around the vertex: V, due to noise, from the effect of independent errors of the estimated size; and
//! B, due to the shape, from the distance to a candidate with less bias, as far as noise does not
//! explain this distance. The candidate with the least B + V is chosen. Without noise V is 0, and the
//! jet is chosen; its error is then estimated by its distance from a jet over more neighbours. Noise is
//! estimated from the residuals of the jets and, where these are due to the shape, from their f.
//!
//! O. V. Lepski, Theory Probab. Appl. 35 (1991) 454, chooses scales by distances between estimates; here
//! distances are averaged over neighbourhoods, and extrapolated by the order of each fit.

mod bias;
mod border;
mod choice;
mod deviation;
mod hidden;
mod level;
mod principal;

use super::{BORDER, normals, rings_from_border};
use crate::curvature::{Curvature, Curvatures};
use crate::element::{Execution, Strided};
use crate::laplacian::{Jet, LaplaceBeltrami};
use crate::method::Method;
use crate::neighbourhood::Neighbourhood;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::Vec3;
use alloc::vec;
use alloc::vec::Vec;
use choice::{Candidate, Chosen};
use deviation::Deviations;
use level::{Estimates, Kind, Level};

/// Number of independent errors whose effect is followed.
const REPLICAS: usize = 12;

/// One number for each replica.
type Values<T> = [T; REPLICAS];

/// H, K and f.
const QUANTITIES: usize = 3;

/// The largest number of nearest vertices over which estimates are averaged.
const POOL: usize = 100;

/// Marks an entry without a vertex.
const NONE: u32 = u32::MAX;

/// Numbers of neighbours of regression jets. Meshes of [`LARGE`] vertices or more have the coarser
/// ladder, with errors at most 1.5 times as large.
const LADDER: [usize; 8] = [45, 64, 90, 128, 181, 256, 362, 512];
const COARSE_LADDER: [usize; 5] = [45, 64, 128, 256, 512];
const LARGE: usize = 100_000;

/// Number of neighbours after those of [`LADDER`], where these still gain at more than the fraction
/// [`RISING`] of the vertices. On a discocyte of 40 962 vertices with noise of 0.03 edges, it divides the
/// errors of H and K by 2 and that of f by 4. Its fits take two thirds of the time of all others and 12 kB
/// for each vertex, too much for meshes of [`LARGE`]. A mesh needs [`NEIGHBOURHOODS`] times as many
/// vertices, because distances between fits over most of a mesh do not show their bias.
const WIDEST: usize = 1024;
const RISING: f64 = 0.9;
const NEIGHBOURHOODS: usize = 32;

/// Number of neighbours from which on degree 4 is a candidate: with fewer neighbours it is no better
/// than degree 6.
const FOURTH: usize = 64;

/// Number of rings at a boundary where derivatives of one fit are more accurate than a fit to the fitted
/// H.
const ONE_STAGE: u8 = 2;

/// Fraction of the vertices that may still gain by more neighbours when the search ends.
const LEFT: f64 = 0.01;

/// Jets whose degree and number of neighbours are chosen at every vertex, with error bars.
///
/// Without noise of the positions, results are those of [`Jet::for_mesh`], except at boundaries. With noise, they
/// are those of regression jets over as many neighbours as the shape allows: the errors of H fall as the inverse
/// of the number of neighbours, those of f faster.
///
/// At a boundary and one edge away, where neighbours lie to one side, heights are fitted after the inversion
/// `y = (x − b n |x|²)/(1 − 2 b n·x + b² |x|²)` of the positions x seen from the vertex, with its normal n. The
/// principal curvatures there decrease by −2b, and f stays the same, as bending energies are invariant under
/// inversions. Of b between 0 and −H/2, which makes a plane of a sphere, the one with a small residual is taken.
/// Fits at the boundary itself have degree 6 or 8, whichever has the least standard error of f if its residual
/// is noise.
///
/// The errors of positions are assumed to be independent from vertex to vertex. Errors that neighbours
/// share cannot be distinguished from the shape, and error bars do not include them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptiveJet<T> {
    /// Known standard deviation σ of the positions along the normal, a length; it is a lower bound of
    /// the deviation at every vertex. If it is 0, the deviation is estimated from the positions alone.
    pub deviation: T,
    /// Number of neighbours of the fits, 28 or more: results are those of regression jets with this
    /// number, of degree 4 or 6, wherever these are possible. With `None` the number is chosen at every
    /// vertex.
    pub neighbours: Option<usize>,
}

impl<T: Real> Default for AdaptiveJet<T> {
    fn default() -> Self {
        Self {
            deviation: T::zero(),
            neighbours: None,
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
    /// Neighbours determine no fit: there are no values.
    #[default]
    Unknown,
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
}

/// Data that all fits share.
struct Ground<'a, T> {
    surface: Surface<'a, T>,
    /// Normals weighted by area.
    normals: Vec<Vec3<T>>,
    /// Normals of the jets where these are known, otherwise normals weighted by area.
    upright: Vec<Vec3<T>>,
    /// Random signs, used as errors of standard deviation 1.
    signs: Vec<Values<T>>,
    /// The nearest vertices of each vertex, sorted by distance and filled up with [`NONE`].
    nearest: Vec<u32>,
    /// Rings from a boundary, at most [`BORDER`].
    rings: Vec<u8>,
}

impl<'a, T: Real> Ground<'a, T> {
    /// `names` are numbers that stay with the vertices when these are reordered.
    fn new(
        execution: &impl Execution,
        surface: Surface<'a, T>,
        names: Option<&[u32]>,
        curvature: &[Curvature<T>],
    ) -> Self {
        let count = surface.mesh().vertex_count();
        let normals = normals(surface);
        let upright = curvature.iter().zip(&normals).map(|(fitted, &normal)| {
            if fitted.normal == [T::zero(); 3] {
                normal
            } else {
                fitted.normal
            }
        });
        let upright = upright.collect();
        let mut nearest = vec![NONE; count * POOL];
        let mut scratch: Vec<Neighbourhood<T>> = Vec::new();
        execution.map_with(
            &mut scratch,
            Strided::new(&mut nearest, POOL),
            |near, vertex, nearest| {
                near.nearest(surface, vertex as u32, POOL);
                for (entry, &(_, vertex)) in nearest.iter_mut().zip(&near.found) {
                    *entry = vertex;
                }
            },
        );
        let name = |vertex: usize| names.map_or(vertex as u32, |names| names[vertex]);
        Self {
            surface,
            normals,
            upright,
            signs: (0..count).map(|vertex| signs(name(vertex))).collect(),
            nearest,
            rings: rings_from_border(surface.mesh()),
        }
    }

    /// Whether fits around a vertex are one-sided.
    fn is_near_border(&self, vertex: usize) -> bool {
        usize::from(self.rings[vertex]) < BORDER
    }

    /// The errors of the height at a vertex.
    #[inline(always)]
    fn errors(&self, vertex: u32) -> &Values<T> {
        &self.signs[vertex as usize]
    }

    /// The vertex, and the `count` nearest others.
    #[inline]
    fn pool(&self, vertex: usize, count: usize) -> impl Iterator<Item = usize> {
        let nearest = self.nearest[vertex * POOL..][..count].iter();
        let others = nearest.take_while(|&&other| other != NONE);
        core::iter::once(vertex).chain(others.map(|&other| other as usize))
    }

    /// The means of the finite values over pools of the `count` nearest vertices; NaN where no value is
    /// finite.
    fn means(&self, execution: &impl Execution, values: &[T], count: usize) -> Vec<T> {
        let mut means = vec![T::nan(); values.len()];
        execution.map(&mut means[..], |vertex, mean| {
            let (mut sum, mut terms) = (T::zero(), 0_u32);
            for other in self.pool(vertex, count) {
                if values[other].is_finite() {
                    sum += values[other];
                    terms += 1;
                }
            }
            *mean = sum / T::constant(f64::from(terms));
        });
        means
    }
}

/// Independent signs for each vertex by its number: the finaliser of D. Lea, G. L. Steele and
/// S. Vigna's SplitMix64.
fn signs<T: Real>(name: u32) -> Values<T> {
    let mut bits = (u64::from(name) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    core::array::from_fn(|k| {
        if bits >> (5 * k) & 1 == 0 {
            T::one()
        } else {
            -T::one()
        }
    })
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
        if !watch(0.0) {
            return None;
        }
        let (curvature, mut jet, mut degree) = jets(execution, surface);
        let ground = Ground::new(execution, surface, names, &curvature);
        let twin = Level::new(execution, &ground, &Kind::interpolating());
        let [_, one_sided] = &twin.of_degrees;
        for (values, one_sided) in jet.iter_mut().zip(&one_sided.values) {
            for (vertex, (value, &one_sided)) in values.iter_mut().zip(one_sided).enumerate() {
                if ground.rings[vertex] < ONE_STAGE && one_sided.is_finite() {
                    *value = one_sided;
                    degree[vertex] = twin.degrees[vertex];
                }
            }
        }
        let [.., force] = &jet;
        let (mut deviations, wider) =
            Deviations::new(execution, &ground, &twin, force, self.deviation);
        let [_, sixth] = twin.of_degrees;
        let first = Candidate::of_jets(
            execution,
            &ground,
            &deviations,
            jet,
            sixth.changes,
            degree,
            &twin.neighbours,
        );
        let ladder = self.ladder(&deviations, surface.mesh().vertex_count());
        let mut chosen = Chosen::new(first);
        if let Some(wider) = wider.filter(|_| ladder.is_empty()) {
            chosen.compare(execution, &ground, &wider);
        }
        // The time of a fit is proportional to its number of neighbours.
        let work = |rungs: &[usize]| rungs.iter().sum::<usize>() as f64 + 56.0;
        for (rung, &neighbours) in ladder.iter().enumerate() {
            if !watch(work(&ladder[..rung]) / work(&ladder)) {
                return None;
            }
            let is_chosen = self.neighbours.is_none();
            if is_chosen && neighbours == WIDEST && chosen.rising() <= RISING {
                break;
            }
            let level = Level::new(execution, &ground, &Kind::regression(neighbours));
            if rung == 0 {
                chosen.limit_noise(execution, &ground, &mut deviations, &level);
            }
            chosen.add(execution, &ground, &deviations, level, neighbours >= FOURTH);
            if is_chosen && chosen.gains() <= LEFT {
                break;
            }
        }
        watch(1.0);
        Some(chosen.measured(
            execution,
            &ground,
            &deviations,
            self.neighbours.is_some(),
            &curvature,
        ))
    }

    /// The numbers of neighbours to try.
    fn ladder(&self, deviations: &Deviations<T>, vertices: usize) -> Vec<usize> {
        match self.neighbours {
            // The fits with fewer neighbours have less bias, and are there for comparison.
            Some(neighbours) => {
                let narrow = (neighbours as f64 / 1.42).max(28.0) as usize;
                let mut ladder = vec![LADDER[0], narrow, neighbours.max(28)];
                ladder.sort_unstable();
                ladder.dedup();
                ladder.retain(|&rung| rung <= neighbours.max(28));
                ladder
            }
            // Without noise no fit is better than the jets.
            None if !deviations.is_seen() => Vec::new(),
            None if vertices < NEIGHBOURHOODS * WIDEST => LADDER.to_vec(),
            None if vertices < LARGE => LADDER.iter().copied().chain([WIDEST]).collect(),
            None => COARSE_LADDER.to_vec(),
        }
    }
}

/// Curvatures, H, K and f of jets, and their degrees.
fn jets<T: Real>(
    execution: &impl Execution,
    surface: Surface<'_, T>,
) -> (Vec<Curvature<T>>, [Vec<T>; QUANTITIES], Vec<u8>) {
    let mesh = surface.mesh();
    let count = mesh.vertex_count();
    let jet = Jet::for_mesh(mesh);
    let mut workspace = jet.workspace(mesh);
    let mut curvature = vec![Curvature::default(); count];
    jet.curvatures(execution, surface, &mut workspace, &mut curvature);
    let degrees = workspace.memory().degrees().to_vec();
    let known = |at: &Curvature<T>, degree: &u8, value: T| {
        let is_known = *degree > 0 && at.normal != [T::zero(); 3];
        if is_known { value } else { T::nan() }
    };
    let mean = Vec::from_iter(curvature.iter().map(|at| at.mean));
    let mut force = vec![T::zero(); count];
    jet.apply_to_scalar(execution, surface, &workspace, &mean, &mut force);
    let two = T::constant(2.0);
    let all = curvature.iter().zip(&degrees);
    let values = [
        all.clone().map(|(at, d)| known(at, d, at.mean)).collect(),
        all.clone()
            .map(|(at, d)| known(at, d, at.gaussian))
            .collect(),
        all.zip(&force)
            .map(|((at, d), &laplacian)| {
                let (mean, gaussian) = (at.mean, at.gaussian);
                known(
                    at,
                    d,
                    two * (laplacian + two * mean * (mean * mean - gaussian)),
                )
            })
            .collect(),
    ];
    (curvature, values, degrees)
}
