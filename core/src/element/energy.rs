//! Energies that are sums over elements.

use super::{Corners, ElementKernel, Execution};
use crate::parameter::ParameterError;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::add;
use alloc::vec::Vec;

/// An energy `Σ w`, w a function of the corners of one element.
///
/// Laws: those of an [`ElementKernel`], and the forces are the exact gradient. Where only one of the
/// two results is wanted, compilers leave out the arithmetic of the other.
pub trait ElementEnergy<T: Real, const CORNERS: usize>: Sync {
    /// −∂w/∂x at each corner of element `element`, and the part of w that each corner gets.
    fn evaluate(
        &self,
        element: usize,
        corners: &Corners<T, CORNERS>,
    ) -> ([[T; 3]; CORNERS], [T; CORNERS]);

    /// Refuses parameters that are no numbers, or so large that results overflow. By default there
    /// are none to refuse.
    ///
    /// # Errors
    /// The parameter, its value and its limit.
    fn check(&self) -> Result<(), ParameterError> {
        Ok(())
    }
}

struct Forces<E>(E);

impl<T: Real, E: ElementEnergy<T, CORNERS>, const CORNERS: usize> ElementKernel<T, CORNERS, 0, 3>
    for Forces<&E>
{
    #[inline(always)]
    fn evaluate(
        &self,
        element: usize,
        corners: &Corners<T, CORNERS>,
        _input: &[[T; 0]; CORNERS],
    ) -> [[T; 3]; CORNERS] {
        self.0.evaluate(element, corners).0
    }
}

struct Shares<E>(E);

impl<T: Real, E: ElementEnergy<T, CORNERS>, const CORNERS: usize> ElementKernel<T, CORNERS, 0, 1>
    for Shares<&E>
{
    #[inline(always)]
    fn evaluate(
        &self,
        element: usize,
        corners: &Corners<T, CORNERS>,
        _input: &[[T; 0]; CORNERS],
    ) -> [[T; 1]; CORNERS] {
        self.0.evaluate(element, corners).1.map(|share| [share])
    }
}

struct Both<E>(E);

impl<T: Real, E: ElementEnergy<T, CORNERS>, const CORNERS: usize> ElementKernel<T, CORNERS, 0, 4>
    for Both<&E>
{
    #[inline(always)]
    fn evaluate(
        &self,
        element: usize,
        corners: &Corners<T, CORNERS>,
        _input: &[[T; 0]; CORNERS],
    ) -> [[T; 4]; CORNERS] {
        let (forces, shares) = self.0.evaluate(element, corners);
        core::array::from_fn(|k| [forces[k][0], forces[k][1], forces[k][2], shares[k]])
    }
}

/// Memory for an energy that is a sum over elements.
#[derive(Clone, Debug, Default)]
pub struct ElementMemory<T> {
    /// The energy at each vertex.
    shares: Vec<[T; 1]>,
    /// The force at each vertex, and the same energy.
    nodal: Vec<[T; 4]>,
}

impl<T: Real> ElementMemory<T> {
    /// Allocates everything at once, so that no kind of evaluation allocates later.
    fn resize(&mut self, surface: Surface<'_, T>) {
        let vertices = surface.mesh().vertex_count();
        self.shares.resize(vertices, [T::zero()]);
        self.nodal.resize(vertices, [T::zero(); 4]);
    }

    /// The energy of these elements.
    pub(crate) fn energy<const CORNERS: usize>(
        &mut self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        elements: &[[u32; CORNERS]],
        energy: &impl ElementEnergy<T, CORNERS>,
    ) -> T {
        self.resize(surface);
        let shares = &mut self.shares[..];
        shares.fill([T::zero()]);
        execution.scatter(&Shares(energy), surface, elements, &[], shares);
        execution.sum(shares.len(), |vertex| shares[vertex][0])
    }

    /// Adds the nodal forces of these elements.
    pub(crate) fn add_force<const CORNERS: usize>(
        &mut self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        elements: &[[u32; CORNERS]],
        energy: &impl ElementEnergy<T, CORNERS>,
        force: &mut [[T; 3]],
    ) {
        self.resize(surface);
        execution.scatter(&Forces(energy), surface, elements, &[], force);
    }

    /// Adds the nodal forces of these elements, and returns their energy.
    pub(crate) fn add_force_and_energy<const CORNERS: usize>(
        &mut self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        elements: &[[u32; CORNERS]],
        energy: &impl ElementEnergy<T, CORNERS>,
        force: &mut [[T; 3]],
    ) -> T {
        self.resize(surface);
        let nodal = &mut self.nodal[..];
        nodal.fill([T::zero(); 4]);
        execution.scatter(&Both(energy), surface, elements, &[], nodal);
        let nodal = &*nodal;
        execution.map(&mut force[..nodal.len()], |vertex, force| {
            let [x, y, z, _] = nodal[vertex];
            *force = add(*force, [x, y, z]);
        });
        execution.sum(nodal.len(), |vertex| nodal[vertex][3])
    }
}
