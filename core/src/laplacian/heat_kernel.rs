//! The heat-kernel operator: the operator of method D.
//!
//! M. Belkin, J. Sun and Y. Wang, Discrete Laplace operator on meshed surfaces, Proc. 24th ACM
//! Symp. Computational Geometry (2008) 278.

use crate::curvature::{Curvature, Curvatures};
use crate::diagnostic::Finding;
use crate::element::{Execution, Ragged, of_vertices};
use crate::lane::Lane;
use crate::laplacian::{Cotangent, LaplaceBeltrami, Rows, VertexSums, expect_measured};
use crate::mesh::{TriangleMesh, VertexKind};
use crate::method::{Method, Workspace};
use crate::neighbourhood::Neighbourhood;
use crate::real::{Real, finite_or_zero};
use crate::surface::Surface;
use crate::triangle::DualArea;
use crate::vec3::{Vec3, add, dot, norm, scale};
use alloc::vec::Vec;

/// `Δ_S φ(i) = 1/(4πh²) Σ_T A_T/3 Σ_{p ∈ T} exp(−|x_p − x_i|²/4h) (φ_p − φ_i)`, h the bandwidth at
/// vertex i.
///
/// * Pointwise. The operator is symmetric in the inner product of the barycentric areas if the
///   bandwidth is global, and not symmetric if each vertex has its own.
/// * `H = −½ (Δ_S x)·n` from the rows of this operator; n, K and the area are those of
///   [`Cotangent`] with mixed areas.
/// * The kernel ends where it is below the rounding of the scalar, at `2 √(h ln 1/ε)`: 12 √h in
///   f64, 8 √h in f32.
/// * Distances are Euclidean, but vertices are searched along the surface, over paths of edges up
///   to 1.15 times the range of the kernel, so that the kernel does not couple sheets that lie
///   close together. (On a triangular lattice a path is up to 2/√3 times as long as the distance.)
/// * Near a boundary the kernel is truncated, which causes an error of order `1/√h` times the
///   gradient of the field. H and K are 0 at boundary vertices.
/// * A vertex without other vertices in range has an empty row and H = 0, and is reported by
///   [`Method::inspect`].
///
/// Rows have hundreds of entries (400 to 500 in f64 with the mixed area for h). Only their columns
/// are stored, 4 bytes per entry instead of 12. The kernel is computed again whenever the operator
/// is applied, because it costs only a fraction of the search along the surface. Rows with more entries
/// than [`Self::stored`] in all are searched again as well. With [`Bandwidth::Converging`] the entries
/// grow like `N^1.5`: a million vertices have 5 · 10⁹, twenty gigabytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatKernel<T> {
    /// The bandwidth h.
    pub bandwidth: Bandwidth<T>,
    /// The largest number of entries of all rows whose columns are stored, 5 bytes each with their spare
    /// room. It changes time and memory, and no result.
    pub stored: usize,
}

/// The bandwidth h of a heat kernel: an area, twice the kernel's variance along each axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Bandwidth<T> {
    /// `max(¼, √N/100) A/N` everywhere, with N vertices that are in triangles and the area A of the
    /// surface. It shrinks more slowly than the triangles, so that errors shrink, too; below a quarter
    /// of the mean area of a vertex the kernel would hardly reach the nearest neighbours.
    #[default]
    Converging,
    /// This factor times the mean area A/N of a vertex, the same for all vertices.
    MeanArea(T),
    /// This factor times the mixed area of each vertex; 1 is the published method. The error does
    /// not shrink with the triangles, because the kernel always averages over the same few
    /// neighbours.
    MixedArea(T),
    /// The same area for all vertices and surfaces.
    Global(T),
}

impl<T: Real> HeatKernel<T> {
    /// The operator with this bandwidth, which stores up to 2²⁹ columns: 2.5 GiB.
    pub fn new(bandwidth: Bandwidth<T>) -> Self {
        Self {
            bandwidth,
            stored: 1 << 29,
        }
    }
}

impl<T: Real> Default for HeatKernel<T> {
    /// The bandwidth with which the operator converges.
    fn default() -> Self {
        Self::new(Bandwidth::Converging)
    }
}

/// Memory of [`HeatKernel`].
#[derive(Clone, Debug)]
pub struct HeatKernelMemory<T> {
    /// Start of each one-ring, and the length of all of them.
    ring_offsets: Vec<usize>,
    cotangent: VertexSums<T>,
    /// The length of the edge to each entry of the mesh's one-rings.
    edge_lengths: Vec<T>,
    searches: Vec<Neighbourhood<T>>,
    kernel: GaussianKernel<T>,
    gathered: Gathered,
}

/// The numbers from which the coefficients are computed.
#[derive(Clone, Debug, Default)]
struct GaussianKernel<T> {
    /// 1/h at each vertex; 0 where the row is empty.
    over_bandwidth: Vec<T>,
    /// The barycentric area of each vertex.
    weights: Vec<T>,
}

impl<T: Real> GaussianKernel<T> {
    /// The coefficient of `neighbour`, at this squared distance, in the row of `vertex`.
    #[inline]
    fn coefficient(&self, vertex: usize, neighbour: u32, squared_distance: T) -> T {
        let over = self.over_bandwidth[vertex];
        // Multiplied factor by factor, because 1/h² may overflow where 1/h does not.
        let weight = self.weights[neighbour as usize] * over;
        let height = over * (T::constant(0.25) * T::FRAC_1_PI());
        let fall = (-T::constant(0.25) * squared_distance * over).exp();
        let [coefficient] = finite_or_zero([weight * height * fall]);
        coefficient
    }

    /// `4 h ln 1/ε`: the squared distance at which the kernel has fallen to the rounding ε.
    fn squared_reach(&self, vertex: usize) -> T {
        let exponent = -T::constant(4.0) * T::epsilon().ln();
        exponent * self.over_bandwidth[vertex].reciprocal_or_zero()
    }

    /// The vertices in the row of `vertex`, with their squared distances.
    fn in_range<'a>(
        &self,
        surface: Surface<'_, T>,
        edge_lengths: &[T],
        search: &'a mut Neighbourhood<T>,
        vertex: usize,
    ) -> &'a [(T, u32)] {
        let squared_reach = self.squared_reach(vertex);
        let longest = T::constant(1.15) * squared_reach.sqrt();
        search.within(surface, edge_lengths, vertex as u32, longest);
        let found = &mut search.found;
        found.retain(|&(squared_distance, _)| squared_distance <= squared_reach);
        found
    }
}

/// The columns of each row, with spare capacity so that a moving surface seldom needs more memory; or of
/// none, if all rows together have too many.
#[derive(Clone, Debug, Default)]
struct Gathered {
    offsets: Vec<usize>,
    /// Number of columns of each row. It may exceed the capacity, until [`Self::make_room`] is called.
    lengths: Vec<u32>,
    columns: Vec<u32>,
    is_stored: bool,
}

impl Gathered {
    /// Allocates `rows` rows; [`Self::make_room`] determines their capacities.
    fn resize(&mut self, rows: usize) {
        if self.lengths.len() != rows {
            self.lengths.clear();
            self.lengths.resize(rows, 0);
            self.offsets.clear();
            self.offsets.resize(rows + 1, 0);
            self.columns.clear();
        }
    }

    /// The columns of a row, if they are stored.
    fn row(&self, row: usize) -> Option<&[u32]> {
        let start = self.offsets[row];
        let end = start + self.lengths[row] as usize;
        self.is_stored.then(|| &self.columns[start..end])
    }

    /// Gives each row capacity for its length and a quarter more, unless every row has enough, or all
    /// have more than `most` columns; returns whether nothing has to be gathered again.
    fn make_room(&mut self, most: usize) -> bool {
        let lengths = self.lengths.iter().map(|&length| u64::from(length));
        self.is_stored = lengths.sum::<u64>() <= most as u64;
        if !self.is_stored {
            self.offsets.fill(0);
            self.columns = Vec::new();
            return true;
        }
        let ends = self.offsets.windows(2);
        let mut rows = ends.zip(&self.lengths);
        if rows.all(|(ends, &length)| length as usize <= ends[1] - ends[0]) {
            return true;
        }
        let mut offset = 0;
        for (&length, end) in self.lengths.iter().zip(&mut self.offsets[1..]) {
            offset += length as usize + length as usize / 4;
            *end = offset;
        }
        self.columns.resize(offset, 0);
        false
    }
}

impl<T: Real> HeatKernel<T> {
    fn set_over_bandwidth(
        &self,
        execution: &impl Execution,
        curvature: &[Curvature<T>],
        over: &mut Vec<T>,
    ) {
        let [of_area, everywhere] = match self.bandwidth {
            Bandwidth::MixedArea(factor) => [factor, T::zero()],
            Bandwidth::MeanArea(factor) => [T::zero(), factor * mean_area(curvature).0],
            Bandwidth::Converging => {
                let (mean, vertices) = mean_area(curvature);
                let factor = T::constant(0.01) * vertices.sqrt();
                [T::zero(), factor.max(T::constant(0.25)) * mean]
            }
            Bandwidth::Global(bandwidth) => [T::zero(), bandwidth],
        };
        over.resize(curvature.len(), T::zero());
        execution.map(&mut over[..], |vertex, over| {
            let Curvature { area, kind, .. } = curvature[vertex];
            let bandwidth = match kind {
                VertexKind::Isolated => T::zero(),
                VertexKind::Interior | VertexKind::Boundary => of_area * area + everywhere,
            };
            *over = bandwidth.reciprocal_or_zero();
        });
    }
}

/// The mean area of the vertices that are in triangles, and their number. One sum in vertex order: no
/// bit depends on the number of threads.
fn mean_area<T: Real>(curvature: &[Curvature<T>]) -> (T, T) {
    let in_triangles = curvature
        .iter()
        .filter(|vertex| vertex.kind != VertexKind::Isolated);
    let (area, vertices) = in_triangles.fold((T::zero(), T::zero()), |(area, vertices), vertex| {
        (area + vertex.area, vertices + T::one())
    });
    (area * vertices.reciprocal_or_zero(), vertices)
}

fn set_edge_lengths<T: Real>(
    execution: &impl Execution,
    surface: Surface<'_, T>,
    lengths: &mut Vec<T>,
    offsets: &[usize],
) {
    let mesh = surface.mesh();
    lengths.resize(mesh.ring_vertices().len(), T::zero());
    execution.map(Ragged::new(lengths, offsets), |vertex, lengths| {
        for (&neighbour, length) in mesh.one_ring(vertex).iter().zip(lengths) {
            *length = norm(surface.difference(vertex as u32, neighbour));
        }
    });
}

/// Finds the vertices within range of each vertex, and sets H.
fn gather<T: Real>(
    execution: &impl Execution,
    surface: Surface<'_, T>,
    memory: &mut HeatKernelMemory<T>,
    curvature: &mut [Curvature<T>],
) {
    let HeatKernelMemory {
        edge_lengths,
        searches,
        kernel,
        gathered,
        ..
    } = memory;
    let Gathered {
        offsets,
        lengths,
        columns,
        ..
    } = gathered;
    let rows = (&mut lengths[..], Ragged::new(columns, offsets));
    execution.map_with(
        searches,
        (curvature, rows),
        |search, vertex, (curvature, (length, columns))| {
            let centre = vertex as u32;
            let found = kernel.in_range(surface, edge_lengths, search, vertex);
            *length = found.len() as u32;
            for (column, &(_, neighbour)) in columns.iter_mut().zip(found) {
                *column = neighbour;
            }
            let mut sum: Vec3<T> = [T::zero(); 3];
            for &(squared_distance, neighbour) in found {
                let coefficient = kernel.coefficient(vertex, neighbour, squared_distance);
                sum = add(
                    sum,
                    scale(coefficient, surface.difference(centre, neighbour)),
                );
            }
            curvature.mean = match curvature.kind {
                VertexKind::Interior => {
                    -T::constant(0.5) * dot(finite_or_zero(sum), curvature.normal)
                }
                VertexKind::Boundary | VertexKind::Isolated => T::zero(),
            };
        },
    );
}

/// The columns and coefficients of a row.
fn row<'a, T: Real>(
    surface: Surface<'a, T>,
    memory: &'a HeatKernelMemory<T>,
    search: &'a mut Neighbourhood<T>,
    vertex: usize,
) -> impl Iterator<Item = (u32, T)> + 'a {
    let kernel = &memory.kernel;
    let (columns, found): (&[u32], &[(T, u32)]) = match memory.gathered.row(vertex) {
        Some(columns) => (columns, &[]),
        None => (
            &[],
            kernel.in_range(surface, &memory.edge_lengths, search, vertex),
        ),
    };
    let found = found.iter().map(|&(_, neighbour)| neighbour);
    columns.iter().copied().chain(found).map(move |neighbour| {
        let difference = surface.difference(vertex as u32, neighbour);
        let squared_distance = dot(difference, difference);
        (
            neighbour,
            kernel.coefficient(vertex, neighbour, squared_distance),
        )
    })
}

impl<T: Real> Method<T> for HeatKernel<T> {
    type Memory = HeatKernelMemory<T>;

    fn memory(&self, mesh: &TriangleMesh) -> HeatKernelMemory<T> {
        let offsets = mesh.ring_offsets().iter();
        HeatKernelMemory {
            ring_offsets: offsets.map(|&offset| offset as usize).collect(),
            cotangent: VertexSums::default(),
            edge_lengths: Vec::new(),
            searches: Vec::new(),
            kernel: GaussianKernel::default(),
            gathered: Gathered::default(),
        }
    }

    fn inspect(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        report: &mut dyn FnMut(Finding),
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        surface.report_uneven_mesh(report);
        surface.report_rough_vertices(report);
        // The kernel of each vertex reaches far, and would miss the area of such a triangle.
        if surface.has_areas_below_range() {
            for vertex in 0..surface.mesh().vertex_count() as u32 {
                report(Finding::OutOfRange { vertex });
            }
        }
        for (vertex, &length) in memory.gathered.lengths.iter().enumerate() {
            if length == 0 && surface.mesh().vertex_kind(vertex) != VertexKind::Isolated {
                report(Finding::TooFewNeighbours {
                    vertex: vertex as u32,
                });
            }
        }
    }
}

impl<T: Real> Curvatures<T> for HeatKernel<T> {
    fn curvatures(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &mut Workspace<T, Self>,
        curvature: &mut [Curvature<T>],
    ) {
        let memory = workspace.for_mesh_mut(surface.mesh());
        let vertices = surface.mesh().vertex_count();
        let curvature = of_vertices(surface, curvature);
        let mixed = Cotangent::new(DualArea::Mixed);
        mixed.sum(execution, surface, &mut memory.cotangent, curvature);
        let GaussianKernel {
            over_bandwidth,
            weights,
        } = &mut memory.kernel;
        self.set_over_bandwidth(execution, curvature, over_bandwidth);
        weights.resize(vertices, T::zero());
        Cotangent::new(DualArea::Barycentric).dual_areas(execution, surface, weights);
        let (lengths, offsets) = (&mut memory.edge_lengths, &memory.ring_offsets);
        set_edge_lengths(execution, surface, lengths, offsets);
        memory.gathered.resize(vertices);
        gather(execution, surface, memory, curvature);
        if !memory.gathered.make_room(self.stored) {
            gather(execution, surface, memory, curvature);
        }
    }
}

impl<T: Real> LaplaceBeltrami<T> for HeatKernel<T> {
    fn apply<const D: usize>(
        &self,
        execution: &impl Execution,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        field: &[[T; D]],
        laplacian: &mut [[T; D]],
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        expect_measured(memory.gathered.lengths.len(), surface.mesh().vertex_count());
        let laplacian = of_vertices(surface, laplacian);
        let set = |search: &mut Neighbourhood<T>, vertex: usize, laplacian: &mut [T; D]| {
            let mut sum = [T::zero(); D];
            for (neighbour, coefficient) in row(surface, memory, search, vertex) {
                for k in 0..D {
                    sum[k] += coefficient * (field[neighbour as usize][k] - field[vertex][k]);
                }
            }
            *laplacian = finite_or_zero(sum);
        };
        // Without a search nothing is allocated.
        if memory.gathered.is_stored {
            execution.map(laplacian, |vertex, laplacian| {
                set(&mut Neighbourhood::default(), vertex, laplacian);
            });
        } else {
            execution.map_with(&mut Vec::new(), laplacian, set);
        }
    }

    fn assemble(
        &self,
        surface: Surface<'_, T>,
        workspace: &Workspace<T, Self>,
        rows: &mut Rows<T>,
    ) {
        let memory = workspace.for_mesh(surface.mesh());
        expect_measured(memory.gathered.lengths.len(), surface.mesh().vertex_count());
        let mut search = Neighbourhood::default();
        rows.clear();
        for vertex in 0..surface.mesh().vertex_count() {
            for (neighbour, coefficient) in row(surface, memory, &mut search, vertex) {
                rows.push(neighbour, coefficient);
            }
            rows.end_row();
        }
    }
}
