//! Methods of each kind as [`Act`] objects.

use super::super::Visitor;
use super::super::fields::Fields;
use crate::act::Act;
use helfrich::{
    Conservative, Cotangent, Curvature, Curvatures, DualArea, Execution, Finding, ForceDensity,
    LaplaceBeltrami, Prepared, Real, StrongForm, Surface, TriangleMesh, VertexKind,
};
use std::fmt;

/// Visitor that prepares a method for a mesh as an [`Act`] object.
pub(in crate::method) struct Preparing<'a, T, X> {
    pub(super) mesh: &'a TriangleMesh,
    pub(super) execution: X,
    pub(super) modulus: T,
    /// Whether the method defines K.
    pub(super) gaussian: bool,
}

impl<T, X> Visitor<T> for Preparing<'_, T, X>
where
    T: Real,
    X: Execution + fmt::Debug + Send + 'static,
{
    type Output = Box<dyn Act<T>>;

    fn energy<M>(self, method: M) -> Self::Output
    where
        M: Conservative<T> + fmt::Debug + Send + 'static,
    {
        Box::new(WithEnergy {
            prepared: Prepared::with_execution(method, self.mesh, self.execution),
            describe: |_, surface, fields| {
                let mut cotangent = Prepared::new(Cotangent::new(DualArea::Mixed), surface.mesh());
                fields.set_normals(cotangent.curvatures(surface));
            },
            density: None,
        })
    }

    fn energy_and_curvatures<M>(self, method: M) -> Self::Output
    where
        M: Conservative<T> + Curvatures<T> + fmt::Debug + Send + 'static,
    {
        Box::new(WithEnergy {
            prepared: Prepared::with_execution(method, self.mesh, self.execution),
            describe: if self.gaussian {
                |prepared, surface, fields| fields.set_curvature(prepared.curvatures(surface))
            } else {
                |prepared, surface, fields| fields.set_mean(prepared.curvatures(surface))
            },
            density: None,
        })
    }

    fn energy_and_density<M>(self, method: M) -> Self::Output
    where
        M: Conservative<T> + Curvatures<T> + ForceDensity<T> + fmt::Debug + Send + 'static,
    {
        Box::new(WithEnergy {
            prepared: Prepared::with_execution(method, self.mesh, self.execution),
            describe: |prepared, surface, fields| {
                fields.set_curvature(prepared.curvatures(surface));
            },
            density: Some(|prepared, surface, fields| {
                let mut density = vec![[T::zero(); 3]; surface.mesh().vertex_count()];
                prepared.force_density(surface, &mut density);
                fields.set_surrounded_density(surface.mesh(), &density);
            }),
        })
    }

    fn strong_form<L>(self, method: StrongForm<T, L>) -> Self::Output
    where
        L: LaplaceBeltrami<T> + fmt::Debug + Send + Sync + 'static,
    {
        let prepared = Prepared::with_execution(method, self.mesh, self.execution);
        Box::new(InStrongForm(prepared))
    }

    fn curvatures<M>(self, method: M) -> Self::Output
    where
        M: Curvatures<T> + fmt::Debug + Send + 'static,
    {
        let prepared = Prepared::with_execution(method, self.mesh, self.execution);
        Box::new(WithoutForce {
            prepared,
            modulus: self.modulus,
        })
    }
}

/// Function that sets fields of a surface.
type DescribeFn<T, M, X> = fn(&mut Prepared<T, M, X>, Surface<'_, T>, &mut Fields<T>);

#[derive(Debug)]
struct WithEnergy<T, M, X>
where
    T: Real,
    M: Conservative<T>,
{
    prepared: Prepared<T, M, X>,
    /// Sets normals and curvatures.
    describe: DescribeFn<T, M, X>,
    /// Sets a force density that does not follow from nodal forces.
    density: Option<DescribeFn<T, M, X>>,
}

impl<T, M, X> Act<T> for WithEnergy<T, M, X>
where
    T: Real,
    M: Conservative<T> + fmt::Debug + Send,
    X: Execution + fmt::Debug + Send,
{
    fn add_force(&mut self, surface: Surface<'_, T>, force: &mut [[T; 3]]) -> T {
        self.prepared.add_force_and_energy(surface, force)
    }

    fn has_fields_of_force(&self) -> bool {
        self.density.is_none()
    }

    fn collect(
        &mut self,
        surface: Surface<'_, T>,
        force: Option<&[[T; 3]]>,
        fields: &mut Fields<T>,
    ) {
        (self.describe)(&mut self.prepared, surface, fields);
        match (self.density, force) {
            (Some(density), Some(_)) => density(&mut self.prepared, surface, fields),
            (None, Some(force)) => fields.set_density(force),
            (_, None) => {}
        }
    }

    fn energy(&mut self, surface: Surface<'_, T>) -> T {
        self.prepared.energy(surface)
    }

    fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        self.prepared.inspect(surface, report);
    }
}

/// An operator for curvatures only.
#[derive(Debug)]
struct WithoutForce<T, M, X>
where
    T: Real,
    M: Curvatures<T>,
{
    prepared: Prepared<T, M, X>,
    modulus: T,
}

impl<T, M, X> Act<T> for WithoutForce<T, M, X>
where
    T: Real,
    M: Curvatures<T> + fmt::Debug + Send,
    X: Execution + fmt::Debug + Send,
{
    fn add_force(&mut self, surface: Surface<'_, T>, _force: &mut [[T; 3]]) -> T {
        self.energy(surface)
    }

    fn has_fields_of_force(&self) -> bool {
        false
    }

    fn collect(
        &mut self,
        surface: Surface<'_, T>,
        _force: Option<&[[T; 3]]>,
        fields: &mut Fields<T>,
    ) {
        fields.set_curvature(self.prepared.curvatures(surface));
    }

    fn energy(&mut self, surface: Surface<'_, T>) -> T {
        let interior = |vertex: &&Curvature<T>| vertex.kind == VertexKind::Interior;
        let vertices = self.prepared.curvatures(surface).iter().filter(interior);
        let terms = vertices.map(|vertex| vertex.mean * vertex.mean * vertex.area);
        T::constant(2.0) * self.modulus * terms.sum::<T>()
    }

    fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        self.prepared.inspect(surface, report);
    }
}

#[derive(Debug)]
struct InStrongForm<T, L, X>(Prepared<T, StrongForm<T, L>, X>)
where
    T: Real,
    L: LaplaceBeltrami<T> + Sync;

impl<T, L, X> Act<T> for InStrongForm<T, L, X>
where
    T: Real,
    X: Execution + fmt::Debug + Send,
    L: LaplaceBeltrami<T> + fmt::Debug + Send + Sync,
{
    fn add_force(&mut self, surface: Surface<'_, T>, force: &mut [[T; 3]]) -> T {
        self.0.force_density(surface, force);
        self.0
            .with(|method, execution, workspace| method.energy_of(execution, workspace.memory()))
    }

    fn is_strong_form(&self) -> bool {
        true
    }

    fn collect(
        &mut self,
        surface: Surface<'_, T>,
        force: Option<&[[T; 3]]>,
        fields: &mut Fields<T>,
    ) {
        match force {
            Some(force) => fields.set_strong_form(surface.mesh(), self.0.memory(), force),
            None => fields.set_curvature(self.0.curvatures(surface)),
        }
    }

    fn energy(&mut self, surface: Surface<'_, T>) -> T {
        self.0.energy(surface)
    }

    fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        self.0.inspect(surface, report);
    }
}
