//! Meshes of bodies with their columns and ratios to flat triangles.

use super::super::curved::Curved;
use super::wanted::Wanted;
use crate::held::{Quantity, keep_volumes_on};
use crate::io::ColumnPlace;
use crate::method::{BendingMethod, Evaluator};
use crate::remesh::{
    NewMesh, RemeshError, carried, in_order_of_components, old_triangles, remeshed,
};
use crate::scene::{Driver, SurfaceScene};
use crate::simulation::{Body, BodyMesh};
use helfrich::{AnyFunctional, MaterialParameter, Surface};

/// A new mesh of a surface, with its columns. Its closed components have their volumes.
pub(super) fn new_mesh(
    wanted: Wanted,
    body: &Body,
    surface: Surface<'_, f64>,
    interrupted: &dyn Fn() -> bool,
) -> Result<BodyMesh, RemeshError> {
    let request = wanted.request(surface.area());
    let NewMesh {
        smooth, mut made, ..
    } = remeshed(surface, &request, &mut |_| !interrupted())?;
    in_order_of_components(surface.mesh(), &mut made);
    let mut positions = Vec::from_iter(made.points.iter().map(|point| point.position));
    keep_volumes_on(surface, &made.mesh, &mut positions)?;
    let columns = body.columns();
    let fields = columns.iter();
    let fields = fields.filter(|column| column.place == ColumnPlace::Vertices);
    let fields = Vec::from_iter(fields.map(|column| &column.values[..]));
    let mut fields = carried(&smooth, &made.places, &fields).into_iter();
    let triangles = old_triangles(&made);
    let columns = columns.iter().map(|column| match column.place {
        ColumnPlace::Triangles => triangles.iter().map(|&old| column.values[old]).collect(),
        ColumnPlace::Vertices => {
            // Parameters stay within their range, in which methods have been checked.
            let (low, high) = range(&column.values);
            let values = fields.next().unwrap_or_default().into_iter();
            values.map(|value| value.clamp(low, high)).collect()
        }
    });
    let columns = columns.collect();
    let ratios = match Surface::new(&made.mesh, &positions) {
        Ok(new) if wanted.smooth => ratios_to_flat(new),
        _ => Vec::new(),
    };
    Ok(BodyMesh {
        mesh: made.mesh,
        positions,
        columns,
        ratios,
    })
}

/// The mesh that a surface has, with its present ratios to flat triangles.
pub(super) fn same_mesh(body: &Body, own: Surface<'_, f64>) -> BodyMesh {
    let columns = body.columns().iter();
    BodyMesh {
        mesh: body.mesh().clone(),
        positions: own.positions().to_vec(),
        columns: columns.map(|column| column.values.clone()).collect(),
        ratios: ratios_to_flat(own),
    }
}

/// Area and volume of each component of the curved surface through the vertices, by the normals of jets of degree 6, over
/// those of its flat triangles; 1 where jets or flat triangles do not measure them.
pub(super) fn ratios_to_flat(surface: Surface<'_, f64>) -> Vec<[f64; 2]> {
    let mesh = surface.mesh();
    let (groups, count) = mesh.components();
    let fields = Evaluator::new(BendingMethod::J6, 1.0, mesh).fields(surface);
    // H is not needed for these.
    let mean = vec![0.0; mesh.vertex_count()];
    let none = [0.0; 2].map(MaterialParameter::Constant);
    let curved = Curved::new(surface, &fields.normal, &mean, none).integrals(&groups, count);
    let flat = [AnyFunctional::Area, AnyFunctional::Volume];
    let flat = flat.map(|of| Quantity::new(of, mesh).values(surface).to_vec());
    let ratio = |curved: f64, flat: f64| {
        let ratio = curved / flat;
        if ratio.is_finite() { ratio } else { 1.0 }
    };
    let parts = curved.iter().enumerate();
    let parts = parts.map(|(at, curved)| {
        [
            ratio(curved.area, flat[0][at]),
            ratio(curved.volume, flat[1][at]),
        ]
    });
    parts.collect()
}

/// Whether area or volume of flat triangles are held exactly.
pub(super) fn holds_triangles(surface: &SurfaceScene, driver: &Driver) -> bool {
    let effects = &surface.effects;
    let geometry = effects.geometry(driver);
    let area = effects.area.is_some_and(|area| area.hold.is_exact());
    let volume = effects.volume.is_some_and(|volume| volume.hold.is_exact());
    let is_flat = [geometry.area, geometry.volume] == [AnyFunctional::Area, AnyFunctional::Volume];
    matches!(driver, Driver::Relax(_)) && is_flat && (area || volume)
}

/// The least and the largest of some numbers.
fn range(values: &[f64]) -> (f64, f64) {
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    let values = values.iter();
    values.fold(start, |(low, high), &value| {
        (low.min(value), high.max(value))
    })
}
