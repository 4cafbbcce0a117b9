//! Colours: OKLab, perceptually uniform colour maps, and a palette for curves.
//!
//! OKLab and its matrices: B. Ottosson, *A perceptual color space for image processing* (2020,
//! public domain). The sRGB curve: IEC 61966-2-1.

/// A colour's red, green and blue as sRGB encodes them, from 0 to 1.
pub type Colour = [f32; 3];

pub(super) const WHITE: Colour = [1.0; 3];
pub(super) const INK: Colour = [0.1; 3];
pub(super) const FAINT: Colour = [0.87; 3];
/// The colour of missing values.
pub const NO_VALUE: Colour = [0.55; 3];
/// The colour of a surface without a field.
pub(super) const PLAIN: Colour = [0.78, 0.8, 0.83];

/// A colour map. Equal differences of values are equal distances in OKLab.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ColourMap {
    /// Colours from dark to light, for fields whose low end is the natural origin.
    #[default]
    Sequential,
    /// Two hues that meet in a light neutral colour for 0, for fields with a sign.
    Diverging,
}

impl ColourMap {
    /// This many colours at equal distances from one end of the map to the other, as sRGB encodes them.
    pub fn colours(self, count: usize) -> Vec<[u8; 3]> {
        let table = ColourTable::new(self);
        let last = count.saturating_sub(1).max(1) as f32;
        let byte = |light: f32| (255.0 * encoded(light)).round() as u8;
        let colour = |at: usize| table.at(at as f32 / last).map(byte);
        (0..count).map(colour).collect()
    }
}

/// Encodes linear light by the sRGB curve.
pub(super) fn encoded(light: f32) -> f32 {
    if light <= 0.003_130_8 {
        12.92 * light.max(0.0)
    } else {
        1.055 * libm::powf(light.min(1.0), 1.0 / 2.4) - 0.055
    }
}

/// Inverse of [`encoded`].
pub(super) fn light(encoded: f32) -> f32 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        libm::powf((encoded + 0.055) / 1.055, 2.4)
    }
}

/// Linear red, green and blue of an OKLab colour; outside \[0, 1\] for colours that screens cannot show.
fn from_oklab([lightness, a, b]: [f64; 3]) -> [f64; 3] {
    let cube = |x: f64| x * x * x;
    let long = cube(lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b);
    let medium = cube(lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b);
    let short = cube(lightness - 0.089_484_177_5 * a - 1.291_485_548 * b);
    [
        4.076_741_662_1 * long - 3.307_711_591_3 * medium + 0.230_969_929_2 * short,
        -1.268_438_004_6 * long + 2.609_757_401_1 * medium - 0.341_319_396_5 * short,
        -0.004_196_086_3 * long - 0.703_418_614_7 * medium + 1.707_614_701 * short,
    ]
}

/// OKLab coordinates from lightness, chroma, and hue in degrees.
fn polar([lightness, chroma, hue]: [f64; 3]) -> [f64; 3] {
    let hue = hue.to_radians();
    [lightness, chroma * libm::cos(hue), chroma * libm::sin(hue)]
}

/// The nearest colour of the same lightness and hue that screens can show, in OKLab and as linear light.
fn shown(lightness: f64, chroma: f64, hue: f64) -> ([f64; 3], [f64; 3]) {
    let of = |chroma| {
        let lab = polar([lightness, chroma, hue]);
        (lab, from_oklab(lab))
    };
    let is_shown =
        |(_, light): &([f64; 3], [f64; 3])| light.iter().all(|x| (0.0..=1.0).contains(x));
    let wanted = of(chroma);
    if is_shown(&wanted) {
        return wanted;
    }
    // The interval is halved down to the resolution of f64, because coarser steps would be visible in the
    // map.
    let (mut low, mut high) = (0.0, chroma);
    for _ in 0..52 {
        let middle = 0.5 * (low + high);
        if is_shown(&of(middle)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    of(low)
}

/// Path of the sequential map for t from 0 to 1: violet, blue, green, yellow, with increasing lightness.
fn sequential(t: f64) -> ([f64; 3], [f64; 3]) {
    let lightness = 0.33 + 0.6 * t;
    let hue = 295.0 - 190.0 * t;
    // Screens show the least chroma in green, much in blue; this smooth function is below the limits of all
    // hues.
    let chroma = 0.125 + 0.035 * libm::cos(2.0 * std::f64::consts::PI * t);
    shown(lightness, chroma, hue)
}

/// Path of the diverging map for t from −1 to 1: blue, a light neutral colour, red.
fn diverging(t: f64) -> ([f64; 3], [f64; 3]) {
    let far = t.abs();
    let hue = if t < 0.0 { 258.0 } else { 28.0 };
    shown(0.965 - 0.5 * far, 0.17 * far, hue)
}

/// A colour map as a table of linear light.
#[derive(Debug)]
pub(super) struct ColourTable {
    entries: Vec<[f32; 3]>,
}

impl ColourTable {
    const SIZE: usize = 512;

    pub(super) fn new(map: ColourMap) -> Self {
        let colours = match map {
            ColourMap::Sequential => even(Self::SIZE, sequential),
            ColourMap::Diverging => {
                let half = Self::SIZE / 2;
                let mut low = even(half, |t| diverging(-t));
                low.reverse();
                low.extend(even(half, diverging));
                low
            }
        };
        let single = |(_, light): ([f64; 3], [f64; 3])| light.map(|x| x as f32);
        Self {
            entries: colours.into_iter().map(single).collect(),
        }
    }

    /// Linear light at a position from 0 to 1; that of a missing value for NaN.
    pub(super) fn at(&self, place: f32) -> [f32; 3] {
        if place.is_nan() {
            return NO_VALUE.map(light);
        }
        let last = self.entries.len() - 1;
        let place = place.clamp(0.0, 1.0) * last as f32;
        let low = (place as usize).min(last - 1);
        let share = place - low as f32;
        let [a, b] = [self.entries[low], self.entries[low + 1]];
        [0, 1, 2].map(|part| a[part] + share * (b[part] - a[part]))
    }
}

/// `count` colours of a path over t from 0 to 1, at equal distances in OKLab.
fn even(count: usize, path: impl Fn(f64) -> ([f64; 3], [f64; 3])) -> Vec<([f64; 3], [f64; 3])> {
    const FINE: usize = 4096;
    let parameter = |step: usize| step as f64 / FINE as f64;
    let mut lengths = vec![0.0];
    let mut last = path(0.0).0;
    for step in 1..=FINE {
        let next = path(parameter(step)).0;
        lengths.push(lengths[step - 1] + distance(last, next));
        last = next;
    }
    let mut step = 0;
    (0..count)
        .map(|at| {
            let length = lengths[FINE] * at as f64 / (count - 1) as f64;
            while step + 1 < FINE && lengths[step + 1] < length {
                step += 1;
            }
            let share = (length - lengths[step]) / (lengths[step + 1] - lengths[step]);
            path(parameter(step) + share / FINE as f64)
        })
        .collect()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let squares = [0, 1, 2].map(|axis| (a[axis] - b[axis]).powi(2));
    squares.iter().sum::<f64>().sqrt()
}

/// Colours of curves, with equal lightness and well-separated hues; they repeat after six.
pub(super) fn of_curve(index: usize) -> Colour {
    const HUES: [f64; 6] = [255.0, 35.0, 150.0, 315.0, 75.0, 200.0];
    let (_, shown) = shown(0.56, 0.16, HUES[index % HUES.len()]);
    shown.map(|x| encoded(x as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_take_even_steps_and_lightness_is_monotonic() {
        type Path = fn(f64) -> ([f64; 3], [f64; 3]);
        let paths: [Path; 3] = [sequential, |t| diverging(-t), diverging];
        for (path, rises) in paths.into_iter().zip([true, false, false]) {
            let colours = even(64, path);
            let steps: Vec<f64> = colours
                .windows(2)
                .map(|pair| distance(pair[0].0, pair[1].0))
                .collect();
            let mean = steps.iter().sum::<f64>() / steps.len() as f64;
            for step in steps {
                assert!((step / mean - 1.0).abs() < 0.05, "{step} of {mean}");
            }
            assert!(
                colours
                    .windows(2)
                    .all(|pair| (pair[0].0[0] < pair[1].0[0]) == rises)
            );
            assert!(
                colours
                    .iter()
                    .flat_map(|colour| colour.1)
                    .all(|x| (0.0..=1.0).contains(&x))
            );
        }
    }

    /// White is L = 1 without chroma, as in the article, and the sRGB curve is the inverse of its inverse.
    #[test]
    fn the_spaces_fit_each_other() {
        for x in from_oklab([1.0, 0.0, 0.0]) {
            assert!((x - 1.0).abs() < 1e-6);
        }
        for step in 0..=100 {
            let x = step as f32 / 100.0;
            assert!((encoded(light(x)) - x).abs() < 1e-5);
        }
        let middle = ColourTable::new(ColourMap::Diverging).at(0.5);
        assert!((middle[0] - middle[2]).abs() < 1e-3 && middle[0] > 0.85);
    }
}
