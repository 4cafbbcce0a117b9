//! Keys of the driver and of its flow.

use super::super::units::Dimension;
use super::{Form, Keys, Kind, NUMBER, Range, any, kinds, optional, positive, required};

pub(super) static DRIVER: Keys = Keys {
    keys: &[
        required(
            "kind",
            Form::Choice(|| kinds(&DRIVER)),
            "The driver: \"relax\" finds an equilibrium, without time; \"boundary-integral\" \
             moves membranes in Stokes flow without walls; \"lattice-boltzmann\" in a box of \
             fluid, with or without inertia, walls and obstacles.",
        ),
        optional(
            "scheme",
            Form::Choice(|| vec!["auto", "minimise", "overdamped"]),
            "\"minimise\" for methods with an energy, \"overdamped\" for all; \"auto\", the \
             default, minimises if all methods have an energy.",
        ),
        optional(
            "residual",
            NUMBER,
            "The run ends when the root mean square of the remaining force per area is below \
             this, in units of κ/R³ + K/R with K the largest in-plane modulus and 4πR² = A; by \
             default 1e-5.",
        ),
        optional(
            "iterations",
            Form::Count(1),
            "Largest number of iterations; by default 10000.",
        ),
        optional(
            "redistribution",
            Form::Either(&[Form::Switch, Form::Choice(|| vec!["auto"])]),
            "Whether vertices of fluid surfaces are moved along the surface to keep the mesh even; \
             by default \"auto\": wherever a surface is fluid, without elasticity and local_area, and \
             in a flow without stretching.",
        ),
        optional(
            "energy_error",
            NUMBER,
            "Largest relative error of the energy of each closed surface with bending, estimated \
             by jets of degree 6 on the same vertices; by default 0.01. With a larger error the \
             run ends as unresolved instead of converged.",
        ),
        optional(
            "viscosity",
            positive(Dimension::VISCOSITY),
            "Viscosity μ of the fluid outside the surfaces.",
        ),
        optional(
            "flow",
            Form::Table(&FLOW),
            "The undisturbed flow, without surfaces; by default the fluid is at rest.",
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
             part of its gradient, 2U/R of a Poiseuille flow, 4U/H of a channel.",
        ),
        optional(
            "integrator",
            Form::Choice(|| vec!["auto", "rkc2", "bs23", "rk4"]),
            "\"rkc2\" where bending or surface tension limits the step, \"bs23\" where they do not, \
             \"rk4\" for fixed steps; \"auto\", the default, is rkc2 if a surface bends or has a tension \
             and else bs23.",
        ),
        optional(
            "step",
            positive(Dimension::TIME),
            "Step of rk4, which requires it; refused if it is not stable at the start of the run. \
             Other integrators choose their steps by the tolerance. Step of a lattice: by default \
             the longest that compressibility, inertia and membranes allow.",
        ),
        optional(
            "tolerance",
            NUMBER,
            "Error tolerance of a step, relative to the size of the surfaces; by default 1e-4.",
        ),
        optional(
            "volume_correction",
            Form::Switch,
            "Whether the volume of each closed surface is kept to rounding, instead of to the error \
             of the mesh and the steps; by default true.",
        ),
        optional(
            "spacing",
            positive(Dimension::LENGTH),
            "Distance of the nodes of the lattice.",
        ),
        optional(
            "resolution",
            NUMBER,
            "Number of nodes in the radius a of the sphere with the volume of the first surface, \
             instead of spacing.",
        ),
        optional(
            "box",
            Form::Exactly(3, &positive(Dimension::LENGTH)),
            "Lengths of the box of fluid, rounded to whole nodes; by default 7 a along each axis, of \
             scenes with one surface.",
        ),
        optional(
            "centre",
            Form::Vector(Dimension::LENGTH),
            "Centre of the box; by default [0, 0, 0].",
        ),
        optional(
            "density",
            positive(Dimension::DENSITY),
            "Mass density ρ of the fluid, inside and outside; by default there is no inertia, and \
             the remaining inertia of the lattice is kept small.",
        ),
        optional(
            "lattice_viscosity",
            NUMBER,
            "Kinematic viscosity ν on the lattice in units of spacing²/step, best from 0.02 to 1; \
             by default 1/3, less if a surface's viscosity ratio requires it, or the value that \
             follows from density and step.",
        ),
        optional(
            "kernel",
            Form::Choice(|| vec!["two", "three", "four"]),
            "The kernel that spreads forces of vertices: its number of nodes along each axis; by \
             default \"two\".",
        ),
        optional(
            "precision",
            Form::Choice(|| vec!["f32", "f64"]),
            "Number type of the lattice; membranes are always f64; by default \"f64\".",
        ),
    ],
    exactly_one: &[],
    at_most_one: &[],
    needs: &[],
    kinds: &[
        Kind {
            name: "relax",
            required: &[],
            optional: &[
                "scheme",
                "residual",
                "iterations",
                "redistribution",
                "energy_error",
            ],
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
                "redistribution",
            ],
            exactly_one: &[&["duration", "strain"]],
        },
        Kind {
            name: "lattice-boltzmann",
            required: &["viscosity"],
            optional: &[
                "flow",
                "duration",
                "strain",
                "spacing",
                "resolution",
                "box",
                "centre",
                "density",
                "lattice_viscosity",
                "step",
                "kernel",
                "precision",
                "volume_correction",
                "redistribution",
            ],
            exactly_one: &[&["duration", "strain"], &["spacing", "resolution"]],
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
             u = U (1 − ρ²/R²) along an axis, ρ the distance from it; \"channel\", along x between the \
             walls of a lattice's box, driven by a force on all fluid. On a lattice a shear is that of \
             two walls at the ends of y.",
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
            "Velocity U on the axis, or in the middle of a channel without surfaces and obstacles.",
        ),
        optional(
            "radius",
            positive(Dimension::LENGTH),
            "Radius R of the tube of this flow. There are no walls: beyond R the flow is \
             reversed.",
        ),
        optional("direction", Form::Direction, "Direction of axis and flow."),
        optional(
            "through",
            Form::Vector(Dimension::LENGTH),
            "A point of the axis; by default [0, 0, 0].",
        ),
        optional(
            "section",
            Form::Choice(|| vec!["plates", "duct"]),
            "\"plates\", walls at the ends of y; \"duct\", of z too; by default plates.",
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
        Kind {
            required: &["centre_velocity"],
            optional: &["section"],
            ..no_keys("channel")
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
