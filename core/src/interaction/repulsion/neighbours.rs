//! Vertices and triangles that may come near each other, listed for several evaluations.

use super::super::cells::{Cells, MARGIN, Near, Place, Sorted};
use super::near::{Bounds, NearFace, NearVertex, around_all, boxed, meet};
use super::{Pairs, Repulsion};
use crate::element::{Execution, Ragged};
use crate::lane::Lane;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, norm, scale, sub};
use alloc::vec::Vec;
use core::ops::Range;

/// Vertices with the triangles that may come near each of them: all that were within the range and a *skin* of each other
/// when they were searched for. The list holds until surfaces have moved by the skin relative to each other. Translations
/// of all surfaces together do not count, and translations of one only against surfaces that it can meet.
///
/// Vertices and their triangles are in the order of surfaces and numbers. Sums over those within the range therefore
/// do not depend on when the list was made.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbours<T> {
    /// For each surface whether forces on it are wanted, if not on all.
    only: Option<Vec<bool>>,
    /// The repulsion for which they were searched, and the number of evaluations since then.
    searched: Option<(Repulsion<T>, u32)>,
    skin: T,
    /// Meshes of the surfaces, by fingerprint and number of vertices, and all positions at the search.
    meshes: Vec<(u64, usize)>,
    positions: Vec<Vec3<T>>,
    /// Surfaces that can meet before the list ends.
    close: Vec<[u32; 2]>,
    motions: Vec<Motion<T>>,
    vertices: Vec<Listed>,
    faces: Vec<[u32; 2]>,
    pairs: Vec<u32>,
    searches: u64,
    bounds: Vec<Bounds<T>>,
    /// The widened boxes of other surfaces and of images that intersect the box of one surface.
    near: Vec<Bounds<T>>,
    vertex_places: Sorted<T>,
    face_places: Sorted<T>,
    near_vertices: Vec<Near>,
    /// Where the triangles of each place of a vertex begin among the pairs.
    offsets: Vec<usize>,
    /// The triangles of which the middles are near vertices.
    found: Vec<[u32; 2]>,
    /// The number of each place of a triangle among these, then of each of these among `faces`.
    numbers: Vec<u32>,
}

/// A vertex that triangles may come near.
#[derive(Clone, Copy, Debug)]
pub(super) struct Listed {
    /// The surface and the number of the vertex in it.
    pub(super) place: [u32; 2],
    /// The first of these triangles among the pairs, and the first one after them.
    pairs: [usize; 2],
}

impl Listed {
    /// Where these triangles are among the pairs.
    pub(super) fn pairs(&self) -> Range<usize> {
        let [begin, end] = self.pairs;
        begin..end
    }
}

/// Mean displacement of a surface's vertices since the search, and the largest distance of one from it.
#[derive(Clone, Copy, Debug)]
struct Motion<T> {
    mean: Vec3<T>,
    rest: T,
}

/// Surfaces are watched one by one if they are within the range and this number of skins; all others together may move so
/// far.
const CLOSE: f64 = 8.0;

/// Number of evaluations that a list should last, as surfaces moved before. With many the lists are long, with few there
/// are many searches.
const LASTING: f64 = 16.0;

/// No triangle.
const NONE: u32 = u32::MAX;

/// Smallest and largest skin over the range.
const SKINS: [f64; 2] = [1.0 / 16.0, 0.5];

impl<T: Real> Motion<T> {
    fn new(positions: &[Vec3<T>], before: &[Vec3<T>]) -> Self {
        let moved = || positions.iter().zip(before).map(|(&x, &y)| sub(x, y));
        let over = T::from_usize(positions.len()).map_or(T::zero(), T::reciprocal_or_zero);
        let mean = scale(over, moved().fold([T::zero(); 3], add));
        let squares = moved().map(|moved| {
            let apart = sub(moved, mean);
            apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2]
        });
        Self {
            mean,
            rest: squares.fold(T::zero(), T::max).sqrt(),
        }
    }
}

impl<T: Real> Neighbours<T> {
    /// In the order of surfaces and numbers.
    pub(super) fn vertices(&self) -> &[Listed] {
        &self.vertices
    }

    /// Surfaces and numbers of triangles.
    pub(super) fn faces(&self) -> &[[u32; 2]] {
        &self.faces
    }

    /// The triangles of all vertices: their numbers among [`Self::faces`].
    pub(super) fn pairs(&self) -> &[u32] {
        &self.pairs
    }

    /// Lists only what acts on some surfaces.
    pub(super) fn limit_to(&mut self, only: Option<&[bool]>) {
        if self.only.as_deref() != only {
            (self.only, self.searched) = (only.map(<[bool]>::to_vec), None);
        }
    }

    /// Number of vertices that the last search found near the box of another surface or an image.
    pub(super) fn candidates(&self) -> usize {
        self.vertex_places.places.len()
    }

    pub(super) fn searches(&self) -> u64 {
        self.searches
    }

    /// Makes the list anew if surfaces, or what is asked for, may have changed too much. The content of `scratch` does not
    /// matter.
    pub(super) fn update(
        &mut self,
        execution: &impl Execution,
        repulsion: &Repulsion<T>,
        surfaces: &[Surface<'_, T>],
        scratch: &mut Vec<NearFace<T>>,
    ) {
        let moved = self.moved(repulsion, surfaces);
        if moved.is_some_and(|moved| moved <= self.skin) {
            self.searched.iter_mut().for_each(|(_, since)| *since += 1);
            return;
        }
        self.skin = self.next_skin(repulsion.range, moved);
        self.search(execution, repulsion, surfaces, scratch);
        self.searched = Some((*repulsion, 1));
        self.searches += 1;
    }

    /// Largest motion relative to other surfaces since the search, by which vertices may have come nearer; none if what was
    /// searched for has changed.
    fn moved(&mut self, repulsion: &Repulsion<T>, surfaces: &[Surface<'_, T>]) -> Option<T> {
        let (searched, _) = self.searched?;
        let same_terms = Repulsion {
            modulus: repulsion.modulus,
            attraction: repulsion.attraction,
            ..searched
        } == *repulsion;
        let meshes = surfaces.iter().map(mesh_of);
        if !same_terms || !meshes.eq(self.meshes.iter().copied()) {
            return None;
        }
        let mut before = self.positions.as_slice();
        self.motions.clear();
        self.motions.extend(surfaces.iter().map(|surface| {
            let (own, rest) = before.split_at(surface.positions().len());
            before = rest;
            Motion::new(surface.positions(), own)
        }));
        let over = T::from_usize(surfaces.len()).map_or(T::zero(), T::reciprocal_or_zero);
        let means = self.motions.iter().map(|motion| motion.mean);
        let mean = scale(over, means.fold([T::zero(); 3], add));
        let close = self.close.iter().map(|&pair| {
            let [one, other] = pair.map(|surface| self.motions[surface as usize]);
            norm(sub(one.mean, other.mean)) + one.rest + other.rest
        });
        let twice = T::constant(2.0 / CLOSE);
        let all = self.motions.iter();
        let all = all.map(|motion| twice * (norm(sub(motion.mean, mean)) + motion.rest));
        let moved = close.chain(all).fold(T::zero(), |most, moved| {
            // A value that is no number is the largest.
            if moved <= most { most } else { moved }
        });
        Some(moved)
    }

    /// A skin for [`LASTING`] evaluations; 0 if nothing is known, and if surfaces move so fast that no skin pays.
    fn next_skin(&self, range: T, moved: Option<T>) -> T {
        let [least, most] = SKINS.map(|skin| T::constant(skin) * range);
        let evaluations = self.searched.and_then(|(_, since)| T::from_u32(since));
        let (Some(moved), Some(evaluations)) = (moved, evaluations) else {
            return T::zero();
        };
        let lasting = T::constant(LASTING) * moved / evaluations;
        if lasting <= T::constant(LASTING / 4.0) * most {
            lasting.max(least).min(most)
        } else {
            T::zero()
        }
    }

    /// Makes the list.
    fn search(
        &mut self,
        execution: &impl Execution,
        repulsion: &Repulsion<T>,
        surfaces: &[Surface<'_, T>],
        near_faces: &mut Vec<NearFace<T>>,
    ) {
        let positions = surfaces.iter().flat_map(|surface| surface.positions());
        self.positions.clear();
        self.positions.extend(positions);
        self.meshes.clear();
        self.meshes.extend(surfaces.iter().map(mesh_of));
        self.vertices.clear();
        self.faces.clear();
        self.pairs.clear();
        let width = self.find_places(repulsion, surfaces);
        if !self.vertex_places.places.is_empty() && !self.face_places.places.is_empty() {
            self.find_pairs(execution, repulsion, width);
            self.keep_near(execution, repulsion, surfaces, near_faces);
        }
    }

    /// Sets the pairs of vertices and triangles whose middles are within reach, in the order of places.
    fn find_pairs(&mut self, execution: &impl Execution, repulsion: &Repulsion<T>, width: T) {
        let Self {
            pairs,
            vertex_places,
            face_places,
            near_vertices,
            offsets,
            found,
            numbers,
            ..
        } = self;
        let both = vertex_places.places.iter().chain(&face_places.places);
        let bounds = around_all(both.map(|place| place.middle));
        let cells = Cells::new(&repulsion.images, width, bounds);
        vertex_places.sort(&cells);
        face_places.sort(&cells);
        near_vertices.resize(vertex_places.cells.len(), Near::default());
        execution.map(&mut near_vertices[..], |k, near| {
            *near = cells.near(face_places, vertex_places.cells[k]);
        });
        let places = vertex_places.places.as_slice();
        offsets.clear();
        offsets.resize(places.len() + 1, 0);
        execution.map(&mut offsets[1..], |k, count| {
            cells.each_near(face_places, near_vertices, &places[k], |_| *count += 1);
        });
        for k in 0..places.len() {
            offsets[k + 1] += offsets[k];
        }
        pairs.resize(offsets[places.len()], 0);
        execution.map(Ragged::new(pairs, offsets), |k, slots: &mut [u32]| {
            let mut free = slots.iter_mut();
            cells.each_near(face_places, near_vertices, &places[k], |face| {
                free.next().into_iter().for_each(|slot| *slot = face as u32);
            });
        });
        found.clear();
        numbers.clear();
        numbers.resize(face_places.places.len(), NONE);
        for pair in &mut *pairs {
            let place = &face_places.places[*pair as usize];
            *pair = number(&mut numbers[*pair as usize], found, place_of(place));
        }
    }

    /// Keeps the pairs that are within the range and the skin, and lists their vertices.
    fn keep_near(
        &mut self,
        execution: &impl Execution,
        repulsion: &Repulsion<T>,
        surfaces: &[Surface<'_, T>],
        near_faces: &mut Vec<NearFace<T>>,
    ) {
        let Self {
            vertices,
            faces,
            pairs,
            vertex_places,
            offsets,
            found,
            numbers,
            only,
            ..
        } = self;
        let places = vertex_places.places.as_slice();
        // Wider than the range and the skin by more than rounding: a pair that is left out stays beyond the range.
        let reach = T::constant(1.0 + MARGIN) * (repulsion.range + self.skin);
        near_faces.resize(found.len(), NearFace::default());
        execution.map(&mut near_faces[..], |k, face| {
            *face = NearFace::new(found[k], surfaces[found[k][0] as usize], reach);
        });
        let near = Pairs::new(repulsion, reach);
        execution.map(Ragged::new(pairs, offsets), |k, slots: &mut [u32]| {
            let place = place_of(&places[k]);
            let vertex = NearVertex::at(place, surfaces[place[0] as usize]);
            let mut kept = 0;
            for k in 0..slots.len() {
                let face = slots[k] as usize;
                let both = [place[0] as usize, found[face][0] as usize];
                if act(repulsion, only.as_deref(), both) && near.is_near(&vertex, &near_faces[face])
                {
                    slots[kept] = slots[k];
                    kept += 1;
                }
            }
            let (kept, rest) = slots.split_at_mut(kept);
            kept.sort_unstable_by_key(|&face| found[face as usize]);
            rest.fill(NONE);
        });
        let mut kept = 0;
        for (place, ends) in places.iter().zip(offsets.windows(2)) {
            let begin = kept;
            for k in ends[0]..ends[1] {
                if pairs[k] == NONE {
                    break;
                }
                pairs[kept] = pairs[k];
                kept += 1;
            }
            if begin < kept {
                vertices.push(Listed {
                    place: place_of(place),
                    pairs: [begin, kept],
                });
            }
        }
        pairs.truncate(kept);
        vertices.sort_unstable_by_key(|listed| listed.place);
        // Triangles are numbered as vertices meet them, so that what is read together lies together.
        numbers.clear();
        numbers.resize(found.len(), NONE);
        for listed in vertices {
            for pair in &mut pairs[listed.pairs()] {
                let face = *pair as usize;
                *pair = number(&mut numbers[face], faces, found[face]);
            }
        }
    }

    /// Finds the surfaces that are close, the vertices in the widened box of another surface or of an image, and the triangles
    /// that intersect it; all of them where parts of a surface act on each other. Returns the width that cells need at least.
    fn find_places(&mut self, repulsion: &Repulsion<T>, surfaces: &[Surface<'_, T>]) -> T {
        let Self {
            bounds,
            near,
            close,
            vertex_places,
            face_places,
            only,
            ..
        } = self;
        vertex_places.clear();
        face_places.clear();
        close.clear();
        let wider = T::constant(1.0 + MARGIN);
        let within = wider * (repulsion.range + self.skin);
        let beyond = wider * (repulsion.range + T::constant(CLOSE) * self.skin);
        let images = &repulsion.images;
        let mut width = within;
        bounds.clear();
        bounds.extend(
            surfaces
                .iter()
                .map(|surface| around_all(surface.positions().iter().copied())),
        );
        for (a, surface) in surfaces.iter().enumerate() {
            near.clear();
            let wanted = act(repulsion, only.as_deref(), [a, a]);
            let mut own = repulsion.parts && wanted;
            let others = (0..surfaces.len()).filter(|&b| act(repulsion, only.as_deref(), [a, b]));
            for b in others.filter(|&b| a != b || images.own) {
                let [low, high] = bounds[b];
                let widened = |by: T| [low.map(|x| x - by), high.map(|x| x + by)];
                let before = near.len();
                images.add_meeting(widened(beyond), bounds[a], a == b, near);
                if near.len() == before {
                    continue;
                }
                if a <= b {
                    close.push([a as u32, b as u32]);
                }
                near.truncate(before);
                images.add_meeting(widened(within), bounds[a], a == b, near);
                own |= a == b && near.len() > before;
            }
            if repulsion.parts && wanted {
                near.push(bounds[a]);
                close.push([a as u32; 2]);
            }
            if near.is_empty() {
                continue;
            }
            let places = [&mut vertex_places.places, &mut face_places.places];
            let reach = repulsion.range + self.skin;
            width = width.max(add_places(a as u32, *surface, own, reach, near, places));
        }
        width
    }
}

/// Whether two surfaces may act on each other, of which forces on one are wanted.
fn act<T: Real>(repulsion: &Repulsion<T>, only: Option<&[bool]>, both: [usize; 2]) -> bool {
    let wanted = |only: &[bool]| both.iter().any(|&surface| only.get(surface) == Some(&true));
    only.is_none_or(wanted) && repulsion.acts(both[0], both[1])
}

/// The number of a triangle, a new one at the end of `faces` if it has none yet.
fn number(known: &mut u32, faces: &mut Vec<[u32; 2]>, face: [u32; 2]) -> u32 {
    if *known == NONE {
        *known = faces.len() as u32;
        faces.push(face);
    }
    *known
}

fn place_of<T>(place: &Place<T>) -> [u32; 2] {
    [place.surface, place.number]
}

/// The mesh of a surface.
fn mesh_of<T: Real>(surface: &Surface<'_, T>) -> (u64, usize) {
    (surface.mesh().fingerprint(), surface.positions().len())
}

/// Adds the vertices and triangles of a surface that are near some boxes, and returns the width that cells need at least
/// for these.
fn add_places<T: Real>(
    surface_number: u32,
    surface: Surface<'_, T>,
    own: bool,
    range: T,
    near: &[Bounds<T>],
    [vertices, faces]: [&mut Vec<Place<T>>; 2],
) -> T {
    let zero = T::zero();
    let is_near = |bounds: &Bounds<T>| near.iter().any(|other| meet(bounds, other));
    let place = |number: usize, middle, reach| Place {
        cell: 0,
        occupied: 0,
        surface: surface_number,
        number: number as u32,
        own,
        middle,
        reach,
    };
    let positions = surface.positions();
    for (vertex, &position) in positions.iter().enumerate() {
        if is_near(&[position; 2]) {
            vertices.push(place(vertex, position, zero));
        }
    }
    let mut width = zero;
    for (triangle, &corners) in surface.mesh().triangles().iter().enumerate() {
        let places = corners.map(|corner| positions[corner as usize]);
        if is_near(&around_all(places.into_iter())) {
            let (edges, [centre, sides]) = boxed(surface, corners, range);
            let middle = add(places[0], centre);
            let farthest = [[zero; 3], edges[0], edges[1]].map(|to| norm(sub(to, centre)));
            let farthest = farthest.into_iter().fold(zero, T::max);
            let reach = T::constant(1.0 + MARGIN) * (farthest + range);
            width = sides.into_iter().fold(width, T::max);
            faces.push(place(triangle, middle, reach));
        }
    }
    width
}
