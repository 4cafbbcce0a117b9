//! Builder of a mesh from the vertices and faces of a file.

use helfrich::{MeshError, TriangleMesh};

use super::{Element, MeshFile, ParseError, Place, Position, Problem};
use crate::polygon::triangulate;
use crate::repair::Soup;

/// Vertices and faces read so far, before they become a mesh.
pub(super) struct MeshBuilder {
    pub(super) positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// First triangle and number of triangles of each face with more than three corners. Until all positions are
    /// known, its triangles are the fan around its first corner.
    polygons: Vec<(usize, usize)>,
    /// Places of faces in the file, with the first triangle of each.
    origins: Vec<Origin>,
    /// The number of faces so far.
    faces: usize,
    /// The number of faces with fewer than three corners, which have no triangle.
    short_faces: usize,
    /// The first face with fewer than three corners or a repeated one.
    refused: Option<ParseError>,
    /// The number of the first vertex and the first face: 1 in OBJ, 0 elsewhere.
    first: usize,
    /// Whether vertices of no face are left out, because they are nodes of other cells.
    pub(super) leaves_out_unused: bool,
}

/// [`Place`] of a single face, or of many triangles at equal distances in the file.
#[derive(Clone, Copy)]
struct Origin {
    /// First triangle of this origin; its triangles extend to the next origin.
    triangle: usize,
    position: Position,
    face: usize,
    /// Lines or bytes from each triangle to the next; 0 for a single face.
    step: usize,
}

impl MeshBuilder {
    pub(super) fn new(first: usize) -> Self {
        Self {
            positions: Vec::new(),
            triangles: Vec::new(),
            polygons: Vec::new(),
            origins: Vec::new(),
            faces: 0,
            short_faces: 0,
            refused: None,
            first,
            leaves_out_unused: false,
        }
    }

    /// Number of triangles so far.
    pub(super) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Adds a triangle of a strip or a fan, in which triangles with a repeated corner join others.
    pub(super) fn add_part(&mut self, triangle: [u32; 3], position: Position) {
        if check_corners(&triangle).is_ok() {
            self.add_face(&triangle, position);
        }
    }

    /// Reserves memory for the numbers that a header announces, limited by the remaining bytes of
    /// the file.
    pub(super) fn reserve(&mut self, vertices: usize, faces: usize, bytes: usize) {
        // Few vertices or faces take less than six bytes; if they do, the lists grow on demand.
        let most = bytes / 6;
        self.positions.reserve(vertices.min(most));
        self.triangles.reserve(faces.min(most));
    }

    /// Number of the next vertex, for messages.
    pub(super) fn next_vertex(&self) -> Element {
        Element::Vertex(self.positions.len() + self.first)
    }

    /// Number of the next face, for messages.
    pub(super) fn next_face(&self) -> Element {
        Element::Face(self.faces + self.first)
    }

    /// Adds a face whose corners count vertices from 0; [`Self::finish`] checks that they exist.
    pub(super) fn add_face(&mut self, corners: &[u32], position: Position) {
        if let Err(problem) = check_corners(corners) {
            let face = self.next_face();
            self.refused
                .get_or_insert_with(|| problem.at(position, Some(face)));
        }
        if corners.len() < 3 {
            self.short_faces += 1;
            self.faces += 1;
            return;
        }
        self.add_origin(position, corners.len() == 3);
        if corners.len() > 3 {
            self.polygons
                .push((self.triangles.len(), corners.len() - 2));
        }
        for pair in corners[1..].windows(2) {
            self.triangles.push([corners[0], pair[0], pair[1]]);
        }
        self.faces += 1;
    }

    /// Adds triangles, and returns their number. The first is at the byte `start`, and the others follow at
    /// equal distances.
    pub(super) fn add_triangles(
        &mut self,
        triangles: impl Iterator<Item = [u32; 3]>,
        start: usize,
        step: usize,
    ) -> usize {
        let triangle = self.triangles.len();
        self.origins.push(Origin {
            triangle,
            position: Position::Byte(start),
            face: self.faces,
            step,
        });
        self.triangles.extend(triangles);
        let added = &self.triangles[triangle..];
        let checks = added.iter().map(|corners| check_corners(corners));
        let refused = checks
            .enumerate()
            .find_map(|(at, check)| Some((at, check.err()?)));
        let count = added.len();
        if let Some((at, problem)) = refused {
            let place = self.place(triangle + at);
            self.refused.get_or_insert(ParseError {
                places: vec![place],
                problem,
            });
        }
        self.faces += count;
        count
    }

    /// Gives every corner the vertex that `name` returns for its own.
    pub(super) fn rename(&mut self, name: impl Fn(u32) -> u32) {
        let corners = self.triangles.as_flattened_mut();
        corners
            .iter_mut()
            .for_each(|corner| *corner = name(*corner));
    }

    /// Reverses the orientation of the triangles from this one on.
    pub(super) fn reverse_from(&mut self, triangle: usize) {
        for corners in &mut self.triangles[triangle..] {
            corners.swap(1, 2);
        }
    }

    /// Stores the place of the next face. Triangles at equal distances share one origin.
    fn add_origin(&mut self, position: Position, is_triangle: bool) {
        let triangle = self.triangles.len();
        if let Some(last) = self.origins.last_mut()
            && is_triangle
        {
            let since = triangle - last.triangle;
            let distance = match (last.position, position) {
                (Position::Line(from), Position::Line(to))
                | (Position::Byte(from), Position::Byte(to)) => to.saturating_sub(from),
                _ => 0,
            };
            if since == 1 && last.step == 0 {
                last.step = distance;
            }
            if last.step > 0 && last.step * since == distance {
                return;
            }
        }
        self.origins.push(Origin {
            triangle,
            position,
            face: self.faces,
            step: 0,
        });
    }

    fn place(&self, triangle: usize) -> Place {
        let after = self.origins.partition_point(|at| at.triangle <= triangle);
        let origin = self.origins[after - 1];
        let since = triangle - origin.triangle;
        let face = origin.face + if origin.step > 0 { since } else { 0 };
        let position = match origin.position {
            Position::Line(line) => Position::Line(line + since * origin.step),
            Position::Byte(byte) => Position::Byte(byte + since * origin.step),
        };
        Place {
            position,
            element: Some(Element::Face(face + self.first)),
        }
    }

    /// Whether each vertex is a node of other cells that no face has; nothing if such vertices are kept.
    fn unneeded(&self) -> Vec<bool> {
        // Without faces, nothing shows that a vertex is not needed.
        if !self.leaves_out_unused || self.triangles.is_empty() {
            return Vec::new();
        }
        let mut is_unused = vec![true; self.positions.len()];
        for &corner in self.triangles.as_flattened() {
            is_unused[corner as usize] = false;
        }
        is_unused
    }

    /// Leaves out vertices that no face needs and whose coordinates are not finite, and returns whether each was left
    /// out: see [`Self::finish`].
    fn leave_out_unknown(&mut self) -> Result<Vec<bool>, ParseError> {
        let mut left_out = self.unneeded();
        let is_unknown = |point: &[f64; 3]| point.iter().any(|x| !x.is_finite());
        if self.positions.iter().any(is_unknown) {
            let unknown = Vec::from_iter(self.positions.iter().map(is_unknown));
            let mut corners = self.triangles.as_flattened().iter();
            if self.triangles.is_empty() || corners.any(|&corner| unknown[corner as usize]) {
                let problem = Problem::NotFinite {
                    axis: 'x',
                    found: "not finite".to_owned(),
                };
                return Err(problem.anywhere());
            }
            left_out.resize(unknown.len(), false);
            let both = left_out.iter_mut().zip(unknown);
            both.for_each(|(left_out, is_unknown)| *left_out |= is_unknown);
        }
        Ok(self.leave_out(left_out))
    }

    /// Leaves out vertices of no triangle, and returns the list, empty if there are none.
    fn leave_out(&mut self, left_out: Vec<bool>) -> Vec<bool> {
        if !left_out.contains(&true) {
            return Vec::new();
        }
        let mut before = 0;
        let numbers = left_out.iter().map(|&is_left_out| {
            let number = before;
            before += u32::from(!is_left_out);
            number
        });
        let numbers = Vec::from_iter(numbers);
        for corner in self.triangles.as_flattened_mut() {
            *corner = numbers[*corner as usize];
        }
        let mut is_left_out = left_out.iter();
        self.positions
            .retain(|_| is_left_out.next() == Some(&false));
        left_out
    }

    /// Replaces the fans of polygons that are not convex.
    fn divide_polygons(&mut self) -> Result<(), ParseError> {
        let (mut corners, mut places) = (Vec::new(), Vec::new());
        for &(first, count) in &self.polygons {
            let triangles = &mut self.triangles[first..first + count];
            corners.clear();
            corners.extend(triangles[0]);
            corners.extend(triangles[1..].iter().map(|&[_, _, last]| last));
            places.clear();
            places.extend(corners.iter().map(|&v| self.positions[v as usize]));
            match triangulate(&places) {
                Ok(division) => {
                    for (triangle, own) in triangles.iter_mut().zip(division) {
                        *triangle = own.map(|corner| corners[corner as usize]);
                    }
                }
                Err(error) => {
                    return Err(ParseError {
                        places: vec![self.place(first)],
                        problem: Problem::Polygon { error },
                    });
                }
            }
        }
        Ok(())
    }

    /// Checks that every corner names a vertex.
    fn check_range(&self) -> Result<(), ParseError> {
        let vertices = self.positions.len();
        for (at, triangle) in self.triangles.iter().enumerate() {
            if let Some(&vertex) = triangle.iter().find(|&&v| v as usize >= vertices) {
                return Err(ParseError {
                    places: vec![self.place(at)],
                    problem: Problem::VertexOutOfRange {
                        vertex: i64::from(vertex) + self.first as i64,
                        vertices,
                        first: self.first,
                    },
                });
            }
        }
        Ok(())
    }

    /// The triangles of all faces, which need not be a mesh, and whether each vertex was left out because only other
    /// cells have it; nothing if none was.
    pub(super) fn soup(mut self) -> Result<(Soup, Vec<bool>), ParseError> {
        self.check_range()?;
        let is_unused = self.unneeded();
        let left_out = self.leave_out(is_unused);
        self.divide_polygons()?;
        let soup = Soup {
            positions: self.positions,
            triangles: self.triangles,
            short_faces: self.short_faces,
        };
        Ok((soup, left_out))
    }

    /// The mesh without vertices that no face has and whose coordinates are not finite, or that are nodes of other
    /// cells; and whether each vertex was left out, or nothing if none was.
    pub(super) fn finish(mut self) -> Result<(MeshFile, Vec<bool>), ParseError> {
        if let Some(refused) = self.refused {
            return Err(refused);
        }
        self.check_range()?;
        let is_unknown = |point: &&[f64; 3]| point.iter().any(|x| !x.is_finite());
        let unknown = self.positions.iter().filter(is_unknown).count();
        let left_out = self.leave_out_unknown()?;
        self.divide_polygons()?;
        let vertices = self.positions.len();
        match TriangleMesh::new(vertices, std::mem::take(&mut self.triangles)) {
            Ok(mesh) => {
                let file = MeshFile {
                    left_out: unknown,
                    ..MeshFile::new(self.positions, mesh)
                };
                Ok((file, left_out))
            }
            Err(error) => {
                let mut triangles = concerned_triangles(&error);
                triangles.sort_unstable();
                let mut places = Vec::from_iter(triangles.iter().map(|&t| self.place(t as usize)));
                places.dedup();
                Err(ParseError {
                    places,
                    problem: Problem::Mesh { error },
                })
            }
        }
    }
}

/// Checks that a face has three corners or more, all different.
fn check_corners(corners: &[u32]) -> Result<(), Problem> {
    let repeated = match *corners {
        [] | [_] | [_, _] => {
            return Err(Problem::TooFewCorners {
                corners: corners.len(),
            });
        }
        [a, b, c] => {
            if a == b {
                Some([1, 2])
            } else if b == c {
                Some([2, 3])
            } else {
                (a == c).then_some([1, 3])
            }
        }
        _ => {
            let mut sorted = Vec::from_iter((1..).zip(corners).map(|(at, vertex)| (vertex, at)));
            sorted.sort_unstable();
            let mut pairs = sorted.windows(2);
            pairs
                .find(|pair| pair[0].0 == pair[1].0)
                .map(|pair| [pair[0].1, pair[1].1])
        }
    };
    match repeated {
        Some(corners) => Err(Problem::RepeatedVertex { corners }),
        None => Ok(()),
    }
}

/// Triangles that an error names.
fn concerned_triangles(error: &MeshError) -> Vec<u32> {
    match *error {
        MeshError::VertexOutOfRange { triangle, .. }
        | MeshError::RepeatedVertex { triangle, .. }
        | MeshError::NonManifoldEdge { triangle, .. } => vec![triangle],
        MeshError::DuplicateTriangle { first, second } => vec![first, second],
        MeshError::InconsistentOrientation { triangles, .. }
        | MeshError::NonManifoldVertex { triangles, .. } => triangles.to_vec(),
        _ => Vec::new(),
    }
}
