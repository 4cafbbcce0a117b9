//! The jets of a mesh without noise, with the degree that suits the shape and the mesh, and their errors.
//!
//! Jets of two degrees have different numbers of neighbours and different errors: the distance between them
//! shows the error of the less accurate jet, which is the one that disagrees more with the jets at neighbouring
//! vertices.

use super::level::Level;
use super::{FORCE, Ground, LOCAL, ONE_STAGE, QUANTITIES};
use crate::curvature::{Curvature, Curvatures};
use crate::element::Execution;
use crate::laplacian::{Jet, LaplaceBeltrami};
use crate::method::Method;
use crate::noise::doubt::{Doubt, larger};
use crate::noise::fit::Model;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::Vec3;
use alloc::vec;
use alloc::vec::Vec;
use core::array::from_fn;
use core::f64::consts::PI;
use core::iter::zip;

/// Number of vertices below which degree 4 may be better than 6. It is better where 56 neighbours are a large part of
/// the surface; on a patch of little curvature, degree 6 has a tenth of the errors of degree 4.
const COARSE: usize = 1000;

/// Ratio of the disagreements of degrees 8 and 6 below which degree 8 is chosen: on coarse meshes where it is only a
/// little below 1, errors of f of degree 8 are up to three times those of degree 6.
const BETTER: f64 = 0.5;

/// Largest ratio of the disagreements of degrees 8 and 6, averaged around a vertex, at which noise does not matter,
/// and fraction of the vertices where it may be larger. Noise has a ratio of about 1. Exact meshes of 10 242 vertices
/// and exact ellipsoids of 2562 had at most 0.4.
const QUIET: f64 = 0.5;
const LOUD: f64 = 0.01;

/// Factors of error bars of jets on a mesh without noise. A bar is [`FROM_OTHER`] times the root mean square distance,
/// over [`LOCAL`] vertices, from jets of another degree. It is multiplied by [`OF_BETTER`] times the ratio of the
/// disagreements of these and of the other jets if this shortens it. On even meshes f gains less than this ratio: its
/// bar is then at least [`OF_ROW`] times the effect of the disagreements on Δ_S H.
const FROM_OTHER: f64 = 3.0;
const OF_BETTER: f64 = 1.25;
const OF_ROW: f64 = 0.8;

/// The least error bar of H and K, in units of the root mean square of the largest disagreements with neighbours:
/// noise that is too small to be found disturbs jets of both degrees alike, so that their distance does not show it.
/// On a hard torus of aspect 0.4 with noise of 1e-5 edges it raises the fraction of vertices with H within its bar
/// from 0.74 to 0.96. The price is longer bars on exact meshes: their median is up to 51 median errors of H and 87 of
/// K, on a relaxed ellipsoid.
const OF_RING: f64 = 1.4;

/// Error bars of jets near a boundary, in units of root mean square distances from fits over more neighbours. On 27
/// meshes of nine shapes 99 % of the errors of H, K and f were below 1.5 such distances in the median case and below
/// 3.9 in the worst, and the distance was at most 5.8 median errors.
const FROM_WIDER: f64 = 4.0;

/// Jets around every vertex.
pub(super) struct Jets<T> {
    pub(super) curvature: Vec<Curvature<T>>,
    /// The gradients of H and K.
    pub(super) gradients: Vec<[Vec3<T>; 2]>,
    /// H, K and f; NaN where there is no fit.
    pub(super) values: [Vec<T>; QUANTITIES],
    pub(super) degrees: Vec<u8>,
    pub(super) neighbours: Vec<u32>,
    /// Doubts from disagreements with neighbouring fits; `None` without a fit, or where the fit is one-sided.
    pub(super) doubts: Vec<Option<Doubt<T>>>,
    /// The distances of H, K and f from those of jets of another degree.
    pub(super) distances: [Vec<T>; QUANTITIES],
    /// The disagreements in H of the jets of another degree.
    pub(super) other_apart: Vec<T>,
    /// The polynomials where the degree was not lowered.
    pub(super) model: Model<T>,
}

impl<T: Real> Jets<T> {
    /// The jets of the degree that suits the surface.
    pub(super) fn new(execution: &impl Execution, surface: Surface<'_, T>) -> Self {
        let of = |jet: Jet<T>| Self::of(execution, surface, &jet);
        let [sixth, eighth] = [Jet::j6(), Jet::j8()].map(of);
        let apart = sixth.disagreement();
        if surface.mesh().vertex_count() < COARSE {
            let fourth = of(Jet::j4());
            if fourth.disagreement() <= apart {
                return fourth.beside(sixth);
            }
        }
        if eighth.disagreement() < T::constant(BETTER * BETTER) * apart {
            eighth.beside(sixth)
        } else {
            sixth.beside(eighth)
        }
    }

    /// These jets, compared with others.
    fn beside(mut self, other: Self) -> Self {
        for (vertex, doubt) in self.doubts.iter_mut().enumerate() {
            if let Some(doubt) = doubt {
                doubt.is_all = self.degrees[vertex] == other.degrees[vertex];
            }
        }
        self.distances = from_fn(|quantity| {
            let both = zip(&self.values[quantity], &other.values[quantity]);
            both.map(|(&own, &other)| (own - other).abs()).collect()
        });
        self.other_apart = other.doubts.iter().map(apart).collect();
        self
    }

    fn of(execution: &impl Execution, surface: Surface<'_, T>, jet: &Jet<T>) -> Self {
        let mesh = surface.mesh();
        let count = mesh.vertex_count();
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
        let field = (&mean[..], |_: usize| T::one());
        jet.apply_to_mean(execution, surface, &workspace, field, &mut force);
        let memory = workspace.memory();
        let doubts = (0..count).map(|vertex| {
            let apart = memory.disagreements();
            let (columns, row) = memory.row(vertex);
            let squares = zip(columns, row).map(|(&other, &entry)| {
                let [of_mean, _] = apart[other as usize];
                entry * entry * of_mean * of_mean
            });
            let covered = T::constant(columns.len() as f64 / PI) * curvature[vertex].area;
            (degrees[vertex] > 0).then(|| Doubt {
                spread: T::infinity(),
                apart: apart[vertex],
                of_laplacian: T::constant(2.0) * squares.sum::<T>().sqrt(),
                radius: covered.sqrt(),
                is_all: true,
            })
        });
        let doubts = Vec::from_iter(doubts);
        let two = T::constant(2.0);
        let all = || curvature.iter().zip(&degrees);
        let values = [
            all().map(|(at, d)| known(at, d, at.mean)).collect(),
            all().map(|(at, d)| known(at, d, at.gaussian)).collect(),
            all()
                .zip(&force)
                .map(|((at, d), &laplacian)| {
                    let (mean, gaussian) = (at.mean, at.gaussian);
                    let density = laplacian + two * mean * (mean * mean - gaussian);
                    known(at, d, two * density)
                })
                .collect(),
        ];
        let neighbours = (0..count).map(|vertex| memory.row(vertex).0.len() as u32);
        Self {
            values,
            neighbours: neighbours.collect(),
            gradients: (0..count).map(|vertex| memory.gradients(vertex)).collect(),
            degrees,
            doubts,
            distances: from_fn(|_| Vec::new()),
            other_apart: Vec::new(),
            curvature,
            model: Model {
                degree: jet.degree,
                sharpness: jet.sharpness,
                interpolates: true,
            },
        }
    }

    /// The mean squares, around every vertex, of the disagreements in H: of these jets, and of jets of another degree.
    fn disagreements(&self, execution: &impl Execution, ground: &Ground<'_, T>) -> [Vec<T>; 2] {
        let own = Vec::from_iter(self.doubts.iter().map(apart));
        [&own, &self.other_apart].map(|apart| {
            let squares = Vec::from_iter(apart.iter().map(|&apart| apart * apart));
            ground.means(execution, &squares, LOCAL)
        })
    }

    /// Whether degree 8 gains so much that noise does not matter. Noise of H grows with the degree by the same factor as
    /// noise of f, which hides the shape first.
    pub(super) fn are_quiet(&self, execution: &impl Execution, ground: &Ground<'_, T>) -> bool {
        if self.model.degree <= 6 {
            return false;
        }
        let [own, other] = self.disagreements(execution, ground);
        let most = T::constant(QUIET * QUIET);
        // Also false for NaN, without a fit.
        let is_quiet = |(own, other): &(T, T)| *own <= most * *other;
        let quiet = zip(own, other).filter(is_quiet).count();
        quiet as f64 >= (1.0 - LOUD) * self.doubts.len() as f64
    }

    /// The squares of the error bars of H, K and f without noise. Near a boundary they follow from `wider`, jets over
    /// more neighbours, and are NaN if it is `None`.
    pub(super) fn squared_errors(
        &self,
        execution: &impl Execution,
        ground: &Ground<'_, T>,
        wider: Option<&Level<T>>,
    ) -> [Vec<T>; QUANTITIES] {
        let squared = |x: T| x * x;
        let pooled = |values: &mut dyn Iterator<Item = T>| {
            let squares = Vec::from_iter(values.map(squared));
            ground.means(execution, &squares, LOCAL)
        };
        let [own, other] = self.disagreements(execution, ground);
        let of_laplacian =
            |doubt: &Option<Doubt<T>>| doubt.map_or(T::nan(), |doubt| doubt.of_laplacian);
        let of_laplacian = pooled(&mut self.doubts.iter().map(of_laplacian));
        from_fn(|quantity| {
            let from_other = pooled(&mut self.distances[quantity].iter().copied());
            let from_wider = wider.map(|wider| {
                let [_, sixth] = &wider.of_degrees;
                let both = zip(&self.values[quantity], &sixth.values[quantity]);
                pooled(&mut both.map(|(&own, &wider)| own - wider))
            });
            let of_ring =
                |doubt: &Option<Doubt<T>>| doubt.map_or(T::nan(), |doubt| doubt.apart[quantity]);
            let of_ring = (quantity != FORCE).then(|| pooled(&mut self.doubts.iter().map(of_ring)));
            let of_vertex = |vertex: usize| match self.doubts[vertex] {
                None => from_wider.as_ref().map_or(T::nan(), |from_wider| {
                    squared(T::constant(FROM_WIDER)) * from_wider[vertex]
                }),
                Some(_) => {
                    let from_other = squared(T::constant(FROM_OTHER)) * from_other[vertex];
                    let ratio = squared(T::constant(OF_BETTER)) * own[vertex] / other[vertex];
                    let mut better = ratio * from_other;
                    if quantity == FORCE {
                        better =
                            larger(better, squared(T::constant(OF_ROW)) * of_laplacian[vertex]);
                    }
                    // Also false for NaN.
                    let square = if better < from_other {
                        better
                    } else {
                        from_other
                    };
                    of_ring.as_ref().map_or(square, |of_ring| {
                        larger(square, squared(T::constant(OF_RING)) * of_ring[vertex])
                    })
                }
            };
            (0..self.doubts.len()).map(of_vertex).collect()
        })
    }

    /// Replaces values near a boundary by those of one-sided fits.
    pub(super) fn take_one_sided(&mut self, ground: &Ground<'_, T>, twin: &Level<T>) {
        let [_, one_sided] = &twin.of_degrees;
        for (values, one_sided) in self.values.iter_mut().zip(&one_sided.values) {
            for (vertex, (value, &one_sided)) in values.iter_mut().zip(one_sided).enumerate() {
                if ground.rings[vertex] < ONE_STAGE && one_sided.is_finite() {
                    *value = one_sided;
                    self.doubts[vertex] = None;
                    self.degrees[vertex] = twin.degrees[vertex];
                    self.neighbours[vertex] = twin.neighbours[vertex];
                }
            }
        }
    }

    /// The sum of the squares of the disagreements in H; infinite if a vertex has no fit.
    fn disagreement(&self) -> T {
        let all = self.doubts.iter();
        let apart = all.map(|doubt| doubt.map_or(T::infinity(), |doubt| doubt.apart[0]));
        apart.map(|apart| apart * apart).sum()
    }
}

/// The disagreement in H; NaN where it is unknown.
fn apart<T: Real>(doubt: &Option<Doubt<T>>) -> T {
    doubt.map_or(T::nan(), |doubt| doubt.apart[0])
}
