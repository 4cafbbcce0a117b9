//! The files of a run for viewers: surfaces, pictures, slices of the fluid, plots.

use super::drive::Mark;
use super::measure::Values;
use super::{Run, RunError, make_folder, measure};
use crate::flow::Fluid;
use crate::io::{
    Collection, CollectionEntry, ColumnPlace, Grid, PointField, PointValues, VtkError, write_vti,
    write_vtp_with_cells,
};
use crate::picture::{
    Canvas, ColourMap, Colouring, FlowSlice, PaintedSurface, Picture, Shading, View,
};
use crate::plots::{PublishedCurve, SeriesCurve, SeriesPlot, axis_label, columns_of, read_curves};
use crate::png;
use crate::scene::{
    Driver, Flow, LatticeBoltzmann, Output, Pictures, Plot, Scene, Slice, UnitSystem,
};
use crate::series::SeriesTable;
use crate::simulation::{Acting, Body, Simulation};
use glam::DVec3;
use helfrich::{Surface, TriangleMesh};
use std::borrow::Cow;
use std::path::Path;
use std::time::Instant;

/// Width and height of the pictures, in pixels.
const PICTURE_SIZE: [u32; 2] = [900, 700];

/// A plot that is drawn when the run ends, with published curves.
#[derive(Debug)]
pub(super) struct PlannedPlot<'a> {
    plot: &'a Plot,
    published: Vec<PublishedCurve>,
}

impl<'a> PlannedPlot<'a> {
    /// Reads the published curves and checks the columns before anything is computed.
    pub(super) fn new(
        plot: &'a Plot,
        columns: &[String],
        simulation: &Simulation,
    ) -> Result<Self, RunError> {
        let table = SeriesTable {
            columns: columns.to_vec(),
            rows: Vec::new(),
        };
        let names = simulation.bodies().iter().map(|body| body.name());
        for column in [&plot.column, &plot.against] {
            if columns_of(&table, column, names.clone()).is_empty() {
                return Err(RunError::NoColumn {
                    column: column.clone(),
                    known: columns.to_vec(),
                });
            }
        }
        let published = match &plot.published {
            Some(path) => read_curves(path)?,
            None => Vec::new(),
        };
        Ok(Self { plot, published })
    }
}

/// Refuses PNG files that this build cannot write.
pub(super) fn refuse_pictures(output: &Output) -> Result<(), RunError> {
    let wanted = [
        ("pictures", output.pictures != Pictures::Never),
        ("plot", !output.plots.is_empty()),
        ("slice", !output.slices.is_empty()),
    ];
    let wanted = wanted.into_iter().find(|&(_, wanted)| wanted);
    match wanted {
        Some((key, _)) if !png::IS_ENABLED => Err(RunError::NoPictures { key }),
        _ => Ok(()),
    }
}

/// Writes into a folder, which is made if necessary, and made again if somebody removes it meanwhile.
fn into_folder(folder: &Path, write: impl Fn() -> Result<(), RunError>) -> Result<(), RunError> {
    const TRIES: usize = 5;
    for _ in 1..TRIES {
        make_folder(folder)?;
        match write() {
            Err(_) if !folder.is_dir() => {}
            written => return written,
        }
    }
    make_folder(folder)?;
    write()
}

fn save_picture(canvas: &Canvas, path: &Path) -> Result<(), RunError> {
    png::write(canvas, path).map_err(|source| RunError::Unwritable {
        path: path.to_owned(),
        source,
    })
}

/// Surfaces that are in one file: a surface, or those of a population.
pub(super) struct Shown<'a> {
    name: &'a str,
    bodies: &'a [Body],
    is_population: bool,
}

/// Writes a file whose content is ready.
type Write<'a> = dyn Fn() -> Result<(), RunError> + 'a;

/// Fields by their names.
type Fields = Vec<(String, Values)>;

impl<'a> Shown<'a> {
    /// All surfaces of a scene, file by file.
    pub(super) fn all(scene: &'a Scene, simulation: &'a Simulation) -> Vec<Self> {
        let bodies = simulation.bodies();
        let alone = scene.populations.first();
        let alone = alone.map_or(bodies.len(), |population| population.surfaces.start);
        let alone = bodies[..alone].chunks(1).map(|bodies| Self {
            name: bodies[0].name(),
            bodies,
            is_population: false,
        });
        let populations = scene.populations.iter().map(|population| Self {
            name: &population.name,
            bodies: &bodies[population.surfaces.clone()],
            is_population: true,
        });
        alone.chain(populations).collect()
    }

    /// The name of the file with the last state of one of `count` of these.
    pub(super) fn last_name(&self, count: usize) -> String {
        match count {
            1 => "last.vtp".to_owned(),
            _ => format!("last-{}.vtp", self.name),
        }
    }

    /// Writes the surfaces with these fields and the columns of their mesh file that belong to their material, and for a
    /// population with the numbers of its surfaces, from 1 on, as the column `cell`.
    fn write(
        &self,
        path: &Path,
        positions: &[[f64; 3]],
        mark: Mark,
        fields: &dyn Fn(&Body) -> Fields,
        around: &dyn Fn(&Write<'_>) -> Result<(), RunError>,
    ) -> Result<(), RunError> {
        let mut points = Fields::new();
        let mut cells = Fields::new();
        let mut triangles = Vec::new();
        let [first, last] = [0, self.bodies.len() - 1].map(|number| &self.bodies[number]);
        let vertices = first.vertices().start..last.vertices().end;
        for (number, body) in (1..).zip(self.bodies) {
            let mut own = fields(body);
            let is_free = |name: &str| own.iter().all(|(known, _)| known != name);
            let mut material = columns(body, ColumnPlace::Vertices);
            material.retain(|(name, _)| is_free(name));
            own.extend(material);
            if self.is_population {
                let cell = vec![f64::from(number); body.vertices().len()];
                own.push(("cell".to_owned(), Values::Scalars(cell)));
                let begin = (body.vertices().start - vertices.start) as u32;
                let own = body.mesh().triangles().iter();
                triangles.extend(own.map(|corners| corners.map(|corner| corner + begin)));
            }
            join(&mut points, own);
            join(&mut cells, columns(body, ColumnPlace::Triangles));
        }
        let joined;
        let mesh = if self.is_population {
            joined = TriangleMesh::new(vertices.len(), triangles)
                .map_err(|error| RunError::Output(Box::new(error)))?;
            &joined
        } else {
            first.mesh()
        };
        let [points, cells] =
            [&points, &cells].map(|fields| Vec::from_iter(fields.iter().map(point_field)));
        let own = &positions[vertices];
        // The content is ready: somebody may remove the folder meanwhile.
        around(&|| {
            write_vtp_with_cells(path, mesh, own, Some(mark.time), &points, &cells)
                .map_err(|error: VtkError| RunError::Output(Box::new(error)))
        })
    }
}

fn point_field((name, values): &(String, Values)) -> PointField<'_> {
    PointField {
        name,
        values: match values {
            Values::Scalars(values) => PointValues::Scalars(values),
            Values::Vectors(values) => PointValues::Vectors(values),
        },
    }
}

/// Appends the fields of a surface to those of others, which have the same ones.
fn join(all: &mut Fields, own: Fields) {
    if all.is_empty() {
        *all = own;
        return;
    }
    for ((_, all), (_, own)) in all.iter_mut().zip(own) {
        match (all, own) {
            (Values::Scalars(all), Values::Scalars(own)) => all.extend(own),
            (Values::Vectors(all), Values::Vectors(own)) => all.extend(own),
            _ => {}
        }
    }
}

/// The columns of the mesh file of a surface that belong to its material, at its vertices or triangles.
fn columns(body: &Body, place: ColumnPlace) -> Fields {
    let columns = body.columns().iter();
    let columns = columns.filter(|column| column.place == place);
    let fields =
        columns.map(|column| (column.name.clone(), Values::Scalars(column.values.clone())));
    fields.collect()
}

/// The obstacles of a scene.
fn solids(simulation: &Simulation) -> impl Iterator<Item = Surface<'_, f64>> {
    let obstacles = simulation.obstacles().iter();
    obstacles.filter_map(|obstacle| Surface::new(&obstacle.mesh, &obstacle.positions).ok())
}

impl Run<'_> {
    pub(super) fn write_surfaces(&mut self, mark: Mark, acting: &[Acting]) -> Result<(), RunError> {
        let folder = self.folder.join("surfaces");
        let positions = self.drive.positions();
        let shown = Shown::all(self.scene, &self.simulation);
        for (part, shown) in shown.into_iter().enumerate() {
            let fields = |body: &Body| measure::fields(body, positions, acting);
            let name = format!("surfaces/{}-{:08}.vtp", shown.name, mark.number);
            let path = self.folder.join(&name);
            shown.write(&path, positions, mark, &fields, &|write| {
                into_folder(&folder, write)
            })?;
            self.outputs.files.entries.push(CollectionEntry {
                time: mark.time,
                part,
                file: name,
            });
        }
        self.write_index("surfaces.pvd", &self.outputs.files)
    }

    /// The surfaces at the end of the run, from which another run can start: `last.vtp`, or
    /// `last-NAME.vtp` for each of several, or for a population. They have the columns on which the scene depends.
    pub(super) fn write_last(&self) -> Result<(), RunError> {
        let mark = self.drive.mark();
        let positions = self.drive.positions();
        let shown = Shown::all(self.scene, &self.simulation);
        let count = shown.len();
        for shown in shown {
            let path = self.folder.join(shown.last_name(count));
            shown.write(&path, positions, mark, &|_| Vec::new(), &|write| write())?;
        }
        Ok(())
    }

    /// All surfaces in one picture, coloured by the scene's field, and obstacles in grey.
    pub(super) fn draw(&mut self, mark: Mark, acting: &[Acting]) -> Result<(), RunError> {
        let folder = self.folder.join("pictures");
        let positions = self.drive.positions();
        let scene = self.scene;
        let field = scene.output.picture_field;
        let bodies = self.simulation.bodies();
        let fields = Vec::from_iter(
            bodies
                .iter()
                .map(|body| measure::picture_field(body, positions, acting, field)),
        );
        let shown = match scene.driver {
            Driver::LatticeBoltzmann(lattice) if !scene.populations.is_empty() => {
                let [corner, _] = lattice.corners();
                Cow::Owned(self.simulation.within_period(corner, positions))
            }
            _ => Cow::Borrowed(positions),
        };
        let painted = |surface, field| PaintedSurface {
            surface,
            field,
            shading: Shading::Smooth,
            edges: false,
            strokes: None,
        };
        let surfaces = bodies.iter().zip(&fields);
        let surfaces = surfaces
            .filter_map(|(body, field)| Some(painted(body.surface(&shown)?, field.as_deref())));
        let solids = solids(&self.simulation).map(|surface| painted(surface, None));
        let surfaces = Vec::from_iter(surfaces.chain(solids));
        let signed = fields.iter().flatten().flatten().any(|&value| value < 0.0);
        let label = measure::picture_label(field, scene.units);
        let picture = Picture {
            size: PICTURE_SIZE,
            title: &self.caption(),
            surfaces: &surfaces,
            colours: Colouring {
                label: &label,
                range: None,
                map: if signed {
                    ColourMap::Diverging
                } else {
                    ColourMap::Sequential
                },
            },
            view: View {
                frame: Some(self.measures.frame(&shown)),
                ..view(scene)
            },
            length_unit: match scene.units {
                UnitSystem::Micro => Some("µm"),
                UnitSystem::None => None,
            },
        };
        let path = folder.join(format!("{:08}.png", mark.number));
        let canvas = picture
            .draw()
            .map_err(|error| RunError::Output(Box::new(error)))?;
        into_folder(&folder, || save_picture(&canvas, &path))
    }

    /// The names of the columns of the scene's probes.
    pub(super) fn probe_columns(scene: &Scene) -> Vec<String> {
        let probes = scene.output.probes.iter();
        let columns = probes.flat_map(|probe| ["x", "y", "z"].map(|axis| (probe, axis)));
        let columns = columns.map(|(probe, axis)| format!("{}_{axis}", probe.name));
        columns.collect()
    }

    /// The velocity at each probe; NaN where there is no fluid.
    pub(super) fn probe(&mut self) -> Vec<f64> {
        let points = self.scene.output.probes.iter().map(|probe| probe.point);
        let points = Vec::from_iter(points);
        if points.is_empty() {
            return Vec::new();
        }
        match self.drive.fluid_at(&mut self.simulation, &points) {
            Some(fluid) => fluid.velocity.concat(),
            None => vec![f64::NAN; 3 * points.len()],
        }
    }

    /// Velocity and pressure on a grid, as a file; none if there is no fluid.
    fn write_fluid(
        &mut self,
        mark: Mark,
        grid: &Grid,
        folder: &str,
        name: &str,
    ) -> Result<Option<(String, Fluid)>, RunError> {
        let points = Vec::from_iter(grid.points());
        let Some(fluid) = self.drive.fluid_at(&mut self.simulation, &points) else {
            return Ok(None);
        };
        let start = Instant::now();
        let name = format!("{folder}/{name}-{:08}.vti", mark.number);
        let fields = [
            PointField {
                name: "velocity",
                values: PointValues::Vectors(&fluid.velocity),
            },
            PointField {
                name: "pressure",
                values: PointValues::Scalars(&fluid.pressure),
            },
        ];
        into_folder(&self.folder.join(folder), || {
            write_vti(&self.folder.join(&name), grid, Some(mark.time), &fields)
                .map_err(|error: VtkError| RunError::Output(Box::new(error)))
        })?;
        self.outputs.output_costs.files.add(start);
        Ok(Some((name, fluid)))
    }

    /// Velocity and pressure in the whole box of the scene's driver.
    pub(super) fn write_volumes(&mut self, mark: Mark) -> Result<(), RunError> {
        let scene = self.scene;
        let Driver::LatticeBoltzmann(driver) = scene.driver else {
            return Ok(());
        };
        for (part, volume) in scene.output.volumes.iter().enumerate() {
            let grid = nodes(&driver, volume.stride);
            if let Some((file, _)) = self.write_fluid(mark, &grid, "volumes", &volume.name)? {
                self.outputs.volumes.entries.push(CollectionEntry {
                    time: mark.time,
                    part,
                    file,
                });
            }
        }
        if scene.output.volumes.is_empty() {
            return Ok(());
        }
        self.write_index("volumes.pvd", &self.outputs.volumes)
    }

    /// Velocity and pressure on the scene's slices, as files and pictures.
    pub(super) fn write_slices(&mut self, mark: Mark) -> Result<(), RunError> {
        let scene = self.scene;
        for (part, slice) in scene.output.slices.iter().enumerate() {
            let grid = grid(slice);
            let written = self.write_fluid(mark, &grid, "slices", &slice.name)?;
            let Some((name, fluid)) = written else {
                continue;
            };
            let start = Instant::now();
            let bodies = self.simulation.bodies().iter();
            let positions = self.drive.positions();
            let surfaces = bodies.filter_map(|body| body.surface(positions));
            let surfaces = Vec::from_iter(surfaces.chain(solids(&self.simulation)));
            let (length, speed) = match scene.units {
                UnitSystem::Micro => (Some("µm"), "|u| (µm/s)"),
                UnitSystem::None => (None, "|u|"),
            };
            let picture = FlowSlice {
                size: PICTURE_SIZE,
                title: &self.caption(),
                grid,
                velocity: &fluid.velocity,
                field: None,
                colours: Colouring {
                    label: speed,
                    range: None,
                    map: ColourMap::Sequential,
                },
                surfaces: &surfaces,
                length_unit: length,
            };
            let canvas = picture
                .draw()
                .map_err(|error| RunError::Output(Box::new(error)))?;
            let folder = self.folder.join("slices");
            let path = folder.join(format!("{}-{:08}.png", slice.name, mark.number));
            into_folder(&folder, || save_picture(&canvas, &path))?;
            self.outputs.output_costs.pictures.add(start);
            self.outputs.slices.entries.push(CollectionEntry {
                time: mark.time,
                part,
                file: name,
            });
        }
        if scene.output.slices.is_empty() {
            return Ok(());
        }
        self.write_index("slices.pvd", &self.outputs.slices)
    }

    /// The series so far, as the scene's plots.
    pub(super) fn draw_plots(&self) -> Result<(), RunError> {
        if self.plots.is_empty() {
            return Ok(());
        }
        let table =
            SeriesTable::read(&self.folder.join(super::SERIES)).map_err(RunError::Series)?;
        let folder = self.folder.join("plots");
        let names = || self.simulation.bodies().iter().map(|body| body.name());
        for PlannedPlot { plot, published } in &self.plots {
            let columns = columns_of(&table, &plot.column, names());
            // All surfaces over one column, or each surface over its own.
            let against = columns_of(&table, &plot.against, names());
            let curves = columns.iter().enumerate().map(|(index, (name, column))| {
                let (_, against) = &against[index.min(against.len() - 1)];
                SeriesCurve {
                    name: if columns.len() == 1 { "this run" } else { name },
                    table: &table,
                    against,
                    column,
                }
            });
            let curves = Vec::from_iter(curves);
            let picture = SeriesPlot {
                size: PICTURE_SIZE,
                title: &self.scene.title,
                labels: [axis_label(&plot.against), axis_label(&plot.column)],
                curves: &curves,
                marked: false,
                hollow: &[],
                published,
            };
            let canvas = picture
                .draw()
                .map_err(|error| RunError::Output(Box::new(error)))?;
            let path = folder.join(format!("{}.png", plot.column));
            into_folder(&folder, || save_picture(&canvas, &path))?;
        }
        Ok(())
    }

    /// The title of a picture: the title of the scene, and the progress.
    fn caption(&self) -> String {
        match self.scene.title.as_str() {
            "" => self.drive.caption(),
            title => format!("{title}, {}", self.drive.caption()),
        }
    }

    fn write_index(&self, name: &str, files: &Collection) -> Result<(), RunError> {
        let path = self.folder.join(name);
        let written = files.write(&path);
        written.map_err(|source| RunError::Unwritable { path, source })
    }
}

/// The view: onto the plane of a shear flow, otherwise from above and to the side.
fn view(scene: &Scene) -> View {
    match scene.driver.flow().and_then(Flow::plane) {
        Some([flow, gradient]) => View {
            direction: DVec3::from(flow).cross(gradient.into()).to_array(),
            up: gradient,
            frame: None,
        },
        None => View::default(),
    }
}

/// Nodes of a lattice with a stride.
fn nodes(driver: &LatticeBoltzmann, stride: usize) -> Grid {
    let [corner, _] = driver.corners();
    Grid {
        origin: corner.map(|coordinate| coordinate + 0.5 * driver.spacing),
        axes: Grid::AXES,
        spacings: [stride as f64 * driver.spacing; 3],
        counts: driver.cells.map(|count| count.div_ceil(stride)),
    }
}

/// The points of a slice.
fn grid(slice: &Slice) -> Grid {
    let [first, second] = slice.axes();
    let normal = DVec3::from(first).cross(second.into());
    let [width, height] = slice.size;
    let [columns, rows] = slice.points;
    let corner = DVec3::from(slice.centre)
        - 0.5 * (width * DVec3::from(first) + height * DVec3::from(second));
    let spacing = |length: f64, count: usize| length / (count.max(2) - 1) as f64;
    let spacings = [spacing(width, columns), spacing(height, rows), 1.0];
    Grid {
        origin: corner.to_array(),
        axes: [first, second, normal.to_array()],
        spacings,
        counts: [columns, rows, 1],
    }
}
