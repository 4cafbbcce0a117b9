//! The triangles of the limit surface, and the loop over them.
//!
//! A patch maps the control points of its nodes to derivatives at three quadrature points by a
//! table that depends only on the valence of its first corner. The same table maps derivatives of
//! the energy back to forces at its nodes. Patches of all valences run through one loop.

use crate::bending::surface_point::Point;
use crate::element::Execution;
use crate::lane::WIDTH;
use crate::mesh::TriangleMesh;
use crate::real::Real;
use crate::subdivision::{Basis, NoPatch, Patch, RowSum, Stencils, Subdivision, basis};
use crate::vec3::dot;
use alloc::vec::Vec;
use core::ops::Range;

/// Interior points of equal weight, exact for quadratic functions. With one point the energy would
/// have negative modes; more points gain nothing. The first point is the nearest to v0.
const POINTS: [[f64; 2]; 3] = [
    [1.0 / 6.0, 1.0 / 6.0],
    [2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0],
];

/// A third of the area of the parameter triangle.
pub(super) const WEIGHT: f64 = 1.0 / 6.0;

/// Number of patches per call of an execution's loop.
pub(super) const BLOCK: usize = 64;

/// Marks a point of the refined mesh that no patch needs.
const NONE: u32 = u32::MAX;

/// Contributions of one node of a patch at the quadrature points.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeBasis<T> {
    pub(super) values: [T; 3],
    /// ∂v, ∂w, ∂vv, ∂vw, ∂ww at each point.
    pub(super) derivatives: [[T; 5]; 3],
}

/// A quantity on the limit surface.
#[derive(Clone, Copy, Debug)]
pub(super) enum Field<'a, T> {
    /// The same everywhere.
    Constant(T),
    /// One value per control point, interpolated by the basis functions.
    Controlled(&'a [[T; 1]]),
}

impl<T: Real> Field<'_, T> {
    /// Its values at the quadrature points of a patch.
    #[inline(always)]
    pub(super) fn at(self, nodes: &[u32], bases: &[NodeBasis<T>]) -> [T; 3] {
        let controls = match self {
            Self::Constant(constant) => return [constant; 3],
            Self::Controlled(controls) => controls,
        };
        let mut values = [T::zero(); 3];
        for (&node, basis) in nodes.iter().zip(bases) {
            let [control] = controls[node as usize];
            for (value, &weight) in values.iter_mut().zip(&basis.values) {
                *value += weight * control;
            }
        }
        values
    }
}

/// The first and second derivatives of a basis function, in the number type of the surface.
pub(super) fn derivatives<T: Real>(basis: &Basis) -> [T; 5] {
    let ([v, w], [vv, vw, ww]) = (basis.first, basis.second);
    [v, w, vv, vw, ww].map(T::constant)
}

/// All patches of a mesh.
#[derive(Clone, Debug)]
pub(super) struct Patches<T> {
    /// Start of the nodes of each patch.
    offsets: Vec<usize>,
    /// Control points: vertices, followed by the points of refined triangles.
    nodes: Vec<u32>,
    /// The table of each patch, and the triangle that it lies in.
    tables: Vec<u32>,
    triangles: Vec<u32>,
    bases: Vec<Vec<NodeBasis<T>>>,
    /// Extraordinary vertices with the patches around them, sorted.
    around: Vec<(u32, u32)>,
    /// From control points to those of refined triangles.
    refined: Stencils,
    refined_transpose: Stencils,
    /// The nodes that each control point is.
    place_offsets: Vec<usize>,
    places: Vec<Place>,
}

/// A node of a patch: its block, and its entry there.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    block: u32,
    entry: u32,
}

/// Contributions of the patches of a block to their nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct PatchBlock<T> {
    pub(super) energy: T,
    /// Weighted area at each quadrature point of each patch.
    pub(super) areas: Vec<[T; 3]>,
    /// Force and mass for each node of each patch.
    pub(super) contributions: Vec<[T; 4]>,
}

impl<T: Real> PatchBlock<T> {
    /// The area of its patches.
    pub(super) fn area(&self) -> T {
        self.areas.iter().flatten().copied().sum()
    }
}

/// Builder of patches, with patches of the same bases next to each other.
#[derive(Default)]
struct Builder {
    groups: Vec<Group>,
}

/// Patches whose first corners have the same valence.
struct Group {
    valence: usize,
    /// The vertices at the first corners.
    firsts: Vec<u32>,
    /// `valence + 6` of each patch.
    nodes: Vec<u32>,
    triangles: Vec<u32>,
}

impl Builder {
    /// Adds a patch whose first corner has this valence; `first` is its number in the mesh that the
    /// patch is of.
    fn push(
        &mut self,
        triangle: usize,
        first: u32,
        valence: usize,
        nodes: impl Iterator<Item = u32>,
    ) {
        let known = self
            .groups
            .iter()
            .position(|group| group.valence == valence);
        let group = known.unwrap_or_else(|| {
            self.groups.push(Group {
                valence,
                firsts: Vec::new(),
                nodes: Vec::new(),
                triangles: Vec::new(),
            });
            self.groups.len() - 1
        });
        let group = &mut self.groups[group];
        group.firsts.push(first);
        group.nodes.extend(nodes);
        group.triangles.push(triangle as u32);
    }
}

impl<T: Real> Patches<T> {
    pub(super) fn new(mesh: &TriangleMesh) -> Self {
        let vertices = mesh.vertex_count();
        let mut builder = Builder::default();
        let mut to_refine = Vec::new();
        for triangle in 0..mesh.triangles().len() {
            match Patch::new(mesh, triangle) {
                Ok(patch) => {
                    let (first, valence) = (patch.nodes[0], patch.valence());
                    builder.push(triangle, first, valence, patch.nodes.into_iter());
                }
                Err(NoPatch::SeveralExtraordinary { .. }) => to_refine.push(triangle),
                Err(NoPatch::Boundary) => {}
            }
        }
        let refined = refine_triangles(mesh, &to_refine, &mut builder);

        let groups = builder.groups;
        let mut offsets = alloc::vec![0];
        let (mut nodes, mut tables, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
        let mut around = Vec::new();
        for (table, group) in groups.iter().enumerate() {
            let patches = group.nodes.chunks_exact(group.valence + 6);
            for (patch, &first) in patches.zip(&group.firsts) {
                // Vertices of the mesh keep their numbers under refinement, and only these can be
                // extraordinary.
                if group.valence != 6 {
                    around.push((first, tables.len() as u32));
                }
                nodes.extend_from_slice(patch);
                offsets.push(nodes.len());
                tables.push(table as u32);
            }
            triangles.extend_from_slice(&group.triangles);
        }
        around.sort_unstable();
        let (place_offsets, places) = places(&offsets, &nodes, vertices + refined.len());
        Self {
            offsets,
            nodes,
            tables,
            triangles,
            bases: groups.iter().map(|group| table(group.valence)).collect(),
            around,
            refined_transpose: refined.transpose(),
            refined,
            place_offsets,
            places,
        }
    }

    /// The entries, among the nodes of all, of the nodes of patches in a row.
    #[inline(always)]
    pub(super) fn entries(&self, patches: Range<usize>) -> Range<usize> {
        self.offsets[patches.start]..self.offsets[patches.end]
    }

    /// Number of patches.
    pub(super) fn len(&self) -> usize {
        self.tables.len()
    }

    /// Number of control points, those of refined triangles included.
    pub(super) fn control_count(&self) -> usize {
        self.place_offsets.len() - 1
    }

    /// Sets the control points of refined triangles, or a field on them.
    pub(super) fn refine<const D: usize>(
        &self,
        execution: &impl Execution,
        coarse: &[[T; D]],
        fine: &mut [[T; D]],
    ) {
        self.refined.apply(execution, coarse, fine);
    }

    /// The patches at an extraordinary vertex.
    pub(super) fn around(&self, vertex: usize) -> impl Iterator<Item = usize> {
        let start = self.around.partition_point(|&(v, _)| (v as usize) < vertex);
        let all = self.around[start..].iter();
        all.take_while(move |&&(v, _)| v as usize == vertex)
            .map(|&(_, patch)| patch as usize)
    }

    /// Number of consecutive patches from this one on, before `last`, with the same bases: at most
    /// one vector.
    #[inline(always)]
    pub(super) fn alike(&self, patch: usize, last: usize) -> usize {
        let tables = &self.tables[patch..last.min(patch + WIDTH)];
        let other = tables.iter().position(|&table| table != tables[0]);
        other.unwrap_or(tables.len())
    }

    #[inline(always)]
    pub(super) fn patch(&self, patch: usize) -> (&[u32], &[NodeBasis<T>]) {
        let nodes = &self.nodes[self.offsets[patch]..self.offsets[patch + 1]];
        (nodes, &self.bases[self.tables[patch] as usize])
    }

    /// The quadrature point nearest to the first corner of a patch.
    pub(super) fn nearest_point(&self, patch: usize, controls: &[[T; 4]]) -> Point<T> {
        let (nodes, bases) = self.patch(patch);
        let first = controls[nodes[0] as usize];
        let mut derivatives = [[T::zero(); 4]; 5];
        for (&node, basis) in nodes.iter().zip(bases).skip(1) {
            let spoke = difference(first, controls[node as usize]);
            accumulate(&mut derivatives, &basis.derivatives[0], spoke);
        }
        point(derivatives)
    }

    /// ∫ x·n dS over a patch.
    pub(super) fn flux(&self, patch: usize, controls: &[[T; 4]]) -> T {
        let (nodes, bases) = self.patch(patch);
        let mut sum = T::zero();
        for k in 0..3 {
            let mut position = [[T::zero(); 4]; 1];
            let mut derivatives = [[T::zero(); 4]; 5];
            for (&node, basis) in nodes.iter().zip(bases) {
                let control = controls[node as usize];
                accumulate(&mut position, &[basis.values[k]], control);
                accumulate(&mut derivatives, &basis.derivatives[k], control);
            }
            let [[x, y, z, _]] = position;
            let point = point(derivatives);
            sum += point.area * dot([x, y, z], point.normal);
        }
        T::constant(WEIGHT) * sum
    }

    /// The triangle of each patch that has no area at one of its points, after an evaluation.
    pub(super) fn without_area(&self, blocks: &[PatchBlock<T>]) -> impl Iterator<Item = u32> {
        let areas = blocks.iter().flat_map(|block| &block.areas);
        let empty = |area: &T| *area < T::min_positive_value();
        areas
            .zip(&self.triangles)
            .filter(move |(areas, _)| areas.iter().any(empty))
            .map(|(_, &triangle)| triangle)
    }

    /// Sets the contributions to nodes to the product of each patch's mass matrix, `Σ φφᵀ` over its
    /// points times their areas, with a field on the control points.
    pub(super) fn apply_mass(
        &self,
        execution: &impl Execution,
        field: &[[T; 4]],
        blocks: &mut [PatchBlock<T>],
    ) {
        execution.map(&mut blocks[..], |index, block| {
            block.contributions.clear();
            for (k, &areas) in block.areas.iter().enumerate() {
                let (nodes, bases) = self.patch(index * BLOCK + k);
                let mut values = [[T::zero(); 4]; 3];
                for (&node, basis) in nodes.iter().zip(bases) {
                    accumulate(&mut values, &basis.values, field[node as usize]);
                }
                for (value, area) in values.iter_mut().zip(areas) {
                    *value = value.map(|entry| area * entry);
                }
                let contributions = bases.iter().map(|basis| combine(&basis.values, &values));
                block.contributions.extend(contributions);
            }
        });
    }

    /// Sums the contributions at the control points. Those of refined triangles are pulled back to
    /// the vertices, which are the first entries of `gathered`.
    pub(super) fn gather(
        &self,
        execution: &impl Execution,
        blocks: &[PatchBlock<T>],
        gathered: &mut [[T; 4]],
    ) {
        execution.map(&mut gathered[..], |control, sum| {
            *sum = [T::zero(); 4];
            let range = self.place_offsets[control]..self.place_offsets[control + 1];
            for place in &self.places[range] {
                let contribution =
                    &blocks[place.block as usize].contributions[place.entry as usize];
                for axis in 0..4 {
                    sum[axis] += contribution[axis];
                }
            }
        });
        let vertices = self.refined.sources();
        let (coarse, fine) = gathered.split_at_mut(vertices);
        if !fine.is_empty() {
            execution.map(&mut coarse[..], |vertex, sum| {
                let pulled: [T; 4] = self.refined_transpose.at(vertex, fine);
                for axis in 0..4 {
                    sum[axis] += pulled[axis];
                }
            });
        }
    }
}

/// Converts derivatives that are padded to four numbers.
#[inline(always)]
pub(super) fn point<T: Real>(derivatives: [[T; 4]; 5]) -> Point<T> {
    Point::new(derivatives.map(|[x, y, z, _]| [x, y, z]))
}

#[inline(always)]
pub(super) fn difference<T: Real>(from: [T; 4], to: [T; 4]) -> [T; 4] {
    core::array::from_fn(|axis| to[axis] - from[axis])
}

/// Adds `weights[k]` times a vector to each sum.
#[inline(always)]
pub(super) fn accumulate<T: Real, const K: usize>(
    sums: &mut [[T; 4]; K],
    weights: &[T; K],
    vector: [T; 4],
) {
    for k in 0..K {
        for axis in 0..4 {
            sums[k][axis] += weights[k] * vector[axis];
        }
    }
}

/// Σ weights\[k\] vectors\[k\].
#[inline(always)]
fn combine<T: Real, const K: usize>(weights: &[T; K], vectors: &[[T; 4]; K]) -> [T; 4] {
    let mut sum = [T::zero(); 4];
    for k in 0..K {
        for axis in 0..4 {
            sum[axis] += weights[k] * vectors[k][axis];
        }
    }
    sum
}

/// The bases of a patch's nodes at the quadrature points.
fn table<T: Real>(valence: usize) -> Vec<NodeBasis<T>> {
    let points = POINTS.map(|[v, w]| basis(valence, v, w).unwrap_or_default());
    (0..valence + 6)
        .map(|node| NodeBasis {
            values: [0, 1, 2].map(|k| T::constant(points[k][node].value)),
            derivatives: [0, 1, 2].map(|k| derivatives(&points[k][node])),
        })
        .collect()
}

/// Adds the four parts of each of these triangles, and returns the map from the control points of
/// the mesh to the additional ones of these parts.
fn refine_triangles(mesh: &TriangleMesh, triangles: &[usize], builder: &mut Builder) -> Stencils {
    let vertices = mesh.vertex_count();
    if triangles.is_empty() {
        return Stencils::with_capacity(vertices, 0, 0);
    }
    let fine = match Subdivision::new(mesh, 1) {
        Ok(fine) => fine,
        Err(error) => {
            panic!("triangles with several extraordinary corners cannot be refined: {error}")
        }
    };
    let mut numbers = alloc::vec![NONE; fine.mesh().vertex_count()];
    let mut needed = Vec::new();
    for &triangle in triangles {
        for part in 4 * triangle..4 * triangle + 4 {
            // All corners of the parent are interior, and after refinement no two extraordinary
            // vertices share a triangle.
            let Ok(patch) = Patch::new(fine.mesh(), part) else {
                continue;
            };
            let (first, valence) = (patch.nodes[0], patch.valence());
            let nodes = patch.nodes.into_iter().map(|node| {
                let number = &mut numbers[node as usize];
                if *number == NONE {
                    *number = (vertices + needed.len()) as u32;
                    needed.push(node);
                }
                *number
            });
            builder.push(triangle, first, valence, nodes);
        }
    }
    let mut map = Stencils::with_capacity(vertices, needed.len(), 7 * needed.len());
    let mut sum = RowSum::new(vertices);
    for node in needed {
        sum.add_row(fine.stencils(), node as usize, 1.0);
        sum.finish(&mut map);
    }
    map
}

/// The nodes that each control point is.
fn places(offsets: &[usize], nodes: &[u32], controls: usize) -> (Vec<usize>, Vec<Place>) {
    let mut starts = alloc::vec![0usize; controls + 1];
    for &node in nodes {
        starts[node as usize + 1] += 1;
    }
    for control in 0..controls {
        starts[control + 1] += starts[control];
    }
    let mut next = starts.clone();
    let mut places = alloc::vec![Place::default(); nodes.len()];
    for patch in 0..offsets.len() - 1 {
        let block = patch / BLOCK;
        for entry in offsets[patch]..offsets[patch + 1] {
            let place = &mut next[nodes[entry] as usize];
            places[*place] = Place {
                block: block as u32,
                entry: (entry - offsets[block * BLOCK]) as u32,
            };
            *place += 1;
        }
    }
    (starts, places)
}
