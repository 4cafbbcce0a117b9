//! Candidates as trait objects: a law that takes one is compiled once, and not for each method.

use super::Candidate;
use crate::meshes::Mesh;
use helfrich::{Energy, Execution, Finding, Force, Prepared, Real, Surface, TriangleMesh};

/// A method prepared for one mesh.
pub trait Evaluate<T: Real> {
    /// See [`Prepared::energy`].
    fn energy(&mut self, surface: Surface<'_, T>) -> T;
    /// See [`Prepared::add_force`].
    fn add_force(&mut self, surface: Surface<'_, T>, force: &mut [[T; 3]]);
    /// See [`Prepared::inspect`].
    fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding));
}

impl<T: Real, M: Energy<T> + Force<T>, X: Execution> Evaluate<T> for Prepared<T, M, X> {
    fn energy(&mut self, surface: Surface<'_, T>) -> T {
        Prepared::energy(self, surface)
    }

    fn add_force(&mut self, surface: Surface<'_, T>, force: &mut [[T; 3]]) {
        Prepared::add_force(self, surface, force);
    }

    fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        Prepared::inspect(self, surface, report);
    }
}

/// A [`Candidate`] in the scalar T.
pub trait Subject<T: Real> {
    /// See [`Candidate::name`].
    fn name(&self) -> &'static str;
    /// See [`Candidate::modules`].
    fn modules(&self) -> Vec<&'static str>;
    /// See [`Candidate::is_gradient`].
    fn is_gradient(&self) -> bool;
    /// See [`Candidate::chooses_by_threshold`].
    fn chooses_by_threshold(&self) -> bool;
    /// The method with this bending modulus, prepared for a mesh.
    fn prepared<'a>(&self, modulus: T, mesh: &TriangleMesh) -> Box<dyn Evaluate<T> + 'a>
    where
        Self: 'a;
}

impl<T: Real, C: Candidate> Subject<T> for C {
    fn name(&self) -> &'static str {
        Candidate::name(*self)
    }

    fn modules(&self) -> Vec<&'static str> {
        Candidate::modules(*self)
    }

    fn is_gradient(&self) -> bool {
        Candidate::is_gradient(*self)
    }

    fn chooses_by_threshold(&self) -> bool {
        Candidate::chooses_by_threshold(*self)
    }

    fn prepared<'a>(&self, modulus: T, mesh: &TriangleMesh) -> Box<dyn Evaluate<T> + 'a>
    where
        Self: 'a,
    {
        Box::new(Prepared::new(self.method(modulus), mesh))
    }
}

impl<T: Real> dyn Subject<T> + '_ {
    /// See [`super::energy`].
    ///
    /// # Panics
    /// If the positions do not fit the mesh.
    pub fn energy(&self, modulus: T, mesh: &TriangleMesh, positions: &[[T; 3]]) -> T {
        let surface = Surface::new(mesh, positions).expect("one finite position a vertex");
        self.prepared(modulus, mesh).energy(surface)
    }

    /// See [`super::forces`].
    ///
    /// # Panics
    /// If the positions do not fit the mesh.
    pub fn forces(&self, modulus: T, mesh: &TriangleMesh, positions: &[[T; 3]]) -> Vec<[T; 3]> {
        let surface = Surface::new(mesh, positions).expect("one finite position a vertex");
        let mut force = vec![[T::zero(); 3]; positions.len()];
        self.prepared(modulus, mesh).add_force(surface, &mut force);
        force
    }
}

impl dyn Subject<f64> + '_ {
    /// See [`super::findings`].
    pub fn findings(&self, mesh: &Mesh) -> Vec<Finding> {
        let mut prepared = self.prepared(1.0, &mesh.connectivity);
        prepared.add_force(mesh.surface(), &mut vec![[0.0; 3]; mesh.positions.len()]);
        let mut findings = Vec::new();
        prepared.inspect(mesh.surface(), &mut |finding| findings.push(finding));
        findings
    }
}
