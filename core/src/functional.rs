//! Functionals of connected components (area, volume, length of the boundary, integrated curvatures)
//! with exact gradients.

use crate::components::Components;
use crate::element::{ElementKernel, Execution};
use crate::mesh::TriangleMesh;
use crate::method::{Method, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{cross, dot};
use alloc::vec::Vec;
use core::ops::Range;

mod boundary_length;
mod enclosed_volume;
mod total_area;
mod total_gaussian_curvature;
mod total_mean_curvature;

pub use boundary_length::BoundaryLength;
pub(crate) use boundary_length::LengthGradient;
pub use enclosed_volume::EnclosedVolume;
pub(crate) use enclosed_volume::VolumeGradient;
pub(crate) use total_area::AreaGradient;
pub use total_area::TotalArea;
pub use total_gaussian_curvature::{GaussianCurvatureMemory, TotalGaussianCurvature};
pub use total_mean_curvature::TotalMeanCurvature;

/// A number F_c of each connected component c of a surface, with its exact gradient.
///
/// Laws: unchanged when the surface is moved, turned or relabelled, to rounding; sums over a
/// component are grouped by the number of its elements alone.
pub trait Functional<T: Real>: Method<T> {
    /// The components of the workspace's mesh.
    fn components<'a>(&self, workspace: &'a Workspace<T, Self>) -> &'a Components;

    /// The number of components of the workspace's mesh.
    fn component_count(&self, workspace: &Workspace<T, Self>) -> usize {
        self.components(workspace).count()
    }

    /// Sets `values`, one entry per component.
    ///
    /// # Panics
    /// If `values` has fewer entries than the surface has components, or the surface another mesh
    /// than that of the workspace.
    fn values(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        values: &mut [T],
    );

    /// Adds `weights[c] ∂F_c/∂x_i`, c the component of vertex i, to `gradient[i]`.
    ///
    /// # Panics
    /// If `weights` has fewer entries than the surface has components, or `gradient` than it has
    /// vertices, or the surface another mesh than that of the workspace.
    fn add_gradient(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        weights: &[T],
        gradient: &mut [[T; 3]],
    );

    /// As [`Self::add_gradient`], for the surface of which [`Self::values`] had the values last, in the same
    /// workspace: what was found there need not be found again.
    ///
    /// # Panics
    /// As [`Self::add_gradient`], and if [`Self::values`] was not called with this workspace.
    fn add_measured_gradient(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        weights: &[T],
        gradient: &mut [[T; 3]],
    ) {
        self.add_gradient(execution, surface, workspace, weights, gradient);
    }
}

/// Boundary edges (two corners), triangles (three) or hinges (four), sorted by connected component.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ComponentElements<const CORNERS: usize> {
    components: Components,
    elements: Vec<[u32; CORNERS]>,
    /// Start of each component's elements, and the end of all.
    offsets: Vec<usize>,
}

impl<const CORNERS: usize> ComponentElements<CORNERS> {
    /// Groups `elements` by component, in their order.
    pub(crate) fn new(
        components: Components,
        elements: impl Iterator<Item = [u32; CORNERS]>,
    ) -> Self {
        Self::sorted(components, elements.collect())
    }

    // Not generic over the iterator, so that sorting is compiled once for each number of corners.
    fn sorted(components: Components, mut elements: Vec<[u32; CORNERS]>) -> Self {
        let component = |element: &[u32; CORNERS]| components.of_vertex()[element[0] as usize];
        elements.sort_by_key(component);
        let begins = |c| elements.partition_point(|element| component(element) < c);
        let offsets = (0..=components.count() as u32).map(begins).collect();
        Self {
            components,
            elements,
            offsets,
        }
    }

    /// The connected components.
    pub fn components(&self) -> &Components {
        &self.components
    }

    fn range(&self, component: usize) -> Range<usize> {
        self.offsets[component]..self.offsets[component + 1]
    }

    /// The elements of a component.
    ///
    /// # Panics
    /// If there is no such component.
    pub fn of(&self, component: usize) -> &[[u32; CORNERS]] {
        &self.elements[self.range(component)]
    }

    pub(crate) fn all(&self) -> &[[u32; CORNERS]] {
        &self.elements
    }

    /// Sets `values` to the sums of `term(first, element)`, `first` the component's first element.
    pub(crate) fn sums<T: Real>(
        &self,
        execution: &impl Execution,
        values: &mut [T],
        term: impl Fn([u32; CORNERS], [u32; CORNERS]) -> T + Sync,
    ) {
        for (component, value) in values[..self.components.count()].iter_mut().enumerate() {
            let elements = self.of(component);
            *value = execution.sum(elements.len(), |k| term(elements[0], elements[k]));
        }
    }

    /// Scatters `kernel(weights[c])` over the elements of each component c.
    pub(crate) fn scatter<T: Real, K: ElementKernel<T, CORNERS, 0, 3>>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        weights: &[T],
        kernel: impl Fn(T) -> K,
        gradient: &mut [[T; 3]],
    ) {
        for (component, &weight) in weights[..self.components.count()].iter().enumerate() {
            let elements = self.of(component);
            execution.scatter(&kernel(weight), surface, elements, &[], gradient);
        }
    }
}

/// The triangles of the components without boundary.
pub(crate) fn closed_triangles(mesh: &TriangleMesh) -> ComponentElements<3> {
    let components = Components::new(mesh);
    let mut closed = alloc::vec![true; components.count()];
    for (edge, &[vertex, _]) in mesh.edges().iter().enumerate() {
        let component = components.of_vertex()[vertex as usize];
        closed[component as usize] &= mesh.edge_triangles(edge).1.is_some();
    }
    let of_vertex = components.of_vertex().to_vec();
    let is_closed = |triangle: &[u32; 3]| closed[of_vertex[triangle[0] as usize] as usize];
    let triangles = mesh.triangles().iter().copied().filter(is_closed);
    ComponentElements::new(components, triangles)
}

/// Six times the signed volume between a triangle and a point on its component.
#[inline(always)]
pub(crate) fn sixfold_volume<T: Real>(
    surface: Surface<'_, T>,
    origin: u32,
    [a, b, c]: [u32; 3],
) -> T {
    let edges = [surface.difference(a, b), surface.difference(a, c)];
    dot(surface.difference(origin, a), cross(edges[0], edges[1]))
}
