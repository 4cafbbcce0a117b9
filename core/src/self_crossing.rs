//! Triangles of a surface that cross each other.

use crate::face_tree::FaceTree;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, cross, dot, sub};
use alloc::vec::Vec;

/// Pairs of triangles of a surface of which an edge of one passes through the other, in increasing order. Triangles with
/// a common edge are not compared, and those that only touch do not cross.
///
/// Signs of volumes decide, in the arithmetic of the scalar: a crossing of the size of its rounding may be missed.
pub fn crossing_triangles<T: Real>(surface: Surface<'_, T>) -> Vec<[u32; 2]> {
    let mut pairs = Vec::new();
    FaceTree::new(surface).meeting_pairs(surface, &mut |pair| {
        if cross_each_other(surface, pair.map(|triangle| triangle as usize)) {
            pairs.push(pair);
        }
    });
    pairs.sort_unstable();
    pairs
}

fn cross_each_other<T: Real>(surface: Surface<'_, T>, pair: [usize; 2]) -> bool {
    let corners = pair.map(|triangle| surface.mesh().triangles()[triangle]);
    let shared = corners[0]
        .iter()
        .filter(|corner| corners[1].contains(corner));
    if shared.count() > 1 {
        return false;
    }
    let places = corners.map(|corners| corners.map(|corner| surface.positions()[corner as usize]));
    [[0, 1], [1, 0]].into_iter().any(|[one, other]| {
        (0..3).any(|k| {
            let ends = [k, (k + 1) % 3];
            let apart = ends
                .iter()
                .all(|&end| !corners[other].contains(&corners[one][end]));
            apart && passes_through(ends.map(|end| places[one][end]), places[other])
        })
    })
}

/// Whether a line segment passes through the inside of a triangle.
fn passes_through<T: Real>([from, to]: [Vec3<T>; 2], [a, b, c]: [Vec3<T>; 3]) -> bool {
    // Six times the volume of a tetrahedron.
    let volume = |origin: Vec3<T>, p: Vec3<T>, q: Vec3<T>, r: Vec3<T>| {
        dot(sub(p, origin), cross(sub(q, origin), sub(r, origin)))
    };
    let zero = T::zero();
    let (below, above) = (volume(from, a, b, c), volume(to, a, b, c));
    if !((below < zero && above > zero) || (below > zero && above < zero)) {
        return false;
    }
    let around = [[a, b], [b, c], [c, a]].map(|[p, q]| volume(from, to, p, q));
    around.iter().all(|&volume| volume > zero) || around.iter().all(|&volume| volume < zero)
}
