//! Flow on a plane: colours, streamlines, and sections with surfaces.

use super::canvas::{Anchor, Area, Canvas};
use super::colour::{ColourTable, INK, WHITE, encoded};
use super::streamlines::{Streamlines, between};
use super::ticks::Ticks;
use super::{
    Colouring, PictureError, capitals, check_size, colour_bar, fitted, outline_of, range_of, title,
};
use glam::DVec3;
use helfrich::Surface;
use helfrich_mesh::io::Grid;
use helfrich_mesh::section::section;

/// Flow on a rectangle of a plane, viewed along the negative normal.
#[derive(Clone, Debug)]
pub struct FlowSlice<'a> {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The title; none if empty.
    pub title: &'a str,
    /// Grid of points: two or more along the first axis, to the right, two or more along the second, upwards,
    /// and one along the third, the normal.
    pub grid: Grid,
    /// The velocity at each point; streamlines follow its component in the plane.
    pub velocity: &'a [[f64; 3]],
    /// Field shown in colours, for example the pressure; by default |u|. Grey where it is not finite.
    pub field: Option<&'a [f64]>,
    /// The map from this field to colours.
    pub colours: Colouring<'a>,
    /// Surfaces whose sections are drawn.
    pub surfaces: &'a [Surface<'a, f64>],
    /// The unit of the positions, if there is one.
    pub length_unit: Option<&'a str>,
}

impl FlowSlice<'_> {
    /// Draws the slice.
    ///
    /// # Errors
    /// If the size, the grid, a range or a field's length is impossible; see [`PictureError`].
    pub fn draw(&self) -> Result<Canvas, PictureError> {
        check_size(self.size)?;
        self.check()?;
        let speeds = Vec::from_iter(self.velocity.iter().map(|&u| DVec3::from(u).length()));
        let values = self.field.unwrap_or(&speeds);
        let finite = values.iter().copied().filter(|value| value.is_finite());
        let range = range_of(self.colours, finite)?;
        let mut canvas = Canvas::new(self.size);
        let letters = capitals(self.size);
        let [width, height] = self.size.map(f64::from);
        let mut area = Area {
            left: 1.6 * letters,
            top: 2.0 * letters,
            right: width - 2.0 * letters,
            bottom: height - 1.8 * letters,
        };
        title(&mut canvas, self.title, letters, &mut area);
        let table = ColourTable::new(self.colours.map);
        let label = self.colours.label;
        colour_bar(
            &mut canvas,
            letters,
            &table,
            label,
            range,
            values,
            &mut area,
        );
        area.left += 6.5 * letters;
        // The picture begins below the name at the colour bar, which may be wider than the bar.
        area.top += 2.4 * letters;
        area.bottom -= 5.0 * letters;
        let map = Map::new(self.grid, area);
        self.paint(&mut canvas, &map, values, range, &table);
        self.streamlines(&mut canvas, &map, letters);
        self.outlines(&mut canvas, &map, letters);
        self.frame(&mut canvas, &map, letters);
        Ok(canvas)
    }

    fn check(&self) -> Result<(), PictureError> {
        let Grid {
            origin,
            axes,
            spacings,
            counts,
        } = self.grid;
        let numbers = axes.as_flattened().iter().chain(&origin).chain(&spacings);
        let is_plane = counts[0] > 1 && counts[1] > 1 && counts[2] == 1;
        let is_finite = numbers.copied().all(f64::is_finite);
        if !(is_plane && is_finite && spacings[0] > 0.0 && spacings[1] > 0.0) {
            return Err(PictureError::Grid { counts });
        }
        let points = self.grid.point_count();
        let found = [Some(self.velocity.len()), self.field.map(<[f64]>::len)];
        match found.into_iter().flatten().find(|&found| found != points) {
            Some(found) => Err(PictureError::PointMismatch { found, points }),
            None => Ok(()),
        }
    }

    /// Paints a scalar field, pixel by pixel.
    fn paint(
        &self,
        canvas: &mut Canvas,
        map: &Map,
        values: &[f64],
        [low, high]: [f64; 2],
        table: &ColourTable,
    ) {
        let area = map.area;
        let (first, last) = (area.left as usize, area.right as usize);
        for y in area.top as usize..area.bottom as usize {
            for (x, pixel) in (first..).zip(&mut canvas.row_mut(y)[first..last]) {
                let at = [x as f64 + 0.5, y as f64 + 0.5];
                let value = map.interpolated(at, |point| values[point]);
                let colour = table.at(((value - low) / (high - low)) as f32);
                *pixel = colour.map(encoded);
            }
        }
    }

    fn streamlines(&self, canvas: &mut Canvas, map: &Map, letters: f64) {
        let [right, up, _] = self.grid.axes.map(DVec3::from);
        let flat = |point: usize| {
            let velocity = DVec3::from(self.velocity[point]);
            [velocity.dot(right), -velocity.dot(up)]
        };
        let speed = |point| {
            let [x, y] = flat(point);
            x.hypot(y)
        };
        let speeds = (0..self.velocity.len()).map(speed);
        // At smaller speeds, the in-plane direction is meaningless.
        let least = 1e-5 * speeds.filter(|speed| speed.is_finite()).fold(0.0, f64::max);
        let direction = |at: [f64; 2]| {
            if !map.area.contains(at) {
                return None;
            }
            let [x, y] = [0, 1].map(|axis| map.interpolated(at, |point| flat(point)[axis]));
            let speed = x.hypot(y);
            (speed > least).then(|| [x / speed, y / speed])
        };
        let lines = Streamlines::new(map.area, 2.6 * letters).all(&direction);
        let thin = (0.11 * letters).max(1.0);
        canvas.stroke(&lines, thin + 0.16 * letters, WHITE);
        for line in &lines {
            for place in arrow_places(line, 14.0 * letters) {
                arrow(canvas, line, place, 0.62 * letters, 0.12 * letters);
            }
        }
        canvas.stroke(&lines, thin, INK);
        for line in &lines {
            for place in arrow_places(line, 14.0 * letters) {
                arrow(canvas, line, place, 0.62 * letters, 0.0);
            }
        }
    }

    /// Draws the sections of the surfaces.
    fn outlines(&self, canvas: &mut Canvas, map: &Map, letters: f64) {
        let [_, _, normal] = self.grid.axes;
        let mut lines = Vec::new();
        for &surface in self.surfaces {
            for line in section(surface, self.grid.origin, normal) {
                let ends = line.map(|end| map.pixel(map.in_plane(end)));
                lines.extend(map.area.clip(ends).map(|ends| ends.to_vec()));
            }
        }
        let width = (0.26 * letters).max(1.6);
        canvas.stroke(&lines, width + 0.3 * letters, WHITE);
        canvas.stroke(&lines, width, INK);
    }

    /// Draws the frame with coordinates along its axes.
    fn frame(&self, canvas: &mut Canvas, map: &Map, letters: f64) {
        let area = map.area;
        let line = (0.1 * letters).max(1.0);
        let tick = 0.5 * letters;
        canvas.stroke(&[outline_of(area)], line, INK);
        let [right, up] = map.ranges;
        let [across, high] = [
            area.width() / (9.0 * letters),
            area.height() / (6.0 * letters),
        ];
        let ticks = Ticks::linear(right[0], right[1], across.clamp(2.0, 8.0));
        for (value, number) in &ticks.marks {
            let [x, _] = map.pixel([*value, up[0]]);
            canvas.line([x, area.bottom], [x, area.bottom + tick], line, INK);
            let at = [x, area.bottom + 2.2 * letters];
            canvas.text(number, at, letters, Anchor::Centre, true);
        }
        let label = ticks.labelled(&self.axis_label(0));
        let at = [0.5 * (area.left + area.right), area.bottom + 4.6 * letters];
        let size = fitted(&label, letters, area.width());
        canvas.text(&label, at, size, Anchor::Centre, true);
        let ticks = Ticks::linear(up[0], up[1], high.clamp(2.0, 8.0));
        for (value, number) in &ticks.marks {
            let [_, y] = map.pixel([right[0], *value]);
            canvas.line([area.left - tick, y], [area.left, y], line, INK);
            let at = [area.left - 1.1 * letters, y + 0.5 * letters];
            canvas.text(number, at, letters, Anchor::Right, true);
        }
        let label = ticks.labelled(&self.axis_label(1));
        let at = [area.left - 5.0 * letters, 0.5 * (area.top + area.bottom)];
        let size = fitted(&label, letters, area.height());
        canvas.text(&label, at, size, Anchor::Centre, false);
    }

    /// Label of an axis: x, y or z, if it has that direction.
    fn axis_label(&self, axis: usize) -> String {
        let along = self.grid.axes[axis];
        let largest = (0..3).find(|&part| along[part].abs() > 1.0 - 1e-9);
        let name = match largest {
            Some(part) if along[part] > 0.0 => ["x", "y", "z"][part],
            Some(part) => ["−x", "−y", "−z"][part],
            None => ["along", "across"][axis],
        };
        match self.length_unit {
            Some(unit) => format!("{name} ({unit})"),
            None => name.to_owned(),
        }
    }
}

/// Map from points of the plane to pixels and grid points.
struct Map {
    grid: Grid,
    /// Lowest and highest coordinate along each axis.
    ranges: [[f64; 2]; 2],
    area: Area,
}

impl Map {
    /// Fits the largest rectangle with the proportions of the grid into an area.
    fn new(grid: Grid, room: Area) -> Self {
        let ranges = [0, 1].map(|axis| {
            let start = DVec3::from(grid.origin).dot(grid.axes[axis].into());
            let length = grid.spacings[axis] * (grid.counts[axis] - 1) as f64;
            [start, start + length]
        });
        let [across, high] = ranges.map(|[low, high]| high - low);
        let scale = (room.width() / across).min(room.height() / high);
        let width = (scale * across).max(1.0).round();
        let height = (scale * high).max(1.0).round();
        let left = (room.left + 0.5 * (room.width() - width)).round();
        let top = (room.top + 0.5 * (room.height() - height)).round();
        let area = Area {
            left,
            top,
            right: left + width,
            bottom: top + height,
        };
        Self { grid, ranges, area }
    }

    /// The coordinates of a point along the axes.
    fn in_plane(&self, point: [f64; 3]) -> [f64; 2] {
        [0, 1].map(|axis| DVec3::from(point).dot(self.grid.axes[axis].into()))
    }

    fn pixel(&self, place: [f64; 2]) -> [f64; 2] {
        let share = |axis: usize| {
            let [low, high] = self.ranges[axis];
            (place[axis] - low) / (high - low)
        };
        [
            self.area.left + share(0) * self.area.width(),
            self.area.bottom - share(1) * self.area.height(),
        ]
    }

    /// Bilinear interpolation between the four grid points around a pixel.
    fn interpolated(&self, [x, y]: [f64; 2], value: impl Fn(usize) -> f64) -> f64 {
        let [columns, rows, _] = self.grid.counts;
        let cell = |share: f64, count: usize| {
            let place = share.clamp(0.0, 1.0) * (count - 1) as f64;
            let first = (place as usize).min(count - 2);
            (first, place - first as f64)
        };
        let (column, u) = cell((x - self.area.left) / self.area.width(), columns);
        let (row, v) = cell((self.area.bottom - y) / self.area.height(), rows);
        let line = |row: usize| {
            let first = row * columns + column;
            (1.0 - u) * value(first) + u * value(first + 1)
        };
        (1.0 - v) * line(row) + v * line(row + 1)
    }
}

/// Indices of the points of a line at which arrows are drawn: evenly spaced, symmetric about the middle.
fn arrow_places(line: &[[f64; 2]], apart: f64) -> Vec<usize> {
    let mut lengths = vec![0.0];
    for pair in line.windows(2) {
        let so_far = lengths[lengths.len() - 1];
        lengths.push(so_far + between(pair[0], pair[1]));
    }
    let whole = lengths[lengths.len() - 1];
    let count = (whole / apart).max(1.0) as usize;
    let places = (0..count).map(|number| (number as f64 + 0.5) / count as f64 * whole);
    let at = |length: f64| lengths.partition_point(|&so_far| so_far < length);
    places.map(at).collect()
}

/// Draws an arrow head on a line; with a `rim`, it is wider by the rim, and white.
fn arrow(canvas: &mut Canvas, line: &[[f64; 2]], place: usize, size: f64, rim: f64) {
    let [a, b] = [place.saturating_sub(1), place].map(|at| line[at.min(line.len() - 1)]);
    let length = between(a, b);
    if length == 0.0 {
        return;
    }
    let along = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
    let corner = |forwards: f64, aside: f64| {
        [
            b[0] + forwards * along[0] - aside * along[1],
            b[1] + forwards * along[1] + aside * along[0],
        ]
    };
    let half = 0.7 * size + rim;
    let head = [
        corner(size + 2.0 * rim, 0.0),
        corner(-size - rim, half),
        corner(-size - rim, -half),
    ];
    canvas.polygon(&head, if rim > 0.0 { WHITE } else { INK });
}
