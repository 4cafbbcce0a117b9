//! Meshes made of triangles that are none.
//!
//! [`repair`] takes any triangles, such as [`io::read_soup`](crate::io::read_soup) reads them, and returns a mesh.
//! Every change is an [`Action`], in this order, and counted in the [`RepairReport`]. A mesh that needs no repair is
//! returned bit for bit, and so is the result of a repair by a second one; only of surfaces that cross each other in
//! many edges and are welded again, a second one may find other sheets.
//!
//! Two triangles that share an edge are neighbours. Where three or more share one, those that continue each other
//! are neighbours: at an edge where closed bodies touch, the two that bound the same body; otherwise the pair that
//! is least bent, then the next. The others end there. A vertex is then a fan of neighbours, so that each further
//! fan at the same vertex gets a copy of it. Triangles that contradict their neighbours are reversed, the fewer of a
//! component; a surface with one side, such as a Möbius strip, is cut across. Splitting and cutting move nothing and
//! remove no triangle.

mod around_edge;
pub(crate) mod holes;
mod neighbours;
mod pass;
mod sheets;
mod slivers;

use crate::io::{Column, ColumnPlace, MeshFile};
use helfrich::{MeshError, TriangleMesh};
use pass::Pass;
use std::fmt;

/// Marks a triangle of the result that is none of the input, in [`Repaired::triangle_of`].
pub const NEW: u32 = u32::MAX;

/// Vertices and triangles that need not form a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soup {
    /// Positions of the vertices, which need not be finite.
    pub positions: Vec<[f64; 3]>,
    /// The triangles over these vertices, in any orientation, with repeated corners and more than once.
    pub triangles: Vec<[u32; 3]>,
    /// Number of faces of the file with fewer than three corners, of which there are no triangles.
    pub short_faces: usize,
}

/// Parts of a repair that are done only if asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RepairSettings {
    /// Distance up to which vertices of triangles are merged, with 0 those at the same point. `None` merges none,
    /// because surfaces may touch or lie close together; readers of STL merge equal corners themselves.
    pub weld: Option<f64>,
    /// The sheets that are kept at edges with three or more triangles.
    pub sheets: Sheets,
    /// The most edges of a hole that is filled. A border that spans more than half of the area of its component is
    /// its outline, and stays.
    pub fill: usize,
    /// Triangles with an angle below this one, in degrees, are removed: an edge is flipped, or collapsed into one of
    /// its ends. 0 removes none.
    pub slivers: f64,
    /// Whether closed components that are inside out are turned, also where nothing contradicts their orientation.
    /// Inner boundaries of bodies with cavities are not inside out.
    pub outward: bool,
    /// Whether vertices are left out that no triangle of the input has.
    pub drop_unused: bool,
}

/// The sheets that are kept at edges with three or more triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sheets {
    /// All of them, taken apart.
    #[default]
    Split,
    /// The one with the largest area of those that meet.
    Largest,
}

impl Sheets {
    /// All choices, with their names.
    pub const NAMES: [(&str, Self); 2] = [("split", Self::Split), ("largest", Self::Largest)];
}

impl std::str::FromStr for Sheets {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::NAMES.iter().find(|(known, _)| *known == name);
        found
            .map(|(_, sheets)| *sheets)
            .ok_or_else(|| format!("`{name}` is no choice of sheets: split and largest are"))
    }
}

macro_rules! actions {
    ($($(#[$doc:meta])* $action:ident, $key:literal, $words:literal;)*) => {
        /// A change that a repair makes, in the order in which they are made.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Action {
            $($(#[$doc])* $action,)*
        }

        impl Action {
            /// All actions, in their order.
            pub const ALL: &[Self] = &[$(Self::$action),*];

            /// Its name in reports.
            pub fn key(self) -> &'static str {
                match self { $(Self::$action => $key,)* }
            }

            /// The things that are counted, and their fate.
            pub fn words(self) -> &'static str {
                match self { $(Self::$action => $words,)* }
            }
        }

        /// Number of actions.
        const ACTIONS: usize = [$(Action::$action),*].len();
    };
}

actions! {
    /// A face with fewer than three corners is left out.
    ShortFaces, "short_faces", "faces with fewer than three corners left out";
    /// A triangle with a corner that is not finite is left out.
    NotFinite, "not_finite", "triangles with a coordinate that is not finite left out";
    /// A vertex is merged with one near it.
    Merged, "merged", "vertices merged with others";
    /// A triangle of which two corners are one vertex is left out.
    Repeated, "repeated", "triangles with a repeated corner left out";
    /// A triangle is left out because an earlier one has its vertices, in either orientation.
    Duplicates, "duplicates", "triangles with the vertices of an earlier one left out";
    /// An edge with three or more triangles is taken apart.
    Edges, "edges", "edges with three or more triangles taken apart";
    /// A triangle is left out because its sheet is not the largest at such an edge.
    SmallSheets, "small_sheets", "triangles of smaller sheets at such edges left out";
    /// An edge is cut because the surface there has only one side.
    Cut, "cut", "edges cut where a surface has only one side";
    /// A vertex with several fans is split.
    BowTies, "bow_ties", "vertices split where surfaces only touch";
    /// A vertex is left out because no triangle has it.
    Unused, "unused", "vertices in no triangle left out";
    /// A triangle is reversed because it contradicts its neighbours, or its closed component is inside out then.
    Reversed, "reversed", "triangles reversed to agree with their neighbours";
    /// A closed component is turned because it is inside out.
    Turned, "turned", "closed components turned that were inside out";
    /// A hole is filled.
    Filled, "filled", "holes filled";
    /// An edge of a sliver is flipped.
    Flipped, "flipped", "edges of slivers flipped";
    /// An edge of a sliver is collapsed.
    Collapsed, "collapsed", "edges of slivers collapsed";
}

/// The actions of a repair.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RepairReport {
    counts: [usize; ACTIONS],
    /// Number of holes within the requested size that could not be filled: they are outlines, or a triangle over
    /// them would meet an edge that has two already.
    pub holes_left: usize,
    /// Number of triangles with an angle below the requested one that could not be removed without worse ones, or
    /// without a change of the border.
    pub slivers_left: usize,
}

impl RepairReport {
    /// Number of times that an action was taken.
    pub fn count(&self, action: Action) -> usize {
        self.counts[action as usize]
    }

    /// The actions that were taken, with their numbers.
    pub fn taken(&self) -> impl Iterator<Item = (Action, usize)> {
        let all = Action::ALL
            .iter()
            .map(|&action| (action, self.count(action)));
        all.filter(|&(_, count)| count > 0)
    }

    /// Whether nothing was changed.
    pub fn is_empty(&self) -> bool {
        self.taken().next().is_none()
    }

    fn add(&mut self, action: Action, count: usize) {
        self.counts[action as usize] += count;
    }
}

/// A line for each action.
impl fmt::Display for RepairReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let taken = self.taken().map(|(action, count)| (action.words(), count));
        let left = [
            ("holes that could not be filled", self.holes_left),
            ("slivers that could not be removed", self.slivers_left),
        ];
        let left = left.into_iter().filter(|&(_, count)| count > 0);
        for (at, (words, count)) in taken.chain(left).enumerate() {
            write!(f, "{}{words}: {count}", if at == 0 { "" } else { "\n" })?;
        }
        Ok(())
    }
}

/// A mesh made by [`repair`].
#[derive(Clone, Debug, PartialEq)]
pub struct Repaired {
    /// The mesh.
    pub file: MeshFile,
    /// The vertex of the input for each of its vertices; the lowest of those that were merged.
    pub vertex_of: Vec<u32>,
    /// The triangle of the input for each of its triangles; [`NEW`] if it fills a hole.
    pub triangle_of: Vec<u32>,
    /// The changes.
    pub report: RepairReport,
}

impl Repaired {
    /// Numbers at the vertices and triangles of the input as those of the mesh; NaN at new triangles.
    ///
    /// # Panics
    /// If a column does not have one number for each vertex or triangle of the input.
    pub fn columns(&self, columns: Vec<Column>) -> Vec<Column> {
        let carried = columns.into_iter().map(|column| {
            let origins = match column.place {
                ColumnPlace::Vertices => &self.vertex_of,
                ColumnPlace::Triangles => &self.triangle_of,
            };
            let value = |&origin: &u32| match origin {
                NEW => f64::NAN,
                origin => column.values[origin as usize],
            };
            let values = origins.iter().map(value).collect();
            Column { values, ..column }
        });
        carried.collect()
    }
}

/// The reason why triangles cannot be repaired.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RepairError {
    /// Nothing remains.
    #[error("no triangle is left of {triangles}: {report}")]
    NothingLeft {
        /// Number of triangles of the input.
        triangles: usize,
        /// The reasons why they were left out.
        report: Box<RepairReport>,
    },
    /// There is no triangle, one names a vertex that does not exist, or there are too many.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Most repetitions of all actions. The second one finds nothing, unless vertices that are merged are near others,
/// or a removed sliver makes room for the removal of another.
const MOST_PASSES: usize = 8;

/// Makes a mesh of triangles.
///
/// # Errors
/// If there is no triangle or none is left, if one names a vertex that does not exist, or if there are more than
/// [`TriangleMesh::LIMIT`].
pub fn repair(soup: Soup, settings: &RepairSettings) -> Result<Repaired, RepairError> {
    check(&soup)?;
    let mut report = RepairReport::default();
    report.add(Action::ShortFaces, soup.short_faces);
    let triangles = soup.triangles.len();
    let mut pass = Pass::new(soup);
    for _ in 0..MOST_PASSES {
        let before = report.counts;
        pass.run(settings, &mut report)?;
        if pass.triangles.is_empty() {
            let report = Box::new(report);
            return Err(RepairError::NothingLeft { triangles, report });
        }
        if report.counts == before {
            break;
        }
    }
    let mesh = TriangleMesh::new(pass.positions.len(), pass.triangles)?;
    Ok(Repaired {
        file: MeshFile::new(pass.positions, mesh),
        vertex_of: pass.vertex_of,
        triangle_of: pass.triangle_of,
        report,
    })
}

/// Whether [`repair`] makes a mesh of triangles that are none for this reason.
pub fn is_repairable(error: &MeshError) -> bool {
    matches!(
        error,
        MeshError::RepeatedVertex { .. }
            | MeshError::DuplicateTriangle { .. }
            | MeshError::NonManifoldEdge { .. }
            | MeshError::InconsistentOrientation { .. }
            | MeshError::NonManifoldVertex { .. }
    )
}

/// Checks that 32 bits number everything, and that every corner names a vertex.
fn check(soup: &Soup) -> Result<(), MeshError> {
    let vertices = soup.positions.len();
    for (what, count) in [("vertices", vertices), ("triangles", soup.triangles.len())] {
        let limit = TriangleMesh::LIMIT;
        if count > limit {
            return Err(MeshError::TooLarge { what, count, limit });
        }
    }
    if soup.triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    let corners = soup.triangles.as_flattened();
    match corners
        .iter()
        .position(|&vertex| vertex as usize >= vertices)
    {
        None => Ok(()),
        Some(place) => Err(MeshError::VertexOutOfRange {
            triangle: (place / 3) as u32,
            vertex: corners[place],
            vertices,
        }),
    }
}
