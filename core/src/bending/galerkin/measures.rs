//! Area and enclosed volume of the patches.

use super::basis::{FREE, QuadraturePoint};
use super::material::Field;
use super::patch::{Bars, Patches, spread};
use super::plan::RETURNED;
use super::shape::{Return, Shape};
use super::vertices::Work;
use crate::bending::surface_point::area_vector;
use crate::components::Components;
use crate::diagnostic::Finding;
use crate::element::{Corners, Execution, SlotKernel, Slots, Strided, of_vertices};
use crate::functional::{
    AreaGradient, ComponentElements, Functional, VolumeGradient, closed_triangles, sixfold_volume,
};
use crate::lane::{Lane, Several, WIDTH};
use crate::mesh::TriangleMesh;
use crate::method::{Method, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, cross, dot, scale, sub};
use alloc::vec;
use alloc::vec::Vec;

/// Area `∫ dS` or enclosed volume `∫ x·n dS/3` of each component of the surface whose bending energy is
/// that of [`Galerkin`](crate::Galerkin): patches of degree 6 instead of flat triangles.
///
/// On smooth meshes that resolve the surface their errors are as small as those of the energy, while those
/// of [`TotalArea`](crate::TotalArea) and [`EnclosedVolume`](crate::EnclosedVolume) are of second order in
/// the edge length. Integrals are sums over the points at which the energy is evaluated, x is taken relative to the
/// mean of the component's vertices, and gradients are exact.
///
/// Triangles with a corner at a boundary, and those of components of less than 11 vertices, have no patch
/// and count as flat. The volume of a component with boundary is 0, without gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PatchFunctional {
    /// The area A.
    Area,
    /// The volume V, positive if triangles run counter-clockwise seen from outside.
    Volume,
}

/// Memory of [`PatchFunctional`].
#[derive(Clone, Debug)]
pub struct PatchFunctionalMemory<T> {
    shape: Shape<T>,
    vertices: ComponentElements<1>,
    /// The first corner and the number of each patch that counts.
    patches: ComponentElements<2>,
    /// Triangles that count and have no patch.
    rest: ComponentElements<3>,
    /// The mean of the vertices of each component, relative to the first.
    means: Vec<[T; 3]>,
    /// The derivatives with respect to the means.
    by_means: Vec<[T; 3]>,
    /// For each block of patches.
    integrals: Vec<Integrals<T>>,
    /// For each patch, 0 where it does not count.
    weights: Vec<T>,
    back: Return<T>,
    work: Vec<Work<T>>,
    idle: Vec<()>,
}

/// A functional of each patch, and its derivative with respect to the origin.
#[derive(Clone, Copy, Debug)]
struct Integrals<T> {
    value: Several<T>,
    by_origin: Vec3<Several<T>>,
}

impl<T: Real> Default for Integrals<T> {
    fn default() -> Self {
        let value = Several::zero();
        Self {
            value,
            by_origin: [value; 3],
        }
    }
}

/// The functional of patches, and with `GRADIENT` its derivatives with respect to what they are made of, times
/// the weights.
struct Measuring<'a, T, const GRADIENT: bool> {
    functional: PatchFunctional,
    shape: &'a Shape<T>,
    surface: Surface<'a, T>,
    components: &'a ComponentElements<1>,
    means: &'a [[T; 3]],
    weights: &'a [T],
}

type MeasuringSlots<'a, T> = (&'a mut [Integrals<T>], Strided<'a, Several<T>>);

impl<'a, T: Real, const GRADIENT: bool> SlotKernel<(), MeasuringSlots<'a, T>>
    for Measuring<'_, T, GRADIENT>
{
    #[inline(always)]
    fn set(&self, (): &mut (), start: usize, (integrals, returned): MeasuringSlots<'a, T>) {
        let slots = integrals.iter_mut().zip(returned.into_slots());
        for (index, (integrals, returned)) in slots.enumerate() {
            let first = (start + index) * WIDTH;
            let patches = self.shape.patches(self.surface, first);
            *integrals = Integrals::default();
            let mut bars = Bars::default();
            let origins = match self.functional {
                PatchFunctional::Area => None,
                PatchFunctional::Volume => Some(self.origins(first)),
            };
            let weights = self.weights(first);
            for node in &self.shape.basis.bulk {
                match &origins {
                    None => add_area::<T, GRADIENT>(&patches, node, weights, integrals, &mut bars),
                    Some(origins) => {
                        let at = sub(patches.position(node), *origins);
                        add_volume::<T, GRADIENT>(
                            &patches, node, at, weights, integrals, &mut bars,
                        );
                    }
                }
            }
            if GRADIENT {
                patches.give_back(&bars, returned);
                // The first corner carries the whole patch with it.
                for (row, by_origin) in returned[FREE..].iter_mut().zip(integrals.by_origin) {
                    *row = *row - weights * by_origin;
                }
            }
        }
    }
}

/// Adds `J` at a quadrature point.
#[inline(always)]
fn add_area<T: Real, const GRADIENT: bool>(
    patches: &Patches<T>,
    node: &QuadraturePoint<T>,
    weights: Several<T>,
    integrals: &mut Integrals<T>,
    bars: &mut Bars<T>,
) {
    let [v, w] = patches.derivatives(node);
    let (vector, area) = area_vector(v, w);
    let part = Several::splat(node.weight);
    integrals.value = integrals.value + part * area;
    if GRADIENT {
        let normal = scale(part * weights * area.reciprocal_or_zero(), vector);
        spread(bars, node, &[cross(w, normal), cross(normal, v)]);
    }
}

/// Adds `x·(x_v × x_w)/3` at a quadrature point.
#[inline(always)]
fn add_volume<T: Real, const GRADIENT: bool>(
    patches: &Patches<T>,
    node: &QuadraturePoint<T>,
    at: Vec3<Several<T>>,
    weights: Several<T>,
    integrals: &mut Integrals<T>,
    bars: &mut Bars<T>,
) {
    let [v, w] = patches.derivatives(node);
    let part = Several::splat(node.weight / T::constant(3.0));
    let vector = scale(part, cross(v, w));
    integrals.value = integrals.value + dot(at, vector);
    integrals.by_origin = sub(integrals.by_origin, vector);
    if GRADIENT {
        let strength = part * weights;
        let [by_v, by_w] = [cross(w, at), cross(at, v)].map(|by| scale(strength, by));
        spread(bars, node, &[by_v, by_w]);
        bars.add_position(node, scale(weights, vector));
    }
}

impl<T: Real, const GRADIENT: bool> Measuring<'_, T, GRADIENT> {
    /// The weights of the patches from number `first` on.
    #[inline(always)]
    fn weights(&self, first: usize) -> Several<T> {
        Several::from_fn(|lane| self.weights.get(first + lane).copied().unwrap_or_default())
    }

    /// The mean of the vertices of each patch's component, relative to the patch's first corner.
    #[inline(always)]
    fn origins(&self, first: usize) -> Vec3<Several<T>> {
        let mut origins = [Several::zero(); 3];
        for lane in 0..WIDTH {
            let corner = self.shape.plan.patch_in(first, lane).corners[0];
            let component = self.components.components().of_vertex()[corner as usize] as usize;
            let [vertex] = self.components.of(component)[0];
            let origin = add(
                self.surface.difference(corner, vertex),
                self.means[component],
            );
            for axis in 0..3 {
                origins[axis].0[lane] = origin[axis];
            }
        }
        origins
    }
}

impl<T: Real> Method<T> for PatchFunctional {
    type Memory = PatchFunctionalMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> PatchFunctionalMemory<T> {
        let shape = Shape::new(mesh);
        let all = match self {
            Self::Area => {
                ComponentElements::new(Components::new(mesh), mesh.triangles().iter().copied())
            }
            Self::Volume => closed_triangles(mesh),
        };
        let components = all.components().clone();
        let mut counted = vec![false; components.count()];
        for &[corner, ..] in all.all() {
            counted[components.of_vertex()[corner as usize] as usize] = true;
        }
        let counts = |corner: u32| counted[components.of_vertex()[corner as usize] as usize];
        let patches = (0..).zip(&shape.plan.patches);
        let patches = patches.map(|(number, patch)| [patch.corners[0], number]);
        let patches = patches.filter(|&[corner, _]| counts(corner));
        let mut has_patch = vec![false; mesh.triangles().len()];
        for &triangle in &shape.plan.triangles {
            has_patch[triangle as usize] = true;
        }
        let rest = mesh.triangles().iter().zip(&has_patch);
        let rest = rest.filter(|&(triangle, has_patch)| !has_patch && counts(triangle[0]));
        let vertices = (0..mesh.vertex_count() as u32).map(|vertex| [vertex]);
        PatchFunctionalMemory {
            vertices: ComponentElements::new(components.clone(), vertices),
            patches: ComponentElements::new(components.clone(), patches),
            rest: ComponentElements::new(components.clone(), rest.map(|(triangle, _)| *triangle)),
            shape,
            means: Vec::new(),
            by_means: Vec::new(),
            integrals: Vec::new(),
            weights: Vec::new(),
            back: Return::default(),
            work: Vec::new(),
            idle: Vec::new(),
        }
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        workspace.for_mesh(surface.mesh()).shape.report_fits(report);
    }
}

impl PatchFunctional {
    /// Sets patches and the means of components.
    fn set_shape<T: Real>(
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut PatchFunctionalMemory<T>,
    ) {
        let PatchFunctionalMemory {
            shape,
            vertices,
            means,
            work,
            ..
        } = memory;
        shape.set(execution, surface, work);
        let components = vertices.components();
        means.resize(components.count(), [T::zero(); 3]);
        for (component, mean) in means.iter_mut().enumerate() {
            let own = vertices.of(component);
            let part = T::one() / T::constant(own.len() as f64);
            let [first] = own[0];
            *mean = [0, 1, 2].map(|axis| {
                let away = |k: usize| surface.difference(first, own[k][0])[axis];
                part * execution.sum(own.len(), away)
            });
        }
    }

    /// Sets the integrals over patches, and with `GRADIENT` their derivatives, times minus the weights of
    /// components.
    fn measure<T: Real, const GRADIENT: bool>(
        self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut PatchFunctionalMemory<T>,
        weights: &[T],
    ) {
        let PatchFunctionalMemory {
            shape,
            vertices,
            patches,
            means,
            integrals,
            weights: of_patches,
            back,
            idle,
            ..
        } = memory;
        let components = vertices.components();
        of_patches.clear();
        if GRADIENT {
            of_patches.resize(shape.plan.patches.len(), T::zero());
            for &[corner, patch] in patches.all() {
                let component = components.of_vertex()[corner as usize];
                of_patches[patch as usize] = -weights[component as usize];
            }
        }
        let shape = &*shape;
        integrals.resize(shape.blocks(), Integrals::default());
        back.returned
            .resize(shape.blocks() * RETURNED, Several::zero());
        let measuring = Measuring::<T, GRADIENT> {
            functional: self,
            shape,
            surface,
            components: vertices,
            means,
            weights: of_patches,
        };
        let slots = (
            &mut integrals[..],
            Strided::new(&mut back.returned, RETURNED),
        );
        execution.run(idle, slots, &measuring);
    }
}

impl<T: Real> Functional<T> for PatchFunctional {
    fn components<'a>(&self, workspace: &'a Workspace<T, Self>) -> &'a Components {
        workspace.memory().vertices.components()
    }

    fn values(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        values: &mut [T],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        Self::set_shape(execution, surface, memory);
        self.measure::<T, false>(execution, surface, memory, &[]);
        let flat = |first: [u32; 3], triangle: [u32; 3]| match self {
            Self::Area => {
                let corners = Corners::<T, 3>::of(surface, triangle);
                T::constant(0.5) * corners.triangle().doubled_area
            }
            Self::Volume => sixfold_volume(surface, first[0], triangle) / T::constant(6.0),
        };
        memory.rest.sums(execution, values, flat);
        for (component, value) in values.iter_mut().enumerate().take(memory.means.len()) {
            let own = memory.patches.of(component);
            *value += execution.sum(own.len(), |k| {
                let patch = own[k][1] as usize;
                memory.integrals[patch / WIDTH].value.0[patch % WIDTH]
            });
        }
    }

    fn add_gradient(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        weights: &[T],
        gradient: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        Self::set_shape(execution, surface, memory);
        self.add_measured_gradient(execution, surface, workspace, weights, gradient);
    }

    fn add_measured_gradient(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        weights: &[T],
        gradient: &mut [[T; 3]],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        assert!(
            memory.means.len() == memory.vertices.components().count(),
            "PatchFunctional::add_measured_gradient needs the values of the same surface: call `values` first"
        );
        self.measure::<T, true>(execution, surface, memory, weights);
        let PatchFunctionalMemory {
            shape,
            vertices,
            patches,
            rest,
            by_means,
            integrals,
            back,
            work,
            ..
        } = memory;
        let none = [Field::Constant(T::zero()); 2];
        let returned = (&*shape, RETURNED);
        back.subtract_from(execution, surface, returned, none, work, gradient);
        match self {
            Self::Area => rest.scatter(execution, surface, weights, AreaGradient, gradient),
            Self::Volume => {
                rest.scatter(execution, surface, weights, VolumeGradient, gradient);
                by_means.resize(vertices.components().count(), [T::zero(); 3]);
                for (component, by_mean) in by_means.iter_mut().enumerate() {
                    let own = patches.of(component);
                    let count = vertices.of(component).len();
                    let part = weights[component] / T::constant(count as f64);
                    *by_mean = [0, 1, 2].map(|axis| {
                        let entry = |k: usize| {
                            let patch = own[k][1] as usize;
                            integrals[patch / WIDTH].by_origin[axis].0[patch % WIDTH]
                        };
                        part * execution.sum(own.len(), entry)
                    });
                }
                let of_vertex = vertices.components().of_vertex();
                execution.map(of_vertices(surface, gradient), |vertex, gradient| {
                    *gradient = add(*gradient, by_means[of_vertex[vertex] as usize]);
                });
            }
        }
    }
}
