//! One pass of a repair: every action once.
//!
//! Counts are differences between the mesh before and the mesh after the pass: two vertices that are merged and
//! taken apart again, because surfaces only touch there, count as nothing.

use super::neighbours::{Manifold, next};
use super::{Action, NEW, RepairReport, RepairSettings, Sheets, Soup, holes, sheets, slivers};
use crate::io::merged;
use crate::orientation::inside_out;
use glam::DVec3;
use helfrich::{MeshError, Surface, TriangleMesh};
use std::collections::BTreeSet;

/// Marks a vertex without a number.
const NONE: u32 = u32::MAX;

/// Vertices and triangles between two passes, with their origins.
pub(super) struct Pass {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) vertex_of: Vec<u32>,
    pub(super) triangle_of: Vec<u32>,
}

impl Pass {
    pub(super) fn new(soup: Soup) -> Self {
        Self {
            vertex_of: (0..soup.positions.len() as u32).collect(),
            triangle_of: (0..soup.triangles.len() as u32).collect(),
            positions: soup.positions,
            triangles: soup.triangles,
        }
    }

    pub(super) fn run(
        &mut self,
        settings: &RepairSettings,
        report: &mut RepairReport,
    ) -> Result<(), MeshError> {
        let was_used = self.used();
        let is_known = Vec::from_iter(
            self.positions
                .iter()
                .map(|point| DVec3::from(*point).is_finite()),
        );
        let count = self.retain(|corners| corners.iter().all(|&vertex| is_known[vertex as usize]));
        report.add(Action::NotFinite, count);
        let merged_into = self.merged_into(settings.weld);
        let name = |corners: [u32; 3]| corners.map(|vertex| merged_into[vertex as usize]);
        let count = self.retain(|&corners| {
            let [a, b, c] = name(corners);
            a != b && b != c && c != a
        });
        report.add(Action::Repeated, count);
        let is_first = first_of_their_vertices(self.triangles.iter().map(|&corners| name(corners)));
        report.add(Action::Duplicates, self.retain_by(&is_first));
        let mut named = Vec::from_iter(self.triangles.iter().map(|&corners| name(corners)));
        if named.is_empty() {
            return Ok(());
        }
        let mut manifold = Manifold::new(&self.positions, &named, &self.triangles);
        if settings.sheets == Sheets::Largest && !manifold.crowded.is_empty() {
            let is_large = sheets::are_large(&self.positions, &self.triangles, &manifold);
            report.add(Action::SmallSheets, self.retain_by(&is_large));
            retain_by(&mut named, &is_large);
            manifold = Manifold::new(&self.positions, &named, &self.triangles);
        }
        self.count_splits(&manifold, report);
        self.renumber(&manifold, report, |vertex| {
            if merged_into[vertex] as usize != vertex {
                Some(Action::Merged)
            } else if was_used[vertex] || settings.drop_unused || !is_known[vertex] {
                Some(Action::Unused)
            } else {
                None
            }
        });
        self.turn(manifold.is_reversed, settings.outward, report)?;
        if settings.fill > 0 {
            let mesh = self.mesh()?;
            let is_double = self.doubles(settings.weld);
            let filled = holes::fill(&self.positions, &mesh, &is_double, settings.fill);
            report.add(Action::Filled, filled.holes);
            report.holes_left = filled.left;
            self.triangle_of
                .extend(filled.triangles.iter().map(|_| NEW));
            self.triangles.extend(filled.triangles);
        }
        if settings.slivers > 0.0 {
            self.remove_slivers(settings, report);
        }
        Ok(())
    }

    fn mesh(&self) -> Result<TriangleMesh, MeshError> {
        TriangleMesh::new(self.positions.len(), self.triangles.clone())
    }

    /// Whether a triangle has each vertex.
    fn used(&self) -> Vec<bool> {
        let mut is_used = vec![false; self.positions.len()];
        for &vertex in self.triangles.as_flattened() {
            is_used[vertex as usize] = true;
        }
        is_used
    }

    /// Keeps some triangles, and returns the number of the others.
    fn retain(&mut self, is_kept: impl FnMut(&[u32; 3]) -> bool) -> usize {
        let is_kept = Vec::from_iter(self.triangles.iter().map(is_kept));
        self.retain_by(&is_kept)
    }

    fn retain_by(&mut self, is_kept: &[bool]) -> usize {
        retain_by(&mut self.triangle_of, is_kept);
        retain_by(&mut self.triangles, is_kept)
    }

    /// For each vertex the one that it is merged into: itself, if none before it is within the distance.
    fn merged_into(&self, distance: Option<f64>) -> Vec<u32> {
        let mut merged_into = Vec::from_iter(0..self.positions.len() as u32);
        let Some(distance) = distance else {
            return merged_into;
        };
        let is_used = self.used();
        let used = Vec::from_iter((0..is_used.len()).filter(|&vertex| is_used[vertex]));
        let points = used.iter().map(|&vertex| self.positions[vertex]);
        let (_, kept_of) = merged(points, distance);
        let mut kept = Vec::new();
        for (&vertex, &place) in used.iter().zip(&kept_of) {
            if place as usize == kept.len() {
                kept.push(vertex as u32);
            }
            merged_into[vertex] = kept[place as usize];
        }
        merged_into
    }

    /// Whether each vertex is near enough to another one to be merged, but was not, because surfaces only touch
    /// there. New edges between such vertices would make neighbours of other triangles when they are merged again.
    fn doubles(&self, distance: Option<f64>) -> Vec<bool> {
        let mut is_double = vec![false; self.positions.len()];
        for (vertex, &into) in self.merged_into(distance).iter().enumerate() {
            if into as usize != vertex {
                is_double[vertex] = true;
                is_double[into as usize] = true;
            }
        }
        is_double
    }

    /// Counts edges that are taken apart or cut, and vertices that are split elsewhere.
    fn count_splits(&self, manifold: &Manifold, report: &mut RepairReport) {
        let old = self.triangles.as_flattened();
        let fans = manifold.vertices.as_flattened();
        let ends = |names: &[u32], edge: u32| {
            let [from, to] = [edge, next(edge)].map(|corner| names[corner as usize]);
            [from.min(to), from.max(to)]
        };
        let is_changed = |edges: &[u32]| {
            let mut both = BTreeSet::new();
            let [mut before, mut after] = [BTreeSet::new(), BTreeSet::new()];
            for &edge in edges {
                let [was, is] = [ends(old, edge), ends(fans, edge)];
                before.insert(was);
                after.insert(is);
                both.insert([was, is]);
            }
            before.len() < both.len() || after.len() < both.len()
        };
        let mut is_end = vec![false; self.positions.len()];
        let crowded = manifold
            .crowded
            .iter()
            .map(|edges| (Action::Edges, &edges[..]));
        let cut = manifold.cut.iter().map(|edges| (Action::Cut, &edges[..]));
        for (action, edges) in crowded.chain(cut) {
            if is_changed(edges) {
                report.add(action, 1);
                for corner in edges.iter().flat_map(|&edge| [edge, next(edge)]) {
                    is_end[old[corner as usize] as usize] = true;
                }
            }
        }
        let mut fan_of = vec![NONE; self.positions.len()];
        let mut is_split = vec![false; self.positions.len()];
        for (&vertex, &fan) in old.iter().zip(fans) {
            let first = &mut fan_of[vertex as usize];
            if *first == NONE {
                *first = fan;
            }
            is_split[vertex as usize] |= *first != fan;
        }
        let split = is_split.iter().zip(&is_end);
        let bow_ties = split.filter(|&(is_split, is_end)| *is_split && !is_end);
        report.add(Action::BowTies, bow_ties.count());
    }

    /// Numbers fans as vertices. A fan keeps the number of its lowest vertex, unless another one has it: then it
    /// becomes a new vertex at the end. `left_out` says why a vertex without a fan is left out.
    fn renumber(
        &mut self,
        manifold: &Manifold,
        report: &mut RepairReport,
        left_out: impl Fn(usize) -> Option<Action>,
    ) {
        let old = self.triangles.as_flattened();
        let fans = manifold.vertices.as_flattened();
        let mut lowest = vec![NONE; old.len()];
        for (&vertex, &fan) in old.iter().zip(fans) {
            let lowest = &mut lowest[fan as usize];
            *lowest = vertex.min(*lowest);
        }
        // Only fans that are the first with their lowest vertex have its number.
        let mut has_fan = vec![false; self.positions.len()];
        let mut copies = Vec::new();
        for (fan, &vertex) in lowest.iter().enumerate() {
            if vertex != NONE && std::mem::replace(&mut has_fan[vertex as usize], true) {
                copies.push(fan);
            }
        }
        let mut is_used = vec![false; self.positions.len()];
        for &vertex in old {
            is_used[vertex as usize] = true;
        }
        let is_kept = Vec::from_iter((0..has_fan.len()).map(|vertex| {
            if has_fan[vertex] {
                return true;
            }
            let reason = match is_used[vertex] {
                true => Some(Action::Merged),
                false => left_out(vertex),
            };
            if let Some(action) = reason {
                report.add(action, 1);
            }
            reason.is_none()
        }));
        let mut numbers = numbered(&is_kept);
        let kept = is_kept.iter().filter(|&&is_kept| is_kept).count();
        let mut fan_numbers = Vec::from_iter(lowest.iter().map(|&vertex| match vertex {
            NONE => NONE,
            vertex => numbers[vertex as usize],
        }));
        for (number, &fan) in (kept as u32..).zip(&copies) {
            fan_numbers[fan] = number;
            let vertex = lowest[fan] as usize;
            self.positions.push(self.positions[vertex]);
            self.vertex_of.push(self.vertex_of[vertex]);
        }
        let is_kept = Vec::from_iter(is_kept.into_iter().chain(copies.iter().map(|_| true)));
        numbers.clear();
        retain_by(&mut self.positions, &is_kept);
        retain_by(&mut self.vertex_of, &is_kept);
        for (corners, fans) in self.triangles.iter_mut().zip(&manifold.vertices) {
            *corners = fans.map(|fan| fan_numbers[fan as usize]);
        }
    }

    /// Reverses triangles that contradict their neighbours, and turns closed components that are inside out: those
    /// of which triangles were reversed, and others on request.
    fn turn(
        &mut self,
        mut is_reversed: Vec<bool>,
        outward: bool,
        report: &mut RepairReport,
    ) -> Result<(), MeshError> {
        let reverse = |triangles: &mut [[u32; 3]], is_reversed: &[bool]| {
            for (corners, &is_reversed) in triangles.iter_mut().zip(is_reversed) {
                if is_reversed {
                    corners.swap(1, 2);
                }
            }
        };
        reverse(&mut self.triangles, &is_reversed);
        if !is_reversed.contains(&true) && !outward {
            return Ok(());
        }
        let mesh = self.mesh()?;
        let (component_of, components) = mesh.components();
        let component = |corners: &[u32; 3]| component_of[corners[0] as usize] as usize;
        let mut is_changed = vec![false; components];
        for (corners, &is_reversed) in self.triangles.iter().zip(&is_reversed) {
            is_changed[component(corners)] |= is_reversed;
        }
        let mut is_turned = vec![false; components];
        // A surface that is too large to be computed with has no volume.
        let found = Surface::new(&mesh, &self.positions[..]).map(inside_out);
        for inward in found.unwrap_or_default() {
            let component = component_of[inward.first] as usize;
            is_turned[component] = outward || is_changed[component];
            if is_turned[component] && !is_changed[component] {
                report.add(Action::Turned, 1);
            }
        }
        let turned = self
            .triangles
            .iter()
            .map(|corners| is_turned[component(corners)]);
        let turned = Vec::from_iter(turned);
        for ((is_reversed, turned), corners) in
            is_reversed.iter_mut().zip(&turned).zip(&self.triangles)
        {
            *is_reversed ^= turned & is_changed[component(corners)];
        }
        reverse(&mut self.triangles, &turned);
        let count = is_reversed
            .iter()
            .filter(|&&is_reversed| is_reversed)
            .count();
        report.add(Action::Reversed, count);
        Ok(())
    }

    fn remove_slivers(&mut self, settings: &RepairSettings, report: &mut RepairReport) {
        let was_used = self.used();
        let is_double = self.doubles(settings.weld);
        let angle = settings.slivers.to_radians();
        let removed = slivers::remove(&self.positions, &mut self.triangles, &is_double, angle);
        report.add(Action::Flipped, removed.flipped);
        report.add(Action::Collapsed, removed.collapsed);
        report.slivers_left = removed.left;
        self.retain_by(&removed.is_kept);
        let is_used = self.used();
        let is_kept = Vec::from_iter(was_used.iter().zip(&is_used).map(|(was, is)| *is || !was));
        let numbers = numbered(&is_kept);
        retain_by(&mut self.positions, &is_kept);
        retain_by(&mut self.vertex_of, &is_kept);
        for corner in self.triangles.as_flattened_mut() {
            *corner = numbers[*corner as usize];
        }
    }
}

/// Keeps some entries, and returns the number of the others.
fn retain_by<T>(list: &mut Vec<T>, is_kept: &[bool]) -> usize {
    let before = list.len();
    let mut is_kept = is_kept.iter();
    list.retain(|_| is_kept.next() == Some(&true));
    before - list.len()
}

/// The new number of each entry that is kept.
fn numbered(is_kept: &[bool]) -> Vec<u32> {
    let mut next = 0;
    let number = |&is_kept: &bool| {
        let number = next;
        next += u32::from(is_kept);
        number
    };
    is_kept.iter().map(number).collect()
}

/// Whether each triangle is the first with its three vertices.
fn first_of_their_vertices(triangles: impl Iterator<Item = [u32; 3]>) -> Vec<bool> {
    let mut sorted = Vec::from_iter(triangles.zip(0u32..).map(|(mut corners, triangle)| {
        corners.sort_unstable();
        (corners, triangle)
    }));
    sorted.sort_unstable();
    let mut is_first = vec![true; sorted.len()];
    for pair in sorted.windows(2) {
        if pair[0].0 == pair[1].0 {
            is_first[pair[1].1 as usize] = false;
        }
    }
    is_first
}
