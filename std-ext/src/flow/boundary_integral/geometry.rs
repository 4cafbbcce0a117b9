//! Where surfaces and their triangles are: what all layers share.

use super::panel::Panel;
use glam::DVec3;
use helfrich::TriangleMesh;
use std::ops::Range;

/// Cells along each axis at most.
const CELLS: usize = 32;

/// Cells are wider than the reach by this part, more than places in cells are rounded by.
const MARGIN: f64 = 1.0 / 64.0;

/// Surfaces, one after the other, and which of their triangles are near a point.
#[derive(Clone, Debug, Default)]
pub(super) struct Geometry {
    /// Where each surface's triangles are among those of all.
    pub(super) surfaces: Vec<Range<usize>>,
    triangles: Vec<[u32; 3]>,
    /// The surface of each vertex.
    owners: Vec<u32>,
    /// `ring_triangles[ring_offsets[i]..ring_offsets[i + 1]]` are the triangles around vertex i.
    ring_offsets: Vec<u32>,
    ring_triangles: Vec<u32>,
    positions: Vec<DVec3>,
    centres: Vec<Centre>,
    /// The sum of the normals around each vertex, each as long as its triangle is large.
    normals: Vec<DVec3>,
    cells: Cells,
}

/// Where a triangle is, its normal as long as twice its area, and the square of the distance within
/// which it is near.
#[derive(Clone, Copy, Debug)]
struct Centre {
    position: DVec3,
    normal: DVec3,
    squared_reach: f64,
}

/// Triangles by the cube their centre lies in, cubes being as wide as the longest reach.
#[derive(Clone, Debug, Default)]
struct Cells {
    low: DVec3,
    over_width: f64,
    /// How many cells there are along each axis.
    counts: [usize; 3],
    /// `members[offsets[i]..offsets[i + 1]]` are the triangles in cell i.
    offsets: Vec<u32>,
    members: Vec<u32>,
}

impl Geometry {
    /// # Panics
    /// If there are 2³² vertices or more.
    pub(super) fn new<'a>(meshes: impl IntoIterator<Item = &'a TriangleMesh>) -> Self {
        let mut geometry = Self::default();
        let Self {
            surfaces,
            triangles,
            owners,
            ring_offsets,
            ring_triangles,
            ..
        } = &mut geometry;
        for (surface, mesh) in meshes.into_iter().enumerate() {
            let (first, first_triangle) = (owners.len(), triangles.len());
            let count = first + mesh.vertex_count();
            assert!(
                u32::try_from(count).is_ok(),
                "{count} vertices are too many"
            );
            owners.resize(count, surface as u32);
            let moved = |triangle: &[u32; 3]| triangle.map(|vertex| vertex + first as u32);
            triangles.extend(mesh.triangles().iter().map(moved));
            surfaces.push(first_triangle..triangles.len());
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

    /// Number of triangles of all surfaces.
    pub(super) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    pub(super) fn position(&self, vertex: usize) -> DVec3 {
        self.positions[vertex]
    }

    pub(super) fn panel(&self, number: usize) -> Panel<'_> {
        Panel::new(self.triangles[number], &self.positions)
    }

    /// The triangles around a vertex.
    pub(super) fn ring(&self, vertex: usize) -> &[u32] {
        &self.ring_triangles
            [self.ring_offsets[vertex] as usize..self.ring_offsets[vertex + 1] as usize]
    }

    /// Puts the vertices at `positions`.
    ///
    /// # Panics
    /// If there is not one position a vertex.
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

    /// The near triangles of a vertex that are integrated apart, but for those around it: all that
    /// are near of other surfaces, and of its own those that face it, be it through the fluid
    /// outside or inside. Their normals are opposite where the gap is least, and those of its
    /// neighbours along a smooth surface are not.
    pub(super) fn near_vertex(&self, vertex: usize) -> impl Iterator<Item = usize> + '_ {
        let normal = self.normals[vertex];
        self.near_point(self.positions[vertex])
            .filter(move |&number| {
                let triangle = self.triangles[number];
                self.owners[triangle[0] as usize] != self.owners[vertex]
                    || self.centres[number].normal.dot(normal) < 0.0
                        && !triangle.contains(&(vertex as u32))
            })
    }

    /// The triangles whose centre is near a point.
    pub(super) fn near_point(&self, at: DVec3) -> impl Iterator<Item = usize> + '_ {
        self.cells
            .around(at)
            .map(|&number| number as usize)
            .filter(move |&number| {
                let centre = self.centres[number];
                at.distance_squared(centre.position) < centre.squared_reach
            })
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
        // What lies beyond the last cell counts as in it.
        self.counts = extent.map(|extent| (extent as usize).min(CELLS - 1) + 1);
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
        // Filled from its end, each cell ends up at its beginning.
        self.members.clear();
        self.members.resize(centres.len(), 0);
        for (number, centre) in centres.iter().enumerate().rev() {
            let cell = self.cell(centre.position);
            self.offsets[cell] -= 1;
            self.members[self.offsets[cell] as usize] = number as u32;
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

    /// The triangles in the cell of any point and in those around it.
    fn around(&self, at: DVec3) -> impl Iterator<Item = &u32> {
        let place = (self.over_width * (at - self.low)).to_array();
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let (cell, count) = (place[axis].floor(), self.counts[axis]);
            // Conversion stays within usize, and makes 0 of what is no number.
            let (first, end) = ((cell - 1.0) as usize, (cell + 2.0) as usize);
            if first < count {
                first..end.min(count)
            } else if count < CELLS {
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
