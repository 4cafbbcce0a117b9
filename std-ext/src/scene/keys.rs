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

impl Keys {
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
    }
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
            "Viscosity inside over viscosity outside; for drivers with a flow.",
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
    ],
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
pub(super) const LATER_DRIVERS: [&str; 2] = ["boundary-integral", "lattice-boltzmann"];

static DRIVER: Keys = plain(&[
    required(
        "kind",
        Form::Choice(|| vec!["relax"]),
        "The driver: \"relax\" goes to an equilibrium, and knows no time.",
    ),
    optional(
        "scheme",
        Form::Choice(|| vec!["auto", "minimise", "overdamped"]),
        "\"minimise\" for methods with an energy, \"overdamped\" for all; \"auto\", the default, \
         minimises where it can.",
    ),
    optional(
        "residual",
        NUMBER,
        "The run ends when the root mean square of the force per area that is left, in units of \
         κ/R³ + K/R with K the largest modulus in the plane and 4πR² = A, is smaller; by default \
         1e-5.",
    ),
    optional(
        "iterations",
        Form::Count(1),
        "The run ends after as many iterations in any case; by default 10000.",
    ),
    optional(
        "redistribution",
        Form::Either(&[Form::Switch, Form::Choice(|| vec!["auto"])]),
        "Whether vertices of fluid surfaces are moved along the surface to keep the mesh even; by \
         default \"auto\": wherever a surface is fluid.",
    ),
]);

static OUTPUT: Keys = plain(&[
    optional(
        "every",
        Form::Count(1),
        "Iterations from one row of the series to the next, and from one set of files to the next; \
         by default 100.",
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
        "Iterations from one checkpoint to the next; by default 1000.",
    ),
]);
