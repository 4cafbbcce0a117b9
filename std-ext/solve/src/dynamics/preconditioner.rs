//! A preconditioner that turns forces into displacements that are smooth over many edges.

use super::Membrane;
use super::cholesky::{Factor, Pattern};
use super::cotangents::{self, Cotangents};
use helfrich::TriangleMesh;

/// The approximate inverse of a membrane's stiffness: bending resists with `κ Δ²`, in-plane
/// elasticity and tension with `−K Δ`.
///
/// With cotangent stiffness S, lumped areas M and a shift σ = 1/R², R the radius of the sphere of the
/// same area, `P = (κ L + K M)⁻¹ M L⁻¹`, `L = S + σ M`: symmetric and positive definite, the inverse
/// of `κ L M⁻¹ L + K L`. The shift stands for the stiffness of the longest waves and keeps
/// translations finite. Fixed vertices are not coupled to the others, whose displacements therefore fall
/// to 0 towards them.
#[derive(Clone, Debug)]
pub(super) struct Preconditioner {
    pattern: Pattern,
    /// L, and `κ L + K M` where K is not 0.
    factors: Option<(Factor, Option<Factor>)>,
    areas: Vec<f64>,
    modulus: f64,
}

impl Preconditioner {
    pub(super) fn new(mesh: &TriangleMesh) -> Self {
        Self {
            pattern: Pattern::new(mesh),
            factors: None,
            areas: Vec::new(),
            modulus: 1.0,
        }
    }

    /// Updates the geometry of the membrane.
    pub(super) fn set(&mut self, membrane: &Membrane, positions: &[[f64; 3]]) {
        let mesh = &*membrane.mesh;
        let Cotangents {
            edges: mut stiffness,
            areas,
            total,
        } = Cotangents::new(mesh, positions);
        let shift = 4.0 * std::f64::consts::PI / total;
        let mut diagonal = cotangents::diagonal(mesh, &areas, &stiffness, [shift, 1.0]);
        if membrane.has_support() {
            for (edge, value) in mesh.edges().iter().zip(&mut stiffness) {
                if edge.iter().any(|&end| membrane.is_fixed(end as usize)) {
                    *value = 0.0;
                }
            }
        }
        let (bending, in_plane) = (membrane.bending_modulus, membrane.in_plane_modulus);
        let pattern = &self.pattern;
        let smooth = Factor::new(pattern, &diagonal, &stiffness);
        self.factors = smooth.and_then(|smooth| {
            if in_plane == 0.0 {
                return Some((smooth, None));
            }
            for (entry, area) in diagonal.iter_mut().zip(&areas) {
                *entry = bending * *entry + in_plane * area;
            }
            for entry in &mut stiffness {
                *entry *= bending;
            }
            Factor::new(pattern, &diagonal, &stiffness).map(|stiff| (smooth, Some(stiff)))
        });
        self.modulus = if bending > 0.0 { bending } else { in_plane };
        self.areas = areas;
    }

    /// Replaces nodal forces, `width` numbers per vertex, by displacements. Without a factorisation
    /// every vertex is treated separately.
    pub(super) fn apply(&mut self, width: usize, vector: &mut [f64]) {
        let over = self.modulus.recip();
        match &mut self.factors {
            None => {
                // A displacement that the shortest waves allow.
                for (entries, area) in vector.chunks_exact_mut(width).zip(&self.areas) {
                    entries.iter_mut().for_each(|entry| *entry *= over * area);
                }
            }
            Some((smooth, stiff)) => {
                smooth.solve(&self.pattern, vector, width);
                let over = if stiff.is_some() { 1.0 } else { over };
                for (entries, area) in vector.chunks_exact_mut(width).zip(&self.areas) {
                    entries.iter_mut().for_each(|entry| *entry *= over * area);
                }
                let second = stiff.as_mut().unwrap_or(smooth);
                second.solve(&self.pattern, vector, width);
            }
        }
    }
}
