//! External forces that do not depend on the shape.

use crate::element::Execution;
use crate::mesh::{TriangleMesh, VertexKind};
use crate::method::{Conservative, Energy, Force, Method, ParameterError, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, dot, normalise, scale, sub};
use alloc::vec::Vec;

/// Constant forces F_i on some vertices: `E = −Σ F_i·(x_i − x_level)`.
///
/// The energy is measured from the point `level`, which is the origin unless [`Self::with_level`]
/// sets another one. If the forces sum to zero, the energy does not depend on the level and is
/// computed from differences of positions alone, so that a translation changes neither forces nor
/// energy.
///
/// The surroundings exert these forces on the membrane, so ΣF and Σ x × F need not be zero.
///
/// ```
/// use helfrich::{PointLoads, Prepared, Surface, TriangleMesh};
///
/// let mesh = TriangleMesh::new(4, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.2, 1.0, 0.0], [0.3, 0.0, 1.0]];
/// let surface = Surface::new(&mesh, &points)?;
///
/// // A quarter of the vertices at each end along x, pulled apart with a force of 3.
/// let loads = PointLoads::opposite_ends(surface, [1.0, 0.0, 0.0], 0.25, 3.0)?;
/// assert_eq!(loads.loads(), [(1, [3.0, 0.0, 0.0]), (0, [-3.0, 0.0, 0.0])]);
/// assert_eq!(Prepared::new(loads, &mesh).energy(surface), -3.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PointLoads<T> {
    loads: Vec<(u32, Vec3<T>)>,
    /// ΣF.
    sum: Vec3<T>,
    level: Vec3<T>,
    vertices: usize,
}

/// The reason why forces cannot act on a surface.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// A force acts on a vertex that does not exist.
    #[error(
        "load {load} names vertex {vertex}, but there are {vertices} vertices, numbered from 0"
    )]
    VertexOutOfRange {
        /// The load, from 0.
        load: usize,
        /// The vertex that it names.
        vertex: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// A force is NaN or infinite.
    #[error("the force of load {load} is not finite")]
    NotFinite {
        /// The load, from 0.
        load: usize,
    },
    /// The direction of a pull has no length, or is not finite.
    #[error("the direction of the pull must be a finite vector other than zero")]
    NoDirection,
    /// Each end would have less than one vertex, or the two ends would have vertices in common.
    #[error(
        "a fraction of {fraction} of {vertices} vertices at each end is {found}: at least one \
         vertex, and at most half of them, is needed"
    )]
    Fraction {
        /// The fraction.
        fraction: f64,
        /// Number of vertices that are in a triangle.
        vertices: usize,
        /// Number of vertices that an end would have.
        found: f64,
    },
}

impl<T: Real> PointLoads<T> {
    /// The given forces on the given vertices of a mesh; forces on the same vertex add up.
    ///
    /// Preparing them for a mesh with another number of vertices panics.
    ///
    /// # Errors
    /// If a vertex does not exist or a force is not finite.
    pub fn new(mesh: &TriangleMesh, loads: Vec<(u32, [T; 3])>) -> Result<Self, LoadError> {
        let vertices = mesh.vertex_count();
        let mut sum = [T::zero(); 3];
        for (load, &(vertex, force)) in loads.iter().enumerate() {
            if vertex as usize >= vertices {
                return Err(LoadError::VertexOutOfRange {
                    load,
                    vertex,
                    vertices,
                });
            }
            if force.iter().any(|f| !f.is_finite()) {
                return Err(LoadError::NotFinite { load });
            }
            sum = add(sum, force);
        }
        Ok(Self {
            loads,
            sum,
            level: [T::zero(); 3],
            vertices,
        })
    }

    /// Opposite forces at the two ends of a surface, as optical tweezers pull a cell: the vertices
    /// that lie farthest along `direction` share `force` equally, and as many vertices at the
    /// opposite end share the opposite force. A negative force pushes.
    ///
    /// An end has `fraction` of the vertices that are in a triangle, rounded to the nearest number:
    /// 0.05, say, for the beads of J. P. Mills, L. Qie, M. Dao, C. T. Lim and S. Suresh, Mech. Chem.
    /// Biosyst. 1 (2004) 169. Among vertices at the same distance, lower numbers count as farther
    /// back. The ends are determined on this surface: when it moves, the same vertices stay loaded,
    /// in the same direction.
    ///
    /// # Errors
    /// If the direction has no length, the force is not finite, or the fraction leaves an end
    /// without vertices or gives both the same ones.
    pub fn opposite_ends(
        surface: Surface<'_, T>,
        direction: [T; 3],
        fraction: T,
        force: T,
    ) -> Result<Self, LoadError> {
        let mesh = surface.mesh();
        // The direction is scaled first, so that no square over- or underflows.
        let longest = direction
            .iter()
            .fold(T::zero(), |most, x| most.max(x.abs()));
        if !(direction.iter().all(|x| x.is_finite()) && longest > T::zero()) {
            return Err(LoadError::NoDirection);
        }
        let direction = normalise(direction.map(|x| x / longest));
        let used = |&vertex: &u32| mesh.vertex_kind(vertex as usize) != VertexKind::Isolated;
        let mut order = Vec::from_iter((0..mesh.vertex_count() as u32).filter(used));
        let vertices = order.len();
        let found = (fraction * T::constant(vertices as f64)).round();
        let count = found.to_usize().unwrap_or(0);
        if !(1..=vertices / 2).contains(&count) {
            let double = |x: T| x.to_f64().unwrap_or(f64::NAN);
            return Err(LoadError::Fraction {
                fraction: double(fraction),
                vertices,
                found: double(found),
            });
        }
        let first = order[0];
        let height = |vertex: u32| dot(direction, surface.difference(first, vertex));
        // The sort is stable: vertices at the same distance stay in the order of their numbers.
        order.sort_by(|&a, &b| {
            let heights = height(a).partial_cmp(&height(b));
            heights.unwrap_or(core::cmp::Ordering::Equal)
        });
        let pull = scale(force / T::constant(count as f64), direction);
        let push = pull.map(|f| -f);
        // Loads are listed in opposite pairs, so that their sum is exactly zero.
        let (back, front) = (&order[..count], &order[vertices - count..]);
        let pair = |(&front, &back)| [(front, pull), (back, push)];
        Self::new(mesh, front.iter().zip(back).flat_map(pair).collect())
    }

    /// The same loads with the energy measured from the point `level`.
    pub fn with_level(mut self, level: [T; 3]) -> Self {
        self.level = level;
        self
    }

    /// The loaded vertices and the forces on them.
    pub fn loads(&self) -> &[(u32, [T; 3])] {
        &self.loads
    }
}

impl<T: Real> Method<T> for PointLoads<T> {
    type Memory = ();

    /// # Panics
    /// If the loads are for another number of vertices.
    fn memory(&self, mesh: &TriangleMesh) {
        assert!(
            self.vertices == mesh.vertex_count(),
            "the loads are for {} vertices, this mesh has {}",
            self.vertices,
            mesh.vertex_count()
        );
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_all_finite("sum of the loads", self.sum)?;
        ParameterError::unless_all_finite("level of the loads", self.level)
    }
}

impl<T: Real> Energy<T> for PointLoads<T> {
    /// `−Σ F_i·(x_i − x_a) − ΣF·(x_a − x_level)`, a the first loaded vertex.
    fn energy(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
    ) -> T {
        workspace.for_mesh(surface.mesh());
        let Some(&(first, _)) = self.loads.first() else {
            return T::zero();
        };
        let work = execution.sum(self.loads.len(), |load| {
            let (vertex, force) = self.loads[load];
            dot(force, surface.difference(first, vertex))
        });
        let mut above = sub(surface.positions()[first as usize], self.level);
        if let Some(remainders) = surface.remainders() {
            above = add(above, remainders[first as usize]);
        }
        -(work + dot(self.sum, above))
    }
}

impl<T: Real> Force<T> for PointLoads<T> {
    fn add_force(
        &self,
        _execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        force: &mut [[T; 3]],
    ) {
        workspace.for_mesh(surface.mesh());
        for &(vertex, load) in &self.loads {
            let force = &mut force[vertex as usize];
            *force = add(*force, load);
        }
    }
}

impl<T: Real> Conservative<T> for PointLoads<T> {}
