//! Regular meshes relaxed with edges as springs.

use super::lattice::Size;
use super::{
    AnyShape, Draft, GenerateError, UNIT_SPHERE, delaunay, icosphere, lattice, position, preimage,
};
use glam::DVec3;
use helfrich::shapes::{Shape, Torus};

/// Level of the icosphere that is relaxed first: coarser meshes do not follow the dimple of a discocyte.
const FIRST_LEVEL: u32 = 3;

/// Number of steps on the first mesh: enough to even out its longest waves.
const FIRST_STEPS: usize = 300;

/// Number of steps after each refinement, which leaves only short waves.
const STEPS: usize = 30;

/// Rest length of springs in mean edges: large enough that edges become even along the surface, small enough
/// that nearly all springs pull.
const REST: f64 = 0.6;

/// Fraction of the springs' mean pull by which a vertex moves in a step.
const SHARE: f64 = 0.5;

/// Limit of the angle between the normals at the ends of an edge, beyond which its spring becomes stiffer,
/// relative to the root mean square over the edges of the initial mesh.
const TURN: f64 = 4.0;

/// Largest value of this limit, as the squared difference of unit normals: an angle of 60°, beyond which an
/// edge cuts corners. It matters only on coarse meshes.
const LARGEST_TURN: f64 = 1.0;

/// Icosphere that is relaxed on the shape, from a coarse level to the fine one.
pub(super) fn icosphere(shape: &AnyShape, level: u32) -> Draft {
    let first = level.min(FIRST_LEVEL);
    let coarse = icosphere::icosphere(first);
    relax_and_refine(shape, coarse, level - first, icosphere::midpoint)
}

/// Mesh with this number of vertices that is relaxed on a sphere-like shape.
///
/// It is refined from a coarse mesh of points on a spiral. If refinement gives up to three vertices too few,
/// the longest edges are cut. While it is as coarse as an icosphere below [`FIRST_LEVEL`], it is relaxed on
/// the sphere.
pub(super) fn of_count(shape: &AnyShape, vertices: usize) -> Result<Draft, GenerateError> {
    let mut counts = vec![vertices];
    let mut coarsest = vertices;
    while refined_from(coarsest) >= icosphere::LEAST_VERTICES {
        coarsest = refined_from(coarsest);
        counts.push(coarsest);
    }
    let preimages = icosphere::spiral(coarsest);
    let triangles = delaunay::sphere(&preimages).map_err(|_| GenerateError::TooExtreme {
        shape: shape.name(),
    })?;
    let mut draft = Draft {
        preimages,
        triangles,
    };
    let mut steps = FIRST_STEPS;
    while let Some(count) = counts.pop() {
        let is_fine = count > 10 << (2 * FIRST_LEVEL) || count == vertices;
        let surface = if is_fine { shape } else { &UNIT_SPHERE };
        if count > draft.preimages.len() {
            draft = icosphere::refine(&draft, icosphere::midpoint);
            cut_longest(surface, &mut draft, count);
            join_fifths(&mut draft);
        }
        relax(surface, &mut draft, steps);
        if is_fine {
            steps = STEPS;
        }
    }
    Ok(draft)
}

/// Number of vertices of the mesh whose refinement has this number or up to three fewer: refinement of a
/// closed mesh without holes makes 4N − 6 vertices of N.
fn refined_from(vertices: usize) -> usize {
    (vertices + 6) / 4
}

/// Cuts the longest edges, if possible apart from each other, until the mesh has this number of vertices.
fn cut_longest(shape: &AnyShape, draft: &mut Draft, vertices: usize) {
    let mut touched = vec![false; vertices];
    while draft.preimages.len() < vertices {
        let added = draft.preimages.len() as u32;
        let edges = draft.triangles.iter();
        let edges = edges.flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let rank = |ends: [u32; 2]| {
            let [a, b] = ends.map(|vertex| position(shape, draft.preimages[vertex as usize]));
            let is_free = ends.iter().all(|&vertex| !touched[vertex as usize]);
            (is_free, a.distance_squared(b))
        };
        // The first of two equal edges is cut.
        let first = |best, edge| if rank(edge) > rank(best) { edge } else { best };
        let Some([a, b]) = edges.reduce(first) else {
            return;
        };
        let ends = [a, b].map(|vertex| draft.preimages[vertex as usize]);
        draft.preimages.push(icosphere::midpoint(ends[0], ends[1]));
        for t in 0..draft.triangles.len() {
            let triangle = draft.triangles[t];
            if triangle.contains(&a) && triangle.contains(&b) {
                let with = |old: u32| triangle.map(|v| if v == old { added } else { v });
                draft.triangles[t] = with(a);
                draft.triangles.push(with(b));
                for vertex in triangle {
                    touched[vertex as usize] = true;
                }
            }
        }
    }
}

/// Joins each vertex of valence four to a fifth one beyond its ring. It flips the side of the ring that is
/// best for the valences and leaves no valence of four: with four springs, a vertex would slip onto an edge.
fn join_fifths(draft: &mut Draft) {
    let triangles = &mut draft.triangles;
    let mut valences = vec![0_i32; draft.preimages.len()];
    for &vertex in triangles.iter().flatten() {
        valences[vertex as usize] += 1;
    }
    let fours = (0..valences.len()).filter(|&vertex| valences[vertex] == 4);
    for vertex in Vec::from_iter(fours) {
        let valence = |of: u32| valences[of as usize];
        let own = |triangle: &[u32; 3]| triangle.iter().position(|&v| v as usize == vertex);
        let flips = triangles.iter().enumerate().filter_map(|(inner, ring)| {
            let at = own(ring)?;
            let [p, q] = [1, 2].map(|next| ring[(at + next) % 3]);
            let beyond = |t: &[u32; 3]| t.contains(&p) && t.contains(&q) && own(t).is_none();
            let outer = triangles.iter().position(beyond)?;
            let x = triangles[outer].into_iter().find(|v| ![p, q].contains(v))?;
            let gain = valence(p) + valence(q) - valence(x);
            (valence(p).min(valence(q)) > 5).then_some((gain, [inner, outer], [p, q, x]))
        });
        let best = flips.reduce(|best, flip| if flip.0 > best.0 { flip } else { best });
        if let Some((_, [inner, outer], [p, q, x])) = best {
            triangles[inner] = [vertex as u32, p, x];
            triangles[outer] = [vertex as u32, x, q];
            for (of, change) in [(vertex as u32, 1), (x, 1), (p, -1), (q, -1)] {
                valences[of as usize] += change;
            }
        }
    }
}

/// Lattice of the torus that is relaxed from a coarse size to the fine one.
pub(super) fn lattice(torus: &Torus<f64>, vertices: usize) -> Draft {
    let Size {
        rows,
        columns,
        level,
    } = Size::nearest(torus, vertices);
    let coarse = lattice::lattice(torus, rows, columns);
    let midpoint = |a, b| preimage(torus, (a + b) / 2.0);
    relax_and_refine(&AnyShape::Torus(*torus), coarse, level, midpoint)
}

fn relax_and_refine(
    shape: &AnyShape,
    mut draft: Draft,
    levels: u32,
    midpoint: impl Fn(DVec3, DVec3) -> DVec3,
) -> Draft {
    relax(shape, &mut draft, FIRST_STEPS);
    for _ in 0..levels {
        draft = icosphere::refine(&draft, &midpoint);
        relax(shape, &mut draft, STEPS);
    }
    draft
}

/// Relaxes a mesh: every edge pulls with the fraction (length − rest)/length of itself; every vertex follows
/// the mean pull of its springs within the tangent plane, and is projected onto the surface.
///
/// Springs shorter than their rest length are slack: rows that are compressed, as on the inner equator of a
/// torus, would buckle and fold.
///
/// Uniform springs settle near the conformal map, which leaves the tips of long shapes and the rims of flat
/// ones without vertices. An edge whose normals differ by an angle φ beyond the limit φ₀ is therefore (φ/φ₀)⁶
/// times as stiff, which keeps vertices where the surface is curved, and changes nothing where no edge
/// exceeds the limit.
fn relax(shape: &AnyShape, draft: &mut Draft, steps: usize) {
    let Draft {
        preimages,
        triangles,
    } = draft;
    let mut positions = Vec::from_iter(preimages.iter().map(|&point| position(shape, point)));
    let mut normals = Vec::from_iter(preimages.iter().map(|&point| normal(shape, point)));
    let most = (TURN * TURN * mean_turn(triangles, &normals)).min(LARGEST_TURN);
    let mut pulls = vec![(DVec3::ZERO, 0.0); positions.len()];
    for _ in 0..steps {
        let rest = REST * mean_edge(triangles, &positions);
        pulls.fill((DVec3::ZERO, 0.0));
        for &[a, b, c] in triangles.iter() {
            for (tail, head) in [(a, b), (b, c), (c, a)] {
                // In a closed mesh, every edge is visited from both ends.
                let [tail, head] = [tail as usize, head as usize];
                let edge = positions[head] - positions[tail];
                let turn = normals[head].distance_squared(normals[tail]) / most;
                let stiffness = if turn > 1.0 { turn * turn * turn } else { 1.0 };
                let (pull, stiff) = &mut pulls[tail];
                *pull += edge * (stiffness * (1.0 - rest / edge.length()).max(0.0));
                *stiff += stiffness;
            }
        }
        for (v, &(pull, stiff)) in pulls.iter().enumerate() {
            let along = pull - normals[v] * pull.dot(normals[v]);
            preimages[v] = preimage(shape, positions[v] + along * (SHARE / stiff));
            positions[v] = position(shape, preimages[v]);
            normals[v] = normal(shape, preimages[v]);
        }
    }
}

/// The exact outward normal.
fn normal(shape: &AnyShape, preimage: DVec3) -> DVec3 {
    shape.at(preimage.to_array()).normal.into()
}

/// Mean squared difference of the normals at the ends of edges.
fn mean_turn(triangles: &[[u32; 3]], normals: &[DVec3]) -> f64 {
    let turn = |a: u32, b: u32| normals[a as usize].distance_squared(normals[b as usize]);
    mean_of_edges(triangles, turn)
}

fn mean_edge(triangles: &[[u32; 3]], positions: &[DVec3]) -> f64 {
    let length = |a: u32, b: u32| positions[a as usize].distance(positions[b as usize]);
    mean_of_edges(triangles, length)
}

fn mean_of_edges(triangles: &[[u32; 3]], value: impl Fn(u32, u32) -> f64) -> f64 {
    let sums = triangles
        .iter()
        .map(|&[a, b, c]| value(a, b) + value(b, c) + value(c, a));
    sums.sum::<f64>() / (3 * triangles.len()) as f64
}
