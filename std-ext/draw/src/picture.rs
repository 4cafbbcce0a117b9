//! Pictures: surfaces coloured by a field, flow on a plane, and charts of curves.
//!
//! Everything is drawn in a fixed order, without a graphics card, font files or threads: the same input gives
//! the same bytes. The feature `png` writes PNG files.

mod canvas;
mod chart;
mod colour;
mod font;
#[cfg(feature = "png")]
mod png;
mod render;
mod slice;
mod streamlines;
mod strokes;
mod ticks;

pub use canvas::Canvas;
pub use chart::{Axis, AxisScale, Chart, Curve, Marks, Numbers, Point};
pub use colour::{Colour, ColourMap, NO_VALUE};
pub use slice::FlowSlice;

use canvas::{Anchor, Area, text_width};
use colour::{ColourTable, INK};
use helfrich::Surface;
use render::{Camera, Painted};
use ticks::Ticks;

/// Smallest and largest width and height of a picture, in pixels.
const SIZES: [u32; 2] = [160, 4096];

/// Reason why a picture cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The picture is too small for its labels, or too large.
    #[error(
        "a picture of {} × {} pixels: both have to be from {} to {}", size[0], size[1], SIZES[0], SIZES[1]
    )]
    Size {
        /// Width and height.
        size: [u32; 2],
    },
    /// A field does not have one value per vertex.
    #[error("surface {surface}: the field has {found} values, the mesh {vertices} vertices")]
    CountMismatch {
        /// The surface, from 0.
        surface: usize,
        /// The number of values.
        found: usize,
        /// The expected number.
        vertices: usize,
    },
    /// A grid is not a rectangle of points.
    #[error(
        "a slice of {} × {} × {} points: two or more, two or more and one are needed, at finite \
         places with spacings above 0", counts[0], counts[1], counts[2]
    )]
    Grid {
        /// The numbers of points along the axes.
        counts: [usize; 3],
    },
    /// A field on a slice does not have one value per point.
    #[error("a field of the slice has {found} values, its grid {points} points")]
    PointMismatch {
        /// The number of values.
        found: usize,
        /// The expected number.
        points: usize,
    },
    /// The direction of view is 0, not finite, or along the upward direction.
    #[error(
        "the view from {direction:?} with {up:?} upwards: the two have to be finite and in \
         different directions"
    )]
    View {
        /// The direction from the surfaces to the viewer.
        direction: [f64; 3],
        /// The upward direction.
        up: [f64; 3],
    },
    /// A range is empty, reversed, or not above 0 on a logarithmic axis.
    #[error("the range from {} to {} of {of} is empty, or cannot be shown on its scale", range[0], range[1])]
    Range {
        /// The field or the axis.
        of: String,
        /// The ends of the range.
        range: [f64; 2],
    },
}

fn check_size(size: [u32; 2]) -> Result<(), PictureError> {
    if size.iter().all(|side| (SIZES[0]..=SIZES[1]).contains(side)) {
        Ok(())
    } else {
        Err(PictureError::Size { size })
    }
}

/// Surfaces seen from one side.
#[derive(Clone, Debug)]
pub struct Picture<'a> {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The title; none if empty.
    pub title: &'a str,
    /// The surfaces in the picture.
    pub surfaces: &'a [PaintedSurface<'a>],
    /// The map from fields to colours.
    pub colours: Colouring<'a>,
    /// The direction of view.
    pub view: View,
    /// Unit of the positions for the scale bar; `None` for no scale bar.
    pub length_unit: Option<&'a str>,
}

/// A surface of a [`Picture`].
#[derive(Clone, Copy, Debug)]
pub struct PaintedSurface<'a> {
    /// Mesh and positions.
    pub surface: Surface<'a, f64>,
    /// One value per vertex; surfaces without a field, and vertices whose value is not finite, are grey.
    pub field: Option<&'a [f64]>,
    /// Smooth or flat shading.
    pub shading: Shading,
    /// Whether the edges of the triangles are drawn.
    pub edges: bool,
    /// Two directions per vertex as unit vectors, such as those of k₁ and k₂, where they are known. They are
    /// drawn as short lines at vertices that are spread evenly over the picture; the lines of the second
    /// direction are shorter.
    pub strokes: Option<&'a [Option<[[f64; 3]; 2]>]>,
}

/// Shading of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Shading {
    /// Shading by vertex normals: the surface looks smooth.
    #[default]
    Smooth,
    /// Shading by triangle normals.
    Flat,
}

/// The map from the fields of a [`Picture`] to colours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Colouring<'a> {
    /// Name and unit, shown beside the colour bar.
    pub label: &'a str,
    /// The values at the ends of the map. Values beyond them have the colours of the ends, and the
    /// bar then has a pointed end. By default the smallest and the largest value except for a few
    /// outliers; on a diverging map, the same range on both sides of 0.
    pub range: Option<[f64; 2]>,
    /// The colours.
    pub map: ColourMap,
}

impl Colouring<'_> {
    /// The values at the ends of the map, for these values; those that are not finite do not count.
    ///
    /// # Errors
    /// If the range that was asked for has no extent that can be shown.
    pub fn ends(&self, values: &[f64]) -> Result<[f64; 2], PictureError> {
        let finite = values.iter().copied().filter(|value| value.is_finite());
        range_of(*self, finite)
    }
}

/// A direction of view, with parallel rays and no perspective.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// The direction from the surfaces to the viewer.
    pub direction: [f64; 3],
    /// The direction that points upwards in the picture.
    pub up: [f64; 3],
    /// The region that has to fit; by default that of the surfaces. Comparable pictures need a common frame.
    pub frame: Option<Frame>,
}

/// A ball that fills a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Its centre.
    pub centre: [f64; 3],
    /// Its radius.
    pub radius: f64,
}

impl Default for View {
    /// A view from above and to the side, with z upwards.
    fn default() -> Self {
        Self {
            direction: [0.55, -1.0, 0.62],
            up: [0.0, 0.0, 1.0],
            frame: None,
        }
    }
}

impl Picture<'_> {
    /// Draws the picture.
    ///
    /// # Errors
    /// If size, view, range or a field's length are impossible; see [`PictureError`].
    pub fn draw(&self) -> Result<Canvas, PictureError> {
        check_size(self.size)?;
        for (surface, painted) in self.surfaces.iter().enumerate() {
            let vertices = painted.surface.mesh().vertex_count();
            let counts = [
                painted.field.map(<[_]>::len),
                painted.strokes.map(<[_]>::len),
            ];
            let mut counts = counts.into_iter().flatten();
            if let Some(found) = counts.find(|&found| found != vertices) {
                return Err(PictureError::CountMismatch {
                    surface,
                    found,
                    vertices,
                });
            }
        }
        let range = range_of(self.colours, self.values())?;
        let mut canvas = Canvas::new(self.size);
        let [width, height] = self.size.map(f64::from);
        let letters = capitals(self.size);
        let mut area = Area {
            left: 2.0 * letters,
            top: 2.0 * letters,
            right: width - 2.0 * letters,
            bottom: height - 2.0 * letters,
        };
        title(&mut canvas, self.title, letters, &mut area);
        let table = ColourTable::new(self.colours.map);
        if self.surfaces.iter().any(|painted| painted.field.is_some()) {
            let values = Vec::from_iter(self.values());
            let label = self.colours.label;
            colour_bar(
                &mut canvas,
                letters,
                &table,
                label,
                range,
                &values,
                &mut area,
            );
        }
        let below = self.length_unit.map_or(0.0, |_| 3.6 * letters);
        let scene = Area {
            bottom: area.bottom - below,
            ..area
        };
        let camera = Camera::new(&self.view, self.surfaces, scene)?;
        let painted: Vec<Painted> = self
            .surfaces
            .iter()
            .map(|surface| Painted::new(surface, &camera, range))
            .collect();
        let depths = render::draw(&mut canvas, scene, &painted, &camera, &table);
        for surface in self.surfaces {
            strokes::draw(&mut canvas, scene, surface, &camera, &depths, letters);
        }
        if let Some(unit) = self.length_unit {
            let at = [area.left, area.bottom];
            scale_bar(&mut canvas, at, area.width(), letters, camera.scale, unit);
        }
        Ok(canvas)
    }

    /// All finite values of all fields.
    fn values(&self) -> impl Iterator<Item = f64> {
        let fields = self.surfaces.iter().filter_map(|painted| painted.field);
        fields.flatten().copied().filter(|value| value.is_finite())
    }
}

/// The values at the ends of the colour map, from the finite values.
fn range_of(
    colours: Colouring<'_>,
    values: impl Iterator<Item = f64>,
) -> Result<[f64; 2], PictureError> {
    if let Some(range) = colours.range {
        return if is_shown(range) {
            Ok(range)
        } else {
            let of = colours.label.to_owned();
            Err(PictureError::Range { of, range })
        };
    }
    let [low, high] = without_outliers(values.collect());
    Ok(widened(match colours.map {
        ColourMap::Sequential => [low, high],
        ColourMap::Diverging => {
            let largest = low.abs().max(high.abs());
            [-largest, largest]
        }
    }))
}

/// Draws the colour bar at the right of an area, and removes its rectangle from the area.
fn colour_bar(
    canvas: &mut Canvas,
    letters: f64,
    table: &ColourTable,
    label: &str,
    [low, high]: [f64; 2],
    values: &[f64],
    area: &mut Area,
) {
    let ticks = Ticks::linear(low, high, 6.0);
    let label = ticks.labelled(label);
    let numbers = ticks
        .marks
        .iter()
        .map(|(_, number)| text_width(number, letters))
        .fold(0.0, f64::max);
    let thick = 1.6 * letters;
    let beside = thick + 1.2 * letters + numbers;
    // A long name may extend to the left over part of the picture's head.
    let size = fitted(&label, letters, 0.6 * area.width());
    let name = text_width(&label, size);
    let bar_right = area.right - beside + thick;
    let bar = Area {
        left: bar_right - thick,
        top: (area.top + 4.0 * letters).round(),
        right: bar_right,
        bottom: (area.bottom - 2.0 * letters).round(),
    };
    let centre = (0.5 * (bar.left + area.right)).min(area.right - 0.5 * name);
    let baseline = [centre, area.top + 1.1 * letters];
    canvas.text(&label, baseline, size, Anchor::Centre, true);
    let rows = bar.top as usize..bar.bottom as usize;
    for y in rows {
        let place = (bar.bottom - 0.5 - y as f64) / bar.height();
        let colour = table.at(place as f32).map(colour::encoded);
        let row = Area {
            top: y as f64,
            bottom: y as f64 + 1.0,
            ..bar
        };
        canvas.fill(row, colour);
    }
    let line = (0.1 * letters).max(1.0);
    let middle = 0.5 * (bar.left + bar.right);
    let ends = values.iter().fold([false; 2], |[below, above], &value| {
        [below || value < low, above || value > high]
    });
    let [bottom, top] = [(0, bar.bottom, 1.0), (1, bar.top, -1.0)].map(|(end, y, outwards)| {
        let tip = [middle, y + outwards * thick];
        if ends[end] {
            // The corners run clockwise: the upper end from its left corner, the lower one from its right
            // corner.
            let corners = match end {
                0 => [[bar.right, y], tip, [bar.left, y]],
                _ => [[bar.left, y], tip, [bar.right, y]],
            };
            let colour = table.at(end as f32).map(colour::encoded);
            canvas.polygon(&corners, colour);
        }
        ends[end].then_some(tip)
    });
    let corners = [
        Some([bar.left, bar.top]),
        top,
        Some([bar.right, bar.top]),
        Some([bar.right, bar.bottom]),
        bottom,
        Some([bar.left, bar.bottom]),
        Some([bar.left, bar.top]),
    ];
    canvas.stroke(&[corners.into_iter().flatten().collect()], line, INK);
    for (value, number) in &ticks.marks {
        let y = bar.bottom - (value - low) / (high - low) * bar.height();
        let end = bar.right + 0.45 * letters;
        canvas.line([bar.right, y], [end, y], line, INK);
        let at = [end + 0.5 * letters, y + 0.5 * letters];
        canvas.text(number, at, letters, Anchor::Left, true);
    }
    area.right = bar.left - 1.5 * letters;
}

/// Height of the capitals of ordinary text in a picture of this size.
fn capitals(size: [u32; 2]) -> f64 {
    let share = (f64::from(size[0]) / 900.0).min(f64::from(size[1]) / 700.0);
    // Small pictures need relatively large letters.
    12.0 * share.max(share.sqrt()).clamp(0.6, 8.0)
}

/// Height of capitals: `letters`, or less if a text would be wider than `width`.
fn fitted(text: &str, letters: f64, width: f64) -> f64 {
    letters * (width / text_width(text, letters)).min(1.0)
}

/// Writes the title at the top of an area, and removes its rectangle from the area.
fn title(canvas: &mut Canvas, title: &str, letters: f64, area: &mut Area) {
    if title.trim().is_empty() {
        return;
    }
    let size = fitted(title, 1.25 * letters, area.width());
    let at = [0.5 * (area.left + area.right), area.top + size];
    canvas.text(title, at, size, Anchor::Centre, true);
    area.top += 3.4 * letters;
}

/// Draws a round length as a bar over its number; `scale` is in pixels per unit.
fn scale_bar(
    canvas: &mut Canvas,
    [left, bottom]: [f64; 2],
    width: f64,
    letters: f64,
    scale: f64,
    unit: &str,
) {
    let (length, number) = ticks::nice_length(0.25 * width / scale);
    let right = left + length * scale;
    let y = bottom - 2.2 * letters;
    let line = (0.16 * letters).max(1.0);
    let tick = |x: f64| vec![[x, y - 0.35 * letters], [x, y + 0.35 * letters]];
    let bar = vec![[left, y], [right, y]];
    canvas.stroke(&[bar, tick(left), tick(right)], line, INK);
    let text = format!("{number} {unit}");
    let half = 0.5 * text_width(&text, letters);
    let centre = (0.5 * (left + right)).max(left + half);
    canvas.text(&text, [centre, bottom], letters, Anchor::Centre, true);
}

fn outline_of(area: Area) -> Vec<[f64; 2]> {
    vec![
        [area.left, area.top],
        [area.right, area.top],
        [area.right, area.bottom],
        [area.left, area.bottom],
        [area.left, area.top],
    ]
}

/// Smallest and largest finite number; `[∞, −∞]` if there is none.
fn extent(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers
        .filter(|number| number.is_finite())
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], number| {
            [low.min(number), high.max(number)]
        })
}

/// Smallest and largest value. If the middle 99 % of the values span less than a third of that range, the
/// range of these: a single bad vertex must not give all others the same colour.
fn without_outliers(mut values: Vec<f64>) -> [f64; 2] {
    values.sort_by(f64::total_cmp);
    let whole = extent(values.iter().copied());
    let cut = values.len() / 200;
    let [low, high] = match &values[cut..values.len() - cut] {
        [low, .., high] => [*low, *high],
        _ => whole,
    };
    if high - low >= (whole[1] - whole[0]) / 3.0 || !is_shown([low, high]) {
        return whole;
    }
    // An end without outliers is kept, so that the range of non-negative fields starts at their minimum.
    let near = 0.2 * (high - low);
    [
        if low - whole[0] < near { whole[0] } else { low },
        if whole[1] - high < near {
            whole[1]
        } else {
            high
        },
    ]
}

/// Whether a scale can show a range, which must exceed rounding and fit into f64.
fn is_shown([low, high]: [f64; 2]) -> bool {
    let (length, largest) = (high - low, low.abs().max(high.abs()));
    length.is_finite() && length > 1e-9 * largest && length > 1e-280
}

/// A range that a scale can show: an empty one is extended by a tenth of its value on both sides.
fn widened([low, high]: [f64; 2]) -> [f64; 2] {
    if is_shown([low, high]) {
        return [low, high];
    }
    let middle = 0.5 * (low + high);
    let around = [middle - 0.1 * middle.abs(), middle + 0.1 * middle.abs()];
    if is_shown(around) {
        around
    } else {
        [-1.0, 1.0]
    }
}
