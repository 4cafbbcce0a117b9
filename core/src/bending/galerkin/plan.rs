//! Results that follow from the connectivity: neighbours, and the places of results in blocks.
//!
//! Vertices, triangles and edges are processed in blocks of one lane each. Results of a block are rows
//! of [`Several`], with an entry for each member of the block.

use super::basis::{AROUND, FREE, INSIDE, ON_EDGE, blend, inner_from};
use crate::fit::coefficient_count;
use crate::lane::{Lane, Several, WIDTH};
use crate::mesh::TriangleMesh;
use crate::neighbourhood::Surroundings;
use crate::real::Real;
use alloc::vec;
use alloc::vec::Vec;

/// Degree of the polynomials.
pub(super) const DEGREE: usize = 8;

/// Number of their coefficients.
pub(super) const COUNT: usize = coefficient_count(DEGREE);

/// Number of vertices whose order may change, so that blocks have members of the same valence.
const WINDOW: usize = 512;

/// Rows of a jet's displacements for each neighbour in the one-ring.
pub(super) const STAR: usize = ON_EDGE + INSIDE;

/// Rows of what a patch returns: derivatives with respect to the displacements of free points, and to
/// the position and the normal of each corner. Derivatives with respect to parameters that vary follow, at
/// free points.
pub(super) const RETURNED: usize = FREE + 3 * 6;

/// No triangle, or no edge.
pub(super) const NONE: u32 = u32::MAX;

/// A row of vectors, one for each member of a block. They are read one by one, so their entries stand together.
pub(super) type Vectors<T> = [[T; 3]; WIDTH];

/// Entry `lane` of row `row`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LanePlace {
    row: usize,
    lane: u8,
}

impl LanePlace {
    fn new(row: usize, lane: usize) -> Self {
        let lane = lane as u8;
        Self { row, lane }
    }

    /// The entry `rows` rows further.
    #[inline(always)]
    pub(super) fn read<T: Copy>(self, all: &[Several<T>], rows: usize) -> T {
        all[self.row + rows].0[usize::from(self.lane)]
    }

    /// The vector at this place.
    #[inline(always)]
    pub(super) fn vector<T: Copy>(self, all: &[Vectors<T>]) -> [T; 3] {
        all[self.row][usize::from(self.lane)]
    }
}

/// Vertices with fits that are computed together.
#[derive(Clone, Debug)]
pub(super) struct VertexBlock {
    /// Entries that no vertex is left for repeat the first.
    pub(super) vertices: [u32; WIDTH],
    pub(super) valences: [u32; WIDTH],
    /// Numbers of neighbours.
    pub(super) counts: [u32; WIDTH],
    /// Degree of the fits.
    pub(super) degree: usize,
}

/// A triangle that counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    pub(super) corners: [u32; 3],
    /// The displacements of each corner's jet: towards the next corner and inside, and towards the
    /// other corner.
    pub(super) stars: [[LanePlace; 2]; 3],
    /// The edges in the list of those between two of these triangles, and whether they run the other
    /// way.
    pub(super) edges: [(u32, bool); 3],
}

/// An edge between two triangles that count: where these have the edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct InteriorEdge {
    /// Number of the triangle among those that count, and its local edge.
    pub(super) sides: [(u32, u8); 2],
}

/// The plan of all evaluations on a mesh.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) blocks: Vec<VertexBlock>,
    /// Rows of neighbours of each block, the one-ring first; padded with the vertex itself.
    pub(super) neighbours: Vec<[u32; WIDTH]>,
    pub(super) neighbour_offsets: Vec<usize>,
    /// Start of each block among the neighbours of one-rings.
    pub(super) ring_offsets: Vec<usize>,
    /// Start of each block among displacements: [`STAR`] rows for each neighbour in the one-ring.
    pub(super) star_offsets: Vec<usize>,
    /// For each of these rows, by lanes, the triangle that follows the neighbour, times 3 plus the number
    /// of the vertex among its corners; [`NONE`] if it does not count.
    pub(super) around: Vec<[u32; WIDTH]>,
    /// The place of each vertex that has a fit: its block and lane.
    pub(super) members: Vec<Option<(u32, u8)>>,
    /// Interior vertices of components that are too small for any fit.
    pub(super) without_fit: Vec<u32>,
    pub(super) patches: Vec<Patch>,
    /// The triangle of the mesh that each is.
    pub(super) triangles: Vec<u32>,
    pub(super) interior_edges: Vec<InteriorEdge>,
    /// For each vertex, the places among neighbours at which it is listed.
    pub(super) listed_offsets: Vec<usize>,
    pub(super) listed: Vec<LanePlace>,
    /// For each vertex, the places among neighbours of one-rings at which it is listed.
    pub(super) ringed_offsets: Vec<usize>,
    pub(super) ringed: Vec<LanePlace>,
}

/// Degrees of fits, highest first, the number of neighbours that each needs, twice the number of coefficients,
/// and the least number of vertices of a component. Whole rings are taken until there are so many; the five
/// rings of a vertex of valence 6 have 90.
///
/// Neighbours are at most a tenth of a component: more would surround it instead of being a graph over a
/// plane. Degree 8 needs more vertices: five rings of a mesh of 2562 vertices surround the tips of a vesicle of
/// reduced volume 0.6, and where vertices do not resolve the surface, polynomials of degree 6 over fewer
/// neighbours have smaller errors.
const DEGREES: [(usize, usize, usize); 6] = [
    (8, 88, 5000),
    (6, 54, 540),
    (5, 40, 400),
    (4, 28, 280),
    (3, 18, 180),
    (2, 10, 100),
];

/// Degree and number of neighbours for the vertices of a component of this size; degree 0 if they determine no
/// fit.
fn degree_and_need(component: usize) -> (usize, usize) {
    let (least, few, _) = DEGREES[DEGREES.len() - 1];
    let mut fits = DEGREES.into_iter();
    match fits.find(|&(_, _, vertices)| vertices <= component) {
        Some((degree, need, _)) => (degree, need),
        None if component > few => (least, few),
        None => (0, 0),
    }
}

/// The blend of what jets give to the free points of patches.
#[inline(always)]
pub(super) fn gather_blended<T: Real>(
    plan: &Plan,
    shares: &[Several<T>],
    first: usize,
) -> [Several<T>; FREE] {
    let zero = Several::zero();
    let (mut near, mut far) = ([[zero; ON_EDGE]; 3], [[zero; ON_EDGE]; 3]);
    let mut inside = [[zero; INSIDE]; 3];
    for lane in 0..WIDTH {
        let patch = plan.patch_in(first, lane);
        for corner in 0..3 {
            let [star, other] = patch.stars[corner];
            // The edge that ends here, from its other end.
            let ending = (corner + 2) % 3;
            for k in 0..ON_EDGE {
                near[corner][k].0[lane] = star.read(shares, k);
                far[ending][ON_EDGE - 1 - k].0[lane] = other.read(shares, k);
            }
            for (k, value) in inside[corner].iter_mut().enumerate() {
                value.0[lane] = star.read(shares, ON_EDGE + k);
            }
        }
    }
    let mut sums = [zero; FREE];
    for edge in 0..3 {
        for k in 0..ON_EDGE {
            let [own, next, _] = AROUND[k];
            let weights = [[own, next, 0.0], [next, own, 0.0]].map(blend);
            sums[edge * ON_EDGE + k] = Several::literal(weights[0]) * near[edge][k]
                + Several::literal(weights[1]) * far[edge][k];
        }
    }
    for (corner, inside) in inside.iter().enumerate() {
        for (k, &value) in inside.iter().enumerate() {
            let point = 3 * ON_EDGE + inner_from(corner, k);
            let weight = Several::literal(blend(AROUND[ON_EDGE + k]));
            sums[point] = sums[point] + weight * value;
        }
    }
    sums
}

impl Plan {
    pub(super) fn new(mesh: &TriangleMesh) -> Self {
        let (components, number) = mesh.components();
        let mut sizes = vec![0; number];
        for &component in &components {
            sizes[component as usize] += 1;
        }
        let fit = |vertex: usize| degree_and_need(sizes[components[vertex] as usize]);
        let surroundings = Surroundings::rings(mesh, |vertex| fit(vertex).1);
        let degree = |vertex: u32| fit(vertex as usize).0;
        let serves = |&vertex: &u32| mesh.is_interior(vertex as usize) && degree(vertex) > 0;
        let counts = |corners: &[u32; 3]| corners.iter().all(serves);
        let mut numbers = vec![NONE; mesh.triangles().len()];
        let mut triangles = Vec::new();
        let mut used = vec![false; mesh.vertex_count()];
        for (triangle, corners) in mesh.triangles().iter().enumerate() {
            if counts(corners) {
                numbers[triangle] = triangles.len() as u32;
                triangles.push(triangle as u32);
                for &corner in corners {
                    used[corner as usize] = true;
                }
            }
        }
        let mut plan = Self {
            blocks: Vec::new(),
            neighbours: Vec::new(),
            neighbour_offsets: vec![0],
            ring_offsets: vec![0],
            star_offsets: vec![0],
            around: Vec::new(),
            members: vec![None; mesh.vertex_count()],
            without_fit: (0..mesh.vertex_count() as u32)
                .filter(|&v| mesh.is_interior(v as usize) && degree(v) == 0)
                .collect(),
            patches: Vec::new(),
            triangles,
            interior_edges: Vec::new(),
            listed_offsets: Vec::new(),
            listed: Vec::new(),
            ringed_offsets: Vec::new(),
            ringed: Vec::new(),
        };
        plan.set_blocks(mesh, &surroundings, &used, degree);
        plan.set_patches(mesh, &numbers);
        plan.set_hems(mesh, &numbers);
        let rows = plan.neighbour_offsets.clone();
        let whole = |block: &VertexBlock, lane: usize| block.counts[lane] as usize;
        (plan.listed_offsets, plan.listed) = plan.lists(&rows, whole);
        let rows = plan.ring_offsets.clone();
        let ring = |block: &VertexBlock, lane: usize| block.valences[lane] as usize;
        (plan.ringed_offsets, plan.ringed) = plan.lists(&rows, ring);
        plan
    }

    fn set_blocks(
        &mut self,
        mesh: &TriangleMesh,
        surroundings: &Surroundings,
        used: &[bool],
        degree: impl Fn(u32) -> usize,
    ) {
        let mut order: Vec<u32> = (0..used.len() as u32)
            .filter(|&v| used[v as usize])
            .collect();
        let count = |vertex: u32| surroundings.of(vertex as usize).count();
        order.sort_by_key(|&vertex| degree(vertex));
        for window in order.chunks_mut(WINDOW) {
            window.sort_by_key(|&v| (degree(v), mesh.valence(v as usize), count(v), v));
        }
        let alike = |a: &u32, b: &u32| degree(*a) == degree(*b);
        for members in order.chunk_by(alike).flat_map(|run| run.chunks(WIDTH)) {
            self.add_block(mesh, surroundings, members, degree(members[0]));
        }
    }

    fn add_block(
        &mut self,
        mesh: &TriangleMesh,
        surroundings: &Surroundings,
        members: &[u32],
        degree: usize,
    ) {
        let number = self.blocks.len() as u32;
        for (lane, &vertex) in members.iter().enumerate() {
            self.members[vertex as usize] = Some((number, lane as u8));
        }
        let vertices: [u32; WIDTH] =
            core::array::from_fn(|lane| members.get(lane).copied().unwrap_or(members[0]));
        let near = vertices.map(|vertex| surroundings.of(vertex as usize).vertices());
        let valences = vertices.map(|vertex| mesh.valence(vertex as usize));
        let rows = near.iter().map(|near| near.len()).max().unwrap_or(0);
        for row in 0..rows {
            let neighbour = |lane: usize| near[lane].get(row).copied().unwrap_or(vertices[lane]);
            self.neighbours.push(core::array::from_fn(neighbour));
        }
        let ring = valences.iter().copied().max().unwrap_or(0);
        let next = |offsets: &[usize], rows: usize| offsets[offsets.len() - 1] + rows;
        self.neighbour_offsets
            .push(next(&self.neighbour_offsets, rows));
        self.ring_offsets.push(next(&self.ring_offsets, ring));
        self.star_offsets
            .push(next(&self.star_offsets, ring * STAR));
        self.around.resize(self.around.len() + ring, [NONE; WIDTH]);
        self.blocks.push(VertexBlock {
            vertices,
            valences: valences.map(|valence| valence as u32),
            counts: near.map(|near| near.len() as u32),
            degree,
        });
    }

    /// The patch in a lane of the block from number `first` on; the last one repeats.
    #[inline(always)]
    pub(super) fn patch_in(&self, first: usize, lane: usize) -> &Patch {
        &self.patches[(first + lane).min(self.patches.len() - 1)]
    }

    /// Where a vertex is listed among neighbours.
    pub(super) fn listed_at(&self, vertex: usize) -> &[LanePlace] {
        &self.listed[self.listed_offsets[vertex]..self.listed_offsets[vertex + 1]]
    }

    /// Where a vertex is listed among neighbours of one-rings.
    pub(super) fn ringed_at(&self, vertex: usize) -> &[LanePlace] {
        &self.ringed[self.ringed_offsets[vertex]..self.ringed_offsets[vertex + 1]]
    }

    /// The triangles that count around a vertex, and the number of the vertex among their corners.
    pub(super) fn patches_at(&self, vertex: usize) -> impl Iterator<Item = (usize, usize)> {
        let (rows, lane) = match self.members[vertex] {
            Some((block, lane)) => {
                let block = block as usize;
                let ends = self.ring_offsets[block]..self.ring_offsets[block + 1];
                (&self.around[ends], usize::from(lane))
            }
            None => (&self.around[..0], 0),
        };
        let triangles = rows.iter().map(move |row| row[lane]);
        let counted = triangles.filter(|&triangle| triangle != NONE);
        counted.map(|triangle| (triangle as usize / 3, triangle as usize % 3))
    }

    /// The block and lane of a vertex that has a fit.
    fn member(&self, vertex: u32) -> (usize, usize) {
        let (block, lane) = self.members[vertex as usize].unwrap_or_default();
        (block as usize, usize::from(lane))
    }

    fn set_patches(&mut self, mesh: &TriangleMesh, numbers: &[u32]) {
        for number in 0..self.triangles.len() {
            let corners = mesh.triangles()[self.triangles[number] as usize];
            let mut stars = [[LanePlace::default(); 2]; 3];
            for (corner, stars) in stars.iter_mut().enumerate() {
                let ring = mesh.one_ring(corners[corner] as usize);
                let next = corners[(corner + 1) % 3];
                let at = ring.iter().position(|&v| v == next).unwrap_or(0);
                let (block, lane) = self.member(corners[corner]);
                let first = self.star_offsets[block];
                let star = |at: usize| LanePlace::new(first + at * STAR, lane);
                *stars = [star(at), star((at + 1) % ring.len())];
                self.around[self.ring_offsets[block] + at][lane] = (3 * number + corner) as u32;
            }
            self.patches.push(Patch {
                corners,
                stars,
                edges: [(NONE, false); 3],
            });
        }
        debug_assert!(numbers.len() >= self.patches.len());
    }

    fn set_hems(&mut self, mesh: &TriangleMesh, numbers: &[u32]) {
        for (edge, &ends) in mesh.edges().iter().enumerate() {
            let (left, right) = mesh.edge_triangles(edge);
            let (left, right) = (
                numbers[left as usize],
                right.map_or(NONE, |right| numbers[right as usize]),
            );
            if left == NONE || right == NONE {
                continue;
            }
            let shared = self.interior_edges.len() as u32;
            let [first, second] = ends;
            let side = |plan: &mut Self, triangle: u32, from: u32, reversed: bool| {
                let patch = &mut plan.patches[triangle as usize];
                let local = patch.corners.iter().position(|&v| v == from).unwrap_or(0);
                patch.edges[local] = (shared, reversed);
                (triangle, local as u8)
            };
            let sides = [
                side(self, left, first, false),
                side(self, right, second, true),
            ];
            self.interior_edges.push(InteriorEdge { sides });
        }
    }

    /// For each vertex, where it is listed among the first neighbours of blocks that start at these rows;
    /// `count` is how many rows of a lane are used.
    fn lists(
        &self,
        rows: &[usize],
        count: impl Fn(&VertexBlock, usize) -> usize,
    ) -> (Vec<usize>, Vec<LanePlace>) {
        let mut starts = vec![0_usize; self.members.len() + 1];
        let each = |visit: &mut dyn FnMut(u32, LanePlace)| {
            for (number, block) in self.blocks.iter().enumerate() {
                for lane in 0..WIDTH {
                    let vertex = block.vertices[lane] as usize;
                    if self.members[vertex] != Some((number as u32, lane as u8)) {
                        continue;
                    }
                    for row in 0..count(block, lane) {
                        let neighbour = self.neighbours[self.neighbour_offsets[number] + row][lane];
                        let place = LanePlace::new(rows[number] + row, lane);
                        visit(neighbour, place);
                    }
                }
            }
        };
        each(&mut |vertex, _| starts[vertex as usize + 1] += 1);
        for vertex in 1..starts.len() {
            starts[vertex] += starts[vertex - 1];
        }
        let mut next = starts.clone();
        let mut places = vec![LanePlace::default(); starts[self.members.len()]];
        each(&mut |vertex, place| {
            let at = &mut next[vertex as usize];
            places[*at] = place;
            *at += 1;
        });
        (starts, places)
    }
}
