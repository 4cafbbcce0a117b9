//! Constant forces on vertices.

use autodiff::F1;
use helfrich::{EndPull, LoadError, PointLoads, Prepared, Surface};
use helfrich_tests::laws::{check_gradient, energy, forces, with_derivatives};
use helfrich_tests::meshes::{GENERIC, dot, rotation};
use helfrich_tests::meshes::{Mesh, cases, disc, icosphere, octahedron, turned};
use helfrich_tests::tolerance;
use proptest::prelude::*;

const ALONG_X: [f64; 3] = [1.0, 0.0, 0.0];

#[test]
fn energy_is_the_work_from_the_level() {
    let mesh = octahedron();
    let loads = vec![
        (4, [0.0, 2.0, -3.0]),
        (1, [1.0, 0.0, 0.5]),
        (4, [0.25, 0.0, 0.0]),
    ];
    let loads = PointLoads::new(&mesh.connectivity, loads).unwrap();
    let at = |level: [f64; 3]| {
        let loads = loads.clone().with_level(level);
        energy(loads, &mesh.connectivity, &mesh.positions)
    };
    let expected = |level: [f64; 3]| {
        let work = |&(vertex, force): &(u32, [f64; 3])| {
            let x: [f64; 3] = mesh.positions[vertex as usize];
            dot(force, [0, 1, 2].map(|k| x[k] - level[k]))
        };
        -loads.loads().iter().map(work).sum::<f64>()
    };
    for level in [[0.0; 3], [0.5, -3.0, 2.0]] {
        tolerance::POLYHEDRON.assert(at(level), expected(level), 10.0, "E");
    }
    let force = forces(loads.clone(), &mesh.connectivity, &mesh.positions);
    assert_eq!(force[4], [0.25, 2.0, -3.0]);
    assert_eq!(force[1], [1.0, 0.0, 0.5]);
    assert_eq!(force[0], [0.0; 3]);

    let dual = loads.loads().iter();
    let dual = dual.map(|&(vertex, force)| (vertex, force.map(F1::cst)));
    let dual = PointLoads::new(&mesh.connectivity, dual.collect()).unwrap();
    // Forces are the gradient, but their sum need not vanish, so the law of balance does not apply.
    let direction = [0.3, -1.0, 0.2];
    let moved = with_derivatives(&mesh.positions, &[direction; 6]);
    let derivative = energy(dual, &mesh.connectivity, &moved).dx;
    let sum: f64 = force.iter().map(|&f| dot(f, direction)).sum();
    tolerance::POLYHEDRON.assert(derivative, -sum, 1.0, "dE");

    let none = PointLoads::new(&mesh.connectivity, vec![]).unwrap();
    assert_eq!(energy(none, &mesh.connectivity, &mesh.positions), 0.0);
    // The remainder of a loaded vertex's position contributes to the energy.
    let remainders = vec![[0.0, 0.0, 1e-18]; 6];
    let single = PointLoads::new(&mesh.connectivity, vec![(0, [0.0, 0.0, 1.0])]).unwrap();
    let flat = vec![[0.0; 3]; 6];
    let surface = Surface::with_remainders(&mesh.connectivity, &flat, &remainders).unwrap();
    assert_eq!(
        Prepared::new(single, &mesh.connectivity).energy(surface),
        -1e-18
    );
}

/// The vertices that are loaded at the two ends.
fn ends(mesh: &Mesh, fraction: f64) -> (Vec<u32>, Vec<u32>) {
    let loads = PointLoads::opposite_ends(mesh.surface(), ALONG_X, fraction, 7.0).unwrap();
    let side = |sign: f64| {
        let of = loads
            .loads()
            .iter()
            .filter(move |load| load.1[0] * sign > 0.0);
        let mut side = Vec::from_iter(of.map(|load| load.0));
        side.sort_unstable();
        side
    };
    (side(1.0), side(-1.0))
}

proptest! {
    #![proptest_config(cases(64))]

    #[test]
    fn ends_have_the_farthest_vertices(refinement in 1..3_u32, fraction in 0.02..0.5) {
        let mesh = icosphere(refinement);
        let (front, back) = ends(&mesh, fraction);
        let count = (fraction * mesh.positions.len() as f64).round() as usize;
        prop_assert_eq!([front.len(), back.len()], [count, count]);
        let x = |vertex: &u32| mesh.positions[*vertex as usize][0];
        let least = front.iter().map(x).fold(f64::INFINITY, f64::min);
        let most = back.iter().map(x).fold(f64::NEG_INFINITY, f64::max);
        for vertex in 0..mesh.positions.len() as u32 {
            prop_assert!(front.contains(&vertex) || x(&vertex) <= least);
            prop_assert!(back.contains(&vertex) || x(&vertex) >= most);
        }
    }
}

#[test]
fn opposite_ends_pull_without_net_force_wherever_the_surface_lies() {
    let mesh = icosphere(3);
    // 39 vertices at each end: 1/39 is not a binary fraction.
    let pull = 0.7;
    let loads = PointLoads::opposite_ends(mesh.surface(), ALONG_X, 0.06, pull).unwrap();
    assert_eq!(loads.loads().len(), 2 * 39);
    let force = forces(loads.clone(), &mesh.connectivity, &mesh.positions);
    let total = |sign: f64| force.iter().map(|f| (sign * f[0]).max(0.0)).sum::<f64>();
    for sign in [1.0, -1.0] {
        tolerance::POLYHEDRON.assert(total(sign), pull, 39.0 * pull, "force on an end");
    }
    assert!(force.iter().all(|f| f[1] == 0.0 && f[2] == 0.0));

    // On a grid, the translation is exact and changes no bit.
    let pitch = 2.0_f64.powi(-30);
    let here = mesh.map(|x| x.map(|x| (x / pitch).round() * pitch));
    let there = here.map(|[x, y, z]| [x + 1024.0, y - 512.0, z]);
    let [near, far] =
        [here, there].map(|mesh| energy(loads.clone(), &mesh.connectivity, &mesh.positions));
    assert_eq!(near, far);
    assert!(near < 0.0);

    // The direction may be any vector of any length.
    let coarse = icosphere(1);
    let turn = rotation(GENERIC);
    let direction = turned(turn, [5.0, 0.0, 0.0]);
    let slanted = coarse.map(|x| turned(turn, x));
    let straight = PointLoads::opposite_ends(coarse.surface(), ALONG_X, 0.1, 1.0).unwrap();
    let slanted = PointLoads::opposite_ends(slanted.surface(), direction, 0.1, 1.0).unwrap();
    let vertices = |loads: &PointLoads<f64>| Vec::from_iter(loads.loads().iter().map(|l| l.0));
    assert_eq!(vertices(&straight), vertices(&slanted));
}

#[test]
fn the_force_is_the_gradient() {
    // Two opposite loads along the line through both vertices, so that there is no torque either.
    let mesh = icosphere(1);
    let [a, b] = [0, 7];
    let along = [0, 1, 2].map(|k| mesh.positions[b][k] - mesh.positions[a][k]);
    let loads = vec![(b as u32, along), (a as u32, along.map(|f| -f))];
    let one = PointLoads::new(&mesh.connectivity, loads.clone()).unwrap();
    let dual = loads.iter().map(|&(v, f)| (v, f.map(F1::cst))).collect();
    let two = PointLoads::new(&mesh.connectivity, dual).unwrap();
    check_gradient(&one, two, &mesh.connectivity, &mesh.positions);
}

fn pull<T: From<f64>>(depths: [f64; 2], [force, stiffness, length]: [f64; 3]) -> EndPull<T> {
    EndPull {
        axis: ALONG_X.map(T::from),
        depths: depths.map(T::from),
        force: force.into(),
        stiffness: stiffness.into(),
        length: length.into(),
    }
}

/// The force on each end of a surface, and the distance of the ends.
fn measured(pull: EndPull<f64>, mesh: &Mesh) -> (f64, f64) {
    let mut prepared = Prepared::new(pull, &mesh.connectivity);
    prepared.energy(mesh.surface());
    prepared.with(|pull, _, workspace| pull.measured(workspace))
}

#[test]
fn the_pull_on_ends_is_the_gradient() {
    let mesh = icosphere(1);
    // An axis of symmetry, so that there is no torque.
    let axis = mesh.positions[0];
    for numbers in [[0.7, 0.0, 0.0], [0.0, 2.0, 3.5], [-0.3, 2.0, 1.0]] {
        let (one, two) = (pull([0.2, 0.7], numbers), pull([0.2, 0.7], numbers));
        let (one, two) = (
            EndPull { axis, ..one },
            EndPull {
                axis: axis.map(F1::cst),
                ..two
            },
        );
        check_gradient(&one, two, &mesh.connectivity, &mesh.positions);
    }
}

/// The integral over a unit sphere is exact: `∫ exp(x/ℓ) dS = 2π ℓ (exp(1/ℓ) − exp(−1/ℓ))`, so that with ℓ ≪ 1 the distance
/// is `2 + ℓ ln(1/ℓ) + ℓ′ ln(1/ℓ′)`. Triangles have an error of second order.
#[test]
fn ends_of_a_sphere_are_as_far_apart_as_its_outermost_points() {
    let depths: [f64; 2] = [0.05, 0.2];
    let expected = 2.0 - depths.iter().map(|depth| depth * depth.ln()).sum::<f64>();
    let errors = [3, 4, 5].map(|level| {
        let (force, distance) = measured(pull(depths, [0.0, 2.0, 3.0]), &icosphere(level));
        assert_eq!(force, 2.0 * (3.0 - distance));
        (distance - expected).abs()
    });
    assert!(errors[2] < 1e-3, "{errors:?}");
    for pair in errors.windows(2) {
        // 4 for the second order; the leading terms are not yet alone.
        assert!((3.5..4.5).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

/// The force on an end is the whole force, however many vertices are there, and normal to the surface: its part along the
/// surface is an error of the triangles, of first order.
#[test]
fn ends_are_pulled_by_the_whole_force_along_the_normals() {
    let across = [3, 4, 5].map(|level| {
        let mesh = icosphere(level);
        let force = forces(
            pull([0.05; 2], [0.7, 0.0, 0.0]),
            &mesh.connectivity,
            &mesh.positions,
        );
        for end in [1.0, -1.0] {
            let own = force.iter().zip(&mesh.positions);
            let own = own.filter(|(_, at)| end * at[0] > 0.0);
            let sum: f64 = own.map(|(force, _)| end * force[0]).sum();
            assert!((sum / 0.7 - 1.0).abs() < 1e-7, "{sum}");
        }
        let parts = force.iter().zip(&mesh.positions).map(|(&force, &at)| {
            let along = dot(force, at);
            let rest = [0, 1, 2].map(|k| force[k] - along * at[k]);
            [along.abs(), dot(rest, rest).sqrt()]
        });
        let [normal, tangential] = parts.fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
        tangential / normal
    });
    assert!(across[2] < 0.03, "{across:?}");
    assert!(
        across[1] < 0.6 * across[0] && across[2] < 0.6 * across[1],
        "{across:?}"
    );
}

/// Among vertices at equal coordinates, the one with the lower number counts as farther back, so that the
/// ends do not share vertices.
#[test]
fn ties_are_broken_by_number() {
    let line = octahedron().map(|_| [1.0, 2.0, 3.0]);
    assert_eq!(ends(&line, 0.5), (vec![3, 4, 5], vec![0, 1, 2]));
    assert_eq!(ends(&line, 0.17), (vec![5], vec![0]));
}

#[test]
fn what_cannot_be_loaded_is_refused() {
    let mesh = octahedron();
    let refused = |vertex: u32, force: [f64; 3]| {
        PointLoads::new(&mesh.connectivity, vec![(0, [0.0; 3]), (vertex, force)]).unwrap_err()
    };
    assert!(matches!(
        refused(6, [0.0; 3]),
        LoadError::VertexOutOfRange {
            load: 1,
            vertex: 6,
            vertices: 6
        }
    ));
    assert_eq!(
        refused(5, [f64::NAN, 0.0, 0.0]),
        LoadError::NotFinite { load: 1 }
    );
    let pull = |direction: [f64; 3], fraction: f64, force: f64| {
        PointLoads::opposite_ends(mesh.surface(), direction, fraction, force).map(|_| ())
    };
    for direction in [[0.0; 3], [f64::INFINITY, 0.0, 0.0], [f64::NAN, 1.0, 0.0]] {
        assert_eq!(pull(direction, 0.2, 1.0), Err(LoadError::NoDirection));
    }
    assert_eq!(pull([1e-200, 0.0, 0.0], 0.2, 1.0), Ok(()));
    assert!(matches!(
        pull(ALONG_X, 0.2, f64::NAN),
        Err(LoadError::NotFinite { .. })
    ));
    for fraction in [0.0, 0.05, 0.6, 1.0, -0.2, f64::NAN, f64::INFINITY] {
        let error = pull(ALONG_X, fraction, 1.0).unwrap_err();
        assert!(
            matches!(error, LoadError::Fraction { vertices: 6, .. }),
            "{error}"
        );
    }
    // Isolated vertices do not belong to an end.
    let mut positions = mesh.positions.clone();
    positions.push([9.0, 0.0, 0.0]);
    let isolated = Mesh::new(positions, mesh.connectivity.triangles().to_vec());
    let (front, _) = ends(&isolated, 0.17);
    assert_ne!(front, [6]);
}

#[test]
#[should_panic(expected = "the loads are for 6 vertices")]
fn loads_of_another_mesh_do_not_go_unnoticed() {
    let (mesh, other) = (octahedron(), disc(2));
    let loads = PointLoads::<f64>::new(&mesh.connectivity, vec![]).unwrap();
    Prepared::new(loads, &other.connectivity);
}
