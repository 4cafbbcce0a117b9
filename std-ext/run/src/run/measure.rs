//! Measurements of a run's surfaces.

use super::deformed::smallest_angle;
use super::drive::Drive;
use super::quality::{self, Flagged};
use super::remeshing::{self, Remesher};
use crate::effect::Effect;
use crate::held::{Geometry, Quantity};
use crate::picture::Frame;
use crate::scene::{Bending, Named, PictureField, Scene, UnitSystem};
use crate::simulation::{Acting, Body, Simulation};
use helfrich::{Cotangent, Curvature, DualArea, Prepared, Surface};
use std::f64::consts::PI;

/// The columns of the series that are common to all drivers.
#[derive(Debug)]
pub(super) struct Measures {
    columns: Vec<String>,
    /// Directions along and across, for each surface that is stretched.
    directions: Vec<Option<[[f64; 3]; 2]>>,
    /// Area and volume, for each surface where they are not those of flat triangles.
    held: Vec<Option<HeldExtents>>,
    /// A ball around the initial surfaces, and obstacles near them.
    ball: Frame,
}

impl Measures {
    pub(super) fn new(all: &Scene, simulation: &Simulation, positions: &[[f64; 3]]) -> Self {
        let mut columns = vec!["energy".to_owned()];
        let effects = simulation.effect_names().into_iter();
        columns.extend(effects.map(|effect| format!("energy_{effect}")));
        let mut directions = Vec::new();
        for (body, scene) in simulation.bodies().iter().zip(&all.surfaces) {
            let mut names = vec!["area", "volume", "reduced_volume", "smallest_angle"];
            if quality::has_bending(body) {
                names.extend(quality::COLUMNS);
            }
            if scene.remesh.is_some() {
                names.extend(remeshing::COLUMNS);
            }
            if let Some(stretching) = &scene.effects.stretching {
                names.extend(["force", "axial_diameter", "transverse_diameter"]);
                names.extend(stretching.has_distance().then_some("end_distance"));
            }
            columns.extend(names.into_iter().map(|name| simulation.label(name, body)));
            let along = body.stretching_axis();
            directions.push(along.map(|axis| [axis, across(axis, &positions[body.vertices()])]));
        }
        let mut ball = ball(positions);
        // Obstacles that are not much larger are shown as a whole.
        let obstacles = simulation.obstacles().iter();
        let reaches = obstacles.map(|obstacle| farthest(ball.centre, &obstacle.positions));
        let near = reaches.filter(|&reach| reach <= 2.0 * ball.radius);
        ball.radius = near.fold(ball.radius, |most, reach| most.max(1.05 * reach));
        let mut measures = Self {
            columns,
            directions,
            held: Vec::new(),
            ball,
        };
        measures.meshes_changed(all, simulation);
        measures
    }

    /// Must be called when surfaces have got new meshes.
    pub(super) fn meshes_changed(&mut self, scene: &Scene, simulation: &Simulation) {
        let bodies = simulation.bodies().iter().zip(&scene.surfaces);
        let held = bodies
            .map(|(body, surface)| HeldExtents::new(body, surface.effects.geometry(&scene.driver)));
        self.held = held.collect();
    }

    /// View of a picture: the ball around the initial surfaces. If the surfaces need more space, the
    /// ball is enlarged in a few large steps, so that pictures can be compared.
    pub(super) fn frame(&self, positions: &[[f64; 3]]) -> Frame {
        let Frame { centre, radius } = self.ball;
        let needed = farthest(centre, positions) / radius;
        let steps = (needed.ln() / ZOOM.ln()).ceil().max(0.0);
        Frame {
            centre,
            radius: radius * ZOOM.powf(steps),
        }
    }

    /// The columns of the series, beginning with those of the driver.
    pub(super) fn columns(&self, drive: &dyn Drive, simulation: &Simulation) -> Vec<String> {
        let mut columns = drive.columns(simulation);
        columns.extend(self.columns.iter().cloned());
        columns
    }

    /// A number for each column; NaN where it is not defined.
    pub(super) fn row(
        &mut self,
        drive: &dyn Drive,
        simulation: &Simulation,
        remesher: &Remesher,
        acting: &[Acting],
        flagged: &[Option<Flagged>],
    ) -> Vec<f64> {
        let positions = drive.positions();
        let energies = acting.iter().map(|acting| acting.energy);
        let mut row = drive.numbers(simulation);
        row.push(energies.clone().sum());
        row.extend(energies);
        let surfaces = self.directions.iter().zip(&mut self.held);
        let bodies = simulation.bodies().iter().zip(surfaces);
        for (index, ((body, (directions, held)), flagged)) in bodies.zip(flagged).enumerate() {
            let surface = body.surface(positions);
            let [area, volume] = surface.map_or([f64::NAN; 2], |at| extents(at, held.as_mut()));
            let angle = surface.map_or(f64::NAN, smallest_angle);
            row.extend([
                area,
                volume,
                6.0 * PI.sqrt() * volume / area.powf(1.5),
                angle,
            ]);
            if quality::has_bending(body) {
                row.extend(flagged.as_ref().map_or([f64::NAN; 3], Flagged::numbers));
            }
            if remesher.renews(index) {
                row.extend(remesher.numbers(body));
            }
            if let (Some((force, distance)), Some(directions)) =
                (body.stretching(surface), directions)
            {
                let own = &positions[body.vertices()];
                row.push(force);
                row.extend(directions.map(|direction| extent(direction, own)));
                row.extend(distance);
            }
        }
        row
    }
}

/// The factor between two frames.
const ZOOM: f64 = 1.25;

/// A ball with all points and a small margin.
fn ball(positions: &[[f64; 3]]) -> Frame {
    let points = positions
        .iter()
        .map(|&position| glam::DVec3::from_array(position));
    let centre = (points.sum::<glam::DVec3>() / positions.len() as f64).to_array();
    Frame {
        centre,
        radius: 1.05 * farthest(centre, positions),
    }
}

fn farthest(centre: [f64; 3], positions: &[[f64; 3]]) -> f64 {
    let centre = glam::DVec3::from_array(centre);
    let distance = |&position: &[f64; 3]| centre.distance(glam::DVec3::from_array(position));
    positions.iter().map(distance).fold(0.0, f64::max)
}

/// Area and volume of the components as they are held: of patches, or of the smooth surface through the vertices.
#[derive(Debug)]
pub(super) struct HeldExtents {
    quantities: [Quantity; 2],
    /// Their values over those of the quantities, component by component; empty if these are the same.
    ratios: Vec<[f64; 2]>,
}

impl HeldExtents {
    /// `None` where area and volume are those of flat triangles.
    pub(super) fn new(body: &Body, geometry: Geometry) -> Option<Self> {
        let ratios = body.ratios().to_vec();
        let quantities = match geometry.of_patches(body.mesh()) {
            Some(patches) => patches,
            None if ratios.is_empty() => return None,
            None => [geometry.area, geometry.volume].map(|of| Quantity::new(of, body.mesh())),
        };
        Some(Self { quantities, ratios })
    }

    fn sums(&mut self, surface: Surface<'_, f64>) -> [f64; 2] {
        let ratios = &self.ratios;
        let mut which = 0..2;
        self.quantities.each_mut().map(|quantity| {
            let which = which.next().unwrap_or_default();
            let values = quantity.values(surface).iter().enumerate();
            let ratio = |component: usize| ratios.get(component).map_or(1.0, |own| own[which]);
            values
                .map(|(component, value)| value * ratio(component))
                .sum()
        })
    }
}

/// Area and volume, as they are held or of flat triangles; the volume is NaN where the surface encloses none.
pub(super) fn extents(surface: Surface<'_, f64>, held: Option<&mut HeldExtents>) -> [f64; 2] {
    let volume = surface.volume();
    let Some(held) = held else {
        return [surface.area(), volume.unwrap_or(f64::NAN)];
    };
    let [area, enclosed] = held.sums(surface);
    [area, volume.map_or(f64::NAN, |_| enclosed)]
}

/// The direction across an axis in which points extend farthest.
fn across(axis: [f64; 3], positions: &[[f64; 3]]) -> [f64; 3] {
    let axis = glam::DVec3::from_array(axis);
    let bases = [glam::DVec3::X, glam::DVec3::Y, glam::DVec3::Z];
    let least = |a: &glam::DVec3, b: &glam::DVec3| a.dot(axis).abs().total_cmp(&b.dot(axis).abs());
    let base = bases.into_iter().min_by(least).unwrap_or(glam::DVec3::X);
    let first = (base - base.dot(axis) * axis).normalize();
    let second = axis.cross(first);
    let direction = |degrees: u32| {
        let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
        (cosine * first + sine * second).to_array()
    };
    // Among extents that are equal for the eye, the first is taken.
    let mut best = (0.0, direction(0));
    for degrees in 0..180 {
        let direction = direction(degrees);
        let extent = extent(direction, positions);
        if extent > 1.000_001 * best.0 {
            best = (extent, direction);
        }
    }
    best.1
}

/// The extent of points along a unit direction.
fn extent(direction: [f64; 3], positions: &[[f64; 3]]) -> f64 {
    let direction = glam::DVec3::from_array(direction);
    let heights = positions
        .iter()
        .map(|&position| direction.dot(glam::DVec3::from_array(position)));
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), height| {
        (low.min(height), high.max(height))
    });
    high - low
}

/// A field on a surface.
#[derive(Debug)]
pub(super) enum Values {
    Scalars(Vec<f64>),
    Vectors(Vec<[f64; 3]>),
}

/// H, K, the bending force density f, and the nodal force of each effect that acts on a surface.
///
/// H and K are computed by the cotangent operator, whatever the method; f is the nodal force divided by
/// the mixed area.
pub(super) fn fields(
    body: &Body,
    positions: &[[f64; 3]],
    acting: &[Acting],
) -> Vec<(String, Values)> {
    let Some(surface) = body.surface(positions) else {
        return Vec::new();
    };
    let mesh = surface.mesh();
    let mut cotangent = Prepared::new(Cotangent::new(DualArea::Mixed), mesh);
    let curvature = cotangent.curvatures(surface);
    let scalars =
        |value: fn(&Curvature<f64>) -> f64| Values::Scalars(curvature.iter().map(value).collect());
    let mut fields = vec![
        ("H".to_owned(), scalars(|vertex| vertex.mean)),
        ("K".to_owned(), scalars(|vertex| vertex.gaussian)),
    ];
    let [own, between] = Acting::of(acting, body);
    for (name, acting) in body.effects().iter().map(Effect::name).zip(own) {
        let force = acting.on(body);
        if name == Bending::NAME {
            let density = |(force, vertex): (&[f64; 3], &Curvature<f64>)| {
                let over = if vertex.area > 0.0 {
                    vertex.area.recip()
                } else {
                    0.0
                };
                force.map(|component| over * component)
            };
            let density = force.iter().zip(curvature).map(density).collect();
            fields.push(("f".to_owned(), Values::Vectors(density)));
        }
        fields.push((format!("force_{name}"), Values::Vectors(force.to_vec())));
    }
    for acting in between {
        let force = acting.on(body).to_vec();
        fields.push((format!("force_{}", acting.effect), Values::Vectors(force)));
    }
    fields
}

/// The numbers that a picture shows on a surface; none if no effect there has them.
pub(super) fn picture_field(
    body: &Body,
    positions: &[[f64; 3]],
    acting: &[Acting],
    field: PictureField,
) -> Option<Vec<f64>> {
    let name = match field {
        PictureField::MeanCurvature => "H",
        PictureField::GaussianCurvature => "K",
        PictureField::BendingForce => "f",
    };
    let fields = fields(body, positions, acting);
    let (_, values) = fields.into_iter().find(|(found, _)| found == name)?;
    Some(match values {
        Values::Scalars(values) => values,
        Values::Vectors(values) => {
            let length = |&value: &[f64; 3]| glam::DVec3::from_array(value).length();
            values.iter().map(length).collect()
        }
    })
}

/// Quantity shown by a picture's colours, with its unit.
pub(super) fn picture_label(field: PictureField, units: UnitSystem) -> String {
    let (name, unit) = match field {
        PictureField::MeanCurvature => ("H", "1/µm"),
        PictureField::GaussianCurvature => ("K", "1/µm²"),
        PictureField::BendingForce => ("|f|", "Pa"),
    };
    match units {
        UnitSystem::Micro => format!("{name} ({unit})"),
        UnitSystem::None => name.to_owned(),
    }
}
