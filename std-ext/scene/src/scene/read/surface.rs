//! Builds surfaces from their values.

use super::super::boundary::Boundary;
use super::super::builder::Builder;
use super::super::effects::{Check, Effects, Stiffness};
use super::super::problem::Problem;
use super::super::reader::Reader;
use super::super::remesh::{Remesh, Topology};
use super::super::value::default_name;
use super::super::{Driver, MeshSource, Orientation, SurfaceScene};
use crate::generate::{AnyShape, Family, check as check_mesh};
use helfrich::shapes::Sphere;

impl Builder<'_> {
    pub(super) fn surface(&mut self, index: usize, surface: Reader<'_>) -> SurfaceScene {
        let name = match surface.text("name") {
            Some(name) => name.to_owned(),
            None => default_name("surface", index),
        };
        SurfaceScene {
            position: surface.vector("position").unwrap_or_default(),
            orientation: orientation(surface),
            boundary: surface
                .text("boundary")
                .and_then(Boundary::parse)
                .unwrap_or_default(),
            remesh: Remesh::read(surface),
            topology: Topology::read(surface),
            ..self.of_a_kind(name, surface)
        }
    }

    /// A surface with the keys that it may share with others, at the origin.
    pub(super) fn of_a_kind(&mut self, name: String, surface: Reader<'_>) -> SurfaceScene {
        let source = self.source(surface);
        SurfaceScene {
            name,
            scale: surface.number("scale").unwrap_or(1.0),
            position: [0.0; 3],
            orientation: None,
            boundary: Boundary::default(),
            remesh: None,
            topology: None,
            viscosity_ratio: surface.number("viscosity_ratio"),
            effects: Effects::read(surface, &source, self),
            source,
        }
    }

    /// The source of the mesh of a surface or an obstacle.
    pub(super) fn source(&mut self, surface: Reader<'_>) -> MeshSource {
        if let Some(name) = surface.text("mesh") {
            return MeshSource::File(self.mesh_file(name, surface));
        }
        let shape = surface.text("shape").and_then(|text| text.parse().ok());
        let family = surface.text("family").and_then(|text| text.parse().ok());
        let family = family.unwrap_or(Family::Smooth);
        let vertices = surface.count("vertices");
        let size = vertices.map(|count| usize::try_from(count).unwrap_or(usize::MAX));
        if let (Some(shape), Some(vertices)) = (&shape, size)
            && let Err(error) = check_mesh(shape, vertices)
        {
            let origin = surface.origin_of("vertices");
            self.problems.add(&origin, Problem::Generate(error));
        }
        MeshSource::Shape {
            shape: shape.unwrap_or(UNIT_SPHERE),
            family,
            vertices: size.unwrap_or(0),
            seed: surface.count("seed").unwrap_or(1),
            match_volume: surface.switch("match_volume").unwrap_or(false),
        }
    }

    /// Reports values that are valid separately but invalid, or doubtful, together.
    pub(super) fn effects(
        &mut self,
        surface: &SurfaceScene,
        reader: Reader<'_>,
        driver: Option<&Driver>,
    ) {
        let SurfaceScene { name, effects, .. } = surface;
        let mut check = Check {
            builder: &mut *self,
            name,
            effects,
            surface: reader,
            driver,
        };
        for (_, effect) in effects.iter() {
            effect.check(&mut check);
        }
        self.remesh(surface, reader);
        match driver {
            None => {}
            Some(Driver::Relax(_)) => self.without_fluid(surface, reader),
            Some(driver) => self.in_fluid(surface, reader, driver),
        }
    }

    /// Reports values that are invalid or doubtful for drivers without fluid.
    fn without_fluid(&mut self, surface: &SurfaceScene, reader: Reader<'_>) {
        let SurfaceScene { name, .. } = surface;
        if surface.viscosity_ratio.is_some_and(|ratio| ratio != 1.0) {
            self.contradiction(
                &reader.origin_of("viscosity_ratio"),
                "the driver \"relax\" has no flow, and no viscosities: leave `viscosity_ratio` out, \
                 or choose the driver \"boundary-integral\""
                    .to_owned(),
            );
        }
        if surface.effects.is_empty() {
            let message =
                format!("nothing acts on \"{name}\": add an effect, such as [surface.bending]");
            self.doubt(reader.origin(), message);
        }
    }

    /// Reports values that are invalid or doubtful for drivers with fluid.
    fn in_fluid(&mut self, surface: &SurfaceScene, reader: Reader<'_>, driver: &Driver) {
        let SurfaceScene { name, .. } = surface;
        if !surface.boundary.is_free() {
            self.contradiction(
                &reader.origin_of("boundary"),
                format!(
                    "a flow would also act on the support of \"{name}\", and the force that its support \
                     exerts on the fluid is not computed: choose the driver \"relax\", or \
                     `boundary = \"free\"`"
                ),
            );
        }
        if surface.effects.stiffness() == Stiffness::default() {
            self.contradiction(
                reader.origin(),
                format!(
                    "nothing in \"{name}\" resists deformation, and the flow would draw it out \
                     without end: add `bending`, `elasticity`, `tension`, `local_area` or a penalty on \
                     its `area`"
                ),
            );
        }
        if let Driver::LatticeBoltzmann(lattice) = driver {
            self.in_a_box(surface, reader, lattice);
        }
    }
}

const UNIT_SPHERE: AnyShape = AnyShape::Sphere(Sphere { radius: 1.0 });

pub(super) fn orientation(around: Reader<'_>) -> Option<Orientation> {
    let reader = around.table("orientation")?;
    Some(Orientation {
        axis: reader.vector("axis").unwrap_or_default(),
        angle: reader.needed("angle"),
    })
}
