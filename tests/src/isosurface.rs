//! Isosurfaces of a grid, as microscopes and simulations produce them: thin triangles, several
//! components, open at the ends of the grid.

use crate::meshes::{SplitMix64, norm};
use std::collections::HashMap;

/// Positions and triangles.
pub type Soup = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// Faces of a cube, counterclockwise from outside, as lists of corners: bit k of a corner is its coordinate
/// along axis k.
const FACES: [[usize; 4]; 6] = [
    [0, 4, 6, 2],
    [1, 3, 7, 5],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 2, 3, 1],
    [4, 5, 7, 6],
];

/// A cubic grid of values, and the vertices on its edges.
struct Grid {
    /// Number of nodes along each axis.
    nodes: usize,
    values: Vec<f64>,
    /// The vertices, keyed by the first node of an edge and the axis of the edge.
    vertices: HashMap<(usize, usize), u32>,
    positions: Vec<[f64; 3]>,
}

impl Grid {
    fn step(&self, axis: usize) -> usize {
        self.nodes.pow(axis as u32)
    }

    /// Node at a corner of the cube whose first node is `cube`.
    fn node(&self, cube: usize, corner: usize) -> usize {
        cube + (0..3)
            .filter(|axis| corner >> axis & 1 == 1)
            .map(|axis| self.step(axis))
            .sum::<usize>()
    }

    fn place(&self, node: usize) -> [f64; 3] {
        let cells = (self.nodes - 1) as f64;
        [0, 1, 2].map(|axis| (node / self.step(axis) % self.nodes) as f64 * 2.0 / cells - 1.0)
    }

    /// Vertex on the edge between two corners of a cube, at the zero of the linear interpolation.
    fn vertex(&mut self, cube: usize, corners: [usize; 2]) -> u32 {
        let [from, to] = [corners[0].min(corners[1]), corners[0].max(corners[1])];
        let axis = (from ^ to).trailing_zeros() as usize;
        let [from, to] = [from, to].map(|corner| self.node(cube, corner));
        let part = self.values[from] / (self.values[from] - self.values[to]);
        let [start, end] = [from, to].map(|node| self.place(node));
        *self.vertices.entry((from, axis)).or_insert_with(|| {
            let at = |axis: usize| start[axis] + part * (end[axis] - start[axis]);
            self.positions.push([0, 1, 2].map(at));
            self.positions.len() as u32 - 1
        })
    }

    /// For each vertex on the edges of a cube, the next vertex of its polygon; and whether a face is
    /// ambiguous. An ambiguous face has four vertices; each of its positive corners is cut off separately.
    fn polygons(&mut self, cube: usize) -> (HashMap<u32, u32>, bool) {
        let mut next = HashMap::new();
        let mut is_ambiguous = false;
        for face in FACES {
            let is_inside = face.map(|corner| self.values[self.node(cube, corner)] > 0.0);
            let leaves = |side: usize| is_inside[side] && !is_inside[(side + 1) % 4];
            let enters = |side: usize| !is_inside[side] && is_inside[(side + 1) % 4];
            is_ambiguous |= leaves(0) && leaves(2) || leaves(1) && leaves(3);
            for side in (0..4).filter(|&side| leaves(side)) {
                let back = (1..4).map(|sides| (side + 4 - sides) % 4);
                let entry = back.into_iter().find(|&side| enters(side));
                let ends = [Some(side), entry].map(|side| {
                    let side = side.expect("what leaves has entered");
                    self.vertex(cube, [face[side], face[(side + 1) % 4]])
                });
                next.insert(ends[1], ends[0]);
            }
        }
        (next, is_ambiguous)
    }
}

/// Zero level of a field on a grid of `cells³` cubes over [−1, 1]³ by marching cubes, with normals that point
/// away from positive values. The polygons of each cube are traced face by face.
pub fn marching_cubes(cells: usize, field: impl Fn([f64; 3]) -> f64) -> Soup {
    let nodes = cells + 1;
    let mut grid = Grid {
        nodes,
        values: Vec::new(),
        vertices: HashMap::new(),
        positions: Vec::new(),
    };
    grid.values = (0..nodes.pow(3))
        .map(|node| field(grid.place(node)))
        .collect();
    let mut triangles = Vec::new();
    for cube in 0..nodes.pow(3) {
        if [0, 1, 2]
            .iter()
            .any(|&axis| cube / grid.step(axis) % nodes == cells)
        {
            continue;
        }
        let (mut next, is_ambiguous) = grid.polygons(cube);
        while let Some(&first) = next.keys().min() {
            let mut polygon = vec![first];
            let mut at = next.remove(&first);
            while let Some(vertex) = at.filter(|&vertex| vertex != first) {
                polygon.push(vertex);
                at = next.remove(&vertex);
            }
            let mut sides = polygon.windows(2).map(|side| [side[0], side[1]]);
            if is_ambiguous && polygon.len() > 3 {
                // The polygon is triangulated about its centre, because a diagonal could lie in a face in
                // which the neighbouring cube has one, too.
                let corners = polygon
                    .iter()
                    .map(|&vertex| grid.positions[vertex as usize]);
                let sum = corners.fold([0.0; 3], |sum, x| [0, 1, 2].map(|k| sum[k] + x[k]));
                let centre = grid.positions.len() as u32;
                grid.positions.push(sum.map(|x| x / polygon.len() as f64));
                let last = [polygon[polygon.len() - 1], first];
                triangles.extend(sides.chain([last]).map(|[from, to]| [centre, from, to]));
            } else {
                sides.next();
                triangles.extend(sides.map(|[from, to]| [first, from, to]));
            }
        }
    }
    (grid.positions, triangles)
}

/// Isosurface like those of a segmentation: one to four overlapping or separate blobs, with noise of the
/// values and of the positions, and with holes in every second case.
pub fn segmentation(cells: usize, seed: u64) -> Soup {
    let mut random = SplitMix64::new(seed);
    let blobs = Vec::from_iter((0..=random.below(4)).map(|_| {
        let centre = [(); 3].map(|()| 0.6 * random.symmetric());
        (centre, 0.25 + 0.1 * random.symmetric())
    }));
    let rough = [0.0, 1e-3, 1e-2][random.below(3)];
    let noise = [0.0, 1e-4, 1e-3, 1e-2, 0.1][random.below(5)] * 2.0 / cells as f64;
    let mut values = SplitMix64::new(!seed);
    let draws = std::cell::RefCell::new(&mut values);
    let (mut positions, triangles) = marching_cubes(cells, |x| {
        let from = |centre: &[f64; 3]| norm([0, 1, 2].map(|k| x[k] - centre[k]));
        let parts = blobs
            .iter()
            .map(|(centre, radius)| (-(from(centre) / radius).powi(2)).exp());
        parts.sum::<f64>() - 0.3 + rough * draws.borrow_mut().symmetric()
    });
    for x in positions.iter_mut().flatten() {
        *x += noise * random.symmetric();
    }
    let holes = Vec::from_iter((0..random.below(2) * 3).filter_map(|_| {
        let centre = *positions.get(random.below(positions.len().max(1)))?;
        Some((centre, 0.05 + 0.15 * random.symmetric().abs()))
    }));
    let is_kept = |&vertex: &u32| {
        let x = positions[vertex as usize];
        let distance = |centre: &[f64; 3]| norm([0, 1, 2].map(|k| x[k] - centre[k]));
        holes
            .iter()
            .all(|(centre, radius)| distance(centre) > *radius)
    };
    let kept = triangles
        .into_iter()
        .filter(|corners| corners.iter().all(is_kept));
    let kept = kept.collect();
    (positions, kept)
}
