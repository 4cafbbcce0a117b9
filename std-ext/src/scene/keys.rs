//! The one table of a scene's keys: their forms, dimensions, ranges and what they mean.

use super::problem::Problem;
use super::units::Dimension;
use crate::method::BendingMethod;

/// The keys of a table.
#[derive(Debug)]
pub(super) struct Keys {
    pub(super) keys: &'static [Key],
    /// Of each group exactly one key is given.
    pub(super) exactly_one: &'static [&'static [&'static str]],
    /// Of each group one key at most is given.
    pub(super) at_most_one: &'static [&'static [&'static str]],
    /// The first key needs the second.
    pub(super) needs: &'static [[&'static str; 2]],
    /// What further rules follow from the table's key `kind`.
    pub(super) kinds: &'static [Kind],
}

/// Keys that a table has if its `kind` is this one. Keys that no kind names belong to all.
#[derive(Debug)]
pub(super) struct Kind {
    pub(super) name: &'static str,
    pub(super) required: &'static [&'static str],
    pub(super) optional: &'static [&'static str],
    /// As [`Keys::exactly_one`]; these keys are optional ones.
    pub(super) exactly_one: &'static [&'static [&'static str]],
}

/// A key.
#[derive(Debug)]
pub(super) struct Key {
    pub(super) name: &'static str,
    pub(super) form: Form,
    pub(super) presence: Presence,
    /// What it means, as it stands in the schema.
    pub(super) summary: &'static str,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Presence {
    Required,
    Optional,
}

/// What a value has to be.
#[derive(Debug)]
pub(super) enum Form {
    /// Any text.
    Text,
    /// A letter, then letters, digits, `-` and `_`.
    Name,
    /// The name of a file.
    File,
    /// An exact shape.
    Shape,
    /// One of these names.
    Choice(fn() -> Vec<&'static str>),
    /// A number, plain or with a unit.
    Number(Dimension, Range),
    /// One number, or a list of one or more.
    Numbers(Dimension, Range),
    /// A whole number from 0 or 1 on.
    Count(u64),
    /// true or false.
    Switch,
    /// Three numbers.
    Vector(Dimension),
    /// Three numbers that are not all 0.
    Direction,
    /// Two names of surfaces.
    Pair,
    /// As many values of a form.
    Exactly(usize, &'static Form),
    /// A table.
    Table(&'static Keys),
    /// A list of tables.
    Tables(&'static Keys),
    /// A value of one of two forms that TOML tells apart.
    Either(&'static [Form; 2]),
}

/// Which numbers are allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Range {
    Any,
    /// Other than 0.
    NotZero,
    /// Above 0.
    Positive,
    /// 0 or above.
    NotNegative,
    /// Above 0, 1 at most.
    Fraction,
    /// Above 0, 0.5 at most.
    Half,
    /// Above this.
    Above(f64),
}

impl Range {
    pub(super) fn contains(self, value: f64) -> bool {
        match self {
            Self::Any => true,
            Self::NotZero => value != 0.0,
            Self::Positive => value > 0.0,
            Self::NotNegative => value >= 0.0,
            Self::Fraction => value > 0.0 && value <= 1.0,
            Self::Half => value > 0.0 && value <= 0.5,
            Self::Above(least) => value > least,
        }
    }

    /// In words, behind `a number`.
    pub(super) fn words(self) -> String {
        match self {
            Self::Any => "of any size".to_owned(),
            Self::NotZero => "other than 0".to_owned(),
            Self::Positive => "above 0".to_owned(),
            Self::NotNegative => "of 0 or above".to_owned(),
            Self::Fraction => "above 0 and at most 1".to_owned(),
            Self::Half => "above 0 and at most 0.5".to_owned(),
            Self::Above(least) => format!("above {least}"),
        }
    }
}

impl Form {
    /// The keys, if a table may stand here.
    pub(super) fn table(&self) -> Option<&'static Keys> {
        match self {
            Self::Table(keys) => Some(keys),
            Self::Either(forms) => forms.iter().find_map(Self::table),
            _ => None,
        }
    }
}

impl Kind {
    pub(super) fn has(&self, name: &str) -> bool {
        self.required.contains(&name) || self.optional.contains(&name)
    }
}

impl Keys {
    /// The kinds that have a key; none if all have it.
    pub(super) fn kinds_with(&self, name: &str) -> Vec<&'static str> {
        let kinds = self.kinds.iter().filter(|kind| kind.has(name));
        kinds.map(|kind| kind.name).collect()
    }

    pub(super) fn find(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }

    /// What is wrong with a key that is not among them.
    pub(super) fn unknown(&self, around: &str, key: &str) -> Problem {
        let known = Vec::from_iter(self.keys.iter().map(|key| key.name));
        Problem::UnknownKey {
            table: around.to_owned(),
            key: key.to_owned(),
            nearest: nearest(key, &known),
            known: known.join(", "),
        }
    }
}

/// The name that was probably meant, if one is near.
pub(super) fn nearest(name: &str, known: &[&str]) -> Option<String> {
    let name = name.to_lowercase();
    let distance = |known: &str| strsim::damerau_levenshtein(&name, &known.to_lowercase());
    let best = known.iter().min_by_key(|known| distance(known))?;
    // A part of a long name is a guess as good as a wrong letter.
    let part = |known: &&&str| name.len() >= 3 && known.to_lowercase().contains(&name);
    let near = |known: &&str| distance(known) <= 1 + name.chars().count().min(known.len()) / 4;
    if near(best) {
        return Some((*best).to_owned());
    }
    known.iter().find(part).map(|known| (*known).to_owned())
}

const fn required(name: &'static str, form: Form, summary: &'static str) -> Key {
    Key {
        name,
        form,
        presence: Presence::Required,
        summary,
    }
}

const fn optional(name: &'static str, form: Form, summary: &'static str) -> Key {
    Key {
        name,
        form,
        presence: Presence::Optional,
        summary,
    }
}

const fn plain(keys: &'static [Key]) -> Keys {
    Keys {
        keys,
        exactly_one: &[],
        at_most_one: &[],
        needs: &[],
        kinds: &[],
    }
}

/// The names of the kinds of a table, as its key `kind` has them.
fn kinds(keys: &Keys) -> Vec<&'static str> {
    keys.kinds.iter().map(|kind| kind.name).collect()
}

const NUMBER: Form = Form::Number(Dimension::NONE, Range::Positive);

const fn positive(dimension: Dimension) -> Form {
    Form::Number(dimension, Range::Positive)
}

const fn any(dimension: Dimension) -> Form {
    Form::Number(dimension, Range::Any)
}

pub(super) static SCENE: Keys = plain(&[
    optional("title", Form::Text, "What the scene is, in a line."),
    required(
        "units",
        Form::Choice(|| vec!["micro", "none"]),
        "Units of plain numbers: \"micro\" is µm, pN and s, hence pN·µm = 1e-18 J, pN/µm = µN/m, \
         pN/µm² = Pa; \"none\" is numbers without units.",
    ),
    required(
        "surface",
        Form::Tables(&SURFACE),
        "A surface and the effects that act on it; what is absent is off.",
    ),
    optional(
        "interaction",
        Form::Tables(&INTERACTION),
        "What acts between surfaces.",
    ),
    required(
        "driver",
        Form::Table(&DRIVER),
        "What moves the surfaces, and when the run ends.",
    ),
    optional(
        "output",
        Form::Table(&OUTPUT),
        "What is written, and how often.",
    ),
]);

static SURFACE: Keys = Keys {
    keys: &[
        optional(
            "name",
            Form::Name,
            "The surface's name; by default surface-1, surface-2 and so on.",
        ),
        optional(
            "shape",
            Form::Shape,
            "Exact shape on which a mesh is generated, with its lengths: sphere:R, ellipsoid:a,b,c, \
             torus:R,r or discocyte:R.",
        ),
        optional(
            "family",
            Form::Choice(|| {
                crate::generate::Family::ALL
                    .map(|family| family.name())
                    .to_vec()
            }),
            "How vertices are spread over the shape; by default smooth.",
        ),
        optional(
            "vertices",
            Form::Count(1),
            "How many vertices are generated: 10·4^k + 2, but for irregular meshes and the torus.",
        ),
        optional(
            "seed",
            Form::Count(0),
            "Seed of the families irregular and hard; by default 1.",
        ),
        optional(
            "match_volume",
            Form::Switch,
            "Whether the mesh is scaled so that it encloses the shape's volume, and not that of a \
             polyhedron inscribed in it; by default false.",
        ),
        optional(
            "mesh",
            Form::File,
            "OBJ, OFF, STL or PLY file, relative to the scene's folder; its coordinates are in the \
             scene's unit of length.",
        ),
        optional(
            "scale",
            NUMBER,
            "Factor by which the mesh is scaled; by default 1.",
        ),
        optional(
            "position",
            Form::Vector(Dimension::LENGTH),
            "Where the mesh's origin is put; by default [0, 0, 0].",
        ),
        optional(
            "orientation",
            Form::Table(&ORIENTATION),
            "How the mesh is turned about its origin, before it is moved.",
        ),
        optional(
            "viscosity_ratio",
            NUMBER,
            "Viscosity inside over viscosity outside, λ; for drivers with a fluid; by default 1.",
        ),
        optional(
            "bending",
            Form::Table(&BENDING),
            "Bending, E = 2κ ∫ (H − H0)² dS.",
        ),
        optional(
            "elasticity",
            Form::Table(&ELASTICITY),
            "Elasticity in the surface's plane, over a reference without stress.",
        ),
        optional(
            "area",
            Form::Table(&AREA),
            "Total area, held exactly or by a penalty E = k/2 (A − A0)²/A0.",
        ),
        optional(
            "local_area",
            Form::Table(&LOCAL_AREA),
            "Area of each triangle, held by a penalty E = k/2 Σ (A − A0)²/A0.",
        ),
        optional(
            "volume",
            Form::Table(&VOLUME),
            "Enclosed volume, held exactly or by a penalty E = k/2 (V − V0)²/V0.",
        ),
        optional(
            "area_difference",
            Form::Table(&AREA_DIFFERENCE),
            "Difference of the leaflets' areas by M = ∫H dS, held exactly (bilayer coupling) or by a \
             penalty E = 2π k (M − M0)²/A.",
        ),
        optional(
            "tension",
            Form::Table(&TENSION),
            "Surface tension, E = σ A.",
        ),
        optional(
            "pressure",
            Form::Table(&PRESSURE),
            "Osmotic pressure, E = −Δp V.",
        ),
        optional(
            "gravity",
            Form::Table(&GRAVITY),
            "Weight of what is inside, less that of what it displaces.",
        ),
        optional(
            "membrane_viscosity",
            Form::Table(&MEMBRANE_VISCOSITY),
            "Viscosity of the membrane; for drivers with a time.",
        ),
        optional(
            "stretching",
            Form::Table(&STRETCHING),
            "Opposite forces spread over the vertices at the surface's two ends, as by optical \
             tweezers (Mills et al. 2004).",
        ),
    ],
    exactly_one: &[&["shape", "mesh"]],
    at_most_one: &[],
    needs: &[
        ["shape", "vertices"],
        ["vertices", "shape"],
        ["family", "shape"],
        ["seed", "shape"],
        ["match_volume", "shape"],
    ],
    kinds: &[],
};

static ORIENTATION: Keys = plain(&[
    required("axis", Form::Direction, "Axis of the rotation."),
    required(
        "angle",
        any(Dimension::NONE),
        "Angle in degrees, right-handed about the axis.",
    ),
]);

fn methods() -> Vec<&'static str> {
    let all = || BendingMethod::ALL.into_iter().chain([BendingMethod::Jet]);
    let names = all().map(BendingMethod::name);
    names
        .chain(all().filter_map(BendingMethod::letter))
        .collect()
}

static BENDING: Keys = plain(&[
    required(
        "method",
        Form::Choice(methods),
        "The bending method, by its name or letter.",
    ),
    required("modulus", positive(Dimension::ENERGY), "Bending modulus κ."),
    optional(
        "spontaneous_curvature",
        any(Dimension::CURVATURE),
        "Spontaneous curvature H0 = c0/2, positive on a sphere; by default 0.",
    ),
]);

static ELASTICITY: Keys = plain(&[
    required(
        "law",
        Form::Choice(|| vec!["neo-hookean", "skalak"]),
        "The law of in-plane elasticity.",
    ),
    required(
        "shear_modulus",
        positive(Dimension::TENSION),
        "Shear modulus G; E_s = 3 G where an article gives that.",
    ),
    optional(
        "area_ratio",
        Form::Number(Dimension::NONE, Range::Above(-0.5)),
        "C of Skalak's law, whose area modulus is (1 + 2 C) G; for Skalak's law only, which needs it.",
    ),
    optional(
        "reference",
        REFERENCE_FORM,
        "Where the surface is without stress: \"initial\", as by default, or a table.",
    ),
]);

const REFERENCE_FORM: Form =
    Form::Either(&[Form::Choice(|| vec!["initial"]), Form::Table(&REFERENCE)]);

static REFERENCE: Keys = Keys {
    keys: &[
        optional(
            "shape",
            Form::Shape,
            "The surface's mesh on another exact shape, with its family, vertices and seed.",
        ),
        optional(
            "mesh",
            Form::File,
            "Mesh file with the triangles of the surface, relative to the scene's folder.",
        ),
        optional(
            "scale",
            NUMBER,
            "Factor by which the reference is scaled; by default 1. The initial surface is scaled if \
             neither shape nor mesh is given.",
        ),
    ],
    exactly_one: &[],
    at_most_one: &[&["shape", "mesh"]],
    needs: &[],
    kinds: &[],
};

const CONSTRAINT: Key = optional(
    "constraint",
    Form::Choice(|| vec!["exact"]),
    "\"exact\": held as a constraint, instead of by a modulus.",
);

static AREA: Keys = Keys {
    keys: &[
        CONSTRAINT,
        optional(
            "modulus",
            positive(Dimension::TENSION),
            "Modulus k of the penalty, instead of a constraint.",
        ),
        optional(
            "target",
            Form::Either(&[Form::Choice(|| vec!["initial"]), positive(Dimension::AREA)]),
            "Area of each connected component: \"initial\", as by default, or a number.",
        ),
    ],
    exactly_one: &[&["constraint", "modulus"]],
    at_most_one: &[],
    needs: &[],
    kinds: &[],
};

static LOCAL_AREA: Keys = plain(&[
    required(
        "modulus",
        positive(Dimension::TENSION),
        "Modulus k of the penalty.",
    ),
    optional(
        "reference",
        REFERENCE_FORM,
        "Where the triangles' areas are measured: \"initial\", as by default, or a table.",
    ),
]);

static VOLUME: Keys = Keys {
    keys: &[
        CONSTRAINT,
        optional(
            "modulus",
            positive(Dimension::PRESSURE),
            "Modulus k of the penalty, instead of a constraint.",
        ),
        optional(
            "target",
            Form::Either(&[
                Form::Choice(|| vec!["initial"]),
                positive(Dimension::VOLUME),
            ]),
            "Volume of each connected component: \"initial\", as by default, or a number.",
        ),
        optional(
            "reduced",
            Form::Number(Dimension::NONE, Range::Fraction),
            "Target as reduced volume v = 6√π V/A^(3/2), with the target area or, if the area is not \
             held, the initial one; instead of target.",
        ),
    ],
    exactly_one: &[&["constraint", "modulus"]],
    at_most_one: &[&["target", "reduced"]],
    needs: &[],
    kinds: &[],
};

static AREA_DIFFERENCE: Keys = Keys {
    keys: &[
        CONSTRAINT,
        optional(
            "modulus",
            positive(Dimension::ENERGY),
            "Modulus k of the penalty, instead of a constraint.",
        ),
        optional(
            "target",
            Form::Either(&[Form::Choice(|| vec!["initial"]), any(Dimension::LENGTH)]),
            "∫H dS of each connected component: \"initial\", as by default, or a number.",
        ),
        optional(
            "reduced",
            any(Dimension::NONE),
            "Target as ∫H dS/√(4πA), 1 for a sphere, with the target area or, if the area is not \
             held, the initial one; instead of target.",
        ),
    ],
    exactly_one: &[&["constraint", "modulus"]],
    at_most_one: &[&["target", "reduced"]],
    needs: &[],
    kinds: &[],
};

static TENSION: Keys = plain(&[required(
    "value",
    any(Dimension::TENSION),
    "Surface tension σ.",
)]);

static PRESSURE: Keys = plain(&[required(
    "value",
    any(Dimension::PRESSURE),
    "Pressure inside minus pressure outside, Δp.",
)]);

static GRAVITY: Keys = plain(&[
    required(
        "density_difference",
        any(Dimension::DENSITY),
        "Mass density inside minus outside.",
    ),
    required(
        "acceleration",
        Form::Vector(Dimension::ACCELERATION),
        "Gravitational acceleration, pointing down.",
    ),
]);

static MEMBRANE_VISCOSITY: Keys = plain(&[
    required(
        "shear",
        Form::Number(Dimension::SURFACE_VISCOSITY, Range::NotNegative),
        "Shear viscosity of the membrane.",
    ),
    optional(
        "dilational",
        Form::Number(Dimension::SURFACE_VISCOSITY, Range::NotNegative),
        "Dilational viscosity of the membrane; by default 0.",
    ),
]);

static STRETCHING: Keys = plain(&[
    required("axis", Form::Direction, "Direction of the forces."),
    required(
        "force",
        Form::Numbers(Dimension::FORCE, Range::NotNegative),
        "Total force on each end; a list is a sequence of them, each from the equilibrium under the \
         one before it.",
    ),
    optional(
        "fraction",
        Form::Number(Dimension::NONE, Range::Half),
        "Fraction of the vertices over which the force on an end is spread; by default 0.05.",
    ),
]);

static INTERACTION: Keys = plain(&[
    required(
        "kind",
        Form::Choice(|| vec!["repulsion"]),
        "What the surfaces do to each other.",
    ),
    required(
        "strength",
        positive(Dimension::REPULSION),
        "Energy per area of both surfaces where they meet: k in E = ∫∫ k (1 − r²/r_c²)³ dS dS.",
    ),
    required(
        "cutoff",
        positive(Dimension::LENGTH),
        "Distance r_c from which on there is no force; edges need half of it or less.",
    ),
    optional(
        "between",
        Form::Pair,
        "Names of two surfaces; by default every pair interacts.",
    ),
]);

/// The drivers there will be, none of which a scene can have yet.
pub(super) const LATER_DRIVERS: [&str; 1] = ["lattice-boltzmann"];

/// The drivers there are.
pub(super) fn drivers() -> Vec<&'static str> {
    kinds(&DRIVER)
}

static DRIVER: Keys = Keys {
    keys: &[
        required(
            "kind",
            Form::Choice(drivers),
            "The driver: \"relax\" goes to an equilibrium, and knows no time; \"boundary-integral\" \
             moves membranes in Stokes flow without walls.",
        ),
        optional(
            "scheme",
            Form::Choice(|| vec!["auto", "minimise", "overdamped"]),
            "\"minimise\" for methods with an energy, \"overdamped\" for all; \"auto\", the \
             default, minimises where it can.",
        ),
        optional(
            "residual",
            NUMBER,
            "The run ends when the root mean square of the force per area that is left, in units \
             of κ/R³ + K/R with K the largest modulus in the plane and 4πR² = A, is smaller; by \
             default 1e-5.",
        ),
        optional(
            "iterations",
            Form::Count(1),
            "The run ends after as many iterations in any case; by default 10000.",
        ),
        optional(
            "redistribution",
            Form::Either(&[Form::Switch, Form::Choice(|| vec!["auto"])]),
            "Whether vertices of fluid surfaces are moved along the surface to keep the mesh even; \
             by default \"auto\": wherever a surface is fluid.",
        ),
        optional(
            "viscosity",
            positive(Dimension::VISCOSITY),
            "Viscosity μ of the fluid outside the surfaces.",
        ),
        optional(
            "flow",
            Form::Table(&FLOW),
            "The flow that there would be without surfaces; by default the fluid is at rest.",
        ),
        optional(
            "duration",
            positive(Dimension::TIME),
            "Time at which the run ends.",
        ),
        optional(
            "strain",
            NUMBER,
            "Strain at which the run ends, the flow's rate times the time, instead of duration. \
             Rates: γ̇ of a shear, ε̇ of an extension, √(2 E:E) of a linear flow with E the symmetric \
             part of its gradient, 2U/R of a Poiseuille flow.",
        ),
        optional(
            "integrator",
            Form::Choice(|| vec!["auto", "rkc2", "bs23", "rk4"]),
            "\"rkc2\" where bending limits the step, \"bs23\" where it does not, \"rk4\" for fixed \
             steps; \"auto\", the default, is rkc2 if a surface bends and else bs23.",
        ),
        optional(
            "step",
            positive(Dimension::TIME),
            "Step of rk4, which needs it; the others choose theirs by the tolerance.",
        ),
        optional(
            "tolerance",
            NUMBER,
            "Error allowed in a step, relative to the size of the surfaces; by default 1e-4.",
        ),
        optional(
            "volume_correction",
            Form::Switch,
            "Whether the volume of each closed surface is kept to rounding, instead of to the error \
             of the mesh and the steps; by default true.",
        ),
    ],
    exactly_one: &[],
    at_most_one: &[],
    needs: &[],
    kinds: &[
        Kind {
            name: "relax",
            required: &[],
            optional: &["scheme", "residual", "iterations", "redistribution"],
            exactly_one: &[],
        },
        Kind {
            name: "boundary-integral",
            required: &["viscosity"],
            optional: &[
                "flow",
                "duration",
                "strain",
                "integrator",
                "step",
                "tolerance",
                "volume_correction",
            ],
            exactly_one: &[&["duration", "strain"]],
        },
    ],
};

const RATE: Form = Form::Number(Dimension::RATE, Range::NotZero);

static FLOW: Keys = Keys {
    keys: &[
        required(
            "kind",
            Form::Choice(|| kinds(&FLOW)),
            "\"quiescent\"; \"shear\", u = (γ̇ y, 0, 0); \"extension\", u = ε̇ (x, −y/2, −z/2); \
             \"plane-extension\", u = ε̇ (x, −y, 0); \"linear\", u = L·x; \"poiseuille\", \
             u = U (1 − ρ²/R²) along an axis, ρ the distance from it.",
        ),
        optional("rate", RATE, "Shear rate γ̇ or rate of extension ε̇."),
        optional(
            "gradient",
            Form::Exactly(3, &Form::Exactly(3, &any(Dimension::RATE))),
            "Velocity gradient L, row by row: [[∂u/∂x, ∂u/∂y, ∂u/∂z], [∂v/∂x, …], …]; its trace is 0.",
        ),
        optional(
            "centre_velocity",
            Form::Number(Dimension::VELOCITY, Range::NotZero),
            "Velocity U on the axis.",
        ),
        optional(
            "radius",
            positive(Dimension::LENGTH),
            "Radius R of the tube of this flow. There are no walls: the flow turns round beyond it.",
        ),
        optional("direction", Form::Direction, "Direction of axis and flow."),
        optional(
            "through",
            Form::Vector(Dimension::LENGTH),
            "A point of the axis; by default [0, 0, 0].",
        ),
    ],
    exactly_one: &[],
    at_most_one: &[],
    needs: &[],
    kinds: &[
        no_keys("quiescent"),
        with_rate("shear"),
        with_rate("extension"),
        with_rate("plane-extension"),
        Kind {
            required: &["gradient"],
            ..no_keys("linear")
        },
        Kind {
            required: &["centre_velocity", "radius", "direction"],
            optional: &["through"],
            ..no_keys("poiseuille")
        },
    ],
};

const fn no_keys(name: &'static str) -> Kind {
    Kind {
        name,
        required: &[],
        optional: &[],
        exactly_one: &[],
    }
}

const fn with_rate(name: &'static str) -> Kind {
    Kind {
        required: &["rate"],
        ..no_keys(name)
    }
}

static OUTPUT: Keys = Keys {
    keys: &[
        optional(
            "every",
            Form::Count(1),
            "Iterations from one row of the series to the next, and from one set of files to the \
             next, of drivers without time; by default 100.",
        ),
        optional(
            "interval",
            positive(Dimension::TIME),
            "The same as a time, of drivers with time; by default a hundredth of the duration.",
        ),
        optional(
            "strain_interval",
            NUMBER,
            "The same as a strain, the flow's rate times the time.",
        ),
        optional(
            "surfaces",
            Form::Switch,
            "Whether surfaces are written as VTP files; by default true.",
        ),
        optional(
            "pictures",
            Form::Switch,
            "Whether pictures are written as PNG files; by default true.",
        ),
        optional(
            "picture_field",
            Form::Choice(|| vec!["mean-curvature", "gaussian-curvature", "bending-force"]),
            "What the pictures' colours show; by default mean-curvature.",
        ),
        optional(
            "checkpoint_every",
            Form::Count(1),
            "Iterations, or steps in time, from one checkpoint to the next; by default 1000 \
             iterations or 50 steps.",
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
             at every output.",
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
        "The column of series.csv. Of several surfaces each has its own, NAME_SURFACE: NAME alone is \
         all of them.",
    ),
    optional(
        "against",
        Form::Text,
        "The column of the horizontal axis; by default strain if the flow has a rate, else time.",
    ),
    optional(
        "published",
        Form::File,
        "CSV file of curves to draw beside it, relative to the scene's folder: a head curve,x,y, \
         then points.",
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
        "Lengths of its edges. The first is along x, or along y where the normal is nearer to x than \
         45°, turned into the plane; the second along the normal times the first.",
    ),
    required(
        "points",
        Form::Exactly(2, &Form::Count(2)),
        "Number of points along each edge.",
    ),
]);
