//! Keys of the outputs.

use super::super::keys::{Form, Keys, NUMBER, Range, optional, plain, positive, required};
use super::super::units::Dimension;

pub(super) static OUTPUT: Keys = Keys {
    keys: &[
        optional(
            "every",
            Form::Count(1),
            "Iterations between rows of the series, for drivers without time; by default 100.",
        ),
        optional(
            "interval",
            positive(Dimension::TIME),
            "Time between rows of the series, for drivers with time; by default a hundredth of \
             the duration.",
        ),
        optional(
            "strain_interval",
            NUMBER,
            "Strain between rows of the series, the flow's rate times the time.",
        ),
        optional(
            "files_every",
            Form::Count(1),
            "Rows between sets of files: surfaces, pictures and slices; by default 1.",
        ),
        optional(
            "surfaces",
            Form::Switch,
            "Whether surfaces are written as VTP files; by default true.",
        ),
        optional(
            "pictures",
            Form::Switch,
            "Whether pictures are written as PNG files with every set of files; by default with the last, and \
             with as many before as take about a tenth of the time of the run.",
        ),
        optional(
            "picture_field",
            Form::Choice(|| {
                let names = [
                    "H",
                    "mean-curvature",
                    "K",
                    "gaussian-curvature",
                    "f",
                    "bending-force",
                ];
                let with_line = ["mean_curvature", "gaussian_curvature", "bending_force"];
                names.into_iter().chain(with_line).collect()
            }),
            "Field that the colours of pictures show, by its name in output files or in words: H, the \
             default, is the mean curvature, K the Gaussian curvature, f the bending force density.",
        ),
        optional(
            "checkpoint_every",
            Form::Count(1),
            "Iterations, or steps in time, from one checkpoint to the next; by default 1000, or 50 for \
             boundary-integral.",
        ),
        optional(
            "plot",
            Form::Tables(&PLOT),
            "A column of the series, drawn as a PNG file.",
        ),
        optional(
            "slice",
            Form::Tables(&SLICE),
            "A rectangle on which the fluid's velocity and pressure are written as VTI and PNG files \
             with every set of files.",
        ),
        optional(
            "volume",
            Form::Tables(&VOLUME),
            "Velocity and pressure in the whole box of a lattice, written as a VTI file with every set \
             of files.",
        ),
        optional(
            "probe",
            Form::Tables(&PROBE),
            "A point at which the fluid's velocity is written into the series.",
        ),
        optional(
            "rheology",
            Form::Table(&RHEOLOGY),
            "Stress of membranes and walls, relative viscosity, and profiles over the height of the box of a lattice; \
             rheology.csv has their means over the time.",
        ),
    ],
    exactly_one: &[],
    at_most_one: &[&["every", "interval", "strain_interval"]],
    needs: &[],
    kinds: &[],
};

static PLOT: Keys = plain(&[
    required(
        "column",
        Form::Text,
        "The column of series.csv. With several surfaces each has its own column NAME_SURFACE, \
         and NAME stands for all of them.",
    ),
    optional(
        "against",
        Form::Text,
        "The column of the horizontal axis; by default strain if the flow has a rate, else time.",
    ),
    optional(
        "published",
        Form::File,
        "CSV file of curves to draw in the same plot, relative to the scene's folder: a header \
         curve,x,y, then points.",
    ),
]);

static SLICE: Keys = plain(&[
    optional(
        "name",
        Form::Name,
        "The slice's name, and that of its files; by default slice-1, slice-2 and so on.",
    ),
    optional(
        "centre",
        Form::Vector(Dimension::LENGTH),
        "Its centre; by default [0, 0, 0].",
    ),
    required("normal", Form::Direction, "The normal of its plane."),
    required(
        "size",
        Form::Exactly(2, &positive(Dimension::LENGTH)),
        "Lengths of its edges. The first is along x, or along y if the normal is nearer to x than 45°, \
         rotated into the plane; the second is along the vector product of the normal and the first.",
    ),
    required(
        "points",
        Form::Exactly(2, &Form::Count(2)),
        "Number of points along each edge.",
    ),
]);

static VOLUME: Keys = plain(&[
    optional(
        "name",
        Form::Name,
        "The volume's name, and that of its files; by default volume-1, volume-2 and so on.",
    ),
    optional(
        "stride",
        Form::Count(1),
        "Stride along each axis: every stride-th node is written; by default 1.",
    ),
]);

static PROBE: Keys = plain(&[
    optional(
        "name",
        Form::Name,
        "The probe's name; its columns are NAME_x, NAME_y and NAME_z; by default probe-1, probe-2 \
         and so on.",
    ),
    required("point", Form::Vector(Dimension::LENGTH), "Its position."),
]);

static RHEOLOGY: Keys = plain(&[
    optional(
        "stress",
        Form::Switch,
        "Whether the series has the stress of the membranes (particle_stress_xx, …), and that of the walls (wall_stress), \
         the relative viscosity, and in shear the normal stress differences N1 and N2; by default true.",
    ),
    optional(
        "profiles",
        Form::Count(1),
        "Number of slices between the walls at the ends of y; profiles.csv has the mean velocity and the share of the \
         volume that membranes enclose in each; by default there are none.",
    ),
    optional(
        "blocks",
        Form::Count(2),
        "Number of blocks of time from whose means the standard errors follow; by default 10.",
    ),
    optional(
        "skip",
        Form::Number(Dimension::NONE, Range::NotNegative),
        "Strain, the flow's rate times the time, up to which rows are left out of means; by default 0.",
    ),
]);
