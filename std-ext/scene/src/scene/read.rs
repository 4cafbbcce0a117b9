//! Builds a scene from the values of its file, and reports contradictions.

mod driver;
mod lattice;
mod output;
mod rheology;
mod surface;

use super::builder::Builder;
use super::check::check_table;
use super::drivers::AXES;
use super::overrides::Overrides;
use super::problem::{Problem, Problems, SceneErrors};
use super::reader::Reader;
use super::source::Source;
use super::tables::SCENE;
use super::units::{Scale, TEMPERATURE, is_thermal};
use super::value::{Origin, Origins, Table, Value};
use super::{Driver, InteractionScene, MeshFiles, Scene, SceneFile, Side, UnitSystem};
use crate::six::Six;
use crate::six::rounded;
use helfrich::Images;
use std::path::Path;
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
    let mut table = values(&source)?;
    let problems = overrides.apply(&SCENE, &mut table);
    checked(source, table, problems, MeshFiles::default())
}

/// The values of a text.
///
/// # Errors
/// If it is not TOML.
pub(super) fn values(source: &Source) -> Result<Table, SceneErrors> {
    let (document, syntax_errors) = DeTable::parse_recoverable(&source.text);
    // Errors after the first are often only its consequences.
    let start = |error: &toml::de::Error| error.span().map(|span| span.start);
    if let Some(error) = syntax_errors.into_iter().min_by_key(start) {
        let origin = error.span().map_or(Origin::File, Origin::Text);
        let message = error.message().to_owned();
        return Err(SceneErrors::from(
            source.error(&origin, Problem::Syntax { message }),
        ));
    }
    Ok(Table::new(document.get_ref(), &Origin::Text))
}

/// The scene of these values, of which some have problems already; `meshes` have been read before.
pub(super) fn checked(
    source: Source,
    table: Table,
    problems: Vec<(Origin, Problem)>,
    meshes: MeshFiles,
) -> Result<SceneFile, SceneErrors> {
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
    let mut problems = Problems(problems);
    let units = match table.get("units").map(|node| &node.value) {
        Some(Value::Text(name)) if name == "none" => UnitSystem::None,
        _ => UnitSystem::Micro,
    };
    let temperature = match table.get("temperature").map(|node| &node.value) {
        Some(Value::Integer(kelvin)) => *kelvin as f64,
        Some(Value::Float(kelvin)) => *kelvin,
        _ => TEMPERATURE,
    };
    let scale = Scale { units, temperature };
    check_table(&SCENE, "", &Origin::File, &table, scale, &mut problems);
    let origin = Origin::File;
    let mut warnings = Problems::default();
    let mut builder = Builder {
        folder: source.path.parent().unwrap_or(Path::new("")),
        problems: &mut problems,
        warnings: &mut warnings,
        barriers: Vec::new(),
        meshes,
    };
    let mut scene = builder.scene(Reader::new(&SCENE, &table, &origin, scale), units);
    let thermal = table.get("temperature").is_some() || table.any_text(&is_thermal);
    scene.temperature = thermal.then_some(temperature);
    let meshes = builder.meshes;
    if let Some(errors) = fail(problems.0) {
        return Err(errors);
    }
    let warnings = fail(warnings.0).map_or_else(Vec::new, |warnings| warnings.errors().to_vec());
    Ok(SceneFile {
        scene,
        warnings,
        origins: Origins::new(&table),
        source,
        meshes,
    })
}

impl Builder<'_> {
    fn scene(&mut self, scene: Reader<'_>, units: UnitSystem) -> Scene {
        if units == UnitSystem::None && scene.has("temperature") {
            self.contradiction(
                &scene.origin_of("temperature"),
                "`temperature` is that of the unit kT, and numbers have no units in this scene: leave it \
                 out, or choose units = \"micro\""
                    .to_owned(),
            );
        }
        let mut readers = scene.tables("surface");
        let alone = readers.len();
        let crowds = scene.tables("population");
        if !scene.has("surface") && !scene.has("population") {
            self.contradiction(
                scene.origin(),
                "the scene has no surface: add a [[surface]], or a [[population]]".to_owned(),
            );
        }
        let surfaces = readers.iter().enumerate();
        let mut surfaces =
            Vec::from_iter(surfaces.map(|(index, reader)| self.surface(index, *reader)));
        // Of each population one surface, until they have places.
        surfaces.extend(crowds.iter().map(|reader| {
            let name = reader.text("name").unwrap_or_default().to_owned();
            self.of_a_kind(name, *reader)
        }));
        readers.extend(&crowds);
        let names = surfaces.iter().map(|surface| surface.name.as_str());
        self.different("surface", &Vec::from_iter(names), &readers);
        let interactions = scene.tables("interaction");
        let barriers = interactions
            .iter()
            .map(|reader| pressure(*reader, None).barrier());
        self.barriers = barriers.collect();
        let table = scene.table("driver");
        let mut driver = table.and_then(|table| self.driver(table, &surfaces, &readers));
        let course = self.course(table);
        let images = driver.as_ref().map(Driver::images);
        let outputs = scene.table("output");
        let mut output = self.output(outputs, driver.as_ref());
        let solids = scene.tables("obstacle");
        output.rheology = self.rheology(
            outputs.and_then(|outputs| outputs.table("rheology")),
            driver.as_ref(),
            output.every,
            &surfaces,
            !solids.is_empty(),
        );
        let obstacles = self.obstacles(&solids);
        if let Some(table) = table {
            self.fit_step(table, driver.as_mut(), &output);
        }
        for (surface, reader) in surfaces.iter().zip(&readers) {
            self.effects(surface, *reader, driver.as_ref());
        }
        let populations = self.populations(
            &crowds,
            (table, driver.as_ref()),
            &mut surfaces,
            alone,
            &obstacles,
        );
        for (obstacle, solid) in obstacles.iter().zip(&solids) {
            if surfaces.iter().any(|surface| surface.name == obstacle.name) {
                let name = &obstacle.name;
                let message = format!(
                    "the obstacle has the name \"{name}\" of a surface: names have to differ, because interactions and \
                     files use them"
                );
                self.contradiction(&solid.origin_of("name"), message);
            }
        }
        let relaxes = matches!(driver, Some(Driver::Relax(_)));
        let met = driver.as_ref().is_some_and(Driver::meets_obstacles);
        let bodies = Bodies {
            names: Vec::from_iter(
                (surfaces.iter().map(|surface| surface.name.as_str()))
                    .chain(obstacles.iter().map(|obstacle| obstacle.name.as_str())),
            ),
            surfaces: surfaces.len(),
            all: surfaces.len() + if met { obstacles.len() } else { 0 },
            populations: Vec::from_iter(crowds.iter().map(|reader| {
                let name = reader.text("name").unwrap_or_default();
                let placed = populations.iter().find(|all| all.name == name);
                let side = placed.map(|all| Side {
                    first: all.surfaces.start,
                    count: all.count(),
                });
                (name, side)
            })),
        };
        if let ([], true, [first, ..]) = (interactions.as_slice(), relaxes, solids.as_slice()) {
            self.contradiction(
                first.origin(),
                "nothing keeps surfaces away from this obstacle: add an [[interaction]], or leave the \
                 obstacle out"
                    .to_owned(),
            );
        }
        let interactions = interactions
            .into_iter()
            .map(|reader| self.interaction(reader, &bodies, images.as_ref()))
            .collect();
        let scene = Scene {
            title: scene.text("title").unwrap_or_default().to_owned(),
            units,
            temperature: None,
            surfaces,
            populations,
            interactions,
            obstacles,
            driver: driver.unwrap_or(driver::PLACEHOLDER),
            course,
            output,
        };
        if let Some(table) = table {
            self.lattice_doubts(table, &scene);
        }
        scene
    }

    /// Reports names that occur twice. The named objects, called `what` in messages, are read from
    /// `readers`.
    fn different(&mut self, what: &'static str, names: &[&str], readers: &[Reader<'_>]) {
        for second in 1..names.len() {
            let name = names[second];
            if let Some(first) = names[..second].iter().position(|first| *first == name) {
                let problem = Problem::RepeatedName {
                    what,
                    name: name.to_owned(),
                    first,
                    second,
                };
                self.problems
                    .add(&readers[second].origin_of("name"), problem);
            }
        }
    }

    /// Images are not checked before it is known whether there are any.
    fn interaction(
        &mut self,
        interaction: Reader<'_>,
        bodies: &Bodies<'_>,
        images: Option<&Images<f64>>,
    ) -> InteractionScene {
        let alone = images.is_some_and(|images| !images.is_periodic());
        let names = interaction.texts("between");
        let alone_named = names.is_empty() || bodies.names.len() == 1;
        let parts = interaction.switch("parts") == Some(true);
        if bodies.all == 1 && alone_named && alone && !parts {
            self.contradiction(
                interaction.origin(),
                "an interaction acts between two surfaces, and the scene has only one: add a \
                 [[surface]], or `parts = true` for contact of the surface with itself, or leave the \
                 interaction out; in the periodic box of the driver \"lattice-boltzmann\" one would meet its \
                 images"
                    .to_owned(),
            );
        }
        let cutoff = interaction.needed("cutoff");
        if let Some(images) = images {
            self.in_one_period(&interaction.origin_of("cutoff"), cutoff, images);
        }
        let mut between = None;
        if let [a, b] = names.as_slice() {
            let origin = interaction.origin_of("between");
            let mut side = |name: &str| match bodies.named(name) {
                Ok(side) => side,
                Err(problem) => {
                    self.problems.add(&origin, problem);
                    None
                }
            };
            let names = [a, b];
            if let (Some(a), Some(b)) = (side(a), side(b)) {
                if a == b && a.count == 1 && alone && !parts {
                    self.contradiction(
                        &origin,
                        format!(
                            "`between` names \"{}\" twice: two surfaces are needed where no box is periodic, or \
                             `parts = true` for contact of the surface with itself",
                            names[0]
                        ),
                    );
                }
                if a != b && a.range().any(|surface| b.range().contains(&surface)) {
                    self.contradiction(
                        &origin,
                        format!(
                            "`between` names \"{}\" and \"{}\", of which one is part of the other: name two without \
                             common surfaces, or the population twice for all its pairs",
                            names[0], names[1]
                        ),
                    );
                }
                if a.first.min(b.first) >= bodies.surfaces {
                    self.contradiction(
                        &origin,
                        "`between` names two obstacles, which do not move: name a surface"
                            .to_owned(),
                    );
                }
                between = Some([a, b]);
            }
        }
        let found = pressure(interaction, between);
        if let InteractionScene::Adhesion { distance, .. } = found
            && distance >= cutoff
        {
            self.contradiction(
                &interaction.origin_of("distance"),
                format!(
                    "surfaces would rest at {}, beyond the reach of the adhesion, {}: choose a longer `cutoff`, such \
                     as twice the distance",
                    Six(distance),
                    Six(cutoff)
                ),
            );
        }
        found
    }

    /// With a range longer than a period, every surface would act on itself.
    fn in_one_period(&mut self, origin: &Origin, cutoff: f64, images: &Images<f64>) {
        let period = |axis: usize| images.period(axis).unwrap_or(f64::INFINITY);
        if let Some(axis) = (0..3).find(|&axis| cutoff > period(axis)) {
            self.contradiction(
                origin,
                format!(
                    "the interaction reaches {cutoff}, and the box, which is periodic along {}, is {} \
                     long: each surface would be pushed by every part of its own images: choose a \
                     shorter `cutoff`, or a longer `box`",
                    AXES[axis],
                    rounded(period(axis))
                ),
            );
        }
    }
}

/// Surfaces, populations and obstacles, of which interactions name two.
struct Bodies<'a> {
    /// The names of the surfaces, then those of the obstacles.
    names: Vec<&'a str>,
    /// Number of surfaces.
    surfaces: usize,
    /// Number of all that interact unless they are named.
    all: usize,
    /// The names of populations, with their surfaces if they have places.
    populations: Vec<(&'a str, Option<Side>)>,
}

impl Bodies<'_> {
    /// The side with this name; an error if there is none. None for a population without places, of which the reason is
    /// known already.
    fn named(&self, name: &str) -> Result<Option<Side>, Problem> {
        if let Some((_, side)) = self.populations.iter().find(|(known, _)| *known == name) {
            return Ok(*side);
        }
        if let Some(number) = self.names.iter().position(|known| *known == name) {
            return Ok(Some(number.into()));
        }
        let placed = |number: usize| {
            let sides = self.populations.iter().filter_map(|(_, side)| *side);
            sides.clone().any(|side| side.range().contains(&number))
        };
        let single = self.names.iter().enumerate();
        let single = single
            .filter(|(number, _)| !placed(*number))
            .map(|(_, name)| *name);
        let populations = self.populations.iter().map(|(name, _)| *name);
        let known = Vec::from_iter(single.chain(populations));
        Err(Problem::UnknownName {
            key: "between".to_owned(),
            name: name.to_owned(),
            nearest: super::keys::nearest(name, &known),
            known: known.join(", "),
        })
    }
}

/// An interaction between these surfaces.
fn pressure(interaction: Reader<'_>, between: Option<[Side; 2]>) -> InteractionScene {
    let cutoff = interaction.needed("cutoff");
    let parts = interaction.switch("parts") == Some(true);
    if interaction.text("kind") == Some("adhesion") {
        return InteractionScene::Adhesion {
            energy: interaction.needed("energy"),
            distance: interaction.needed("distance"),
            cutoff,
            between,
            parts,
        };
    }
    InteractionScene::Repulsion {
        strength: interaction.needed("strength"),
        cutoff,
        between,
        parts,
    }
}
