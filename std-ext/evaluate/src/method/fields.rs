//! Per-vertex results of a method.

use helfrich::bending::StrongFormMemory;
use helfrich::{Curvature, Real, Reordering, TriangleMesh, VertexKind};

/// All results of a method on a surface, one value per vertex; `None` where undefined.
#[derive(Clone, Debug, PartialEq)]
pub struct Fields<T> {
    /// Mixed area.
    pub area: Vec<T>,
    /// Outward unit normal; 0 where undefined.
    pub normal: Vec<[T; 3]>,
    /// Mean curvature H, positive on a sphere.
    pub mean: Vec<Option<T>>,
    /// Gaussian curvature K.
    pub gaussian: Vec<Option<T>>,
    /// Δ_S H.
    pub laplacian_of_mean: Vec<Option<T>>,
    /// Force density f; for methods with nodal forces only, F divided by the mixed area.
    pub force_density: Vec<Option<[T; 3]>>,
}

fn where_defined<V: Copy>(values: &[V], defined: impl Fn(usize) -> bool) -> Vec<Option<V>> {
    values
        .iter()
        .enumerate()
        .map(|(vertex, &value)| defined(vertex).then_some(value))
        .collect()
}

impl<T: Real> Fields<T> {
    /// Leaves the curvatures of a vertex undefined, and its force density unless the mixed area is above 0.
    pub(super) fn clear(&mut self, vertex: usize) {
        self.mean[vertex] = None;
        self.gaussian[vertex] = None;
        self.laplacian_of_mean[vertex] = None;
        if self.area[vertex] <= T::zero() {
            self.force_density[vertex] = None;
        }
    }

    /// Leaves quantities with fourth derivatives undefined at a vertex.
    pub(super) fn clear_fourth_derivative(&mut self, vertex: usize) {
        self.laplacian_of_mean[vertex] = None;
        self.force_density[vertex] = None;
    }

    /// Converts results on a reordered mesh to the order of the user's mesh.
    pub(super) fn undone(&self, order: &Reordering) -> Self {
        Self {
            area: order.undo(&self.area),
            normal: order.undo(&self.normal),
            mean: order.undo(&self.mean),
            gaussian: order.undo(&self.gaussian),
            laplacian_of_mean: order.undo(&self.laplacian_of_mean),
            force_density: order.undo(&self.force_density),
        }
    }

    pub(super) fn set_density(&mut self, force: &[[T; 3]]) {
        let over = |force: [T; 3], area: T| {
            let density = force.map(|component| component / area);
            let defined = area > T::zero() && density.iter().all(|component| component.is_finite());
            defined.then_some(density)
        };
        self.force_density = force
            .iter()
            .zip(&self.area)
            .map(|(&force, &area)| over(force, area))
            .collect();
    }

    pub(super) fn set_normals(&mut self, curvature: &[Curvature<T>]) {
        self.normal = curvature.iter().map(|vertex| vertex.normal).collect();
    }

    /// Sets normals and H.
    pub(super) fn set_mean(&mut self, curvature: &[Curvature<T>]) {
        self.set_normals(curvature);
        let interior = |vertex: usize| curvature[vertex].kind == VertexKind::Interior;
        let mean: Vec<T> = curvature.iter().map(|vertex| vertex.mean).collect();
        self.mean = where_defined(&mean, interior);
    }

    /// Sets normals, H and K.
    pub(super) fn set_curvature(&mut self, curvature: &[Curvature<T>]) {
        let interior = |vertex: usize| curvature[vertex].kind == VertexKind::Interior;
        let gaussian: Vec<T> = curvature.iter().map(|vertex| vertex.gaussian).collect();
        self.set_mean(curvature);
        self.gaussian = where_defined(&gaussian, interior);
    }

    pub(super) fn set_strong_form<W>(
        &mut self,
        mesh: &TriangleMesh,
        memory: &StrongFormMemory<T, W>,
        density: &[[T; 3]],
    ) {
        let surrounded = |vertex| mesh.is_surrounded(vertex);
        self.set_curvature(memory.curvature());
        self.laplacian_of_mean = where_defined(memory.laplacian_of_mean(), surrounded);
        self.set_surrounded_density(mesh, density);
    }

    /// Sets force densities, which are defined where a vertex and all its neighbours are interior.
    pub(super) fn set_surrounded_density(&mut self, mesh: &TriangleMesh, density: &[[T; 3]]) {
        self.force_density = where_defined(density, |vertex| mesh.is_surrounded(vertex));
    }
}
