//! Surfaces and their effects from their values.

use super::super::problem::Problem;
use super::super::reader::Reader;
use super::super::value::{Origin, default_name};
use super::super::{
    AreaDifferenceTarget, Bending, Driver, Elasticity, Gravity, Held, Hold, InPlaneLaw, LocalArea,
    MembraneViscosity, MeshSource, Orientation, Reference, ReferenceSource, Stretching,
    SurfaceScene, Target, VolumeTarget,
};
use super::{Builder, reduced_volume};
use crate::generate::{AnyShape, Family, check as check_mesh};
use crate::method::BendingMethod;
use helfrich::shapes::Sphere;

impl Builder<'_> {
    pub(super) fn surface(&mut self, index: usize, surface: Reader<'_>) -> SurfaceScene {
        let name = match surface.text("name") {
            Some(name) => name.to_owned(),
            None => default_name("surface", index),
        };
        let source = self.source(surface);
        let held = |key, target: &dyn Fn(Reader<'_>) -> Target| {
            let reader = surface.table(key)?;
            Some(Held {
                hold: hold(reader),
                target: target(reader),
            })
        };
        let area = held("area", &|reader| {
            reader
                .number("target")
                .map_or(Target::Initial, Target::Value)
        });
        let volume = surface.table("volume").map(|reader| Held {
            hold: hold(reader),
            target: match (reader.number("reduced"), reader.number("target")) {
                (Some(reduced), _) => VolumeTarget::Reduced(reduced),
                (_, Some(value)) => VolumeTarget::Value(value),
                _ => VolumeTarget::Initial,
            },
        });
        let area_difference = surface.table("area_difference").map(|reader| Held {
            hold: hold(reader),
            target: match (reader.number("reduced"), reader.number("target")) {
                (Some(reduced), _) => AreaDifferenceTarget::Reduced(reduced),
                (_, Some(value)) => AreaDifferenceTarget::Value(value),
                _ => AreaDifferenceTarget::Initial,
            },
        });
        SurfaceScene {
            name,
            scale: surface.number("scale").unwrap_or(1.0),
            position: surface.vector("position").unwrap_or_default(),
            orientation: orientation(surface),
            viscosity_ratio: surface.number("viscosity_ratio"),
            bending: surface.table("bending").map(bending),
            elasticity: surface.table("elasticity").map(|reader| Elasticity {
                law: self.law(reader),
                reference: self.reference(reader, &source),
            }),
            area,
            local_area: surface.table("local_area").map(|reader| LocalArea {
                modulus: reader.needed("modulus"),
                reference: self.reference(reader, &source),
            }),
            volume,
            area_difference,
            tension: surface
                .table("tension")
                .map(|reader| reader.needed("value")),
            pressure: surface
                .table("pressure")
                .map(|reader| reader.needed("value")),
            gravity: surface.table("gravity").map(|reader| Gravity {
                density_difference: reader.needed("density_difference"),
                acceleration: reader.vector("acceleration").unwrap_or_default(),
            }),
            membrane_viscosity: surface.table("membrane_viscosity").map(|reader| {
                MembraneViscosity {
                    shear: reader.needed("shear"),
                    dilational: reader.number("dilational").unwrap_or(0.0),
                }
            }),
            stretching: surface.table("stretching").map(|reader| Stretching {
                axis: reader.vector("axis").unwrap_or_default(),
                forces: reader.numbers("force"),
                fraction: reader.number("fraction").unwrap_or(0.05),
            }),
            source,
        }
    }

    /// Where the mesh of a surface or an obstacle comes from.
    pub(super) fn source(&mut self, surface: Reader<'_>) -> MeshSource {
        if let Some(name) = surface.text("mesh") {
            return MeshSource::File(self.file(name));
        }
        let shape = surface.text("shape").and_then(|text| text.parse().ok());
        let family = surface.text("family").and_then(|text| text.parse().ok());
        let family = family.unwrap_or(Family::Smooth);
        let vertices = surface.count("vertices");
        let size = vertices.map(|count| usize::try_from(count).unwrap_or(usize::MAX));
        if let (Some(shape), Some(vertices)) = (&shape, size)
            && let Err(error) = check_mesh(shape, family, vertices)
        {
            let origin = surface.origin_of("vertices");
            self.problems.add(&origin, Problem::Generate(error));
        }
        MeshSource::Shape {
            shape: shape.unwrap_or(UNIT_SPHERE),
            family,
            vertices: size.unwrap_or(0),
            seed: surface.count("seed").unwrap_or(1),
            match_volume: surface.switch("match_volume").unwrap_or(false),
        }
    }

    fn law(&mut self, elasticity: Reader<'_>) -> InPlaneLaw {
        let shear_modulus = elasticity.needed("shear_modulus");
        let area_ratio = elasticity.number("area_ratio");
        let given = elasticity.has("area_ratio");
        match elasticity.text("law") {
            Some("skalak") => {
                if !given {
                    self.contradiction(
                        &elasticity.origin_of("law"),
                        "Skalak's law lacks `area_ratio`: C, such as 1, for an area modulus of \
                         (1 + 2 C) G"
                            .to_owned(),
                    );
                }
                InPlaneLaw::Skalak {
                    shear_modulus,
                    area_ratio: area_ratio.unwrap_or(f64::NAN),
                }
            }
            law => {
                if given && law == Some("neo-hookean") {
                    self.contradiction(
                        &elasticity.origin_of("area_ratio"),
                        "`area_ratio` is the C of Skalak's law, and the neo-Hookean has none: leave \
                         it out, or choose law = \"skalak\""
                            .to_owned(),
                    );
                }
                InPlaneLaw::NeoHookean { shear_modulus }
            }
        }
    }

    fn reference(&mut self, around: Reader<'_>, source: &MeshSource) -> Reference {
        let Some(reader) = around.table("reference") else {
            return Reference {
                source: ReferenceSource::Initial,
                scale: 1.0,
            };
        };
        let shape = reader.text("shape").and_then(|text| text.parse().ok());
        let origin = reader.origin_of("shape");
        let reference = match (shape, reader.text("mesh")) {
            (Some(shape), _) => {
                self.reference_shape(&origin, shape, source);
                ReferenceSource::Shape(shape)
            }
            (_, Some(mesh)) => ReferenceSource::File(self.file(mesh)),
            _ => ReferenceSource::Initial,
        };
        Reference {
            source: reference,
            scale: reader.number("scale").unwrap_or(1.0),
        }
    }

    /// A reference has the triangles of its surface: not every shape can.
    fn reference_shape(&mut self, origin: &Origin, reference: AnyShape, source: &MeshSource) {
        let is_torus = |shape: &AnyShape| matches!(shape, AnyShape::Torus(_));
        let why = match source {
            MeshSource::File(_) => {
                "the surface is a mesh file: its reference is \"initial\" or a \
                                    mesh file with the same triangles, { mesh = \"…\" }"
            }
            MeshSource::Shape { family, .. } if *family == Family::Irregular => {
                "the triangles of an irregular mesh depend on the shape: choose another family"
            }
            MeshSource::Shape { shape, .. }
                if is_torus(shape) != is_torus(&reference)
                    || (is_torus(shape) && *shape != reference) =>
            {
                "the meshes of the two shapes have different triangles: choose a shape like the \
                 surface's, and no other torus for a torus"
            }
            MeshSource::Shape { .. } => return,
        };
        self.contradiction(
            origin,
            format!("no reference on the {}: {why}", reference.name()),
        );
    }

    /// What is right by itself and wrong, or doubtful, together.
    pub(super) fn effects(
        &mut self,
        surface: &SurfaceScene,
        reader: Reader<'_>,
        driver: Option<&Driver>,
    ) {
        let SurfaceScene { name, .. } = surface;
        if let (Some(bending), Some(table)) = (surface.bending, reader.table("bending"))
            && bending.method == BendingMethod::KantorNelson
            && bending.spontaneous_curvature != 0.0
        {
            self.contradiction(
                &table.origin_of("spontaneous_curvature"),
                "method kantor-nelson (A) has no spontaneous curvature: choose another method"
                    .to_owned(),
            );
        }
        if let (Some(area), Some(volume)) = (surface.area, surface.volume)
            && let (Target::Value(area), VolumeTarget::Value(volume)) = (area.target, volume.target)
        {
            let reduced = reduced_volume(volume, area);
            let table = reader.table("volume");
            if reduced > 1.0
                && let Some(table) = table
            {
                self.contradiction(
                    &table.origin_of("target"),
                    format!(
                        "the reduced volume of these targets is {reduced:.4}: no surface of area \
                         {area} encloses more than a sphere, {:.6}",
                        volume / reduced
                    ),
                );
            }
        }
        let exact = |hold: Option<Hold>| hold == Some(Hold::Exact);
        let idle = [
            (
                "tension",
                surface.tension.is_some() && exact(surface.area.map(|held| held.hold)),
                "area",
            ),
            (
                "pressure",
                surface.pressure.is_some() && exact(surface.volume.map(|held| held.hold)),
                "volume",
            ),
        ];
        for (key, _, held) in idle.into_iter().filter(|(_, idle, _)| *idle) {
            let message = format!(
                "`{key}` does nothing to \"{name}\", whose {held} is held exactly: leave one of them \
                 out"
            );
            self.doubt(&reader.origin_of(key), message);
        }
        match driver {
            None => {}
            Some(Driver::Relax(_)) => self.without_fluid(surface, reader),
            Some(driver) => self.in_fluid(surface, reader, driver),
        }
    }

    /// What is wrong or doubtful where there is no fluid.
    fn without_fluid(&mut self, surface: &SurfaceScene, reader: Reader<'_>) {
        let SurfaceScene { name, .. } = surface;
        if surface.viscosity_ratio.is_some_and(|ratio| ratio != 1.0) {
            self.contradiction(
                &reader.origin_of("viscosity_ratio"),
                "the driver \"relax\" has no flow, and no viscosities: leave `viscosity_ratio` out, \
                 or choose the driver \"boundary-integral\""
                    .to_owned(),
            );
        }
        if surface.membrane_viscosity.is_some() {
            self.contradiction(
                &reader.origin_of("membrane_viscosity"),
                "the driver \"relax\" has no time, and nothing that a viscosity slows down: leave \
                 [surface.membrane_viscosity] out, or choose the driver \"boundary-integral\""
                    .to_owned(),
            );
        }
        if surface.elasticity.is_some() && surface.bending.is_none() {
            let message = format!(
                "\"{name}\" is elastic and has no bending: where it is compressed it wrinkles at the \
                 scale of its mesh, more so on a finer one: add [surface.bending]"
            );
            self.doubt(&reader.origin_of("elasticity"), message);
        }
        if surface.gravity.is_some() {
            let message = format!(
                "\"{name}\" has a weight and nothing that carries it: the driver \"relax\" finds no \
                 equilibrium, and ends by its iterations"
            );
            self.doubt(&reader.origin_of("gravity"), message);
        }
        if !surface.has_effects() {
            let message =
                format!("nothing acts on \"{name}\": add an effect, such as [surface.bending]");
            self.doubt(reader.origin(), message);
        }
    }

    /// What is wrong or doubtful in a fluid.
    fn in_fluid(&mut self, surface: &SurfaceScene, reader: Reader<'_>, driver: &Driver) {
        let SurfaceScene { name, .. } = surface;
        let penalty = |area: Held<Target>| area.hold != Hold::Exact;
        let resists = surface.bending.is_some()
            || surface.elasticity.is_some()
            || surface.local_area.is_some()
            || surface.tension.is_some()
            || surface.area.is_some_and(penalty);
        if !resists {
            self.contradiction(
                reader.origin(),
                format!(
                    "nothing in \"{name}\" resists deformation, and the flow would draw it out \
                     without end: add `bending`, `elasticity`, `tension`, `local_area` or a penalty on \
                     its `area`"
                ),
            );
        }
        let held = [
            ("area", surface.area.map(|held| held.hold)),
            (
                "area_difference",
                surface.area_difference.map(|held| held.hold),
            ),
        ];
        for (key, hold) in held {
            if hold == Some(Hold::Exact)
                && let Some(table) = reader.table(key)
            {
                self.contradiction(
                    &table.origin_of("constraint"),
                    format!(
                        "in a flow the `{key}` of \"{name}\" cannot be held exactly: only forces \
                         move membranes there; give a `modulus`, as large as needed"
                    ),
                );
            }
        }
        let loads = surface.stretching.as_ref();
        if loads.is_some_and(|stretching| stretching.forces.len() > 1)
            && let Some(table) = reader.table("stretching")
        {
            self.contradiction(
                &table.origin_of("force"),
                format!(
                    "a sequence of forces goes from equilibrium to equilibrium, and the driver \"{}\" \
                     goes by time: give one force, which acts throughout, or choose the driver \
                     \"relax\"",
                    driver.name()
                ),
            );
        }
        if let Driver::LatticeBoltzmann(lattice) = driver {
            self.in_a_box(surface, reader, lattice);
        }
        if surface.pressure.is_some() {
            let message = format!(
                "`pressure` does nothing to \"{name}\", whose volume the fluid inside keeps: leave it \
                 out"
            );
            self.doubt(&reader.origin_of("pressure"), message);
        }
        if let (Some(bending), Some(table)) = (surface.bending, reader.table("bending"))
            && bending.method == BendingMethod::KantorNelson
        {
            let message =
                "method kantor-nelson (A) bends with k̃ = 2κ/√3, by which capsules in shear \
                           are deformed 37 to 43 % too much (Ca_G = 0.15, b = 0.1125): choose \
                           gompper-kroll (B) or j4"
                    .to_owned();
            self.doubt(&table.origin_of("method"), message);
        }
    }
}

const UNIT_SPHERE: AnyShape = AnyShape::Sphere(Sphere { radius: 1.0 });

pub(super) fn orientation(around: Reader<'_>) -> Option<Orientation> {
    let reader = around.table("orientation")?;
    Some(Orientation {
        axis: reader.vector("axis").unwrap_or_default(),
        angle: reader.needed("angle"),
    })
}

fn hold(reader: Reader<'_>) -> Hold {
    reader.number("modulus").map_or(Hold::Exact, Hold::Penalty)
}

fn bending(reader: Reader<'_>) -> Bending {
    let method = reader.text("method").and_then(|text| text.parse().ok());
    Bending {
        method: method.unwrap_or(BendingMethod::GompperKroll),
        modulus: reader.needed("modulus"),
        spontaneous_curvature: reader.number("spontaneous_curvature").unwrap_or(0.0),
    }
}
