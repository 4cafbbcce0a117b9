//! Laws that also hold on degenerate surfaces.

use super::{Candidate, CurvatureLaw, Law, Measured, OperatorLaw, Subject};
use crate::meshes::Mesh;
use helfrich::{Curvature, Curvatures, LaplaceBeltrami, VertexKind};

/// Energies, forces and findings of a method are finite on any surface, degenerate ones included, and no
/// force acts on isolated vertices.
#[derive(Clone, Copy, Debug)]
pub struct Finite<'a>(pub &'a Mesh);

impl Law for Finite<'_> {
    fn check<C: Candidate>(&mut self, candidate: C) {
        self.check_method(&candidate);
    }
}

impl Finite<'_> {
    fn check_method(&self, candidate: &dyn Subject<f64>) {
        let Mesh {
            connectivity: mesh,
            positions,
        } = self.0;
        let name = candidate.name();
        let energy = candidate.energy(1.0, mesh, positions);
        assert!(energy.is_finite(), "{name}: energy {energy}");
        let forces = candidate.forces(1.0, mesh, positions);
        for (vertex, force) in forces.into_iter().enumerate() {
            let finite = force.iter().all(|f| f.is_finite());
            assert!(finite, "{name}: force {force:?} at vertex {vertex}");
            if mesh.vertex_kind(vertex) == VertexKind::Isolated {
                assert_eq!(force, [0.0; 3], "{name}: isolated vertex {vertex}");
            }
        }
    }
}

impl CurvatureLaw for Finite<'_> {
    fn check<L: Curvatures<f64> + Copy>(&mut self, name: &str, operator: L) {
        self.check_curvatures(name, &Measured::new(operator, self.0).curvature);
    }
}

impl Finite<'_> {
    fn check_curvatures(&self, name: &str, curvature: &[Curvature<f64>]) {
        for (vertex, curvature) in curvature.iter().enumerate() {
            let kind = self.0.connectivity.vertex_kind(vertex);
            let Curvature {
                normal,
                mean,
                gaussian,
                area,
                ..
            } = *curvature;
            let values = [normal[0], normal[1], normal[2], mean, gaussian, area];
            let finite = values.iter().all(|value| value.is_finite());
            assert!(finite, "{name}: {curvature:?} at vertex {vertex}");
            assert_eq!(curvature.kind, kind, "{name}: kind of vertex {vertex}");
            if kind == VertexKind::Isolated {
                assert_eq!((normal, area), ([0.0; 3], 0.0), "{name}: vertex {vertex}");
            }
        }
    }
}

impl OperatorLaw for Finite<'_> {
    fn check<L: LaplaceBeltrami<f64> + Copy>(&mut self, name: &str, operator: L) {
        CurvatureLaw::check(self, name, operator);
        let measured = Measured::new(operator, self.0);
        let laplacian = measured.apply(&self.0.positions);
        let finite = laplacian.iter().flatten().all(|value| value.is_finite());
        assert!(finite, "{name}: Δ_S x");
    }
}
