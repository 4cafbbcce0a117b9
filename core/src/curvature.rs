//! Curvatures at vertices.

use crate::element::Execution;
use crate::mesh::VertexKind;
use crate::method::{Method, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::cross;
use num_traits::Float;

/// Normal, curvatures and area of a surface at one vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Curvature<T> {
    /// Outward unit normal n; 0 at a vertex where it is undefined.
    pub normal: [T; 3],
    /// Mean curvature H = (c₁ + c₂)/2, positive on a sphere.
    pub mean: T,
    /// Gaussian curvature K = c₁ c₂.
    pub gaussian: T,
    /// Unit tangent vector along which the surface has its larger principal curvature, of either sign; 0 where both
    /// are equal, and for methods that determine no directions. Near umbilics errors of positions turn it.
    pub direction: [T; 3],
    /// The area that belongs to the vertex: K and H are averages over it.
    pub area: T,
    /// Interior, boundary or isolated. Operators that need a full ring of triangles define H and K at
    /// interior vertices only, and set them to 0 elsewhere.
    pub kind: VertexKind,
}

impl<T: Real> Curvature<T> {
    /// The principal curvatures c₁ ≥ c₂, `H ± √(H² − K)`; both are H where K is larger than H² by errors.
    pub fn principal(&self) -> [T; 2] {
        let root = (self.mean * self.mean - self.gaussian).max(T::zero());
        let root = Float::sqrt(root);
        [self.mean + root, self.mean - root]
    }

    /// The unit vectors along which the surface has the principal curvatures c₁ and c₂, with a normal a right-handed
    /// frame; `None` where [`Self::direction`] is 0.
    pub fn directions(&self) -> Option<[[T; 3]; 2]> {
        let first = self.direction;
        (first != [T::zero(); 3]).then(|| [first, cross(self.normal, first)])
    }
}

/// A method or operator that measures curvatures.
///
/// Laws: curvatures follow rotations, translations and relabellings; they scale as 1/length (H) and
/// 1/length² (K).
///
/// ```
/// use helfrich::{Cotangent, DualArea, Prepared, Surface, TriangleMesh};
///
/// let mesh = TriangleMesh::new(4, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let points = [[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0]];
/// let mut cotangent = Prepared::new(Cotangent::new(DualArea::Voronoi), &mesh);
/// let curvature = cotangent.curvatures(Surface::new(&mesh, &points)?);
///
/// // Inscribed in a sphere of radius √3, the mean curvature is 1/√3 on any mesh.
/// assert!(curvature.iter().all(|vertex| (vertex.mean - 1.0 / 3.0_f64.sqrt()).abs() < 1e-14));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Curvatures<T: Real>: Method<T> {
    /// Measures the surface: sets `curvature`, one entry per vertex.
    ///
    /// # Panics
    /// If `curvature` has fewer entries than the surface has vertices, or the surface another mesh
    /// than that of the workspace.
    fn curvatures(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        curvature: &mut [Curvature<T>],
    );

    /// Whether H and K are defined at boundary vertices, too.
    fn reaches_boundary(&self) -> bool {
        false
    }
}
