//! Cells of data sets as faces of a mesh: polygons, strips of triangles, cells of higher order by their corners.
//!
//! Points and lines are skipped. Solid cells are skipped where there are faces; of a data set of solid cells alone
//! their outer surface is the mesh. Nodes of no face are left out where other cells have them.

mod solid;

pub(super) use solid::Solid;
use solid::Solids;

use super::weld::Weld;
use super::{MeshBuilder, ParseError, Position, Problem};

/// The meaning of the nodes of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cell {
    /// The corners of a polygon.
    Polygon,
    /// A polygon of this number of corners, and nodes on its sides and inside.
    Corners(usize),
    /// A polygon of as many corners as nodes on its sides, which follow them.
    HalfCorners,
    /// A strip of triangles, each of three successive nodes; every second one is reversed.
    Strip,
    /// Triangles of the first node and two successive ones.
    Fan,
    /// A rectangle, row by row.
    Pixel,
    /// Points or a line.
    Line,
    /// A solid.
    Solid(Solid),
}

/// A list of cells, as VTK stores them.
pub(super) struct CellList<'a> {
    /// The nodes of all cells.
    pub(super) nodes: &'a [i64],
    /// The end of each cell in this list.
    pub(super) ends: &'a [i64],
    pub(super) kinds: Kinds<'a>,
    /// The first vertex of the nodes, and their number of vertices.
    pub(super) before: usize,
    pub(super) vertices: usize,
    /// Whether each cell is left out, by its index in this list.
    pub(super) is_left_out: &'a dyn Fn(usize) -> bool,
}

/// The kinds of cells of a list.
pub(super) enum Kinds<'a> {
    All(Cell),
    /// Numbers of VTK's types, as [`of_vtk`].
    Types(&'a [i64]),
}

/// A number of a [`CellList`], by its index there.
#[derive(Clone, Copy, Debug)]
pub(super) enum CellPart {
    /// All numbers.
    All,
    Node(usize),
    End(usize),
    Type(usize),
}

/// The faces of a data set, and the number of triangles of each cell.
pub(super) struct CellFaces {
    pub(super) builder: MeshBuilder,
    /// The number of triangles of each cell.
    pub(super) triangles: Vec<u32>,
    solids: Solids,
    /// The first solid cell.
    first_solid: Option<Position>,
    /// The first solid cell whose faces are not known.
    unknown: Option<Position>,
}

impl CellFaces {
    pub(super) fn new(first: usize) -> Self {
        Self {
            builder: MeshBuilder::new(first),
            triangles: Vec::new(),
            solids: Solids::default(),
            first_solid: None,
            unknown: None,
        }
    }

    /// Adds a cell with these nodes.
    pub(super) fn add(&mut self, cell: Cell, nodes: &[u32], position: Position) {
        let before = self.builder.triangle_count();
        let builder = &mut self.builder;
        match (cell, nodes) {
            (Cell::Polygon, _) => builder.add_face(nodes, position),
            (Cell::Corners(count), _) => {
                builder.leaves_out_unused |= nodes.len() > count;
                let corners = nodes.get(..count).unwrap_or(nodes);
                // A short list is refused for its number of corners.
                let corners = if nodes.len() < count {
                    &nodes[..0]
                } else {
                    corners
                };
                builder.add_face(corners, position);
            }
            (Cell::HalfCorners, _) => {
                builder.leaves_out_unused = true;
                builder.add_face(&nodes[..nodes.len() / 2], position);
            }
            (Cell::Pixel, &[a, b, c, d]) => builder.add_face(&[a, b, d, c], position),
            (Cell::Pixel, _) => builder.add_face(&[], position),
            (Cell::Strip, _) => {
                for (at, triangle) in nodes.windows(3).enumerate() {
                    let &[a, b, c] = triangle else { continue };
                    let triangle = if at % 2 == 0 { [a, b, c] } else { [b, a, c] };
                    builder.add_part(triangle, position);
                }
            }
            (Cell::Fan, &[first, ref rest @ ..]) => {
                for pair in rest.windows(2) {
                    builder.add_part([first, pair[0], pair[1]], position);
                }
            }
            (Cell::Fan, []) | (Cell::Line, _) => {}
            (Cell::Solid(solid), _) => {
                builder.leaves_out_unused = true;
                self.first_solid.get_or_insert(position);
                match nodes.get(..solid.corners()) {
                    Some(corners) if solid != Solid::Polyhedron => {
                        self.solids.add(solid, self.triangles.len(), corners);
                    }
                    _ => {
                        self.unknown.get_or_insert(position);
                    }
                }
            }
        }
        let added = builder.triangle_count() - before;
        self.triangles.push(added as u32);
    }

    /// Adds the cells of a list, whose numbers are at these positions of the file.
    pub(super) fn add_list(
        &mut self,
        list: &CellList<'_>,
        position: &dyn Fn(CellPart) -> Position,
    ) -> Result<(), ParseError> {
        // All faces get the position of the first, because counting lines for each would take too long.
        let here = position(CellPart::All);
        let (mut start, mut nodes) = (0, Vec::new());
        for (index, &end) in list.ends.iter().enumerate() {
            let element = self.builder.next_face();
            let own = usize::try_from(end).ok();
            let own = own.and_then(|end| Some((end, list.nodes.get(start..end)?)));
            let Some((end, own)) = own else {
                let problem = Problem::Expected {
                    expected: "ends of polygons that rise, and are no larger than the connectivity",
                    found: format!("`{end}`"),
                };
                return Err(problem.at(position(CellPart::End(index)), Some(element)));
            };
            let kind = match list.kinds {
                Kinds::All(kind) => kind,
                Kinds::Types(types) => {
                    let number = types.get(index);
                    number.copied().and_then(of_vtk).ok_or_else(|| {
                        let found = number.map_or("none".to_owned(), |type_| format!("`{type_}`"));
                        let expected = "the number of a type of cells, such as 5 for triangles";
                        let problem = Problem::Expected { expected, found };
                        problem.at(position(CellPart::Type(index)), None)
                    })?
                }
            };
            nodes.clear();
            for (place, &vertex) in own.iter().enumerate() {
                let known = usize::try_from(vertex).ok().filter(|&v| v < list.vertices);
                let known = known.and_then(|v| u32::try_from(list.before + v).ok());
                nodes.push(known.ok_or_else(|| {
                    let problem = Problem::VertexOutOfRange {
                        vertex,
                        vertices: list.vertices,
                        first: 0,
                    };
                    problem.at(position(CellPart::Node(start + place)), Some(element))
                })?);
            }
            match (list.is_left_out)(index) {
                true => self.triangles.push(0),
                false => self.add(kind, &nodes, here),
            }
            start = end;
        }
        Ok(())
    }

    /// Makes one vertex of all those at the same point; the others are left out.
    pub(super) fn merge(&mut self) {
        let (mut weld, mut distinct) = (Weld::default(), Vec::new());
        let mut firsts: Vec<u32> = Vec::new();
        let points = self.builder.positions.iter().enumerate();
        let merged = points.map(|(vertex, &point)| {
            let known = weld.vertex(point, &mut distinct) as usize;
            if known == firsts.len() {
                firsts.push(vertex as u32);
            }
            firsts[known]
        });
        let merged = Vec::from_iter(merged);
        let first = |vertex: u32| merged[vertex as usize];
        self.builder.rename(first);
        self.solids.rename(first);
        self.builder.leaves_out_unused = true;
    }

    /// The faces, and the number of triangles of each cell.
    pub(super) fn faces(mut self) -> Result<(MeshBuilder, Vec<u32>), ParseError> {
        let Some(position) = self
            .first_solid
            .filter(|_| self.builder.triangle_count() == 0)
        else {
            return Ok((self.builder, self.triangles));
        };
        if let Some(position) = self.unknown {
            let problem = Problem::Expected {
                expected: "faces: triangles, quadrilaterals, polygons or strips",
                found: "polyhedra, or cells with too few nodes: extract their surface first"
                    .to_owned(),
            };
            return Err(problem.at(position, None));
        }
        for (cell, corners) in self.solids.outer_faces(&self.builder.positions) {
            let before = self.builder.triangle_count();
            self.builder.add_face(&corners, position);
            self.triangles[cell] += (self.builder.triangle_count() - before) as u32;
        }
        Ok((self.builder, self.triangles))
    }
}

/// A number for each triangle from a number for each cell with its number of triangles.
pub(super) fn at_triangles(numbers: &[f64], triangles: &[u32]) -> Vec<f64> {
    let cells = numbers.iter().zip(triangles);
    let repeated = cells.map(|(&number, &count)| std::iter::repeat_n(number, count as usize));
    repeated.flatten().collect()
}

/// The cell of a type of VTK. Source: *VTK file formats* (docs.vtk.org) and the header `vtkCellType.h`, which lists
/// the numbers.
pub(super) fn of_vtk(number: i64) -> Option<Cell> {
    Some(match number {
        0..=4 | 21 | 35 | 51 | 68 | 75 => Cell::Line,
        5 | 7 | 9 => Cell::Polygon,
        6 => Cell::Strip,
        8 => Cell::Pixel,
        22 | 34 | 52 | 69 | 76 => Cell::Corners(3),
        23 | 28 | 30 | 53 | 70 | 77 => Cell::Corners(4),
        36 => Cell::HalfCorners,
        10 | 24 | 54 | 71 | 78 => Cell::Solid(Solid::Tetrahedron),
        11 => Cell::Solid(Solid::Voxel),
        12 | 25 | 29 | 33 | 55 | 72 | 79 => Cell::Solid(Solid::Hexahedron),
        13 | 26 | 31 | 32 | 56 | 73 | 80 => Cell::Solid(Solid::Wedge),
        14 | 27 | 37 | 57 | 74 | 81 => Cell::Solid(Solid::Pyramid),
        15 | 16 | 41 | 42 => Cell::Solid(Solid::Polyhedron),
        _ => return None,
    })
}
