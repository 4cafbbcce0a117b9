//! Surfaces that part and join: necks are cut and closed on both sides, holes are closed, films break.
//!
//! Necks and holes are found where they are shorter around than a circle of a given radius, films where they are thinner
//! than a given thickness, one at a time.

mod films;
mod necks;

pub use self::films::joined;

use self::necks::neck;
use crate::repair::holes::borders;
use glam::DVec3;
use helfrich::edit::EditableMesh;
use helfrich::{Surface, TriangleMesh};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Rounds in which a new cap or rim and its surroundings are smoothed; it starts with an edge.
const ROUNDS: usize = 6;

/// A change of the topology of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Break {
    /// A neck is cut, and closed on both sides.
    Neck,
    /// A hole is closed.
    Hole,
    /// A film between two parts that face each other breaks, and they join around it.
    Film,
}

/// A surface after a change of its topology.
#[derive(Clone, Debug)]
pub struct Parted {
    /// The change.
    pub change: Break,
    /// The mesh. New triangles follow those that were there before.
    pub mesh: TriangleMesh,
    /// The positions with flat caps: the parts of a closed surface together have its volume. Or with rims where they were.
    pub flat: Vec<[f64; 3]>,
    /// The positions with smoothed caps or rims.
    pub positions: Vec<[f64; 3]>,
    /// For each vertex the old one there, or one next to it.
    pub vertices: Vec<u32>,
    /// For each triangle the old one there, or one next to it.
    pub triangles: Vec<u32>,
}

/// The surface with a hole closed, or else with the thinnest neck cut and closed on both sides; none if no hole and no neck
/// is shorter around than a circle of this radius.
///
/// A neck is a closed path of edges that cannot be shrunk to a point within half its greatest length. No part becomes smaller
/// than a sphere of the radius, by its area.
pub fn parted(surface: Surface<'_, f64>, radius: f64) -> Option<Parted> {
    let longest = 2.0 * PI * radius;
    // A part that is hardly more than its caps is none, and a small patch has no hole.
    let least = 4.0 * PI * radius * radius;
    let whole = OpenParts::of(surface);
    let is_hole = |border: &Vec<u32>| {
        around(surface, border) <= longest && whole.smallest(surface, border) > least
    };
    if let Some(hole) = borders(surface.mesh()).find(is_hole) {
        return Some(whole.closed(&[hole], Break::Hole));
    }
    let is_neck = |path: &[u32]| cut(surface, path).smallest(surface, path) > least;
    let path = neck(surface, longest, is_neck)?;
    let open = cut(surface, &path);
    let own = |border: &Vec<u32>| {
        border
            .iter()
            .all(|&vertex| path.contains(&open.vertices[vertex as usize]))
    };
    let sides = Vec::from_iter(borders(&open.mesh).filter(own));
    Some(open.closed(&sides, Break::Neck))
}

/// The length of a closed path.
fn around(surface: Surface<'_, f64>, path: &[u32]) -> f64 {
    let next = path.iter().cycle().skip(1);
    let edges = path.iter().zip(next);
    edges
        .map(|(&from, &to)| DVec3::from_array(surface.difference(from, to)).length())
        .sum()
}

/// A mesh of vertices and triangles of another one.
struct OpenParts {
    mesh: TriangleMesh,
    positions: Vec<[f64; 3]>,
    vertices: Vec<u32>,
    triangles: Vec<u32>,
}

/// The surface cut along a closed path of edges.
fn cut(surface: Surface<'_, f64>, path: &[u32]) -> OpenParts {
    let next = path.iter().cycle().skip(1);
    let lines = path.iter().zip(next).map(|(&from, &to)| [from, to]);
    let edited = EditableMesh::with_lines(surface.mesh(), &Vec::from_iter(lines)).cut();
    let positions = edited.vertices.iter();
    OpenParts {
        positions: positions
            .map(|&old| surface.positions()[old as usize])
            .collect(),
        vertices: edited.vertices,
        triangles: Vec::from_iter(0..edited.mesh.triangles().len() as u32),
        mesh: edited.mesh,
    }
}

impl OpenParts {
    fn of(surface: Surface<'_, f64>) -> Self {
        let mesh = surface.mesh().clone();
        Self {
            positions: surface.positions().to_vec(),
            vertices: Vec::from_iter(0..mesh.vertex_count() as u32),
            triangles: Vec::from_iter(0..mesh.triangles().len() as u32),
            mesh,
        }
    }

    /// The least area of the components that have one of these vertices of the surface, from the areas there.
    fn smallest(&self, old: Surface<'_, f64>, vertices: &[u32]) -> f64 {
        let (components, count) = self.mesh.components();
        let mut areas = vec![0.0; count];
        for (triangle, corners) in self.mesh.triangles().iter().enumerate() {
            areas[components[corners[0] as usize] as usize] += old.triangle_area(triangle);
        }
        let here = self.vertices.iter().zip(&components);
        let here = here.filter(|(vertex, _)| vertices.contains(vertex));
        let areas = here.map(|(_, &component)| areas[component as usize]);
        areas.fold(f64::INFINITY, f64::min)
    }

    /// Closes these borders by caps: triangles around a new vertex in their middle, or one.
    fn closed(mut self, borders: &[Vec<u32>], change: Break) -> Parted {
        let mut triangles = self.mesh.triangles().to_vec();
        let mut caps = Vec::new();
        for border in borders {
            caps.extend(border);
            let mut add = |corners| {
                triangles.push(corners);
                // A triangle of the border.
                let own = |old: &[u32; 3]| old.contains(&border[0]);
                let beside = self.mesh.triangles().iter().position(own);
                self.triangles
                    .push(beside.map_or(0, |beside| self.triangles[beside]));
            };
            if let &[a, b, c] = &border[..] {
                add([a, b, c]);
                continue;
            }
            let middle = self.positions.len() as u32;
            let corners = border.iter().zip(border.iter().cycle().skip(1));
            for (&from, &to) in corners {
                add([from, to, middle]);
            }
            let sum: DVec3 = border
                .iter()
                .map(|&vertex| DVec3::from(self.positions[vertex as usize]))
                .sum();
            self.positions.push((sum / border.len() as f64).to_array());
            self.vertices.push(self.vertices[border[0] as usize]);
            caps.push(middle);
        }
        let mesh = TriangleMesh::new(self.positions.len(), triangles);
        let mesh = mesh.expect("caps of borders of an oriented manifold");
        let mut positions = self.positions.clone();
        smooth(&mesh, &mut positions, &caps);
        Parted {
            change,
            mesh,
            flat: self.positions,
            positions,
            vertices: self.vertices,
            triangles: self.triangles,
        }
    }
}

/// Moves caps and their neighbours half of the way to the middle of their neighbours, again and again.
fn smooth(mesh: &TriangleMesh, positions: &mut [[f64; 3]], caps: &[u32]) {
    let neighbours = caps.iter().flat_map(|&cap| mesh.one_ring(cap as usize));
    let mut moving = Vec::from_iter(caps.iter().chain(neighbours).copied());
    moving.sort_unstable();
    moving.dedup();
    let at = |positions: &[[f64; 3]], vertex: u32| DVec3::from(positions[vertex as usize]);
    for _ in 0..ROUNDS {
        let moved = moving.iter().map(|&vertex| {
            let ring = mesh.one_ring(vertex as usize);
            let sum: DVec3 = ring.iter().map(|&other| at(positions, other)).sum();
            0.5 * (at(positions, vertex) + sum / ring.len() as f64)
        });
        let moved = Vec::from_iter(moved);
        for (&vertex, moved) in moving.iter().zip(moved) {
            positions[vertex as usize] = moved.to_array();
        }
    }
}
