//! Effects from their Python descriptions: classes with the words of scenes.

use crate::arrays::{Numbers, Positions, checked, made_ready};
use crate::curvature::Chosen;
use crate::failure::{Fault, invalid};
use helfrich::{
    AnyFunctional, BorderTension, Components, GaussianBending, GaussianDomains, GompperKroll,
    Gravity, InPlane, LineTension, LocalArea, MaterialParameter, Method, NeoHookean,
    OsmoticPressure, PointLoads, Reordering, Skalak, StrainEnergy, Surface, SurfaceTension,
    Targets, TriangleMesh, WallAdhesion,
};
use helfrich_std::effect::{CompiledPotential, Effect, Lumping, MembranePart, in_plane};
use helfrich_std::held::Geometry;
use helfrich_std::method::BendingMethod;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

/// The mesh of a membrane, and the order in which it is evaluated.
pub(crate) struct Ground<'a> {
    /// The mesh of the user.
    pub(crate) mesh: &'a TriangleMesh,
    /// The same in the order of evaluation.
    pub(crate) own: &'a TriangleMesh,
    pub(crate) order: Option<&'a Reordering>,
    /// The functionals for area and volume.
    pub(crate) geometry: Geometry,
}

impl Ground<'_> {
    /// Values at the vertices, in the order of evaluation.
    fn ordered<V: Copy>(&self, values: Vec<V>) -> Vec<V> {
        match self.order {
            Some(order) => order.apply(&values),
            None => values,
        }
    }
}

/// A parameter at the vertices of a mesh, or the same everywhere.
pub(crate) fn material(
    numbers: &Numbers<'_>,
    vertices: usize,
    name: &str,
) -> PyResult<MaterialParameter<f64>> {
    Ok(match (numbers, numbers.each(vertices, name)?) {
        (_, Some(each)) => MaterialParameter::PerVertex(each.to_vec()),
        (Numbers::Same(same), None) => MaterialParameter::Constant(*same),
        (Numbers::Each(_), None) => MaterialParameter::default(),
    })
}

/// Refuses a modulus κ and a spontaneous curvature H0 with which methods cannot compute.
pub(crate) fn checked_material(
    method: BendingMethod,
    [modulus, spontaneous_curvature]: &[MaterialParameter<f64>; 2],
) -> PyResult<()> {
    let is_curved = *spontaneous_curvature != MaterialParameter::default();
    if method == BendingMethod::KantorNelson && is_curved {
        return Err(invalid(
            "kantor-nelson has no spontaneous curvature: choose another method",
        ));
    }
    let same_limits = GompperKroll {
        modulus: modulus.clone(),
        spontaneous_curvature: spontaneous_curvature.clone(),
        ..GompperKroll::new(1.0)
    };
    Method::check(&same_limits).map_err(invalid)
}

/// The attributes of an effect's description.
struct Reader<'a, 'py> {
    described: &'a Bound<'py, PyAny>,
    ground: &'a Ground<'a>,
}

impl<'py> Reader<'_, 'py> {
    fn get(&self, name: &str) -> PyResult<Bound<'py, PyAny>> {
        self.described.getattr(name)
    }

    fn number(&self, name: &str) -> PyResult<f64> {
        checked("number", &self.get(name)?, name)?.extract()
    }

    fn vector(&self, name: &str) -> PyResult<[f64; 3]> {
        checked("vector", &self.get(name)?, name)?.extract()
    }

    /// A parameter at the vertices, in the order of evaluation.
    fn material(&self, name: &str) -> PyResult<MaterialParameter<f64>> {
        let numbers = Numbers::named(&self.get(name)?, name)?;
        let values = material(&numbers, self.ground.mesh.vertex_count(), name)?;
        Ok(match values {
            MaterialParameter::PerVertex(values) => {
                MaterialParameter::PerVertex(self.ground.ordered(values))
            }
            same => same,
        })
    }

    /// A target for each component, in the order of evaluation, or the same for all.
    fn targets(&self, name: &str) -> PyResult<Targets<f64>> {
        let numbers = Numbers::named(&self.get(name)?, name)?;
        if let Numbers::Same(same) = numbers {
            return Ok(Targets::Same(same));
        }
        let components = Components::new(self.ground.mesh);
        let each = numbers.each(components.count(), name)?.unwrap_or(&[]);
        let Some(order) = self.ground.order else {
            return Ok(Targets::PerComponent(each.to_vec()));
        };
        let own = Components::new(self.ground.own);
        let mut ordered = vec![0.0; own.count()];
        for (&component, &vertex) in own.of_vertex().iter().zip(order.vertices()) {
            let old = components.of_vertex()[vertex as usize];
            ordered[component as usize] = each[old as usize];
        }
        Ok(Targets::PerComponent(ordered))
    }

    /// A law of in-plane elasticity over the reference positions.
    fn in_plane<W: StrainEnergy<f64>>(&self, law: W) -> PyResult<InPlane<f64, W>> {
        let positions = Positions::named(&self.get("reference")?, "reference")?;
        let positions = positions.double();
        let wrong = |fault: Fault| fault.of_argument("reference");
        Surface::new(self.ground.mesh, &positions[..]).map_err(|error| wrong(error.into()))?;
        let positions = self.ground.ordered(positions.into_owned());
        let reference = Surface::new(self.ground.own, &positions);
        let reference = reference.map_err(|error| wrong(error.into()))?;
        Ok(in_plane(law, reference, 1.0).map_err(|error| wrong(Fault::new(error)))?)
    }

    /// The effect of a potential whose parameters are checked.
    fn potential(&self, name: &'static str, method: impl CompiledPotential) -> PyResult<Effect> {
        Effect::conservative(name, method, self.ground.own).map_err(invalid)
    }

    fn bending(&self) -> PyResult<Effect> {
        let method: String = checked("text", &self.get("method")?, "method")?.extract()?;
        let option = |name| checked("option", &self.get(name)?, name)?.extract::<Option<String>>();
        let (areas, bandwidth) = (option("areas")?, option("bandwidth")?);
        let Chosen { method, options } =
            Chosen::named(&method, areas.as_deref(), bandwidth.as_deref())?;
        let material = [self.material("kappa")?, self.material("H0")?];
        checked_material(method, &material)?;
        let own = self.ground.own;
        Effect::bending("bending", method, &options, material, Lumping::Own, own).map_err(invalid)
    }

    fn gaussian_bending(&self) -> PyResult<Effect> {
        let name = "gaussian_bending";
        match self.material("modulus")? {
            MaterialParameter::Constant(modulus) => {
                self.potential(name, GaussianBending::new(modulus))
            }
            modulus => self.potential(name, GaussianDomains { modulus }),
        }
    }

    fn border_tension(&self) -> PyResult<Effect> {
        let (tension, own) = (self.number("value")?, self.ground.own);
        let domains = made_ready("labels", &self.get("domains")?, "domains")?;
        let domains = domains
            .cast::<PyArray1<i64>>()?
            .try_readonly()
            .map_err(invalid)?;
        let labels = domains.as_slice().map_err(invalid)?;
        let [vertices, triangles] = [own.vertex_count(), own.triangles().len()];
        let order = self.ground.order;
        let method = if labels.len() == vertices {
            BorderTension::new(tension, own, &self.ground.ordered(labels.to_vec()))
        } else if labels.len() == triangles {
            let own_labels = order.map(|order| order.apply_to_triangles(labels));
            let labels = own_labels.unwrap_or_else(|| labels.to_vec());
            BorderTension::of_triangles(tension, own, &labels)
        } else {
            return Err(Fault::new(format_args!(
                "domains has {} labels: one for each of {vertices} vertices or {triangles} faces is needed",
                labels.len()
            ))
            .into());
        };
        self.potential("border_tension", method)
    }

    fn adhesion(&self) -> PyResult<Effect> {
        let normal = self.vector("normal")?;
        let [x, y, z] = normal;
        let length = x.hypot(y).hypot(z);
        if !(length > 0.0 && length.is_finite()) {
            return Err(invalid("the normal of the wall has no length"));
        }
        self.potential(
            "adhesion",
            WallAdhesion {
                strength: self.number("strength")?,
                distance: self.number("distance")?,
                range: self.number("range")?,
                wall: self.vector("wall")?,
                normal: normal.map(|component| component / length),
            },
        )
    }

    fn loads(&self) -> PyResult<Effect> {
        let vertices = made_ready("labels", &self.get("vertices")?, "vertices")?;
        let vertices = vertices
            .cast::<PyArray1<i64>>()?
            .try_readonly()
            .map_err(invalid)?;
        let vertices = vertices.as_slice().map_err(invalid)?;
        let forces = Positions::named(&self.get("forces")?, "forces")?;
        let forces = forces.double();
        if vertices.len() != forces.len() {
            return Err(Fault::new(format_args!(
                "there are {} vertices for {} forces: one for each is needed",
                vertices.len(),
                forces.len()
            ))
            .into());
        }
        let count = self.ground.mesh.vertex_count();
        let mut given = Vec::with_capacity(vertices.len());
        for (place, (&vertex, &force)) in vertices.iter().zip(forces.iter()).enumerate() {
            let Some(number) = u32::try_from(vertex).ok().filter(|&v| (v as usize) < count) else {
                return Err(Fault::new(format_args!(
                    "vertices[{place}] is {vertex}: the mesh has {count} vertices, numbered from 0"
                ))
                .into());
            };
            given.push((number, force));
        }
        // Messages name the vertices of the user's mesh.
        PointLoads::new(self.ground.mesh, given.clone()).map_err(invalid)?;
        if let Some(order) = self.ground.order {
            let mut places = vec![0; order.vertices().len()];
            for (place, &vertex) in order.vertices().iter().enumerate() {
                places[vertex as usize] = place as u32;
            }
            for (vertex, _) in &mut given {
                *vertex = places[*vertex as usize];
            }
        }
        let loads = PointLoads::new(self.ground.own, given).map_err(invalid)?;
        self.potential("stretching", loads)
    }

    /// A quantity that is held exactly, or whose penalty acts.
    fn quantity(&self, name: &'static str, functional: AnyFunctional) -> PyResult<MembranePart> {
        let targets = self.targets("target")?;
        let exact: bool = checked("flag", &self.get("exact")?, "exact")?.extract()?;
        if exact && !self.get("modulus")?.is_none() {
            return Err(invalid(
                "an exact quantity has no modulus: leave one of them out",
            ));
        }
        let modulus = (!exact).then(|| self.number("modulus")).transpose()?;
        MembranePart::keeping(name, functional, modulus, targets, self.ground.own).map_err(invalid)
    }
}

/// The method by which a membrane bends, if this is what an object describes.
pub(crate) fn bending_method(described: &Bound<'_, PyAny>) -> Option<BendingMethod> {
    let class = described.get_type().name().ok()?;
    let method = described.getattr("method").ok()?.extract::<String>().ok()?;
    method.parse().ok().filter(|_| class == "Bending")
}

/// The part of a membrane that an object describes, ready for a mesh.
pub(crate) fn part(described: &Bound<'_, PyAny>, ground: &Ground<'_>) -> PyResult<MembranePart> {
    let reader = Reader { described, ground };
    let class = described.get_type().name()?.to_string();
    match class.as_str() {
        "Area" => reader.quantity("area", ground.geometry.area),
        "Volume" => reader.quantity("volume", ground.geometry.volume),
        "AreaDifference" => reader.quantity("area_difference", AnyFunctional::MeanCurvature),
        _ => effect(&reader, &class).map(MembranePart::Acting),
    }
}

fn effect(reader: &Reader<'_, '_>, class: &str) -> PyResult<Effect> {
    match class {
        "Bending" => reader.bending(),
        "GaussianBending" => reader.gaussian_bending(),
        "NeoHookean" => {
            let shear_modulus = reader.number("shear_modulus")?;
            let law = reader.in_plane(NeoHookean { shear_modulus })?;
            reader.potential("elasticity", law)
        }
        "Skalak" => {
            let law = Skalak {
                shear_modulus: reader.number("shear_modulus")?,
                area_ratio: reader.number("area_ratio")?,
            };
            reader.potential("elasticity", reader.in_plane(law)?)
        }
        "LocalArea" => {
            let area_modulus = reader.number("modulus")?;
            let law = reader.in_plane(LocalArea { area_modulus })?;
            reader.potential("local_area", law)
        }
        "Tension" => reader.potential("tension", SurfaceTension::new(reader.number("value")?)),
        "LineTension" => {
            reader.potential("line_tension", LineTension::new(reader.number("value")?))
        }
        "BorderTension" => reader.border_tension(),
        "Pressure" => reader.potential("pressure", OsmoticPressure::new(reader.number("value")?)),
        "Gravity" => {
            let density = reader.number("density_difference")?;
            let weight = reader.vector("acceleration")?.map(|g| density * g);
            let level = reader.vector("level")?;
            reader.potential("gravity", Gravity { weight, level })
        }
        "Adhesion" => reader.adhesion(),
        "Loads" => reader.loads(),
        _ => Err(PyTypeError::new_err(format!(
            "{class} is no effect: helfrich.effects has them all"
        ))),
    }
}
