//! A mesh with positions.

use crate::diagnostic::Finding;
use crate::mesh::TriangleMesh;
use crate::points::Points;
use crate::real::Real;
use crate::reduction;
use crate::triangle::Triangle;
use crate::vec3::{self, Vec3, add, dot, normalise, sub};
use alloc::vec;
use alloc::vec::Vec;

/// A [`TriangleMesh`] with a position for each of its vertices: a view that is copied freely.
///
/// Formulas read only differences of positions, so that results do not depend on the place of the
/// surface. Differences cannot recover digits that were lost when positions were stored; in `f32`
/// this limits the accuracy of fourth derivatives. [`Surface::with_remainders`] takes positions as
/// pairs, with twice the digits.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a, T> {
    mesh: &'a TriangleMesh,
    positions: &'a [[T; 3]],
    remainders: Option<&'a [[T; 3]]>,
}

/// The reason why points do not fit a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// Each vertex needs one position.
    #[error("{positions} positions were given for a mesh of {vertices} vertices")]
    CountMismatch {
        /// Number of positions.
        positions: usize,
        /// Number of vertices of the mesh.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error(
        "coordinate {} of vertex {vertex} is not a finite number",
        ["x", "y", "z"][*axis]
    )]
    NotFinite {
        /// The vertex.
        vertex: usize,
        /// 0, 1 or 2.
        axis: usize,
    },
    /// The surface is so large that squares of its areas overflow.
    #[error(
        "vertex {vertex} is farther than 2^{exponent} from vertex 0, the most that this number type \
         computes with: choose a larger unit of length"
    )]
    TooLarge {
        /// The vertex.
        vertex: usize,
        /// The largest allowed distance along an axis is two to this power.
        exponent: i32,
    },
}

/// The largest distance along an axis with which formulas cannot overflow; their highest power is
/// the square of a sum of areas.
fn most_extent<T: Real>() -> T {
    T::max_value().sqrt().sqrt() * T::constant(1.0 / 16.0)
}

/// Points that fit a mesh and are finite.
fn checked<'a, T: Real, P>(mesh: &TriangleMesh, points: &'a P) -> Result<&'a [[T; 3]], SurfaceError>
where
    P: Points<Scalar = T> + ?Sized,
{
    let positions = points.coordinates();
    if positions.len() != mesh.vertex_count() {
        return Err(SurfaceError::CountMismatch {
            positions: positions.len(),
            vertices: mesh.vertex_count(),
        });
    }
    let most = most_extent::<T>();
    let first = positions.first().copied().unwrap_or_default();
    for (vertex, position) in positions.iter().enumerate() {
        if let Some(axis) = position.iter().position(|x| !x.is_finite()) {
            return Err(SurfaceError::NotFinite { vertex, axis });
        }
        if vec3::sub(*position, first).iter().any(|x| x.abs() > most) {
            let exponent = most.log2().to_i32().unwrap_or(i32::MAX);
            return Err(SurfaceError::TooLarge { vertex, exponent });
        }
    }
    Ok(positions)
}

/// A surface relative to one of its vertices.
pub(crate) struct Seen<'a, T> {
    from: [T; 3],
    positions: &'a [[T; 3]],
    /// The position of the vertex, and all positions.
    remainders: Option<([T; 3], &'a [[T; 3]])>,
}

impl<T: Real> Seen<'_, T> {
    /// x_to − x_from.
    #[inline(always)]
    pub(crate) fn difference(&self, to: u32) -> [T; 3] {
        let to = to as usize;
        let difference = vec3::sub(self.positions[to], self.from);
        match self.remainders {
            None => difference,
            Some((from, remainders)) => vec3::add(difference, vec3::sub(remainders[to], from)),
        }
    }
}

impl<'a, T: Real> Surface<'a, T> {
    /// The surface with `points` at the vertices of `mesh`.
    ///
    /// # Errors
    /// If the numbers of points and vertices differ, a coordinate is not finite, or the surface is so
    /// large that squares of areas overflow (2^28 in f32, 2^252 in f64).
    pub fn new<P>(mesh: &'a TriangleMesh, points: &'a P) -> Result<Self, SurfaceError>
    where
        P: Points<Scalar = T> + ?Sized,
    {
        let positions = checked(mesh, points)?;
        Ok(Self {
            mesh,
            positions,
            remainders: None,
        })
    }

    /// The surface with the sums `points + remainders` at the vertices: each coordinate is the sum
    /// of its nearest number and a remainder, which gives twice the precision of the scalar.
    ///
    /// # Errors
    /// As [`Self::new`], for both.
    pub fn with_remainders<P>(
        mesh: &'a TriangleMesh,
        points: &'a P,
        remainders: &'a P,
    ) -> Result<Self, SurfaceError>
    where
        P: Points<Scalar = T> + ?Sized,
    {
        let positions = checked(mesh, points)?;
        let remainders = Some(checked(mesh, remainders)?);
        Ok(Self {
            mesh,
            positions,
            remainders,
        })
    }

    /// The surface with positions of another surface, which have been checked already.
    ///
    /// # Panics
    /// If there is no position for a vertex.
    pub(crate) fn of_checked(
        mesh: &'a TriangleMesh,
        positions: &'a [[T; 3]],
        remainders: Option<&'a [[T; 3]]>,
    ) -> Self {
        assert_eq!(
            mesh.vertex_count(),
            positions.len(),
            "positions of vertices"
        );
        Self {
            mesh,
            positions,
            remainders,
        }
    }

    /// The connectivity.
    #[inline]
    pub fn mesh(&self) -> &'a TriangleMesh {
        self.mesh
    }

    /// The positions, without remainders, for output; formulas use [`Self::difference`].
    #[inline]
    pub fn positions(&self) -> &'a [[T; 3]] {
        self.positions
    }

    /// Remainders of the positions, if they were given as pairs.
    #[inline]
    pub fn remainders(&self) -> Option<&'a [[T; 3]]> {
        self.remainders
    }

    /// x_to − x_from.
    ///
    /// # Panics
    /// If there is no such vertex.
    #[inline(always)]
    pub fn difference(&self, from: u32, to: u32) -> [T; 3] {
        let (from, to) = (from as usize, to as usize);
        let difference = vec3::sub(self.positions[to], self.positions[from]);
        match self.remainders {
            None => difference,
            Some(remainders) => vec3::add(difference, vec3::sub(remainders[to], remainders[from])),
        }
    }

    /// The neighbours of a vertex relative to it, in the order of [`TriangleMesh::one_ring`].
    pub(crate) fn spokes(self, vertex: usize) -> impl Iterator<Item = [T; 3]> {
        let ring = self.mesh().one_ring(vertex).iter();
        ring.map(move |&neighbour| self.difference(vertex as u32, neighbour))
    }

    /// The surface relative to a vertex, for many differences from this vertex.
    #[inline(always)]
    pub(crate) fn seen_from(&self, from: u32) -> Seen<'a, T> {
        Seen {
            from: self.positions[from as usize],
            positions: self.positions,
            remainders: self.remainders.map(|r| (r[from as usize], r)),
        }
    }

    /// The position of a vertex relative to a nearby vertex, with remainders. Formulas subtract two
    /// positions with the same origin.
    #[inline(always)]
    pub(crate) fn position_near(&self, vertex: u32, origin: u32) -> [T; 3] {
        match self.remainders {
            None => self.positions[vertex as usize],
            Some(remainders) => {
                let position = self.positions[vertex as usize];
                let difference = vec3::sub(position, self.positions[origin as usize]);
                vec3::add(difference, remainders[vertex as usize])
            }
        }
    }

    #[inline(always)]
    pub(crate) fn triangle(&self, triangle: usize) -> Triangle<T> {
        let [a, b, c] = self.mesh.triangles()[triangle];
        Triangle::new([
            self.difference(b, c),
            self.difference(c, a),
            self.difference(a, b),
        ])
    }

    /// Area of a triangle.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn triangle_area(&self, triangle: usize) -> T {
        T::constant(0.5) * self.triangle(triangle).doubled_area
    }

    /// Outward unit normal of a triangle; 0 for one without area.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn triangle_normal(&self, triangle: usize) -> [T; 3] {
        self.triangle(triangle).normal()
    }

    /// Angles at the three corners of a triangle, in radians.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn triangle_angles(&self, triangle: usize) -> [T; 3] {
        self.triangle(triangle).angles()
    }

    /// Total area.
    pub fn area(&self) -> T {
        reduction::sum(self.mesh.triangles().len(), &|t| self.triangle_area(t))
    }

    /// Enclosed volume, positive if the triangles run counter-clockwise seen from outside; `None`
    /// if the mesh has a boundary.
    pub fn volume(&self) -> Option<T> {
        self.mesh.is_closed().then(|| {
            let sixfold = reduction::sum(self.mesh.triangles().len(), &|t| self.sixfold_volume(t));
            sixfold / T::constant(6.0)
        })
    }

    /// Six times the signed volume between a triangle and the first triangle's first vertex.
    fn sixfold_volume(&self, triangle: usize) -> T {
        let [a, b, c] = self.mesh.triangles()[triangle];
        let origin = self.mesh.triangles()[0][0];
        let apex = self.difference(origin, a);
        vec3::dot(
            apex,
            vec3::cross(self.difference(a, b), self.difference(a, c)),
        )
    }

    /// Centroid ∫ x dS / ∫ dS of the area; the first vertex of the first triangle if there is no
    /// area.
    pub fn centroid(&self) -> [T; 3] {
        let origin = self.mesh.triangles()[0][0];
        let triangles = self.mesh.triangles().len();
        let thrice_area = T::constant(3.0) * self.area();
        let over = if thrice_area > T::zero() {
            thrice_area.recip()
        } else {
            T::zero()
        };
        let moment = |axis: usize| {
            reduction::sum(triangles, &|t| {
                let corners = self.mesh.triangles()[t];
                let offset = |v: u32| self.difference(origin, v)[axis];
                let sum = offset(corners[0]) + offset(corners[1]) + offset(corners[2]);
                self.triangle_area(t) * sum
            })
        };
        let offset: Vec3<T> = [moment(0), moment(1), moment(2)];
        vec3::add(self.positions[origin as usize], vec3::scale(over, offset))
    }

    /// Edges at which the normals of the two triangles differ by more than this angle, in radians.
    ///
    /// A triangle lower than 1/5 of its longest edge whose normal differs by more than half this angle from those of all
    /// its neighbours says nothing about the surface: instead of it count its other two neighbours, by their areas.
    pub fn creases(&self, angle: T) -> Vec<[u32; 2]> {
        const LOW: f64 = 0.2;
        let half = angle / T::constant(2.0);
        let normals = 0..self.mesh.triangles().len();
        let normals = Vec::from_iter(normals.map(|triangle| self.triangle_normal(triangle)));
        let sides = |edge: usize| {
            let (left, right) = self.mesh.edge_triangles(edge);
            right.map(|right| [left as usize, right as usize])
        };
        let edges = 0..self.mesh.edges().len();
        let mut agrees = vec![false; normals.len()];
        let mut around = vec![[T::zero(); 3]; normals.len()];
        for [left, right] in edges.clone().filter_map(sides) {
            let is_even = dot(normals[left], normals[right]) > half.cos();
            for (here, beyond) in [(left, right), (right, left)] {
                agrees[here] |= is_even;
                around[here] = add(around[here], self.triangle(beyond).area_vector);
            }
        }
        let side = |here: usize, beyond: usize| {
            let triangle = self.triangle(here);
            let squares = triangle.edges.map(|edge| dot(edge, edge));
            let longest = squares.into_iter().fold(T::zero(), T::max);
            if agrees[here] || triangle.doubled_area > T::constant(LOW) * longest {
                normals[here]
            } else {
                normalise(sub(around[here], self.triangle(beyond).area_vector))
            }
        };
        let is_crease = |&edge: &usize| {
            sides(edge).is_some_and(|[left, right]| {
                dot(side(left, right), side(right, left)) < angle.cos()
            })
        };
        edges
            .filter(is_crease)
            .map(|edge| self.mesh.edges()[edge])
            .collect()
    }

    /// Reports every triangle without area.
    pub(crate) fn report_degenerate_triangles(&self, report: &mut dyn FnMut(Finding)) {
        for triangle in 0..self.mesh.triangles().len() {
            if self.triangle(triangle).reciprocal == T::zero() {
                report(Finding::DegenerateTriangle {
                    triangle: triangle as u32,
                });
            }
        }
    }

    /// V − E + F: see [`TriangleMesh::euler_characteristic`].
    pub fn euler_characteristic(&self) -> i64 {
        self.mesh.euler_characteristic()
    }
}
