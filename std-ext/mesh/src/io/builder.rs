//! Builder of a mesh from the vertices and faces of a file.

use helfrich::{MeshError, TriangleMesh};

use super::{Element, MeshFile, ParseError, Place, Position, Problem};

/// Vertices and faces that have been read, before they become a mesh.
pub(super) struct Builder {
    pub(super) positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// The place of the face of each triangle in the file.
    origins: Vec<Origin>,
    /// The number of faces so far.
    faces: usize,
    /// The number of the first vertex and the first face: 1 in OBJ, 0 elsewhere.
    first: usize,
}

/// A [`Place`] of a face, kept for every triangle.
#[derive(Clone, Copy)]
struct Origin {
    position: Position,
    face: usize,
}

impl Builder {
    pub(super) fn new(first: usize) -> Self {
        Self {
            positions: Vec::new(),
            triangles: Vec::new(),
            origins: Vec::new(),
            faces: 0,
            first,
        }
    }

    /// Reserves memory for the numbers that a header announces, limited by the remaining bytes of
    /// the file.
    pub(super) fn reserve(&mut self, vertices: usize, faces: usize, bytes: usize) {
        // Few vertices or faces take less than six bytes; if they do, the lists grow as they are
        // filled.
        let most = bytes / 6;
        self.positions.reserve(vertices.min(most));
        self.triangles.reserve(faces.min(most));
        self.origins.reserve(faces.min(most));
    }

    /// The vertex that would be added next.
    pub(super) fn next_vertex(&self) -> Element {
        Element::Vertex(self.positions.len() + self.first)
    }

    /// The face that would be added next.
    pub(super) fn next_face(&self) -> Element {
        Element::Face(self.faces + self.first)
    }

    /// Adds a face whose corners count vertices from 0; whether these exist is checked at the end.
    pub(super) fn add_face(
        &mut self,
        corners: &[u32],
        position: Position,
    ) -> Result<(), ParseError> {
        if let Err(problem) = check_corners(corners) {
            return Err(problem.at(position, Some(self.next_face())));
        }
        let origin = Origin {
            position,
            face: self.faces,
        };
        for pair in corners[1..].windows(2) {
            self.triangles.push([corners[0], pair[0], pair[1]]);
            self.origins.push(origin);
        }
        self.faces += 1;
        Ok(())
    }

    fn place(&self, triangle: usize) -> Place {
        let origin = self.origins[triangle];
        Place {
            position: origin.position,
            element: Some(Element::Face(origin.face + self.first)),
        }
    }

    pub(super) fn finish(mut self) -> Result<MeshFile, ParseError> {
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
        match TriangleMesh::new(vertices, std::mem::take(&mut self.triangles)) {
            Ok(mesh) => Ok(MeshFile {
                positions: self.positions,
                mesh,
            }),
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

/// Three corners or more, all different.
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

/// The triangles that an error names.
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
