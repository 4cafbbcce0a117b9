//! Nodes inside meshes.

use crate::{between, cells, lattice, periodic, sphere, stirred};
use helfrich::Surface;
use helfrich_std::flow::lattice_boltzmann::Sides;
use helfrich_tests::meshes::Mesh;

/// Nodes are inside a ball according to their distance from its centre.
#[test]
fn nodes_are_inside_of_meshes_or_not() {
    let lattice = lattice::<f32>(periodic([20, 17, 15], 0.1));
    // Balls in the middle, across all sides, and whole periods away.
    for centre in [[9.3, 8.1, 7.7], [0.2, 16.8, -0.1], [-991.0, 34.5, 1510.4]] {
        let ball = sphere(4.9, centre);
        let inside = lattice.inside(&ball.connectivity, &ball.positions).unwrap();
        for (number, [x, y, z]) in cells([20, 17, 15]).enumerate() {
            let away = |at: usize, centre: f64, count: f64| {
                let distance = (at as f64 + 0.5 - centre).rem_euclid(count);
                distance.min(count - distance)
            };
            let away = [
                away(x, centre[0], 20.0),
                away(y, centre[1], 17.0),
                away(z, centre[2], 15.0),
            ];
            let distance = away.iter().map(|d| d * d).sum::<f64>().sqrt();
            // The mesh lies between the sphere and the centres of its triangles.
            if !(4.8..=4.9).contains(&distance) {
                assert_eq!(inside[number], distance < 4.85, "at {distance}");
            }
        }
    }
}

/// Lines of nodes pass through vertices and along edges: of six tetrahedra that fill a cube with corners on
/// lines of nodes, exactly one contains each node, and together they contain as many as the volume says.
#[test]
fn lines_through_edges_are_counted_once() {
    let lattice = lattice::<f64>(periodic([12; 3], 0.1));
    let mut owners = vec![0; 12 * 12 * 12];
    for path in [
        [0, 1, 2],
        [1, 2, 0],
        [2, 0, 1],
        [0, 2, 1],
        [2, 1, 0],
        [1, 0, 2],
    ] {
        // Path along three edges of the cube from one corner to the opposite one.
        let mut corner = [2.5; 3];
        let mut corners = vec![corner];
        for axis in path {
            corner[axis] += 6.0;
            corners.push(corner);
        }
        let faces = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
        let part = Mesh::new(corners, faces);
        let inside = lattice.inside(&part.connectivity, &part.positions).unwrap();
        for (owners, inside) in owners.iter_mut().zip(inside) {
            *owners += usize::from(inside);
        }
    }
    assert!(owners.iter().all(|&owners| owners <= 1));
    assert_eq!(owners.iter().sum::<usize>(), 6 * 6 * 6);
}

/// Two spheres with viscosities of their own, in any position, give the same bits as viscosities per node.
#[test]
fn fluids_inside_surfaces_have_their_viscosities() {
    let size = [20, 17, 15];
    let walls = Sides::Walls {
        low: [0.0; 3],
        high: [0.0, 0.0, 0.03],
    };
    let setup = between(1, walls, periodic(size, 0.1));
    let [mut moved, mut fresh] = [(); 2].map(|()| {
        let mut lattice = lattice::<f64>(setup.clone());
        lattice.fill(stirred(size));
        lattice
    });
    // Across periodic sides and a wall; then with the second sphere inside the first, across a side as well.
    for (centres, radius) in [
        ([[0.4, 8.1, -7.0], [10.0, 9.0, 7.0]], 4.3),
        ([[19.0, 2.0, 8.0], [20.1, 3.0, 7.0]], 2.4),
    ] {
        let balls = [sphere(4.3, centres[0]), sphere(radius, centres[1])];
        let [first, second] = balls.each_ref().map(Mesh::surface);
        (moved.set_inner_viscosities(&[(first, 0.05), (second, 0.7)])).unwrap();
        let inside = balls.each_ref().map(|ball| {
            let inside = moved.inside(&ball.connectivity, &ball.positions);
            inside.unwrap()
        });
        let number = |[x, y, z]: [usize; 3]| x + size[0] * (y + size[1] * z);
        let viscosity = |cell| match inside.each_ref().map(|inside| inside[number(cell)]) {
            [_, true] => 0.7,
            [true, false] => 0.05,
            [false, false] => 0.1,
        };
        fresh.set_viscosities(viscosity).unwrap();
        for _ in 0..3 {
            moved.advance(1);
            fresh.advance(1);
            assert!(moved.state() == fresh.state(), "{centres:?}");
        }
        // A refused call changes nothing.
        let mut positions = balls[0].positions.clone();
        positions.iter_mut().for_each(|x| x[1] += 100.0);
        let away = Surface::new(&balls[0].connectivity, &positions).unwrap();
        assert!(moved.set_inner_viscosities(&[(second, 0.0)]).is_err());
        assert!((moved.set_inner_viscosities(&[(second, 0.2), (away, 0.3)])).is_err());
        moved.advance(1);
        fresh.advance(1);
        assert!(moved.state() == fresh.state(), "after refusals");
    }
    moved.set_inner_viscosities(&[]).unwrap();
    fresh.set_viscosities(|_| 0.1).unwrap();
    moved.advance(2);
    fresh.advance(2);
    assert!(moved.state() == fresh.state(), "without surfaces");
}

/// In nested shells, of which the innermost has the viscosity of the fluid outside, each node has the
/// viscosity of the innermost surface around it, in every order of the surfaces.
#[test]
fn the_innermost_surface_says_which_fluid_there_is() {
    let size = [20, 17, 15];
    let setup = periodic(size, 0.1);
    // The shells reach across the sides of the box.
    let balls = [
        (sphere(6.2, [19.0, 8.1, 7.7]), 0.5),
        (sphere(4.1, [20.5, 8.0, 7.0]), 0.05),
        (sphere(1.9, [20.9, 8.5, 7.5]), 0.1),
    ];
    let [mut fresh, nested] = [(); 2].map(|()| {
        let mut lattice = lattice::<f64>(setup.clone());
        lattice.fill(stirred(size));
        lattice
    });
    let inside = balls.each_ref().map(|(ball, _)| {
        let inside = fresh.inside(&ball.connectivity, &ball.positions);
        inside.unwrap()
    });
    let viscosity = |[x, y, z]: [usize; 3]| {
        let number = x + size[0] * (y + size[1] * z);
        let mut containing = balls.iter().zip(&inside).rev();
        let innermost = containing.find(|(_, inside)| inside[number]);
        innermost.map_or(0.1, |((_, viscosity), _)| *viscosity)
    };
    fresh.set_viscosities(viscosity).unwrap();
    fresh.advance(3);
    for order in [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ] {
        let mut nested = nested.clone();
        let surfaces = order.map(|k| (balls[k].0.surface(), balls[k].1));
        nested.set_inner_viscosities(&surfaces).unwrap();
        nested.advance(3);
        assert!(nested.state() == fresh.state(), "{order:?}");
    }
}
