//! Large meshes in a cache-friendly order.

use crate::method::Fields;
use helfrich::{Real, Reordering, Surface, TriangleMesh};

/// The least number of vertices for reordering; smaller meshes fit the caches in any order.
const WORTH_ORDERING: usize = 100_000;

/// A mesh in another order, and the surface that was evaluated last.
#[derive(Debug)]
pub(crate) struct Ordered<T> {
    order: Reordering,
    mesh: TriangleMesh,
    positions: Vec<[T; 3]>,
    remainders: Vec<[T; 3]>,
    force: Vec<[T; 3]>,
}

impl<T: Real> Ordered<T> {
    /// An order for a mesh, if reordering is worthwhile.
    pub(crate) fn of(mesh: &TriangleMesh) -> Option<Self> {
        if mesh.vertex_count() < WORTH_ORDERING {
            return None;
        }
        let order = Reordering::reverse_cuthill_mckee(mesh);
        let mesh = order.of_mesh(mesh).ok()?;
        Some(Self {
            force: vec![[T::zero(); 3]; mesh.vertex_count()],
            order,
            mesh,
            positions: Vec::new(),
            remainders: Vec::new(),
        })
    }

    /// The mesh in this order.
    pub(crate) fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// The order.
    pub(crate) fn order(&self) -> &Reordering {
        &self.order
    }

    /// A surface in this order, and memory for its forces.
    pub(crate) fn parts(&mut self, surface: Surface<'_, T>) -> (Surface<'_, T>, &mut [[T; 3]]) {
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

    /// The forces in the order of the user's mesh.
    pub(crate) fn put_back(&self, force: &mut [[T; 3]]) {
        let old = self.order.vertices().iter();
        for (&vertex, found) in old.zip(&self.force) {
            force[vertex as usize] = *found;
        }
    }

    /// All results of a method, in the order of the user's mesh.
    pub(crate) fn undo(&self, fields: &Fields<T>) -> Fields<T> {
        let order = &self.order;
        Fields {
            area: order.undo(&fields.area),
            normal: order.undo(&fields.normal),
            mean: order.undo(&fields.mean),
            gaussian: order.undo(&fields.gaussian),
            laplacian_of_mean: order.undo(&fields.laplacian_of_mean),
            force_density: order.undo(&fields.force_density),
        }
    }
}
