//! Positions of surfaces and their triangles, for all layers.

use super::panel::Panel;
use glam::DVec3;
use helfrich::TriangleMesh;
use std::ops::Range;

/// Largest number of cells along each axis for few triangles. For many, all cells are at most eight
/// times as many as triangles, which lie on surfaces.
const CELLS: usize = 32;

/// Cells are wider than the reach by this fraction, which exceeds the rounding of cell coordinates.
const MARGIN: f64 = 1.0 / 64.0;

/// Consecutive surfaces, and a search for their triangles near a point.
#[derive(Clone, Debug, Default)]
pub(super) struct Geometry {
    pub(super) surfaces: Vec<SurfaceRange>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<Edge>,
    /// The surface of each vertex.
    owners: Vec<u32>,
    /// `ring_triangles[ring_offsets[i]..ring_offsets[i + 1]]` are the triangles around vertex i.
    ring_offsets: Vec<u32>,
    ring_triangles: Vec<u32>,
    positions: Vec<DVec3>,
    centres: Vec<Centre>,
    /// The sum of the area-weighted normals around each vertex.
    normals: Vec<DVec3>,
    cells: Cells,
}

/// The ranges of a surface's triangles and edges among those of all surfaces.
#[derive(Clone, Debug)]
pub(super) struct SurfaceRange {
    pub(super) triangles: Range<usize>,
    pub(super) edges: Range<usize>,
}

/// The ends of an edge, and the triangles on its sides.
#[derive(Clone, Copy, Debug)]
struct Edge {
    ends: [u32; 2],
    triangles: (u32, Option<u32>),
}

/// The centre of a triangle, its normal with twice the area as its length, and the square of the
/// distance within which it is near.
#[derive(Clone, Copy, Debug)]
struct Centre {
    position: DVec3,
    normal: DVec3,
    squared_reach: f64,
}

/// The relation of a near triangle to a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Near {
    /// On the same surface, and adjacent.
    Beside,
    /// On another surface, or on the same surface and facing the vertex through the fluid outside
    /// or inside. Normals are opposite where such a gap is least, unlike normals of neighbours
    /// along a smooth surface. Gaps may be much smaller than edges.
    Across,
}

/// Triangles sorted into cubes by their centres; the cubes are as wide as the longest reach.
#[derive(Clone, Debug, Default)]
struct Cells {
    low: DVec3,
    over_width: f64,
    /// The largest number of cells along an axis.
    most: usize,
    /// Number of cells along each axis.
    counts: [usize; 3],
    /// `members[offsets[i]..offsets[i + 1]]` are the triangles in cell i.
    offsets: Vec<u32>,
    members: Vec<Member>,
}

/// A triangle of a cell, with the data that are compared for every point near the cell.
#[derive(Clone, Copy, Debug, Default)]
struct Member {
    position: DVec3,
    squared_reach: f64,
    number: u32,
}

impl Geometry {
    /// # Panics
    /// If there are 2³² vertices or more.
    pub(super) fn new<'a>(meshes: impl IntoIterator<Item = &'a TriangleMesh>) -> Self {
        let mut geometry = Self::default();
        let Self {
            surfaces,
            triangles,
            edges,
            owners,
            ring_offsets,
            ring_triangles,
            ..
        } = &mut geometry;
        for (surface, mesh) in meshes.into_iter().enumerate() {
            let (first, first_triangle) = (owners.len(), triangles.len());
            let first_edge = edges.len();
            let count = first + mesh.vertex_count();
            assert!(
                u32::try_from(count).is_ok(),
                "{count} vertices are too many"
            );
            owners.resize(count, surface as u32);
            let moved = |triangle: &[u32; 3]| triangle.map(|vertex| vertex + first as u32);
            triangles.extend(mesh.triangles().iter().map(moved));
            edges.extend(mesh.edges().iter().enumerate().map(|(number, edge)| {
                let (one, other) = mesh.edge_triangles(number);
                let moved = |triangle: u32| triangle + first_triangle as u32;
                Edge {
                    ends: edge.map(|vertex| vertex + first as u32),
                    triangles: (moved(one), other.map(moved)),
                }
            }));
            surfaces.push(SurfaceRange {
                triangles: first_triangle..triangles.len(),
                edges: first_edge..edges.len(),
            });
        }
        let count = owners.len();
        ring_offsets.resize(count + 1, 0);
        for &vertex in triangles.iter().flatten() {
            ring_offsets[vertex as usize + 1] += 1;
        }
        for vertex in 0..count {
            ring_offsets[vertex + 1] += ring_offsets[vertex];
        }
        let mut next = ring_offsets.clone();
        ring_triangles.resize(3 * triangles.len(), 0);
        for (number, triangle) in triangles.iter().enumerate() {
            for &vertex in triangle {
                let slot = &mut next[vertex as usize];
                ring_triangles[*slot as usize] = number as u32;
                *slot += 1;
            }
        }
        geometry
    }

    /// Number of vertices of all surfaces.
    pub(super) fn vertex_count(&self) -> usize {
        self.owners.len()
    }

    /// Number of edges of all surfaces.
    pub(super) fn edge_count(&self) -> usize {
        self.edges.len()
    }

    /// The normals of the triangles on the sides of an edge, with twice the area as length.
    pub(super) fn normals(&self, edge: usize) -> [DVec3; 2] {
        let (one, other) = self.edges[edge].triangles;
        let normal = |triangle: u32| self.centres[triangle as usize].normal;
        [normal(one), other.map_or(DVec3::ZERO, normal)]
    }

    /// A distance from the middle of an edge beyond which no point is near the adjacent triangles.
    pub(super) fn reach(&self, edge: usize) -> f64 {
        let (one, other) = self.edges[edge].triangles;
        let squared = |triangle: u32| self.centres[triangle as usize].squared_reach;
        // The distance from the centre to the middle is less than the longest edge, which is half of
        // the reach.
        1.5 * squared(one).max(other.map_or(0.0, squared)).sqrt()
    }

    /// The midpoint of an edge.
    pub(super) fn middle(&self, edge: usize) -> DVec3 {
        self.mean(edge, &self.positions)
    }

    /// The value of a linear field in the middle of an edge.
    pub(super) fn mean(&self, edge: usize, field: &[DVec3]) -> DVec3 {
        let [a, b] = self.edges[edge].ends.map(|vertex| field[vertex as usize]);
        0.5 * (a + b)
    }

    pub(super) fn position(&self, vertex: usize) -> DVec3 {
        self.positions[vertex]
    }

    /// Whether the midpoint of an edge of a triangle is closer to a point than a 64th of the longest edge: its
    /// contribution is then large, and the correction by the triangle nearly cancels it.
    pub(super) fn has_close_middle(&self, triangle: usize, at: DVec3) -> bool {
        let [a, b, c] = self.panel(triangle).corners_from(at);
        let close = |one: DVec3, other: DVec3| {
            let twice = one + other;
            4096.0 * twice.length_squared() < self.centres[triangle].squared_reach
        };
        close(a, b) || close(b, c) || close(c, a)
    }

    /// Whether the height of a triangle is less than about a sixteenth of its longest edge.
    pub(super) fn is_thin(&self, triangle: usize) -> bool {
        let centre = &self.centres[triangle];
        64.0 * centre.normal.length() < centre.squared_reach
    }

    /// The root of twice the area around a vertex.
    pub(super) fn width(&self, vertex: usize) -> f64 {
        self.normals[vertex].length().sqrt()
    }

    pub(super) fn panel(&self, number: usize) -> Panel<'_> {
        Panel::new(self.triangles[number], &self.positions)
    }

    /// The surface of a triangle.
    pub(super) fn surface(&self, number: usize) -> usize {
        self.surfaces
            .partition_point(|part| part.triangles.end <= number)
    }

    /// The triangles around a vertex.
    pub(super) fn ring(&self, vertex: usize) -> &[u32] {
        &self.ring_triangles
            [self.ring_offsets[vertex] as usize..self.ring_offsets[vertex + 1] as usize]
    }

    /// Moves the vertices to `positions`.
    ///
    /// # Panics
    /// If there is not one position per vertex.
    pub(super) fn place(&mut self, positions: &[[f64; 3]]) {
        assert_eq!(
            positions.len(),
            self.vertex_count(),
            "one position a vertex"
        );
        let points = positions.iter().copied().map(DVec3::from);
        self.positions.clear();
        self.positions.extend(points);
        self.normals.clear();
        self.normals.resize(positions.len(), DVec3::ZERO);
        self.centres.clear();
        for &triangle in &self.triangles {
            let panel = Panel::new(triangle, &self.positions);
            let normal = panel.doubled_normal();
            for vertex in triangle {
                self.normals[vertex as usize] += normal;
            }
            self.centres.push(Centre {
                position: panel.centre(),
                normal,
                squared_reach: panel.squared_reach(),
            });
        }
        self.cells.fill(&self.centres);
    }

    /// The near triangles of a vertex, without those around it, and their relation to it.
    pub(super) fn near_vertex(&self, vertex: usize) -> impl Iterator<Item = (usize, Near)> + '_ {
        let (owner, normal) = (self.owners[vertex], self.normals[vertex]);
        self.near_point(self.positions[vertex], 1)
            .filter_map(move |number| {
                let triangle = self.triangles[number];
                let near = if self.owners[triangle[0] as usize] != owner
                    || self.centres[number].normal.dot(normal) < 0.0
                {
                    Near::Across
                } else {
                    Near::Beside
                };
                (!triangle.contains(&(vertex as u32))).then_some((number, near))
            })
    }

    /// The triangles whose centre is within `factor` reaches of a point.
    pub(super) fn near_point(&self, at: DVec3, reaches: u32) -> impl Iterator<Item = usize> + '_ {
        let squared = f64::from(reaches * reaches);
        self.cells
            .around(at, reaches)
            .filter(move |member| {
                at.distance_squared(member.position) < squared * member.squared_reach
            })
            .map(|member| member.number as usize)
    }
}

impl Cells {
    fn fill(&mut self, centres: &[Centre]) {
        let first = centres
            .first()
            .map_or(DVec3::ZERO, |centre| centre.position);
        let mut high = first;
        let mut squared_width = 0.0;
        self.low = first;
        for centre in centres {
            self.low = self.low.min(centre.position);
            high = high.max(centre.position);
            squared_width = centre.squared_reach.max(squared_width);
        }
        let width = (1.0 + MARGIN) * squared_width.sqrt();
        self.over_width = if width.is_normal() {
            width.recip()
        } else {
            0.0
        };
        let extent = (self.over_width * (high - self.low)).to_array();
        // Points beyond the last cell count as in that cell.
        self.most = (2.0 * (centres.len() as f64).cbrt()).max(CELLS as f64) as usize;
        self.counts = extent.map(|extent| (extent as usize).min(self.most - 1) + 1);
        let cells = self.counts.iter().product::<usize>();
        self.offsets.clear();
        self.offsets.resize(cells + 1, 0);
        for centre in centres {
            let cell = self.cell(centre.position);
            self.offsets[cell] += 1;
        }
        for cell in 0..cells {
            self.offsets[cell + 1] += self.offsets[cell];
        }
        // Each cell is filled from its end, so that its offset finally is its start.
        self.members.clear();
        self.members.resize(centres.len(), Member::default());
        for (number, centre) in centres.iter().enumerate().rev() {
            let cell = self.cell(centre.position);
            self.offsets[cell] -= 1;
            self.members[self.offsets[cell] as usize] = Member {
                position: centre.position,
                squared_reach: centre.squared_reach,
                number: number as u32,
            };
        }
    }

    fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        (x * self.counts[1] + y) * self.counts[2] + z
    }

    /// The cell of a centre.
    fn cell(&self, at: DVec3) -> usize {
        let place = (self.over_width * (at - self.low)).to_array();
        let clamped = |axis: usize| (place[axis] as usize).min(self.counts[axis] - 1);
        self.number([0, 1, 2].map(clamped))
    }

    /// The triangles in the cell of a point, and in the cells up to `cells` away.
    fn around(&self, at: DVec3, cells: u32) -> impl Iterator<Item = &Member> {
        let place = (self.over_width * (at - self.low)).to_array();
        let cells = f64::from(cells);
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let (cell, count) = (place[axis].floor(), self.counts[axis]);
            // The conversion saturates, and turns NaN into 0.
            let (first, end) = ((cell - cells) as usize, (cell + cells + 1.0) as usize);
            if first < count {
                first..end.min(count)
            } else if count < self.most {
                0..0
            } else {
                count - 1..count
            }
        });
        let rows = x.flat_map(move |x| y.clone().map(move |y| [x, y]));
        rows.flat_map(move |[x, y]| {
            let members = if z.is_empty() {
                0..0
            } else {
                let first = self.number([x, y, z.start]);
                let last = self.number([x, y, z.end - 1]);
                self.offsets[first] as usize..self.offsets[last + 1] as usize
            };
            &self.members[members]
        })
    }
}
