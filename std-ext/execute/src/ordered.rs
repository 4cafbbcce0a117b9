//! Large meshes in a cache-friendly order.

use crate::execute::look_for_interruption;
use helfrich::{Finding, Real, Reordering, Surface, TriangleMesh};
use std::sync::Arc;

/// Smallest number of vertices for reordering; smaller meshes fit into caches in any order. An order takes the time of
/// some twenty evaluations of method B.
const WORTH_ORDERING: usize = 20_000;

/// A mesh in another order, with the surface and forces of the last evaluation.
#[derive(Debug)]
pub struct Ordered<T> {
    order: Reordering,
    mesh: Arc<TriangleMesh>,
    positions: Vec<[T; 3]>,
    remainders: Vec<[T; 3]>,
    force: Vec<[T; 3]>,
}

impl<T: Real> Ordered<T> {
    /// Reorders a mesh, if this is worthwhile.
    pub fn of(mesh: &TriangleMesh) -> Option<Self> {
        if mesh.vertex_count() < WORTH_ORDERING {
            return None;
        }
        let order = Reordering::reverse_cuthill_mckee(mesh);
        look_for_interruption();
        let mesh = Arc::new(order.of_mesh(mesh).ok()?);
        look_for_interruption();
        Some(Self {
            force: vec![[T::zero(); 3]; mesh.vertex_count()],
            order,
            mesh,
            positions: Vec::new(),
            remainders: Vec::new(),
        })
    }

    /// The mesh in this order.
    pub fn mesh(&self) -> &Arc<TriangleMesh> {
        &self.mesh
    }

    /// The order.
    pub fn order(&self) -> &Reordering {
        &self.order
    }

    /// Returns a surface in this order, and the forces of the previous evaluation on it.
    ///
    /// # Panics
    /// If the surface has another number of vertices than the mesh.
    pub fn parts(&mut self, surface: Surface<'_, T>) -> (Surface<'_, T>, &mut [[T; 3]]) {
        let Self {
            order,
            mesh,
            positions,
            remainders,
            force,
        } = self;
        let surface = order.of_surface(surface, mesh, positions, remainders);
        (surface, force)
    }

    /// Reports the findings of `inspect` about a surface in this order, with the vertex numbers of the user's
    /// mesh.
    ///
    /// # Panics
    /// If the surface has another number of vertices than the mesh.
    pub fn inspect(
        &self,
        surface: Surface<'_, T>,
        inspect: impl FnOnce(Surface<'_, T>, &mut dyn FnMut(Finding)),
        report: &mut dyn FnMut(Finding),
    ) {
        let (mut positions, mut remainders) = (Vec::new(), Vec::new());
        let order = &self.order;
        let surface = order.of_surface(surface, &self.mesh, &mut positions, &mut remainders);
        inspect(surface, &mut |finding| report(order.undo_finding(finding)));
    }

    /// Applies `change` to positions in this order, and returns its result.
    ///
    /// # Panics
    /// If there is not one position per vertex.
    pub fn change<R>(
        &mut self,
        positions: &mut [[T; 3]],
        change: impl FnOnce(&mut [[T; 3]]) -> R,
    ) -> R {
        let mut ordered = self.order.apply(positions);
        let result = change(&mut ordered);
        for (&vertex, position) in self.order.vertices().iter().zip(ordered) {
            positions[vertex as usize] = position;
        }
        result
    }

    /// Adds the forces in this order to those at the vertices of the user's mesh.
    ///
    /// # Panics
    /// If `sum` has fewer entries than the mesh has vertices.
    pub fn add_forces_to(&self, sum: &mut [[T; 3]]) {
        for (&vertex, own) in self.order.vertices().iter().zip(&self.force) {
            let sum = &mut sum[vertex as usize];
            *sum = std::array::from_fn(|axis| sum[axis] + own[axis]);
        }
    }
}
