//! The flat triangles of the input, on which the vertices of a new mesh move.

use crate::edit::{EditableMesh, Freedom};
use crate::face_tree::{MeshPoint, nearest_of};
use crate::lane::Lane;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, dot, norm, normalise, scale, sub};
use alloc::vec;
use alloc::vec::Vec;
use core::array::from_fn;
use core::iter::zip;

/// The input, with its kept lines, and the edge length that is wanted at each of its vertices.
pub(super) struct InputSurface<'a, T> {
    pub(super) surface: Surface<'a, T>,
    pub(super) corners: EditableMesh,
    /// The same triangles, cut along the lines, which no path crosses.
    sides: EditableMesh,
    pub(super) sizes: &'a [T],
    /// Unit normals at the vertices of the input, means over their triangles.
    normals: Vec<Vec3<T>>,
}

/// The input at one of its places.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sample<T> {
    pub(super) position: Vec3<T>,
    /// The unit normal, a mean of those of the corners.
    pub(super) normal: Vec3<T>,
    /// The wanted length of edges.
    pub(super) size: T,
}

/// A place on a line of the input: a part of the way between two vertices along the line, or a vertex, twice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot<T> {
    pub(super) from: u32,
    pub(super) to: u32,
    pub(super) part: T,
}

impl<T: Real> Spot<T> {
    pub(super) fn at_vertex(vertex: u32) -> Self {
        Self {
            from: vertex,
            to: vertex,
            part: T::zero(),
        }
    }
}

/// The largest turn of a line at a vertex that is not one of its corners: 45°.
const CORNER: f64 = core::f64::consts::FRAC_1_SQRT_2;

impl<'a, T: Real> InputSurface<'a, T> {
    pub(super) fn new(surface: Surface<'a, T>, lines: &[[u32; 2]], sizes: &'a [T]) -> Self {
        assert_eq!(sizes.len(), surface.positions().len(), "sizes at vertices");
        let corners = EditableMesh::with_lines(surface.mesh(), lines);
        let sides = match lines {
            [] => corners.clone(),
            _ => EditableMesh::new(&corners.clone().cut().mesh),
        };
        let mut ground = Self {
            surface,
            corners,
            sides,
            sizes,
            normals: vertex_normals(surface),
        };
        for vertex in 0..sizes.len() as u32 {
            if let Freedom::OnLine(ends) = ground.corners.freedom(vertex) {
                let [a, b] = ends.map(|end| sub(ground.at(end), ground.at(vertex)));
                if -dot(a, b) < T::constant(CORNER) * norm(a) * norm(b) {
                    ground.corners.fix(vertex);
                }
            }
        }
        ground
    }

    /// The offset of a smooth line through vertices from the spot of the straight one: a polynomial of degree 3 in the
    /// length of the straight line, or of a lower one where it ends.
    pub(super) fn bend(&self, spot: Spot<T>) -> Vec3<T> {
        let Spot { from, to, part } = spot;
        let way = sub(self.at(to), self.at(from));
        let length = norm(way);
        // Places of the vertices relative to the spot, and lengths along the line.
        let flat = scale(part, way);
        let mut points = [([T::zero(); 3], T::zero()); 4];
        points[0] = (sub([T::zero(); 3], flat), -part * length);
        points[1] = (sub(way, flat), (T::one() - part) * length);
        let mut count = 2;
        for [here, before] in [[from, to], [to, from]] {
            if let Freedom::OnLine([a, b]) = self.corners.freedom(here) {
                let beyond = if a == before { b } else { a };
                let step = norm(sub(self.at(beyond), self.at(here)));
                let at = sub(sub(self.at(beyond), self.at(from)), flat);
                let along = if here == from {
                    points[0].1 - step
                } else {
                    points[1].1 + step
                };
                points[count] = (at, along);
                count += 1;
            }
        }
        let points = &points[..count];
        let terms = points.iter().enumerate().map(|(k, &(point, own))| {
            let others = points.iter().enumerate().filter(|(other, _)| *other != k);
            let weight = others.fold(T::one(), |weight, (_, &(_, other))| {
                weight * other * (other - own).reciprocal_or_zero()
            });
            scale(weight, point)
        });
        terms.fold([T::zero(); 3], add)
    }

    /// The places on the triangles beside a spot; none at a vertex.
    pub(super) fn sides(&self, spot: Spot<T>) -> [Option<MeshPoint<T>>; 2] {
        let Spot { from, to, part } = spot;
        let left = self.corners.half_edge(from, to);
        let right = self.corners.half_edge(to, from);
        [
            left.map(|half_edge| self.corner(half_edge as usize, part)),
            right.map(|half_edge| self.corner(half_edge as usize, T::one() - part)),
        ]
    }

    fn at(&self, vertex: u32) -> Vec3<T> {
        self.surface.positions()[vertex as usize]
    }

    /// The flat triangle, its normal and the wanted length at a place.
    pub(super) fn sample(&self, place: MeshPoint<T>) -> Sample<T> {
        let corners = self.surface.mesh().triangles()[place.triangle];
        let mut sample = Sample::default();
        for (corner, weight) in zip(corners, place.barycentric) {
            let at = self.normals[corner as usize];
            sample.position = add(sample.position, scale(weight, self.at(corner)));
            sample.normal = add(sample.normal, scale(weight, at));
            sample.size += weight * self.sizes[corner as usize];
        }
        sample.normal = normalise(sample.normal);
        sample
    }

    /// The samples at the vertices.
    pub(super) fn at_vertices(&self) -> Vec<Sample<T>> {
        let vertices = zip(self.surface.positions(), zip(&self.normals, self.sizes));
        let samples = vertices.map(|(&position, (&normal, &size))| Sample {
            position,
            normal,
            size,
        });
        samples.collect()
    }

    /// A place at a vertex of the input, which is in a triangle.
    pub(super) fn vertex(&self, vertex: u32) -> MeshPoint<T> {
        let half_edge = self.corners.around(vertex).next();
        let corner = half_edge.expect("a vertex of a triangle") as usize;
        self.corner(corner, T::zero())
    }

    /// A place on a half-edge of the input.
    fn corner(&self, half_edge: usize, part: T) -> MeshPoint<T> {
        let (start, end) = (half_edge % 3, (half_edge + 1) % 3);
        MeshPoint {
            triangle: half_edge / 3,
            barycentric: from_fn(|k| match k {
                _ if k == start => T::one() - part,
                _ if k == end => part,
                _ => T::zero(),
            }),
        }
    }

    /// A place on a line.
    pub(super) fn place(&self, spot: Spot<T>) -> MeshPoint<T> {
        let [left, right] = self.sides(spot);
        left.or(right).unwrap_or_else(|| self.vertex(spot.from))
    }

    /// The point nearest to `target` that is found by going downhill from a spot, to any of its sides.
    pub(super) fn nearest_beside(&self, from: Spot<T>, target: Vec3<T>) -> MeshPoint<T> {
        let ends = [from.from, from.to].into_iter();
        let around = ends.flat_map(|vertex| self.corners.around(vertex));
        let squared = |half_edge: &u32| nearest_of(self.surface, *half_edge as usize / 3, target).1;
        let best = around.min_by(|a, b| {
            let order = squared(a).partial_cmp(&squared(b));
            order.unwrap_or(core::cmp::Ordering::Equal)
        });
        let half_edge = best.expect("a vertex of a triangle") as usize;
        self.nearest(self.corner(half_edge, T::zero()), target)
    }

    /// The point nearest to `target` that is found by going downhill from a place, across edges and vertices.
    pub(super) fn nearest(&self, from: MeshPoint<T>, target: Vec3<T>) -> MeshPoint<T> {
        let (barycentric, mut least) = nearest_of(self.surface, from.triangle, target);
        let mut best = MeshPoint {
            triangle: from.triangle,
            barycentric,
        };
        loop {
            let (here, before) = (best, least);
            let mut visit = |triangle: usize| {
                let (barycentric, squared) = nearest_of(self.surface, triangle, target);
                if squared < least {
                    least = squared;
                    best = MeshPoint {
                        triangle,
                        barycentric,
                    };
                }
            };
            let is_zero = here.barycentric.map(|weight| weight == T::zero());
            match is_zero {
                [false, false, false] => return best,
                [true, false, false] | [false, true, false] | [false, false, true] => {
                    let off = is_zero.iter().position(|&zero| zero).unwrap_or(0);
                    let half_edge = 3 * here.triangle + (off + 1) % 3;
                    if let Some(other) = self.sides.opposite(half_edge as u32) {
                        visit(other as usize / 3);
                    }
                }
                _ => {
                    let corner = is_zero.iter().position(|&zero| !zero).unwrap_or(0);
                    let vertex = self.sides.tail((3 * here.triangle + corner) as u32);
                    for half_edge in self.sides.around(vertex) {
                        visit(half_edge as usize / 3);
                    }
                }
            }
            // A distance that is no number is none that is less.
            let is_closer = least < before;
            if !is_closer {
                return here;
            }
        }
    }

    /// The spot at a distance along the line from a spot, on the side to which the direction points; at most the end of
    /// the line.
    pub(super) fn along(&self, spot: Spot<T>, direction: Vec3<T>, distance: T) -> Spot<T> {
        let Some(mut spot) = self.towards(spot, direction) else {
            return spot;
        };
        let mut left = distance;
        // A closed line has at most as many edges as the mesh has vertices.
        for _ in 0..self.sizes.len() {
            let length = norm(sub(self.at(spot.to), self.at(spot.from)));
            let room = (T::one() - spot.part) * length;
            if left < room {
                spot.part += left * length.reciprocal_or_zero();
                return spot;
            }
            left -= room;
            let next = match self.corners.freedom(spot.to) {
                Freedom::OnLine([a, b]) => Some(if a == spot.from { b } else { a }),
                _ => None,
            };
            let Some(next) = next else {
                return Spot::at_vertex(spot.to);
            };
            spot = Spot {
                from: spot.to,
                to: next,
                part: T::zero(),
            };
        }
        spot
    }

    /// The same spot, with the end of its edge to which a direction points last; `None` if the line does not go on there.
    fn towards(&self, spot: Spot<T>, direction: Vec3<T>) -> Option<Spot<T>> {
        if spot.from != spot.to {
            let ahead = dot(sub(self.at(spot.to), self.at(spot.from)), direction);
            return Some(if ahead < T::zero() {
                Spot {
                    from: spot.to,
                    to: spot.from,
                    part: T::one() - spot.part,
                }
            } else {
                spot
            });
        }
        let mut most = T::zero();
        let mut best = None;
        for to in self.line_ends(spot.from) {
            let edge = sub(self.at(to), self.at(spot.from));
            let ahead = dot(edge, direction) * norm(edge).reciprocal_or_zero();
            if ahead > most {
                most = ahead;
                best = Some(Spot { to, ..spot });
            }
        }
        best
    }

    /// The neighbours of a vertex along lines.
    fn line_ends(&self, vertex: u32) -> impl Iterator<Item = u32> {
        let neighbours = self.corners.neighbours(vertex);
        neighbours.filter(move |&other| {
            let here = self.corners.half_edge(vertex, other);
            let edge = here.or_else(|| self.corners.half_edge(other, vertex));
            edge.is_some_and(|half_edge| self.corners.is_kept(half_edge))
        })
    }
}

/// Unit normals by N. Max, J. Graphics Tools 4(2), 1999: sums of area vectors over the squared lengths of the edges at
/// the vertex. Weights by angles would take the normal of a sliver with an angle near π for that of the surface.
fn vertex_normals<T: Real>(surface: Surface<'_, T>) -> Vec<Vec3<T>> {
    let mut normals = vec![[T::zero(); 3]; surface.positions().len()];
    for (triangle, corners) in surface.mesh().triangles().iter().enumerate() {
        let flat = surface.triangle(triangle);
        let squares = flat.edges.map(|edge| dot(edge, edge));
        for (k, &corner) in corners.iter().enumerate() {
            let weight = (squares[(k + 1) % 3] * squares[(k + 2) % 3]).reciprocal_or_zero();
            let sum = &mut normals[corner as usize];
            *sum = add(*sum, scale(weight, flat.area_vector));
        }
    }
    normals.into_iter().map(normalise).collect()
}
