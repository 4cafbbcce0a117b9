//! Bending.

use super::super::keys::{Form, Keys, any, optional, plain, positive, required};
use super::super::material::COLUMN;
use super::super::units::Dimension;
use super::{
    Builder, Check, Described, EffectError, Groups, MeshCheck, MeshSource, Named, Parameter,
    Parameters, Preparation, Reader, Stiffness, SurfaceEffect,
};
use crate::effect::Effect;
use crate::generate::Family;
use crate::info::MeshInfo;
use crate::io::Column;
use crate::method::{BendingMethod, MethodOptions};
use crate::scene::{Boundary, Driver, Flow, Material};
use crate::six::Six;
use helfrich::{Bandwidth, DualArea, GompperKroll, Method, ParameterError};
use serde::Serialize;
use std::sync::Arc;

/// Bending, `E = 2 ∫ κ (H − H0)² dS`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bending {
    /// The method.
    pub method: BendingMethod,
    /// Its options.
    #[serde(flatten)]
    pub options: MethodOptions,
    /// Bending modulus κ, an energy.
    pub modulus: Material,
    /// Spontaneous curvature H0 = c0/2, 1/length, positive on a sphere; 0 if there is none.
    pub spontaneous_curvature: Material,
}

fn methods() -> Vec<&'static str> {
    let bending = || {
        BendingMethod::NAMED
            .into_iter()
            .filter(|method| method.has_force())
    };
    let letters = bending().filter_map(BendingMethod::letter);
    bending().map(BendingMethod::name).chain(letters).collect()
}

impl Described for Bending {
    const SUMMARY: &'static str = "Bending, E = 2 ∫ κ (H − H0)² dS.";

    const KEYS: &'static Keys = &plain(&[
        required(
            "method",
            Form::Choice(methods),
            "The bending method, by its name or letter.",
        ),
        required(
            "modulus",
            Form::Either(&[positive(Dimension::ENERGY), COLUMN]),
            "Bending modulus κ: a number, or a column of the mesh file with a number for each vertex. Method \
             kantor-nelson has the modulus 2κ/√3 of an edge: its forces are those of κ, and its energy is \
             2 ∫ κ (H² − 2K/3) dS, 8πκ/3 for a sphere.",
        ),
        optional(
            MethodOptions::AREAS,
            Form::Choice(MethodOptions::areas_names),
            "Vertex areas, for gompper-kroll and meyer; by default mixed.",
        ),
        optional(
            MethodOptions::BANDWIDTH,
            Form::Either(&[
                Form::Choice(MethodOptions::bandwidth_names),
                positive(Dimension::NONE),
            ]),
            "Bandwidth of the heat kernel of belkin, in mean vertex areas; or \"published\", the mixed \
             area of each vertex; by default \"converging\", max(1/4, sqrt(N)/100) mean areas with N \
             vertices.",
        ),
        optional(
            "spontaneous_curvature",
            Form::Either(&[any(Dimension::CURVATURE), COLUMN]),
            "Spontaneous curvature H0 = c0/2, positive on a sphere; by default 0. A number, or a \
             column of the mesh file with a number for each vertex.",
        ),
    ]);

    fn read(table: Reader<'_>, source: &MeshSource, builder: &mut Builder<'_>) -> Self {
        let mut material = |key| Material::read(table, key, source, builder);
        let [modulus, curvature] = ["modulus", "spontaneous_curvature"].map(&mut material);
        let method = table.text("method").and_then(|text| text.parse().ok());
        let areas = table.text(MethodOptions::AREAS);
        let bandwidth = table.text(MethodOptions::BANDWIDTH);
        let in_mean_areas = table.number(MethodOptions::BANDWIDTH);
        Self {
            method: method.unwrap_or(BendingMethod::GompperKroll),
            options: MethodOptions {
                areas: areas.and_then(|name| MethodOptions::parse_areas(name).ok()),
                bandwidth: bandwidth
                    .and_then(|name| MethodOptions::parse_bandwidth(name).ok())
                    .or(in_mean_areas.map(Bandwidth::MeanArea)),
            },
            modulus: modulus.unwrap_or(Material::Number(f64::NAN)),
            spontaneous_curvature: curvature.unwrap_or(Material::Number(0.0)),
        }
    }
}

impl SurfaceEffect for Bending {
    fn check(&self, check: &mut Check<'_, '_>) {
        let is_kantor_nelson = self.method == BendingMethod::KantorNelson;
        if is_kantor_nelson && self.modulus.column().is_some() {
            check.contradiction(
                "bending.modulus",
                "method kantor-nelson (A) has one modulus for all edges: choose another method, or a \
                 number"
                    .to_owned(),
            );
        }
        if is_kantor_nelson && self.spontaneous_curvature != Material::Number(0.0) {
            check.contradiction(
                "bending.spontaneous_curvature",
                "method kantor-nelson (A) has no spontaneous curvature: choose another method"
                    .to_owned(),
            );
        }
        if self.varies() {
            check.doubt_unheld_parts(Self::NAME);
        }
        if let Err(unused) = self.options.check(self.method) {
            check.contradiction(&format!("bending.{}", unused.option), unused.to_string());
        }
        if is_kantor_nelson && check.fluid().is_some() {
            let message = "method kantor-nelson (A) uses k̃ = 2κ/√3, with which capsules in shear \
             deform 37 to 43 % too much (Ca_G = 0.15, b = 0.1125): choose gompper-kroll (B) or j4";
            check.doubt("bending.method", message.to_owned());
        }
    }

    fn check_mesh(&self, check: &mut MeshCheck<'_>) {
        self.check_edge(check);
        // The same limits apply to every method.
        let method = GompperKroll {
            modulus: self.modulus.parameter(),
            spontaneous_curvature: self.spontaneous_curvature.parameter(),
            area: DualArea::default(),
        };
        let range = Method::<f64>::check(&method);
        match check.driver {
            Driver::Relax(_) => self.check_size(check, range),
            _ => {
                if let Err(error) = range {
                    check.contradiction("bending", error.to_string());
                }
                self.check_evenness(check);
            }
        }
    }

    fn columns(&self) -> Vec<&Arc<Column>> {
        let parameters = [&self.modulus, &self.spontaneous_curvature];
        parameters
            .into_iter()
            .filter_map(Material::column)
            .collect()
    }

    fn columns_mut(&mut self) -> Vec<&mut Arc<Column>> {
        let parameters = [&mut self.modulus, &mut self.spontaneous_curvature];
        let columns = parameters.into_iter().filter_map(Material::column_mut);
        columns.collect()
    }

    fn stiffness(&self) -> Stiffness {
        Stiffness {
            bending: self.modulus.largest(),
            ..Stiffness::default()
        }
    }

    fn bytes(&self, mesh: &MeshInfo) -> u64 {
        self.method
            .bytes(&self.options, mesh.vertices, mesh.valences)
    }

    fn explain(&self, number: &Parameters) -> (String, Vec<Parameter>) {
        let mut choice = match self.options {
            options if options.is_default() => self.method.to_string(),
            options => format!("{}, {options}", self.method),
        };
        if self.method == BendingMethod::KantorNelson {
            choice.push_str(", k̃ = 2κ/√3 at an edge, E = 2 ∫ κ (H² − ⅔ K) dS");
        }
        let mut parameters = Vec::new();
        for (name, material, dimension) in [
            ("modulus", &self.modulus, Dimension::ENERGY),
            (
                "spontaneous_curvature",
                &self.spontaneous_curvature,
                Dimension::CURVATURE,
            ),
        ] {
            match material {
                Material::Number(value) if *value == 0.0 => {}
                Material::Number(value) => parameters.push(number.of(name, *value, dimension)),
                Material::Column { .. } => {
                    let range = material.range().unwrap_or_default();
                    choice.push_str(&format!(", {name} {range}"));
                }
            }
        }
        (choice, parameters)
    }

    fn groups(&self, groups: &mut Groups<'_>) {
        let spontaneous = self.spontaneous_curvature.uniform();
        if let Some(curvature) = spontaneous.filter(|&curvature| curvature != 0.0) {
            let reduced = 2.0 * curvature * groups.radius();
            groups.add("reduced spontaneous curvature", "c0 R = 2 H0 R", reduced);
        }
        let rate = groups.driver.flow().and_then(Flow::rate);
        let modulus = self.modulus.uniform();
        if let (Some(rate), Some(viscosity), Some(modulus)) =
            (rate, groups.driver.viscosity(), modulus)
        {
            let viscous = viscosity * rate * groups.mesh.enclosed_radius().powi(3);
            let name = "capillary number by κ";
            groups.add(name, "Ca_κ = μγ̇a³/κ", viscous / modulus);
        }
    }

    fn prepare(&self, preparation: &mut Preparation<'_>) -> Result<(), EffectError> {
        let effect = Effect::bending(
            Self::NAME,
            self.method,
            &self.options,
            [&self.modulus, &self.spontaneous_curvature]
                .map(|material| preparation.parameter(material)),
            preparation.lumping,
            preparation.mesh(),
        )?;
        preparation.forces.push(effect);
        Ok(())
    }
}

impl Bending {
    /// Whether κ or H0 varies over the surface.
    fn varies(&self) -> bool {
        let parameters = [&self.modulus, &self.spontaneous_curvature];
        parameters
            .iter()
            .any(|parameter| parameter.uniform().is_none())
    }

    /// Reports forces whose squares overflow or underflow, and parameters beyond the `range`.
    fn check_size(&self, check: &mut MeshCheck<'_>, range: Result<(), ParameterError>) {
        let radius = (check.mesh.area / (4.0 * std::f64::consts::PI)).sqrt();
        let unit = self.modulus.largest() / radius.powi(3);
        if !(unit * unit).is_normal() {
            let message = format!(
                "forces per area of \"{}\" are of the size of κ/R³ = {}, whose square is beyond the \
                 numbers of f64: choose other units",
                check.name,
                Six(unit)
            );
            check.contradiction("bending.modulus", message);
        } else if let Err(error) = range {
            check.contradiction("bending", error.to_string());
        }
    }

    /// Reports methods without an energy, or with a different energy, at an edge.
    fn check_edge(&self, check: &mut MeshCheck<'_>) {
        if check.mesh.boundary_edges == 0 {
            return;
        }
        let (name, method) = (check.name, self.method);
        if !method.is_conservative() {
            let message = format!(
                "\"{name}\" is open, and {method} has no forces at an edge, which only the gradient of \
                 an energy defines: choose gompper-kroll (B), juelicher, hamann or loop (S)"
            );
            check.contradiction("bending.method", message);
        }
        if method == BendingMethod::KantorNelson && check.boundary != Boundary::Clamped {
            let message = format!(
                "\"{name}\" is open, and the energy of method kantor-nelson (A) includes a Gaussian \
                 modulus, −4κ/3 on equilateral triangles, which acts at its edge: choose gompper-kroll (B)"
            );
            check.doubt("bending.method", message);
        }
    }

    /// Reports uneven meshes, with which some methods are unstable in a flow.
    fn check_evenness(&self, check: &mut MeshCheck<'_>) {
        let mesh = check.mesh;
        let [fewest, most] = mesh.valences;
        let irregular = fewest <= 3 || most >= 9;
        let uneven = match check.source {
            MeshSource::Shape {
                family: Family::Irregular | Family::Hard,
                ..
            } => true,
            _ => irregular || mesh.angles[0] < 10.0,
        };
        let consequence = match self.method {
            BendingMethod::GompperKroll => {
                "with method gompper-kroll (B) steps were 100 times shorter on irregular meshes, and \
                 vanishingly short on slivers"
            }
            BendingMethod::Meyer => {
                "with method meyer (C) steps were 200 times shorter on irregular meshes, and shorter \
                 still on slivers"
            }
            BendingMethod::Farutin => {
                "with method farutin (E) deformations at the scale of the mesh grow without limit on \
                 slivers, and irregular meshes took ten times the steps of j4"
            }
            BendingMethod::Belkin if irregular => {
                "with method belkin (D) capsules on irregular meshes deformed too much, by 3 % with \
                 162 vertices and by 8 % with 642"
            }
            BendingMethod::Hamann if irregular => {
                "with method hamann steps were vanishingly short on irregular meshes with 162 vertices"
            }
            BendingMethod::Loop if irregular => {
                "with method loop (S) irregular meshes took six times the steps of j4, and steps were \
                 vanishingly short with 162 vertices"
            }
            _ => return,
        };
        if uneven {
            let angle = mesh.angles[0];
            let message = format!(
                "the mesh of \"{}\" is uneven, with {fewest} to {most} neighbours of a vertex and \
                 angles from {angle:.1}°: {consequence}: choose j4, or an even mesh",
                check.name
            );
            check.doubt("bending.method", message);
        }
    }
}
