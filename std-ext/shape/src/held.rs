//! Functionals of the components of one membrane: their values, gradients, and exact constraints.

use crate::execute::Parallel;
use helfrich::{
    AnyFunctional, ConstraintError, Constraints, Correction, Functional, PatchFunctional, Prepared,
    Surface, Targets, TriangleMesh,
};
use helfrich_evaluate::method::BendingMethod;
use std::sync::Arc;

/// The functionals by which area and enclosed volume of a surface are held and reported.
#[derive(Clone, Copy, Debug)]
pub struct Geometry {
    /// The functional for the area.
    pub area: AnyFunctional,
    /// The functional for the volume.
    pub volume: AnyFunctional,
}

impl Geometry {
    /// Area and volume of the patches of Galerkin's method where it is among those by which the surface bends,
    /// otherwise those of flat triangles. These have an error of second order in the edge length, which would be
    /// that of the equilibrium.
    pub fn new(bending: impl IntoIterator<Item = BendingMethod>) -> Self {
        let mut bending = bending.into_iter();
        let [area, volume] = if bending.any(|method| method == BendingMethod::Galerkin) {
            [PatchFunctional::Area, PatchFunctional::Volume].map(AnyFunctional::OfPatches)
        } else {
            [AnyFunctional::Area, AnyFunctional::Volume]
        };
        Self { area, volume }
    }

    /// Prepares the functionals for a mesh, unless triangles are flat.
    pub fn of_patches(self, mesh: &TriangleMesh) -> Option<[Quantity; 2]> {
        let is_of_patches = matches!(self.area, AnyFunctional::OfPatches(_));
        is_of_patches.then(|| [self.area, self.volume].map(|of| Quantity::new(of, mesh)))
    }
}

/// A functional of each connected component, prepared for one mesh.
#[derive(Debug)]
pub struct Quantity {
    prepared: Prepared<f64, AnyFunctional, Parallel>,
    values: Vec<f64>,
    ones: Vec<f64>,
}

impl Quantity {
    /// Prepares a functional for a mesh.
    pub fn new(functional: AnyFunctional, mesh: &TriangleMesh) -> Self {
        let (_, count) = mesh.components();
        Self {
            prepared: Prepared::with_execution(functional, mesh, Parallel::new()),
            values: vec![0.0; count],
            ones: vec![1.0; count],
        }
    }

    /// The values of a functional on a surface, as targets.
    pub fn targets(functional: AnyFunctional, surface: Surface<'_, f64>) -> Targets<f64> {
        let mut quantity = Self::new(functional, surface.mesh());
        quantity.values(surface);
        Targets::PerComponent(quantity.values)
    }

    /// The value of each component.
    ///
    /// # Panics
    /// If the surface has another mesh.
    pub fn values(&mut self, surface: Surface<'_, f64>) -> &[f64] {
        let values = &mut self.values;
        self.prepared.with(|functional, execution, workspace| {
            functional.values(execution, surface, workspace, values);
        });
        values
    }

    /// Adds the gradient, a vector per vertex, to `gradient`.
    ///
    /// # Panics
    /// If the surface has another mesh, or `gradient` has fewer entries than it has vertices.
    pub fn add_gradient(&mut self, surface: Surface<'_, f64>, gradient: &mut [[f64; 3]]) {
        let ones = &self.ones;
        self.prepared.with(|functional, execution, workspace| {
            functional.add_gradient(execution, surface, workspace, ones, gradient);
        });
    }
}

/// The exact constraints of one membrane, with the memory of their evaluation.
#[derive(Debug)]
pub struct Held {
    mesh: Arc<TriangleMesh>,
    constraints: Prepared<f64, Constraints<f64>, Parallel>,
    quantities: Vec<Quantity>,
    groups: Vec<u32>,
    /// The targets for which they were prepared.
    ends: Vec<Targets<f64>>,
}

impl Held {
    /// Prepares constraints for a mesh.
    pub fn new(mesh: Arc<TriangleMesh>, constraints: Constraints<f64>) -> Self {
        let targets = constraints.constraints.iter();
        let ends = Vec::from_iter(targets.map(|constraint| constraint.targets.clone()));
        let quantities = constraints.constraints.iter();
        let quantities = quantities.map(|constraint| Quantity::new(constraint.functional, &mesh));
        Self {
            quantities: quantities.collect(),
            constraints: Prepared::with_execution(constraints, &mesh, Parallel::new()),
            groups: mesh.components().0,
            ends,
            mesh,
        }
    }

    /// Number of constrained functionals.
    pub fn count(&self) -> usize {
        self.quantities.len()
    }

    /// The connected component of each vertex; every component has its own values.
    pub fn groups(&self) -> &[u32] {
        &self.groups
    }

    /// The value of each functional for each component; NaN where positions do not fit the mesh or are not
    /// finite.
    pub fn values(&mut self, positions: &[[f64; 3]]) -> Vec<Vec<f64>> {
        let surface = Surface::new(&self.mesh, positions).ok();
        let values = self.quantities.iter_mut().map(|quantity| match surface {
            Some(surface) => quantity.values(surface).to_vec(),
            None => vec![f64::NAN; quantity.ones.len()],
        });
        values.collect()
    }

    /// Sets the targets on the way from some values, those of [`Self::values`], to the targets for which
    /// the constraints were prepared: a fraction from 0 to 1.
    pub fn approach(&mut self, starts: &[Vec<f64>], fraction: f64) {
        let constraints = &mut self.constraints.method_mut().constraints;
        for ((constraint, end), starts) in constraints.iter_mut().zip(&self.ends).zip(starts) {
            constraint.targets = if fraction < 1.0 {
                let between = starts.iter().enumerate();
                let between = between.map(|(at, start)| start + fraction * (end.at(at) - start));
                Targets::PerComponent(between.collect())
            } else {
                end.clone()
            };
        }
    }

    /// Moves positions so that every functional has its target.
    ///
    /// # Errors
    /// If this fails: see [`Constraints::correct`].
    pub fn restore(
        &mut self,
        positions: &mut [[f64; 3]],
    ) -> Result<Correction<f64>, ConstraintError> {
        let mesh = &self.mesh;
        self.constraints.with(|method, execution, workspace| {
            method.correct(execution, mesh, positions, workspace)
        })
    }

    /// Sets `gradient` to the gradient of one of the functionals; 0 where positions do not fit the mesh
    /// or are not finite.
    ///
    /// # Panics
    /// If there is no such functional, or `gradient` has fewer entries than the mesh has vertices.
    pub fn gradient(&mut self, index: usize, positions: &[[f64; 3]], gradient: &mut [[f64; 3]]) {
        gradient.fill([0.0; 3]);
        if let Ok(surface) = Surface::new(&self.mesh, positions) {
            self.quantities[index].add_gradient(surface, gradient);
        }
    }
}

/// Largest number of steps of [`keep_volumes`]. The correct digits double with each, once the first is right.
const STEPS: usize = 40;

/// Error, in roundings of a volume, below which it counts as kept.
const ROUNDINGS: f64 = 8.0;

/// A volume that was not kept.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "component {component} would have the volume {volume:.3e} instead of {target:.3e}, and moving its vertices along \
     their normals does not give it back"
)]
pub struct VolumeError {
    /// The component, numbered as by `Components`.
    pub component: usize,
    /// Its volume, a length cubed.
    pub volume: f64,
    /// The volume that it had before.
    pub target: f64,
}

/// Moves the vertices of each closed component by the same distance along their normals, until the component
/// encloses the volume V0 that it has on `before` (a length cubed, signed, of the polyhedron) to rounding: `|V − V0| ≤
/// 8 ε (|V0| + Σ |∂V/∂x| |x|)`. Components with a border, and those whose volume is right, stay where they are.
///
/// Normals are the directions of ∂V/∂x, so that `A = Σ |∂V/∂x|` is the derivative of V by the distance. Steps are `3 V/A
/// ((V0/V)^⅓ − 1)`, exact on spheres and Newton's `(V0 − V)/A` near V0, and the latter if V changes its sign.
///
/// # Errors
/// If a volume is not reached, or was lost in the rounding of the positions.
///
/// # Panics
/// If there is not one position per vertex.
pub fn keep_volumes(
    before: Surface<'_, f64>,
    positions: &mut [[f64; 3]],
) -> Result<(), VolumeError> {
    keep_volumes_on(before, before.mesh(), positions)
}

/// The same for positions on another mesh, whose components are as many, in the same order.
///
/// # Errors
/// As [`keep_volumes`].
///
/// # Panics
/// If there is not one position per vertex of the mesh, or the numbers of components differ.
pub fn keep_volumes_on(
    before: Surface<'_, f64>,
    mesh: &TriangleMesh,
    positions: &mut [[f64; 3]],
) -> Result<(), VolumeError> {
    let mut quantity = Quantity::new(AnyFunctional::Volume, before.mesh());
    reach_volumes(quantity.values(before), mesh, positions)
}

/// The same to a volume for each component.
///
/// # Errors
/// As [`keep_volumes`].
///
/// # Panics
/// If there is not one position per vertex of the mesh, or one volume per component.
pub fn reach_volumes(
    targets: &[f64],
    mesh: &TriangleMesh,
    positions: &mut [[f64; 3]],
) -> Result<(), VolumeError> {
    let mut quantity = Quantity::new(AnyFunctional::Volume, mesh);
    assert_eq!(
        targets.len(),
        quantity.values.len(),
        "volumes and components"
    );
    let mut volumes = targets.to_vec();
    let (components, _) = mesh.components();
    let mut gradient = vec![[0.0; 3]; positions.len()];
    let length = |[x, y, z]: [f64; 3]| x.hypot(y).hypot(z);
    'steps: for _ in 0..=STEPS {
        let Ok(surface) = Surface::new(mesh, positions) else {
            // Positions were finite at the start: the steps have left the range.
            break;
        };
        volumes.copy_from_slice(quantity.values(surface));
        gradient.fill([0.0; 3]);
        quantity.add_gradient(surface, &mut gradient);
        // A, and Σ |∂V/∂x| |x|.
        let mut sums = vec![[0.0; 2]; targets.len()];
        for ((&gradient, &at), &component) in gradient.iter().zip(&*positions).zip(&components) {
            let [area, reach] = &mut sums[component as usize];
            *area += length(gradient);
            *reach += length(gradient) * length(at);
        }
        let mut distances = vec![0.0; targets.len()];
        for (component, distance) in distances.iter_mut().enumerate() {
            let (volume, target, [area, reach]) =
                (volumes[component], targets[component], sums[component]);
            let off = target - volume;
            let rounding = ROUNDINGS * f64::EPSILON;
            if off.abs() <= rounding * (target.abs() + reach) {
                continue;
            }
            if volume.abs() * f64::EPSILON.sqrt() <= rounding * reach {
                // Rounding has taken half of the digits of the shape.
                break 'steps;
            }
            *distance = if volume * target > 0.0 {
                3.0 * volume / area * ((target / volume).cbrt() - 1.0)
            } else {
                off / area
            };
        }
        if distances.iter().all(|&distance| distance == 0.0) {
            return Ok(());
        }
        for ((at, &gradient), &component) in positions.iter_mut().zip(&gradient).zip(&components) {
            let distance = distances[component as usize];
            let size = length(gradient);
            if distance != 0.0 && size > 0.0 {
                *at = std::array::from_fn(|axis| at[axis] + distance / size * gradient[axis]);
            }
        }
    }
    let off = |component: usize| (volumes[component] / targets[component] - 1.0).abs();
    let worst = (0..targets.len()).filter(|&component| targets[component] != 0.0);
    let component = worst
        .max_by(|&a, &b| off(a).total_cmp(&off(b)))
        .unwrap_or(0);
    Err(VolumeError {
        component,
        volume: volumes[component],
        target: targets[component],
    })
}
