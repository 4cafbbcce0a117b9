//! Meshes for the laws: small, seeded, and described by a few readable numbers.

use helfrich::{Cotangent, DualArea, Real, Serial, Surface, TriangleMesh, VertexKind};
use std::collections::HashMap;
use std::ops::{Add, Mul, Sub};

pub mod rows;
mod strategies;

pub use strategies::{Base, Inscribed, Rough, bent, cases, inscribed, rough_any, rough_closed};

/// Connectivity with positions.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// The triangles.
    pub connectivity: TriangleMesh,
    /// The positions of the vertices.
    pub positions: Vec<[f64; 3]>,
}

impl Mesh {
    /// Mesh of these triangles and positions.
    ///
    /// # Panics
    /// If the mesh is not valid.
    pub fn new(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        let connectivity =
            TriangleMesh::new(positions.len(), triangles).expect("the generators make manifolds");
        Self {
            connectivity,
            positions,
        }
    }

    /// The surface.
    ///
    /// # Panics
    /// If a position is not finite.
    pub fn surface(&self) -> Surface<'_, f64> {
        Surface::new(&self.connectivity, &self.positions).expect("one finite position a vertex")
    }

    /// The part whose vertices are `kept`, and the old number of each of its vertices.
    pub fn cut(&self, kept: impl Fn([f64; 3]) -> bool) -> (Self, Vec<u32>) {
        let is_kept = Vec::from_iter(self.positions.iter().map(|&x| kept(x)));
        let triangles = self.connectivity.triangles().iter();
        let whole = |corners: &&[u32; 3]| corners.iter().all(|&v| is_kept[v as usize]);
        let triangles = Vec::from_iter(triangles.filter(whole).copied());
        let mut old = triangles.as_flattened().to_vec();
        old.sort_unstable();
        old.dedup();
        let number = |corner: u32| old.binary_search(&corner).map_or(0, |at| at as u32);
        let renumbered = triangles
            .iter()
            .map(|corners| corners.map(number))
            .collect();
        let positions = old.iter().map(|&v| self.positions[v as usize]).collect();
        (Self::new(positions, renumbered), old)
    }

    /// The number of edges from each vertex to the boundary; `u32::MAX` on closed components.
    pub fn edges_to_boundary(&self) -> Vec<u32> {
        let mesh = &self.connectivity;
        let mut distance = vec![u32::MAX; mesh.vertex_count()];
        let at_boundary = |&v: &usize| mesh.vertex_kind(v) == VertexKind::Boundary;
        let mut front = Vec::from_iter((0..mesh.vertex_count()).filter(at_boundary));
        for ring in 0.. {
            if front.is_empty() {
                break;
            }
            let mut next = Vec::new();
            for &vertex in &front {
                if distance[vertex] == u32::MAX {
                    distance[vertex] = ring;
                    next.extend(mesh.one_ring(vertex).iter().map(|&v| v as usize));
                }
            }
            next.retain(|&v| distance[v] == u32::MAX);
            front = next;
        }
        distance
    }

    /// Mesh with the same connectivity, every position mapped.
    pub fn map(&self, position: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        Self {
            connectivity: self.connectivity.clone(),
            positions: self.positions.iter().map(|&x| position(x)).collect(),
        }
    }

    /// The positions rounded to another scalar.
    pub fn positions_in<T: Real>(&self) -> Vec<[T; 3]> {
        let round = |position: &[f64; 3]| position.map(T::constant);
        self.positions.iter().map(round).collect()
    }

    /// The mean length of the edges.
    pub fn edge_length(&self) -> f64 {
        let edges = self.connectivity.edges();
        let surface = self.surface();
        let length = |&[a, b]: &[u32; 2]| norm(surface.difference(a, b));
        edges.iter().map(length).sum::<f64>() / edges.len() as f64
    }

    /// The smallest |cos| of all angles: the distance from a right angle, where mixed areas change
    /// their formula.
    pub fn distance_from_right_angle(&self) -> f64 {
        let surface = self.surface();
        let angles = (0..self.connectivity.triangles().len())
            .flat_map(|triangle| surface.triangle_angles(triangle));
        angles.map(|angle| angle.cos().abs()).fold(1.0, f64::min)
    }

    /// Ratio of the mean to the smallest absolute Voronoi area: the factor by which the smallest area
    /// amplifies rounding in formulas that divide by areas.
    pub fn roughness(&self) -> f64 {
        let mut areas = vec![0.0; self.positions.len()];
        Cotangent::new(DualArea::Voronoi).dual_areas(&Serial, self.surface(), &mut areas);
        let smallest = areas
            .iter()
            .fold(f64::INFINITY, |least, area| least.min(area.abs()));
        let mean = self.surface().area() / areas.len() as f64;
        (mean / smallest).max(1.0)
    }

    /// The same surface with permuted vertices and triangles, each triangle starting at another corner;
    /// and the new number of each old vertex.
    pub fn relabelled(&self, seed: u64) -> (Self, Vec<usize>) {
        let mut random = SplitMix64::new(seed);
        let new_number = random.permutation(self.positions.len());
        let mut positions = self.positions.clone();
        for (old, &new) in new_number.iter().enumerate() {
            positions[new] = self.positions[old];
        }
        let old_triangles = self.connectivity.triangles();
        let order = random.permutation(old_triangles.len());
        let triangles = order.into_iter().map(|triangle| {
            let mut corners = old_triangles[triangle].map(|old| new_number[old as usize] as u32);
            corners.rotate_left(random.below(3));
            corners
        });
        (Self::new(positions, triangles.collect()), new_number)
    }

    /// This mesh, and another one moved by a vector, as one mesh.
    pub fn beside(&self, other: &Self, away: [f64; 3]) -> Self {
        let first = self.positions.len() as u32;
        let mut positions = self.positions.clone();
        positions.extend(
            other
                .positions
                .iter()
                .map(|x| [0, 1, 2].map(|k| x[k] + away[k])),
        );
        let mut triangles = self.connectivity.triangles().to_vec();
        let others = other.connectivity.triangles().iter();
        triangles.extend(others.map(|corners| corners.map(|vertex| vertex + first)));
        Self::new(positions, triangles)
    }

    /// Each triangle divided into four at the middles of its edges.
    pub fn divided(&self) -> Self {
        let mut positions = self.positions.clone();
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                let (p, q) = (positions[a as usize], positions[b as usize]);
                positions.push([0, 1, 2].map(|axis| 0.5 * (p[axis] + q[axis])));
                positions.len() as u32 - 1
            })
        };
        let mut triangles = Vec::new();
        for &[a, b, c] in self.connectivity.triangles() {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            triangles.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        Self::new(positions, triangles)
    }

    fn divided_on_sphere(self, refinement: u32) -> Self {
        (0..refinement).fold(self.map(unit), |mesh, _| mesh.divided().map(unit))
    }
}

/// The regular tetrahedron in the unit sphere.
pub fn tetrahedron() -> Mesh {
    let positions = vec![
        [1.0, 1.0, 1.0],
        [1.0, -1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
    ];
    let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    Mesh::new(positions, triangles).map(unit)
}

/// The regular octahedron in the unit sphere; its last four triangles face down.
pub fn octahedron() -> Mesh {
    let positions = vec![
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let triangles = vec![
        [0, 1, 4],
        [1, 2, 4],
        [2, 3, 4],
        [3, 0, 4],
        [1, 0, 5],
        [2, 1, 5],
        [3, 2, 5],
        [0, 3, 5],
    ];
    Mesh::new(positions, triangles)
}

/// The regular icosahedron in the unit sphere.
pub fn icosahedron() -> Mesh {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut positions = Vec::new();
    for axis in 0..3 {
        for (long, short) in [
            (golden, 1.0),
            (golden, -1.0),
            (-golden, 1.0),
            (-golden, -1.0),
        ] {
            let mut position = [0.0; 3];
            position[axis] = long;
            position[(axis + 1) % 3] = short;
            positions.push(position);
        }
    }
    // The faces are the triples at mutual distance 2, oriented outward.
    let mut triangles = Vec::new();
    let near = |a: usize, b: usize| norm(difference(positions[a], positions[b])) < 2.1;
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let [p, q, r] = [positions[a], positions[b], positions[c]];
                    let outward = dot(p, cross(difference(q, p), difference(r, p))) > 0.0;
                    let (b, c) = if outward { (b, c) } else { (c, b) };
                    triangles.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    Mesh::new(positions, triangles).map(unit)
}

/// The icosahedron divided `refinement` times, in the unit sphere, in a generic rotation.
pub fn icosphere(refinement: u32) -> Mesh {
    let turn = rotation(GENERIC);
    icosahedron()
        .divided_on_sphere(refinement)
        .map(|x| turned(turn, x))
}

/// The upper half of the octahedron divided `refinement` times: an open patch of the unit sphere.
pub fn hemisphere(refinement: u32) -> Mesh {
    let octahedron = octahedron();
    let upper = octahedron.connectivity.triangles()[..4].to_vec();
    Mesh::new(octahedron.positions[..5].to_vec(), upper).divided_on_sphere(refinement)
}

/// A flat disc of hexagonal rings around the origin, with edges of length 1/`rings`.
pub fn disc(rings: u32) -> Mesh {
    let hexagon = (0..6).map(|k| {
        let (sine, cosine) = (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
        [cosine, sine]
    });
    let directions = Vec::from_iter(hexagon);
    let mut positions = vec![[0.0; 3]];
    let mut triangles = Vec::new();
    let number = |ring: u32, step: u32| match ring {
        0 => 0,
        _ => 1 + 3 * ring * (ring - 1) + step % (6 * ring),
    };
    for ring in 1..=rings {
        for side in 0..6 {
            for step in 0..ring {
                let (from, to) = (
                    directions[side as usize],
                    directions[(side as usize + 1) % 6],
                );
                let (outer, part) = (f64::from(ring), f64::from(step));
                let along = |axis: usize| {
                    ((outer - part) * from[axis] + part * to[axis]) / f64::from(rings)
                };
                positions.push([along(0), along(1), 0.0]);
                let here = number(ring, side * ring + step);
                let next = number(ring, side * ring + step + 1);
                let below = number(ring - 1, side * (ring - 1) + step);
                triangles.push([below, here, next]);
                if step > 0 {
                    let before = number(ring - 1, side * (ring - 1) + step - 1);
                    triangles.push([before, here, below]);
                }
            }
        }
    }
    Mesh::new(positions, triangles)
}

/// A round disc of radius 1, of `rings` circles of evenly spaced vertices around its centre.
pub fn round_disc(rings: u32) -> Mesh {
    let disc = disc(rings);
    let mut positions = vec![[0.0; 3]];
    for ring in 1..=rings {
        for step in 0..6 * ring {
            let angle = std::f64::consts::TAU * f64::from(step) / f64::from(6 * ring);
            let radius = f64::from(ring) / f64::from(rings);
            positions.push([radius * angle.cos(), radius * angle.sin(), 0.0]);
        }
    }
    Mesh::new(positions, disc.connectivity.triangles().to_vec())
}

/// The cap of the unit sphere about its highest point, out to this polar angle.
pub fn cap(rings: u32, angle: f64) -> Mesh {
    round_disc(rings).map(|[x, y, _]| {
        let radius = x.hypot(y);
        let (sine, cosine) = (angle * radius).sin_cos();
        let outward = if radius > 0.0 { sine / radius } else { 0.0 };
        [outward * x, outward * y, cosine]
    })
}

/// A tube of `around` vertices in each of `rows` + 1 circles, open at both ends, of radius
/// `radius(z)` at heights z from −`height` to `height`.
pub fn tube(around: u32, rows: u32, height: f64, radius: impl Fn(f64) -> f64) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let number = |row: u32, step: u32| row * around + step % around;
    for row in 0..=rows {
        let z = height * (2.0 * f64::from(row) / f64::from(rows) - 1.0);
        for step in 0..around {
            // Every second circle is rotated by half an edge, so that triangles are nearly equilateral.
            let step = f64::from(step) + 0.5 * f64::from(row % 2);
            let angle = std::f64::consts::TAU * step / f64::from(around);
            positions.push([radius(z) * angle.cos(), radius(z) * angle.sin(), z]);
        }
    }
    for row in 0..rows {
        for step in 0..around {
            let [a, b] = [number(row, step), number(row, step + 1)];
            let [c, d] = [number(row + 1, step), number(row + 1, step + 1)];
            let pair = if row % 2 == 0 {
                [[a, b, c], [b, d, c]]
            } else {
                [[a, b, d], [a, d, c]]
            };
            triangles.extend(pair);
        }
    }
    Mesh::new(positions, triangles)
}

/// The catenoid `r = cosh z` out to this height, in triangles that are nearly equilateral.
pub fn catenoid(around: u32, height: f64) -> Mesh {
    let step = std::f64::consts::TAU / f64::from(around) * 0.75_f64.sqrt();
    let rows = (2.0 * height / step).round() as u32;
    tube(around, rows, height, f64::cosh)
}

/// A torus with radii 1 and 0.4 of `around` × `across` quadrilaterals, each cut in two.
pub fn torus(around: u32, across: u32) -> Mesh {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let angle =
                |k: u32, count: u32| std::f64::consts::TAU * f64::from(k) / f64::from(count);
            let ((s, c), (v, u)) = (angle(i, around).sin_cos(), angle(j, across).sin_cos());
            let radius = 1.0 + 0.4 * u;
            positions.push([radius * c, radius * s, 0.4 * v]);
            let number = |i: u32, j: u32| (i % around) * across + j % across;
            let [a, b] = [number(i, j), number(i + 1, j)];
            let [d, c] = [number(i, j + 1), number(i + 1, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Mesh::new(positions, triangles)
}

/// A curved sheet with a boundary, `cells` × `cells` squares of two triangles each; it has vertices
/// in one triangle only.
pub fn sheet(cells: u32) -> Mesh {
    let at = |i: u32, j: u32| i + (cells + 1) * j;
    let mut triangles = Vec::new();
    let mut positions = Vec::new();
    for j in 0..=cells {
        for i in 0..=cells {
            let [x, y] = [i, j].map(|k| f64::from(k) / f64::from(cells) - 0.5);
            positions.push([x, y + 0.1 * x * x, 0.4 * x * x + 0.3 * x * y - 0.2 * y]);
            if i < cells && j < cells {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    Mesh::new(positions, triangles)
}

/// The boundary of a set of unit cubes, each face divided into `divisions` × `divisions` squares of two triangles.
pub fn cubes(cells: &[[i32; 3]], divisions: i32) -> Mesh {
    let mut numbers = HashMap::new();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let mut number = |at: [i32; 3]| {
        *numbers.entry(at).or_insert_with(|| {
            positions.push(at.map(|k| f64::from(k) / f64::from(divisions)));
            positions.len() as u32 - 1
        })
    };
    for cell in cells {
        for axis in 0..3 {
            for side in [0, 1] {
                let mut beyond = *cell;
                beyond[axis] += 2 * side - 1;
                if cells.contains(&beyond) {
                    continue;
                }
                let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
                for (i, j) in (0..divisions).flat_map(|i| (0..divisions).map(move |j| (i, j))) {
                    let mut corner = |di: i32, dj: i32| {
                        let mut at = cell.map(|k| divisions * k);
                        at[axis] += divisions * side;
                        (at[u], at[v]) = (at[u] + i + di, at[v] + j + dj);
                        number(at)
                    };
                    let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    triangles.extend(match side {
                        0 => [[a, c, b], [a, d, c]],
                        _ => [[a, b, c], [a, c, d]],
                    });
                }
            }
        }
    }
    Mesh::new(positions, triangles)
}

/// The smallest meshes, closed and open, with their names.
pub fn small() -> [(&'static str, Mesh); 4] {
    [
        ("tetrahedron", tetrahedron()),
        ("octahedron", octahedron()),
        ("triangle pair", sheet(1)),
        ("sheet", sheet(6)),
    ]
}
/// A small generator of random numbers: G. Steele, D. Lea, C. Flood, OOPSLA 2014.
#[derive(Clone, Debug)]
pub struct SplitMix64 {
    state: u64,
}

impl SplitMix64 {
    /// Starts the sequence of this seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number in [−1, 1).
    pub fn symmetric(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * 2.0_f64.powi(-52) - 1.0
    }

    /// An integer below `bound`.
    pub fn below(&mut self, bound: usize) -> usize {
        (self.bits() % bound as u64) as usize
    }

    /// The numbers below `count` in random order.
    pub fn permutation(&mut self, count: usize) -> Vec<usize> {
        let mut order = Vec::from_iter(0..count);
        for last in (1..count).rev() {
            order.swap(last, self.below(last + 1));
        }
        order
    }

    /// A vector with coordinates in [−1, 1) for each of `count` vertices.
    pub fn directions(&mut self, count: usize) -> Vec<[f64; 3]> {
        let direction = |_| [self.symmetric(), self.symmetric(), self.symmetric()];
        (0..count).map(direction).collect()
    }
}

/// A quaternion without symmetry, so that no edge or normal is parallel to an axis.
pub const GENERIC: [f64; 4] = [0.79, 0.31, -0.43, 0.17];

/// The rotation matrix, by rows, of a quaternion of any length above 0.
pub fn rotation(quaternion: [f64; 4]) -> [[f64; 3]; 3] {
    let length = quaternion.iter().map(|q| q * q).sum::<f64>().sqrt();
    let [w, x, y, z] = quaternion.map(|q| q / length);
    [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ],
        [
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
        ],
        [
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ]
}

/// A vector after a rotation.
pub fn turned(rotation: [[f64; 3]; 3], x: [f64; 3]) -> [f64; 3] {
    rotation.map(|row| dot(row, x))
}

/// a − b.
pub fn difference<T: Copy + Sub<Output = T>>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Scalar product.
pub fn dot<T: Copy + Add<Output = T> + Mul<Output = T>>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Vector product.
pub fn cross<T: Copy + Sub<Output = T> + Mul<Output = T>>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Length.
pub fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// The vector of length 1 in the same direction.
pub fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = norm(a);
    a.map(|coordinate| coordinate / length)
}
