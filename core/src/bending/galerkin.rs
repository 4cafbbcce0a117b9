//! Method G: the bending energy of blended osculating jets and its exact gradient, and the strong form over jets.
//!
//! The idea of an energy of second derivatives on surfaces that are only continuous is that of C0 interior
//! penalty methods: S. C. Brenner and L.-Y. Sung, J. Sci. Comput. 22 (2005) 83. Jets, their blend, and
//! the gradient of the whole are our own.

mod basis;
mod edges;
mod fields;
mod findings;
mod fit;
mod jets;
mod material;
mod measures;
mod passes;
mod patch;
mod plan;
mod points;
mod polynomial;
mod shape;
mod vertices;

use self::basis::FREE;
use self::edges::{EDGE_GRADIENTS, Edges, PATCH_EDGE_VALUES};
use self::fields::FieldMemory;
use self::jets::Jets;
pub use self::measures::{PatchFunctional, PatchFunctionalMemory};
use self::passes::{Back, Inside};
use self::patch::Bars;
use self::plan::RETURNED;
use self::shape::{Return, Shape};
use self::vertices::Work;
use crate::bending::MaterialParameter;
use crate::diagnostic::Finding;
use crate::element::{Execution, Strided};
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
/// connectivity alone, so that the energy is a smooth function of the positions.
///
/// On meshes that resolve the surface the energy converges, and so does the work of the nodal forces in any
/// smooth displacement, whatever the valences. Nodal forces over areas of vertices do not converge. The force
/// density f is another discretisation, that of [`StrongForm`](crate::StrongForm) over [`Jet`](crate::Jet)s, and
/// no gradient; n, H, K and A are those of the same jets. They converge at every vertex, are defined near borders
/// as in the strong form, and do not suffer from vertices that are close. Jets have degree 8 if the largest
/// component has 2500 vertices or more, degree 6 from 1000 on, and degree 4 below.
///
/// In the energy only triangles with interior corners count, see [`crate::bending`]. Nodal forces there include
/// the natural boundary conditions. Components of less than 5000 vertices have fits of degree 6, those of less than
/// 540 fits of lower degree, and those of less than 11 none and therefore no energy; the last two are
/// reported.
///
/// Findings are those of the last evaluation: about patches after an energy or nodal forces, and about jets after
/// curvatures or force densities.
///
/// docs/GALERKIN.md has the theory, measurements and limits.
#[derive(Clone, Debug, PartialEq)]
pub struct Galerkin<T> {
    /// Bending modulus κ, in units of energy.
    pub modulus: MaterialParameter<T>,
    /// Spontaneous curvature H0.
    pub spontaneous_curvature: MaterialParameter<T>,
}

impl<T: Real> Galerkin<T> {
    /// The method without spontaneous curvature.
    pub fn new(modulus: T) -> Self {
        Self {
            modulus: modulus.into(),
            spontaneous_curvature: MaterialParameter::default(),
        }
    }
}

/// Memory of [`Galerkin`].
#[derive(Clone, Debug)]
pub struct GalerkinMemory<T: Real> {
    shape: Shape<T>,
    /// Bending modulus and spontaneous curvature.
    fields: [FieldMemory<T>; 2],
    energies: Vec<Several<T>>,
    edge_energies: Vec<Several<T>>,
    edge_values: Vec<Several<T>>,
    edge_gradients: Vec<Several<T>>,
    bars: Vec<Bars<T>>,
    back: Return<T>,
    work: Vec<Work<T>>,
    idle: Vec<()>,
    /// Made when n, H, K or f are first asked for.
    jets: Option<Jets<T>>,
    /// Whether the last evaluation was of these.
    is_pointwise: bool,
}

impl<T: Real> Method<T> for Galerkin<T> {
    type Memory = GalerkinMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> GalerkinMemory<T> {
        GalerkinMemory {
            shape: Shape::new(mesh),
            fields: Default::default(),
            energies: Vec::new(),
            edge_energies: Vec::new(),
            edge_values: Vec::new(),
            edge_gradients: Vec::new(),
            bars: Vec::new(),
            back: Return::default(),
            work: Vec::new(),
            idle: Vec::new(),
            jets: None,
            is_pointwise: false,
        }
    }

    fn check(&self) -> Result<(), ParameterError> {
        MaterialParameter::check(&self.modulus, &self.spontaneous_curvature)
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        if let (true, Some(jets)) = (memory.is_pointwise, &memory.jets) {
            jets.inspect(surface, report);
            return;
        }
        surface.report_uneven_mesh(report);
        surface.report_rough_vertices(report);
        memory.shape.report_fits(report);
        memory.shape.report_rows(surface, report);
        memory.report_angles(report);
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
        memory.edge_values.resize(blocks * PATCH_EDGE_VALUES, zero);
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
                Strided::new(&mut memory.edge_values, PATCH_EDGE_VALUES),
            ),
            &mut memory.bars[..],
        );
        execution.run(&mut memory.idle, slots, &inside);

        let blocks = shape.plan.interior_edges.len().div_ceil(WIDTH);
        memory.edge_energies.resize(blocks, zero);
        memory.edge_gradients.resize(blocks * EDGE_GRADIENTS, zero);
        let edges = Edges {
            plan: &shape.plan,
            basis: &shape.basis,
            edge_values: &memory.edge_values,
        };
        let slots = (
            &mut memory.edge_energies[..],
            Strided::new(&mut memory.edge_gradients, EDGE_GRADIENTS),
        );
        execution.run(&mut memory.idle, slots, &edges);
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
        } = self;
        MaterialParameter::expect(self, modulus, spontaneous_curvature, surface.mesh());
        memory.is_pointwise = false;
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
            edge_gradients,
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
            edge_gradients,
            material,
        };
        let slots = Strided::new(&mut back.returned, stride);
        execution.run(idle, slots, &by_patches);
        back.subtract_from(execution, surface, (shape, stride), material, work, force);
    }
}
