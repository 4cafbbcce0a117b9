//! The part that energies of methods leave out at the boundary of an open surface.

use super::BendingMethod;
use helfrich::Surface;

impl BendingMethod {
    /// Whether the energy covers an open surface up to its boundary; see [`helfrich::bending`].
    pub const fn reaches_boundary(self) -> bool {
        matches!(self, Self::J4 | Self::J6 | Self::J8 | Self::Jet)
    }

    /// The share of the area that the energy leaves out at the boundary: 0 for closed surfaces, and for methods
    /// that reach it.
    pub fn share_left_out(self, surface: Surface<'_, f64>) -> f64 {
        let mesh = surface.mesh();
        if mesh.is_closed() || self.reaches_boundary() {
            return 0.0;
        }
        let outer = |&vertex: &u32| !mesh.is_interior(vertex as usize);
        let (mut left_out, mut total) = (0.0, 0.0);
        for (triangle, corners) in mesh.triangles().iter().enumerate() {
            let area = surface.triangle_area(triangle);
            let outer = corners.iter().filter(|corner| outer(corner)).count();
            left_out += area
                * match self {
                    // Only triangles with interior corners count.
                    Self::Loop | Self::Galerkin => f64::from(outer > 0),
                    _ => outer as f64 / 3.0,
                };
            total += area;
        }
        if total > 0.0 { left_out / total } else { 0.0 }
    }

    /// The same in words; `None` where nothing is left out.
    pub fn what_is_left_out(self, surface: Surface<'_, f64>) -> Option<String> {
        let share = 100.0 * self.share_left_out(surface);
        (share > 0.0).then(|| {
            format!(
                "the energy of {self} leaves out about half a row of triangles at the border, {share:.2} % of the \
                 area: j4, j6 and j8 measure up to the border"
            )
        })
    }
}
