//! The smooth surface through the vertices of a mesh: each triangle curved by the normals at its
//! corners.

use glam::DVec3;
use helfrich::{MaterialParameter, Surface};

/// Integrals over a component of a closed surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Integrals {
    /// `∫ κ H² dA`.
    pub(super) squared_mean: f64,
    /// `∫ κ (H − H0)² dA`.
    pub(super) squared_excess: f64,
    /// `∫ dA`.
    pub(super) area: f64,
    /// The enclosed volume.
    pub(super) volume: f64,
    /// `∫ H dA`.
    pub(super) mean: f64,
}

/// Barycentric coordinates and weights of a rule of degree 5 on a triangle, of area 1: D. A. Dunavant,
/// Int. J. Numer. Meth. Eng. 21 (1985) 1129.
const POINTS: [([f64; 3], f64); 7] = {
    const A: f64 = 0.470_142_064_105_115;
    const B: f64 = 0.101_286_507_323_456;
    const P: f64 = 0.132_394_152_788_506;
    const Q: f64 = 0.125_939_180_544_827;
    const C: f64 = 1.0 - 2.0 * A;
    const D: f64 = 1.0 - 2.0 * B;
    const THIRD: f64 = 1.0 / 3.0;
    [
        ([THIRD, THIRD, THIRD], 0.225),
        ([C, A, A], P),
        ([A, C, A], P),
        ([A, A, C], P),
        ([D, B, B], Q),
        ([B, D, B], Q),
        ([B, B, D], Q),
    ]
};

/// Normals and mean curvature at the vertices of a surface.
pub(super) struct Curved<'a> {
    surface: Surface<'a, f64>,
    normal: &'a [[f64; 3]],
    mean: &'a [f64],
    /// Bending modulus κ and spontaneous curvature H0.
    material: [MaterialParameter<f64>; 2],
    /// The gradient of H at each vertex.
    gradient: Vec<DVec3>,
}

impl<'a> Curved<'a> {
    /// The curved surface from unit normals and mean curvatures at the vertices.
    pub(super) fn new(
        surface: Surface<'a, f64>,
        normal: &'a [[f64; 3]],
        mean: &'a [f64],
        material: [MaterialParameter<f64>; 2],
    ) -> Self {
        let mut sums = vec![(DVec3::ZERO, 0.0); surface.mesh().vertex_count()];
        for triangle in surface.mesh().triangles() {
            let [a, b, c] = corners(surface, *triangle);
            let doubled = (b - a).cross(c - a);
            let length = doubled.length();
            if length > 0.0 {
                let [u, v, w] = triangle.map(|vertex| mean[vertex as usize]);
                // Twice the triangle's area times the gradient.
                let along = u * (c - b) + v * (a - c) + w * (b - a);
                let gradient = (doubled / length).cross(along);
                for &vertex in triangle {
                    let (sum, area) = &mut sums[vertex as usize];
                    *sum += gradient;
                    *area += length;
                }
            }
        }
        let mean_of = |(sum, area): (DVec3, f64)| if area > 0.0 { sum / area } else { DVec3::ZERO };
        Self {
            surface,
            normal,
            mean,
            material,
            gradient: sums.into_iter().map(mean_of).collect(),
        }
    }

    /// The integrals over each of `count` components; `groups` has the component of each vertex.
    pub(super) fn integrals(&self, groups: &[u32], count: usize) -> Vec<Integrals> {
        let mut integrals = vec![Integrals::default(); count];
        for triangle in self.surface.mesh().triangles() {
            self.add(
                *triangle,
                &mut integrals[groups[triangle[0] as usize] as usize],
            );
        }
        integrals
    }

    /// Adds the integrals over one triangle, on which position and H are quadratic functions.
    fn add(&self, triangle: [u32; 3], integrals: &mut Integrals) {
        // The volume is a sum of cones. Their apex lies near the surface, which avoids
        // cancellation.
        let origin = DVec3::from_array(self.surface.positions()[0]);
        let p = corners(self.surface, triangle).map(|p| p - origin);
        let h = triangle.map(|vertex| self.mean[vertex as usize]);
        let [moduli, spontaneous] = &self.material;
        let [moduli, spontaneous] =
            [moduli, spontaneous].map(|of| triangle.map(|vertex| of.at(vertex as usize)));
        let mut edge_p = [DVec3::ZERO; 3];
        let mut edge_h = [0.0; 3];
        for edge in 0..3 {
            let [i, j] = [(edge + 1) % 3, (edge + 2) % 3];
            let [v, w] = [triangle[i] as usize, triangle[j] as usize];
            let along = p[j] - p[i];
            let [m, n] = [v, w].map(|vertex| DVec3::from_array(self.normal[vertex]));
            // Control points of quadratic functions are twice as far from the triangle as the middle of
            // the edge, which is an eighth of the change of slope away.
            let height = (n - m).dot(along) / 4.0;
            edge_p[edge] = 0.5 * (p[i] + p[j]) + height * (m + n).normalize_or_zero();
            edge_h[edge] =
                0.5 * (h[i] + h[j]) + (self.gradient[v] - self.gradient[w]).dot(along) / 4.0;
        }
        for ([x, y, z], weight) in POINTS {
            let [q0, q1, q2] = edge_p;
            // Derivatives with respect to the barycentric coordinates.
            let [a, b, c] = [
                2.0 * (x * p[0] + y * q2 + z * q1),
                2.0 * (x * q2 + y * p[1] + z * q0),
                2.0 * (x * q1 + y * q0 + z * p[2]),
            ];
            let position = 0.5 * (x * a + y * b + z * c);
            let vector = 0.5 * weight * (b - a).cross(c - a);
            let area = vector.length();
            let mean = x * x * h[0]
                + y * y * h[1]
                + z * z * h[2]
                + 2.0 * (y * z * edge_h[0] + z * x * edge_h[1] + x * y * edge_h[2]);
            let here = |[a, b, c]: [f64; 3]| x * a + y * b + z * c;
            let (modulus, excess) = (here(moduli), mean - here(spontaneous));
            integrals.squared_mean += modulus * mean * mean * area;
            integrals.squared_excess += modulus * excess * excess * area;
            integrals.area += area;
            integrals.volume += position.dot(vector) / 3.0;
            integrals.mean += mean * area;
        }
    }
}

fn corners(surface: Surface<'_, f64>, triangle: [u32; 3]) -> [DVec3; 3] {
    triangle.map(|vertex| DVec3::from_array(surface.positions()[vertex as usize]))
}

#[cfg(test)]
mod tests {
    use super::Curved;
    use crate::generate::{AnyShape, Family, generate};
    use helfrich::shapes::Shape;
    use helfrich::{MaterialParameter, Surface};

    /// Relative errors of the integrals over an ellipsoid with exact normals and curvatures: area,
    /// volume and `∫H² dA`.
    fn off(vertices: usize) -> [f64; 3] {
        let shape: AnyShape = "ellipsoid:1,1,1.5".parse().expect("a shape");
        let generated = generate(&shape, Family::Smooth, vertices, 0).expect("a mesh");
        let exact = |place: &[f64; 3]| shape.at(shape.preimage(*place));
        let exact = Vec::from_iter(generated.positions.iter().map(exact));
        let normal = Vec::from_iter(exact.iter().map(|point| point.normal));
        let mean = Vec::from_iter(exact.iter().map(|point| point.mean));
        let surface = Surface::new(&generated.mesh, &generated.positions).expect("fits");
        let groups = vec![0; vertices];
        let material = [1.0, 0.0].map(MaterialParameter::Constant);
        let found = Curved::new(surface, &normal, &mean, material).integrals(&groups, 1)[0];
        let squared = squared_mean(1.0, 1.5);
        [
            found.area / shape.area() - 1.0,
            found.volume / shape.volume() - 1.0,
            found.squared_mean / squared - 1.0,
        ]
    }

    /// `∫H² dA` of the spheroid with semi-axes a, a, c by Simpson's rule.
    fn squared_mean(a: f64, c: f64) -> f64 {
        const INTERVALS: u32 = 4096;
        let terms = (0..=INTERVALS).map(|index| {
            let z = f64::from(index) / f64::from(INTERVALS);
            let weight = match index {
                0 | INTERVALS => 1.0,
                _ if index % 2 == 1 => 4.0,
                _ => 2.0,
            };
            // Heights are c z; g = √(a² z² + c² (1 − z²)).
            let g = (a * a * z * z + c * c * (1.0 - z * z)).sqrt();
            let (meridian, parallel) = (a * c / g.powi(3), c / (a * g));
            weight * (0.5 * (meridian + parallel)).powi(2) * g
        });
        4.0 * std::f64::consts::PI * a * terms.sum::<f64>() / (3.0 * f64::from(INTERVALS))
    }

    #[test]
    fn integrals_are_of_fourth_order() {
        let [coarse, fine] = [642, 2562].map(off);
        for (coarse, fine) in coarse.into_iter().zip(fine) {
            // Halving the edges divides the error by about 16; not by exactly 16, because triangles
            // have different shapes.
            assert!(fine.abs() < coarse.abs() / 11.0, "{coarse:e} {fine:e}");
            assert!(coarse.abs() < 2e-3, "{coarse:e}");
        }
    }
}
