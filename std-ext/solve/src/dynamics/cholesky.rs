//! Sparse Cholesky factorisation of symmetric matrices whose pattern is that of a mesh.
//!
//! Order of elimination: nested dissection by level sets, A. George and J. W.-H. Liu, SIAM J. Numer.
//! Anal. 15 (1978) 1053. Factorisation row by row, T. A. Davis, ACM Trans. Math. Softw. 31 (2005) 587.
//! An implementation of our own, because it is short and rounds identically on every machine.

use helfrich::TriangleMesh;
use helfrich_execute::execute::look_for_interruption;

/// Index that stands for no vertex or column.
const NONE: u32 = u32::MAX;

/// Sets of at most this many vertices are not dissected further.
const LEAF: usize = 24;

/// Number of rows that are factorised between two looks for an interruption: some milliseconds on the largest meshes.
const INTERRUPTIBLE: usize = 256;

/// The symbolic factorisation, which follows from the mesh alone.
#[derive(Clone, Debug)]
pub(crate) struct Pattern {
    /// The vertex that is eliminated k-th.
    vertices: Vec<u32>,
    /// Entries left of the diagonal, row by row: the start of each row, and `(column, edge)`.
    row_offsets: Vec<usize>,
    entries: Vec<(u32, u32)>,
    /// The elimination tree: each column's parent.
    parents: Vec<u32>,
    /// The start of each column of the factor.
    column_offsets: Vec<usize>,
}

impl Pattern {
    pub(crate) fn new(mesh: &TriangleMesh) -> Self {
        let count = mesh.vertex_count();
        let vertices = Dissection::new(mesh).vertices;
        let mut places = vec![0u32; count];
        for (place, &vertex) in vertices.iter().enumerate() {
            places[vertex as usize] = place as u32;
        }
        let mut row_offsets = vec![0usize; count + 1];
        let ends = |edge: &[u32; 2]| {
            let [a, b] = edge.map(|vertex| places[vertex as usize]);
            (a.max(b) as usize, a.min(b))
        };
        for edge in mesh.edges() {
            row_offsets[ends(edge).0 + 1] += 1;
        }
        for row in 0..count {
            row_offsets[row + 1] += row_offsets[row];
        }
        let mut next = row_offsets.clone();
        let mut entries = vec![(0u32, 0u32); mesh.edges().len()];
        for (index, edge) in mesh.edges().iter().enumerate() {
            let (row, column) = ends(edge);
            entries[next[row]] = (column, index as u32);
            next[row] += 1;
        }
        let mut pattern = Self {
            vertices,
            row_offsets,
            entries,
            parents: vec![NONE; count],
            column_offsets: Vec::new(),
        };
        pattern.set_columns();
        pattern
    }

    fn row(&self, row: usize) -> &[(u32, u32)] {
        &self.entries[self.row_offsets[row]..self.row_offsets[row + 1]]
    }

    /// The elimination tree, and the lengths of the factor's columns.
    fn set_columns(&mut self) {
        let count = self.vertices.len();
        let mut lengths = vec![0usize; count + 1];
        let mut seen = vec![NONE; count];
        for row in 0..count {
            seen[row] = row as u32;
            for entry in self.row_offsets[row]..self.row_offsets[row + 1] {
                let mut column = self.entries[entry].0 as usize;
                while seen[column] != row as u32 {
                    if self.parents[column] == NONE {
                        self.parents[column] = row as u32;
                    }
                    lengths[column + 1] += 1;
                    seen[column] = row as u32;
                    column = self.parents[column] as usize;
                }
            }
        }
        for column in 0..count {
            lengths[column + 1] += lengths[column];
        }
        self.column_offsets = lengths;
    }

    /// Number of entries below the diagonal of the factor.
    fn fill(&self) -> usize {
        self.column_offsets.last().copied().unwrap_or(0)
    }
}

/// `A = L D Lᵀ`, with unit diagonal in L.
#[derive(Clone, Debug)]
pub(crate) struct Factor {
    rows: Vec<u32>,
    values: Vec<f64>,
    /// 1/D.
    reciprocals: Vec<f64>,
    /// Memory for permuted vectors.
    vector: Vec<f64>,
}

impl Factor {
    /// Factorises the matrix with these entries on the diagonal, one a vertex, and off it, one an
    /// edge; `None` if it is not positive definite.
    pub(crate) fn new(pattern: &Pattern, diagonal: &[f64], edges: &[f64]) -> Option<Self> {
        let count = pattern.vertices.len();
        let mut rows = vec![0u32; pattern.fill()];
        let mut values = vec![0.0; pattern.fill()];
        let mut pivots = vec![0.0; count];
        let mut ends = pattern.column_offsets.clone();
        let mut seen = vec![NONE; count];
        let mut dense = vec![0.0; count];
        let mut path = Vec::new();
        let mut reach: Vec<u32> = Vec::new();
        for row in 0..count {
            if row % INTERRUPTIBLE == 0 {
                look_for_interruption();
            }
            seen[row] = row as u32;
            reach.clear();
            for &(column, edge) in pattern.row(row) {
                dense[column as usize] += edges[edge as usize];
                let mut column = column;
                path.clear();
                while seen[column as usize] != row as u32 {
                    seen[column as usize] = row as u32;
                    path.push(column);
                    column = pattern.parents[column as usize];
                }
                // Read from its end, `reach` has every column before the column's ancestors.
                reach.extend(path.iter().rev());
            }
            let mut pivot = diagonal[pattern.vertices[row] as usize];
            for &column in reach.iter().rev() {
                let column = column as usize;
                let entry = std::mem::take(&mut dense[column]);
                let range = pattern.column_offsets[column]..ends[column];
                for (&below, &value) in rows[range.clone()].iter().zip(&values[range]) {
                    dense[below as usize] -= value * entry;
                }
                let value = entry / pivots[column];
                pivot -= value * entry;
                rows[ends[column]] = row as u32;
                values[ends[column]] = value;
                ends[column] += 1;
            }
            if !(pivot > 0.0 && pivot.is_finite()) {
                return None;
            }
            pivots[row] = pivot;
        }
        Some(Self {
            rows,
            values,
            reciprocals: pivots.iter().map(|pivot| pivot.recip()).collect(),
            vector: Vec::new(),
        })
    }

    /// Replaces `vector`, which has `stride` numbers per vertex, by `A⁻¹` times it, separately for
    /// each of these numbers.
    pub(crate) fn solve(&mut self, pattern: &Pattern, vector: &mut [f64], stride: usize) {
        if stride == 3 {
            return self.solve_parts::<3>(pattern, vector, stride, 0);
        }
        for part in 0..stride {
            self.solve_parts::<1>(pattern, vector, stride, part);
        }
    }

    /// Solves for N consecutive numbers of each vertex, the first of which has the index `part`.
    fn solve_parts<const N: usize>(
        &mut self,
        pattern: &Pattern,
        field: &mut [f64],
        stride: usize,
        part: usize,
    ) {
        let Self {
            rows,
            values,
            reciprocals,
            vector,
        } = self;
        let count = reciprocals.len();
        vector.resize(N * count, 0.0);
        let (vector, _) = vector.as_chunks_mut::<N>();
        for (entry, &vertex) in vector.iter_mut().zip(&pattern.vertices) {
            entry.copy_from_slice(&field[stride * vertex as usize + part..][..N]);
        }
        let column_of = |column: usize| {
            let range = pattern.column_offsets[column]..pattern.column_offsets[column + 1];
            (&rows[range.clone()], &values[range])
        };
        for column in 0..count {
            let entry = vector[column];
            let (rows, values) = column_of(column);
            for (&row, &value) in rows.iter().zip(values) {
                let below = &mut vector[row as usize];
                for part in 0..N {
                    below[part] -= value * entry[part];
                }
            }
        }
        for column in (0..count).rev() {
            let mut entry = vector[column].map(|entry| entry * reciprocals[column]);
            let (rows, values) = column_of(column);
            for (&row, &value) in rows.iter().zip(values) {
                let below = vector[row as usize];
                for part in 0..N {
                    entry[part] -= value * below[part];
                }
            }
            vector[column] = entry;
        }
        for (entry, &vertex) in vector.iter().zip(&pattern.vertices) {
            field[stride * vertex as usize + part..][..N].copy_from_slice(entry);
        }
    }
}

/// An elimination order with little fill. The middle level set around a peripheral vertex divides
/// the mesh and is eliminated last; the parts are divided in the same way.
struct Dissection<'a> {
    mesh: &'a TriangleMesh,
    /// The set to which a vertex belongs until it is numbered.
    sets: Vec<u32>,
    set_count: u32,
    levels: Vec<u32>,
    vertices: Vec<u32>,
}

impl<'a> Dissection<'a> {
    fn new(mesh: &'a TriangleMesh) -> Self {
        let count = mesh.vertex_count();
        let mut dissection = Self {
            mesh,
            sets: vec![0; count],
            set_count: 1,
            levels: vec![NONE; count],
            vertices: Vec::with_capacity(count),
        };
        dissection.dissect((0..count as u32).collect());
        dissection
    }

    /// Gives a new number to the set of these vertices.
    fn name(&mut self, vertices: &[u32]) -> u32 {
        let set = self.set_count;
        self.set_count += 1;
        for &vertex in vertices {
            self.sets[vertex as usize] = set;
        }
        set
    }

    /// The vertices of the set that can be reached from `start`, in breadth-first order; sets their
    /// levels.
    fn spread(&mut self, start: u32, set: u32, members: &[u32]) -> Vec<u32> {
        for &vertex in members {
            self.levels[vertex as usize] = NONE;
        }
        self.levels[start as usize] = 0;
        let mut reached = vec![start];
        let mut next = 0;
        while let Some(&vertex) = reached.get(next) {
            next += 1;
            for &neighbour in self.mesh.one_ring(vertex as usize) {
                let neighbour_at = neighbour as usize;
                if self.sets[neighbour_at] == set && self.levels[neighbour_at] == NONE {
                    self.levels[neighbour_at] = self.levels[vertex as usize] + 1;
                    reached.push(neighbour);
                }
            }
        }
        reached
    }

    fn dissect(&mut self, mut members: Vec<u32>) {
        while members.len() > LEAF {
            let set = self.name(&members);
            let first = self.spread(members[0], set, &members);
            let far_out = first.last().copied().unwrap_or(members[0]);
            let reached = self.spread(far_out, set, &members);
            if reached.len() < members.len() {
                let levels = &self.levels;
                members.retain(|&vertex| levels[vertex as usize] == NONE);
                self.dissect(reached);
                continue;
            }
            let Some(middle) = self.middle_level(&reached) else {
                break;
            };
            let (mut near, mut separator, mut far) = (Vec::new(), Vec::new(), Vec::new());
            for vertex in reached {
                let level = self.levels[vertex as usize];
                let ring = self.mesh.one_ring(vertex as usize);
                let divides = || {
                    let beyond = |&neighbour: &u32| {
                        self.sets[neighbour as usize] == set
                            && self.levels[neighbour as usize] == middle + 1
                    };
                    ring.iter().any(beyond)
                };
                if level > middle {
                    far.push(vertex);
                } else if level == middle && divides() {
                    separator.push(vertex);
                } else {
                    near.push(vertex);
                }
            }
            self.dissect(near);
            self.dissect(far);
            members = separator;
            break;
        }
        self.name(&members);
        self.vertices.append(&mut members);
    }

    /// The smallest level among those that leave a third of the vertices on either side; `None` if
    /// there are too few levels to divide anything.
    fn middle_level(&self, reached: &[u32]) -> Option<u32> {
        let depth = self.levels[*reached.last()? as usize];
        if depth < 2 {
            return None;
        }
        let mut sizes = vec![0usize; depth as usize + 1];
        for &vertex in reached {
            sizes[self.levels[vertex as usize] as usize] += 1;
        }
        let mut before = 0;
        let mut best: Option<(usize, u32)> = None;
        for (level, &size) in sizes.iter().enumerate().take(depth as usize) {
            let balanced = 3 * before >= reached.len() && 3 * (before + size) <= 2 * reached.len();
            if level > 0 && balanced && best.is_none_or(|(smallest, _)| size < smallest) {
                best = Some((size, level as u32));
            }
            before += size;
        }
        let half = self.levels[reached[reached.len() / 2] as usize];
        Some(best.map_or(half.clamp(1, depth - 1), |(_, level)| level))
    }
}

#[cfg(test)]
mod tests {
    use super::{Factor, Pattern};
    use helfrich_mesh::generate::{AnyShape, Family, generate};

    /// `A x` for a matrix with one number per vertex and one per edge.
    fn product(edges: &[[u32; 2]], diagonal: &[f64], off: &[f64], x: &[f64]) -> Vec<f64> {
        let mut result: Vec<f64> = diagonal.iter().zip(x).map(|(d, x)| d * x).collect();
        for (&[a, b], &value) in edges.iter().zip(off) {
            result[a as usize] += value * x[b as usize];
            result[b as usize] += value * x[a as usize];
        }
        result
    }

    #[test]
    fn solves_what_it_factorised() {
        let shape: AnyShape = "sphere".parse().expect("a shape");
        for (family, vertices) in [
            (Family::Regular, 12),
            (Family::Regular, 642),
            (Family::Irregular, 700),
        ] {
            let mesh = generate(&shape, family, vertices, 1).expect("a mesh").mesh;
            let edges = mesh.edges();
            // Any numbers that leave the matrix positive definite.
            let off: Vec<f64> = (0..edges.len()).map(|k| -1.0 - (k % 7) as f64).collect();
            let mut diagonal = vec![0.5; vertices];
            for (&[a, b], &value) in edges.iter().zip(&off) {
                diagonal[a as usize] -= value;
                diagonal[b as usize] -= value;
            }
            let pattern = Pattern::new(&mesh);
            let mut factor = Factor::new(&pattern, &diagonal, &off).expect("positive definite");
            let x: Vec<f64> = (0..vertices).map(|v| ((v * v) % 17) as f64 - 8.0).collect();
            let mut solution = product(edges, &diagonal, &off, &x);
            factor.solve(&pattern, &mut solution, 1);
            for (found, expected) in solution.iter().zip(&x) {
                assert!((found - expected).abs() < 1e-9, "{found} {expected}");
            }
            // A band matrix of this size would have V √V entries and more.
            assert!(pattern.fill() < 25 * vertices, "{}", pattern.fill());
            diagonal[vertices / 2] = -1.0;
            assert!(Factor::new(&pattern, &diagonal, &off).is_none());
        }
    }
}
