//! Keys of a surface and of its mesh.

use super::super::boundary::BOUNDARY;
use super::super::effects;
use super::super::keys::{
    Form, Key, Keys, NUMBER, Range, any, joined, optional, plain, positive, required,
};
use super::super::mesh_source::WELD;
use super::super::remesh::{REMESH, TOPOLOGY};
use super::super::units::Dimension;

pub(super) static SURFACE: Keys = Keys {
    keys: &joined::<{ OWN.len() + effects::KEYS.len() }>(OWN, effects::KEYS),
    ..PLACED
};

/// The keys of a surface, without those of its effects.
const OWN: &[Key] = &[
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
    WELD,
    SCALE,
    POSITION,
    ORIENTATION,
    BOUNDARY,
    REMESH,
    TOPOLOGY,
    VISCOSITY_RATIO,
];

const VISCOSITY_RATIO: Key = optional(
    "viscosity_ratio",
    NUMBER,
    "Ratio λ of the viscosity inside to that of the driver's fluid, which is outside of all \
     surfaces; for drivers with a fluid; by default 1.",
);

/// Rules for the keys of a mesh.
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
        ["weld", "mesh"],
        ["topology", "remesh"],
    ],
    kinds: &[],
};

/// Equal surfaces at random or given places, with the keys of surfaces but those of a single place.
pub(super) static POPULATION: Keys = Keys {
    keys: &joined::<{ CROWD.len() + effects::KEYS.len() }>(CROWD, effects::KEYS),
    exactly_one: &[&["shape", "mesh"], &["count", "haematocrit", "places"]],
    at_most_one: &[&["places", "gap"], &["places", "orientation"]],
    needs: &[
        ["shape", "vertices"],
        ["vertices", "shape"],
        ["family", "shape"],
        ["match_volume", "shape"],
        ["weld", "mesh"],
    ],
    kinds: &[],
};

/// The keys of a population, without those of its effects.
const CROWD: &[Key] = &[
    required(
        "name",
        Form::Name,
        "The population's name. Its surfaces are NAME-1, NAME-2 and so on; the series has their means and standard \
         deviations as NAME_mean_COLUMN and NAME_sd_COLUMN, and surfaces/NAME-*.vtp all of them with the column `cell`.",
    ),
    optional("count", Form::Count(1), "Number of surfaces."),
    optional(
        "haematocrit",
        Form::Number(Dimension::NONE, Range::Positive),
        "Part of the box between its walls, without obstacles, that the surfaces enclose; instead of `count`.",
    ),
    optional(
        "places",
        Form::File,
        "Text file with the place of a surface in each line, instead of random ones: x, y and z of its origin, in the scene's \
         unit of length, and if it is turned an axis of three numbers and an angle in degrees. Titles are a first line of \
         words, and lines that begin with #.",
    ),
    optional(
        "seed",
        Form::Count(0),
        "Seed of the places, and of the families irregular and hard; by default 1.",
    ),
    optional(
        "gap",
        positive(Dimension::LENGTH),
        "Least distance of two surfaces, and of a surface and a wall or obstacle, at the start; by default the spacing of the \
         lattice, or half of the longest cutoff of an interaction if that is more.",
    ),
    optional(
        "orientation",
        Form::Choice(|| vec!["random", "fixed"]),
        "\"random\", any orientation; \"fixed\", that of the mesh. By default random.",
    ),
    optional(
        "per_cell",
        Form::Switch,
        "Whether series-NAME.csv has a row for each surface at each time: the time, the number of the surface as `cell`, and \
         its columns. By default false.",
    ),
    SHAPE,
    FAMILY,
    VERTICES,
    MATCH_VOLUME,
    MESH,
    WELD,
    SCALE,
    VISCOSITY_RATIO,
];

/// A body at rest: its mesh and position, with the same keys as surfaces.
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
        WELD,
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
    "Mesh family, the distribution of vertices; by default smooth.",
);

const VERTICES: Key = optional(
    "vertices",
    Form::Count(1),
    "Number of vertices, at least 12. Meshes with 10·4^k + 2 are the most regular; meshes of the torus \
     have approximately this number.",
);

const SEED: Key = optional(
    "seed",
    Form::Count(0),
    "Seed of the families irregular and hard; by default 1.",
);

const MATCH_VOLUME: Key = optional(
    "match_volume",
    Form::Switch,
    "Whether the mesh, which is inscribed in the shape, is scaled so that it encloses the shape's \
     volume; by default false.",
);

const MESH: Key = optional(
    "mesh",
    Form::File,
    "OBJ, OFF, STL, PLY, VTP, VTU, VTK, glTF, MSH, GIFTI or 3MF file, relative to the scene's folder, such as the `last.vtp` of a run; \
     its coordinates are in the scene's unit of length.",
);

const SCALE: Key = optional(
    "scale",
    NUMBER,
    "Factor by which the mesh is scaled; by default 1.",
);

const POSITION: Key = optional(
    "position",
    Form::Vector(Dimension::LENGTH),
    "Position of the mesh's origin; by default [0, 0, 0].",
);

const ORIENTATION: Key = optional(
    "orientation",
    Form::Table(&ROTATION),
    "Rotation of the mesh about its origin, before it is moved.",
);

static ROTATION: Keys = plain(&[
    required("axis", Form::Direction, "Axis of the rotation."),
    required(
        "angle",
        any(Dimension::NONE),
        "Angle in degrees, right-handed about the axis.",
    ),
]);
