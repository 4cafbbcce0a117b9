//! Line tension of the borders between domains.

use super::super::keys::{Keys, any, plain, required};
use super::super::material::{COLUMN, Material, singular};
use super::super::units::Dimension;
use super::{
    Builder, Check, Described, EffectError, Groups, MeshSource, Named, Parameter, Parameters,
    Preparation, Reader, SurfaceEffect,
};
use crate::io::{Column, ColumnPlace};
use serde::Serialize;
use std::sync::Arc;

/// Line tension of the borders between domains, `E = Λ L`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BorderTension {
    /// Λ, a force.
    pub value: f64,
    /// The label of the domain of each vertex or triangle, a whole number; `None` if it has been reported.
    pub domains: Option<Material>,
}

impl Described for BorderTension {
    const SUMMARY: &'static str = "Line tension of the borders between domains, E = Λ L.";

    const KEYS: &'static Keys = &plain(&[
        required(
            "value",
            any(Dimension::FORCE),
            "Line tension Λ, energy per length of the borders; positive if they contract.",
        ),
        required(
            "domains",
            COLUMN,
            "The domain of each vertex or face: a column of whole numbers. Borders run midway between \
             vertices of different domains, or along the edges between faces of different domains.",
        ),
    ]);

    fn read(table: Reader<'_>, source: &MeshSource, builder: &mut Builder<'_>) -> Self {
        let domains = Material::read_labels(table, "domains", source, builder);
        if let Some(Material::Column { column }) = &domains
            && let Err(message) = check_labels(column)
        {
            builder.contradiction(&table.origin_of("domains"), message);
        }
        Self {
            value: table.needed("value"),
            domains,
        }
    }
}

/// The reason why a column does not define domains.
fn check_labels(column: &Column) -> Result<(), String> {
    let Column {
        name,
        place,
        values,
    } = column;
    // Larger numbers are always whole in f64.
    let is_label = |value: &f64| value.fract() == 0.0 && value.abs() < 2.0_f64.powi(53);
    if let Some(at) = values.iter().position(|value| !is_label(value)) {
        return Err(format!(
            "the column \"{name}\" is {} at {} {at}: the label of a domain has to be a whole number",
            values[at],
            singular(*place)
        ));
    }
    if values.iter().all(|value| *value == values[0]) {
        return Err(format!(
            "the column \"{name}\" is {} everywhere, and one domain has no border: leave `border_tension` \
             out",
            values[0]
        ));
    }
    Ok(())
}

impl BorderTension {
    fn labels(&self) -> &[f64] {
        self.domains.as_ref().map_or(&[], Material::values)
    }
}

impl SurfaceEffect for BorderTension {
    fn check(&self, check: &mut Check<'_, '_>) {
        super::refuse_on_lattice(Self::NAME, check);
        check.doubt_unheld_parts(Self::NAME);
    }

    fn columns(&self) -> Vec<&Arc<Column>> {
        self.domains.iter().filter_map(Material::column).collect()
    }

    fn columns_mut(&mut self) -> Vec<&mut Arc<Column>> {
        let domains = self.domains.iter_mut();
        domains.filter_map(Material::column_mut).collect()
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let value = number.of("value", self.value, Dimension::FORCE);
        let mut labels = self.labels().to_vec();
        labels.sort_by(f64::total_cmp);
        labels.dedup();
        (format!("{} domains", labels.len()), vec![value])
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        if let Some(modulus) = groups.bending_modulus() {
            let ratio = self.value * groups.radius() / modulus;
            groups.add("reduced tension of borders", "Λ R/κ", ratio);
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        let labels = self.labels().iter().map(|&label| label as i64);
        let place = self.domains.as_ref().and_then(Material::column);
        let place = place.map_or(ColumnPlace::Vertices, |column| column.place);
        let labels = preparation.ordered(place, labels.collect());
        let make = match place {
            ColumnPlace::Triangles => helfrich::BorderTension::of_triangles,
            ColumnPlace::Vertices => helfrich::BorderTension::new,
        };
        let method = make(self.value, preparation.mesh(), &labels);
        preparation.conservative(Self::NAME, method)
    }
}
