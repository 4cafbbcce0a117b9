//! Rasterisation of triangles: parallel projection, depth buffer, two by two samples per pixel.

use super::canvas::{Area, Canvas};
use super::colour::{self, ColourTable, PLAIN};
use super::{PaintedSurface, PictureError, Shading, View};
use helfrich::Surface;

/// Samples per pixel in each direction.
const SAMPLES: usize = 2;
/// Rows of pixels that are sampled at a time.
const BAND: usize = 24;
/// Fraction of ambient light.
const AMBIENT: f64 = 0.47;
/// Half of the width of an edge line, in pixels.
const EDGE: f64 = 0.45;
/// Fraction of the light that an edge absorbs.
const EDGE_DARKNESS: f32 = 0.6;

/// The map from space to a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    /// Orthonormal directions to the right, upwards and to the viewer.
    axes: [[f64; 3]; 3],
    /// Point in the middle of the picture.
    centre: [f64; 3],
    /// Middle of the picture in pixels.
    middle: [f64; 2],
    /// Pixels per unit of length.
    pub(super) scale: f64,
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Unit vector; NaN if the vector has no direction.
fn unit(a: [f64; 3]) -> [f64; 3] {
    // Division by the largest component first, because squares of lengths in metres might underflow.
    let largest = a.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let a = a.map(|x| x / largest);
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

impl Camera {
    pub(super) fn new(
        view: &View,
        surfaces: &[PaintedSurface<'_>],
        area: Area,
    ) -> Result<Self, PictureError> {
        let View {
            direction,
            up,
            frame,
        } = *view;
        let towards = unit(direction);
        let right = cross(unit(up), towards);
        let usable = dot(right, right) > 1e-12;
        if !usable || !frame.is_none_or(|frame| frame.radius > 0.0) {
            return Err(PictureError::View { direction, up });
        }
        let right = unit(right);
        let axes = [right, cross(towards, right), towards];
        let (centre, [wide, high]) = match frame {
            Some(frame) => (frame.centre, [2.0 * frame.radius; 2]),
            None => framed(&axes, surfaces),
        };
        let scale = (area.width() / wide).min(area.height() / high);
        let middle = [
            0.5 * (area.left + area.right),
            0.5 * (area.top + area.bottom),
        ];
        Ok(Self {
            axes,
            centre,
            middle,
            scale: if scale.is_finite() { scale } else { 1.0 },
        })
    }

    /// Projects a point: pixels to the right and down, and nearness to the viewer.
    pub(super) fn project(&self, x: [f64; 3]) -> [f64; 3] {
        let [right, down, near] = self.turn(sub(x, self.centre)).map(|x| self.scale * x);
        [self.middle[0] + right, self.middle[1] + down, near]
    }

    /// Components of a direction to the right, down and towards the viewer.
    pub(super) fn turn(&self, direction: [f64; 3]) -> [f64; 3] {
        let [right, up, near] = self.axes.map(|axis| dot(axis, direction));
        [right, -up, near]
    }

    /// |cos| of the angle between a direction and the direction to the viewer.
    pub(super) fn tilt(&self, direction: [f64; 3]) -> f64 {
        dot(direction, self.axes[2]).abs()
    }

    /// Direction to the light, which is beside the viewer, so that a sphere looks shaded.
    fn light(&self) -> [f64; 3] {
        let [right, up, towards] = self.axes;
        unit([0, 1, 2].map(|axis| towards[axis] + 0.45 * up[axis] - 0.3 * right[axis]))
    }
}

/// Centre, and extent to the right and up, of all vertices that belong to triangles.
fn framed(axes: &[[f64; 3]; 3], surfaces: &[PaintedSurface<'_>]) -> ([f64; 3], [f64; 2]) {
    let points = || {
        surfaces.iter().flat_map(|painted| {
            let positions = painted.surface.positions();
            let corners = painted.surface.mesh().triangles().as_flattened();
            corners.iter().map(|&vertex| positions[vertex as usize])
        })
    };
    let extents = axes.map(|axis| super::extent(points().map(|x| dot(axis, x))));
    let middle = extents.map(|[low, high]| 0.5 * (low + high));
    let centre = [0, 1, 2].map(|at| (0..3).map(|axis| middle[axis] * axes[axis][at]).sum());
    let across = |axis: usize| extents[axis][1] - extents[axis][0];
    (centre, [across(0), across(1)])
}

/// A projected vertex.
#[derive(Clone, Copy)]
struct Corner {
    /// Pixels to the right, pixels down, nearness.
    at: [f64; 3],
    normal: [f64; 3],
    /// Position in the colour map; NaN where there is no value.
    value: f64,
}

/// A surface that is ready to be drawn.
pub(super) struct Painted {
    corners: Vec<[Corner; 3]>,
    /// Whether there is no field, so that the surface has a single colour.
    plain: bool,
    edges: bool,
}

impl Painted {
    pub(super) fn new(
        painted: &PaintedSurface<'_>,
        camera: &Camera,
        [low, high]: [f64; 2],
    ) -> Self {
        let surface = painted.surface;
        let normals = vertex_normals(surface);
        let corner = |triangle: usize, vertex: u32| {
            let vertex = vertex as usize;
            Corner {
                at: camera.project(surface.positions()[vertex]),
                normal: match painted.shading {
                    Shading::Smooth => normals[vertex],
                    Shading::Flat => surface.triangle_normal(triangle),
                },
                value: painted.field.map_or(0.0, |field| match field[vertex] {
                    value if value.is_finite() => (value - low) / (high - low),
                    _ => f64::NAN,
                }),
            }
        };
        let mut corners: Vec<_> = surface
            .mesh()
            .triangles()
            .iter()
            .enumerate()
            .map(|(triangle, corners)| corners.map(|vertex| corner(triangle, vertex)))
            .collect();
        // Triangles are sorted from near to far, so that hidden ones need not be coloured.
        let nearness =
            |corners: &[Corner; 3]| corners.iter().map(|corner| corner.at[2]).sum::<f64>();
        corners.sort_by(|a, b| nearness(b).total_cmp(&nearness(a)));
        Self {
            corners,
            plain: painted.field.is_none(),
            edges: painted.edges,
        }
    }
}

/// Sums of the triangles' normals, weighted by area.
pub(super) fn vertex_normals(surface: Surface<'_, f64>) -> Vec<[f64; 3]> {
    let mut normals = vec![[0.0; 3]; surface.mesh().vertex_count()];
    for (triangle, corners) in surface.mesh().triangles().iter().enumerate() {
        let area = surface.triangle_area(triangle);
        let normal = surface.triangle_normal(triangle);
        for &corner in corners {
            for (sum, part) in normals[corner as usize].iter_mut().zip(normal) {
                *sum += area * part;
            }
        }
    }
    normals.into_iter().map(unit).collect()
}

/// The nearest surface at a sample of the picture.
#[derive(Clone, Copy)]
struct Sample {
    near: f64,
    light: [f32; 3],
}

const NOTHING: Sample = Sample {
    near: f64::NEG_INFINITY,
    light: [1.0; 3],
};

/// Nearness of the nearest surface at the centre of every pixel of an area.
pub(super) struct Depths {
    left: usize,
    top: usize,
    across: usize,
    near: Vec<f64>,
}

impl Depths {
    /// Nearness at a point of the picture; −∞ where there is no surface.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let column = (x as usize).checked_sub(self.left);
        let row = (y as usize).checked_sub(self.top);
        let inside = column.filter(|&column| column < self.across).zip(row);
        let near = inside.and_then(|(column, row)| self.near.get(row * self.across + column));
        near.copied().unwrap_or(f64::NEG_INFINITY)
    }
}

/// Draws surfaces into an area of a canvas.
pub(super) fn draw(
    canvas: &mut Canvas,
    area: Area,
    surfaces: &[Painted],
    camera: &Camera,
    table: &ColourTable,
) -> Depths {
    let (left, right) = (area.left as usize, area.right as usize);
    let (top, bottom) = (area.top as usize, area.bottom as usize);
    let across = SAMPLES * right.saturating_sub(left);
    let mut samples = vec![NOTHING; across * SAMPLES * BAND];
    let mut near = Vec::with_capacity(right.saturating_sub(left) * bottom.saturating_sub(top));
    let encoding = Encoding::new();
    for from in (top..bottom).step_by(BAND) {
        let rows = from..(from + BAND).min(bottom);
        let mut band = Band {
            origin: [left as f64, from as f64],
            size: [across, SAMPLES * rows.len()],
            samples: &mut samples,
            reached: [across, 0],
            light: camera.light(),
            towards: camera.axes[2],
            table,
            plain: PLAIN.map(colour::light),
        };
        for surface in surfaces {
            for corners in &surface.corners {
                band.triangle(corners, surface);
            }
        }
        // Most of a picture is empty: only columns that a triangle has reached are looked at.
        let [first, end] = band.reached;
        let columns = first / SAMPLES..end.div_ceil(SAMPLES).max(first / SAMPLES);
        for (row, y) in rows.enumerate() {
            let depths = near.len();
            near.resize(depths + across / SAMPLES, f64::NEG_INFINITY);
            let pixels = &mut canvas.row_mut(y)[left..right];
            for column in columns.clone() {
                let pixel = &mut pixels[column];
                let block = (0..SAMPLES).flat_map(|down| {
                    let start = (SAMPLES * row + down) * across + SAMPLES * column;
                    &samples[start..start + SAMPLES]
                });
                let mut sum = [0.0_f32; 3];
                let mut seen = false;
                for sample in block {
                    seen |= sample.near > f64::NEG_INFINITY;
                    for (sum, light) in sum.iter_mut().zip(sample.light) {
                        *sum += light;
                    }
                }
                if seen {
                    let share = 1.0 / (SAMPLES * SAMPLES) as f32;
                    *pixel = sum.map(|sum| encoding.at(share * sum));
                }
                let middle = (SAMPLES * row + SAMPLES / 2) * across + SAMPLES * column;
                near[depths + column] = samples[middle + SAMPLES / 2].near;
            }
        }
        if first < end {
            for row in samples.chunks_mut(across) {
                row[first..end].fill(NOTHING);
            }
        }
    }
    Depths {
        left,
        top,
        across: right.saturating_sub(left),
        near,
    }
}

/// The curve of sRGB as a table.
struct Encoding(Vec<f32>);

impl Encoding {
    /// Intervals of the table; between its entries, lines are off by less than a tenth of the steps of eight
    /// bits.
    const SIZE: usize = 4096;

    fn new() -> Self {
        let light = |entry: usize| entry as f32 / Self::SIZE as f32;
        Self(
            (0..=Self::SIZE)
                .map(|entry| colour::encoded(light(entry)))
                .collect(),
        )
    }

    /// A part of a colour, from its linear light.
    fn at(&self, light: f32) -> f32 {
        let place = light.clamp(0.0, 1.0) * Self::SIZE as f32;
        let low = (place as usize).min(Self::SIZE - 1);
        let [a, b] = [self.0[low], self.0[low + 1]];
        a + (place - low as f32) * (b - a)
    }
}

/// A few rows of samples.
struct Band<'a> {
    /// Upper left corner in pixels.
    origin: [f64; 2],
    /// Samples across and down.
    size: [usize; 2],
    samples: &'a mut [Sample],
    /// The first column of samples that a triangle has reached, and the one after the last.
    reached: [usize; 2],
    light: [f64; 3],
    towards: [f64; 3],
    table: &'a ColourTable,
    /// The light of a surface without a field.
    plain: [f32; 3],
}

impl Band<'_> {
    fn triangle(&mut self, corners: &[Corner; 3], surface: &Painted) {
        let density = SAMPLES as f64;
        let [a, b, c] = corners
            .map(|corner| [0, 1].map(|axis| density * (corner.at[axis] - self.origin[axis]) - 0.5));
        let range = |axis: usize| {
            let low = a[axis].min(b[axis]).min(c[axis]).ceil().max(0.0);
            let high = a[axis].max(b[axis]).max(c[axis]).floor();
            (low, high.min(self.size[axis] as f64 - 1.0))
        };
        let ((left, right), (top, bottom)) = (range(0), range(1));
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        // A triangle that is seen from its edge is invisible.
        if !(left <= right && top <= bottom) || area == 0.0 {
            return;
        }
        let [first, end] = self.reached;
        self.reached = [first.min(left as usize), end.max(right as usize + 1)];
        // The weight of a corner is the area between a sample and the opposite side, relative to the
        // triangle's area: its change to the right, its change downwards, and its value at the origin.
        let weight = |p: [f64; 2], q: [f64; 2]| {
            let [x, y] = [(q[0] - p[0]) / area, (q[1] - p[1]) / area];
            [-y, x, y * p[0] - x * p[1]]
        };
        let weights = [weight(b, c), weight(c, a), weight(a, b)];
        // Distance from a side, in pixels, per unit of the weight.
        let heights = weights.map(|[x, y, _]| 1.0 / (x * x + y * y).sqrt() / density);
        for y in top as usize..=bottom as usize {
            let row = weights.map(|[_, down, start]| start + down * y as f64);
            for x in left as usize..=right as usize {
                let along = x as f64;
                let at = [0, 1, 2].map(|corner| row[corner] + weights[corner][0] * along);
                // The tolerance prevents gaps between adjacent triangles.
                if at[0].min(at[1]).min(at[2]) < -1e-9 {
                    continue;
                }
                let mix = |part: fn(&Corner) -> f64| {
                    at[0] * part(&corners[0])
                        + at[1] * part(&corners[1])
                        + at[2] * part(&corners[2])
                };
                let near = mix(|corner| corner.at[2]);
                let sample = &mut self.samples[y * self.size[0] + x];
                if near <= sample.near {
                    continue;
                }
                let normal = [
                    mix(|corner| corner.normal[0]),
                    mix(|corner| corner.normal[1]),
                    mix(|corner| corner.normal[2]),
                ];
                let mut light = lit(normal, self.light, self.towards);
                let edge = (0..3).any(|side| at[side] * heights[side] < EDGE);
                if surface.edges && edge {
                    light *= 1.0 - EDGE_DARKNESS;
                }
                let colour = if surface.plain {
                    self.plain
                } else {
                    self.table.at(mix(|corner| corner.value) as f32)
                };
                *sample = Sample {
                    near,
                    light: colour.map(|part| light * part),
                };
            }
        }
    }
}

/// Fraction of the light that a surface reflects, on either side.
fn lit(normal: [f64; 3], light: [f64; 3], towards: [f64; 3]) -> f32 {
    let length = dot(normal, normal).sqrt();
    let side = if dot(normal, towards) < 0.0 {
        -length
    } else {
        length
    };
    let direct = (dot(normal, light) / side).max(0.0);
    (AMBIENT + (1.0 - AMBIENT) * direct) as f32
}
