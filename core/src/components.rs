//! Connected components of a mesh.

use crate::mesh::TriangleMesh;
use crate::real::Real;
use crate::surface::Surface;
use alloc::vec;
use alloc::vec::Vec;

/// The connected component of each vertex.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Components {
    of_vertex: Vec<u32>,
    count: usize,
}

/// Receives the fraction of some work that is done; false ends it.
type Watch<'a> = &'a mut dyn FnMut(f64) -> bool;

/// A function that measures a component: see [`Components::each`].
type Measure<'f, T, R> = dyn FnMut(Surface<'_, T>, &[u32], Watch<'_>) -> Option<Vec<R>> + 'f;

impl Components {
    /// The components of a mesh.
    pub fn new(mesh: &TriangleMesh) -> Self {
        let (of_vertex, count) = mesh.components();
        Self { of_vertex, count }
    }

    /// Number of components; an isolated vertex is a component of its own.
    #[inline]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The component of each vertex. Components are numbered from 0 in the order of their lowest
    /// vertices.
    #[inline]
    pub fn of_vertex(&self) -> &[u32] {
        &self.of_vertex
    }

    /// The results of all components of a surface, each measured alone by `measure`, which receives the component,
    /// the numbers of its vertices, and `watch` for the fraction of its work that is done; isolated vertices have
    /// the result `nothing`. `None` if `measure` returned it.
    ///
    /// # Panics
    /// If `measure` returns another number of results than there are vertices.
    pub fn each<T: Real, R: Clone>(
        surface: Surface<'_, T>,
        nothing: R,
        watch: Watch<'_>,
        measure: &mut Measure<'_, T, R>,
    ) -> Option<Vec<R>> {
        let count = surface.mesh().vertex_count();
        let components = Self::new(surface.mesh());
        if components.count() == 1 {
            return measure(surface, &Vec::from_iter(0..count as u32), watch);
        }
        let mut all = vec![nothing; count];
        let mut done = 0;
        for part in components.parts(surface) {
            let share = part.vertices().len();
            if let Some(surface) = part.surface() {
                let fraction = |of_part: f64| (done as f64 + of_part * share as f64) / count as f64;
                let mut watch = |of_part: f64| watch(fraction(of_part));
                let results = measure(surface, part.vertices(), &mut watch)?;
                assert_eq!(results.len(), share, "a result for each vertex");
                for (&vertex, result) in part.vertices().iter().zip(results) {
                    all[vertex as usize] = result;
                }
            }
            done += share;
        }
        watch(1.0).then_some(all)
    }

    /// The components of a surface as surfaces of their own, each with its vertices and triangles in the order
    /// of the whole.
    ///
    /// # Panics
    /// If these are the components of another mesh.
    pub fn parts<T: Real>(&self, surface: Surface<'_, T>) -> Vec<Part<T>> {
        let mut vertices = vec![Vec::new(); self.count];
        let mut numbers = Vec::with_capacity(self.of_vertex.len());
        for (vertex, &component) in (0..).zip(&self.of_vertex) {
            let own: &mut Vec<u32> = &mut vertices[component as usize];
            numbers.push(own.len() as u32);
            own.push(vertex);
        }
        let mut triangles = vec![Vec::new(); self.count];
        for corners in surface.mesh().triangles() {
            let component = self.of_vertex[corners[0] as usize] as usize;
            triangles[component].push(corners.map(|vertex| numbers[vertex as usize]));
        }
        let parts = vertices.into_iter().zip(triangles);
        let part = |(vertices, triangles): (Vec<u32>, Vec<[u32; 3]>)| {
            let of = |values: &[[T; 3]]| {
                let values = vertices.iter().map(|&vertex| values[vertex as usize]);
                Vec::from_iter(values)
            };
            // An isolated vertex is no mesh.
            let mesh = (!triangles.is_empty()).then(|| {
                let mesh = TriangleMesh::new(vertices.len(), triangles);
                mesh.expect("a component of a mesh is a mesh")
            });
            Part {
                mesh,
                positions: of(surface.positions()),
                remainders: surface.remainders().map(of),
                vertices,
            }
        };
        parts.map(part).collect()
    }
}

/// A connected component of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Part<T> {
    mesh: Option<TriangleMesh>,
    positions: Vec<[T; 3]>,
    remainders: Option<Vec<[T; 3]>>,
    vertices: Vec<u32>,
}

impl<T: Real> Part<T> {
    /// The component as a surface; `None` for an isolated vertex.
    pub fn surface(&self) -> Option<Surface<'_, T>> {
        let mesh = self.mesh.as_ref()?;
        Some(Surface::of_checked(
            mesh,
            &self.positions,
            self.remainders.as_deref(),
        ))
    }

    /// The number of each of its vertices on the whole surface, in ascending order.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }
}
