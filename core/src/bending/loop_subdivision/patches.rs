//! The triangles of the limit surface, and the loop over them.
//!
//! A patch takes its nodes' control points to derivatives at three quadrature points, by a table
//! that depends on nothing but the valence of its first corner; and derivatives of the energy back to
//! forces at its nodes, by the same table. Patches of all valences run through one loop.

use super::point::Point;
use crate::element::Execution;
use crate::mesh::TriangleMesh;
use crate::real::Real;
use crate::subdivision::{Basis, NoPatch, Patch, RowSum, Stencils, Subdivision, basis};
use crate::vec3::dot;
use alloc::vec::Vec;

/// Interior points of equal weight, exact for quadratic functions. One point would leave an energy
/// with negative modes; more points gain nothing. The first is the nearest to v0.
const POINTS: [[f64; 2]; 3] = [
    [1.0 / 6.0, 1.0 / 6.0],
    [2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0],
];

/// A third of the area of the parameter triangle.
const WEIGHT: f64 = 1.0 / 6.0;

/// Patches that are done by one call of an execution's loop.
const BLOCK: usize = 64;

/// Marks a patch without extraordinary vertex.
const NONE: u32 = u32::MAX;

/// What one node of a patch contributes at the quadrature points.
#[derive(Clone, Copy, Debug)]
struct NodeBasis<T> {
    values: [T; 3],
    /// ∂v, ∂w, ∂vv, ∂vw, ∂ww at the first point, at the second and at the third, and a 0 that fills
    /// the last vector register.
    derivatives: [T; DERIVATIVES],
}

/// A number on the limit surface.
#[derive(Clone, Copy, Debug)]
pub(super) enum Field<'a, T> {
    /// The same everywhere.
    Constant(T),
    /// One number a control point, for the basis functions to interpolate.
    Controlled(&'a [[T; 1]]),
}

impl<T: Real> Field<'_, T> {
    /// Its values at the quadrature points of a patch.
    #[inline(always)]
    fn at(self, nodes: &[u32], bases: &[NodeBasis<T>]) -> [T; 3] {
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

/// Room for five derivatives at three points.
const DERIVATIVES: usize = 16;

impl<T: Real> NodeBasis<T> {
    /// The derivatives at one point.
    fn at(&self, point: usize) -> [T; 5] {
        core::array::from_fn(|k| self.derivatives[5 * point + k])
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
    /// Where the nodes of each patch start.
    offsets: Vec<usize>,
    /// Control points: vertices, and after them the points of refined triangles.
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
    /// Where each control point is a node.
    place_offsets: Vec<usize>,
    places: Vec<Place>,
}

/// A node of a patch: its block, and its entry there.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    block: u32,
    entry: u32,
}

/// What the patches of a block give to their nodes.
#[derive(Clone, Debug, Default)]
pub(super) struct Block<T> {
    pub(super) energy: T,
    /// Weighted area at each quadrature point of each patch.
    areas: Vec<[T; 3]>,
    /// Force and mass for each node of each patch.
    gifts: Vec<[T; 4]>,
    /// The nodes of one patch, relative to its first.
    local: Vec<[T; 4]>,
}

impl<T: Real> Block<T> {
    /// The area of its patches.
    pub(super) fn area(&self) -> T {
        self.areas.iter().flatten().copied().sum()
    }
}

/// Patches in the making.
struct Builder {
    offsets: Vec<usize>,
    nodes: Vec<u32>,
    tables: Vec<u32>,
    triangles: Vec<u32>,
    valences: Vec<usize>,
    around: Vec<(u32, u32)>,
}

impl Builder {
    /// Adds a patch whose first corner is, or came from, the vertex `first`.
    fn push(
        &mut self,
        triangle: usize,
        first: u32,
        valence: usize,
        nodes: impl Iterator<Item = u32>,
    ) {
        let found = self.valences.iter().position(|&known| known == valence);
        let table = found.unwrap_or_else(|| {
            self.valences.push(valence);
            self.valences.len() - 1
        });
        if first != NONE {
            self.around.push((first, self.tables.len() as u32));
        }
        self.nodes.extend(nodes);
        self.offsets.push(self.nodes.len());
        self.tables.push(table as u32);
        self.triangles.push(triangle as u32);
    }
}

impl<T: Real> Patches<T> {
    pub(super) fn new(mesh: &TriangleMesh) -> Self {
        let vertices = mesh.vertex_count();
        let mut builder = Builder {
            offsets: alloc::vec![0],
            nodes: Vec::with_capacity(12 * mesh.triangles().len()),
            tables: Vec::with_capacity(mesh.triangles().len()),
            triangles: Vec::with_capacity(mesh.triangles().len()),
            valences: Vec::new(),
            around: Vec::new(),
        };
        let mut to_refine = Vec::new();
        for triangle in 0..mesh.triangles().len() {
            match Patch::new(mesh, triangle) {
                Ok(patch) => {
                    let valence = patch.valence();
                    let first = if valence == 6 { NONE } else { patch.nodes[0] };
                    builder.push(triangle, first, valence, patch.nodes.into_iter());
                }
                Err(NoPatch::SeveralExtraordinary { .. }) => to_refine.push(triangle),
                Err(NoPatch::Boundary) => {}
            }
        }
        let refined = refine_triangles(mesh, &to_refine, &mut builder);
        let Builder {
            offsets,
            nodes,
            tables,
            triangles,
            valences,
            mut around,
        } = builder;
        around.sort_unstable();
        let (place_offsets, places) = places(&offsets, &nodes, vertices + refined.len());
        Self {
            offsets,
            nodes,
            tables,
            triangles,
            bases: valences.into_iter().map(table).collect(),
            around,
            refined_transpose: refined.transpose(),
            refined,
            place_offsets,
            places,
        }
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

    fn patch(&self, patch: usize) -> (&[u32], &[NodeBasis<T>]) {
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
            accumulate(&mut derivatives, &basis.at(0), spoke);
        }
        Point::new(derivatives)
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
                accumulate(&mut derivatives, &basis.at(k), control);
            }
            let [[x, y, z, _]] = position;
            let point = Point::new(derivatives);
            sum += point.area * dot([x, y, z], point.normal);
        }
        T::constant(WEIGHT) * sum
    }

    /// The triangle of each patch that has no area at one of its points, after an evaluation.
    pub(super) fn without_area(&self, blocks: &[Block<T>]) -> impl Iterator<Item = u32> {
        let areas = blocks.iter().flat_map(|block| &block.areas);
        let empty = |area: &T| *area < T::min_positive_value();
        areas
            .zip(&self.triangles)
            .filter(move |(areas, _)| areas.iter().any(empty))
            .map(|(_, &triangle)| triangle)
    }

    fn blocks(&self) -> usize {
        self.len().div_ceil(BLOCK)
    }

    /// Sets energies and areas, and with `GRADIENT` forces and masses, from the control points.
    pub(super) fn evaluate<const GRADIENT: bool>(
        &self,
        execution: &impl Execution,
        modulus: T,
        spontaneous: Field<'_, T>,
        controls: &[[T; 4]],
        blocks: &mut Vec<Block<T>>,
    ) {
        blocks.resize_with(self.blocks(), Block::default);
        execution.map(&mut blocks[..], |index, block| {
            let first = index * BLOCK;
            let last = (first + BLOCK).min(self.len());
            block.energy = T::zero();
            block.areas.clear();
            block.gifts.clear();
            for patch in first..last {
                let (nodes, bases) = self.patch(patch);
                // Nearly all patches: a number of nodes that the compiler knows.
                if let (Ok(nodes), Ok(bases)) = (
                    <&[u32; 12]>::try_from(nodes),
                    <&[NodeBasis<T>; 12]>::try_from(bases),
                ) {
                    block.evaluate::<GRADIENT>(nodes, bases, modulus, spontaneous, controls);
                } else {
                    block.evaluate::<GRADIENT>(nodes, bases, modulus, spontaneous, controls);
                }
            }
        });
    }

    /// Sets the gifts to the product of each patch's mass matrix, `Σ φφᵀ` over its points times
    /// their areas, with a field on the control points.
    pub(super) fn apply_mass(
        &self,
        execution: &impl Execution,
        field: &[[T; 4]],
        blocks: &mut [Block<T>],
    ) {
        execution.map(&mut blocks[..], |index, block| {
            block.gifts.clear();
            for (k, &areas) in block.areas.iter().enumerate() {
                let (nodes, bases) = self.patch(index * BLOCK + k);
                let mut values = [[T::zero(); 4]; 3];
                for (&node, basis) in nodes.iter().zip(bases) {
                    accumulate(&mut values, &basis.values, field[node as usize]);
                }
                for (value, area) in values.iter_mut().zip(areas) {
                    *value = value.map(|entry| area * entry);
                }
                let gifts = bases.iter().map(|basis| combine(&basis.values, &values));
                block.gifts.extend(gifts);
            }
        });
    }

    /// Sums the gifts at their control points; those of refined triangles are pulled back to the
    /// vertices, which are the first entries of `gathered`.
    pub(super) fn gather(
        &self,
        execution: &impl Execution,
        blocks: &[Block<T>],
        gathered: &mut [[T; 4]],
    ) {
        execution.map(&mut gathered[..], |control, sum| {
            *sum = [T::zero(); 4];
            let range = self.place_offsets[control]..self.place_offsets[control + 1];
            for place in &self.places[range] {
                let gift = &blocks[place.block as usize].gifts[place.entry as usize];
                for axis in 0..4 {
                    sum[axis] += gift[axis];
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

impl<T: Real> Block<T> {
    #[inline(always)]
    fn evaluate<const GRADIENT: bool>(
        &mut self,
        nodes: &[u32],
        bases: &[NodeBasis<T>],
        modulus: T,
        spontaneous: Field<'_, T>,
        controls: &[[T; 4]],
    ) {
        let weight = T::constant(WEIGHT);
        let strength = weight * modulus;
        let first = controls[nodes[0] as usize];
        self.local.clear();
        let spokes = nodes
            .iter()
            .map(|&node| difference(first, controls[node as usize]));
        self.local.extend(spokes);

        let derivatives: [[T; DERIVATIVES]; 3] = core::array::from_fn(|axis| {
            let mut sums = [T::zero(); DERIVATIVES];
            for (basis, spoke) in bases.iter().zip(&self.local) {
                for (sum, &weight) in sums.iter_mut().zip(&basis.derivatives) {
                    *sum += weight * spoke[axis];
                }
            }
            sums
        });
        let wanted = spontaneous.at(nodes, bases);
        let mut areas = [T::zero(); 3];
        let mut gradients = [[T::zero(); DERIVATIVES]; 3];
        for (point, area) in areas.iter_mut().enumerate() {
            let vector = |k: usize| {
                let at = |axis: usize| derivatives[axis][5 * point + k];
                [at(0), at(1), at(2), T::zero()]
            };
            let geometry = Point::new(core::array::from_fn(vector));
            self.energy += geometry.energy(strength, wanted[point]);
            *area = weight * geometry.area;
            if GRADIENT {
                let gradient = geometry.gradient(strength, wanted[point]);
                for (k, vector) in gradient.into_iter().enumerate() {
                    for (axis, component) in vector.into_iter().enumerate() {
                        gradients[axis][5 * point + k] = -component;
                    }
                }
            }
        }
        self.areas.push(areas);
        if GRADIENT {
            self.gifts.extend(bases.iter().map(|basis| {
                let [x, y, z] = [0, 1, 2].map(|axis| product(&basis.derivatives, &gradients[axis]));
                let [a, b, c] = basis.values;
                [x, y, z, a * areas[0] + b * areas[1] + c * areas[2]]
            }));
        }
    }
}

/// Σ a\[k\] b\[k\], in four sums that a vector register can hold.
#[inline(always)]
fn product<T: Real>(a: &[T; DERIVATIVES], b: &[T; DERIVATIVES]) -> T {
    let mut sums = [T::zero(); 4];
    for (a, b) in a.as_chunks::<4>().0.iter().zip(b.as_chunks::<4>().0) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3])
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
            derivatives: core::array::from_fn(|k| {
                let point = points.get(k / 5);
                point.map_or(T::zero(), |bases| derivatives(&bases[node])[k % 5])
            }),
        })
        .collect()
}

/// Adds the four parts of each of these triangles, and returns the map from the mesh's control
/// points to those that only they need.
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
            // All corners of the parent are interior, and extraordinary ones are apart by now.
            let Ok(patch) = Patch::new(fine.mesh(), part) else {
                continue;
            };
            // A coarse vertex keeps its number, and only such a one can be extraordinary.
            let valence = patch.valence();
            let first = if valence == 6 { NONE } else { patch.nodes[0] };
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

/// Where each control point is a node.
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
