//! Exact values, and errors of methods.

use super::{Quantity, Study, StudyError};
use crate::execute::Parallel;
use crate::generate::{AnyShape, Family, GeneratedMesh, generate};
use crate::method::{AnyMethod, Fields};
use crate::scalar::Scalar;
use helfrich::shapes::{ExactPoint, Shape};
use helfrich::{Real, Surface};

/// A quantity that is smaller than this part of a power of the largest curvature may vanish up to errors.
const VANISHING: f64 = 0.05;

/// Reference values at the vertices, and the scales of relative errors.
pub(crate) struct Reference {
    /// H, K and Δ_S H.
    curvatures: [Vec<f64>; 3],
    force_density: Vec<[f64; 3]>,
    scales: [f64; 4],
}

impl Reference {
    /// The exact values on a shape.
    pub(super) fn exact(shape: &AnyShape, mesh: &GeneratedMesh, modulus: f64) -> Self {
        let points: Vec<_> = mesh
            .preimages
            .iter()
            .map(|&preimage| shape.at(preimage))
            .collect();
        let force = |point: &ExactPoint<f64>| {
            let density = point.force_density(modulus);
            point.normal.map(|component| density * component)
        };
        let all = |value: fn(&ExactPoint<f64>) -> f64| points.iter().map(value).collect();
        let mut reference = Self {
            curvatures: [
                all(|point| point.mean),
                all(|point| point.gaussian),
                all(|point| point.laplacian_of_mean),
            ],
            force_density: points.iter().map(force).collect(),
            scales: natural_scales(shape, modulus),
        };
        let densities = points.iter().map(|point| point.force_density(modulus));
        let largest = reference.largest(densities);
        for (scale, largest) in reference.scales.iter_mut().zip(largest) {
            // Δ_S H and f of a sphere and f of a Clifford torus vanish up to rounding; their errors
            // are relative to the scale of the shape.
            if largest > f64::EPSILON.sqrt() * *scale {
                *scale = largest;
            }
        }
        reference
    }

    /// The results of a method on a surface, with κ = 1; without a result nothing is compared.
    pub(crate) fn of<T: Real>(fields: &Fields<T>) -> Self {
        let all = |values: &[Option<T>]| {
            let numbers = values.iter().map(|&value| value.map_or(f64::NAN, double));
            numbers.collect::<Vec<_>>()
        };
        let densities = fields.force_density.iter();
        let mut reference = Self {
            curvatures: [
                all(&fields.mean),
                all(&fields.gaussian),
                all(&fields.laplacian_of_mean),
            ],
            force_density: densities
                .map(|density| density.map_or([f64::NAN; 3], |density| density.map(double)))
                .collect(),
            scales: [0.0; 4],
        };
        let sizes = reference.force_density.iter().map(|&density| norm(density));
        reference.scales = Self::natural(reference.largest(sizes));
        reference
    }

    /// The same values with the scales of another reference.
    pub(crate) fn in_units_like(self, other: &Self) -> Self {
        let scales = other.scales;
        Self { scales, ..self }
    }

    /// Values of one quantity, f along these normals, relative to these largest ones; nothing is compared
    /// where there is no number, nor of other quantities.
    pub(crate) fn estimated(
        quantity: Quantity,
        values: Vec<f64>,
        normals: &[[f64; 3]],
        largest: [f64; 4],
    ) -> Self {
        let mut curvatures = [(); 3].map(|()| vec![f64::NAN; values.len()]);
        let mut force_density = vec![[f64::NAN; 3]; values.len()];
        match curvatures.get_mut(quantity as usize) {
            Some(curvature) => *curvature = values,
            None => {
                let along = values.iter().zip(normals);
                force_density = along.map(|(value, n)| n.map(|n| value * n)).collect();
            }
        }
        Self {
            curvatures,
            force_density,
            scales: Self::natural(largest),
        }
    }

    /// The scales of relative errors from the largest |H|, |K|, |Δ_S H| and |f|.
    fn natural(mut scales: [f64; 4]) -> [f64; 4] {
        let [mean, gaussian, laplacian, density] = &mut scales;
        let natural = [mean.powi(2), mean.powi(3), mean.powi(3)];
        for (scale, natural) in [gaussian, laplacian, density].into_iter().zip(natural) {
            // What vanishes on the surface itself, as f does on a sphere, is compared with what its
            // curvature makes of it.
            if *scale < VANISHING * natural {
                *scale = natural;
            }
        }
        scales
    }

    /// Number of vertices with a value.
    pub(crate) fn known(&self, quantity: Quantity) -> usize {
        let vertices = 0..self.force_density.len();
        vertices
            .filter(|&vertex| self.is_known(vertex, quantity))
            .count()
    }

    fn is_known(&self, vertex: usize, quantity: Quantity) -> bool {
        match self.curvatures.get(quantity as usize) {
            Some(values) => values[vertex].is_finite(),
            None => self.force_density[vertex]
                .iter()
                .all(|component| component.is_finite()),
        }
    }

    /// The largest value of each quantity; NaN is ignored.
    fn largest(&self, densities: impl Iterator<Item = f64>) -> [f64; 4] {
        let [mean, gaussian, laplacian] = self
            .curvatures
            .each_ref()
            .map(|values| values.iter().map(|value| value.abs()).fold(0.0, f64::max));
        let density = densities.map(f64::abs).fold(0.0, f64::max);
        [mean, gaussian, laplacian, density]
    }

    /// The scale of relative errors of a quantity.
    pub(crate) fn scale(&self, quantity: Quantity) -> f64 {
        self.scales[quantity as usize]
    }

    /// The error at each vertex, relative; infinite where there is no number.
    pub(crate) fn at_vertices<T: Real>(&self, fields: &Fields<T>, quantity: Quantity) -> Vec<f64> {
        // No number, or none at all (on a closed surface, for want of an area), is an infinite
        // error: `max` would pass it over.
        let relative = |error: Option<f64>| {
            let error = error.filter(|error| !error.is_nan());
            error.unwrap_or(f64::INFINITY) / self.scale(quantity)
        };
        let found = match quantity {
            Quantity::Mean => &fields.mean,
            Quantity::Gaussian => &fields.gaussian,
            Quantity::LaplacianOfMean => &fields.laplacian_of_mean,
            Quantity::ForceDensity => {
                let both = fields.force_density.iter().zip(&self.force_density);
                let errors = both.map(|(found, value)| {
                    relative(found.map(|found| {
                        norm(core::array::from_fn(|axis| {
                            double(found[axis]) - value[axis]
                        }))
                    }))
                });
                return errors.collect();
            }
        };
        let both = found.iter().zip(&self.curvatures[quantity as usize]);
        both.map(|(found, value)| relative(found.map(|found| (double(found) - value).abs())))
            .collect()
    }

    /// Largest and area-weighted mean error of a quantity, relative.
    pub(crate) fn errors<T: Real>(&self, fields: &Fields<T>, quantity: Quantity) -> [f64; 2] {
        let errors = self.at_vertices(fields, quantity);
        let mut largest = 0.0_f64;
        let (mut weighted, mut weights) = (0.0, 0.0);
        for (vertex, (&error, area)) in errors.iter().zip(&fields.area).enumerate() {
            if !self.is_known(vertex, quantity) {
                continue;
            }
            let area = area.to_f64().unwrap_or(f64::NAN);
            largest = largest.max(error);
            weighted += area * error;
            weights += area;
        }
        let mean = if largest.is_finite() {
            weighted / weights
        } else {
            largest
        };
        [largest, mean]
    }
}

fn double<T: Real>(value: T) -> f64 {
    value.to_f64().unwrap_or(f64::NAN)
}

fn norm(vector: [f64; 3]) -> f64 {
    let squares = vector.iter().map(|component| component.powi(2));
    squares.sum::<f64>().sqrt()
}

/// 1/R, 1/R², 1/R³ and κ/R³: what a shape's size R makes of H, K, Δ_S H and f.
pub(super) fn natural_scales(shape: &AnyShape, modulus: f64) -> [f64; 4] {
    let curvature = shape.size().recip();
    let third = curvature.powi(3);
    [curvature, curvature.powi(2), third, modulus.abs() * third]
}

/// Errors of methods at the vertices of a mesh.
#[derive(Clone, Debug)]
pub struct ErrorFields {
    /// The mesh family.
    pub family: Family,
    /// The mesh.
    pub mesh: GeneratedMesh,
    /// The quantity compared.
    pub quantity: Quantity,
    /// For each method the error at each vertex, relative to the largest exact value; infinite without a
    /// result.
    pub methods: Vec<(AnyMethod, Vec<f64>)>,
}

impl Study {
    /// The errors at the vertices of one mesh of each family, in f64, of every method that defines
    /// the quantity.
    ///
    /// # Errors
    /// If a mesh cannot be made.
    pub fn error_fields(
        &self,
        vertices: usize,
        quantity: Quantity,
    ) -> Result<Vec<ErrorFields>, StudyError> {
        let of = |&family: &Family| {
            let mesh = generate(&self.shape, family, vertices, self.seed)?;
            let exact = Reference::exact(&self.shape, &mesh, self.modulus);
            let surface = Surface::new(&mesh.mesh, &mesh.positions).map_err(|source| {
                StudyError::Surface {
                    vertices,
                    scalar: Scalar::F64,
                    source,
                }
            })?;
            let methods = self.methods.iter().copied();
            let methods = methods.filter(|&method| quantity.is_defined_by(method));
            let methods = methods.map(|method| {
                let threads = Parallel::new();
                let options = &self.options;
                let mut evaluator = method.evaluator(options, self.modulus, &mesh.mesh, threads);
                let fields = evaluator.fields(surface);
                (method, exact.at_vertices(&fields, quantity))
            });
            let methods = methods.collect();
            Ok(ErrorFields {
                family,
                mesh,
                quantity,
                methods,
            })
        };
        self.families.iter().map(of).collect()
    }
}
