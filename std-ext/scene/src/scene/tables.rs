//! The table of all keys of a scene.

mod output;
mod surface;

use super::drivers::DRIVER;
use super::keys::{
    Form, Key, Keys, Kind, NUMBER, count_of, kinds, of_kinds, optional, plain, positive, required,
};
use super::units::Dimension;
use output::OUTPUT;
use surface::{OBSTACLE, POPULATION, SURFACE};

pub(super) static SCENE: Keys = plain(&[
    optional("title", Form::Text, "Description of the scene in one line."),
    required(
        "units",
        Form::Choice(|| vec!["micro", "none"]),
        "Units of plain numbers: \"micro\" is µm, pN and s, hence pN·µm = 1e-18 J, pN/µm = µN/m, \
         pN/µm² = Pa; \"none\" is numbers without units.",
    ),
    optional(
        "temperature",
        NUMBER,
        "Temperature in kelvin, for numbers with the unit kT; by default 298.15.",
    ),
    optional(
        "surface",
        Form::Tables(&SURFACE),
        "A surface and the effects that act on it; absent effects are off.",
    ),
    optional(
        "population",
        Form::Tables(&POPULATION),
        "Equal surfaces at random or given places in the box of the driver \"lattice-boltzmann\", and the effects that act on \
         each; together at least one surface is needed.",
    ),
    optional(
        "interaction",
        Form::Tables(&INTERACTION),
        "What acts between surfaces.",
    ),
    optional(
        "obstacle",
        Form::Tables(&OBSTACLE),
        "A closed body at rest: in a fluid, which does not slip on it, or one that an interaction keeps surfaces away from, \
         with the driver \"relax\".",
    ),
    required(
        "driver",
        Form::Table(&DRIVER),
        "Driver that moves the surfaces, and the end of the run.",
    ),
    optional(
        "output",
        Form::Table(&OUTPUT),
        "Outputs and their intervals.",
    ),
]);

const CUTOFF: Key = required(
    "cutoff",
    positive(Dimension::LENGTH),
    "Distance r_c beyond which there is no force: a few node spacings on a lattice, and less \
     than the gaps of interest.",
);

const BETWEEN: Key = optional(
    "between",
    Form::Pair,
    "Names of two surfaces or populations, or of one and an obstacle; by default every pair of surfaces interacts, in a \
     periodic box every surface with its own images, and, but on a lattice, every surface with every obstacle. \
     Surfaces of a population interact with the other one that is named, not with each other. If both names are the \
     same, a surface interacts with itself only: with its own images, and with `parts`; surfaces of a population \
     with each other, too.",
);

const PARTS: Key = optional(
    "parts",
    Form::Switch,
    "Whether parts of one surface act on each other, too, where they face each other: where the normal of one points to \
     the other within 30°, less up to 60°. A surface whose radii of curvature exceed the cutoff feels nothing of itself \
     where it is not folded. By default false.",
);

const INTERACTIONS: &[Kind] = &[
    Kind {
        name: "repulsion",
        keys: &[
            required(
                "strength",
                positive(Dimension::REPULSION),
                "k in the energy per area w(d) = k r_c²/4 (1 − s²)³/s² of surfaces at a distance d, s = \
         d/r_c. The pressure k r_c/2 (1 − s²)² (1 + 2s²)/s³ grows without bound as surfaces \
         approach each other. If k r_c is about the applied pressure, they rest at two thirds of \
         r_c.",
            ),
            CUTOFF,
            BETWEEN,
            PARTS,
        ],
        exactly_one: &[],
    },
    Kind {
        name: "adhesion",
        keys: &[
            required(
                "energy",
                positive(Dimension::TENSION),
                "W, the energy per area that surfaces gain at their distance of rest.",
            ),
            required(
                "distance",
                positive(Dimension::LENGTH),
                "Distance d at which surfaces rest, below the cutoff; nearer they repel each other without bound.",
            ),
            CUTOFF,
            BETWEEN,
            PARTS,
        ],
        exactly_one: &[],
    },
];

static INTERACTION: Keys = Keys {
    keys: &of_kinds::<{ 1 + count_of(INTERACTIONS) }>(
        required(
            "kind",
            Form::Choice(|| kinds(&INTERACTION)),
            "\"repulsion\"; \"adhesion\", attraction with a distance of rest.",
        ),
        INTERACTIONS,
    ),
    exactly_one: &[],
    at_most_one: &[],
    needs: &[],
    kinds: INTERACTIONS,
};
