//! Pull on the two ends of a surface.

use crate::adhesion::PotentialForce;
use crate::element::{Corners, Execution};
use crate::mesh::TriangleMesh;
use crate::method::{Method, ParameterError, TwoPass, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::dot;
use alloc::vec::Vec;

/// Opposite forces on the two ends of a surface, constant or those of a spring:
/// `E = k/2 (d − L)² − F (d − L)`, with the distance of the ends along the unit vector a
///
/// ```text
/// d = ℓ ln (∫ exp(a·x/ℓ) dS / (2π ℓ²)) + ℓ′ ln (∫ exp(−a·x/ℓ′) dS / (2π ℓ′²)).
/// ```
///
/// The integrals weigh the outermost layers of thickness ℓ and ℓ′: where ends are spheres of radii R and R′, d is the distance
/// of the outermost points plus `ℓ ln(R/ℓ) + ℓ′ ln(R′/ℓ′)`, for ℓ and ℓ′ far below them. Forces are the exact gradient, and
/// their sum over an end is `F − k (d − L)`, because d grows by t where one end moves by t.
///
/// Unlike [`PointLoads`](crate::PointLoads), it knows no vertices: the force does not change where these move along the
/// surface or the mesh is another, and has no part along the surface but for the error of the triangles. So it pulls tethers
/// from fluid membranes, of which forces along the surface would only drag vertices away. The integral over a triangle is its
/// area times the mean of the corners, so edges at the ends have to be shorter than √(R ℓ).
///
/// ```
/// use helfrich::{EndPull, Serial, Surface, TriangleMesh, Method, Force};
///
/// let mesh = TriangleMesh::new(4, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.2, 1.0, 0.0], [0.3, 0.0, 1.0]];
/// let surface = Surface::new(&mesh, &points)?;
///
/// let pull = EndPull { axis: [1.0, 0.0, 0.0], depths: [0.1; 2], force: 2.0, stiffness: 0.0, length: 0.0 };
/// let mut force = [[0.0; 3]; 4];
/// pull.add_force(&Serial, surface, &mut pull.workspace(&mesh), &mut force);
/// // One end is vertex 1.
/// assert!(force[1][0] > 1.5 && force[1][0] < 2.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndPull<T> {
    /// The unit vector a.
    pub axis: [T; 3],
    /// Thicknesses ℓ and ℓ′, above 0, of the layers that are the ends ahead and behind along the axis.
    pub depths: [T; 2],
    /// Force F that drives the ends apart at the distance L.
    pub force: T,
    /// Stiffness k, force per length; 0 for a constant force.
    pub stiffness: T,
    /// Distance L.
    pub length: T,
}

/// Memory of [`EndPull`].
#[derive(Clone, Debug)]
pub struct EndPullMemory<T> {
    /// V and −V′ along the axis at each vertex: the energy per area of which forces are the gradient.
    potentials: Vec<[T; 2]>,
    distance: T,
}

impl<T: Real> EndPull<T> {
    /// The force `F − k (d − L)` on each end of the surface of the last evaluation, and the distance d of the ends; NaN
    /// before the first.
    pub fn measured(&self, workspace: &Workspace<T, Self>) -> (T, T) {
        let distance = workspace.memory().distance;
        (self.at(distance), distance)
    }

    fn at(&self, distance: T) -> T {
        self.force - self.stiffness * (distance - self.length)
    }
}

impl<T: Real> Method<T> for EndPull<T> {
    type Memory = EndPullMemory<T>;
    const NEEDS_AREAS: bool = true;

    fn memory(&self, _mesh: &TriangleMesh) -> EndPullMemory<T> {
        EndPullMemory {
            potentials: Vec::new(),
            distance: T::nan(),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_all_finite("axis of the pull", self.axis)?;
        for depth in self.depths {
            ParameterError::unless_finite("depth of an end", depth)?;
            ParameterError::unless_finite("inverse depth of an end", depth.recip())?;
        }
        ParameterError::unless_finite("pulling force", self.force)?;
        ParameterError::unless_finite("stiffness of the pull", self.stiffness)?;
        ParameterError::unless_finite("length of the pull", self.length)
    }
}

impl<T: Real> TwoPass for EndPull<T> {
    type Scalar = T;

    fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut EndPullMemory<T>,
    ) {
        let triangles = surface.mesh().triangles();
        let potentials = &mut memory.potentials;
        potentials.resize(surface.positions().len(), [T::zero(); 2]);
        let Some(&[first, ..]) = triangles.first() else {
            memory.distance = T::zero();
            return;
        };
        let height = |vertex: u32| dot(self.axis, surface.difference(first, vertex));
        // Only vertices of triangles count.
        let ends = triangles.iter().flatten().map(|&vertex| height(vertex));
        let [bottom, top] = ends.fold([T::zero(); 2], |[low, high], height| {
            [low.min(height), high.max(height)]
        });
        execution.map(&mut potentials[..], |vertex, weights| {
            let height = height(vertex as u32);
            let [ahead, behind] = self.depths;
            let inwards = [(height - top) / ahead, (bottom - height) / behind];
            *weights = inwards.map(|inwards| inwards.min(T::zero()).exp());
        });
        let weighed = |end: usize| {
            execution.sum(triangles.len(), |at| {
                let triangle = triangles[at];
                let [a, b, c] = triangle.map(|vertex| potentials[vertex as usize][end]);
                let corners = Corners::<T, 3>::of(surface, triangle);
                T::constant(1.0 / 6.0) * corners.triangle().doubled_area * (a + b + c)
            })
        };
        let areas = [0, 1].map(weighed);
        let beyond = |end: usize| {
            let depth = self.depths[end];
            depth * (areas[end] / (T::constant(core::f64::consts::TAU) * depth * depth)).ln()
        };
        memory.distance = top - bottom + beyond(0) + beyond(1);
        let pull = self.at(memory.distance);
        execution.map(&mut potentials[..], |_, weights| {
            let [ahead, behind] = [weights[0] / areas[0], weights[1] / areas[1]];
            *weights = [
                -pull * (self.depths[0] * ahead + self.depths[1] * behind),
                pull * (ahead - behind),
            ];
        });
    }

    fn measured_energy(
        &self,
        _execution: &impl Execution,
        _surface: Surface<'_, T>,
        memory: &mut EndPullMemory<T>,
    ) -> T {
        let longer = memory.distance - self.length;
        (T::constant(0.5) * self.stiffness * longer - self.force) * longer
    }

    fn add_measured_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut EndPullMemory<T>,
        force: &mut [[T; 3]],
    ) {
        let kernel = PotentialForce {
            direction: self.axis,
        };
        let triangles = surface.mesh().triangles();
        execution.scatter(&kernel, surface, triangles, &memory.potentials, force);
    }
}
