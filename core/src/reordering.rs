//! Vertex orders in which nearby vertices have nearby numbers.
//!
//! E. Cuthill and J. McKee, Proc. 24th Nat. Conf. ACM (1969) 157; reversed after A. George, 1971.

use crate::diagnostic::Finding;
use crate::mesh::{MeshError, TriangleMesh};
use crate::real::Real;
use crate::surface::Surface;
use alloc::vec::Vec;

/// Another order of the vertices and triangles of a mesh, and its inverse.
///
/// Loops over elements read and write at the vertices of each element. On large meshes these loops
/// are fast if the vertices are close together in memory, and can be divided among threads if
/// ranges of vertices share few elements.
///
/// ```
/// use helfrich::{Reordering, TriangleMesh};
///
/// // A strip of triangles whose vertices were numbered at random.
/// let mesh = TriangleMesh::new(6, vec![[0, 4, 2], [4, 1, 2], [2, 1, 5], [1, 3, 5]])?;
/// let order = Reordering::reverse_cuthill_mckee(&mesh);
/// let ordered = order.of_mesh(&mesh)?;
/// let widest = |mesh: &TriangleMesh| mesh.edges().iter().map(|[a, b]| a.abs_diff(*b)).max();
/// assert_eq!((widest(&mesh), widest(&ordered)), (Some(4), Some(2)));
///
/// let heights = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5];
/// assert_eq!(order.undo(&order.apply(&heights)), heights);
/// # Ok::<(), helfrich::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reordering {
    /// The old number of each vertex.
    vertices: Vec<u32>,
    /// The new number of each vertex.
    places: Vec<u32>,
    /// The old number of each triangle.
    triangles: Vec<u32>,
}

impl Reordering {
    /// The reverse Cuthill–McKee order: component by component, each in breadth-first order from a
    /// peripheral vertex, reversed. Triangles are sorted by their lowest vertex.
    pub fn reverse_cuthill_mckee(mesh: &TriangleMesh) -> Self {
        let count = mesh.vertex_count();
        let mut search = Search {
            mesh,
            reached: alloc::vec![0; count],
            number: 0,
            neighbours: Vec::new(),
        };
        let mut placed = alloc::vec![false; count];
        let (mut vertices, mut component) = (Vec::with_capacity(count), Vec::new());
        for vertex in 0..count as u32 {
            if placed[vertex as usize] {
                continue;
            }
            // The vertex that is reached last is peripheral; a search from there ends at one that is
            // farther still.
            let mut start = vertex;
            for _ in 0..3 {
                search.around(start, &mut component);
                start = component[component.len() - 1];
            }
            for &vertex in &component {
                placed[vertex as usize] = true;
            }
            vertices.extend_from_slice(&component);
        }
        vertices.reverse();
        let mut places = alloc::vec![0; count];
        for (place, &vertex) in vertices.iter().enumerate() {
            places[vertex as usize] = place as u32;
        }
        let mut triangles = Vec::from_iter(0..mesh.triangles().len() as u32);
        triangles.sort_by_cached_key(|&triangle| {
            let mut corners = mesh.triangles()[triangle as usize].map(|v| places[v as usize]);
            corners.sort_unstable();
            corners
        });
        Self {
            vertices,
            places,
            triangles,
        }
    }

    /// The mesh in this order.
    ///
    /// # Errors
    /// If the order was made for a mesh with other triangles.
    ///
    /// # Panics
    /// If the mesh has fewer vertices or triangles than the order.
    pub fn of_mesh(&self, mesh: &TriangleMesh) -> Result<TriangleMesh, MeshError> {
        let corners = |&triangle: &u32| {
            mesh.triangles()[triangle as usize].map(|vertex| self.places[vertex as usize])
        };
        TriangleMesh::new(
            self.vertices.len(),
            self.triangles.iter().map(corners).collect(),
        )
    }

    /// The old number of each vertex.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// The old number of each triangle.
    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// Values at the vertices, in this order.
    ///
    /// # Panics
    /// If there are fewer values than vertices.
    pub fn apply<V: Copy>(&self, values: &[V]) -> Vec<V> {
        let old = self.vertices.iter();
        old.map(|&vertex| values[vertex as usize]).collect()
    }

    /// Values at the triangles, in this order.
    ///
    /// # Panics
    /// If there are fewer values than triangles.
    pub fn apply_to_triangles<V: Copy>(&self, values: &[V]) -> Vec<V> {
        let old = self.triangles.iter();
        old.map(|&triangle| values[triangle as usize]).collect()
    }

    /// A surface in this order. `mesh` is its mesh in this order, see [`Self::of_mesh`]; its positions
    /// are copied to `positions` and `remainders`, whose memory is reused.
    ///
    /// # Panics
    /// If the surface or `mesh` has another number of vertices than the order.
    pub fn of_surface<'a, T: Real>(
        &self,
        surface: Surface<'_, T>,
        mesh: &'a TriangleMesh,
        positions: &'a mut Vec<[T; 3]>,
        remainders: &'a mut Vec<[T; 3]>,
    ) -> Surface<'a, T> {
        let take = |values: &[[T; 3]], taken: &mut Vec<[T; 3]>| {
            assert_eq!(values.len(), self.vertices.len(), "vertices of the order");
            taken.clear();
            let old = self.vertices.iter();
            taken.extend(old.map(|&vertex| values[vertex as usize]));
        };
        take(surface.positions(), positions);
        let remainders = surface.remainders().map(|values| {
            take(values, remainders);
            &remainders[..]
        });
        Surface::of_checked(mesh, positions, remainders)
    }

    /// A finding about a surface in this order, with the numbers of the original mesh.
    ///
    /// # Panics
    /// If there is no such vertex or triangle.
    pub fn undo_finding(&self, mut finding: Finding) -> Finding {
        match &mut finding {
            Finding::ZeroArea { vertex }
            | Finding::NegativeArea { vertex }
            | Finding::SmallArea { vertex }
            | Finding::ClampedArea { vertex }
            | Finding::ReducedDegree { vertex, .. }
            | Finding::TooFewNeighbours { vertex }
            | Finding::Amplified { vertex }
            | Finding::NoGraph { vertex }
            | Finding::Unresolved { vertex }
            | Finding::Rows { vertex }
            | Finding::Crease { vertex }
            | Finding::Outlier { vertex }
            | Finding::SmallComponent { vertex }
            | Finding::Grid { vertex }
            | Finding::Uneven { vertex }
            | Finding::UnusualValence { vertex }
            | Finding::Folded { vertex }
            | Finding::OutOfRange { vertex }
            | Finding::RoundedPosition { vertex }
            | Finding::NoisyPosition { vertex } => *vertex = self.vertices[*vertex as usize],
            Finding::DegenerateTriangle { triangle }
            | Finding::Overstretched { triangle }
            | Finding::ThinTriangle { triangle } => {
                *triangle = self.triangles[*triangle as usize];
            }
        }
        finding
    }

    /// Values in the order of the original mesh, from values in this order.
    ///
    /// # Panics
    /// If there are fewer values than vertices.
    pub fn undo<V: Copy>(&self, values: &[V]) -> Vec<V> {
        let new = self.places.iter();
        new.map(|&place| values[place as usize]).collect()
    }
}

/// Searches ring after ring.
struct Search<'a> {
    mesh: &'a TriangleMesh,
    /// The search that reached each vertex last.
    reached: Vec<u32>,
    number: u32,
    neighbours: Vec<u32>,
}

impl Search<'_> {
    /// Sets `order` to the component of `start` in breadth-first order; neighbours with few neighbours
    /// come before those with many.
    fn around(&mut self, start: u32, order: &mut Vec<u32>) {
        self.number += 1;
        self.reached[start as usize] = self.number;
        order.clear();
        order.push(start);
        let mut next = 0;
        while let Some(&vertex) = order.get(next) {
            next += 1;
            self.neighbours.clear();
            for &neighbour in self.mesh.one_ring(vertex as usize) {
                if self.reached[neighbour as usize] != self.number {
                    self.reached[neighbour as usize] = self.number;
                    self.neighbours.push(neighbour);
                }
            }
            let mesh = self.mesh;
            self.neighbours
                .sort_unstable_by_key(|&v| (mesh.valence(v as usize), v));
            order.extend_from_slice(&self.neighbours);
        }
    }
}
