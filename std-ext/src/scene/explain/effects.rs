//! The effects that are on, in words and numbers, and those that are off.

use super::super::units::Dimension;
use super::super::{
    AreaDifferenceTarget, Held, Hold, InPlaneLaw, Reference, ReferenceSource, SurfaceScene, Target,
    VolumeTarget,
};
use super::groups::largest;
use super::{Active, Parameter, Parameters};

pub(super) fn effects(
    surface: &SurfaceScene,
    number: &Parameters,
) -> (Vec<Active>, Vec<&'static str>) {
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
