//! Check that some effect acts at the start of a run.

use super::RunError;
use crate::method::Evaluator;
use crate::scene::{Driver, Scene};
use crate::simulation::{Body, Simulation};
use helfrich::{Finding, Surface, VertexKind};

/// Checks that some force acts on the surfaces, and that bending is measured at some vertex; otherwise
/// the result of a run would not be an equilibrium.
pub(super) fn refuse_idle(
    scene: &Scene,
    simulation: &mut Simulation,
    positions: &[[f64; 3]],
) -> Result<(), RunError> {
    let acting = simulation.resolve(positions);
    let is_idle = |force: &[[f64; 3]]| force.as_flattened().iter().all(|&entry| entry == 0.0);
    for (body, surface) in simulation.bodies().iter().zip(&scene.surfaces) {
        let Some(bending) = &surface.effects.bending else {
            continue;
        };
        let label = simulation.label("bending", body);
        let own = acting.iter().find(|acting| acting.effect == label);
        let idle = own.is_some_and(|acting| is_idle(acting.on(body)));
        if idle && let Some(at) = body.surface(positions) {
            let mut evaluator =
                Evaluator::new(bending.method, bending.modulus.largest(), body.mesh());
            evaluator.evaluate(at);
            let vertices = interior(at);
            if left_out(&evaluator.findings(at), at) == vertices {
                return Err(RunError::NotMeasured {
                    surface: body.name().to_owned(),
                    method: bending.method.name(),
                    vertices,
                });
            }
        }
    }
    let relaxes = matches!(scene.driver, Driver::Relax(_)) && simulation.load_count() == 1;
    // Positions that are not finite are left to the driver, which reports them.
    if relaxes && !acting.is_empty() && acting.iter().all(|acting| is_idle(&acting.force)) {
        let names = simulation.bodies().iter().map(Body::name);
        return Err(RunError::NothingActs {
            surfaces: Vec::from_iter(names.map(|name| format!("\"{name}\""))).join(", "),
        });
    }
    Ok(())
}

/// Number of interior vertices, where bending can be measured.
fn interior(surface: Surface<'_, f64>) -> usize {
    let mesh = surface.mesh();
    let interior = |vertex: &usize| mesh.vertex_kind(*vertex) == VertexKind::Interior;
    (0..mesh.vertex_count()).filter(interior).count()
}

/// Number of these vertices that a method has left out.
fn left_out(findings: &[Finding], surface: Surface<'_, f64>) -> usize {
    let mut left_out = vec![false; surface.mesh().vertex_count()];
    for finding in findings {
        if let Finding::ZeroArea { vertex } | Finding::TooFewNeighbours { vertex } = *finding {
            left_out[vertex as usize] =
                surface.mesh().vertex_kind(vertex as usize) == VertexKind::Interior;
        }
    }
    left_out.into_iter().filter(|&left_out| left_out).count()
}
