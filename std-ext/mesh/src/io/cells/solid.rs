//! The outer surface of solid cells: the faces that belong to one cell only.

/// A kind of solid cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::io) enum Solid {
    Tetrahedron,
    Hexahedron,
    /// A box whose nodes run along x, then y, then z.
    Voxel,
    Wedge,
    Pyramid,
    /// Cells whose faces are not known from their nodes.
    Polyhedron,
}

impl Solid {
    /// The faces of a cell by places among its corners, all with the same sense of rotation. Source: *VTK file
    /// formats*; Gmsh has the same corners, where wedges may rotate the other way round.
    fn faces(self) -> &'static [&'static [usize]] {
        match self {
            Self::Tetrahedron => &[&[0, 1, 3], &[1, 2, 3], &[2, 0, 3], &[0, 2, 1]],
            Self::Hexahedron => &[
                &[0, 4, 7, 3],
                &[1, 2, 6, 5],
                &[0, 1, 5, 4],
                &[3, 7, 6, 2],
                &[0, 3, 2, 1],
                &[4, 5, 6, 7],
            ],
            Self::Voxel => &[
                &[0, 4, 6, 2],
                &[1, 3, 7, 5],
                &[0, 1, 5, 4],
                &[2, 6, 7, 3],
                &[0, 2, 3, 1],
                &[4, 5, 7, 6],
            ],
            Self::Wedge => &[
                &[0, 1, 2],
                &[3, 5, 4],
                &[0, 3, 4, 1],
                &[1, 4, 5, 2],
                &[2, 5, 3, 0],
            ],
            Self::Pyramid => &[
                &[0, 3, 2, 1],
                &[0, 1, 4],
                &[1, 2, 4],
                &[2, 3, 4],
                &[3, 0, 4],
            ],
            Self::Polyhedron => &[],
        }
    }

    /// The number of corners, which come first among the nodes of a cell.
    pub(super) fn corners(self) -> usize {
        match self {
            Self::Tetrahedron => 4,
            Self::Hexahedron | Self::Voxel => 8,
            Self::Wedge => 6,
            Self::Pyramid => 5,
            Self::Polyhedron => 0,
        }
    }
}

/// Solid cells of a data set.
#[derive(Default)]
pub(super) struct Solids {
    /// The kind of each, its number among all cells, and its first corner.
    cells: Vec<(Solid, usize, usize)>,
    corners: Vec<u32>,
}

impl Solids {
    /// Adds a cell with this number and these corners.
    pub(super) fn add(&mut self, solid: Solid, number: usize, corners: &[u32]) {
        self.cells.push((solid, number, self.corners.len()));
        self.corners.extend_from_slice(corners);
    }

    /// Gives every corner the vertex that `name` returns for its own.
    pub(super) fn rename(&mut self, name: impl Fn(u32) -> u32) {
        self.corners
            .iter_mut()
            .for_each(|corner| *corner = name(*corner));
    }

    /// The faces of each cell that no other cell has, cell after cell, with the number of the cell. They rotate
    /// counter-clockwise seen from outside, whatever the sense of rotation of the cells. Corners that a face names
    /// more than once count once.
    pub(super) fn outer_faces(&self, positions: &[[f64; 3]]) -> Vec<(usize, Vec<u32>)> {
        let mut corners = Vec::new();
        let mut faces = Vec::new();
        for (cell, (solid, ..)) in self.cells.iter().enumerate() {
            for face in 0..solid.faces().len() {
                self.name_corners([cell, face], &mut corners);
                if corners.len() > 2 {
                    // Faces have three or four corners.
                    let mut key = [u32::MAX; 4];
                    key[..corners.len()].copy_from_slice(&corners);
                    key.sort_unstable();
                    faces.push((key, cell as u32, face as u8));
                }
            }
        }
        faces.sort_unstable();
        let same = faces.chunk_by(|a, b| a.0 == b.0);
        let outer = same.filter_map(|same| match same {
            [(_, cell, face)] => Some([*cell as usize, usize::from(*face)]),
            _ => None,
        });
        let mut outer = Vec::from_iter(outer);
        outer.sort_unstable();
        let turned = outer.into_iter().map(|[cell, face]| {
            let (solid, number, first) = self.cells[cell];
            let own = &self.corners[first..][..solid.corners()];
            self.name_corners([cell, face], &mut corners);
            if volume(solid.faces(), own, positions) < 0.0 {
                corners.reverse();
            }
            (number, corners.clone())
        });
        turned.collect()
    }

    /// Lists the corners of a face, those that it names more than once once.
    fn name_corners(&self, [cell, face]: [usize; 2], corners: &mut Vec<u32>) {
        let (solid, _, first) = self.cells[cell];
        corners.clear();
        let places = solid.faces()[face].iter();
        corners.extend(places.map(|&place| self.corners[first + place]));
        corners.dedup();
        if corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
    }
}

/// Six times the volume within faces, positive if they rotate counter-clockwise seen from outside.
fn volume(faces: &[&[usize]], corners: &[u32], positions: &[[f64; 3]]) -> f64 {
    let origin = positions[corners[0] as usize];
    let from_origin = |place: usize| {
        let position = positions[corners[place] as usize];
        glam::DVec3::from(position) - glam::DVec3::from(origin)
    };
    let fan = |face: &&[usize]| {
        let first = from_origin(face[0]);
        let pairs = face[1..].windows(2);
        let terms = pairs.map(|pair| first.dot(from_origin(pair[0]).cross(from_origin(pair[1]))));
        terms.sum::<f64>()
    };
    faces.iter().map(fan).sum()
}
