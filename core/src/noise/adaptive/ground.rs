//! Data that all fits of a surface share.

use super::{FitExtent, LOCAL, NONE, POOL, REPLICAS, Values};
use crate::curvature::Curvature;
use crate::element::{Execution, Strided};
use crate::neighbourhood::Neighbourhood;
use crate::noise::doubt::{ELONGATED, ROWS, aspects};
use crate::noise::grid;
use crate::noise::sharp::{self, Mark};
use crate::noise::{BORDER, normals, rings_from_border};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::Vec3;
use alloc::vec;
use alloc::vec::Vec;

/// Inputs common to all fits.
pub(super) struct Ground<'a, T> {
    pub(super) surface: Surface<'a, T>,
    /// Normals weighted by area.
    pub(super) normals: Vec<Vec3<T>>,
    /// Normals of the jets where these are known, otherwise normals weighted by area.
    pub(super) upright: Vec<Vec3<T>>,
    /// Random signs, used as errors of standard deviation 1.
    pub(super) signs: Vec<Values<T>>,
    /// The `pool` nearest vertices of each vertex, sorted by distance and filled up with [`NONE`]: at first
    /// [`LOCAL`], enough for a mesh without noise.
    nearest: Vec<u32>,
    pool: usize,
    /// Rings from a boundary, at most [`BORDER`].
    pub(super) rings: Vec<u8>,
    /// Creases and outliers, if there are any.
    pub(super) marks: Vec<Option<Mark>>,
    /// Whether vertices lie on the edges of a grid.
    pub(super) is_on_grid: bool,
    /// Ratios of spacings: see [`aspects`].
    aspects: Vec<T>,
    /// Numbers of vertices within the radius of fits with one, and the largest of them.
    within: Vec<u32>,
    pub(super) most_within: usize,
}

impl<'a, T: Real> Ground<'a, T> {
    /// `names` are numbers that stay with the vertices when these are reordered.
    pub(super) fn new(
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
        let name = |vertex: usize| names.map_or(vertex as u32, |names| names[vertex]);
        let mut marks = sharp::marks(surface);
        if marks.iter().all(Option::is_none) {
            marks.clear();
        }
        let mut ground = Self {
            surface,
            aspects: aspects(surface, &normals),
            is_on_grid: grid::is_on_grid(surface.positions()),
            marks,
            normals,
            upright,
            signs: (0..count).map(|vertex| signs(name(vertex))).collect(),
            nearest: Vec::new(),
            pool: 0,
            rings: rings_from_border(surface.mesh()),
            within: Vec::new(),
            most_within: 0,
        };
        ground.find_nearest(execution, LOCAL);
        ground
    }

    /// Finds the nearest vertices that estimates of noise are averaged over.
    pub(super) fn widen(&mut self, execution: &impl Execution) {
        self.find_nearest(execution, POOL);
    }

    fn find_nearest(&mut self, execution: &impl Execution, pool: usize) {
        let surface = self.surface;
        self.pool = pool;
        self.nearest.clear();
        self.nearest.resize(self.rings.len() * pool, NONE);
        let mut scratch: Vec<Neighbourhood<T>> = Vec::new();
        execution.map_with(
            &mut scratch,
            Strided::new(&mut self.nearest, pool),
            |near, vertex, nearest| {
                near.nearest(surface, vertex as u32, pool);
                for (entry, &(_, vertex)) in nearest.iter_mut().zip(&near.found) {
                    *entry = vertex;
                }
            },
        );
    }

    /// Counts the vertices within this distance of each, within the limits of [`FitExtent::Radius`].
    pub(super) fn count_within(&mut self, execution: &impl Execution, radius: T) {
        let surface = self.surface;
        let [fewest, most] = [FitExtent::<T>::FEWEST, FitExtent::<T>::MOST];
        self.within.resize(self.rings.len(), 0);
        let mut scratch: Vec<Neighbourhood<T>> = Vec::new();
        execution.map_with(&mut scratch, &mut self.within[..], |near, vertex, count| {
            let mut searched = 2 * fewest;
            let is_within = |&(squared, _): &(T, u32)| squared <= radius * radius;
            loop {
                near.nearest(surface, vertex as u32, searched);
                let is_whole = near.found.len() < searched || searched >= most;
                if is_whole || !near.found.last().is_some_and(is_within) {
                    break;
                }
                searched = (2 * searched).min(most);
            }
            *count = near.found.partition_point(is_within).max(fewest) as u32;
        });
        self.most_within = self.within.iter().copied().max().unwrap_or(0) as usize;
    }

    /// The number of neighbours of a regression at a vertex that has `largest` where most vertices are within the
    /// radius; `largest` everywhere if fits have no radius.
    pub(super) fn share(&self, vertex: usize, largest: usize) -> usize {
        self.within.get(vertex).map_or(largest, |&own| {
            let share = largest * own as usize / self.most_within;
            share.max(FitExtent::<T>::FEWEST)
        })
    }

    /// Whether fits around a vertex are one-sided.
    pub(super) fn is_near_border(&self, vertex: usize) -> bool {
        usize::from(self.rings[vertex]) < BORDER
    }

    /// Whether all fits around a vertex share their errors, and whether it lies in a row.
    pub(super) fn is_elongated(&self, vertex: usize) -> [bool; 2] {
        [ELONGATED, ROWS].map(|ratio| self.aspects[vertex] >= T::constant(ratio))
    }

    /// The mark of a vertex, or of the first of some neighbours.
    pub(super) fn mark(&self, vertex: usize, neighbours: &[(T, u32)]) -> Option<Mark> {
        let own = *self.marks.get(vertex)?;
        let mut others = neighbours.iter();
        own.or_else(|| others.find_map(|&(_, other)| self.marks[other as usize]))
    }

    /// The errors of the height at a vertex.
    #[inline(always)]
    pub(super) fn errors(&self, vertex: u32) -> &Values<T> {
        &self.signs[vertex as usize]
    }

    /// The vertex, and the `count` nearest others.
    #[inline]
    pub(super) fn pool(&self, vertex: usize, count: usize) -> impl Iterator<Item = usize> {
        debug_assert!(count <= self.pool, "{count} of {} vertices", self.pool);
        let nearest = self.nearest[vertex * self.pool..][..count].iter();
        let others = nearest.take_while(|&&other| other != NONE);
        core::iter::once(vertex).chain(others.map(|&other| other as usize))
    }

    /// The means of the finite values over pools of the `count` nearest vertices; NaN where no value is
    /// finite.
    pub(super) fn means(&self, execution: &impl Execution, values: &[T], count: usize) -> Vec<T> {
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
    core::array::from_fn::<_, REPLICAS, _>(|k| {
        if bits >> (5 * k) & 1 == 0 {
            T::one()
        } else {
            -T::one()
        }
    })
}
