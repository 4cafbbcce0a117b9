//! Deformation and orientation of bodies in flow.
//!
//! The shape is described by the ellipsoid with the same volume and second moments: S. Ramanujan
//! and C. Pozrikidis, J. Fluid Mech. 361 (1998) 117. All values are exact for the polyhedron that
//! the triangles enclose.

mod plateau;
mod tank_treading;

pub use plateau::{Plateau, first_plateau};
pub use tank_treading::TankTreading;

use crate::flow::Ambient;
use glam::{DMat3, DVec3};
use helfrich::{Cotangent, DualArea, GompperKroll, Prepared, Surface};
use helfrich_mesh::section::section;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// The plane of a shear flow, spanned by the directions of the flow and of its gradient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShearPlane {
    flow: [f64; 3],
    gradient: [f64; 3],
}

impl ShearPlane {
    /// The plane of two directions of any length, `gradient` made perpendicular to `flow`; none if
    /// they are parallel, 0 or not finite.
    pub fn new(flow: [f64; 3], gradient: [f64; 3]) -> Option<Self> {
        let flow = DVec3::from(flow).try_normalize()?;
        let gradient = DVec3::from(gradient).try_normalize()?;
        let across = gradient - gradient.dot(flow) * flow;
        // Rounding errors of parallel directions have no meaningful direction.
        if across.length() < 1e-12 {
            return None;
        }
        Some(Self {
            flow: flow.to_array(),
            gradient: across.normalize().to_array(),
        })
    }

    /// The plane of shear of a flow at a point, where ∇u = γ̇ f gᵀ with f ⟂ g. None where the flow is not
    /// a simple shear, for example an extension, or where it is uniform, as on the axis of a Poiseuille
    /// profile.
    pub fn at(ambient: &Ambient, point: [f64; 3]) -> Option<Self> {
        let rows = match *ambient {
            Ambient::Linear { gradient } => gradient.map(DVec3::from),
            Ambient::Poiseuille {
                centre_velocity,
                radius,
                direction,
                through,
            } => {
                let direction = DVec3::from(direction).try_normalize()?;
                let away = (DVec3::from(point) - DVec3::from(through)) / radius;
                let across = away - away.dot(direction) * direction;
                if across.length() < 1e-12 * (1.0 + away.length()) {
                    return None;
                }
                let row = -2.0 * centre_velocity / radius * across;
                direction.to_array().map(|component| component * row)
            }
        };
        let longest = |a: &DVec3, b: &DVec3| a.length().total_cmp(&b.length());
        let gradient = rows.into_iter().max_by(longest)?.try_normalize()?;
        let flow = rows.map(|row| row.dot(gradient));
        let rest = rows.iter().zip(flow);
        let rest = rest.map(|(&row, along)| (row - along * gradient).length_squared());
        let rate = DVec3::from(flow).length();
        let slip = gradient.dot(DVec3::from(flow)).abs();
        let is_shear = rest.sum::<f64>().sqrt() <= 1e-9 * rate && slip <= 1e-9 * rate;
        is_shear
            .then(|| Self::new(flow, gradient.to_array()))
            .flatten()
    }

    /// The unit vector of the flow.
    pub fn flow(&self) -> [f64; 3] {
        self.flow
    }

    /// The unit vector of the gradient, perpendicular to the flow.
    pub fn gradient(&self) -> [f64; 3] {
        self.gradient
    }

    /// flow × gradient, the unit vector antiparallel to the vorticity.
    pub fn normal(&self) -> [f64; 3] {
        DVec3::from(self.flow)
            .cross(self.gradient.into())
            .to_array()
    }

    /// Coordinates along flow and gradient.
    fn coordinates(&self, offset: DVec3) -> [f64; 2] {
        [self.flow, self.gradient].map(|axis| offset.dot(axis.into()))
    }
}

/// Taylor's deformation parameter D = (L − B)/(L + B) of a long and a short axis or semi-axis; 0 for a
/// circle.
pub fn taylor([longest, shortest]: [f64; 2]) -> f64 {
    (longest - shortest) / (longest + shortest)
}

/// The ellipsoid with the volume and the second moments of the body that a surface encloses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deformation {
    /// V, negative if the mesh is inside out.
    pub volume: f64,
    /// Centre of the volume, c.
    pub centroid: [f64; 3],
    /// `∫ (x − c)(x − c)ᵀ dV / V`, a square of a length.
    pub second_moments: [[f64; 3]; 3],
    /// √5 times the roots of the principal second moments, longest first: the semi-axes of the
    /// ellipsoid.
    pub semi_axes: [f64; 3],
    /// Unit vectors along the semi-axes, right-handed; their signs are arbitrary.
    pub directions: [[f64; 3]; 3],
}

impl Deformation {
    /// The moments of a surface; none if it has a boundary or encloses no volume.
    pub fn new(surface: Surface<'_, f64>) -> Option<Self> {
        if !surface.mesh().is_closed() {
            return None;
        }
        let positions = surface.positions();
        let corner = |vertex: u32| DVec3::from(positions[vertex as usize]);
        // Differences from a nearby point keep the digits of bodies far from the origin. Of the tetrahedra with this corner
        // and triangles: the volume V, ∫ x dV = V/4 s with the sum s of the corners, and ∫ x xᵀ dV = V/20 (s sᵀ plus the sum of
        // the corners' own squares).
        let first = corner(surface.mesh().triangles()[0][0]);
        let next = |x: DVec3| DVec3::new(x.y, x.z, x.x);
        let (mut volume, mut centre) = (0.0, DVec3::ZERO);
        // xx, yy and zz; xy, yz and zx.
        let [mut squares, mut products] = [DVec3::ZERO; 2];
        for triangle in surface.mesh().triangles() {
            let [a, b, c] = triangle.map(|vertex| corner(vertex) - first);
            let part = a.dot(b.cross(c)) / 6.0;
            let sum = a + b + c;
            volume += part;
            centre += part * sum;
            squares += part * (sum * sum + a * a + b * b + c * c);
            products += part * (sum * next(sum) + a * next(a) + b * next(b) + c * next(c));
        }
        if volume == 0.0 || !volume.is_finite() {
            return None;
        }
        let centre = centre / (4.0 * volume);
        let centroid = first + centre;
        let [xx, yy, zz] = (squares / (20.0 * volume) - centre * centre).to_array();
        let [xy, yz, zx] = (products / (20.0 * volume) - centre * next(centre)).to_array();
        let second_moments = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
        let (values, directions) = principal(second_moments);
        Some(Self {
            volume,
            centroid: centroid.to_array(),
            second_moments,
            semi_axes: values.map(|value| (5.0 * value).sqrt()),
            directions,
        })
    }

    /// D of the longest and the shortest semi-axis, in any direction: [`taylor`].
    pub fn taylor(&self) -> f64 {
        taylor([self.semi_axes[0], self.semi_axes[2]])
    }

    /// The ellipse with the second moments in a plane. If the body is symmetric to the plane, as a
    /// capsule in simple shear is, its semi-axes are two of [`Self::semi_axes`]; they are the longest
    /// and the shortest one if the semi-axis across the plane lies between them.
    pub fn in_plane(&self, plane: ShearPlane) -> MomentEllipse {
        let moments = DMat3::from_cols_array_2d(&self.second_moments);
        let [flow, gradient] = [plane.flow, plane.gradient].map(DVec3::from);
        let [along, across] = [flow, gradient].map(|axis| axis.dot(moments * axis));
        let mixed = flow.dot(moments * gradient);
        let (middle, half) = (0.5 * (along + across), 0.5 * (along - across));
        let reach = half.hypot(mixed);
        let inclination = 0.5 * mixed.atan2(half).to_degrees();
        MomentEllipse {
            semi_axes: [middle + reach, middle - reach].map(|value| (5.0 * value).sqrt()),
            // The arctangent distinguishes −0 from 0.
            inclination: if inclination <= -90.0 {
                90.0
            } else {
                inclination
            },
        }
    }
}

/// A body in the plane of a flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MomentEllipse {
    /// The longer and the shorter semi-axis.
    pub semi_axes: [f64; 2],
    /// The angle between the longer semi-axis and the flow, in degrees, positive towards the
    /// gradient: above −90 and at most 90. Soft capsules start at 45 and align towards 0.
    pub inclination: f64,
}

impl MomentEllipse {
    /// D of the two semi-axes: [`taylor`].
    pub fn taylor(&self) -> f64 {
        taylor(self.semi_axes)
    }
}

/// The largest and the smallest distance from a point to the section of the surface by the plane
/// through the point. For the centroid these are the semi-axes that are measured in pictures of
/// capsules. None if the plane does not intersect the surface.
///
/// Between vertices the curve is straight, so that the distances depend on the orientation of the
/// mesh: by about 1 % on 1280 triangles. Use [`Deformation`] for comparisons.
pub fn extremes(surface: Surface<'_, f64>, point: [f64; 3], plane: ShearPlane) -> Option<[f64; 2]> {
    let centre = DVec3::from(point);
    let segments = section(surface, point, plane.normal());
    let ends = segments.iter().flatten();
    let longest = ends.map(|&end| centre.distance(end.into()));
    let shortest = segments.iter().map(|&[a, b]| {
        let [a, b] = [a, b].map(|end| DVec3::from(end) - centre);
        let along = b - a;
        let squared = along.length_squared();
        let share = if squared > 0.0 {
            (-a.dot(along) / squared).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (a + share * along).length()
    });
    let largest = longest.reduce(f64::max)?;
    Some([largest, shortest.reduce(f64::min)?])
}

/// A measure of wrinkles: `∫ H² dS / 4π`, by the energy of Gompper and Kroll with mixed areas. It is 1
/// for a sphere and slightly more for smooth capsules; where a capsule wrinkles at the scale of the mesh
/// it grows with refinement.
pub fn wrinkle_indicator(surface: Surface<'_, f64>) -> f64 {
    let method = GompperKroll::new(1.0);
    Prepared::new(method, surface.mesh()).energy(surface) / (8.0 * PI)
}

/// The variation of curvature from vertex to vertex: the root mean square of the difference of
/// H from its mean over the neighbours, over that of H itself.
///
/// Below 0.1 on smooth capsules with fine and even meshes; near 1 where the surface is folded at the
/// scale of its edges, or its mesh is too coarse or too uneven for its shape.
pub fn roughness(surface: Surface<'_, f64>) -> f64 {
    let mesh = surface.mesh();
    let mut cotangent = Prepared::new(Cotangent::new(DualArea::Mixed), mesh);
    let curvature = cotangent.curvatures(surface);
    let [mut changes, mut squares] = [0.0; 2];
    for (vertex, own) in curvature.iter().enumerate() {
        let ring = mesh.one_ring(vertex);
        let around = ring.iter().map(|&other| curvature[other as usize].mean);
        let change = own.mean - around.sum::<f64>() / ring.len().max(1) as f64;
        changes += change * change;
        squares += own.mean * own.mean;
    }
    if squares > 0.0 {
        (changes / squares).sqrt()
    } else {
        0.0
    }
}

/// Eigenvalues of a symmetric matrix, largest first, and unit eigenvectors, right-handed.
///
/// Jacobi's rotations: G. H. Golub and C. F. Van Loan, Matrix Computations, section 8.5. They need no
/// gap between eigenvalues, and a sphere has none.
fn principal(mut matrix: [[f64; 3]; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    // Convergence is quadratic: five are enough for f64.
    const SWEEPS: usize = 10;
    let mut vectors = DMat3::IDENTITY.to_cols_array_2d();
    for _ in 0..SWEEPS {
        for [p, q] in [[0, 1], [0, 2], [1, 2]] {
            if matrix[p][q] == 0.0 {
                continue;
            }
            let cotangent = 0.5 * (matrix[q][q] - matrix[p][p]) / matrix[p][q];
            let tangent = cotangent.signum() / (cotangent.abs() + cotangent.hypot(1.0));
            let cosine = tangent.hypot(1.0).recip();
            let sine = tangent * cosine;
            for row in &mut matrix {
                let [x, y] = [row[p], row[q]];
                (row[p], row[q]) = (cosine * x - sine * y, sine * x + cosine * y);
            }
            for rows in [&mut matrix, &mut vectors] {
                let [x, y] = [rows[p], rows[q]].map(DVec3::from);
                rows[p] = (cosine * x - sine * y).to_array();
                rows[q] = (sine * x + cosine * y).to_array();
            }
            (matrix[p][q], matrix[q][p]) = (0.0, 0.0);
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&a: &usize, &b: &usize| matrix[b][b].total_cmp(&matrix[a][a]));
    let [first, second] = [order[0], order[1]].map(|at| DVec3::from(vectors[at]).normalize());
    let third = first.cross(second);
    (
        order.map(|at| matrix[at][at]),
        [first, second, third].map(|vector| vector.to_array()),
    )
}
