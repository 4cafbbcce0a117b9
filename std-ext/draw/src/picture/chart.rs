//! Curves over a pair of axes.

use super::canvas::{Anchor, Area, Canvas, text_width};
use super::colour::{Colour, FAINT, INK, WHITE, of_curve};
use super::ticks::Ticks;
use super::{
    PictureError, capitals, check_size, extent, fitted, is_shown, outline_of, title, widened,
};

/// Curves over a pair of axes, as one description for pictures in pixels ([`Chart::draw`]) and for other
/// renderers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// One line that describes the chart; none if empty.
    pub title: String,
    /// The horizontal and the vertical axis.
    pub axes: [Axis; 2],
    /// The curves, in the order in which they are drawn.
    pub curves: Vec<Curve>,
    /// Values at which a horizontal line with a label is drawn; ignored by [`Chart::draw`].
    pub guides: Vec<(f64, String)>,
}

/// An axis of a [`Chart`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Name and unit.
    pub label: String,
    /// Ends of the axis; by default slightly beyond the range of the curves.
    pub range: Option<[f64; 2]>,
    /// Linear or logarithmic scale.
    pub scale: AxisScale,
    /// Form of the numbers at a logarithmic axis; [`Chart::draw`] always shows powers of ten.
    pub numbers: Numbers,
}

/// The scale of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum AxisScale {
    /// Linear: equal differences have equal distances.
    #[default]
    Linear,
    /// Logarithmic: equal ratios have equal distances. Numbers that are not positive are left out.
    Logarithmic,
}

/// The form of the numbers at a logarithmic axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Numbers {
    /// Powers of ten.
    #[default]
    Plain,
    /// Fractions, shown as powers of ten in per cent.
    Share,
    /// Seconds.
    Time,
    /// Bytes.
    Bytes,
}

/// A curve of a [`Chart`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Name in the legend; a curve without a name has no entry.
    pub name: String,
    /// Points, joined in this order; a point that is not finite interrupts the line.
    pub points: Vec<Point>,
    /// Lines or marks.
    pub marks: Marks,
    /// Curves with the same number have the same colour and marks; by default each curve has its own.
    pub style: Option<usize>,
    /// Whether the line is the strongest of the chart.
    pub is_strong: bool,
    /// Whether marks are hollow; only [`Chart::draw`] draws them so.
    pub hollow: bool,
    /// Label at the last point, none if empty; ignored by [`Chart::draw`].
    pub label: String,
}

/// A point of a [`Curve`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// Coordinates on both axes.
    pub at: [f64; 2],
    /// Lower and upper bound of y, drawn as a bar.
    pub bounds: Option<[f64; 2]>,
    /// Text of the tooltip; ignored by [`Chart::draw`].
    pub note: String,
}

impl From<[f64; 2]> for Point {
    fn from(at: [f64; 2]) -> Self {
        Self {
            at,
            ..Self::default()
        }
    }
}

/// Lines or marks for the points of a [`Curve`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Marks {
    /// A line through the points.
    #[default]
    Line,
    /// A dashed line through the points.
    Dashes,
    /// A mark at each point.
    Points,
    /// Both a line and marks.
    LineAndPoints,
    /// Both a dashed line and marks.
    DashesAndPoints,
}

impl Marks {
    /// Whether a line joins the points.
    pub fn has_line(self) -> bool {
        self != Self::Points
    }

    /// Whether the line is dashed.
    pub fn is_dashed(self) -> bool {
        matches!(self, Self::Dashes | Self::DashesAndPoints)
    }

    /// Whether the points are marked.
    pub fn has_points(self) -> bool {
        matches!(
            self,
            Self::Points | Self::LineAndPoints | Self::DashesAndPoints
        )
    }
}

/// The map from numbers to pixels.
struct Projection {
    scales: [AxisScale; 2],
    ranges: [[f64; 2]; 2],
    area: Area,
}

fn on_scale(scale: AxisScale, number: f64) -> f64 {
    match scale {
        AxisScale::Linear => number,
        AxisScale::Logarithmic if number > 0.0 => libm::log10(number),
        AxisScale::Logarithmic => f64::NAN,
    }
}

impl Projection {
    fn share(&self, axis: usize, number: f64) -> f64 {
        let [at, low, high] = [number, self.ranges[axis][0], self.ranges[axis][1]]
            .map(|number| on_scale(self.scales[axis], number));
        (at - low) / (high - low)
    }

    fn x(&self, number: f64) -> f64 {
        self.area.left + self.share(0, number) * self.area.width()
    }

    fn y(&self, number: f64) -> f64 {
        self.area.bottom - self.share(1, number) * self.area.height()
    }

    /// Pixel of a point; `None` if a coordinate cannot be shown on its scale.
    fn point(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let at = [self.x(x), self.y(y)];
        at.iter().all(|x| x.is_finite()).then_some(at)
    }
}

impl Chart {
    /// Whether there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.curves.iter().all(|curve| curve.points.is_empty())
    }

    /// Draws the chart in pixels, of this width and height.
    ///
    /// # Errors
    /// If the size or a range is impossible; see [`PictureError`].
    pub fn draw(&self, size: [u32; 2]) -> Result<Canvas, PictureError> {
        check_size(size)?;
        let [x, y] = &self.axes;
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let bounds = || points().flat_map(|point| point.bounds).flatten();
        let ranges = [
            x.fitting(points().map(|point| point.at[0]))?,
            y.fitting(points().map(|point| point.at[1]).chain(bounds()))?,
        ];
        let mut canvas = Canvas::new(size);
        let letters = capitals(size);
        let [width, height] = size.map(f64::from);
        let mut area = Area {
            left: 1.6 * letters,
            top: 2.0 * letters,
            right: width - 2.4 * letters,
            bottom: height - 1.8 * letters,
        };
        title(&mut canvas, &self.title, letters, &mut area);
        let ticks = |axis: &Axis, [low, high]: [f64; 2], count: f64| {
            let count = count.clamp(2.0, 8.0);
            match axis.scale {
                AxisScale::Linear => Ticks::linear(low, high, count),
                AxisScale::Logarithmic => Ticks::logarithmic(low, high, count),
            }
        };
        let x_ticks = ticks(x, ranges[0], area.width() / (9.0 * letters));
        let y_ticks = ticks(y, ranges[1], area.height() / (6.0 * letters));
        let numbers = y_ticks
            .marks
            .iter()
            .map(|(_, number)| text_width(number, letters))
            .fold(0.0, f64::max);
        let label_x = area.left + 1.1 * letters;
        let label_y = area.bottom;
        area.left += 2.8 * letters + numbers + letters;
        area.bottom -= 5.0 * letters;
        let projection = Projection {
            scales: [x.scale, y.scale],
            ranges,
            area,
        };
        self.grid(&mut canvas, &projection, letters, [&x_ticks, &y_ticks]);
        for (index, curve) in self.curves.iter().enumerate() {
            curve.draw(&mut canvas, &projection, letters, index);
        }
        let line = (0.1 * letters).max(1.0);
        canvas.stroke(&[outline_of(area)], line, INK);
        let label = x_ticks.labelled(&x.label_with_unit());
        let height = fitted(&label, letters, area.width());
        let at = [0.5 * (area.left + area.right), label_y];
        canvas.text(&label, at, height, Anchor::Centre, true);
        let label = y_ticks.labelled(&y.label_with_unit());
        let height = fitted(&label, letters, area.height());
        let at = [label_x, 0.5 * (area.top + area.bottom)];
        canvas.text(&label, at, height, Anchor::Centre, false);
        self.legend(&mut canvas, &projection, letters);
        Ok(canvas)
    }

    /// Grid lines, ticks and their numbers.
    fn grid(&self, canvas: &mut Canvas, projection: &Projection, letters: f64, ticks: [&Ticks; 2]) {
        let area = projection.area;
        let line = (0.1 * letters).max(1.0);
        let tick = 0.5 * letters;
        let [x_ticks, y_ticks] = ticks;
        for (value, number) in &x_ticks.marks {
            let x = projection.x(*value);
            canvas.line([x, area.top], [x, area.bottom], line, FAINT);
            canvas.line([x, area.bottom], [x, area.bottom + tick], line, INK);
            let at = [x, area.bottom + 2.2 * letters];
            canvas.text(number, at, letters, Anchor::Centre, true);
        }
        for (value, number) in &y_ticks.marks {
            let y = projection.y(*value);
            canvas.line([area.left, y], [area.right, y], line, FAINT);
            canvas.line([area.left - tick, y], [area.left, y], line, INK);
            let at = [area.left - 1.1 * letters, y + 0.5 * letters];
            canvas.text(number, at, letters, Anchor::Right, true);
        }
        for value in &x_ticks.minor {
            let x = projection.x(*value);
            canvas.line([x, area.bottom], [x, area.bottom + 0.5 * tick], line, INK);
        }
        for value in &y_ticks.minor {
            let y = projection.y(*value);
            canvas.line([area.left - 0.5 * tick, y], [area.left, y], line, INK);
        }
    }

    /// Draws the legend in a corner or elsewhere, where it hides least of the curves.
    fn legend(&self, canvas: &mut Canvas, projection: &Projection, letters: f64) {
        let named: Vec<_> = self
            .curves
            .iter()
            .enumerate()
            .filter(|(_, curve)| !curve.name.trim().is_empty())
            .collect();
        if named.is_empty() {
            return;
        }
        let area = projection.area;
        let sample = 3.2 * letters;
        let names = named
            .iter()
            .map(|(_, curve)| text_width(&curve.name, letters))
            .fold(0.0, f64::max);
        let room = area.width() - sample - 4.9 * letters;
        let size = letters * (room / names).min(1.0);
        let wide = sample + 2.5 * letters + names.min(room);
        let high = (2.0 * named.len() as f64 + 0.6) * letters;
        let gap = 0.9 * letters;
        // Shares of the way to the right and down.
        let box_at = |[across, down]: [f64; 2]| {
            let left = area.left + gap + across * (area.width() - 2.0 * gap - wide);
            let top = area.top + gap + down * (area.height() - 2.0 * gap - high);
            Area {
                left,
                top,
                right: left + wide,
                bottom: top + high,
            }
        };
        let corners = [[1.0, 0.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let sides = [0.25, 0.5, 0.75].map(|down| [[1.0, down], [0.0, down], [0.5, down]]);
        let ends = [[0.5, 0.0], [0.5, 1.0]];
        let sides = sides.into_iter().flatten().chain(ends);
        let boxes = corners.into_iter().chain(sides).map(box_at);
        let hidden = |area: &Area| {
            let curves = self.curves.iter();
            curves
                .map(|curve| curve.hidden(projection, *area))
                .sum::<usize>()
        };
        // The first of equally good places is chosen.
        let Some(place) = boxes.min_by_key(hidden) else {
            return;
        };
        canvas.fill(place, WHITE);
        canvas.stroke(&[outline_of(place)], (0.08 * letters).max(0.8), FAINT);
        for (row, (index, curve)) in named.into_iter().enumerate() {
            let y = place.top + (1.3 + 2.0 * row as f64) * letters;
            let left = place.left + 0.7 * letters;
            let colour = curve.colour(index);
            if curve.marks.has_line() {
                let ends = vec![[left, y], [left + sample, y]];
                curve.stroke(canvas, &[ends], letters, colour);
            }
            if curve.marks.has_points() {
                let centre = [left + 0.5 * sample, y];
                curve.mark(canvas, centre, letters, index);
            }
            let at = [left + sample + 0.8 * letters, y + 0.5 * letters];
            canvas.text(&curve.name, at, size, Anchor::Left, true);
        }
    }
}

impl Axis {
    /// The label, with the unit of the numbers at the ticks.
    fn label_with_unit(&self) -> String {
        match self.numbers {
            Numbers::Plain | Numbers::Share => self.label.clone(),
            Numbers::Time => format!("{} [s]", self.label),
            Numbers::Bytes => format!("{} [B]", self.label),
        }
    }

    /// Ends of an axis: the given range, or one that contains all numbers that the scale can show.
    fn fitting(&self, numbers: impl Iterator<Item = f64>) -> Result<[f64; 2], PictureError> {
        if let Some(range) = self.range {
            let places = range.map(|end| on_scale(self.scale, end));
            return if is_shown(places) {
                Ok(range)
            } else {
                let of = self.label.clone();
                Err(PictureError::Range { of, range })
            };
        }
        const MARGIN: f64 = 0.04;
        // Limits of the decimal logarithms of positive numbers that f64 holds.
        const LEAST: f64 = -323.0;
        const MOST: f64 = 308.25;
        let [low, high] = widened(extent(numbers.map(|number| on_scale(self.scale, number))));
        let margin = MARGIN * (high - low);
        let ends = [low - margin, high + margin];
        Ok(match self.scale {
            // At the limits of f64 a margin would overflow.
            AxisScale::Linear if !(ends[1] - ends[0]).is_finite() => [low, high],
            AxisScale::Linear => ends,
            AxisScale::Logarithmic => ends.map(|end| libm::exp10(end.clamp(LEAST, MOST))),
        })
    }
}

impl Curve {
    fn colour(&self, index: usize) -> Colour {
        of_curve(self.style.unwrap_or(index))
    }

    /// x and bounds of the points that have bounds.
    fn bars(&self) -> impl Iterator<Item = (f64, [f64; 2])> {
        let bounds = |point: &Point| Some((point.at[0], point.bounds?));
        self.points.iter().filter_map(bounds)
    }

    /// Parts of the curve's lines inside the axes.
    fn lines(&self, projection: &Projection) -> Vec<Vec<[f64; 2]>> {
        let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
        for pair in self.points.windows(2) {
            let ends = [projection.point(pair[0].at), projection.point(pair[1].at)];
            let [Some(a), Some(b)] = ends else {
                continue;
            };
            let Some([a, b]) = projection.area.clip([a, b]) else {
                continue;
            };
            match lines.last_mut() {
                Some(line) if line.last() == Some(&a) => line.push(b),
                _ => lines.push(vec![a, b]),
            }
        }
        lines
    }

    fn draw(&self, canvas: &mut Canvas, projection: &Projection, letters: f64, index: usize) {
        let colour = self.colour(index);
        let thin = (0.11 * letters).max(1.0);
        for (x, [low, high]) in self.bars() {
            let ends = [projection.point([x, low]), projection.point([x, high])];
            let [Some(a), Some(b)] = ends else {
                continue;
            };
            let Some(bar) = projection.area.clip([a, b]) else {
                continue;
            };
            let cap = 0.4 * letters;
            // There is no cap where the bar continues outside.
            let caps = bar
                .iter()
                .filter(|end| **end == a || **end == b)
                .map(|&[x, y]| vec![[x - cap, y], [x + cap, y]]);
            let strokes: Vec<_> = caps.chain([bar.to_vec()]).collect();
            canvas.stroke(&strokes, thin, colour);
        }
        if self.marks.has_line() {
            self.stroke(canvas, &self.lines(projection), letters, colour);
        }
        if self.marks.has_points() {
            for point in &self.points {
                if let Some(at) = projection.point(point.at)
                    && projection.area.contains(at)
                {
                    self.mark(canvas, at, letters, index);
                }
            }
        }
    }

    fn mark(&self, canvas: &mut Canvas, at: [f64; 2], letters: f64, index: usize) {
        let style = self.style.unwrap_or(index);
        mark(canvas, at, letters, style, self.colour(index), self.hollow);
    }

    fn stroke(&self, canvas: &mut Canvas, lines: &[Vec<[f64; 2]>], letters: f64, colour: Colour) {
        let strength = if self.is_strong { 2.0 } else { 1.0 };
        let width = strength * (0.17 * letters).max(1.2);
        if self.marks.is_dashed() {
            let dashes: Vec<_> = lines
                .iter()
                .flat_map(|line| dashed(line, 0.9 * letters, 0.65 * letters))
                .collect();
            canvas.stroke(&dashes, width, colour);
        } else {
            canvas.stroke(lines, width, colour);
        }
    }

    /// Estimated number of points and bars of the curve that an area would hide.
    fn hidden(&self, projection: &Projection, area: Area) -> usize {
        let bars = self.bars().filter(|&(x, [low, high])| {
            let ends = [projection.point([x, low]), projection.point([x, high])];
            matches!(ends, [Some(a), Some(b)] if area.clip([a, b]).is_some())
        });
        let points = self.points.iter().filter(|point| {
            let at = projection.point(point.at);
            at.is_some_and(|at| area.contains(at))
        });
        let lines = self.lines(projection);
        let crossing = lines
            .iter()
            .flat_map(|line| line.windows(2))
            .filter(|pair| self.marks.has_line() && area.clip([pair[0], pair[1]]).is_some());
        bars.count() + points.count() + crossing.count()
    }
}

/// Dashes of a line.
fn dashed(line: &[[f64; 2]], dash: f64, gap: f64) -> Vec<Vec<[f64; 2]>> {
    let mut dashes = vec![vec![line[0]]];
    let mut drawing = true;
    let mut left = dash;
    for pair in line.windows(2) {
        let [x, y] = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        let length = (x * x + y * y).sqrt();
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let at = [
                pair[0][0] + x * done / length,
                pair[0][1] + y * done / length,
            ];
            if drawing && let Some(dash) = dashes.last_mut() {
                dash.push(at);
            } else {
                dashes.push(vec![at]);
            }
            drawing = !drawing;
            left = if drawing { dash } else { gap };
        }
        left -= length - done;
        if drawing && let Some(dash) = dashes.last_mut() {
            dash.push(pair[1]);
        }
    }
    dashes
}

/// Draws a mark with a white rim, so that touching marks and lines remain distinguishable.
fn mark(
    canvas: &mut Canvas,
    centre: [f64; 2],
    letters: f64,
    index: usize,
    colour: Colour,
    hollow: bool,
) {
    let (radius, rim) = (0.4 * letters, 0.12 * letters);
    let hole = if hollow { 0.6 * radius } else { 0.0 };
    for (radius, colour) in [(radius + rim, WHITE), (radius, colour), (hole, WHITE)] {
        if radius == 0.0 {
            continue;
        }
        let corners = |offsets: &[[f64; 2]]| -> Vec<[f64; 2]> {
            offsets
                .iter()
                .map(|[x, y]| [centre[0] + radius * x, centre[1] + radius * y])
                .collect()
        };
        match index % 4 {
            0 => canvas.disc(centre, radius, colour),
            1 => {
                let square = corners(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]);
                canvas.polygon(&square, colour);
            }
            2 => {
                let triangle = corners(&[[0.0, -1.25], [1.1, 0.75], [-1.1, 0.75]]);
                canvas.polygon(&triangle, colour);
            }
            _ => {
                let diamond = corners(&[[0.0, -1.3], [1.2, 0.0], [0.0, 1.3], [-1.2, 0.0]]);
                canvas.polygon(&diamond, colour);
            }
        }
    }
}
