//! Builds the driver `lattice-boltzmann` from its values.

use super::super::builder::Builder;
use super::super::reader::Reader;
use super::super::value::{Origin, default_name};
use super::super::{
    Driver, Every, Flow, LatticeBoltzmann, MeshFileSource, MeshFiles, MeshSource, ObstacleScene,
    Output, Scene, SurfaceScene,
};
use crate::flow::lattice_boltzmann::Kernel;
use crate::flow::lattice_boltzmann::limits::{
    FREE_BOX, ImmersedMembrane, MACH, VISCOSITIES, default_viscosity,
};
use crate::generate;
use crate::io::free_memory;
use crate::scalar::Scalar;
use crate::six::rounded;
use helfrich::Surface;
use std::f64::consts::PI;

/// The largest number of nodes; more fit into no machine's memory.
const NODES: f64 = 1e10;

impl Builder<'_> {
    pub(super) fn lattice_boltzmann(
        &mut self,
        driver: Reader<'_>,
        surfaces: &[SurfaceScene],
        readers: &[Reader<'_>],
    ) -> LatticeBoltzmann {
        let flow = self.flow(driver.table("flow"));
        self.flow_in_a_box(driver, flow);
        let fixed = |key| driver.has(key);
        // Mesh files are read here only if a number depends on them.
        let asks = fixed("resolution") || !fixed("box") || !fixed("step");
        let membranes = match asks {
            true => self.membranes(surfaces, readers),
            false => Vec::new(),
        };
        let spacing = match driver.number("resolution") {
            Some(resolution) => {
                let radii = membranes.iter().map(|membrane| membrane.radius);
                radii.fold(f64::NAN, f64::min) / resolution
            }
            None => driver.needed("spacing"),
        };
        let lengths = self.lengths(driver, &membranes, surfaces.len());
        let cells = self.cells(driver, spacing, lengths);
        let side = |axis: usize| cells[axis] as f64 * spacing;
        let flow = match flow {
            Flow::Channel {
                centre_velocity,
                depth,
                ..
            } => Flow::Channel {
                centre_velocity,
                width: side(1),
                depth: depth.map(|_| side(2)),
            },
            flow => flow,
        };
        self.volumes_kept(driver, surfaces);
        let mut lattice = LatticeBoltzmann {
            viscosity: driver.needed("viscosity"),
            density: driver.number("density"),
            flow,
            duration: self.duration(driver, flow),
            spacing,
            cells,
            centre: driver.vector("centre").unwrap_or_default(),
            lattice_viscosity: driver.number("lattice_viscosity").unwrap_or_else(|| {
                let ratios = surfaces
                    .iter()
                    .filter_map(|surface| surface.viscosity_ratio);
                default_viscosity(ratios)
            }),
            step: driver.needed("step"),
            kernel: match driver.text("kernel") {
                Some("three") => Kernel::Three,
                Some("four") => Kernel::Four,
                _ => Kernel::Two,
            },
            precision: match driver.text("precision") {
                Some("f32") => Scalar::F32,
                _ => Scalar::F64,
            },
            volume_correction: driver.switch("volume_correction").unwrap_or(true),
            redistribution: self.redistribution(driver, surfaces, SurfaceScene::slides),
        };
        self.step(driver, &mut lattice, &membranes);
        lattice
    }

    /// Warnings about the lattice that do not depend on meshes, once its step is known.
    pub(super) fn lattice_doubts(&mut self, driver: Reader<'_>, scene: &Scene) {
        let Driver::LatticeBoltzmann(lattice) = scene.driver else {
            return;
        };
        let place = |key: &str, or: &str| match driver.has(key) {
            true => driver.origin_of(key),
            false => driver.origin_of(or),
        };
        let viscosity = lattice.lattice_viscosity;
        if !VISCOSITIES.contains(&viscosity) && viscosity.is_finite() {
            let nearest = viscosity.clamp(*VISCOSITIES.start(), *VISCOSITIES.end());
            let change = match lattice.density {
                None => format!("choose a `lattice_viscosity` of {nearest}"),
                Some(_) => format!(
                    "choose a `step` of {}, or another `spacing`",
                    rounded(lattice.step * nearest / viscosity)
                ),
            };
            let message = format!(
                "the viscosity on the lattice is {}, and best lies between 0.02 and 1: below, it comes \
                 near to instability, above, walls and membranes act at a distance: {change}",
                rounded(viscosity)
            );
            self.doubt(&place("lattice_viscosity", "step"), message);
        }
        let mach = lattice.parameters().mach();
        if mach > MACH {
            let what = match lattice.flow {
                Flow::Shear { .. } => "the walls move",
                _ => "the fluid moves",
            };
            let message = format!(
                "{what} with a Mach number of {} on the lattice, above {MACH}, and errors by \
                 compressibility go with its square: choose a `step` of {}",
                rounded(mach),
                rounded(lattice.step * MACH / mach)
            );
            self.doubt(&place("step", "lattice_viscosity"), message);
        }
        let needed = scene.lattice_memory().iter().sum::<u64>();
        if let Some(free) = free_memory()
            && needed > free
        {
            let gigabytes = |bytes: u64| rounded(bytes as f64 / 1e9);
            let precision = match lattice.precision {
                Scalar::F64 => "`precision` = \"f32\", which takes half of it, ",
                _ => "",
            };
            let enough = lattice.spacing * (needed as f64 / free as f64).cbrt();
            let message = format!(
                "the lattice takes {} GB of memory, and {} are free: choose {precision}a `spacing` of \
                 {}, or a smaller `box`",
                gigabytes(needed),
                gigabytes(free),
                rounded(enough)
            );
            self.doubt(&place("spacing", "resolution"), message);
        }
    }

    /// Warnings about a surface in a box.
    pub(super) fn in_a_box(
        &mut self,
        surface: &SurfaceScene,
        reader: Reader<'_>,
        lattice: &LatticeBoltzmann,
    ) {
        let SurfaceScene { name, .. } = surface;
        let ratio = surface.viscosity_ratio.unwrap_or(1.0);
        let inside = ratio * lattice.lattice_viscosity;
        let [least, most] = [*VISCOSITIES.start(), *VISCOSITIES.end()];
        if VISCOSITIES.contains(&lattice.lattice_viscosity)
            && !VISCOSITIES.contains(&inside)
            && inside.is_finite()
        {
            let outside = if ratio > 1.0 {
                most / ratio
            } else {
                least / ratio
            };
            let change = if !VISCOSITIES.contains(&outside) {
                "no viscosity outside is right for both: choose a ratio between 1/50 and 50, or the \
                 driver \"boundary-integral\""
                    .to_owned()
            } else if lattice.density.is_some() {
                let step = lattice.step * outside / lattice.lattice_viscosity;
                format!("choose a `step` of {}", rounded(step))
            } else {
                format!("choose a `lattice_viscosity` of {}", rounded(outside))
            };
            let message = format!(
                "the viscosity on the lattice is {} inside of \"{name}\", and best lies between {least} \
                 and {most}: {change}",
                rounded(inside)
            );
            self.doubt(&reader.origin_of("viscosity_ratio"), message);
        }
    }

    /// Refuses flows that are not possible in a box.
    fn flow_in_a_box(&mut self, driver: Reader<'_>, flow: Flow) {
        let instead = match flow {
            Flow::Quiescent | Flow::Shear { .. } | Flow::Channel { .. } => return,
            Flow::Poiseuille { .. } => "\"channel\"",
            _ => "\"quiescent\", \"shear\" or \"channel\"",
        };
        if let Some(table) = driver.table("flow") {
            self.contradiction(
                &table.origin_of("kind"),
                format!(
                    "the flow \"{}\" is one of unbounded fluid, and the driver \"lattice-boltzmann\" \
                     has a box: choose {instead}, or the driver \"boundary-integral\"",
                    flow.name()
                ),
            );
        }
    }

    /// Properties of the surfaces; `None` if those of one surface are unknown.
    fn membranes(
        &mut self,
        surfaces: &[SurfaceScene],
        readers: &[Reader<'_>],
    ) -> Vec<ImmersedMembrane> {
        let mut membranes = Vec::with_capacity(surfaces.len());
        for (surface, reader) in surfaces.iter().zip(readers) {
            let measured = match &surface.source {
                MeshSource::Shape {
                    shape, vertices, ..
                } => {
                    // The error of a wrong count has been reported already.
                    if generate::check(shape, *vertices).is_err() {
                        return Vec::new();
                    }
                    let characteristic = shape.euler_characteristic().unsigned_abs() as usize;
                    Ok((
                        shape.volume(),
                        shape.area(),
                        2 * (vertices - characteristic),
                    ))
                }
                MeshSource::File(file) => measure(file, &mut self.meshes),
            };
            match measured {
                Ok((volume, area, triangles)) => {
                    let radius = surface.scale * (0.75 * volume / PI).cbrt();
                    let area = surface.scale.powi(2) * area;
                    membranes.push(surface.membrane(radius, area, triangles));
                }
                Err(why) => {
                    self.contradiction(
                        &reader.origin_of("mesh"),
                        format!(
                            "the size of \"{}\" is not known, from which the lattice would follow: \
                             {why}: repair the file, or give the driver `spacing`, `box` and `step`",
                            surface.name
                        ),
                    );
                    return Vec::new();
                }
            }
        }
        membranes
    }

    /// The lengths of the box; NaN if unknown.
    fn lengths(
        &mut self,
        driver: Reader<'_>,
        membranes: &[ImmersedMembrane],
        surfaces: usize,
    ) -> [f64; 3] {
        if let Some(lengths) = driver.vector("box") {
            return lengths;
        }
        if !driver.has("box") && surfaces > 1 {
            self.contradiction(
                driver.origin(),
                format!(
                    "`driver` lacks `box`, the three lengths of the box of fluid: of one surface they \
                     would be {FREE_BOX} of its radii, and there are {surfaces} surfaces"
                ),
            );
        }
        match membranes {
            [membrane] => [FREE_BOX * membrane.radius; 3],
            _ => [f64::NAN; 3],
        }
    }

    /// The number of nodes along each axis.
    fn cells(&mut self, driver: Reader<'_>, spacing: f64, lengths: [f64; 3]) -> [usize; 3] {
        let counts = lengths.map(|length| (length / spacing).round());
        // The error of a value that is not a number has been reported already.
        if counts.iter().any(|count| count.is_nan()) {
            return [0; 3];
        }
        let key = if driver.has("resolution") {
            "resolution"
        } else {
            "spacing"
        };
        let origin = driver.origin_of(key);
        if let Some(axis) = (0..3).find(|&axis| counts[axis] < 1.0) {
            self.contradiction(
                &origin,
                format!(
                    "nodes are {spacing} apart, and the box is {} long along {}: choose a smaller \
                     spacing, or a longer `box`",
                    lengths[axis],
                    ["x", "y", "z"][axis]
                ),
            );
            return [0; 3];
        }
        let nodes: f64 = counts.iter().product();
        if nodes > NODES {
            self.contradiction(
                &origin,
                format!(
                    "the box would have {nodes:.1e} nodes, of which {NODES:.0e} are beyond any \
                     machine: choose a larger spacing, {} say, or a smaller `box`",
                    rounded(spacing * (nodes / 1e6).cbrt())
                ),
            );
            return [0; 3];
        }
        counts.map(|count| count as usize)
    }

    /// Chooses the step and the lattice viscosity, unless given.
    fn step(
        &mut self,
        driver: Reader<'_>,
        lattice: &mut LatticeBoltzmann,
        membranes: &[ImmersedMembrane],
    ) {
        let given = driver.has("step");
        // spacing² ρ/μ, the step at which ν is 1.
        let unit = lattice
            .density
            .map(|density| density * lattice.spacing.powi(2) / lattice.viscosity);
        let Some(unit) = unit else {
            if !given {
                lattice.step = lattice.parameters().chosen_step(membranes, &self.barriers);
            }
            return;
        };
        match (given, driver.has("lattice_viscosity")) {
            (true, true) => self.contradiction(
                &driver.origin_of("step"),
                format!(
                    "with a `density`, `step` and `lattice_viscosity` follow from each other, step = \
                     ν spacing² ρ/μ: leave one of them out; with this step ν is {}",
                    rounded(lattice.step / unit)
                ),
            ),
            (true, false) => lattice.lattice_viscosity = lattice.step / unit,
            (false, true) => lattice.step = lattice.lattice_viscosity * unit,
            (false, false) => {
                let longest = lattice.parameters().chosen_step(membranes, &self.barriers);
                lattice.step = longest.min(lattice.lattice_viscosity * unit);
                lattice.lattice_viscosity = lattice.step / unit;
            }
        }
    }

    /// Shortens a chosen step so that outputs come after whole steps. Called only if all values are
    /// valid.
    pub(super) fn fit_step(
        &mut self,
        reader: Reader<'_>,
        driver: Option<&mut Driver>,
        output: &Output,
    ) {
        let (Some(Driver::LatticeBoltzmann(lattice)), Every::Time(interval)) =
            (driver, output.every)
        else {
            return;
        };
        let inertia = lattice.density.is_some();
        let given = reader.has("step") || (inertia && reader.has("lattice_viscosity"));
        let step = interval / (interval / lattice.step).ceil();
        if !given && step > 0.0 && step.is_finite() {
            if inertia {
                lattice.lattice_viscosity *= step / lattice.step;
            }
            lattice.step = step;
        }
        // The error of a value that is not a number has been reported already.
        let LatticeBoltzmann {
            step,
            lattice_viscosity,
            duration,
            ..
        } = *lattice;
        let beyond = |value: f64| !value.is_nan() && !value.is_normal();
        if !beyond(step) {
            self.endless(reader, duration, step);
        }
        if beyond(step) || beyond(lattice_viscosity) {
            self.contradiction(
                reader.origin(),
                format!(
                    "steps would take {step:e}, with a viscosity of {lattice_viscosity:e} on the lattice: \
                     numbers of such sizes cannot be computed with; choose other units, or a `step`"
                ),
            );
        }
    }

    /// Reports points of an output, called `what` in messages, that lie beyond a wall, where there is
    /// no fluid.
    pub(super) fn in_the_fluid(
        &mut self,
        origin: &Origin,
        what: &str,
        points: &[[f64; 3]],
        driver: Option<&Driver>,
    ) {
        let Some(Driver::LatticeBoltzmann(lattice)) = driver else {
            return;
        };
        let [low, high] = lattice.corners();
        let walls = lattice.walls();
        for axis in (0..3).filter(|&axis| walls[axis]) {
            // The tolerance is for points exactly at a wall, up to rounding.
            let slack = 1e-9 * (high[axis] - low[axis]);
            let beyond = |point: &&[f64; 3]| {
                point[axis] < low[axis] - slack || point[axis] > high[axis] + slack
            };
            if let Some(point) = points.iter().find(beyond) {
                self.contradiction(
                    origin,
                    format!(
                        "{what} reaches to {} along {}, and the fluid is between walls at {} and {}: \
                         choose it within, or a longer `box`",
                        point[axis],
                        ["x", "y", "z"][axis],
                        low[axis],
                        high[axis]
                    ),
                );
                return;
            }
        }
    }

    /// Bodies at rest: in a fluid, which flows around them, and in relaxations, where interactions keep surfaces away from
    /// them.
    pub(super) fn obstacles(&mut self, readers: &[Reader<'_>]) -> Vec<ObstacleScene> {
        let mut obstacles = Vec::with_capacity(readers.len());
        for (index, reader) in readers.iter().enumerate() {
            obstacles.push(ObstacleScene {
                name: match reader.text("name") {
                    Some(name) => name.to_owned(),
                    None => default_name("obstacle", index),
                },
                source: self.source(*reader),
                scale: reader.number("scale").unwrap_or(1.0),
                position: reader.vector("position").unwrap_or_default(),
                orientation: super::surface::orientation(*reader),
            });
        }
        let names = obstacles.iter().map(|obstacle| obstacle.name.as_str());
        self.different("obstacle", &Vec::from_iter(names), readers);
        obstacles
    }
}

/// Volume, area and number of triangles of a mesh file, or the reason why they are unknown.
fn measure(source: &MeshFileSource, meshes: &mut MeshFiles) -> Result<(f64, f64, usize), String> {
    let file = meshes.read(source).map_err(|error| error.to_string())?;
    let surface = Surface::new(&file.mesh, &file.positions).map_err(|error| error.to_string())?;
    let volume = surface.volume().filter(|&volume| volume > 0.0);
    let volume = volume.ok_or_else(|| format!("{} encloses no volume", source.path.display()))?;
    Ok((volume, surface.area(), file.mesh.triangles().len()))
}
