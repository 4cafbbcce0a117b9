//! Sums over all pairs; those between clusters that are apart are interpolated.
//!
//! The sources of a cluster act on distant points like sources at the nodes of its grid, and the sum of
//! distant sources at the points of a cluster is a polynomial through its values at the nodes. W. Fong
//! and E. Darve, J. Comput. Phys. 228, 8712 (2009); for pairs of clusters L. Wilson, N. Vaughn and R.
//! Krasny, Comput. Phys. Commun. 265, 108017 (2021).

use super::clusters::Tree;
use super::geometry::Geometry;
use super::interpolation::SEPARATION;
use super::kernel::{Expansion, Kernel, Scaled, Units};
use super::partial_sums::PartialSums;
use super::sums::{self, Columns};
use crate::flow::vectors::Vectors;
use glam::DVec3;
use helfrich_execute::execute::{in_parts, in_two};
use pulp::Arch;
use std::collections::VecDeque;
use std::marker::PhantomData;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Largest number of targets of a leaf.
const TARGETS: usize = 64;

/// Largest number of sources of a leaf.
const SOURCES: usize = 48;

/// Points of a leaf whose squared radius is more than this many times their squared widths, like those of several small
/// bodies, are too far from its centre, in units of the distances between neighbours, for single precision.
const SPREAD: f64 = 256.0;

/// Number of parts into which the targets are divided for threads.
const PARTS: usize = 64;

/// Largest tolerance. Errors of polynomials of the lowest degrees do not follow their estimate.
const LOOSEST: f64 = 1e-3;

/// The vertices and sources of a layer in clusters.
#[derive(Clone, Debug, Default)]
pub(super) struct Far {
    /// The error of interpolations, relative to the interpolated functions; 0 for all pairs.
    error: f64,
    /// Whether sums have single precision.
    single: bool,
    vertices: Tree,
    sources: Tree,
}

impl Far {
    /// Sums with this tolerance, or over all pairs if it is 0, before vertices are placed.
    /// `interpolation` is the ratio of the error of interpolations to that of their sums, and `single` chooses
    /// single precision.
    pub(super) fn new(interpolation: f64, tolerance: f64, single: bool) -> Self {
        Self {
            error: interpolation * tolerance.min(LOOSEST),
            single,
            ..Self::default()
        }
    }

    /// Sets the clusters of vertices and of sources; the triangles of a source need better integrals at
    /// points within its `reach`.
    pub(super) fn place<const SOURCE: usize>(
        &mut self,
        threads: NonZeroUsize,
        geometry: &Geometry,
        sources: &[[f64; SOURCE]],
        reach: impl Fn(usize) -> f64 + Sync,
    ) {
        if self.error > 0.0 {
            let vertex = |vertex| (geometry.position(vertex), geometry.width(vertex));
            let count = geometry.vertex_count();
            self.vertices = self.tree(&vertex, count, TARGETS, threads);
            let point = |source: usize| DVec3::from_slice(&sources[source][..3]);
            let source = |source| (point(source), reach(source));
            self.sources = self.tree(&source, sources.len(), SOURCES, threads);
        }
    }

    /// Whether sums have single precision.
    pub(super) fn single(&self) -> bool {
        self.single
    }

    /// Units of sums at the vertices.
    pub(super) fn units<const SOURCE: usize>(
        &self,
        kernel: impl Scaled<SOURCE>,
        sources: &[[f64; SOURCE]],
    ) -> Units {
        let root = self.vertices.clusters.first();
        root.map_or(Units::NONE, |root| kernel.units(root.radius, sources))
    }

    /// The clusters of other points, if they are needed.
    pub(super) fn points(&self, points: &[[f64; 3]], threads: NonZeroUsize) -> Option<Tree> {
        let point = |point: usize| (DVec3::from(points[point]), 0.0);
        (self.error > 0.0).then(|| self.tree(&point, points.len(), TARGETS, threads))
    }

    /// The trees for sums at the vertices; `None` where all pairs are summed.
    pub(super) fn at_vertices(&self) -> Option<[&Tree; 2]> {
        self.at(Some(&self.vertices))
    }

    /// The trees for sums at other points.
    pub(super) fn at<'a>(&'a self, points: Option<&'a Tree>) -> Option<[&'a Tree; 2]> {
        let trees = [points?, &self.sources];
        (trees.iter().all(|tree| !tree.order.is_empty())).then_some(trees)
    }

    fn tree(
        &self,
        points: &(impl Fn(usize) -> (DVec3, f64) + Sync),
        count: usize,
        most: usize,
        threads: NonZeroUsize,
    ) -> Tree {
        Tree::new(points, count, most, self.error, threads.get())
    }
}

/// Adds the result of [`sums::add`] to each entry, by sums over clusters if there are trees. Of each correction it is
/// known whether it may nearly cancel the sum, which then has double precision.
#[expect(
    clippy::too_many_arguments,
    reason = "those of the sum over all pairs, and the trees"
)]
pub(super) fn add<
    T,
    K,
    const TARGET: usize,
    const SOURCE: usize,
    const SUM: usize,
    const FAR: usize,
    const LOCAL: usize,
>(
    kernel: K,
    trees: Option<[&Tree; 2]>,
    threads: NonZeroUsize,
    sources: &[[f64; SOURCE]],
    factor: f64,
    entries: &mut [[f64; SUM]],
    target: impl Fn(usize) -> [f64; TARGET] + Sync,
    correction: impl Fn(usize) -> ([f64; SUM], bool) + Sync,
) where
    T: Vectors,
    K: Expansion<T, TARGET, SOURCE, SUM, FAR, LOCAL> + Kernel<f64, TARGET, SOURCE, SUM>,
{
    let Some(trees) = trees else {
        let correction = |entry| correction(entry).0;
        sums::add(
            kernel, threads, sources, factor, entries, target, correction,
        );
        return;
    };
    let mut cancelling = vec![false; entries.len()];
    let mut both: Vec<_> = entries.iter_mut().zip(&mut cancelling).collect();
    sums::distribute(threads, &mut both, |first, both| {
        for (k, (entry, cancelling)) in both.iter_mut().enumerate() {
            let (more, cancels) = correction(first + k);
            **cancelling = cancels;
            for axis in 0..SUM {
                entry[axis] += factor * more[axis];
            }
        }
    });
    let sums = sums::<T, _, _, _, _, _, _>(kernel, threads, trees, sources, target, &cancelling);
    for (entry, sum) in entries.iter_mut().zip(sums) {
        for axis in 0..SUM {
            entry[axis] += factor * sum[axis];
        }
    }
}

/// The sums over all sources at all targets, in the order of the targets.
fn sums<
    T,
    K,
    const TARGET: usize,
    const SOURCE: usize,
    const SUM: usize,
    const FAR: usize,
    const LOCAL: usize,
>(
    kernel: K,
    threads: NonZeroUsize,
    [target_tree, source_tree]: [&Tree; 2],
    sources: &[[f64; SOURCE]],
    target: impl Fn(usize) -> [f64; TARGET] + Sync,
    cancelling: &[bool],
) -> Vec<[f64; SUM]>
where
    T: Vectors,
    K: Expansion<T, TARGET, SOURCE, SUM, FAR, LOCAL> + Kernel<f64, TARGET, SOURCE, SUM>,
{
    let sources: Vec<_> = (source_tree.order.iter())
        .map(|&source| sources[source as usize])
        .collect();
    let mut first_nodes = vec![0];
    for cluster in &source_tree.clusters {
        let count = cluster.grid.as_ref().map_or(0, |grid| grid.len());
        first_nodes.push(first_nodes[first_nodes.len() - 1] + count);
    }
    let mut moments = vec![[0.0; FAR]; first_nodes[first_nodes.len() - 1]];
    let ascent = Ascent {
        moments_of: |source: &[f64; SOURCE]| kernel.moments(source),
        tree: source_tree,
        sources: &sources,
        first_nodes: &first_nodes,
    };
    ascent.ascend(0, &mut moments, threads.get());
    let descent = Descent::<T, _, _, TARGET, SOURCE, SUM, FAR, LOCAL> {
        kernel,
        targets: target_tree,
        sources: source_tree,
        first_nodes: &first_nodes,
        numbers: &sources,
        moments: &moments,
        target,
        cancelling,
        units: kernel.units(target_tree.clusters[0].radius, &sources),
        number: PhantomData,
    };
    let ordered = descent.run(threads);
    let mut sums = vec![[0.0; SUM]; ordered.len()];
    for (&target, sum) in target_tree.order.iter().zip(ordered) {
        sums[target as usize] = sum;
    }
    sums
}

/// Sources moved to the nodes of their clusters, from the leaves upward.
struct Ascent<'a, M, const SOURCE: usize, const FAR: usize> {
    /// The moments of a source.
    moments_of: M,
    tree: &'a Tree,
    /// In the order of the tree.
    sources: &'a [[f64; SOURCE]],
    first_nodes: &'a [usize],
}

impl<M, const SOURCE: usize, const FAR: usize> Ascent<'_, M, SOURCE, FAR>
where
    M: Fn(&[f64; SOURCE]) -> [f64; FAR] + Sync,
{
    /// Sets the moments at the nodes of a cluster and of all below it.
    fn ascend(&self, cluster: usize, moments: &mut [[f64; FAR]], threads: usize) {
        let nodes =
            |family: Range<usize>| self.first_nodes[family.end] - self.first_nodes[family.start];
        let (own, below) = moments.split_at_mut(nodes(cluster..cluster + 1));
        let children = self.tree.children(cluster);
        let halves = children.map(|[left, right]| {
            let (first, second) = below.split_at_mut(nodes(self.tree.family(left)));
            in_two(
                threads,
                |threads| {
                    self.ascend(left, first, threads);
                    &*first
                },
                |threads| {
                    self.ascend(right, second, threads);
                    &*second
                },
            )
        });
        let cluster = &self.tree.clusters[cluster];
        let Some(grid) = &cluster.grid else {
            return;
        };
        let raw = |points: &Range<usize>| {
            let sources = self.sources[points.clone()].iter();
            sources.map(&self.moments_of)
        };
        let mut moved = Vec::with_capacity(cluster.points.len());
        match (children, halves) {
            (Some(children), Some(halves)) => {
                for (child, moments) in children.into_iter().zip(halves) {
                    let child = &self.tree.clusters[child];
                    match &child.grid {
                        Some(grid) => moved.extend_from_slice(&moments[..grid.len()]),
                        None => moved.extend(raw(&child.points)),
                    }
                }
            }
            _ => moved.extend(raw(&cluster.points)),
        }
        Arch::new().dispatch(
            #[inline(always)]
            || {
                for moment in &moved {
                    let [x, y, z] = [moment[0], moment[1], moment[2]];
                    grid.spread(&grid.weights(DVec3::new(x, y, z)), |node, weight| {
                        // It is cheaper to add the position as well; it is set below.
                        for (sum, number) in own[node].iter_mut().zip(moment) {
                            *sum += weight * number;
                        }
                    });
                }
            },
        );
        for (moment, node) in own.iter_mut().zip(grid.nodes()) {
            moment[..3].copy_from_slice(&node.to_array());
        }
    }
}

/// Sums carried from clusters to the points in them.
struct Descent<
    'a,
    T,
    K,
    P,
    const TARGET: usize,
    const SOURCE: usize,
    const SUM: usize,
    const FAR: usize,
    const LOCAL: usize,
> {
    kernel: K,
    targets: &'a Tree,
    sources: &'a Tree,
    first_nodes: &'a [usize],
    /// The sources in the order of their tree.
    numbers: &'a [[f64; SOURCE]],
    moments: &'a [[f64; FAR]],
    target: P,
    /// Whether a correction may nearly cancel the sum at a target.
    cancelling: &'a [bool],
    units: Units,
    number: PhantomData<fn() -> T>,
}

/// A cluster of targets, and the sources that act on all of it.
struct Visit<const LOCAL: usize> {
    cluster: usize,
    /// Clusters of sources whose treatment is not decided yet.
    candidates: Vec<usize>,
    /// Sources that are summed point by point.
    direct: Vec<Direct>,
    /// The innermost enclosing cluster that has sums at its nodes, and these sums.
    around: Option<Arc<(usize, Columns<f64, LOCAL>)>>,
}

/// Sources that act on each target.
#[derive(Clone, Debug)]
enum Direct {
    /// All sources of a cluster.
    Sources(usize),
    /// The nodes of a cluster.
    Nodes(usize),
}

impl<
    T: Vectors,
    K,
    P,
    const TARGET: usize,
    const SOURCE: usize,
    const SUM: usize,
    const FAR: usize,
    const LOCAL: usize,
> Descent<'_, T, K, P, TARGET, SOURCE, SUM, FAR, LOCAL>
where
    K: Expansion<T, TARGET, SOURCE, SUM, FAR, LOCAL> + Kernel<f64, TARGET, SOURCE, SUM>,
    P: Fn(usize) -> [f64; TARGET] + Sync,
{
    /// The sums at all targets, in the order of their tree.
    fn run(&self, threads: NonZeroUsize) -> Vec<[f64; SUM]> {
        let mut waiting = VecDeque::from([Visit {
            cluster: 0,
            candidates: vec![0],
            direct: Vec::new(),
            around: None,
        }]);
        let mut sums = vec![[0.0; SUM]; self.targets.order.len()];
        // Each part is large enough for a thread, and there are enough parts to balance the load.
        let most = sums.len() / PARTS;
        let mut parts = Vec::new();
        let mut rest = sums.as_mut_slice();
        while let Some(mut visit) = waiting.pop_front() {
            let size = self.targets.clusters[visit.cluster].points.len();
            if size > most && self.targets.children(visit.cluster).is_some() {
                for child in self.meet(&mut visit).into_iter().flatten().rev() {
                    waiting.push_front(child);
                }
            } else {
                let part;
                (part, rest) = rest.split_at_mut(size);
                parts.push((visit, part));
            }
        }
        let parts = Mutex::new(parts);
        in_parts(0..threads.get(), &|_| {
            loop {
                let part = parts.lock().unwrap_or_else(PoisonError::into_inner).pop();
                let Some((visit, sums)) = part else { break };
                self.descend(visit, sums);
            }
        });
        sums
    }

    /// Sets the sums in a cluster.
    fn descend(&self, mut visit: Visit<LOCAL>, sums: &mut [[f64; SUM]]) {
        match self.meet(&mut visit) {
            Some([left, right]) => {
                let middle = self.targets.clusters[left.cluster].points.len();
                let (first, second) = sums.split_at_mut(middle);
                self.descend(left, first);
                self.descend(right, second);
            }
            None => self.finish(&visit, sums),
        }
    }

    /// Decides how the candidates act on a cluster; candidates that do not act in the same way on all
    /// of it are passed on to the clusters below.
    fn meet(&self, visit: &mut Visit<LOCAL>) -> Option<[Visit<LOCAL>; 2]> {
        let target = &self.targets.clusters[visit.cluster];
        let children = self.targets.children(visit.cluster);
        let mut interpolated = Vec::new();
        let mut passed = Vec::new();
        let mut candidates = std::mem::take(&mut visit.candidates);
        candidates.reverse();
        while let Some(number) = candidates.pop() {
            let source = &self.sources.clusters[number];
            let distance = target.centre.distance(source.centre);
            let below = self.sources.children(number);
            let apart = distance - target.radius > SEPARATION * source.radius
                && distance - source.radius > SEPARATION * target.radius;
            // Sums are exact where better integrals replace them.
            if apart && distance - target.radius > source.reach {
                match (&source.grid, &target.grid) {
                    (Some(_), Some(_)) => interpolated.push(number),
                    (Some(_), None) => visit.direct.push(Direct::Nodes(number)),
                    (None, _) => visit.direct.push(Direct::Sources(number)),
                }
            } else if let Some([left, right]) = below
                && (children.is_none() || source.radius > target.radius)
            {
                candidates.extend([right, left]);
            } else if children.is_some() {
                passed.push(number);
            } else {
                visit.direct.push(Direct::Sources(number));
            }
        }
        if let Some(grid) = &target.grid
            && !(interpolated.is_empty() && visit.around.is_none())
        {
            let nodes: Vec<_> = grid.nodes().collect();
            let mut sums = Columns::new(nodes.len());
            if let Some(around) = &visit.around {
                for (number, &node) in nodes.iter().enumerate() {
                    sums.set(number, self.interpolated(around, node));
                }
            }
            let origin = target.centre;
            let rows: Vec<_> = nodes.iter().map(|node| node.to_array()).collect();
            let mut partial = PartialSums::new(self.columns(origin, &rows), &mut sums);
            for &number in &interpolated {
                partial.add(self.kernel.distant(), self.seen(origin, self.nodes(number)));
            }
            partial.finish(self.kernel.distant());
            visit.around = Some(Arc::new((visit.cluster, sums)));
        }
        let [left, right] = children?;
        let below = |cluster, candidates, direct| Visit {
            cluster,
            candidates,
            direct,
            around: visit.around.clone(),
        };
        Some([
            below(left, passed.clone(), visit.direct.clone()),
            below(right, passed, visit.direct.clone()),
        ])
    }

    /// Sets the sums at the targets of a leaf.
    fn finish(&self, visit: &Visit<LOCAL>, sums: &mut [[f64; SUM]]) {
        let range = self.targets.clusters[visit.cluster].points.clone();
        let order = &self.targets.order[range];
        let rows: Vec<[f64; TARGET]> = order
            .iter()
            .map(|&target| (self.target)(target as usize))
            .collect();
        let mut columns = Columns::new(rows.len());
        let leaf = &self.targets.clusters[visit.cluster];
        let compact = leaf.radius * leaf.radius <= SPREAD * leaf.squared_reaches;
        if compact && !order.iter().any(|&target| self.cancelling[target as usize]) {
            self.add_sources::<T>(visit, leaf.centre, &rows, &mut columns);
        } else {
            self.add_sources::<f64>(visit, DVec3::ZERO, &rows, &mut columns);
        }
        let mut partial = PartialSums::new(self.columns(leaf.centre, &rows), &mut columns);
        for direct in &visit.direct {
            if let Direct::Nodes(number) = *direct {
                let nodes = self.seen(leaf.centre, self.nodes(number));
                partial.add(self.kernel.distant(), nodes);
            }
        }
        partial.finish(self.kernel.distant());
        for (k, (sum, &target)) in sums.iter_mut().zip(&rows).enumerate() {
            *sum = columns.row(k);
            if let Some(around) = &visit.around {
                let local = self.interpolated(around, DVec3::new(target[0], target[1], target[2]));
                for (sum, far) in sum.iter_mut().zip(self.kernel.at(local, target)) {
                    *sum += far;
                }
            }
            for number in sum {
                *number *= self.units.of_sum;
            }
        }
    }

    /// Adds the sources that act on the targets of a leaf one by one, in numbers of type `V`.
    fn add_sources<V: Vectors>(
        &self,
        visit: &Visit<LOCAL>,
        origin: DVec3,
        targets: &[[f64; TARGET]],
        sums: &mut Columns<f64, SUM>,
    ) where
        K: Kernel<V, TARGET, SOURCE, SUM>,
    {
        let mut partial = PartialSums::<V, _, _, _>::new(self.columns(origin, targets), sums);
        for direct in &visit.direct {
            if let Direct::Sources(number) = *direct {
                let points = self.sources.clusters[number].points.clone();
                partial.add(self.kernel, self.seen(origin, &self.numbers[points]));
            }
        }
        partial.finish(self.kernel);
    }

    /// The numbers of points relative to an origin, in units.
    fn seen<V: Vectors, const N: usize>(
        &self,
        origin: DVec3,
        rows: &[[f64; N]],
    ) -> impl Iterator<Item = [V; N]> {
        let origin = origin.to_array();
        rows.iter().map(move |row| self.units.within(origin, row))
    }

    fn columns<V: Vectors, const N: usize>(
        &self,
        origin: DVec3,
        rows: &[[f64; N]],
    ) -> Columns<V, N> {
        let seen: Vec<_> = self.seen(origin, rows).collect();
        Columns::from_rows(seen.len(), |k| seen[k])
    }

    /// The nodes of a cluster of sources with their moments.
    fn nodes(&self, cluster: usize) -> &[[f64; FAR]] {
        &self.moments[self.first_nodes[cluster]..self.first_nodes[cluster + 1]]
    }

    /// The value at a point of the polynomials through the sums at the nodes of the enclosing cluster.
    fn interpolated(&self, around: &(usize, Columns<f64, LOCAL>), at: DVec3) -> [f64; LOCAL] {
        let (cluster, sums) = around;
        let mut value = [0.0; LOCAL];
        if let Some(grid) = &self.targets.clusters[*cluster].grid {
            grid.spread(&grid.weights(at), |node, weight| {
                for (value, sum) in value.iter_mut().zip(sums.row(node)) {
                    *value += weight * sum;
                }
            });
        }
        value
    }
}
