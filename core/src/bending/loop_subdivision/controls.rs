//! From nodes to control points, and forces back.

use crate::element::Execution;
use crate::mesh::TriangleMesh;
use crate::real::Real;
use crate::subdivision::{RowSum, Stencils, limit_weight};
use num_traits::Float;

/// The map from the nodes X to the control points C of the subdivision surface: `C = QX`.
///
/// L is the map from control points to the points of the limit surface under the vertices
/// ([`crate::subdivision::limit_positions`]), boundary vertices included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ControlPoints {
    /// C = X, as published. The surface lies inside the nodes, and all results are of second order.
    Nodes,
    /// LC = X: the surface passes through the nodes. Solved iteratively to rounding; the stiffest
    /// choice.
    Interpolated,
    /// C = (2I − L)X, one step towards interpolation: enough for fourth order on smooth meshes.
    Sharpened,
    /// C = (2I − L)X, and then, with the neighbours fixed, each extraordinary vertex gets the
    /// control point with which the surface passes through its node. The error there is 20 to 60
    /// times smaller than with [`Self::Sharpened`].
    #[default]
    Hybrid,
}

impl ControlPoints {
    /// All choices.
    pub const ALL: [Self; 4] = [
        Self::Nodes,
        Self::Interpolated,
        Self::Sharpened,
        Self::Hybrid,
    ];
}

/// Q and its transpose.
#[derive(Clone, Debug)]
pub(super) enum ControlMap<T> {
    Identity,
    Direct { map: Stencils, transpose: Stencils },
    Inverse(Inverse<T>),
}

impl<T: Real> ControlMap<T> {
    pub(super) fn new(controls: ControlPoints, mesh: &TriangleMesh, limit: &Stencils) -> Self {
        let map = match controls {
            ControlPoints::Nodes => return Self::Identity,
            ControlPoints::Interpolated => return Self::Inverse(Inverse::new(mesh, limit)),
            ControlPoints::Sharpened => sharpened(limit),
            ControlPoints::Hybrid => hybrid(mesh, &sharpened(limit)),
        };
        let transpose = map.transpose();
        Self::Direct { map, transpose }
    }

    /// Sets `controls` to Q `nodes`.
    pub(super) fn apply<const D: usize>(
        &self,
        execution: &impl Execution,
        nodes: &[[T; D]],
        controls: &mut [[T; D]],
        scratch: &mut alloc::vec::Vec<[T; D]>,
    ) {
        match self {
            Self::Identity => controls.copy_from_slice(nodes),
            Self::Direct { map, .. } => map.apply(execution, nodes, controls),
            Self::Inverse(inverse) => {
                scratch.resize(nodes.len(), [T::zero(); D]);
                inverse.solve(execution, &inverse.limit, nodes, controls, scratch);
            }
        }
    }

    /// Sets `nodal` to Qᵀ `forces`.
    pub(super) fn apply_transpose<const D: usize>(
        &self,
        execution: &impl Execution,
        forces: &[[T; D]],
        nodal: &mut [[T; D]],
        scratch: &mut alloc::vec::Vec<[T; D]>,
    ) {
        match self {
            Self::Identity => nodal.copy_from_slice(forces),
            Self::Direct { transpose, .. } => transpose.apply(execution, forces, nodal),
            Self::Inverse(inverse) => {
                scratch.resize(forces.len(), [T::zero(); D]);
                inverse.solve(execution, &inverse.transpose, forces, nodal, scratch);
            }
        }
    }
}

/// 2I − L.
fn sharpened(limit: &Stencils) -> Stencils {
    let vertices = limit.len();
    let mut map = Stencils::with_capacity(vertices, vertices, 7 * vertices);
    let mut sum = RowSum::new(vertices);
    for vertex in 0..vertices {
        sum.add(vertex as u32, 2.0);
        sum.add_row(limit, vertex, -1.0);
        sum.finish(&mut map);
    }
    map
}

/// `C_i = (X_i − ω Σ_j C_j)/(1 − nω)` at extraordinary vertices, with the sharpened neighbours.
fn hybrid(mesh: &TriangleMesh, sharpened: &Stencils) -> Stencils {
    let vertices = mesh.vertex_count();
    let mut map = Stencils::with_capacity(vertices, vertices, 7 * vertices);
    let mut sum = RowSum::new(vertices);
    for vertex in 0..vertices {
        let ring = mesh.one_ring(vertex);
        if mesh.is_interior(vertex) && ring.len() != 6 {
            let omega = limit_weight(ring.len());
            let over = 1.0 / (1.0 - ring.len() as f64 * omega);
            sum.add(vertex as u32, over);
            for &neighbour in ring {
                sum.add_row(sharpened, neighbour as usize, -omega * over);
            }
        } else {
            sum.add_row(sharpened, vertex, 1.0);
        }
        sum.finish(&mut map);
    }
    map
}

/// L⁻¹ by Chebyshev's iteration.
///
/// All eigenvalues of L are real and lie in \[a, 1\], `a = 1 − 3/2 max(nω)`: around an interior vertex
/// `L = I − ωΔ` is similar to a sum over triangles of symmetric matrices with these bounds, and the
/// boundary has 1/3 … 1. A number of steps that depends on a and on the number type alone makes the
/// result a polynomial of L: a linear map with the same polynomial of Lᵀ as its exact transpose, so
/// that forces are the gradient to rounding whatever is left of the error.
#[derive(Clone, Debug)]
pub(super) struct Inverse<T> {
    limit: Stencils,
    transpose: Stencils,
    /// Centre and half-width of the eigenvalues' interval.
    centre: T,
    half_width: T,
    steps: usize,
}

impl<T: Real> Inverse<T> {
    fn new(mesh: &TriangleMesh, limit: &Stencils) -> Self {
        let lowest = (0..mesh.vertex_count())
            .filter(|&vertex| mesh.is_interior(vertex))
            .map(|vertex| {
                let valence = mesh.valence(vertex);
                1.0 - 1.5 * valence as f64 * limit_weight(valence)
            })
            .fold(1.0 / 3.0, f64::min);
        let (centre, half_width) = ((1.0 + lowest) / 2.0, (1.0 - lowest) / 2.0);
        let ratio = centre / half_width;
        // T_k(ratio) ≈ ½ (ratio + √(ratio² − 1))^k divides the error.
        let rate = ratio + Float::sqrt(ratio * ratio - 1.0);
        let precision = T::epsilon().to_f64().unwrap_or(f64::EPSILON);
        let steps = Float::ceil(Float::ln(2.0 / precision) / Float::ln(rate)) as usize;
        // Additional steps, because next to a boundary L is not similar to a symmetric matrix, and
        // errors first grow slightly.
        let extra = if mesh.is_closed() { 0 } else { steps / 4 };
        Self {
            limit: limit.clone(),
            transpose: limit.transpose(),
            centre: T::constant(centre),
            half_width: T::constant(half_width),
            steps: steps + extra,
        }
    }

    /// Sets `solution` to about `matrix`⁻¹ `right`, for the matrix L or its transpose.
    fn solve<const D: usize>(
        &self,
        execution: &impl Execution,
        matrix: &Stencils,
        right: &[[T; D]],
        solution: &mut [[T; D]],
        update: &mut [[T; D]],
    ) {
        solution.copy_from_slice(right);
        let two = T::constant(2.0);
        let ratio = self.centre / self.half_width;
        let mut rho = ratio.recip();
        let [mut keep, mut gain] = [T::zero(), self.centre.recip()];
        for _ in 0..self.steps {
            let current = &*solution;
            execution.map(&mut update[..], |row, update| {
                let image: [T; D] = matrix.at(row, current);
                for k in 0..D {
                    update[k] = keep * update[k] + gain * (right[row][k] - image[k]);
                }
            });
            let update = &*update;
            execution.map(&mut solution[..], |row, solution| {
                for k in 0..D {
                    solution[k] += update[row][k];
                }
            });
            let next = (two * ratio - rho).recip();
            keep = next * rho;
            gain = two * next / self.half_width;
            rho = next;
        }
    }
}
