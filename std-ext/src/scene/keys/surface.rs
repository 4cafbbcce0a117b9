//! Keys of a surface and of its effects.

use super::super::units::Dimension;
use super::{Form, Key, Keys, NUMBER, Range, any, optional, plain, positive, required};
use crate::method::BendingMethod;

pub(super) static SURFACE: Keys = Keys {
    keys: &[
        optional(
            "name",
            Form::Name,
            "The surface's name; by default surface-1, surface-2 and so on.",
        ),
        SHAPE,
        FAMILY,
        VERTICES,
        SEED,
        MATCH_VOLUME,
        MESH,
        SCALE,
        POSITION,
        ORIENTATION,
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
    ..PLACED
};

/// What holds of the keys of a mesh.
const PLACED: Keys = Keys {
    keys: &[],
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

/// A body at rest: its mesh and where that is put, as surfaces have them.
pub(super) static OBSTACLE: Keys = Keys {
    keys: &[
        optional(
            "name",
            Form::Name,
            "The obstacle's name; by default obstacle-1, obstacle-2 and so on.",
        ),
        SHAPE,
        FAMILY,
        VERTICES,
        SEED,
        MATCH_VOLUME,
        MESH,
        SCALE,
        POSITION,
        ORIENTATION,
    ],
    ..PLACED
};

const SHAPE: Key = optional(
    "shape",
    Form::Shape,
    "Exact shape on which a mesh is generated, with its lengths: sphere:R, ellipsoid:a,b,c, \
     torus:R,r or discocyte:R.",
);

const FAMILY: Key = optional(
    "family",
    Form::Choice(|| {
        crate::generate::Family::ALL
            .map(|family| family.name())
            .to_vec()
    }),
    "How vertices are spread over the shape; by default smooth.",
);

const VERTICES: Key = optional(
    "vertices",
    Form::Count(1),
    "How many vertices are generated: 10·4^k + 2, but for irregular meshes and the torus.",
);

const SEED: Key = optional(
    "seed",
    Form::Count(0),
    "Seed of the families irregular and hard; by default 1.",
);

const MATCH_VOLUME: Key = optional(
    "match_volume",
    Form::Switch,
    "Whether the mesh is scaled so that it encloses the shape's volume, and not that of a \
     polyhedron inscribed in it; by default false.",
);

const MESH: Key = optional(
    "mesh",
    Form::File,
    "OBJ, OFF, STL or PLY file, relative to the scene's folder; its coordinates are in the \
     scene's unit of length.",
);

const SCALE: Key = optional(
    "scale",
    NUMBER,
    "Factor by which the mesh is scaled; by default 1.",
);

const POSITION: Key = optional(
    "position",
    Form::Vector(Dimension::LENGTH),
    "Where the mesh's origin is put; by default [0, 0, 0].",
);

const ORIENTATION: Key = optional(
    "orientation",
    Form::Table(&ROTATION),
    "How the mesh is turned about its origin, before it is moved.",
);

static ROTATION: Keys = plain(&[
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
