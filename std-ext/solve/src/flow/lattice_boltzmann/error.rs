//! Errors of the lattice.

use helfrich::SurfaceError;

/// Reason why something cannot be computed on a lattice.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LatticeError {
    /// A box without nodes along an axis.
    #[error("the lattice has 0 nodes along {}: at least 1 is needed", axis_name(*axis))]
    NoCells {
        /// 0, 1 or 2.
        axis: usize,
    },
    /// More memory than can be addressed.
    #[error(
        "a lattice of {} × {} × {} nodes is larger than any memory: the size that fits is \
         about 170 bytes a node in f64, half in f32", cells[0], cells[1], cells[2]
    )]
    TooLarge {
        /// Number of nodes along each axis.
        cells: [usize; 3],
    },
    /// More memory than is available.
    #[error("{bytes} bytes of memory are not available: use fewer nodes, or f32")]
    NoMemory {
        /// The requested size.
        bytes: usize,
    },
    /// More ranks than planes allow.
    #[error(
        "{ranks} ranks cannot share {planes} planes of nodes along z, of which each needs 3: use {most} at \
         most, or let z be the longest axis"
    )]
    TooManyRanks {
        /// Number of ranks.
        ranks: usize,
        /// Number of nodes along z.
        planes: usize,
        /// The largest number of ranks.
        most: usize,
    },
    /// A viscosity that is not positive.
    #[error(
        "the viscosity is {viscosity} in lattice units: it has to be above 0, which is a relaxation \
         time τ = 3ν + ½ above ½, and is best between 0.02 and 1"
    )]
    Viscosity {
        /// In lattice units.
        viscosity: f64,
    },
    /// A wall with a normal velocity, or as fast as sound.
    #[error(
        "the {} wall along {} moves with ({}, {}, {}): its velocity must lie in the wall and be \
         below the speed of sound, 0.577, better below 0.1",
        if *high { "high" } else { "low" }, axis_name(*axis), velocity[0], velocity[1], velocity[2]
    )]
    WallVelocity {
        /// The axis normal to the wall.
        axis: usize,
        /// Whether it is the wall at the end of the axis.
        high: bool,
        /// In lattice units.
        velocity: [f64; 3],
    },
    /// Walls where the box is periodic, or the reverse.
    #[error("along {} the box is periodic or has walls from the start: only their velocities can change", axis_name(*axis))]
    OtherSides {
        /// The axis.
        axis: usize,
    },
    /// A force that is not finite.
    #[error("the force ({}, {}, {}) is not finite", force[0], force[1], force[2])]
    Force {
        /// In lattice units.
        force: [f64; 3],
    },
    /// Positions that do not fit their mesh.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// A mesh that is not closed.
    #[error(
        "the mesh has {boundary_edges} boundary edges: only a closed one has an inside and an outside"
    )]
    Open {
        /// The number of edges with one triangle.
        boundary_edges: usize,
    },
    /// Positions that are not in lattice units.
    #[error(
        "the mesh reaches to {coordinate} along {}, far beyond the box of {cells} nodes: positions \
         are in lattice units, and in the box", axis_name(*axis)
    )]
    FarAway {
        /// 0, 1 or 2.
        axis: usize,
        /// The coordinate, modulo whole periods.
        coordinate: f64,
        /// Number of nodes along the axis.
        cells: usize,
    },
    /// An obstacle that contains no node.
    #[error(
        "no node of the lattice lies inside the mesh: it needs to be larger, or the lattice finer"
    )]
    NothingInside,
    /// Too many obstacles.
    #[error("a lattice has room for {limit} obstacles at most")]
    TooManyObstacles {
        /// The largest number allowed.
        limit: usize,
    },
    /// A point with a coordinate that is not finite.
    #[error("coordinate {} of point {point} is not a finite number", axis_name(*axis))]
    PointNotFinite {
        /// The point.
        point: usize,
        /// 0, 1 or 2.
        axis: usize,
    },
    /// A point whose kernel reaches through a wall.
    #[error(
        "point {point} is at {coordinate} along {}, between walls at 0 and {cells}: its kernel needs \
         {distance} of distance from each, and one of fewer points less", axis_name(*axis)
    )]
    NearWall {
        /// The point.
        point: usize,
        /// The axis normal to the wall.
        axis: usize,
        /// The point's coordinate.
        coordinate: f64,
        /// Number of nodes along the axis.
        cells: usize,
        /// The distance from walls that the kernel needs.
        distance: f64,
    },
    /// Units that are not positive, finite numbers.
    #[error("the {name} is {value}: it has to be a number above 0")]
    Unit {
        /// The quantity that it is a unit of.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A state of another lattice.
    #[error(
        "the state is of a lattice of {} × {} × {} nodes with {populations} populations, this one \
         has {} × {} × {} with {expected}", found[0], found[1], found[2], cells[0], cells[1], cells[2]
    )]
    OtherState {
        /// Nodes of the state along each axis.
        found: [usize; 3],
        /// Numbers in the state.
        populations: usize,
        /// Nodes of the lattice along each axis.
        cells: [usize; 3],
        /// Numbers that the lattice holds.
        expected: usize,
    },
}

fn axis_name(axis: usize) -> &'static str {
    ["x", "y", "z"][axis]
}
