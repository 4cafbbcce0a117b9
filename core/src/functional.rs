//! Numbers of a whole component (area, volume, integrated mean curvature) with exact gradients.
//!
//! Integrated mean curvature of polyhedra: J. Steiner, Monatsber. Preuss. Akad. Wiss. (1840) 114.

use crate::bending::{Hinge, Hinges};
use crate::element::{Corners, ElementKernel, Execution};
use crate::energy::{Finding, Method};
use crate::lane::Lane;
use crate::mesh::TriangleMesh;
use crate::projection::Components;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{cross, dot, scale};
use alloc::vec::Vec;
use core::ops::Range;

/// A number F_c of each connected component c of a surface, with its exact gradient.
///
/// Laws: unchanged when the surface is moved, turned or relabelled, to rounding; sums over a
/// component are grouped by the number of its elements alone.
pub trait Functional<T: Real>: Method<T> {
    /// The components the plan found.
    fn components<'a>(&self, plan: &'a Self::Plan) -> &'a Components;

    /// How many components the plan found.
    fn component_count(&self, plan: &Self::Plan) -> usize {
        self.components(plan).count()
    }

    /// Sets `values`, one entry a component.
    ///
    /// # Panics
    /// If `values` has fewer entries than the surface has components.
    fn values(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        values: &mut [T],
    );

    /// Adds `weights[c] ∂F_c/∂x_i`, c the component of vertex i, to `gradient[i]`.
    ///
    /// # Panics
    /// If `weights` has fewer entries than the surface has components, or `gradient` than it has
    /// vertices.
    fn add_gradient(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        weights: &[T],
        gradient: &mut [[T; 3]],
    );
}

/// Triangles (three corners) or hinges (four), those of one connected component after the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ComponentElements<const CORNERS: usize> {
    components: Components,
    elements: Vec<[u32; CORNERS]>,
    /// Where each component's elements begin, and the end.
    offsets: Vec<usize>,
}

impl<const CORNERS: usize> ComponentElements<CORNERS> {
    /// Groups `elements` by component, in their order.
    pub(crate) fn new(
        components: Components,
        elements: impl Iterator<Item = [u32; CORNERS]>,
    ) -> Self {
        let component = |element: &[u32; CORNERS]| components.of_vertex()[element[0] as usize];
        let mut elements = Vec::from_iter(elements);
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
    fn scatter<T: Real, K: ElementKernel<T, CORNERS, 0, 3>>(
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

/// The triangles of every component.
fn triangles(mesh: &TriangleMesh) -> ComponentElements<3> {
    ComponentElements::new(Components::new(mesh), mesh.triangles().iter().copied())
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

/// The area A of each component, a sum over its triangles.
///
/// A triangle without area has no gradient, and is reported by [`Method::inspect`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TotalArea;

/// The volume V that each component encloses: that of the polyhedron, positive if the triangles
/// run counter-clockwise seen from outside.
///
/// A component with boundary encloses nothing: V = 0, without gradient. (∫ x·n/3 dS over it would
/// depend on the origin.)
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EnclosedVolume;

/// The integrated mean curvature `M = ∫ H dS = ½ Σ l θ` of each component, l the length of an
/// interior edge, θ the angle between the normals of its two triangles, positive where the surface
/// is convex: 4πR on a sphere. In units of length.
///
/// The gradient `½ Σ (θ ∂l + l ∂θ)` is exact; on a closed component the second sum is zero (L.
/// Schläfli, Q. J. Pure Appl. Math. 2 (1858) 269), at a boundary it is not. Boundary edges and edges
/// at a triangle without area have no angle. θ jumps by 2π where two triangles fold onto each
/// other, and M with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TotalMeanCurvature;

/// `w ∂A/∂x`: at a corner half the opposite edge, turned outward in the plane.
struct AreaGradient<T>(T);

impl<T: Real> ElementKernel<T, 3, 0, 3> for AreaGradient<T> {
    #[inline(always)]
    fn evaluate<L: Lane<Scalar = T>>(
        &self,
        _first: usize,
        corners: &Corners<L, 3>,
        _input: &[[L; 0]; 3],
    ) -> [[L; 3]; 3] {
        let triangle = corners.triangle();
        let half = L::literal(0.5) * L::splat(self.0);
        let normal = scale(half, triangle.normal());
        triangle.edges.map(|edge| cross(normal, edge))
    }
}

/// `w ∂V/∂x`: on a closed surface a third of the area times the normal at each corner.
struct VolumeGradient<T>(T);

impl<T: Real> ElementKernel<T, 3, 0, 3> for VolumeGradient<T> {
    #[inline(always)]
    fn evaluate<L: Lane<Scalar = T>>(
        &self,
        _first: usize,
        corners: &Corners<L, 3>,
        _input: &[[L; 0]; 3],
    ) -> [[L; 3]; 3] {
        let sixth = L::literal(1.0 / 6.0) * L::splat(self.0);
        [scale(sixth, corners.triangle().area_vector); 3]
    }
}

/// `w ∂M/∂x`.
struct MeanCurvatureGradient<T>(T);

impl<T: Real> ElementKernel<T, 4, 0, 3> for MeanCurvatureGradient<T> {
    #[inline(always)]
    fn evaluate<L: Lane<Scalar = T>>(
        &self,
        _first: usize,
        corners: &Corners<L, 4>,
        _input: &[[L; 0]; 4],
    ) -> [[L; 3]; 4] {
        let half = L::literal(0.5) * L::splat(self.0);
        Hinge::new(corners).length_times_angle_gradient(corners, half)
    }
}

impl<T: Real> Method<T> for TotalArea {
    type Plan = ComponentElements<3>;
    type Memory = ();

    fn plan(&self, mesh: &TriangleMesh) -> Self::Plan {
        triangles(mesh)
    }

    fn inspect(
        &self,
        _plan: &Self::Plan,
        surface: Surface<'_, T>,
        _memory: &(),
        report: &mut dyn FnMut(Finding),
    ) {
        surface.report_degenerate_triangles(report);
    }
}

impl<T: Real> Functional<T> for TotalArea {
    fn components<'a>(&self, plan: &'a Self::Plan) -> &'a Components {
        plan.components()
    }

    fn values(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        _memory: &mut (),
        values: &mut [T],
    ) {
        plan.sums(execution, values, |_, triangle| {
            let corners = Corners::<T, 3>::of(surface, triangle);
            T::constant(0.5) * corners.triangle().doubled_area
        });
    }

    fn add_gradient(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        _memory: &mut (),
        weights: &[T],
        gradient: &mut [[T; 3]],
    ) {
        plan.scatter(execution, surface, weights, AreaGradient, gradient);
    }
}

impl<T: Real> Method<T> for EnclosedVolume {
    type Plan = ComponentElements<3>;
    type Memory = ();

    fn plan(&self, mesh: &TriangleMesh) -> Self::Plan {
        closed_triangles(mesh)
    }
}

impl<T: Real> Functional<T> for EnclosedVolume {
    fn components<'a>(&self, plan: &'a Self::Plan) -> &'a Components {
        plan.components()
    }

    fn values(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        _memory: &mut (),
        values: &mut [T],
    ) {
        plan.sums(execution, values, |first, triangle| {
            sixfold_volume(surface, first[0], triangle) / T::constant(6.0)
        });
    }

    fn add_gradient(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        _memory: &mut (),
        weights: &[T],
        gradient: &mut [[T; 3]],
    ) {
        plan.scatter(execution, surface, weights, VolumeGradient, gradient);
    }
}

impl<T: Real> Method<T> for TotalMeanCurvature {
    type Plan = ComponentElements<4>;
    type Memory = ();

    fn plan(&self, mesh: &TriangleMesh) -> Self::Plan {
        let hinges = Hinges::new(mesh).vertices;
        ComponentElements::new(Components::new(mesh), hinges.into_iter())
    }

    fn inspect(
        &self,
        _plan: &Self::Plan,
        surface: Surface<'_, T>,
        _memory: &(),
        report: &mut dyn FnMut(Finding),
    ) {
        surface.report_degenerate_triangles(report);
    }
}

impl<T: Real> Functional<T> for TotalMeanCurvature {
    fn components<'a>(&self, plan: &'a Self::Plan) -> &'a Components {
        plan.components()
    }

    fn values(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        _memory: &mut (),
        values: &mut [T],
    ) {
        plan.sums(execution, values, |_, hinge| {
            let hinge = Hinge::<T>::new(&Corners::of(surface, hinge));
            T::constant(0.5) * hinge.edge_length * hinge.angle()
        });
    }

    fn add_gradient(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        _memory: &mut (),
        weights: &[T],
        gradient: &mut [[T; 3]],
    ) {
        plan.scatter(execution, surface, weights, MeanCurvatureGradient, gradient);
    }
}

/// A functional that is chosen at run time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// [`TotalArea`].
    Area,
    /// [`EnclosedVolume`].
    Volume,
    /// [`TotalMeanCurvature`].
    MeanCurvature,
}

/// The plan of a [`Quantity`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum QuantityPlan {
    /// For sums over triangles.
    Triangles(ComponentElements<3>),
    /// For sums over hinges.
    Hinges(ComponentElements<4>),
}

impl<T: Real> Method<T> for Quantity {
    type Plan = QuantityPlan;
    type Memory = ();

    fn plan(&self, mesh: &TriangleMesh) -> Self::Plan {
        let triangles = QuantityPlan::Triangles;
        match self {
            Self::Area => triangles(Method::<T>::plan(&TotalArea, mesh)),
            Self::Volume => triangles(Method::<T>::plan(&EnclosedVolume, mesh)),
            Self::MeanCurvature => {
                QuantityPlan::Hinges(Method::<T>::plan(&TotalMeanCurvature, mesh))
            }
        }
    }
}

/// What [`Quantity`] panics with when its plan is another's.
const FOREIGN_PLAN: &str = "the plan was made by another quantity";

impl<T: Real> Functional<T> for Quantity {
    fn components<'a>(&self, plan: &'a Self::Plan) -> &'a Components {
        match plan {
            QuantityPlan::Triangles(plan) => plan.components(),
            QuantityPlan::Hinges(plan) => plan.components(),
        }
    }

    fn values(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut (),
        values: &mut [T],
    ) {
        match (self, plan) {
            (Self::Area, QuantityPlan::Triangles(plan)) => {
                TotalArea.values(execution, plan, surface, memory, values);
            }
            (Self::Volume, QuantityPlan::Triangles(plan)) => {
                EnclosedVolume.values(execution, plan, surface, memory, values);
            }
            (Self::MeanCurvature, QuantityPlan::Hinges(plan)) => {
                TotalMeanCurvature.values(execution, plan, surface, memory, values);
            }
            _ => panic!("{FOREIGN_PLAN}"),
        }
    }

    fn add_gradient(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut (),
        weights: &[T],
        gradient: &mut [[T; 3]],
    ) {
        match (self, plan) {
            (Self::Area, QuantityPlan::Triangles(plan)) => {
                TotalArea.add_gradient(execution, plan, surface, memory, weights, gradient);
            }
            (Self::Volume, QuantityPlan::Triangles(plan)) => {
                EnclosedVolume.add_gradient(execution, plan, surface, memory, weights, gradient);
            }
            (Self::MeanCurvature, QuantityPlan::Hinges(plan)) => {
                let quantity = TotalMeanCurvature;
                quantity.add_gradient(execution, plan, surface, memory, weights, gradient);
            }
            _ => panic!("{FOREIGN_PLAN}"),
        }
    }
}
