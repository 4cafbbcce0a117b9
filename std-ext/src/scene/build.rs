//! A scene from the values of its file, and what contradicts what in it.

mod driver;
mod lattice;
mod surface;

pub(super) use lattice::{BOX, rounded};

use super::check::{Problems, check_table};
use super::keys::SCENE;
use super::problem::{Problem, SceneErrors, Source};
use super::reader::Reader;
use super::value::{Origin, Origins, Overrides, Table, Value};
use super::{Interaction, Scene, SceneFile, SurfaceScene, Units};
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

    fn doubt(&mut self, origin: &Origin, message: String) {
        self.warnings.add(origin, Problem::Doubtful { message });
    }

    fn scene(&mut self, scene: Reader<'_>, units: Units) -> Scene {
        let readers = scene.tables("surface");
        let surfaces = readers.iter().enumerate();
        let surfaces = Vec::from_iter(surfaces.map(|(index, reader)| self.surface(index, *reader)));
        let names = surfaces.iter().map(|surface| surface.name.as_str());
        self.different("surface", &Vec::from_iter(names), &readers);
        let interactions = scene.tables("interaction");
        let interactions = interactions
            .into_iter()
            .map(|reader| self.interaction(reader, &surfaces))
            .collect();
        let table = scene.table("driver");
        let mut driver = table.and_then(|table| self.driver(table, &surfaces, &readers));
        let obstacles = self.obstacles(&scene.tables("obstacle"), driver.as_ref());
        let output = self.output(scene.table("output"), driver.as_ref());
        if let Some(table) = table {
            self.fit_step(table, driver.as_mut(), &output);
        }
        for (surface, reader) in surfaces.iter().zip(&readers) {
            self.effects(surface, *reader, driver.as_ref());
        }
        let scene = Scene {
            title: scene.text("title").unwrap_or_default().to_owned(),
            units,
            surfaces,
            interactions,
            obstacles,
            driver: driver.unwrap_or(driver::PLACEHOLDER),
            output,
        };
        if let Some(table) = table {
            self.lattice_doubts(table, &scene);
        }
        scene
    }

    /// Names have to differ. `what` they name is read from `readers`.
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

    fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }
}

/// v = 6√π V/A^{3/2}.
pub(super) fn reduced_volume(volume: f64, area: f64) -> f64 {
    6.0 * std::f64::consts::PI.sqrt() * volume / area.powf(1.5)
}
