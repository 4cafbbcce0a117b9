//! Units of the columns of series.

use super::Scene;
use super::units::Dimension;

/// The unit of the numbers of a column of a scene's series; empty if they have none.
pub fn unit_of(column: &str, scene: &Scene) -> String {
    let probes = scene.output.probes.iter();
    let mut probes = probes.filter_map(|probe| column.strip_prefix(&*probe.name));
    let names = scene.surfaces.iter().map(|surface| &*surface.name);
    let own = names.filter_map(|name| column.strip_suffix(name)?.strip_suffix('_'));
    let dimension = if probes.any(|axis| matches!(axis, "_x" | "_y" | "_z")) {
        Some(Dimension::VELOCITY)
    } else {
        let mut quantities = std::iter::once(column).chain(own);
        match quantities.find_map(angle_or_dimension) {
            Some(None) => return "degrees".to_owned(),
            found => found.flatten(),
        }
    };
    dimension.map_or_else(String::new, |dimension| dimension.unit(scene.units))
}

/// The dimension of a quantity that has one, or `None` inside for an angle in degrees.
fn angle_or_dimension(quantity: &str) -> Option<Option<Dimension>> {
    Some(match quantity {
        "smallest_angle" | "inclination" => None,
        "time" | "step" | "step_limit" | "tank_treading_period" => Some(Dimension::TIME),
        "area" => Some(Dimension::AREA),
        "volume" => Some(Dimension::VOLUME),
        "force" => Some(Dimension::FORCE),
        "axial_diameter"
        | "transverse_diameter"
        | "centroid_x"
        | "centroid_y"
        | "centroid_z"
        | "free_layer" => Some(Dimension::LENGTH),
        "wall_stress" | "N1" | "N2" => Some(Dimension::PRESSURE),
        stress if stress.starts_with("particle_stress_") => Some(Dimension::PRESSURE),
        "flow_rate" => Some(Dimension::FLOW_RATE),
        energy if energy == "energy" || energy.starts_with("energy_") => Some(Dimension::ENERGY),
        // An energy over the fourth power of a length.
        "stiffness" => Some(Dimension::REPULSION),
        _ => return None,
    })
}
