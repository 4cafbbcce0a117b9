//! Short lines on surfaces, evenly spread over the picture.

use super::PaintedSurface;
use super::canvas::{Area, Canvas};
use super::colour::{INK, WHITE};
use super::render::{Camera, Depths, vertex_normals};

/// Distance of neighbouring lines, in heights of capitals.
const SPACING: f64 = 1.9;

/// Lengths of the lines of each field, in the same: the first ones are longer.
const LENGTHS: [f64; 2] = [1.6, 0.7];

/// Width of a line, and with its light rims, by which it stands out from dark colours.
const WIDTH: f64 = 0.13;
const RIMMED: f64 = 0.3;

/// The least cosine between a surface's normal and the view: beyond, lines are too foreshortened to be read.
const LEAST_TILT: f64 = 0.25;

/// A vertex in front, where lines may be drawn.
#[derive(Clone, Copy)]
struct Seen {
    vertex: usize,
    /// Squared distance from the middle of its cell, in pixels.
    off: f64,
}

/// Draws the lines of a surface at one visible vertex in each cell of a lattice over the picture.
pub(super) fn draw(
    canvas: &mut Canvas,
    area: Area,
    painted: &PaintedSurface<'_>,
    camera: &Camera,
    depths: &Depths,
    letters: f64,
) {
    if painted.strokes.is_empty() {
        return;
    }
    let spacing = SPACING * letters;
    let [across, down] = [area.width(), area.bottom - area.top]
        .map(|extent| (extent / spacing).ceil().max(0.0) as usize);
    let mut cells: Vec<Option<Seen>> = vec![None; across * down];
    let positions = painted.surface.positions();
    for (vertex, (&position, normal)) in positions
        .iter()
        .zip(vertex_normals(painted.surface))
        .enumerate()
    {
        let is_known = |field: &&[[f64; 3]]| field[vertex].iter().all(|x| x.is_finite());
        let [x, y, near] = camera.project(position);
        let tilt = camera.tilt(normal);
        // The surface around the vertex is nearer by as much as it rises within a pixel or two.
        let is_hidden = near < depths.at([x, y]) - 2.0 * (1.0 + 1.0 / tilt);
        let is_steep = tilt.is_nan() || tilt < LEAST_TILT;
        if is_steep || is_hidden || !painted.strokes.iter().any(is_known) {
            continue;
        }
        let [column, row] = [(x - area.left) / spacing, (y - area.top) / spacing];
        let is_inside = column >= 0.0 && row >= 0.0 && column < across as f64 && row < down as f64;
        if !is_inside {
            continue;
        }
        let off = (column.fract() - 0.5).powi(2) + (row.fract() - 0.5).powi(2);
        let cell = &mut cells[row as usize * across + column as usize];
        if cell.is_none_or(|seen| off < seen.off) {
            *cell = Some(Seen { vertex, off });
        }
    }
    let lines = painted.strokes.iter().zip(LENGTHS).map(|(field, length)| {
        let half = 0.5 * length * letters / camera.scale;
        let lines = cells.iter().flatten().map(|seen| {
            let (position, direction) = (positions[seen.vertex], field[seen.vertex]);
            [-half, half].map(|part| {
                let end = [0, 1, 2].map(|axis| position[axis] + part * direction[axis]);
                let [x, y, _] = camera.project(end);
                [x, y]
            })
        });
        let known = lines.filter(|ends| ends.iter().flatten().all(|x| x.is_finite()));
        Vec::from_iter(known.map(|ends| ends.to_vec()))
    });
    let lines = lines.collect::<Vec<_>>().concat();
    for (width, colour) in [(RIMMED, WHITE), (WIDTH, INK)] {
        canvas.stroke(&lines, (width * letters).max(1.0), colour);
    }
}
