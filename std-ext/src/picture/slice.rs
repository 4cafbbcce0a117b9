//! Flow on a plane: colours, streamlines, and where the plane cuts surfaces.
//!
//! Streamlines at even distances: B. Jobard and W. Lefer, in: Visualization in Scientific Computing
//! '97, Springer 1997, p. 43. The code is our own.

use super::canvas::{Anchor, Area, Canvas};
use super::colour::{INK, Table, WHITE, encoded};
use super::ticks::Ticks;
use super::{
    Colouring, PictureError, capitals, check_size, colour_bar, fitted, outline_of, range_of, title,
};
use crate::io::Grid;
use crate::section::section;
use glam::DVec3;
use helfrich::Surface;
use std::collections::VecDeque;

/// Flow on a rectangle of a plane, seen against its normal.
#[derive(Clone, Debug)]
pub struct FlowSlice<'a> {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The line at the top; none if it is empty.
    pub title: &'a str,
    /// The points: two or more along the first axis, to the right, and the second, upwards; one along
    /// the third, the normal.
    pub grid: Grid,
    /// The velocity at each; streamlines follow what of it lies in the plane.
    pub velocity: &'a [[f64; 3]],
    /// What the colours show, pressure for one; without it |u|. Grey where it is not finite.
    pub field: Option<&'a [f64]>,
    /// How that becomes colours.
    pub colours: Colouring<'a>,
    /// Surfaces whose sections are drawn.
    pub surfaces: &'a [Surface<'a, f64>],
    /// The unit of the positions, if there is one.
    pub length_unit: Option<&'a str>,
}

impl FlowSlice<'_> {
    /// Draws it.
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
        let table = Table::new(self.colours.map);
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
        // Below the name of the colours, which may be wider than their bar.
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

    /// Colours of a scalar, pixel by pixel.
    fn paint(
        &self,
        canvas: &mut Canvas,
        map: &Map,
        values: &[f64],
        [low, high]: [f64; 2],
        table: &Table,
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
        // Slower than this the plane has no direction that means anything.
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

    /// Where the plane cuts the surfaces.
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

    /// The rectangle with the places along its axes.
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

    /// x, y or z where an axis is along them.
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

/// From places in the plane to pixels and points of the grid.
struct Map {
    grid: Grid,
    /// Lowest and highest place along each axis.
    ranges: [[f64; 2]; 2],
    area: Area,
}

impl Map {
    /// The grid's rectangle as large as it fits into an area.
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

    /// A point's place along the axes.
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

    /// Between the four points around a pixel, in proportion.
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

/// Lines along a field of unit vectors, about equally far from each other.
struct Streamlines {
    area: Area,
    /// From one line to the next where a line begins.
    apart: f64,
    /// The points of the lines so far, by squares of that size.
    cells: Vec<Vec<[f64; 2]>>,
    columns: usize,
}

type Polyline = Vec<[f64; 2]>;

impl Streamlines {
    /// Lines may come as near as this part of the distance at which they begin.
    const NEAREST: f64 = 0.5;
    /// Lines that extend less, in units of the distance, are left out.
    const SMALLEST: f64 = 0.8;

    fn new(area: Area, apart: f64) -> Self {
        let columns = (area.width() / apart) as usize + 1;
        let rows = (area.height() / apart) as usize + 1;
        Self {
            area,
            apart,
            cells: vec![Vec::new(); columns * rows],
            columns,
        }
    }

    fn all(mut self, direction: &dyn Fn([f64; 2]) -> Option<[f64; 2]>) -> Vec<Polyline> {
        let middle = [
            0.5 * (self.area.left + self.area.right),
            0.5 * (self.area.top + self.area.bottom),
        ];
        let mut lines: Vec<Polyline> = Vec::new();
        // Beside lines first, so that neighbours are parallel; then wherever there is room.
        let mut seeds = VecDeque::from([middle]);
        let mut lattice = self.lattice().into_iter();
        while let Some(seed) = seeds.pop_front().or_else(|| lattice.next()) {
            if !self.area.contains(seed) || self.is_near(seed, self.apart) {
                continue;
            }
            let Some(line) = self.line(seed, direction) else {
                continue;
            };
            for &[x, y] in line.iter().step_by(4) {
                if let Some([u, v]) = direction([x, y]) {
                    // Not quite as far, lest rounding put a line out of reach of its own seeds.
                    let aside = 1.001 * self.apart;
                    seeds.push_back([x - aside * v, y + aside * u]);
                    seeds.push_back([x + aside * v, y - aside * u]);
                }
            }
            for &point in &line {
                let cell = self.cell(point);
                self.cells[cell].push(point);
            }
            lines.push(line);
        }
        lines
    }

    /// Places at equal distances over the whole area.
    fn lattice(&self) -> Vec<[f64; 2]> {
        let rows = self.cells.len() / self.columns;
        let place = |cell: usize| {
            let [column, row] = [cell % self.columns, cell / self.columns].map(|at| at as f64);
            [
                self.area.left + (column + 0.5) * self.apart,
                self.area.top + (row + 0.5) * self.apart,
            ]
        };
        (0..self.columns * rows).map(place).collect()
    }

    fn cell(&self, [x, y]: [f64; 2]) -> usize {
        let column = ((x - self.area.left) / self.apart) as usize;
        let row = ((y - self.area.top) / self.apart) as usize;
        row * self.columns + column
    }

    /// Whether a line is nearer than `distance`, which is at most that between lines.
    fn is_near(&self, at: [f64; 2], distance: f64) -> bool {
        let rows = self.cells.len() / self.columns;
        let cell = self.cell(at);
        let (column, row) = (cell % self.columns, cell / self.columns);
        let columns = column.saturating_sub(1)..(column + 2).min(self.columns);
        let mut near = (row.saturating_sub(1)..(row + 2).min(rows))
            .flat_map(|row| columns.clone().map(move |column| (row, column)));
        near.any(|(row, column)| {
            let points = &self.cells[row * self.columns + column];
            points.iter().any(|&point| between(point, at) < distance)
        })
    }

    /// The line through a place, both ways, until it leaves the area, meets another line or itself.
    fn line(
        &self,
        seed: [f64; 2],
        direction: &dyn Fn([f64; 2]) -> Option<[f64; 2]>,
    ) -> Option<Polyline> {
        let forth = self.half(seed, 1.0, direction);
        let mut line = if between(*forth.last()?, seed) == 0.0 && forth.len() > 1 {
            // It has come back to where it began.
            Vec::new()
        } else {
            self.half(seed, -1.0, direction)
        };
        line.reverse();
        line.pop();
        line.extend(forth);
        let reach = line.iter().map(|&point| between(point, seed));
        (reach.fold(0.0, f64::max) >= Self::SMALLEST * self.apart).then_some(line)
    }

    fn half(
        &self,
        seed: [f64; 2],
        sign: f64,
        direction: &dyn Fn([f64; 2]) -> Option<[f64; 2]>,
    ) -> Polyline {
        let step = 0.1 * self.apart;
        // Own points so far back that the line has turned since.
        let back = (3.0 * self.apart / step) as usize;
        // No line needs more to fill the area.
        let most = (40.0 * (self.area.width() + self.area.height()) / step) as usize;
        let near = Self::NEAREST * self.apart;
        let mut line = vec![seed];
        let mut at = seed;
        // How far it still is from where it began, when it comes back there.
        let mut left = f64::INFINITY;
        for _ in 0..most {
            let Some(next) = runge_kutta(at, sign * step, direction) else {
                break;
            };
            if !self.area.contains(next) || self.is_near(next, near) {
                break;
            }
            let old = &line[..line.len().saturating_sub(back)];
            let home = old.first().map(|&start| between(start, next));
            match home.filter(|&home| home < near) {
                Some(home) if home < step => {
                    line.push(seed);
                    break;
                }
                Some(home) if home > left => break,
                Some(home) => left = home,
                None if old.iter().any(|&own| between(own, next) < near) => break,
                None => {}
            }
            line.push(next);
            at = next;
        }
        line
    }
}

/// A step of the classical fourth order along unit vectors; none where there is no direction.
fn runge_kutta(
    at: [f64; 2],
    step: f64,
    direction: &dyn Fn([f64; 2]) -> Option<[f64; 2]>,
) -> Option<[f64; 2]> {
    let along = |[u, v]: [f64; 2], share: f64| [at[0] + share * step * u, at[1] + share * step * v];
    let first = direction(at)?;
    let second = direction(along(first, 0.5))?;
    let third = direction(along(second, 0.5))?;
    let fourth = direction(along(third, 1.0))?;
    let mean = [0, 1].map(|k| (first[k] + 2.0 * second[k] + 2.0 * third[k] + fourth[k]) / 6.0);
    Some(along(mean, 1.0))
}

fn between(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Which points of a line bear arrows: its middle, and others so far from it and each other.
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

/// A head of an arrow on a line, wider by `rim` and then white.
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

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Area = Area {
        left: 30.0,
        top: 20.0,
        right: 430.0,
        bottom: 320.0,
    };
    const APART: f64 = 20.0;
    const CENTRE: [f64; 2] = [230.0, 170.0];

    fn lines(direction: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<Polyline> {
        Streamlines::new(AREA, APART).all(&|at| {
            let [x, y] = direction(at);
            let length = x.hypot(y);
            (AREA.contains(at) && length > 0.0).then(|| [x / length, y / length])
        })
    }

    fn points(lines: &[Polyline]) -> Vec<(usize, [f64; 2])> {
        let numbered = lines.iter().enumerate();
        let points =
            numbered.flat_map(|(line, points)| points.iter().map(move |&point| (line, point)));
        points.collect()
    }

    /// Nowhere nearer to each other than half the distance.
    fn assert_apart(lines: &[Polyline]) {
        let points = points(lines);
        for &(line, point) in &points {
            let others = points.iter().filter(|(other, _)| *other != line);
            let nearest = others.map(|&(_, other)| between(point, other));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(nearest >= 0.5 * APART, "{nearest} at {point:?}");
        }
    }

    /// And, where lines can begin, without gaps of more than one and a half of it.
    fn assert_even(lines: &[Polyline]) {
        assert_apart(lines);
        let points = points(lines);
        for x in (60..400).step_by(7) {
            for y in (50..290).step_by(7) {
                let at = [f64::from(x), f64::from(y)];
                let nearest = points.iter().map(|&(_, point)| between(point, at));
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                assert!(nearest <= 1.5 * APART, "{nearest} at {at:?}");
            }
        }
    }

    #[test]
    fn circles_close_and_are_round() {
        let lines = lines(|[x, y]| [CENTRE[1] - y, x - CENTRE[0]]);
        assert_even(&lines);
        let mut closed = 0;
        for line in &lines {
            let radius = between(line[0], CENTRE);
            for &point in line {
                // Of fourth order in the angle of a step, a tenth of a radian at most.
                assert!((between(point, CENTRE) / radius - 1.0).abs() < 1e-3);
            }
            for pair in line.windows(2) {
                // A step, and where it closes less than two.
                assert!(between(pair[0], pair[1]) < 0.2 * APART);
            }
            closed += usize::from(line.len() > 1 && line.first() == line.last());
        }
        // Of those that fit, up to a radius of 150.
        assert!((5..=9).contains(&closed), "{closed}");
    }

    #[test]
    fn lines_end_at_the_border_and_where_nothing_flows() {
        let straight = lines(|_| [1.0, 0.0]);
        assert_even(&straight);
        for line in &straight {
            let [first, last] = [line[0], line[line.len() - 1]];
            assert!(first[0] < AREA.left + 0.11 * APART && last[0] > AREA.right - 0.11 * APART);
            assert!(line.iter().all(|point| (point[1] - first[1]).abs() < 1e-9));
        }
        let half = lines(|[x, _]| [if x < CENTRE[0] { 1.0 } else { 0.0 }, 0.0]);
        assert!(!half.is_empty());
        assert!(
            half.as_slice()
                .concat()
                .iter()
                .all(|point| point[0] <= CENTRE[0])
        );
        assert!(lines(|_| [0.0, 0.0]).is_empty());
        // In towards a point: all lines but a few meet others before.
        let inward = lines(|[x, y]| [CENTRE[0] - x, CENTRE[1] - y]);
        assert_apart(&inward);
        assert!(inward.len() > 10);
    }
}
