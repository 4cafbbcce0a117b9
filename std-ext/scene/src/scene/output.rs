//! The outputs of a run and their intervals.

use glam::DVec3;
use serde::Serialize;
use std::f64::consts::FRAC_1_SQRT_2;
use std::path::PathBuf;

/// The outputs of a run and their intervals.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Output {
    /// Interval between rows of the series.
    pub every: Every,
    /// Number of rows between sets of files: surfaces, pictures and slices.
    pub files_every: u64,
    /// Whether surfaces are written.
    pub surfaces: bool,
    /// Which sets of files have pictures.
    pub pictures: Pictures,
    /// The field that pictures show as colours.
    pub picture_field: PictureField,
    /// Iterations, or steps in time, between two checkpoints.
    pub checkpoint_every: u64,
    /// Columns of the series that are drawn as plots.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub plots: Vec<Plot>,
    /// Planes on which the fluid's velocity and pressure are written.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub slices: Vec<Slice>,
    /// Outputs of the whole box of a lattice.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub volumes: Vec<Volume>,
    /// Points at which the fluid's velocity is written.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<Probe>,
    /// Measurements of a suspension as by a rheometer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rheology: Option<Rheology>,
}

/// Measurements of a suspension in the box of a lattice, as by a rheometer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rheology {
    /// Whether stresses are columns of the series.
    pub stress: bool,
    /// The number of slices between the walls, 0 for none.
    pub profiles: usize,
    /// The number of blocks of time from which errors of means follow, 2 or more.
    pub blocks: usize,
    /// The strain, the flow's rate times the time, up to which rows are left out of means.
    pub skip: f64,
}

/// Interval between outputs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Every {
    /// A number of iterations, for drivers without time.
    Iterations(u64),
    /// A time.
    Time(f64),
}

/// Sets of files with pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pictures {
    /// None.
    Never,
    /// The last, and before it as many as take a tenth of the time of the run.
    Affordable,
    /// All.
    Always,
}

/// A field that pictures show as colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PictureField {
    /// H.
    MeanCurvature,
    /// K.
    GaussianCurvature,
    /// Magnitude of the bending force density.
    BendingForce,
}

/// A column of the series, drawn over another one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plot {
    /// The column. With several surfaces each has its own column `NAME_SURFACE`, and `NAME` stands
    /// for all of them.
    pub column: String,
    /// The column of the horizontal axis.
    pub against: String,
    /// CSV file with curves to be drawn in the same plot: a header `curve,x,y`, then points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub published: Option<PathBuf>,
}

/// A rectangle in the fluid, on which velocity and pressure are written with every set of files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Slice {
    /// Its name, and that of its files; `slice-1` and so on for those without one.
    pub name: String,
    /// Its centre.
    pub centre: [f64; 3],
    /// The normal of its plane, of any length above 0.
    pub normal: [f64; 3],
    /// Its edges' lengths, along [`Self::axes`].
    pub size: [f64; 2],
    /// The number of points along each edge, 2 or more.
    pub points: [usize; 2],
}

impl Slice {
    /// Unit vectors along its edges: the first is x, or y if the normal is nearer to x than 45°,
    /// rotated into the plane; the second is the vector product of the normal and the first.
    pub fn axes(&self) -> [[f64; 3]; 2] {
        let normal = DVec3::from(self.normal).normalize_or_zero();
        let near = normal.x.abs() > FRAC_1_SQRT_2;
        let axis = if near { DVec3::Y } else { DVec3::X };
        let first = axis.reject_from_normalized(normal).normalize_or_zero();
        [first, normal.cross(first)].map(|axis| axis.to_array())
    }

    /// Its four corners.
    pub(super) fn corners(&self) -> [[f64; 3]; 4] {
        let [first, second] = self.axes().map(DVec3::from);
        [[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5], [0.5, 0.5]].map(|[a, b]| {
            let away = a * self.size[0] * first + b * self.size[1] * second;
            (DVec3::from(self.centre) + away).to_array()
        })
    }
}

/// The fluid in the whole box of a lattice, of which velocity and pressure are written with every set
/// of files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Volume {
    /// Its name, and that of its files; `volume-1` and so on for those without one.
    pub name: String,
    /// The stride along each axis: every stride-th node is written.
    pub stride: usize,
}

/// A point at which the fluid's velocity is written into the series.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Probe {
    /// Its name, and that of its columns: `NAME_x`, `NAME_y`, `NAME_z`; `probe-1` and so on for those
    /// without one.
    pub name: String,
    /// Its position.
    pub point: [f64; 3],
}
