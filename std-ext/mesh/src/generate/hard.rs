//! Regular meshes with random displacements, needles and caps.

use super::random::Random;
use super::{AnyShape, GenerateError, GeneratedMesh, position, preimage};
use glam::DVec3;
use helfrich::TriangleMesh;
use helfrich::shapes::Shape;

/// Radius of the disc in which a vertex is displaced, in mean lengths of its edges.
const JITTER: f64 = 0.3;

/// Lengths of a needle's short edge in mean edges, and heights of a cap in its base. They are tried in this
/// order, and the first that keeps the angles within their range is used.
const SHARPNESS: [f64; 4] = [0.013, 0.016, 0.02, 0.026];

/// Smallest cosine between the normals of a triangle and of the surface at its centre.
const LEAST_ALIGNMENT: f64 = 0.1;

/// The angles that the triangles around a moved vertex may have.
#[derive(Clone, Copy)]
struct AngleRange {
    /// The cotangent of the smallest angle.
    most: f64,
    /// The cotangent of the largest angle.
    least: f64,
}

impl AngleRange {
    fn degrees(smallest: f64, largest: f64) -> Self {
        let cotangent = |degrees: f64| 1.0 / libm::tan(degrees.to_radians());
        Self {
            most: cotangent(smallest),
            least: cotangent(largest),
        }
    }

    fn contains(self, cotangent: f64) -> bool {
        self.least <= cotangent && cotangent <= self.most
    }
}

/// Displaces the vertices of a mesh at random, and makes 1 % of them needles and 1 % caps.
pub(super) fn disturb(regular: GeneratedMesh, seed: u64) -> Result<GeneratedMesh, GenerateError> {
    let GeneratedMesh {
        mesh,
        positions,
        preimages,
        shape,
    } = regular;
    let mut vertices = Vertices {
        mesh: &mesh,
        shape: &shape,
        positions: positions.into_iter().map(DVec3::from).collect(),
        preimages,
    };
    let mut random = Random::new(seed);
    vertices.jitter(&mut random);
    vertices.sharpen(&mut random);
    let Vertices {
        positions,
        preimages,
        ..
    } = vertices;
    let positions = positions.iter().map(DVec3::to_array).collect();
    Ok(GeneratedMesh {
        mesh,
        positions,
        preimages,
        shape,
    })
}

struct Vertices<'a> {
    mesh: &'a TriangleMesh,
    shape: &'a AnyShape,
    positions: Vec<DVec3>,
    preimages: Vec<[f64; 3]>,
}

impl Vertices<'_> {
    fn jitter(&mut self, random: &mut Random) {
        let range = AngleRange::degrees(5.0, 165.0);
        let edges = Vec::from_iter((0..self.positions.len()).map(|v| self.mean_edge(v)));
        for (vertex, edge) in edges.into_iter().enumerate() {
            let here = self.positions[vertex];
            let normal = DVec3::from(self.shape.at(self.preimages[vertex]).normal);
            let right = normal.any_orthonormal_vector();
            let up = normal.cross(right);
            let offset = JITTER * edge * random.in_disc();
            // Where the map to the shape has already flattened the triangles, a smaller step may still fit.
            for share in [1.0, 0.5, 0.25] {
                let target = here + share * (offset.x * right + offset.y * up);
                if self.move_within(vertex, target, range) {
                    break;
                }
            }
        }
    }

    /// Makes needles and caps in turn around randomly chosen vertices that share no triangle.
    fn sharpen(&mut self, random: &mut Random) {
        let count = self.positions.len();
        let wanted = count.div_ceil(100);
        let mut taken = vec![false; count];
        let mut order = random.permutation(count).into_iter();
        for make in [Self::needle, Self::cap] {
            let mut made = 0;
            while made < wanted
                && let Some(vertex) = order.next()
            {
                let vertex = vertex as usize;
                let choice = random.below(self.mesh.valence(vertex));
                if !taken[vertex] && make(self, vertex, choice) {
                    made += 1;
                    taken[vertex] = true;
                    for &neighbour in self.mesh.one_ring(vertex) {
                        taken[neighbour as usize] = true;
                    }
                }
            }
        }
    }

    /// Moves a vertex almost onto one of its neighbours.
    fn needle(&mut self, vertex: usize, choice: usize) -> bool {
        let range = AngleRange::degrees(0.7, 170.0);
        let neighbour = self.positions[self.mesh.one_ring(vertex)[choice] as usize];
        let edge = self.mean_edge(vertex);
        let direction = (self.positions[vertex] - neighbour).normalize();
        SHARPNESS.iter().any(|sharpness| {
            self.move_within(vertex, neighbour + sharpness * edge * direction, range)
        })
    }

    /// Moves a vertex almost onto the opposite edge of one of its triangles.
    fn cap(&mut self, vertex: usize, choice: usize) -> bool {
        let range = AngleRange::degrees(0.7, 176.0);
        let ring = self.mesh.one_ring(vertex);
        let left = self.positions[ring[choice] as usize];
        let right = self.positions[ring[(choice + 1) % ring.len()] as usize];
        let base = right - left;
        let middle = left.midpoint(right);
        let height = (self.positions[vertex] - middle)
            .reject_from(base)
            .normalize();
        SHARPNESS.iter().any(|sharpness| {
            let target = middle + sharpness * base.length() * height;
            self.move_within(vertex, target, range)
        })
    }

    /// Moves a vertex to the point of the surface near `target` if the triangles around it then stay aligned
    /// with the surface and their angles within the range; returns whether it moved.
    fn move_within(&mut self, vertex: usize, target: DVec3, range: AngleRange) -> bool {
        let moved_preimage = preimage(self.shape, target);
        let moved = position(self.shape, moved_preimage);
        let ring = self.mesh.one_ring(vertex);
        for (at, &next) in ring.iter().enumerate() {
            let last = ring[(at + 1) % ring.len()];
            let corners = [
                moved,
                self.positions[next as usize],
                self.positions[last as usize],
            ];
            if !self.is_sound(corners, range) {
                return false;
            }
        }
        self.positions[vertex] = moved;
        self.preimages[vertex] = moved_preimage.to_array();
        true
    }

    fn is_sound(&self, [a, b, c]: [DVec3; 3], range: AngleRange) -> bool {
        let area = (b - a).cross(c - a);
        let length = area.length();
        let in_range = |corner: DVec3, next: DVec3, last: DVec3| {
            range.contains((next - corner).dot(last - corner) / length)
        };
        let centre = preimage(self.shape, (a + b + c) / 3.0);
        let normal = DVec3::from(self.shape.at(centre.to_array()).normal);
        area.dot(normal) > LEAST_ALIGNMENT * length
            && in_range(a, b, c)
            && in_range(b, c, a)
            && in_range(c, a, b)
    }

    fn mean_edge(&self, vertex: usize) -> f64 {
        let here = self.positions[vertex];
        let ring = self.mesh.one_ring(vertex);
        let lengths = ring
            .iter()
            .map(|&neighbour| here.distance(self.positions[neighbour as usize]));
        lengths.sum::<f64>() / ring.len() as f64
    }
}
