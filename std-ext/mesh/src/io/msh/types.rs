//! The types of elements of Gmsh.
//!
//! Source: Gmsh reference manual, "MSH file format", element types.

use super::super::cells::{Cell, Solid};

/// The cell of a type of Gmsh, and its number of nodes.
pub(super) fn of_gmsh(number: i64) -> Option<(Cell, usize)> {
    let tetrahedra = Cell::Solid(Solid::Tetrahedron);
    let hexahedra = Cell::Solid(Solid::Hexahedron);
    let wedges = Cell::Solid(Solid::Wedge);
    let pyramids = Cell::Solid(Solid::Pyramid);
    Some(match number {
        15 => (Cell::Line, 1),
        1 => (Cell::Line, 2),
        8 => (Cell::Line, 3),
        26 => (Cell::Line, 4),
        27 => (Cell::Line, 5),
        28 => (Cell::Line, 6),
        2 => (Cell::Polygon, 3),
        9 => (Cell::Corners(3), 6),
        20 => (Cell::Corners(3), 9),
        21 => (Cell::Corners(3), 10),
        22 => (Cell::Corners(3), 12),
        23 | 24 => (Cell::Corners(3), 15),
        25 => (Cell::Corners(3), 21),
        3 => (Cell::Polygon, 4),
        16 => (Cell::Corners(4), 8),
        10 => (Cell::Corners(4), 9),
        36 => (Cell::Corners(4), 16),
        37 => (Cell::Corners(4), 25),
        38 => (Cell::Corners(4), 36),
        4 => (tetrahedra, 4),
        11 => (tetrahedra, 10),
        29 => (tetrahedra, 20),
        30 => (tetrahedra, 35),
        31 => (tetrahedra, 56),
        5 => (hexahedra, 8),
        17 => (hexahedra, 20),
        12 => (hexahedra, 27),
        92 => (hexahedra, 64),
        93 => (hexahedra, 125),
        6 => (wedges, 6),
        18 => (wedges, 15),
        13 => (wedges, 18),
        7 => (pyramids, 5),
        19 => (pyramids, 13),
        14 => (pyramids, 14),
        _ => return None,
    })
}
