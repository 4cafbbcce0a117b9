//! Canvas of pixels on which lines, areas and texts are drawn with antialiasing.

use super::colour::{Colour, WHITE};
use super::font;

/// A finished picture. Pixels are counted from the upper left corner; y points down.
#[derive(Clone, Debug, PartialEq)]
pub struct Canvas {
    width: usize,
    height: usize,
    /// Row after row, encoded as sRGB.
    pixels: Vec<Colour>,
    /// Fraction of each pixel that the current shape covers; 0 between shapes.
    coverage: Vec<f32>,
}

/// Point of a text that is aligned with the given position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Left,
    Centre,
    Right,
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Area {
    pub(super) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(super) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(super) fn contains(&self, [x, y]: [f64; 2]) -> bool {
        (self.left..=self.right).contains(&x) && (self.top..=self.bottom).contains(&y)
    }

    /// The part of a line inside the area, if there is one (Liang and Barsky 1984).
    pub(super) fn clip(&self, [a, b]: [[f64; 2]; 2]) -> Option<[[f64; 2]; 2]> {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for (axis, low, high) in [(0, self.left, self.right), (1, self.top, self.bottom)] {
            let along = b[axis] - a[axis];
            if along == 0.0 {
                if !(low..=high).contains(&a[axis]) {
                    return None;
                }
                continue;
            }
            let [first, second] = [(low - a[axis]) / along, (high - a[axis]) / along];
            from = from.max(first.min(second));
            to = to.min(first.max(second));
        }
        // Rounding at far ends must not lead outside again; the ends are finite.
        let at = |t: f64| {
            let [x, y] = [0, 1].map(|axis| a[axis] + t * (b[axis] - a[axis]));
            [
                x.clamp(self.left, self.right),
                y.clamp(self.top, self.bottom),
            ]
        };
        let clipped = [at(from), at(to)];
        let exists = from <= to && clipped.as_flattened().iter().all(|x| x.is_finite());
        exists.then_some(clipped)
    }
}

impl Canvas {
    /// A white canvas.
    pub(super) fn new([width, height]: [u32; 2]) -> Self {
        let (width, height) = (width as usize, height as usize);
        Self {
            width,
            height,
            pixels: vec![WHITE; width * height],
            coverage: vec![0.0; width * height],
        }
    }

    /// Pixels across and down.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The pixels' red, green and blue, row after row from the top.
    pub fn rgb(&self) -> Vec<u8> {
        let byte = |part: f32| (255.0 * part + 0.5) as u8;
        self.pixels.iter().flatten().copied().map(byte).collect()
    }

    pub(super) fn row_mut(&mut self, y: usize) -> &mut [Colour] {
        &mut self.pixels[y * self.width..(y + 1) * self.width]
    }

    /// Pixels that touch an interval of x or y.
    fn span(low: f64, high: f64, count: usize) -> std::ops::Range<usize> {
        let pixel = |x: f64| x.clamp(0.0, count as f64) as usize;
        pixel(low.floor())..pixel(high.ceil())
    }

    /// Raises the coverage of the pixels in an area to `cover` at their centres.
    fn cover(&mut self, area: Area, cover: impl Fn([f64; 2]) -> f64) {
        let columns = Self::span(area.left, area.right, self.width);
        for y in Self::span(area.top, area.bottom, self.height) {
            for x in columns.clone() {
                let found = cover([x as f64 + 0.5, y as f64 + 0.5]).clamp(0.0, 1.0) as f32;
                let coverage = &mut self.coverage[y * self.width + x];
                *coverage = coverage.max(found);
            }
        }
    }

    /// Paints the covered part of an area in a colour.
    fn paint(&mut self, area: Area, colour: Colour) {
        let columns = Self::span(area.left, area.right, self.width);
        for y in Self::span(area.top, area.bottom, self.height) {
            let row = y * self.width;
            for at in row + columns.start..row + columns.end {
                let share = std::mem::take(&mut self.coverage[at]);
                for (pixel, part) in self.pixels[at].iter_mut().zip(colour) {
                    *pixel += share * (part - *pixel);
                }
            }
        }
    }

    /// Fills a rectangle.
    pub(super) fn fill(&mut self, area: Area, colour: Colour) {
        let overlap = |low: f64, high: f64, at: f64| high.min(at + 0.5) - low.max(at - 0.5);
        self.cover(area, |[x, y]| {
            overlap(area.left, area.right, x).max(0.0) * overlap(area.top, area.bottom, y).max(0.0)
        });
        self.paint(area, colour);
    }

    /// Draws strokes with round ends as a single shape, so that crossings are not painted twice.
    pub(super) fn stroke(&mut self, strokes: &[Vec<[f64; 2]>], width: f64, colour: Colour) {
        let reach = 0.5 * width + 1.0;
        let around = |a: [f64; 2], b: [f64; 2]| Area {
            left: a[0].min(b[0]) - reach,
            top: a[1].min(b[1]) - reach,
            right: a[0].max(b[0]) + reach,
            bottom: a[1].max(b[1]) + reach,
        };
        let pairs = strokes.iter().flat_map(|stroke| stroke.windows(2));
        let mut whole: Option<Area> = None;
        for pair in pairs {
            let [a, b] = [pair[0], pair[1]];
            let area = around(a, b);
            self.cover(area, |at| 0.5 + 0.5 * width - distance(at, a, b));
            whole = Some(whole.map_or(area, |whole| Area {
                left: whole.left.min(area.left),
                top: whole.top.min(area.top),
                right: whole.right.max(area.right),
                bottom: whole.bottom.max(area.bottom),
            }));
        }
        if let Some(whole) = whole {
            self.paint(whole, colour);
        }
    }

    /// Draws one straight line.
    pub(super) fn line(&mut self, a: [f64; 2], b: [f64; 2], width: f64, colour: Colour) {
        self.stroke(&[vec![a, b]], width, colour);
    }

    /// Fills a convex polygon whose corners run clockwise on the screen.
    pub(super) fn polygon(&mut self, corners: &[[f64; 2]], colour: Colour) {
        let bound = |axis: usize, pick: fn(f64, f64) -> f64, start| {
            corners.iter().map(|corner| corner[axis]).fold(start, pick)
        };
        let area = Area {
            left: bound(0, f64::min, f64::INFINITY) - 1.0,
            top: bound(1, f64::min, f64::INFINITY) - 1.0,
            right: bound(0, f64::max, f64::NEG_INFINITY) + 1.0,
            bottom: bound(1, f64::max, f64::NEG_INFINITY) + 1.0,
        };
        self.cover(area, |at| {
            let sides = corners.iter().zip(corners.iter().cycle().skip(1));
            let inside = sides.map(|(a, b)| {
                let [x, y] = [b[0] - a[0], b[1] - a[1]];
                (x * (at[1] - a[1]) - y * (at[0] - a[0])) / (x * x + y * y).sqrt()
            });
            0.5 + inside.fold(f64::INFINITY, f64::min)
        });
        self.paint(area, colour);
    }

    /// Fills a disc.
    pub(super) fn disc(&mut self, centre: [f64; 2], radius: f64, colour: Colour) {
        self.stroke(&[vec![centre, centre]], 2.0 * radius, colour);
    }

    /// Writes a text with capitals of a given height; `at` is on its baseline. Upright text runs from
    /// left to right, other text from the bottom to the top.
    pub(super) fn text(
        &mut self,
        text: &str,
        at: [f64; 2],
        capitals: f64,
        anchor: Anchor,
        upright: bool,
    ) {
        let scale = capitals / font::CAPITALS;
        let start = match anchor {
            Anchor::Left => 0.0,
            Anchor::Centre => -0.5 * font::width(text),
            Anchor::Right => -font::width(text),
        };
        let mut strokes = font::strokes(text);
        for point in strokes.iter_mut().flatten() {
            let [x, y] = [scale * (start + point[0]), -scale * point[1]];
            *point = if upright {
                [at[0] + x, at[1] + y]
            } else {
                [at[0] + y, at[1] - x]
            };
        }
        let width = (0.115 * capitals).max(1.0);
        self.stroke(&strokes, width, super::colour::INK);
    }
}

/// Width in pixels of a text whose capitals have this height.
pub(super) fn text_width(text: &str, capitals: f64) -> f64 {
    font::width(text) * capitals / font::CAPITALS
}

/// Distance of a point from the line between two others.
fn distance(at: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let from = [at[0] - a[0], at[1] - a[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let t = if square > 0.0 {
        ((from[0] * along[0] + from[1] * along[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let [x, y] = [from[0] - t * along[0], from[1] - t * along[1]];
    (x * x + y * y).sqrt()
}
