//! Isosurfaces of values on a grid.
//!
//! Marching cubes and their kin put every vertex on an edge of the grid, so that two of its three coordinates are those
//! of nodes. If the values are those of a mask, blurred or not, the surface has ripples with the wavelength of
//! the cells and longer, which all neighbours of a vertex share: a fit takes them for the shape.

use super::sort;
use crate::real::Real;
use crate::vec3::Vec3;
use alloc::vec::Vec;

/// Least number of vertices in a plane of the grid. Of 48 vertices that the symmetries of a cube map to each other, eight
/// have the same coordinate.
const IN_PLANE: usize = 12;

/// Least number of planes along an axis.
const PLANES: usize = 4;

/// Largest distance of a plane from its place in the grid, in spacings.
const OFF: f64 = 1e-3;

/// Least part of the vertices that are on edges of the grid: the others are where triangles were divided or joined.
const ON_EDGES: f64 = 0.9;

/// Whether most vertices lie on the edges of a grid along the axes.
pub(super) fn is_on_grid<T: Real>(positions: &[Vec3<T>]) -> bool {
    let planes = [0, 1, 2].map(|axis| planes(positions, axis));
    let is_on_edge = |position: &&Vec3<T>| {
        let in_plane = position.iter().zip(&planes).filter(|(x, planes)| {
            let place = planes.partition_point(|plane| plane < x);
            planes.get(place) == Some(x)
        });
        in_plane.count() >= 2
    };
    let on_edges = positions.iter().filter(is_on_edge).count();
    on_edges as f64 >= ON_EDGES * positions.len() as f64
}

/// The coordinates along an axis that many vertices have, if these are evenly spaced; otherwise none.
fn planes<T: Real>(positions: &[Vec3<T>], axis: usize) -> Vec<T> {
    let mut all = Vec::from_iter(positions.iter().map(|position| position[axis]));
    sort(&mut all);
    let same = all.chunk_by(|a, b| a == b);
    let planes = same.filter(|same| same.len() >= IN_PLANE);
    let planes = Vec::from_iter(planes.map(|same| same[0]));
    let gaps = || planes.windows(2).map(|pair| pair[1] - pair[0]);
    let spacing = gaps().fold(T::infinity(), T::min);
    let is_whole = |gap: T| {
        let steps = gap / spacing;
        (steps - steps.round()).abs() <= T::constant(OFF)
    };
    if planes.len() >= PLANES && gaps().all(is_whole) {
        planes
    } else {
        Vec::new()
    }
}
