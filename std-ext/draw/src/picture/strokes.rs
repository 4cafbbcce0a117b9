//! Short lines on surfaces, spread evenly over the picture.

use super::PaintedSurface;
use super::canvas::{Area, Canvas};
use super::colour::{INK, WHITE};
use super::render::{Camera, Depths, vertex_normals};
use helfrich::Surface;
use std::collections::BTreeMap;

/// Smallest distance of neighbouring lines, in heights of capitals and in edges of the mesh: at smaller
/// distances, some lattice cells would contain no vertex.
const LEAST_SPACING: [f64; 2] = [2.0, 1.3];

/// Lengths of the lines of the first and the second direction, relative to their distance, so that they do
/// not touch.
const LENGTHS: [f64; 2] = [0.8, 0.45];

/// Widths of these lines, in heights of capitals, and of the light rims that set them off from dark colours.
const WIDTHS: [f64; 2] = [0.14, 0.09];
const RIM: f64 = 0.08;

/// Smallest cosine between a surface's normal and the view; beyond it, lines would be too foreshortened.
const LEAST_TILT: f64 = 0.25;

/// Position of a line, and the visible vertex nearest to it.
struct StrokePlace {
    vertex: usize,
    /// Distance from the position to the vertex, in pixels.
    off: f64,
    /// Pixels to the right and down, and nearness.
    at: [f64; 3],
    /// Tolerance of the nearness for a line to count as on the surface.
    slack: f64,
}

/// Centres of lattice cells in which there is a visible vertex with directions, each with the nearest such
/// vertex. Odd rows of the lattice are shifted by half a cell. Lines at the vertices themselves would be
/// spread as unevenly as the vertices.
fn places(
    painted: &PaintedSurface<'_>,
    directions: &[Option<[[f64; 3]; 2]>],
    camera: &Camera,
    depths: &Depths,
    spacing: f64,
) -> BTreeMap<[i64; 2], StrokePlace> {
    let mut places = BTreeMap::<_, StrokePlace>::new();
    let positions = painted.surface.positions().iter();
    let normals = vertex_normals(painted.surface);
    for (vertex, (&position, normal)) in positions.zip(normals).enumerate() {
        let [x, y, near] = camera.project(position);
        let tilt = camera.tilt(normal);
        // Around a vertex, the nearness changes with the tilt of the surface, and coarse meshes are bent.
        let slack = 0.1 * spacing * (1.0 + 1.0 / tilt);
        let is_seen = tilt >= LEAST_TILT && near >= depths.at([x, y]) - slack;
        if !is_seen || directions[vertex].is_none() {
            continue;
        }
        let row = (y / spacing).floor();
        let shift = 0.5 * row.rem_euclid(2.0);
        let column = (x / spacing + shift).floor();
        let middle = [column + 0.5 - shift, row + 0.5].map(|at| spacing * at);
        let off = ((x - middle[0]).powi(2) + (y - middle[1]).powi(2)).sqrt();
        let surface = depths.at(middle);
        // The centre is on the same part of the surface if the depth changes by no more than the tilt
        // explains.
        let is_there = (surface - near).abs() <= slack + off / tilt;
        let cell = [row as i64, column as i64];
        if is_there && places.get(&cell).is_none_or(|other| off < other.off) {
            let at = [middle[0], middle[1], surface];
            places.insert(
                cell,
                StrokePlace {
                    vertex,
                    off,
                    at,
                    slack,
                },
            );
        }
    }
    places
}

/// Edge length of a mesh of equal equilateral triangles with the same area.
fn edge(surface: Surface<'_, f64>) -> f64 {
    let triangles = surface.mesh().triangles().len();
    let area: f64 = (0..triangles)
        .map(|triangle| surface.triangle_area(triangle))
        .sum();
    (4.0 / 3.0_f64.sqrt() * area / triangles as f64).sqrt()
}

/// Draws the lines of a surface where the surface is visible.
pub(super) fn draw(
    canvas: &mut Canvas,
    area: Area,
    painted: &PaintedSurface<'_>,
    camera: &Camera,
    depths: &Depths,
    letters: f64,
) {
    let Some(directions) = painted.strokes else {
        return;
    };
    let units = [letters, camera.scale * edge(painted.surface)];
    let [least, of_mesh] = [0, 1].map(|unit| LEAST_SPACING[unit] * units[unit]);
    let spacing = least.max(of_mesh);
    let places = places(painted, directions, camera, depths, spacing);
    // Follows a line from its position, pixel by pixel, while it stays on the surface.
    let reach = |place: &StrokePlace, [right, down, nearer]: [f64; 3], length: f64| {
        let [x, y, near] = place.at;
        let half = 0.5 * length * spacing;
        let steps = (1..=half.ceil() as usize).map(|step| half.min(step as f64));
        let ends = steps.map(|step| [x + step * right, y + step * down, near + step * nearer]);
        let on_surface = ends.take_while(|&[x, y, near]| {
            area.contains([x, y]) && (near - depths.at([x, y])).abs() <= place.slack
        });
        on_surface.last().map_or([x, y], |[x, y, _]| [x, y])
    };
    let lines = [0, 1].map(|which| {
        let lines = places.values().filter_map(|place| {
            let along = camera.turn(directions[place.vertex]?[which]);
            let ends = [along, along.map(|x| -x)].map(|to| reach(place, to, LENGTHS[which]));
            (ends[0] != ends[1]).then(|| ends.to_vec())
        });
        Vec::from_iter(lines)
    });
    for (rim, colour) in [(RIM, WHITE), (0.0, INK)] {
        for (lines, width) in lines.iter().zip(WIDTHS) {
            canvas.stroke(lines, ((width + 2.0 * rim) * letters).max(1.0), colour);
        }
    }
}
