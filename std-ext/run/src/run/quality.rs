//! Quality of the surfaces of a run: vertices whose energy cannot be trusted.

use super::Run;
use crate::effect::Effect;
use crate::findings::first_of_each_kind;
use crate::scene::{Bending, Named};
use crate::simulation::{Acting, Body, Simulation};
use crate::six::Six;
use helfrich::{Cotangent, DualArea, Finding, Prepared, Quality, Surface};
use serde::Serialize;

/// The fraction of ∫H² dA on flagged vertices above which an energy is not trusted. The shipped scenes
/// have 0, a false minimum has 0.38, and energies are required to agree with theory to 1 %.
const LIMIT: f64 = 0.02;

/// The columns of a surface with bending.
pub(super) const COLUMNS: [&str; 3] = ["flagged_vertices", "flagged_triangles", "flagged_share"];

/// Vertices and triangles of a surface that its bending method flags.
#[derive(Clone, Debug, Serialize)]
pub struct Flagged {
    /// The surface's name.
    pub surface: String,
    /// Number of vertices that have a finding, or a triangle or neighbour with one.
    pub vertices: usize,
    /// Number of triangles that are thin or have no area.
    pub triangles: usize,
    /// The part of ∫H² dA, by the cotangent operator, on flagged vertices, from 0 to 1.
    pub share: f64,
    /// The number of findings of each kind, with its description.
    pub findings: Vec<(usize, String)>,
}

/// The findings of the last evaluation, which must have been at these positions: one entry per
/// surface, `None` without bending.
pub(super) fn flagged(simulation: &Simulation, positions: &[[f64; 3]]) -> Vec<Option<Flagged>> {
    let of = |body: &Body| Flagged::new(body, body.surface(positions)?);
    simulation.bodies().iter().map(of).collect()
}

/// The message about a surface of which the bending energy is below 0 although no surface has such an energy: a
/// discrete energy whose edges have a part of it is not bounded from below where the mesh does not resolve the
/// surface, and a relaxation would follow it without end.
pub(super) fn impossible(
    simulation: &Simulation,
    acting: &[Acting],
    flagged: &[Option<Flagged>],
) -> Option<String> {
    let bodies = simulation.bodies().iter().zip(flagged);
    let effects = bodies.flat_map(|(body, flagged)| {
        let effects = body.effects().iter();
        effects.map(move |effect| (effect.name(), flagged))
    });
    let below = effects
        .zip(acting)
        .filter(|((name, _), acting)| *name == Bending::NAME && acting.energy < 0.0);
    let mut below = below.filter_map(|((_, flagged), acting)| Some((flagged.as_ref()?, acting)));
    let (flagged, acting) = below.find(|(flagged, _)| flagged.rules())?;
    Some(format!(
        "the bending energy of \"{}\" is {}, and no surface has one below 0: the mesh does not resolve the \
         surface; choose a finer mesh, or a shape nearer to the equilibrium",
        flagged.surface,
        Six(acting.energy)
    ))
}

/// Whether a surface has the columns.
pub(super) fn has_bending(body: &Body) -> bool {
    body.effects()
        .iter()
        .any(|effect| effect.name() == Bending::NAME)
}

impl Flagged {
    fn new(body: &Body, surface: Surface<'_, f64>) -> Option<Self> {
        let bending = |effect: &&Effect| effect.name() == Bending::NAME;
        let bending = body.effects().iter().find(bending)?;
        let quality = Quality::gather(body.mesh(), |report| {
            body.inspect(bending, surface, report);
        });
        let flagged = quality.flagged();
        let on_triangle = |finding: &&Finding| {
            matches!(
                finding,
                Finding::ThinTriangle { .. } | Finding::DegenerateTriangle { .. }
            )
        };
        Some(Self {
            surface: body.name().to_owned(),
            vertices: flagged.iter().filter(|&&flagged| flagged).count(),
            triangles: quality.findings().iter().filter(on_triangle).count(),
            share: share(surface, flagged),
            findings: first_of_each_kind(quality.findings()),
        })
    }

    pub(super) fn numbers(&self) -> [f64; 3] {
        [self.vertices as f64, self.triangles as f64, self.share]
    }

    /// Whether too much of the bending energy lies on flagged vertices.
    pub(super) fn rules(&self) -> bool {
        self.share > LIMIT
    }

    /// The message about flagged vertices.
    pub(super) fn message(&self) -> String {
        let kinds = self
            .findings
            .iter()
            .map(|(count, words)| format!("{count} times {words}"));
        format!(
            "{:.1} % of the bending energy of \"{}\" lies on {} vertices that its method cannot \
             handle; the limit is {} %: {}",
            100.0 * self.share,
            self.surface,
            self.vertices,
            100.0 * LIMIT,
            Vec::from_iter(kinds).join("; ")
        )
    }
}

impl Run<'_> {
    /// Warns once about each surface whose energy lies on flagged vertices.
    pub(super) fn doubt<'f>(&mut self, flagged: impl Iterator<Item = &'f Flagged>) {
        let doubts = &mut self.outputs.doubts;
        for flagged in flagged.filter(|flagged| flagged.rules()) {
            if !doubts
                .iter()
                .any(|(surface, _)| *surface == flagged.surface)
            {
                let note = format!("from {}: {}", self.drive.caption(), flagged.message());
                doubts.push((flagged.surface.clone(), note));
            }
        }
    }
}

/// The part of ∫H² dA on flagged vertices; 0 where there is no curvature.
fn share(surface: Surface<'_, f64>, flagged: &[bool]) -> f64 {
    if !flagged.contains(&true) {
        return 0.0;
    }
    let mesh = surface.mesh();
    let mut cotangent = Prepared::new(Cotangent::new(DualArea::Mixed), mesh);
    let curvature = cotangent.curvatures(surface);
    let mut sums = [0.0; 2];
    for (vertex, &flagged) in curvature.iter().zip(flagged) {
        let energy = vertex.mean * vertex.mean * vertex.area;
        sums[0] += energy;
        sums[1] += if flagged { energy } else { 0.0 };
    }
    let [all, part] = sums;
    if all > 0.0 { part / all } else { 0.0 }
}
