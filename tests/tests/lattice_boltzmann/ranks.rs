//! Ranks: the independence of results from the number of processes that share a lattice. Here ranks are threads.

use crate::{between, periodic, scattered, sphere, stirred};
use helfrich::Surface;
use helfrich_std::flow::lattice_boltzmann::{
    Immersed, Kernel, Lattice, LatticeError, Precision, Setup, Sides, State,
};
use helfrich_std::team::Team;
use helfrich_tests::meshes::Mesh;
use proptest::prelude::*;

/// A box with everything that links nodes of different planes.
#[derive(Clone, Copy, Debug)]
struct Case {
    size: [usize; 3],
    /// The axis with moving walls, if there is one.
    walls: Option<usize>,
    obstacle: bool,
    /// Whether fluid in a sphere has another viscosity.
    filled: bool,
    kernel: Kernel,
}

/// The results on rank 0.
#[derive(PartialEq)]
struct Known<T> {
    state: State<T>,
    velocities: Vec<[f64; 3]>,
    read: Vec<[f64; 3]>,
    forces: Vec<[f64; 3]>,
    layers: Vec<[f64; 3]>,
}

fn setup(case: Case) -> Setup {
    let setup = periodic(case.size, 0.1);
    let Some(axis) = case.walls else {
        return setup;
    };
    let along = |speed| crate::unit((axis + 1) % 3, speed);
    let (low, high) = (along(0.02), along(-0.01));
    between(axis, Sides::Walls { low, high }, setup)
}

/// Points in the box, away from its walls.
fn points(case: Case) -> Vec<[f64; 3]> {
    let mut points = scattered(60, case.size);
    if let Some(axis) = case.walls {
        let end = case.size[axis] as f64 - 2.0;
        points
            .iter_mut()
            .for_each(|point| point[axis] = point[axis].clamp(2.0, end));
    }
    points
}

fn force(number: usize) -> [f64; 3] {
    let angle = number as f64;
    [angle.sin(), angle.cos(), (3.0 * angle).sin()].map(|x| 1e-3 * x)
}

/// Some steps with points in the flow, in the order of the points or in the opposite one.
fn advanced<T: Precision>(case: Case, team: Team, backwards: bool) -> Known<T> {
    let mut lattice = Lattice::<T>::shared(setup(case), team).unwrap();
    lattice.fill(stirred(case.size));
    lattice.set_force([1e-4, 0.0, -1e-4]).unwrap();
    let place = |mesh: Mesh| (mesh.connectivity, mesh.positions);
    if case.obstacle {
        // Across the middle planes, which two ranks have.
        let at = [3.0, 4.0, 0.5 * case.size[2] as f64];
        let (mesh, positions) = place(sphere(2.2, at));
        lattice.add_obstacle(&mesh, &positions).unwrap();
    }
    let (mesh, positions) = place(sphere(2.6, [6.0, 4.5, 0.4]));
    let mut immersed = Immersed::new(case.kernel);
    let (mut points, mut forces): (Vec<_>, Vec<_>) = (points(case).into_iter().enumerate())
        .map(|(number, point)| (point, force(number)))
        .unzip();
    if backwards {
        points.reverse();
        forces.reverse();
    }
    let mut velocities = vec![[0.0; 3]; points.len()];
    let mut read = vec![[0.0; 3]; points.len()];
    let mut all_read = Vec::new();
    // An odd number, for the two kinds of steps keep populations in different places.
    for _ in 0..5 {
        if case.filled {
            let surface = Surface::new(&mesh, &positions).unwrap();
            lattice.set_inner_viscosities(&[(surface, 0.4)]).unwrap();
        }
        immersed.place(&lattice, &points).unwrap();
        lattice.clear_forces();
        immersed.spread(&mut lattice, &forces).unwrap();
        immersed.interpolate(&mut lattice, &mut read);
        all_read.extend_from_slice(&read);
        immersed.place_own(&lattice, &points).unwrap();
        lattice.advance_keeping_velocities();
        immersed.interpolate_kept(&lattice, &mut velocities);
        for (point, velocity) in points.iter_mut().zip(&velocities) {
            point.iter_mut().zip(velocity).for_each(|(x, u)| *x += u);
        }
    }
    let mut on = Vec::from_iter((0..3).flat_map(|axis| lattice.wall_forces(axis)));
    on.extend(case.obstacle.then(|| lattice.obstacle_force(0)));
    lattice.collect();
    Known {
        state: lattice.state().clone(),
        velocities,
        read: all_read,
        forces: on,
        layers: lattice.layer_velocities(),
    }
}

/// The results on rank 0 of some ranks.
fn shared<T: Precision>(case: Case, ranks: usize) -> Known<T> {
    let mut teams = Team::of_threads(ranks).into_iter();
    let first = teams.next().unwrap();
    std::thread::scope(|scope| {
        for team in teams {
            scope.spawn(move || advanced::<T>(case, team, false));
        }
        advanced::<T>(case, first, false)
    })
}

fn kernels() -> impl Strategy<Value = Kernel> {
    prop::sample::select(vec![Kernel::Two, Kernel::Three, Kernel::Four])
}

fn check<T: Precision>(case: Case, ranks: usize) -> Result<(), TestCaseError> {
    let expected = advanced::<T>(case, Team::alone(), false);
    let found = shared::<T>(case, ranks);
    let Known {
        state,
        velocities,
        read,
        forces,
        layers,
    } = &found;
    prop_assert!(
        forces == &expected.forces,
        "forces {forces:?}, alone {:?}",
        expected.forces
    );
    prop_assert!(velocities == &expected.velocities, "kept velocities");
    prop_assert!(read == &expected.read, "velocities that were read");
    prop_assert!(layers == &expected.layers, "layers");
    prop_assert!(state == &expected.state, "populations");
    Ok(())
}

proptest! {
    #![proptest_config(helfrich_tests::meshes::cases(24))]

    /// To the last bit, in both number types.
    #[test]
    fn nothing_depends_on_the_number_of_ranks(
        ranks in 2..5_usize,
        planes in 12..17_usize,
        walls in prop::option::of(0..3_usize),
        obstacle: bool,
        filled: bool,
        kernel in kernels(),
        single: bool,
    ) {
        let case = Case { size: [11, 9, planes], walls, obstacle, filled, kernel };
        if single {
            check::<f32>(case, ranks)?;
        } else {
            check::<f64>(case, ranks)?;
        }
    }
}

/// The check sees the order in which the forces of points meet on nodes: in another order, which is what ranks would add if
/// each spread its own points, other bits follow.
#[test]
fn forces_in_another_order_give_other_bits() {
    let case = Case {
        size: [11, 9, 12],
        walls: None,
        obstacle: false,
        filled: false,
        kernel: Kernel::Four,
    };
    let [one, other] = [false, true].map(|back| advanced::<f64>(case, Team::alone(), back));
    assert!(one.state != other.state);
}

/// A state that rank 0 restores goes on at all ranks.
#[test]
fn states_go_on_with_any_number_of_ranks() {
    let size = [11, 9, 12];
    let start = |team| {
        let mut lattice = Lattice::<f64>::shared(periodic(size, 0.1), team).unwrap();
        lattice.fill(stirred(size));
        lattice
    };
    for first in [4, 5] {
        let mut through = start(Team::alone());
        through.advance(first);
        let stored = through.state().clone();
        through.advance(6);
        let resumed = |team: Team| {
            let mut lattice = start(team.clone());
            if team.number() == 0 {
                lattice.restore(stored.clone()).unwrap();
            }
            lattice.distribute();
            lattice.advance(6);
            lattice.collect();
            lattice
        };
        let mut teams = Team::of_threads(3).into_iter();
        let own = teams.next().unwrap();
        let found = std::thread::scope(|scope| {
            teams.for_each(|team| {
                scope.spawn(|| resumed(team));
            });
            resumed(own)
        });
        assert!(found.state() == through.state(), "from step {first}");
        assert_eq!(found.steps(), first + 6);
    }
}

#[test]
fn more_ranks_than_planes_allow_are_refused() {
    let team = Team::of_threads(5).remove(0);
    let refused = Lattice::<f64>::shared(periodic([8, 8, 13], 0.1), team).unwrap_err();
    assert_eq!(
        refused,
        LatticeError::TooManyRanks {
            ranks: 5,
            planes: 13,
            most: 4
        }
    );
}
