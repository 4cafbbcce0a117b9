//! Charts as SVG, for the page and for files.
//!
//! An SVG is as wide as a phone screen. Its colours are classes, which the page defines; a separate
//! file includes their definitions.

use super::text::{escaped, number_label};
use crate::picture::{Axis, AxisScale, Chart, Point};
use std::fmt::Write as _;
use std::io::{self, Write};

/// The height of a label: that of the letters of the page.
const LABEL_HEIGHT: f64 = 13.0;
const WIDTH: f64 = 480.0;
const HEIGHT: f64 = 350.0;
const LEFT: f64 = 60.0;
const RIGHT: f64 = 462.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 304.0;

/// Number of points from which on marks are smaller.
const MANY: usize = 40;

/// The number of styles: one for each listed method, and the last for published results.
const STYLES: usize = 15;

/// The colours of the styles, on light ground; the page has its own for dark ground.
pub const COLOURS: [&str; STYLES] = [
    "#737373", "#c77700", "#00805f", "#8a5a16", "#b8488a", "#2f8fc4", "#7a55b0", "#d1481b",
    "#a3123a", "#5b7be0", "#0a3d91", "#00959c", "#6b8e23", "#9a8200", "#222222",
];

/// Outlines of marks within a square of 2 × 2 around 0.
const MARKS: [&str; STYLES] = [
    "M-.8-.8L.8.8M.8-.8L-.8.8",
    "M-.8-.8H.8V.8H-.8Z",
    "M0-1L.95.7H-.95Z",
    "M0 1L.95-.7H-.95Z",
    "M0-1.1L1.1 0L0 1.1L-1.1 0Z",
    "M-1 0H1M0-1V1",
    "M0-1L.95-.31L.59.81H-.59L-.95-.31Z",
    "M-.9-.9H.9L-.9.9H.9Z",
    "M0-1.2L.29-.4L1.14-.37L.48 .15L.71 .97L0 .5L-.71 .97L-.48 .15L-1.14-.37L-.29-.4Z",
    "M-.9 0A.9.9 0 1 0 .9 0A.9.9 0 1 0-.9 0Z",
    "M0-1.3L.4-.4L1.3 0L.4.4L0 1.3L-.4.4L-1.3 0L-.4-.4Z",
    "M1.1 0L-.75.95V-.95Z",
    "M-1.1 0L.75.95V-.95Z",
    "M-.9-.9V.9L.9-.9V.9Z",
    "M-.8 0A.8.8 0 1 0 .8 0A.8.8 0 1 0-.8 0Z",
];

/// The class of a style, which has its colour.
pub(super) fn style_class(style: usize) -> String {
    format!("s{}", style % STYLES)
}

/// The mark of a style, for legends.
pub fn mark(style: usize) -> String {
    format!(
        "<svg viewBox=\"-8 -8 16 16\" class=\"key {}\" aria-hidden=\"true\"><path class=\"m\" d=\"{}\" transform=\"scale(5)\"/></svg>",
        style_class(style),
        MARKS[style % STYLES]
    )
}

/// The map from numbers to positions.
struct Places {
    logarithmic: bool,
    low: f64,
    high: f64,
    ends: [f64; 2],
}

impl Places {
    fn new(axis: &Axis, values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Self {
        let logarithmic = axis.scale != AxisScale::Linear;
        let on = |value: f64| if logarithmic { value.log10() } else { value };
        if let Some([low, high]) = axis.range.map(|range| range.map(on)) {
            return Self {
                logarithmic,
                low,
                high,
                ends,
            };
        }
        let (low, high) = values
            .map(on)
            .filter(|value| value.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            });
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        let around = if logarithmic {
            0.12
        } else {
            0.04 * (high - low)
        };
        let around = around.max(0.03 * (high - low)).max(1e-9);
        let low = if !logarithmic && low >= 0.0 {
            0.0
        } else {
            low - around
        };
        Self {
            logarithmic,
            low,
            high: high + around,
            ends,
        }
    }

    fn at(&self, value: f64) -> Option<f64> {
        let value = if self.logarithmic {
            value.log10()
        } else {
            value
        };
        let share = (value - self.low) / (self.high - self.low);
        let [first, last] = self.ends;
        (-1e-9..=1.0 + 1e-9)
            .contains(&share)
            .then_some(first + share * (last - first))
    }

    /// The positions of ticks: powers of ten with a stride, or round numbers.
    fn marks(&self) -> Vec<f64> {
        let span = self.high - self.low;
        if self.logarithmic && span < 2.4 {
            let decades = self.low.floor() as i32..=self.high.floor() as i32;
            let steps: &[f64] = if span < 1.2 {
                &[1.0, 2.0, 5.0]
            } else {
                &[1.0, 3.0]
            };
            let of = |decade: i32| steps.iter().map(move |step| step * 10f64.powi(decade));
            return decades.flat_map(of).collect();
        }
        if self.logarithmic {
            let step = (span / 6.0).ceil().max(1.0);
            let first = (self.low / step).ceil() as i32;
            let last = (self.high / step).floor() as i32;
            let exponents = (first..=last).map(|number| number * step as i32);
            return exponents.map(|exponent| 10f64.powi(exponent)).collect();
        }
        let (low, high) = (self.low, self.high);
        let rough = (high - low) / 5.0;
        let unit = 10f64.powf(rough.log10().floor());
        let steps = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * unit);
        let step = steps.into_iter().find(|&step| step >= rough);
        let step = step.unwrap_or(10.0 * unit);
        let first = (low / step - 1e-9).ceil() as i64;
        let last = (high / step + 1e-9).floor() as i64;
        (first..=last).map(|number| number as f64 * step).collect()
    }
}

/// Writes the chart as an SVG element or, with `styled`, as a separate file.
///
/// # Errors
/// If `out` cannot be written to.
pub fn write(chart: &Chart, id: &str, styled: bool, out: &mut dyn Write) -> io::Result<()> {
    let values = |axis: usize| {
        let points = chart.curves.iter().flat_map(|curve| &curve.points);
        points.map(move |point| point.at[axis])
    };
    let [x, y] = [
        Places::new(&chart.axes[0], values(0), [LEFT, RIGHT]),
        Places::new(
            &chart.axes[1],
            values(1).chain(chart.guides.iter().map(|guide| guide.0)),
            [BOTTOM, TOP],
        ),
    ];
    let space = if styled {
        " xmlns=\"http://www.w3.org/2000/svg\""
    } else {
        ""
    };
    writeln!(
        out,
        "<svg{space} class=\"chart\" id=\"{id}\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" tabindex=\"0\" aria-labelledby=\"{id}-t\"><title id=\"{id}-t\">{}</title>",
        escaped(&chart.title)
    )?;
    if styled {
        writeln!(out, "<style>{}</style>", style())?;
        writeln!(
            out,
            "<rect class=\"ground\" width=\"{WIDTH}\" height=\"{HEIGHT}\"/>"
        )?;
    }
    write_axes(&chart.axes, [&x, &y], out)?;
    for (height, says) in &chart.guides {
        if let Some(at) = y.at(*height) {
            writeln!(
                out,
                "<path class=\"guide\" d=\"M{LEFT} {at:.1}H{RIGHT}\"/><text class=\"guide-t\" x=\"{}\" y=\"{:.1}\">{}</text>",
                LEFT + 5.0,
                at - 4.0,
                escaped(says)
            )?;
        }
    }
    let drawn = chart.curves.iter().map(|curve| {
        let points = curve.points.iter();
        let places =
            points.filter_map(|point| Some(([x.at(point.at[0])?, y.at(point.at[1])?], point)));
        Vec::from_iter(places)
    });
    let drawn = Vec::from_iter(drawn);
    let labels = label_places(chart, &drawn);
    for (index, ((curve, places), label)) in chart.curves.iter().zip(&drawn).zip(labels).enumerate()
    {
        if places.is_empty() {
            continue;
        }
        let mut line = String::new();
        if curve.marks.has_line() {
            for (number, ([x, y], _)) in places.iter().enumerate() {
                let letter = if number == 0 { 'M' } else { 'L' };
                let _ = write!(line, "{letter}{x:.1} {y:.1}");
            }
        }
        let own = curve.style.unwrap_or(index);
        let style = own % STYLES;
        let dash = if curve.marks.is_dashed() { " dash" } else { "" };
        let bare = if curve.marks.has_points() {
            ""
        } else {
            " bare"
        };
        let best = if curve.is_strong { " best" } else { "" };
        write!(
            out,
            "<g class=\"c s{style}{dash}{bare}{best}\" data-m=\"{own}\">"
        )?;
        if !line.is_empty() {
            write!(out, "<path class=\"l\" d=\"{line}\"/>")?;
        }
        // Marks of many points without a line would hide each other.
        let size = if !curve.marks.has_line() && places.len() > MANY {
            2.2
        } else {
            4.0
        };
        for ([x, y], point) in places {
            write!(
                out,
                "<path class=\"m\" d=\"{}\" transform=\"translate({x:.1} {y:.1})scale({size})\"><title>{}</title></path>",
                MARKS[style],
                escaped(&point.note)
            )?;
        }
        if let Some([x, y]) = label {
            write!(
                out,
                "<text class=\"n\" x=\"{x:.1}\" y=\"{:.1}\">{}</text>",
                y + 4.0,
                escaped(&curve.label)
            )?;
        }
        writeln!(out, "</g>")?;
    }
    writeln!(out, "</svg>")
}

/// The positions of labels: beside the last point of each curve, moved below or above others
/// where necessary, in the order of the last points.
fn label_places(chart: &Chart, drawn: &[Vec<([f64; 2], &Point)>]) -> Vec<Option<[f64; 2]>> {
    let mut places: Vec<Option<[f64; 2]>> = vec![None; drawn.len()];
    let end = |curve: usize| drawn[curve].last().map_or(0.0, |([_, y], _)| *y);
    let mut order = Vec::from_iter(0..drawn.len());
    order.sort_by(|&one, &other| end(one).total_cmp(&end(other)));
    for curve in order {
        let label = &chart.curves[curve].label;
        let Some(([end_x, end_y], _)) = drawn[curve].last() else {
            continue;
        };
        if label.is_empty() {
            continue;
        }
        let x = (end_x + 8.0).min(WIDTH - 9.0 * label.chars().count() as f64);
        let mut steps = (0..32).flat_map(|step| [3.0 * f64::from(step), -3.0 * f64::from(step)]);
        let free = |step: &f64| {
            // Labels must not rise above the figure.
            end_y + step > TOP
                && places.iter().flatten().all(|&[other_x, other_y]| {
                    (other_x - x).abs() > 18.0 || (other_y - end_y - step).abs() > LABEL_HEIGHT
                })
        };
        let step = steps.find(free).unwrap_or(0.0);
        places[curve] = Some([x, end_y + step]);
    }
    // Neighbouring labels are swapped until their order is that of the curves.
    for _ in 0..places.len() {
        for one in 0..places.len() {
            for other in 0..one {
                if let (Some(a), Some(b)) = (places[one], places[other])
                    && (a[0] - b[0]).abs() <= 18.0
                    && (end(one) - end(other)) * (a[1] - b[1]) < 0.0
                {
                    places[one] = Some([a[0], b[1]]);
                    places[other] = Some([b[0], a[1]]);
                }
            }
        }
    }
    places
}

fn write_axes(axes: &[Axis; 2], [x, y]: [&Places; 2], out: &mut dyn Write) -> io::Result<()> {
    for mark in x.marks() {
        if let Some(at) = x.at(mark) {
            writeln!(
                out,
                "<path class=\"grid\" d=\"M{at:.1} {TOP}V{BOTTOM}\"/><text class=\"tick\" x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                BOTTOM + 16.0,
                number_label(mark, &axes[0])
            )?;
        }
    }
    for mark in y.marks() {
        if let Some(at) = y.at(mark) {
            writeln!(
                out,
                "<path class=\"grid\" d=\"M{LEFT} {at:.1}H{RIGHT}\"/><text class=\"tick\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
                LEFT - 6.0,
                at + 4.0,
                number_label(mark, &axes[1])
            )?;
        }
    }
    writeln!(
        out,
        "<path class=\"axis\" d=\"M{LEFT} {TOP}V{BOTTOM}H{RIGHT}\"/>\
         <text class=\"name\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\
         <text class=\"name\" transform=\"translate(13 {})rotate(-90)\" text-anchor=\"middle\">{}</text>",
        0.5 * (LEFT + RIGHT),
        HEIGHT - 10.0,
        escaped(&axes[0].label),
        0.5 * (TOP + BOTTOM),
        escaped(&axes[1].label),
    )
}

/// The part of the style of the page that an SVG file needs.
fn style() -> String {
    let mut style = "svg{font:13px system-ui,sans-serif;fill:#222}.ground{fill:#fff}.grid{stroke:#e4e4e4;fill:none}.axis{stroke:#777;fill:none}.tick{font-size:12px}.guide{stroke:#999;stroke-dasharray:2 3;fill:none}.guide-t{font-size:11px;fill:#666}.l{fill:none;stroke-width:1.8}.m{stroke-width:.35}.dash .l{stroke-dasharray:5 3}.dash .m{fill:#fff}.bare .m{opacity:0}.best .l{stroke-width:4}.n{font-weight:600}".to_owned();
    for (number, colour) in COLOURS.iter().enumerate() {
        let _ = write!(
            style,
            ".s{number} .l,.s{number} .m{{stroke:{colour}}}.s{number}:not(.dash) .m,.s{number} .n{{fill:{colour}}}"
        );
    }
    style
}
