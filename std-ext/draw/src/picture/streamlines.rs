//! Evenly spaced streamlines: B. Jobard and W. Lefer, in: Visualization in Scientific Computing '97, Springer
//! 1997, p. 43. The code is our own.

use super::canvas::Area;
use std::collections::VecDeque;

/// Evenly spaced lines along a field of unit vectors.
pub(super) struct Streamlines {
    area: Area,
    /// Distance of the start of a line from other lines.
    apart: f64,
    /// Points of all lines so far, in square cells of this size.
    cells: Vec<Vec<[f64; 2]>>,
    columns: usize,
}

pub(super) type Polyline = Vec<[f64; 2]>;

impl Streamlines {
    /// Smallest distance between lines, relative to the distance at their start.
    const NEAREST: f64 = 0.5;
    /// Smallest extent of a line, relative to that distance; shorter lines are left out.
    const SMALLEST: f64 = 0.8;

    pub(super) fn new(area: Area, apart: f64) -> Self {
        let columns = (area.width() / apart) as usize + 1;
        let rows = (area.height() / apart) as usize + 1;
        Self {
            area,
            apart,
            cells: vec![Vec::new(); columns * rows],
            columns,
        }
    }

    pub(super) fn all(mut self, direction: &dyn Fn([f64; 2]) -> Option<[f64; 2]>) -> Vec<Polyline> {
        let middle = [
            0.5 * (self.area.left + self.area.right),
            0.5 * (self.area.top + self.area.bottom),
        ];
        let mut lines: Vec<Polyline> = Vec::new();
        // Seeds next to lines come first, so that neighbouring lines are parallel; then seeds on a lattice
        // fill the gaps.
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
                    // Slightly farther away, so that rounding does not reject the line's own seeds.
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

    /// Seeds at equal distances over the whole area.
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

    /// Whether a point is closer than `distance` to a line; `distance` may be at most that between lines.
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

    /// Line through a point in both directions, until it leaves the area or approaches another line or
    /// itself.
    fn line(
        &self,
        seed: [f64; 2],
        direction: &dyn Fn([f64; 2]) -> Option<[f64; 2]>,
    ) -> Option<Polyline> {
        let forth = self.half(seed, 1.0, direction);
        let mut line = if between(*forth.last()?, seed) == 0.0 && forth.len() > 1 {
            // The line is closed.
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
        // Points of the line itself count from this many steps back, where it has turned.
        let back = (3.0 * self.apart / step) as usize;
        // A limit on the number of steps: no line needs more to fill the area.
        let most = (40.0 * (self.area.width() + self.area.height()) / step) as usize;
        let near = Self::NEAREST * self.apart;
        let mut line = vec![seed];
        let mut at = seed;
        // The remaining distance to the start of the line, while the line returns to it.
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

/// Step of the classical fourth-order Runge–Kutta method along unit vectors; `None` if a direction is
/// missing.
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

pub(super) fn between(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
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

    /// Checks that lines are at least half of the spacing apart.
    fn assert_apart(lines: &[Polyline]) {
        let points = points(lines);
        for &(line, point) in &points {
            let others = points.iter().filter(|(other, _)| *other != line);
            let nearest = others.map(|&(_, other)| between(point, other));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(nearest >= 0.5 * APART, "{nearest} at {point:?}");
        }
    }

    /// Checks this and, where lines can start, that gaps are at most one and a half spacings wide.
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
                // The error is of fourth order in the angle of a step, which is at most a tenth of a
                // radian.
                assert!((between(point, CENTRE) / radius - 1.0).abs() < 1e-3);
            }
            for pair in line.windows(2) {
                // A pair is one step apart, or less than two where the line closes.
                assert!(between(pair[0], pair[1]) < 0.2 * APART);
            }
            closed += usize::from(line.len() > 1 && line.first() == line.last());
        }
        // Circles up to a radius of 150 fit.
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
        // In a flow towards a point, all but a few lines end near others.
        let inward = lines(|[x, y]| [CENTRE[0] - x, CENTRE[1] - y]);
        assert_apart(&inward);
        assert!(inward.len() > 10);
    }
}
