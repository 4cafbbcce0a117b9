//! A scene from the values of its file, and what contradicts what in it.

use super::check::{Problems, Reader, check_table};
use super::keys::SCENE;
use super::problem::{Problem, SceneErrors, Source};
use super::value::{Origin, Origins, Overrides, Table, Value, default_name};
use super::{
    AreaDifferenceTarget, Bending, Driver, Elasticity, Gravity, Held, Hold, InPlaneLaw,
    Interaction, LocalArea, MembraneViscosity, MeshSource, Orientation, Output, PictureField,
    Reference, ReferenceSource, Relax, Scene, SceneFile, Scheme, Stretching, SurfaceScene, Target,
    Units, VolumeTarget,
};
use crate::generate::{AnyShape, Family, check as check_mesh};
use crate::method::BendingMethod;
use helfrich::shapes::Sphere;
use std::path::{Path, PathBuf};
use toml::de::DeTable;

pub(super) fn parse(
    text: &str,
    path: &Path,
    overrides: &Overrides,
) -> Result<SceneFile, SceneErrors> {
    let source = Source {
        path: path.to_owned(),
        text: text.to_owned(),
        overrides: overrides.clone(),
    };
    let fail = |problems: Vec<(Origin, Problem)>| {
        let mut problems = problems;
        problems.sort_by_key(|(origin, _)| match origin {
            Origin::File => (0, 0),
            Origin::Text(range) => (1, range.start),
            Origin::Override(index) => (2, *index),
        });
        let errors = problems
            .into_iter()
            .map(|(origin, problem)| source.error(&origin, problem));
        SceneErrors::new(errors.collect())
    };
    let (document, syntax_errors) = DeTable::parse_recoverable(text);
    // What follows the first error is often only its echo.
    let start = |error: &toml::de::Error| error.span().map(|span| span.start);
    if let Some(error) = syntax_errors.into_iter().min_by_key(start) {
        let origin = error.span().map_or(Origin::File, Origin::Text);
        let message = error.message().to_owned();
        return Err(SceneErrors::from(
            source.error(&origin, Problem::Syntax { message }),
        ));
    }
    let mut table = Table::new(document.get_ref(), &Origin::Text);
    let mut problems = Problems(overrides.apply(&SCENE, &mut table));
    let units = match table.get("units").map(|node| &node.value) {
        Some(Value::Text(name)) if name == "none" => Units::None,
        _ => Units::Micro,
    };
    check_table(&SCENE, "", &Origin::File, &table, units, &mut problems);
    let origin = Origin::File;
    let mut warnings = Problems::default();
    let mut builder = Builder {
        folder: path.parent().unwrap_or(Path::new("")),
        problems: &mut problems,
        warnings: &mut warnings,
    };
    let scene = builder.scene(Reader::new(&SCENE, &table, &origin), units);
    if let Some(errors) = fail(problems.0) {
        return Err(errors);
    }
    let warnings = fail(warnings.0).map_or_else(Vec::new, |warnings| warnings.errors().to_vec());
    Ok(SceneFile {
        scene,
        warnings,
        origins: Origins::new(&table),
        source,
    })
}

struct Builder<'a> {
    /// The scene file's.
    folder: &'a Path,
    problems: &'a mut Problems,
    warnings: &'a mut Problems,
}

impl Builder<'_> {
    fn contradiction(&mut self, origin: &Origin, message: String) {
        self.problems
            .add(origin, Problem::Contradiction { message });
    }

    fn scene(&mut self, scene: Reader<'_>, units: Units) -> Scene {
        let readers = scene.tables("surface");
        let mut surfaces = Vec::with_capacity(readers.len());
        for (index, reader) in readers.iter().enumerate() {
            let surface = self.surface(index, *reader);
            self.effects(&surface, *reader);
            surfaces.push(surface);
        }
        for second in 1..surfaces.len() {
            let name = &surfaces[second].name;
            let first = surfaces[..second]
                .iter()
                .position(|first| first.name == *name);
            if let Some(first) = first {
                let problem = Problem::RepeatedName {
                    name: name.clone(),
                    first,
                    second,
                };
                self.problems
                    .add(&readers[second].origin_of("name"), problem);
            }
        }
        let interactions = scene.tables("interaction");
        let interactions = interactions
            .into_iter()
            .map(|reader| self.interaction(reader, &surfaces))
            .collect();
        let driver = Driver::Relax(self.relax(scene.table("driver"), &surfaces, &readers));
        Scene {
            title: scene.text("title").unwrap_or_default().to_owned(),
            units,
            surfaces,
            interactions,
            driver,
            output: output(scene.table("output")),
        }
    }

    fn surface(&mut self, index: usize, surface: Reader<'_>) -> SurfaceScene {
        let name = match surface.text("name") {
            Some(name) => name.to_owned(),
            None => default_name(index),
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
            orientation: surface.table("orientation").map(|reader| Orientation {
                axis: reader.vector("axis").unwrap_or_default(),
                angle: reader.needed("angle"),
            }),
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

    fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    fn source(&mut self, surface: Reader<'_>) -> MeshSource {
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

    fn interaction(&mut self, interaction: Reader<'_>, surfaces: &[SurfaceScene]) -> Interaction {
        if surfaces.len() == 1 {
            self.contradiction(
                interaction.origin(),
                "an interaction acts between two surfaces, and the scene has only one: add a \
                 [[surface]], or leave the interaction out"
                    .to_owned(),
            );
        }
        let names = interaction.texts("between");
        let mut between = None;
        if let [a, b] = names.as_slice() {
            let known = Vec::from_iter(surfaces.iter().map(|surface| surface.name.as_str()));
            let origin = interaction.origin_of("between");
            let mut index = |name: &str| {
                let found = known.iter().position(|known| *known == name);
                if found.is_none() {
                    let problem = Problem::UnknownName {
                        key: "between".to_owned(),
                        name: name.to_owned(),
                        nearest: super::keys::nearest(name, &known),
                        known: known.join(", "),
                    };
                    self.problems.add(&origin, problem);
                }
                found
            };
            if let (Some(a), Some(b)) = (index(a), index(b)) {
                if a == b {
                    self.contradiction(
                        &origin,
                        format!(
                            "`between` names \"{}\" twice: two surfaces are needed",
                            known[a]
                        ),
                    );
                }
                between = Some([a, b]);
            }
        }
        Interaction::Repulsion {
            strength: interaction.needed("strength"),
            cutoff: interaction.needed("cutoff"),
            between,
        }
    }

    /// The driver, and what surfaces ask for that it has not.
    fn relax(
        &mut self,
        driver: Option<Reader<'_>>,
        surfaces: &[SurfaceScene],
        readers: &[Reader<'_>],
    ) -> Relax {
        let text = |key| driver.and_then(|driver| driver.text(key));
        for (surface, reader) in surfaces.iter().zip(readers) {
            if surface.viscosity_ratio.is_some_and(|ratio| ratio != 1.0) {
                self.contradiction(
                    &reader.origin_of("viscosity_ratio"),
                    "the driver \"relax\" has no flow, and no viscosities: leave `viscosity_ratio` \
                     out"
                        .to_owned(),
                );
            }
            if surface.membrane_viscosity.is_some() {
                self.contradiction(
                    &reader.origin_of("membrane_viscosity"),
                    "the driver \"relax\" has no time, and nothing that a viscosity slows down: \
                     leave [surface.membrane_viscosity] out"
                        .to_owned(),
                );
            }
        }
        let strong_form = |surface: &&SurfaceScene| !surface.is_conservative();
        let strong_form = surfaces.iter().find(strong_form);
        let scheme = match text("scheme") {
            Some("minimise") => Scheme::Minimise,
            Some("overdamped") => Scheme::Overdamped,
            _ if strong_form.is_none() => Scheme::Minimise,
            _ => Scheme::Overdamped,
        };
        if let (Scheme::Minimise, Some(surface), Some(driver)) = (scheme, strong_form, driver) {
            let method = surface.bending.map_or("", |bending| bending.method.name());
            self.contradiction(
                &driver.origin_of("scheme"),
                format!(
                    "scheme = \"minimise\" needs an energy, and {method}, the bending method of \
                     \"{}\", has none: choose \"overdamped\" or \"auto\", or one of the methods {}",
                    surface.name,
                    conservative_methods()
                ),
            );
        }
        let number = |key| driver.and_then(|driver| driver.number(key));
        let count = |key| driver.and_then(|driver| driver.count(key));
        let fluid = surfaces.iter().any(SurfaceScene::is_fluid);
        let redistribution = driver.and_then(|driver| driver.switch("redistribution"));
        if let (Some(true), false, Some(driver)) = (redistribution, fluid, driver) {
            self.contradiction(
                &driver.origin_of("redistribution"),
                "redistribution moves vertices along fluid membranes, and every surface is elastic: \
                 choose false or \"auto\""
                    .to_owned(),
            );
        }
        Relax {
            scheme,
            residual: number("residual").unwrap_or(1e-5),
            iterations: count("iterations").unwrap_or(10_000),
            redistribution: redistribution.unwrap_or(fluid),
        }
    }

    /// What is right by itself and wrong, or doubtful, together.
    fn effects(&mut self, surface: &SurfaceScene, reader: Reader<'_>) {
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
        if surface.elasticity.is_some() && surface.bending.is_none() {
            let message = format!(
                "\"{name}\" is elastic and has no bending: where it is compressed it wrinkles at the \
                 scale of its mesh, more so on a finer one: add [surface.bending]"
            );
            let origin = reader.origin_of("elasticity");
            self.warnings.add(&origin, Problem::Doubtful { message });
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
            let origin = reader.origin_of(key);
            self.warnings.add(&origin, Problem::Doubtful { message });
        }
        if surface.gravity.is_some() {
            let message = format!(
                "\"{name}\" has a weight and nothing that carries it: the driver \"relax\" finds no \
                 equilibrium, and ends by its iterations"
            );
            let origin = reader.origin_of("gravity");
            self.warnings.add(&origin, Problem::Doubtful { message });
        }
        if !surface.has_effects() {
            let message =
                format!("nothing acts on \"{name}\": add an effect, such as [surface.bending]");
            self.warnings
                .add(reader.origin(), Problem::Doubtful { message });
        }
    }
}

/// v = 6√π V/A^{3/2}.
pub(super) fn reduced_volume(volume: f64, area: f64) -> f64 {
    6.0 * std::f64::consts::PI.sqrt() * volume / area.powf(1.5)
}

fn conservative_methods() -> String {
    let all = BendingMethod::ALL.into_iter();
    let names = all
        .filter(|method| method.is_conservative())
        .map(BendingMethod::name);
    Vec::from_iter(names).join(", ")
}

const UNIT_SPHERE: AnyShape = AnyShape::Sphere(Sphere { radius: 1.0 });

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

fn output(output: Option<Reader<'_>>) -> Output {
    let count = |key| output.and_then(|output| output.count(key));
    let switch = |key| output.and_then(|output| output.switch(key));
    Output {
        every: count("every").unwrap_or(100),
        surfaces: switch("surfaces").unwrap_or(true),
        pictures: switch("pictures").unwrap_or(true),
        picture_field: match output.and_then(|output| output.text("picture_field")) {
            Some("gaussian-curvature") => PictureField::GaussianCurvature,
            Some("bending-force") => PictureField::BendingForce,
            _ => PictureField::MeanCurvature,
        },
        checkpoint_every: count("checkpoint_every").unwrap_or(1000),
    }
}
