//! Components that are inside out.

use helfrich::{Surface, TriangleMesh};
use helfrich_std::generate::{Family, generate};
use helfrich_std::orientation::{InsideOut, inside_out};

/// A sphere of 42 vertices: its centre, its radius, and whether its triangles are reversed.
type Sphere = ([f64; 3], f64, bool);

/// What is said about spheres in one mesh, of which one vertex that no triangle uses is the first.
fn said(spheres: &[Sphere], open: bool) -> Vec<InsideOut> {
    let made = generate(&"sphere".parse().unwrap(), Family::Regular, 42, 1).unwrap();
    let mut positions = vec![[7.0; 3]];
    let mut triangles = Vec::new();
    for &(centre, radius, is_reversed) in spheres {
        let first = positions.len() as u32;
        let place = |x: &[f64; 3]| [0, 1, 2].map(|axis| centre[axis] + radius * x[axis]);
        positions.extend(made.positions.iter().map(place));
        let own = made.mesh.triangles().iter().map(|&[a, b, c]| {
            let [a, b, c] = [a, b, c].map(|vertex| vertex + first);
            if is_reversed { [a, c, b] } else { [a, b, c] }
        });
        triangles.extend(own);
    }
    if open {
        triangles.pop();
    }
    let mesh = TriangleMesh::new(positions.len(), triangles).unwrap();
    inside_out(Surface::new(&mesh, &positions).unwrap())
}

fn components(spheres: &[Sphere]) -> Vec<usize> {
    said(spheres, false).iter().map(|it| it.component).collect()
}

#[test]
fn components_are_inside_out_unless_they_bound_a_cavity() {
    let at = |x: f64, radius: f64, is_reversed: bool| ([x, 0.0, 0.0], radius, is_reversed);
    assert_eq!(components(&[at(0.0, 1.0, false)]), [0; 0]);
    assert_eq!(components(&[at(0.0, 1.0, true)]), [1]);
    // One of two, far from the origin and small.
    let found = said(&[at(0.0, 1.0, false), at(1e6, 1e-3, true)], false);
    let expected = InsideOut {
        component: 2,
        components: 2,
        vertices: 42,
        first: 43,
    };
    assert_eq!(found, [expected]);
    assert!(
        found[0]
            .to_string()
            .starts_with("component 2 of 2 (42 vertices from vertex 43 on) is inside out")
    );
    // The cavity of a body, two bodies within each other, a body in the cavity, and one there inside out.
    let body = at(0.0, 4.0, false);
    let cavity = at(0.0, 3.0, true);
    assert_eq!(components(&[body, cavity]), [0; 0]);
    assert_eq!(components(&[cavity, body]), [0; 0]);
    assert_eq!(components(&[body, at(0.0, 3.0, false)]), [0; 0]);
    assert_eq!(components(&[body, cavity, at(1.0, 1.0, false)]), [0; 0]);
    assert_eq!(components(&[body, cavity, at(1.0, 1.0, true)]), [3]);
    // The hull is inside out, and what is within it is not outside of anything.
    assert_eq!(components(&[at(0.0, 4.0, true), at(0.0, 3.0, false)]), [1]);
    // In the corner of the body's bounding box, and not in the body.
    assert_eq!(components(&[body, ([3.5; 3], 0.4, true)]), [2]);
    // An open surface has no inside.
    assert!(said(&[at(0.0, 1.0, true)], true).is_empty());
}
