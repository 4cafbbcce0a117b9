//! Films: what is between two parts of a surface that face each other, where it is thin.
//!
//! A film breaks at its thinnest place: a disc is taken out of both parts there, and triangles join the rims, as when two
//! drops meet, or the two sides of a dimpled cell.

use super::{Break, OpenParts, Parted, smooth};
use crate::repair::holes::borders;
use glam::DVec3;
use helfrich::{Surface, TriangleMesh};
use std::collections::HashMap;

/// The least cosine of the angle between one normal and the other turned round, and between these and the film's direction.
const FACING: f64 = 0.5;

/// Distance of the farthest point of a triangle with equal sides from its nearest corner, in parts of a side: 1/√3.
const FARTHEST: f64 = 0.577_350_269;

/// The surface with the thinnest of its films broken, if that is thinner than `thickness`, and joined around a hole of this
/// `radius`, which has to be longer than edges; none if no film is as thin, or no such hole has room.
///
/// A film is between two vertices, of one component or of two, that face each other outside or inside, one within the
/// neighbourhood of the other's foot. Triangles that stay come first, in their order.
pub fn joined(surface: Surface<'_, f64>, thickness: f64, radius: f64) -> Option<Parted> {
    let at = Vec::from_iter(surface.positions().iter().copied().map(DVec3::from));
    let mut films = films(surface, &at, thickness);
    films.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Vertices near each other have nearly the same film.
    let mut tried = Vec::<[DVec3; 2]>::new();
    for (_, ends) in films {
        let places = ends.map(|end| at[end as usize]);
        let is_near = |other: &[DVec3; 2]| (other[0] - places[0]).length() < radius;
        if tried.iter().any(is_near) {
            continue;
        }
        tried.push(places);
        let discs = ends.map(|end| disc(surface.mesh(), &at, end, radius));
        if let [Some(one), Some(other)] = discs
            && let Some(parts) = bridged(surface, [&one, &other])
        {
            return Some(parts);
        }
    }
    None
}

/// The films that are thinner than this: thickness and the vertices at both sides, the lower one first.
fn films(surface: Surface<'_, f64>, at: &[DVec3], thickness: f64) -> Vec<(f64, [u32; 2])> {
    let mesh = surface.mesh();
    let mut normals = vec![DVec3::ZERO; at.len()];
    for &[a, b, c] in mesh.triangles() {
        let [a, b, c] = [a, b, c].map(|corner| corner as usize);
        let doubled = (at[b] - at[a]).cross(at[c] - at[a]);
        for corner in [a, b, c] {
            normals[corner] += doubled;
        }
    }
    normals
        .iter_mut()
        .for_each(|normal| *normal = normal.normalize_or_zero());
    let edges = mesh.edges().iter();
    let longest = edges.map(|edge| {
        let [from, to] = edge.map(|end| at[end as usize]);
        (to - from).length()
    });
    let aside = FARTHEST * longest.fold(0.0, f64::max);
    let reach = thickness.hypot(aside);
    let cell = |at: DVec3| (at / reach).to_array().map(|x| x.floor() as i64);
    let mut cells = HashMap::<_, Vec<u32>>::new();
    for (vertex, &place) in (0..).zip(at) {
        if mesh.is_interior(vertex as usize) {
            cells.entry(cell(place)).or_default().push(vertex);
        }
    }
    let mut films = Vec::new();
    for (one, &place) in (0..).zip(at) {
        let [x, y, z] = cell(place);
        let near = (x - 1..=x + 1).flat_map(|x| {
            (y - 1..=y + 1).flat_map(move |y| (z - 1..=z + 1).map(move |z| [x, y, z]))
        });
        let near = near.filter_map(|cell| cells.get(&cell)).flatten();
        for &other in near.filter(|&&other| other > one) {
            let [n, m] = [normals[one as usize], normals[other as usize]];
            let apart = at[other as usize] - place;
            let across = (n - m).normalize_or_zero();
            let film = apart.dot(across);
            let faces = -n.dot(m) > FACING && mesh.is_interior(one as usize);
            let is_beside = (apart - film * across).length() <= aside;
            if faces && is_beside && film.abs() < thickness {
                films.push((film.abs(), [one, other]));
            }
        }
    }
    films
}

/// The vertices within this distance of one, which are connected with it; none if one of them is at a border.
fn disc(mesh: &TriangleMesh, at: &[DVec3], middle: u32, radius: f64) -> Option<Vec<u32>> {
    let mut disc = vec![middle];
    let mut next = 0;
    while let Some(&vertex) = disc.get(next) {
        next += 1;
        if !mesh.is_interior(vertex as usize) {
            return None;
        }
        for &beside in mesh.one_ring(vertex as usize) {
            let distance = (at[beside as usize] - at[middle as usize]).length();
            if distance < radius && !disc.contains(&beside) {
                disc.push(beside);
            }
        }
    }
    Some(disc)
}

/// The surface without two discs of vertices, and with triangles between their rims; none if they touch, or are no discs.
fn bridged(surface: Surface<'_, f64>, discs: [&[u32]; 2]) -> Option<Parted> {
    let mesh = surface.mesh();
    let mut rims = [Vec::new(), Vec::new()];
    for (rim, disc) in rims.iter_mut().zip(discs) {
        let rings = disc
            .iter()
            .flat_map(|&vertex| mesh.one_ring(vertex as usize));
        rim.extend(rings.filter(|vertex| !disc.contains(vertex)));
        rim.sort_unstable();
        rim.dedup();
    }
    let is_near = |vertex: &u32| {
        rims[1].contains(vertex)
            || discs[1].contains(vertex)
            || mesh
                .one_ring(*vertex as usize)
                .iter()
                .any(|other| rims[1].contains(other))
    };
    if rims[0].iter().any(is_near) {
        return None;
    }
    let is_removed = |vertex: &u32| discs.iter().any(|disc| disc.contains(vertex));
    let mut numbers = vec![u32::MAX; mesh.vertex_count()];
    let stay = (0..mesh.vertex_count() as u32).filter(|vertex| !is_removed(vertex));
    let vertices = Vec::from_iter(stay);
    for (new, &old) in (0..).zip(&vertices) {
        numbers[old as usize] = new;
    }
    let (removed, stay): (Vec<u32>, Vec<u32>) = (0..mesh.triangles().len() as u32)
        .partition(|&triangle| mesh.triangles()[triangle as usize].iter().any(is_removed));
    let corners = |&old: &u32| mesh.triangles()[old as usize].map(|old| numbers[old as usize]);
    let open = OpenParts {
        // A rim that touches itself is no circle.
        mesh: TriangleMesh::new(vertices.len(), stay.iter().map(corners).collect()).ok()?,
        positions: vertices
            .iter()
            .map(|&old| surface.positions()[old as usize])
            .collect(),
        vertices,
        triangles: stay,
    };
    let loops = rims.each_ref().map(|rim| {
        let is_own = |vertex: &u32| rim.contains(&open.vertices[*vertex as usize]);
        let mut own = borders(&open.mesh).filter(|border| border.iter().all(is_own));
        let border = own.next().filter(|border| border.len() == rim.len());
        border.filter(|_| own.next().is_none())
    });
    let [Some(one), Some(other)] = loops else {
        return None;
    };
    let old_beside = |vertex: u32| {
        let old = open.vertices[vertex as usize];
        let has = |triangle: &&u32| mesh.triangles()[**triangle as usize].contains(&old);
        removed.iter().find(has).map_or(0, |&triangle| triangle)
    };
    let mut triangles = open.mesh.triangles().to_vec();
    let mut beside = open.triangles.clone();
    for corners in between(&open.positions, &one, &other) {
        beside.push(old_beside(corners[0]));
        triangles.push(corners);
    }
    let mesh = TriangleMesh::new(open.positions.len(), triangles).ok()?;
    let mut positions = open.positions.clone();
    smooth(&mesh, &mut positions, &[one, other].concat());
    Some(Parted {
        change: Break::Film,
        mesh,
        flat: open.positions,
        positions,
        vertices: open.vertices,
        triangles: beside,
    })
}

/// Triangles between two closed paths that run opposite to each other, along the shorter of the two next edges each time.
fn between(positions: &[[f64; 3]], one: &[u32], other: &[u32]) -> Vec<[u32; 3]> {
    let distance = |a: u32, b: u32| {
        let [a, b] = [a, b].map(|vertex| DVec3::from(positions[vertex as usize]));
        (b - a).length()
    };
    let (m, n) = (one.len(), other.len());
    let pairs = (0..m).flat_map(|a| (0..n).map(move |b| (a, b)));
    let start = pairs.min_by(|&(a, b), &(c, d)| {
        distance(one[a], other[b]).total_cmp(&distance(one[c], other[d]))
    });
    let (first, last) = start.unwrap_or_default();
    // Steps along the one, and back along the other.
    let a = |step: usize| one[(first + step) % m];
    let b = |step: usize| other[(last + n - step % n) % n];
    let (mut i, mut j) = (0, 0);
    let mut triangles = Vec::with_capacity(m + n);
    while i < m || j < n {
        let along = j == n || i < m && distance(a(i + 1), b(j)) <= distance(a(i), b(j + 1));
        if along {
            triangles.push([a(i), a(i + 1), b(j)]);
            i += 1;
        } else {
            triangles.push([b(j + 1), b(j), a(i)]);
            j += 1;
        }
    }
    triangles
}
