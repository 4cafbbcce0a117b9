//! Naive versions: generic over the number, lists of lists, vertex after vertex, with a branch wherever
//! something might be missing.

use helfrich::{Real, TriangleMesh};
use nalgebra::{DMatrix, DVector, RealField};
use num_traits::Float;
use std::collections::HashSet;

pub(crate) struct Rings {
    triangles: Vec<[usize; 3]>,
    /// The triangles around each vertex, and its place in each.
    around: Vec<Vec<(usize, usize)>>,
    neighbours: Vec<Vec<usize>>,
    /// Both ends of each edge, and the triangles on its two sides.
    edges: Vec<([usize; 2], [usize; 2])>,
}

impl Rings {
    pub(crate) fn new(mesh: &TriangleMesh) -> Self {
        let triangles: Vec<[usize; 3]> = mesh
            .triangles()
            .iter()
            .map(|t| t.map(|v| v as usize))
            .collect();
        let mut around = vec![Vec::new(); mesh.vertex_count()];
        for (t, triangle) in triangles.iter().enumerate() {
            for (corner, &vertex) in triangle.iter().enumerate() {
                around[vertex].push((t, corner));
            }
        }
        let ring = |v| mesh.one_ring(v).iter().map(|&n| n as usize).collect();
        let edges = mesh.edges().iter().enumerate().filter_map(|(edge, ends)| {
            let (first, second) = mesh.edge_triangles(edge);
            let sides = [first as usize, second? as usize];
            Some((ends.map(|v| v as usize), sides))
        });
        Self {
            triangles,
            around,
            neighbours: (0..mesh.vertex_count()).map(ring).collect(),
            edges: edges.collect(),
        }
    }

    /// The corner of a triangle that is not an end of an edge.
    fn opposite(&self, triangle: usize, ends: [usize; 2]) -> usize {
        let corners = self.triangles[triangle];
        if !ends.contains(&corners[0]) {
            corners[0]
        } else if !ends.contains(&corners[1]) {
            corners[1]
        } else {
            corners[2]
        }
    }
}

fn sub<T: Float>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
fn add<T: Float>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}
fn scale<T: Float>(s: T, a: [T; 3]) -> [T; 3] {
    a.map(|x| s * x)
}
fn dot<T: Float>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
fn cross<T: Float>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// cot of the angle between a and b.
fn cotangent<T: Float>(a: [T; 3], b: [T; 3]) -> T {
    let normal = cross(a, b);
    let area = dot(normal, normal).sqrt();
    if area > T::zero() {
        dot(a, b) / area
    } else {
        T::zero()
    }
}

/// Energy and exact gradient of method B with Voronoi areas and κ = 1: adds −∂E/∂x to `force`.
pub(crate) fn squared_laplacian<T: Float>(
    rings: &Rings,
    positions: &[[T; 3]],
    force: &mut [[T; 3]],
) -> T {
    let number = |value: f64| T::from(value).unwrap_or_else(T::nan);
    let (half, quarter, eighth) = (number(0.5), number(0.25), number(0.125));
    let corners = |t: usize, corner: usize| [0, 1, 2].map(|k| rings.triangles[t][(corner + k) % 3]);
    let mut energy = T::zero();
    let mut weights = Vec::new();
    for (i, around) in rings.around.iter().enumerate() {
        let (mut gradient, mut area) = ([T::zero(); 3], T::zero());
        for &(t, corner) in around {
            let [_, j, k] = corners(t, corner);
            let (x, y, z) = (positions[i], positions[j], positions[k]);
            let at_j = cotangent(sub(x, y), sub(z, y));
            let at_k = cotangent(sub(x, z), sub(y, z));
            gradient = add(gradient, scale(half * at_k, sub(x, y)));
            gradient = add(gradient, scale(half * at_j, sub(x, z)));
            area = area + eighth * at_k * dot(sub(x, y), sub(x, y));
            area = area + eighth * at_j * dot(sub(x, z), sub(x, z));
        }
        if area == T::zero() {
            weights.push(([T::zero(); 3], T::zero()));
            continue;
        }
        let squared = dot(gradient, gradient) / area;
        energy = energy + half * squared;
        weights.push((scale(area.recip(), gradient), half * squared / area));
    }
    for (i, around) in rings.around.iter().enumerate() {
        for &(t, corner) in around {
            let triangle = corners(t, corner);
            // Each edge with what its cotangent is multiplied by.
            for opposite in 0..3 {
                let k = triangle[opposite];
                let (p, q) = (triangle[(opposite + 1) % 3], triangle[(opposite + 2) % 3]);
                let (a, b) = (
                    sub(positions[p], positions[k]),
                    sub(positions[q], positions[k]),
                );
                let normal = cross(a, b);
                let area = dot(normal, normal).sqrt();
                if area == T::zero() {
                    continue;
                }
                let unit = scale(area.recip(), normal);
                let along = dot(a, b);
                let edge = sub(a, b);
                let (turn, sum) = (sub(weights[p].0, weights[q].0), weights[p].1 + weights[q].1);
                let factor = half * dot(turn, edge) - eighth * sum * dot(edge, edge);
                let slope = sub(scale(half, turn), scale(quarter * sum, edge));
                let over = along / (area * area);
                let by_a = sub(scale(area.recip(), b), scale(over, cross(b, unit)));
                let by_b = sub(scale(area.recip(), a), scale(over, cross(unit, a)));
                let change = if p == i {
                    add(scale(factor, by_a), scale(along / area, slope))
                } else if q == i {
                    sub(scale(factor, by_b), scale(along / area, slope))
                } else {
                    scale(-factor, add(by_a, by_b))
                };
                force[i] = sub(force[i], change);
            }
        }
    }
    energy
}

fn unit<T: Float>(a: [T; 3]) -> [T; 3] {
    let length = dot(a, a).sqrt();
    if length > T::zero() {
        scale(length.recip(), a)
    } else {
        a
    }
}

/// Energy and exact gradient of method A with k̃ = 2/√3: adds −∂E/∂x to `force`.
pub(crate) fn dihedral<T: Float>(rings: &Rings, positions: &[[T; 3]], force: &mut [[T; 3]]) -> T {
    let two = T::one() + T::one();
    let modulus = two / (two + T::one()).sqrt();
    let mut energy = T::zero();
    for &(_, sides) in &rings.edges {
        let normals = sides.map(|t| {
            let [a, b, c] = rings.triangles[t].map(|v| positions[v]);
            cross(sub(b, a), sub(c, a))
        });
        let units = normals.map(unit);
        energy = energy + modulus * (T::one() - dot(units[0], units[1]));
        for side in 0..2 {
            let length = dot(normals[side], normals[side]).sqrt();
            if length == T::zero() {
                continue;
            }
            // What n₁·n₂ changes by with the area vector of this side.
            let (own, other) = (units[side], units[1 - side]);
            let along = dot(own, other);
            let slope = scale(modulus / length, sub(other, scale(along, own)));
            let corners = rings.triangles[sides[side]];
            for k in 0..3 {
                let [p, q] = [corners[(k + 1) % 3], corners[(k + 2) % 3]];
                let edge = sub(positions[q], positions[p]);
                force[corners[k]] = add(force[corners[k]], cross(slope, edge));
            }
        }
    }
    energy
}

/// Energy and exact gradient of Jülicher's method with κ = 1: adds −∂E/∂x to `force`.
pub(crate) fn edge_curvature<T: Float>(
    rings: &Rings,
    positions: &[[T; 3]],
    force: &mut [[T; 3]],
) -> T {
    let number = |value: f64| T::from(value).unwrap_or_else(T::nan);
    let (two, quarter, sixth) = (number(2.0), number(0.25), number(1.0 / 6.0));
    let normal = |t: usize| {
        let [a, b, c] = rings.triangles[t].map(|v| positions[v]);
        cross(sub(b, a), sub(c, a))
    };
    // Length and angle of each edge.
    let mut hinges = Vec::new();
    let mut curvatures = vec![(T::zero(), T::zero()); positions.len()];
    for &([a, b], sides) in &rings.edges {
        let edge = sub(positions[b], positions[a]);
        let length = dot(edge, edge).sqrt();
        let [left, right] = sides.map(|t| unit(normal(t)));
        let along = dot(left, right).max(-T::one()).min(T::one());
        let bend = cross(left, right);
        let angle = dot(bend, bend).sqrt().atan2(along);
        // Convex if the other triangle lies below this one.
        let opposite = rings.opposite(sides[1], [a, b]);
        let lifted = dot(left, sub(positions[opposite], positions[a])) > T::zero();
        let angle = if lifted { -angle } else { angle };
        for end in [a, b] {
            curvatures[end].0 = curvatures[end].0 + quarter * length * angle;
        }
        hinges.push((length, angle));
    }
    for (t, corners) in rings.triangles.iter().enumerate() {
        let vector = normal(t);
        for &corner in corners {
            curvatures[corner].1 = curvatures[corner].1 + sixth * dot(vector, vector).sqrt();
        }
    }
    let mut energy = T::zero();
    let mut means = Vec::new();
    for &(curvature, area) in &curvatures {
        let mean = if area > T::zero() {
            curvature / area
        } else {
            T::zero()
        };
        energy = energy + two * mean * mean * area;
        means.push(mean);
    }
    for (&([a, b], sides), &(length, angle)) in rings.edges.iter().zip(&hinges) {
        if length == T::zero() {
            continue;
        }
        let weight = means[a] + means[b];
        let edge = sub(positions[b], positions[a]);
        let stretch = scale(weight * angle / length, edge);
        force[a] = add(force[a], stretch);
        force[b] = sub(force[b], stretch);
        for t in sides {
            let vector = normal(t);
            let squared = dot(vector, vector);
            if squared == T::zero() {
                continue;
            }
            let opposite = rings.opposite(t, [a, b]);
            let lever = scale(weight / squared, vector);
            let from_a = dot(sub(positions[opposite], positions[a]), edge);
            let from_b = dot(sub(positions[b], positions[opposite]), edge);
            force[a] = sub(force[a], scale(from_b, lever));
            force[b] = sub(force[b], scale(from_a, lever));
            force[opposite] = add(force[opposite], scale(length * length, lever));
        }
    }
    for (t, corners) in rings.triangles.iter().enumerate() {
        let weight = corners
            .iter()
            .fold(T::zero(), |sum, &v| sum + means[v] * means[v]);
        let vector = normal(t);
        let size = dot(vector, vector).sqrt();
        if size == T::zero() {
            continue;
        }
        let pull = scale(number(1.0 / 3.0) * weight / size, vector);
        for k in 0..3 {
            let [p, q] = [corners[(k + 1) % 3], corners[(k + 2) % 3]];
            let change = cross(pull, sub(positions[q], positions[p]));
            force[corners[k]] = add(force[corners[k]], change);
        }
    }
    energy
}

/// Force density of method C with κ = 1.
pub(crate) fn meyer<T: Float>(rings: &Rings, positions: &[[T; 3]], density: &mut [[T; 3]]) {
    let number = |value: f64| T::from(value).unwrap_or_else(T::nan);
    let (half, eighth) = (number(0.5), number(0.125));
    let mut weights: Vec<Vec<(usize, T)>> = Vec::new();
    let (mut means, mut gaussians, mut normals) = (Vec::new(), Vec::new(), Vec::new());
    for (i, around) in rings.around.iter().enumerate() {
        let (mut area, mut angles, mut normal) = (T::zero(), T::zero(), [T::zero(); 3]);
        let mut row: Vec<(usize, T)> = Vec::new();
        for &(t, corner) in around {
            let [j, k] = [1, 2].map(|next| rings.triangles[t][(corner + next) % 3]);
            let (x, y, z) = (positions[i], positions[j], positions[k]);
            let (at_i, at_j, at_k) = (
                cotangent(sub(y, x), sub(z, x)),
                cotangent(sub(x, y), sub(z, y)),
                cotangent(sub(x, z), sub(y, z)),
            );
            let vector = cross(sub(y, x), sub(z, x));
            let doubled = dot(vector, vector).sqrt();
            angles = angles + doubled.atan2(dot(sub(y, x), sub(z, x)));
            normal = add(normal, vector);
            area = area
                + if at_i < T::zero() {
                    half * half * doubled
                } else if at_j < T::zero() || at_k < T::zero() {
                    half * half * half * doubled
                } else {
                    let (to_j, to_k) = (sub(x, y), sub(x, z));
                    eighth * (at_k * dot(to_j, to_j) + at_j * dot(to_k, to_k))
                };
            row.push((j, half * at_k));
            row.push((k, half * at_j));
        }
        let mut laplacian = [T::zero(); 3];
        for (j, weight) in &mut row {
            *weight = if area > T::zero() {
                *weight / area
            } else {
                T::zero()
            };
            laplacian = add(laplacian, scale(*weight, sub(positions[*j], positions[i])));
        }
        let normal = unit(normal);
        means.push(-half * dot(laplacian, normal));
        gaussians.push((number(std::f64::consts::TAU) - angles) / area);
        normals.push(normal);
        weights.push(row);
    }
    for (i, row) in weights.iter().enumerate() {
        let change = row.iter().fold(T::zero(), |sum, &(j, weight)| {
            sum + weight * (means[j] - means[i])
        });
        let (mean, gaussian) = (means[i], gaussians[i]);
        let two = T::one() + T::one();
        let force = two * (change + two * mean * (mean * mean - gaussian));
        density[i] = scale(force, normals[i]);
    }
}

/// H by jets of a degree, one dense factorisation a vertex, and then the Laplacian of H by its rows.
pub(crate) fn jets<T: Real + RealField + Copy>(
    rings: &Rings,
    positions: &[[T; 3]],
    (degree, neighbours, sharpness): (usize, usize, f64),
    laplacian: &mut [T],
) {
    let mut means = Vec::new();
    let mut rows: Vec<Vec<(usize, T)>> = Vec::new();
    for i in 0..positions.len() {
        let mut seen = HashSet::from([i]);
        let mut found: Vec<(T, usize)> = Vec::new();
        let mut ring = vec![i];
        while found.len() < 2 * neighbours && !ring.is_empty() {
            let mut next = Vec::new();
            for &vertex in &ring {
                for &neighbour in &rings.neighbours[vertex] {
                    if seen.insert(neighbour) {
                        let edge = sub(positions[neighbour], positions[i]);
                        found.push((dot(edge, edge), neighbour));
                        next.push(neighbour);
                    }
                }
            }
            ring = next;
        }
        found.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(std::cmp::Ordering::Equal));
        found.truncate(neighbours);
        let mut normal = [T::zero(); 3];
        for &(t, _) in &rings.around[i] {
            let [a, b, c] = rings.triangles[t].map(|v| positions[v]);
            normal = add(normal, cross(sub(b, a), sub(c, a)));
        }
        let normal = unit(normal);
        let axis = if Float::abs(normal[0]) < T::constant(0.6) {
            [T::one(), T::zero(), T::zero()]
        } else {
            [T::zero(), T::one(), T::zero()]
        };
        let first = unit(cross(normal, axis));
        let second = cross(normal, first);
        let squared = found.last().map_or(T::one(), |last| last.0);
        let radius = Float::sqrt(squared);
        let columns = (degree + 1) * (degree + 2) / 2 - 1;
        let mut matrix = DMatrix::zeros(found.len(), columns);
        let mut heights = DVector::zeros(found.len());
        let mut weights = Vec::new();
        for (row, &(distance, neighbour)) in found.iter().enumerate() {
            let edge = scale(
                Float::recip(radius),
                sub(positions[neighbour], positions[i]),
            );
            let (x, y, z) = (dot(edge, first), dot(edge, second), dot(edge, normal));
            let weight = Float::exp(-T::constant(sharpness) * distance / squared);
            let mut column = 0;
            for total in 1..=degree as i32 {
                for power in 0..=total {
                    matrix[(row, column)] =
                        weight * Float::powi(x, total - power) * Float::powi(y, power);
                    column += 1;
                }
            }
            heights[row] = weight * z;
            weights.push(weight);
        }
        let qr = matrix.qr();
        let mut right = heights.clone();
        qr.q_tr_mul(&mut right);
        let upper = qr.r();
        let Some(c) = upper.solve_upper_triangular(&right.rows(0, columns).into_owned()) else {
            continue;
        };
        let (one, two) = (T::one(), T::constant(2.0));
        let (p, q) = (c[0], c[1]);
        let w = one + p * p + q * q;
        let bend = (one + q * q) * two * c[2] - two * p * q * c[3] + (one + p * p) * two * c[4];
        let mean = -bend / (two * w * Float::sqrt(w));
        means.push(mean / radius);
        let mut functional = DVector::zeros(columns);
        functional[0] = two * mean * p / Float::sqrt(w);
        functional[1] = two * mean * q / Float::sqrt(w);
        functional[2] = two * (one - p * p / w);
        functional[3] = -two * p * q / w;
        functional[4] = two * (one - q * q / w);
        let Some(y) = upper.tr_solve_upper_triangular(&functional) else {
            continue;
        };
        let entries = qr.q() * y;
        let row = found
            .iter()
            .enumerate()
            .map(|(k, &(_, neighbour))| (neighbour, entries[k] * weights[k] / (radius * radius)));
        rows.push(row.collect());
    }
    for (i, row) in rows.iter().enumerate() {
        laplacian[i] = row.iter().fold(T::zero(), |sum, &(j, weight)| {
            sum + weight * (means[j] - means[i])
        });
    }
}

/// Σ_j G(x_i − x_j) f_j of the Stokeslet, without what is near: adds to `velocity`.
pub(crate) fn stokeslets<T: Float>(
    targets: &[[T; 3]],
    sources: &[[T; 3]],
    forces: &[[T; 3]],
    velocity: &mut [[T; 3]],
) {
    for (x, sum) in targets.iter().zip(velocity) {
        for (y, force) in sources.iter().zip(forces) {
            let r = sub(*x, *y);
            let squared = dot(r, r);
            if squared > T::zero() {
                let distance = squared.sqrt();
                let along = dot(r, *force) / (squared * distance);
                *sum = add(*sum, add(scale(distance.recip(), *force), scale(along, r)));
            }
        }
    }
}
