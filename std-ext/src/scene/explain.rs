//! What a scene amounts to: its effects, the dimensionless groups they form, what follows for
//! memory, steps and cost.

use super::build::reduced_volume;
use super::units::Dimension;
use super::{
    AreaDifferenceTarget, Driver, Held, Hold, InPlaneLaw, Interaction, MeshSource, Reference,
    ReferenceSource, Relax, Scene, Scheme, Stretching, SurfaceScene, Target, Units, VolumeTarget,
};
use crate::info::MeshInfo;
use crate::method::BendingMethod;
use serde::Serialize;
use std::f64::consts::PI;
use std::fmt;

/// What [`Scene::explain`] finds; shown as text by its `Display`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Explanation {
    /// The scene's title.
    pub title: String,
    /// The units of its numbers.
    pub units: Units,
    /// Surface by surface.
    pub surfaces: Vec<SurfaceExplanation>,
    /// What acts between surfaces.
    pub interactions: Vec<Active>,
    /// The driver.
    pub driver: Active,
    /// What limits the step.
    pub step_limit: &'static str,
    /// Estimate of the memory that the run needs, in bytes.
    pub memory: u64,
}

/// What acts on a surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceExplanation {
    /// Its name.
    pub name: String,
    /// Where its mesh comes from.
    pub mesh: String,
    /// Number of vertices.
    pub vertices: usize,
    /// Area, volume and lengths of the mesh.
    pub measures: Vec<Parameter>,
    /// The effects that are on.
    pub on: Vec<Active>,
    /// The keys of those that are off.
    pub off: Vec<&'static str>,
    /// Dimensionless groups, with R the radius of the sphere of the same area.
    pub groups: Vec<Group>,
    /// Time of one evaluation of the bending force over that of method B.
    pub bending_cost: Option<f64>,
}

/// An effect, interaction or driver that is on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Active {
    /// Its key or kind.
    pub name: &'static str,
    /// Which law, method or scheme.
    pub choice: String,
    /// Its numbers.
    pub parameters: Vec<Parameter>,
}

/// A number with its unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Its key.
    pub name: &'static str,
    /// The number in the scene's units.
    pub value: f64,
    /// The unit; empty if there is none.
    pub unit: String,
}

/// A dimensionless group.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Group {
    /// What it is called.
    pub name: &'static str,
    /// Its formula.
    pub formula: &'static str,
    /// The number.
    pub value: f64,
}

/// Bytes a vertex: mesh, positions, forces, their copies in outputs and checkpoints.
const BASE_BYTES: u64 = 600;
/// Of the twelve pairs of positions and forces that minimisation remembers.
const MINIMISE_BYTES: u64 = 12 * 2 * 24;
/// Of sources, centres and tractions of the triangles, and of the stages of a step.
const BOUNDARY_INTEGRAL_BYTES: u64 = 800;
/// Of a law over a reference: three numbers for each of two triangles a vertex, forces, energies.
const IN_PLANE_BYTES: u64 = 130;

impl Scene {
    /// What the scene amounts to on these meshes, one a surface, scaled as the scene says.
    ///
    /// # Panics
    /// If there are fewer meshes than surfaces.
    pub fn explain(&self, meshes: &[MeshInfo]) -> Explanation {
        let surfaces = self.surfaces.iter().zip(meshes);
        assert!(meshes.len() >= self.surfaces.len(), "one mesh a surface");
        let memory = surfaces.clone().map(|(surface, mesh)| {
            let vertices = mesh.vertices as u64;
            let minimises = |relax: &Relax| relax.scheme == Scheme::Minimise;
            let driver = match &self.driver {
                Driver::Relax(relax) if minimises(relax) => MINIMISE_BYTES,
                Driver::Relax(_) => 0,
                Driver::BoundaryIntegral(_) => BOUNDARY_INTEGRAL_BYTES,
            };
            let bending = surface
                .bending
                .map_or(0, |bending| bytes(bending.method, mesh));
            let laws =
                u64::from(surface.elasticity.is_some()) + u64::from(surface.local_area.is_some());
            vertices * (BASE_BYTES + driver + bending + laws * IN_PLANE_BYTES)
        });
        let number = Parameters(self.units);
        let interaction = |interaction: &Interaction| {
            let Interaction::Repulsion {
                strength,
                cutoff,
                between,
            } = interaction;
            let name = |index: usize| self.surfaces[index].name.as_str();
            Active {
                name: "repulsion",
                choice: match between {
                    Some([a, b]) => format!("between {} and {}", name(*a), name(*b)),
                    None => "between all surfaces".to_owned(),
                },
                parameters: vec![
                    number.of("strength", *strength, Dimension::REPULSION),
                    number.of("cutoff", *cutoff, Dimension::LENGTH),
                ],
            }
        };
        Explanation {
            title: self.title.clone(),
            units: self.units,
            surfaces: surfaces
                .map(|(surface, mesh)| explain_surface(surface, mesh, self.units))
                .collect(),
            interactions: self.interactions.iter().map(interaction).collect(),
            driver: driver(&self.driver, &number),
            step_limit: "none: relax has no time, and chooses its steps itself; without a flow \
                         there is no capillary number either",
            memory: memory.sum(),
        }
    }
}

fn driver(driver: &Driver, number: &Parameters) -> Active {
    let (choice, parameters) = match driver {
        Driver::Relax(relax) => {
            let scheme = match relax.scheme {
                Scheme::Minimise => "minimise: the energy of all effects, under the constraints",
                Scheme::Overdamped => {
                    "overdamped: forces that have no energy, stopped on what is left of them"
                }
            };
            let parameters = vec![
                number.plain("residual", relax.residual),
                number.plain("iterations", relax.iterations as f64),
            ];
            (scheme.to_owned(), parameters)
        }
        Driver::BoundaryIntegral(integral) => {
            let parameters = vec![
                number.of("viscosity", integral.viscosity, Dimension::VISCOSITY),
                number.of("duration", integral.duration, Dimension::TIME),
            ];
            ("Stokes flow without walls".to_owned(), parameters)
        }
    };
    Active {
        name: driver.name(),
        choice,
        parameters,
    }
}

/// Bytes a vertex of a prepared bending method after its first evaluation, as measured on meshes of
/// 10242 vertices.
fn bytes(method: BendingMethod, mesh: &MeshInfo) -> u64 {
    match method {
        BendingMethod::KantorNelson => 80,
        BendingMethod::GompperKroll => 90,
        BendingMethod::Meyer => 210,
        BendingMethod::Belkin => 2600,
        BendingMethod::Farutin => 290,
        // Patches of one kind only, or of many.
        BendingMethod::Loop if mesh.valences[0] >= 5 && mesh.valences[1] <= 6 => 1700,
        BendingMethod::Loop => 7000,
        BendingMethod::Juelicher => 110,
        BendingMethod::J4 => 950,
        BendingMethod::J6 | BendingMethod::Jet => 1530,
    }
}

/// Time of an evaluation over that of method B: the table in the README.
fn cost(method: BendingMethod) -> f64 {
    match method {
        BendingMethod::GompperKroll => 1.0,
        BendingMethod::KantorNelson | BendingMethod::Meyer => 2.0,
        BendingMethod::Juelicher => 3.0,
        BendingMethod::Loop => 11.0,
        BendingMethod::Farutin => 32.0,
        BendingMethod::J4 => 100.0,
        BendingMethod::J6 | BendingMethod::Jet | BendingMethod::Belkin => 300.0,
    }
}

struct Parameters(Units);

impl Parameters {
    fn of(&self, name: &'static str, value: f64, dimension: Dimension) -> Parameter {
        Parameter {
            name,
            value,
            unit: dimension.unit(self.0),
        }
    }

    fn plain(&self, name: &'static str, value: f64) -> Parameter {
        self.of(name, value, Dimension::NONE)
    }

    fn vector(
        &self,
        names: [&'static str; 3],
        value: [f64; 3],
        dimension: Dimension,
    ) -> [Parameter; 3] {
        std::array::from_fn(|axis| self.of(names[axis], value[axis], dimension))
    }
}

fn explain_surface(surface: &SurfaceScene, mesh: &MeshInfo, units: Units) -> SurfaceExplanation {
    let number = Parameters(units);
    let radius = (mesh.area / (4.0 * PI)).sqrt();
    let mut measures = vec![
        number.of("area", mesh.area, Dimension::AREA),
        number.of("R", radius, Dimension::LENGTH),
        number.of("shortest edge", mesh.edge_lengths[0], Dimension::LENGTH),
        number.of("longest edge", mesh.edge_lengths[1], Dimension::LENGTH),
    ];
    if let Some(volume) = mesh.volume {
        measures.insert(1, number.of("volume", volume, Dimension::VOLUME));
    }
    let source = match &surface.source {
        MeshSource::Shape { shape, family, .. } => format!("{shape}, {family}"),
        MeshSource::File(path) => path.display().to_string(),
    };
    let (on, off) = effects(surface, &number);
    SurfaceExplanation {
        name: surface.name.clone(),
        mesh: source,
        vertices: mesh.vertices,
        measures,
        on,
        off,
        groups: groups(surface, mesh, radius),
        bending_cost: surface.bending.map(|bending| cost(bending.method)),
    }
}

fn effects(surface: &SurfaceScene, number: &Parameters) -> (Vec<Active>, Vec<&'static str>) {
    let mut on = Vec::new();
    let mut off = Vec::new();
    let mut effect = |name: &'static str, active: Option<(String, Vec<Parameter>)>| match active {
        Some((choice, parameters)) => on.push(Active {
            name,
            choice,
            parameters,
        }),
        None => off.push(name),
    };
    effect(
        "bending",
        surface.bending.map(|bending| {
            let curvature = bending.spontaneous_curvature;
            let mut parameters = vec![number.of("modulus", bending.modulus, Dimension::ENERGY)];
            if curvature != 0.0 {
                let name = "spontaneous_curvature";
                parameters.push(number.of(name, curvature, Dimension::CURVATURE));
            }
            (bending.method.to_string(), parameters)
        }),
    );
    effect(
        "elasticity",
        surface.elasticity.as_ref().map(|elasticity| {
            let shear = elasticity.law.shear_modulus();
            let mut parameters = vec![number.of("shear_modulus", shear, Dimension::TENSION)];
            let name = match elasticity.law {
                InPlaneLaw::NeoHookean { .. } => "neo-hookean",
                InPlaneLaw::Skalak { area_ratio, .. } => {
                    parameters.push(number.plain("area_ratio", area_ratio));
                    "skalak"
                }
            };
            let reference = words(&elasticity.reference);
            (format!("{name}, without stress {reference}"), parameters)
        }),
    );
    effect(
        "local_area",
        surface.local_area.as_ref().map(|local| {
            let choice = format!("penalty, A0 {}", words(&local.reference));
            let modulus = number.of("modulus", local.modulus, Dimension::TENSION);
            (choice, vec![modulus])
        }),
    );
    effect(
        "area",
        surface.area.map(|held| {
            let target = match held.target {
                Target::Initial => None,
                Target::Value(value) => Some(number.of("target", value, Dimension::AREA)),
            };
            hold(held, target, number, Dimension::TENSION)
        }),
    );
    effect(
        "volume",
        surface.volume.map(|held| {
            let target = match held.target {
                VolumeTarget::Initial => None,
                VolumeTarget::Value(value) => Some(number.of("target", value, Dimension::VOLUME)),
                VolumeTarget::Reduced(reduced) => Some(number.plain("reduced", reduced)),
            };
            hold(held, target, number, Dimension::PRESSURE)
        }),
    );
    effect(
        "area_difference",
        surface.area_difference.map(|held| {
            let target = match held.target {
                AreaDifferenceTarget::Initial => None,
                AreaDifferenceTarget::Value(value) => {
                    Some(number.of("target", value, Dimension::LENGTH))
                }
                AreaDifferenceTarget::Reduced(reduced) => Some(number.plain("reduced", reduced)),
            };
            hold(held, target, number, Dimension::ENERGY)
        }),
    );
    let one = |value, dimension| (String::new(), vec![number.of("value", value, dimension)]);
    effect(
        "tension",
        surface.tension.map(|value| one(value, Dimension::TENSION)),
    );
    effect(
        "pressure",
        surface
            .pressure
            .map(|value| one(value, Dimension::PRESSURE)),
    );
    effect(
        "gravity",
        surface.gravity.map(|gravity| {
            let difference = gravity.density_difference;
            let mut parameters =
                vec![number.of("density_difference", difference, Dimension::DENSITY)];
            let names = ["acceleration x", "y", "z"];
            let acceleration = gravity.acceleration;
            parameters.extend(number.vector(names, acceleration, Dimension::ACCELERATION));
            (String::new(), parameters)
        }),
    );
    effect(
        "membrane_viscosity",
        surface.membrane_viscosity.map(|viscosity| {
            let dimension = Dimension::SURFACE_VISCOSITY;
            let parameters = vec![
                number.of("shear", viscosity.shear, dimension),
                number.of("dilational", viscosity.dilational, dimension),
            ];
            (String::new(), parameters)
        }),
    );
    effect(
        "stretching",
        surface.stretching.as_ref().map(|stretching| {
            let [x, y, z] = stretching.axis;
            let count = match stretching.forces.len() {
                1 => String::new(),
                count => format!(", {count} forces one after the other"),
            };
            let largest = number.of("largest force", largest(stretching), Dimension::FORCE);
            let fraction = number.plain("fraction", stretching.fraction);
            let choice = format!("along [{x}, {y}, {z}]{count}");
            (choice, vec![largest, fraction])
        }),
    );
    (on, off)
}

fn largest(stretching: &Stretching) -> f64 {
    stretching.forces.iter().copied().fold(0.0, f64::max)
}

fn words(reference: &Reference) -> String {
    let place = match &reference.source {
        ReferenceSource::Initial => "at the start".to_owned(),
        ReferenceSource::Shape(shape) => format!("on {shape}"),
        ReferenceSource::File(path) => format!("as in {}", path.display()),
    };
    if reference.scale == 1.0 {
        place
    } else {
        format!("{place}, scaled by {}", reference.scale)
    }
}

fn hold<T>(
    held: Held<T>,
    target: Option<Parameter>,
    number: &Parameters,
    dimension: Dimension,
) -> (String, Vec<Parameter>) {
    let mut parameters = Vec::new();
    let kind = match held.hold {
        Hold::Exact => "exact",
        Hold::Penalty(modulus) => {
            parameters.push(number.of("modulus", modulus, dimension));
            "penalty"
        }
    };
    let initial = if target.is_none() {
        ", at what it is at the start"
    } else {
        ""
    };
    parameters.extend(target);
    (format!("{kind}{initial}"), parameters)
}

fn groups(surface: &SurfaceScene, mesh: &MeshInfo, radius: f64) -> Vec<Group> {
    let mut groups = Vec::new();
    let mut group = |name, formula, value: f64| {
        groups.push(Group {
            name,
            formula,
            value,
        });
    };
    if let Some(volume) = mesh.volume {
        let reduced = reduced_volume(volume, mesh.area);
        group("reduced volume at the start", "6√π V/A^(3/2)", reduced);
    }
    if let Some(held) = surface.volume {
        let area = match surface.area.map(|held| held.target) {
            Some(Target::Value(area)) => area,
            _ => mesh.area,
        };
        match held.target {
            VolumeTarget::Initial => {}
            VolumeTarget::Value(volume) => {
                let reduced = reduced_volume(volume, area);
                group("reduced volume of the target", "6√π V0/A^(3/2)", reduced);
            }
            VolumeTarget::Reduced(reduced) => {
                group("reduced volume of the target", "6√π V0/A^(3/2)", reduced);
            }
        }
    }
    match surface.area_difference.map(|held| held.target) {
        Some(AreaDifferenceTarget::Value(value)) => {
            let reduced = value / (4.0 * PI * radius);
            group("reduced area difference of the target", "M0/(4πR)", reduced);
        }
        Some(AreaDifferenceTarget::Reduced(reduced)) => {
            group("reduced area difference of the target", "M0/(4πR)", reduced);
        }
        _ => {}
    }
    let elasticity = surface.elasticity.as_ref().map(|elasticity| elasticity.law);
    if let Some(law) = elasticity {
        let ratio = law.area_modulus() / law.shear_modulus();
        group("area over shear modulus", "K_s/G", ratio);
        if let Some(stretching) = &surface.stretching {
            let value = largest(stretching) / (law.shear_modulus() * radius);
            group("largest stretching force over shear", "F/(G R)", value);
        }
    }
    let Some(bending) = surface.bending else {
        return groups;
    };
    let modulus = bending.modulus;
    if bending.spontaneous_curvature != 0.0 {
        let reduced = 2.0 * bending.spontaneous_curvature * radius;
        group("reduced spontaneous curvature", "c0 R = 2 H0 R", reduced);
    }
    if let Some(law) = elasticity {
        let [shear, area] = [law.shear_modulus(), law.area_modulus()];
        let young = 4.0 * area * shear / (area + shear);
        let squared = radius * radius;
        let b = modulus / (squared * shear);
        group("bending number by G", "b = κ/(R² G)", b);
        group("bending number by E_s = 3 G", "κ/(R² 3 G)", b / 3.0);
        let name = "Föppl–von Kármán number";
        group(
            name,
            "γ = Y R²/κ, Y = 4 K_s G/(K_s + G)",
            young * squared / modulus,
        );
    } else {
        if let Some(stretching) = &surface.stretching {
            let value = largest(stretching) * radius / modulus;
            group("largest stretching force over bending", "F R/κ", value);
        }
    }
    let penalty = |hold| match hold {
        Hold::Penalty(modulus) => Some(modulus),
        Hold::Exact => None,
    };
    if let Some(local) = &surface.local_area {
        let value = local.modulus * radius.powi(2) / modulus;
        group("local area over bending modulus", "k R²/κ", value);
    }
    if let Some(area) = surface.area.and_then(|held| penalty(held.hold)) {
        group(
            "area over bending modulus",
            "k R²/κ",
            area * radius.powi(2) / modulus,
        );
    }
    if let Some(volume) = surface.volume.and_then(|held| penalty(held.hold)) {
        group(
            "volume over bending modulus",
            "k R³/κ",
            volume * radius.powi(3) / modulus,
        );
    }
    if let Some(difference) = surface.area_difference.and_then(|held| penalty(held.hold)) {
        group(
            "area difference over bending modulus",
            "α = k/κ",
            difference / modulus,
        );
    }
    if let Some(tension) = surface.tension {
        group(
            "reduced tension",
            "σ R²/κ",
            tension * radius.powi(2) / modulus,
        );
    }
    if let Some(pressure) = surface.pressure {
        group(
            "reduced pressure",
            "Δp R³/κ",
            pressure * radius.powi(3) / modulus,
        );
    }
    if let Some(gravity) = surface.gravity {
        let [x, y, z] = gravity.acceleration;
        let weight = gravity.density_difference * x.hypot(y).hypot(z);
        group(
            "bending Bond number",
            "Δρ g R⁴/κ",
            weight * radius.powi(4) / modulus,
        );
    }
    groups
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.title.is_empty() {
            writeln!(f, "{}", self.title)?;
        }
        let units = match self.units {
            Units::Micro => "µm, pN, s",
            Units::None => "none",
        };
        writeln!(f, "units: {units}")?;
        for surface in &self.surfaces {
            write!(f, "{surface}")?;
        }
        if !self.interactions.is_empty() {
            writeln!(f, "\ninteractions")?;
            for interaction in &self.interactions {
                writeln!(f, "  {interaction}")?;
            }
        }
        writeln!(f, "\ndriver\n  {}", self.driver)?;
        writeln!(f, "  step limit          {}", self.step_limit)?;
        // In what the numbers are good for.
        let megabytes = self.memory.div_ceil(1_000_000);
        writeln!(f, "  memory              about {megabytes} MB")
    }
}

impl fmt::Display for SurfaceExplanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "\nsurface {}: {}, {} vertices",
            self.name, self.mesh, self.vertices
        )?;
        let measures = Vec::from_iter(self.measures.iter().map(Parameter::to_string));
        writeln!(f, "  {}", measures.join(", "))?;
        for effect in &self.on {
            writeln!(f, "  {effect}")?;
        }
        if self.on.is_empty() {
            writeln!(f, "  nothing acts on it")?;
        }
        if !self.off.is_empty() {
            writeln!(f, "  off: {}", self.off.join(", "))?;
        }
        if !self.groups.is_empty() {
            writeln!(f, "  dimensionless groups")?;
        }
        for Group {
            name,
            formula,
            value,
        } in &self.groups
        {
            writeln!(f, "    {name:38} {:>10}  {formula}", digits(*value))?;
        }
        match self.bending_cost {
            Some(1.0) => writeln!(f, "  cost: bending by method B, the fastest"),
            Some(cost) => writeln!(
                f,
                "  cost: bending takes about {cost} times as long as by method B"
            ),
            None => Ok(()),
        }
    }
}

impl fmt::Display for Active {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:19} {}", self.name, self.choice)?;
        let parameters = Vec::from_iter(self.parameters.iter().map(Parameter::to_string));
        let separator = if self.choice.is_empty() || parameters.is_empty() {
            ""
        } else {
            "; "
        };
        write!(f, "{separator}{}", parameters.join(", "))
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, value, unit } = self;
        let space = if unit.is_empty() { "" } else { " " };
        write!(f, "{name} = {}{space}{unit}", digits(*value))
    }
}

/// Five digits, with a power of ten where zeros would hide them.
fn digits(value: f64) -> String {
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(value);
        rounded.to_string()
    } else {
        format!("{value:.4e}")
    }
}
