//! Deviation of a mesh from the shape on which it was generated.

use super::AnyShape;
use crate::info::MeshInfo;
use std::f64::consts::PI;

/// Smallest limit of the deviation, 1 %.
const LEAST: f64 = 0.01;

/// Factor of the limit, in units of the volume that an even mesh of the sphere lacks.
const FACTOR: f64 = 4.0;

/// Relative deviation of area and volume of a mesh from those of the exact shape; negative if the
/// mesh has less, as inscribed meshes have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeDeviation {
    /// A/A₀ − 1.
    pub area: f64,
    /// V/V₀ − 1; NaN if the mesh is open.
    pub volume: f64,
    /// Number of vertices.
    pub vertices: usize,
}

impl ShapeDeviation {
    /// The deviation of a mesh from the shape enlarged by the factor `scale`.
    pub fn new(shape: &AnyShape, scale: f64, mesh: &MeshInfo) -> Self {
        Self {
            area: mesh.area / (shape.area() * scale * scale) - 1.0,
            volume: mesh.volume.unwrap_or(f64::NAN) / (shape.volume() * scale * scale * scale)
                - 1.0,
            vertices: mesh.vertices,
        }
    }

    /// The deviation with the larger absolute value, and its name, "area" or "volume".
    pub fn largest(&self) -> (f64, &'static str) {
        if self.area.abs() > self.volume.abs() {
            (self.area, "area")
        } else {
            (self.volume, "volume")
        }
    }

    /// The deviation that a mesh of this many vertices may have: four times the volume that an even
    /// mesh of the sphere lacks, relative, and 1 % in any case.
    ///
    /// The unit sphere rises over equilateral triangles of edge h by h²/8 on average, with h² = 8π/(√3 N):
    /// ΔV/V = 3h²/8 = √3 π/N.
    pub fn limit(&self) -> f64 {
        let sphere = 3f64.sqrt() * PI / self.vertices as f64;
        (FACTOR * sphere).max(LEAST)
    }

    /// Whether the larger deviation exceeds the limit.
    pub fn is_beyond_limit(&self) -> bool {
        self.largest().0.abs() > self.limit()
    }
}
