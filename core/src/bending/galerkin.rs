//! Method G: the bending energy of blended osculating jets, whose exact gradient converges pointwise.
//!
//! The idea of an energy of second derivatives on surfaces that are only continuous is that of C0 interior
//! penalty methods: S. C. Brenner and L.-Y. Sung, J. Sci. Comput. 22 (2005) 83. Jets, their blend, and
//! the gradient of the whole are our own.

mod basis;
mod density;
mod edges;
mod fields;
mod findings;
mod fit;
mod mass;
mod measures;
mod patch;
mod plan;
mod points;
mod polynomial;
mod shape;
mod smoothing;
mod start;
mod vertices;

use self::basis::FREE;
use self::density::Solver;
use self::edges::Edges;
use self::fields::FieldMemory;
use self::mass::Mass;
pub use self::measures::{PatchFunctional, PatchFunctionalMemory};
use self::patch::{Back, Bars, HEM, Inside, RETURNED, RIM};
use self::shape::{Return, Shape};
use self::vertices::Work;
use crate::bending::MaterialParameter;
use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::{Execution, Strided, of_vertices};
use crate::lane::{Lane, Several, WIDTH};
use crate::mesh::TriangleMesh;
use crate::method::{Method, ParameterError, TwoPass, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use alloc::vec::Vec;

/// `E = 2 ∫ κ (H − H0)² dS + Σ_e [2 ∫_e κ {H − H0} θ ds + ½ ∫_e κ θ² ds/∫_e ds]` over patches of degree 6,
/// and the exact gradient of this energy; {·} is the mean of both sides of an edge, θ the angle between
/// them.
///
/// A polynomial of degree 8 is fitted around each vertex, as in [`Jet`](crate::Jet), and interpolates the
/// vertex. The three polynomials at the corners of a triangle are blended, and the patch over the
/// triangle interpolates the blend. Neighbours are whole rings around a vertex: they follow from the
/// connectivity alone, so that the energy is a smooth function of the positions. Energy and nodal forces need
/// no solution of equations. The force density solves equations with the consistent mass matrix, which a
/// regression completes where vertices are close; forces over areas do not converge.
///
/// On meshes that resolve the surface, H, K, the energy and f converge at every vertex, whatever the
/// valences. Two vertices that are much closer to each other than to the rest amplify the error of f there.
/// f is normal to the surface: where κ or H0 vary, its tangential part is in the nodal forces only.
///
/// Only triangles with interior corners count, see [`crate::bending`]. On components with a boundary f is the strong
/// form over the jets, without a solution: the nodal forces have the natural boundary conditions, too, which a
/// solution spreads over the surface. f is 0 at a boundary and at vertices all of whose triangles have a corner
/// there, and less accurate within a few edges of them. Components of less than 5000 vertices have fits of degree 6, those of less than
/// 540 fits of lower degree, and those of less than 11 none and therefore no energy; the last two are
/// reported.
///
/// docs/GALERKIN.md has the theory, measurements and limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Galerkin<T> {
    /// Bending modulus κ, in units of energy.
    pub modulus: MaterialParameter<T>,
    /// Spontaneous curvature H0.
    pub spontaneous_curvature: MaterialParameter<T>,
    /// Residual at which the solution of the equations of the force density ends, relative to that of the
    /// strong form over the jets, with which it starts. The latter is about the error of f: with the default, 0.5,
    /// errors differ by up to 30 % from those of the whole solution, in either direction; 1 takes the strong form
    /// itself, scaled so that its residual is least.
    pub tolerance: T,
}

impl<T: Real> Galerkin<T> {
    /// The method without spontaneous curvature.
    pub fn new(modulus: T) -> Self {
        Self {
            modulus: modulus.into(),
            spontaneous_curvature: MaterialParameter::default(),
            tolerance: T::constant(0.5),
        }
    }
}

impl<T> GalerkinMemory<T> {
    /// Number of iterations of the last force density.
    pub fn iterations(&self) -> usize {
        self.solver.iterations
    }
}

/// Memory of [`Galerkin`].
#[derive(Clone, Debug)]
pub struct GalerkinMemory<T> {
    shape: Shape<T>,
    /// Bending modulus and spontaneous curvature.
    fields: [FieldMemory<T>; 2],
    energies: Vec<Several<T>>,
    edge_energies: Vec<Several<T>>,
    rims: Vec<Several<T>>,
    hems: Vec<Several<T>>,
    bars: Vec<Bars<T>>,
    back: Return<T>,
    mass: Mass<T>,
    solver: Solver<T>,
    work: Vec<Work<T>>,
    idle: Vec<()>,
}

impl<T: Real> Method<T> for Galerkin<T> {
    type Memory = GalerkinMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> GalerkinMemory<T> {
        GalerkinMemory {
            shape: Shape::new(mesh),
            fields: Default::default(),
            energies: Vec::new(),
            edge_energies: Vec::new(),
            rims: Vec::new(),
            hems: Vec::new(),
            bars: Vec::new(),
            back: Return::default(),
            mass: Mass::default(),
            solver: Solver::default(),
            work: Vec::new(),
            idle: Vec::new(),
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::unless_finite("tolerance of the force density", self.tolerance)?;
        MaterialParameter::check(&self.modulus, &self.spontaneous_curvature)
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        let mut concerns_all = false;
        let mut listening = |finding: Finding| {
            concerns_all |= findings::concerns_all(finding);
            report(finding);
        };
        surface.report_uneven_mesh(&mut listening);
        surface.report_rough_vertices(&mut listening);
        memory.shape.report_fits(&mut listening);
        memory.shape.report_rows(surface, &mut listening);
        if concerns_all {
            for vertex in 0..surface.mesh().vertex_count() as u32 {
                report(Finding::Unresolved { vertex });
            }
        } else {
            memory.report_angles(report);
        }
    }
}

impl<T: Real> Galerkin<T> {
    /// Energies of patches and edges, and with `GRADIENT` the derivatives inside patches.
    fn evaluate<const GRADIENT: bool>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut GalerkinMemory<T>,
    ) {
        let zero = Several::zero();
        memory.shape.set(execution, surface, &mut memory.work);
        let shape = &memory.shape;
        let blocks = shape.blocks();
        memory.energies.resize(blocks, zero);
        memory.rims.resize(blocks * RIM, zero);
        memory.bars.resize_with(blocks, Bars::default);
        let parameters = [&self.modulus, &self.spontaneous_curvature];
        for (field, parameter) in memory.fields.iter_mut().zip(parameters) {
            field.set(execution, surface, parameter, shape, &mut memory.work);
        }
        let material = [0, 1].map(|k| memory.fields[k].field(parameters[k]));
        let inside = Inside::<T, GRADIENT> {
            shape,
            surface,
            material,
        };
        let slots = (
            (
                &mut memory.energies[..],
                Strided::new(&mut memory.rims, RIM),
            ),
            &mut memory.bars[..],
        );
        execution.run(&mut memory.idle, slots, &inside);

        let blocks = shape.plan.hems.len().div_ceil(WIDTH);
        memory.edge_energies.resize(blocks, zero);
        memory.hems.resize(blocks * HEM, zero);
        let edges = Edges {
            plan: &shape.plan,
            basis: &shape.basis,
            rims: &memory.rims,
        };
        let slots = (
            &mut memory.edge_energies[..],
            Strided::new(&mut memory.hems, HEM),
        );
        execution.run(&mut memory.idle, slots, &edges);
    }
}

/// n, H and K of the polynomial at each vertex where it has a fit, 0 elsewhere; areas are a third of the
/// triangles around it.
impl<T: Real> Curvatures<T> for Galerkin<T> {
    fn curvatures(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        curvature: &mut [Curvature<T>],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        self.measure(execution, surface, memory);
        memory.shape.set_jets(execution);
        let shape = &memory.shape;
        execution.map(of_vertices(surface, curvature), |vertex, curvature| {
            *curvature = Curvature {
                normal: shape.normals[vertex],
                area: shape.sums[vertex][3] / T::constant(3.0),
                kind: surface.mesh().vertex_kind(vertex),
                ..Curvature::default()
            };
            let jet = shape.jet(vertex);
            if let Some(jet) = jet.filter(|jet| jet.mean.is_finite() && jet.gaussian.is_finite()) {
                curvature.normal = jet.normal;
                (curvature.mean, curvature.gaussian) = (jet.mean, jet.gaussian);
            }
        });
    }
}

impl<T: Real> TwoPass for Galerkin<T> {
    type Scalar = T;

    fn measure(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut GalerkinMemory<T>,
    ) {
        let Self {
            modulus,
            spontaneous_curvature,
            ..
        } = self;
        MaterialParameter::expect(self, modulus, spontaneous_curvature, surface.mesh());
        self.evaluate::<true>(execution, surface, memory);
    }

    fn measured_energy(
        &self,
        execution: &impl Execution,
        _: Surface<'_, T>,
        memory: &mut GalerkinMemory<T>,
    ) -> T {
        let entry = |energies: &[Several<T>], k: usize| energies[k / WIDTH].0[k % WIDTH];
        let [inside, between] = [&memory.energies, &memory.edge_energies]
            .map(|energies| execution.sum(energies.len() * WIDTH, |k| entry(energies, k)));
        inside + between
    }

    fn add_measured_force(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        memory: &mut GalerkinMemory<T>,
        force: &mut [[T; 3]],
    ) {
        let GalerkinMemory {
            shape,
            fields,
            hems,
            bars,
            back,
            work,
            idle,
            ..
        } = memory;
        let parameters = [&self.modulus, &self.spontaneous_curvature];
        let varying = parameters.iter().filter(|parameter| parameter.varies());
        let stride = RETURNED + FREE * varying.count();
        let material = [0, 1].map(|k| fields[k].field(parameters[k]));
        back.returned.resize(bars.len() * stride, Several::zero());
        let by_patches = Back {
            shape,
            surface,
            inside: bars,
            hems,
            material,
        };
        let slots = Strided::new(&mut back.returned, stride);
        execution.run(idle, slots, &by_patches);
        back.subtract_from(execution, surface, (shape, stride), material, work, force);
    }
}
