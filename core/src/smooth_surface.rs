//! The smooth surface through the vertices of a mesh, at any of its points.
//!
//! Local fits of the vertices of a triangle are averaged (X. Jiao and D. Wang, Eng. Comput. 28 (2012); Y. Li, X. Zhao,
//! N. Ray and X. Jiao, arXiv:1901.08036). Here the fits are those of [`Jet`], and their points are moved onto one
//! normal line before they are averaged; otherwise the order would be 6 at most.

mod fields;

use crate::curvature::{Curvature, Curvatures};
use crate::edit::{EditableMesh, Edited};
use crate::element::Execution;
use crate::face_tree::{FaceTree, MeshPoint};
use crate::lane::Lane;
use crate::laplacian::{Jet, JetPoint};
use crate::mesh::TriangleMesh;
use crate::method::{Method, Workspace};
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, cross, dot, norm, normalise, scale, sub};
use alloc::vec;
use alloc::vec::Vec;
use core::array::from_fn;
use core::iter::zip;
pub use fields::{FieldPoint, SmoothFields};

/// Most steps of a projection.
const STEPS: usize = 30;

/// The error bar of a position in disagreements of its fits. At the centroids of irregular meshes of ellipsoids and tori,
/// 99 of 100 errors are at most 4.1 disagreements; on spheres, where neighbouring fits share their errors, 95 of 100.
const DOUBTED: f64 = 4.0;

/// The smooth surface through the vertices of a mesh: around each vertex the polynomial that [`Jet`] fits, and over
/// each triangle a blend of the polynomials of its corners.
///
/// Polynomials of degree d are fitted once, when the surface is made, which keeps a copy of the mesh. Positions have
/// errors of order d + 1 in the edge length, H and K of order d − 1. The surface passes through the vertices; where all
/// corners have fits it is continuous, except across lines, and has kinks of order d at edges and none at vertices. Corners
/// without a fit do not take part in a blend; where no corner has one, points are those of the flat triangle, and curvatures
/// NaN. At lines where a surface is folded, the fits of each side are those of a border.
///
/// ```
/// use helfrich::{Jet, MeshPoint, Serial, SmoothSurface, Surface, TriangleMesh};
///
/// // A piece of a cylinder of radius 1.
/// let n = 15_u32;
/// let point = |k: u32| {
///     let (angle, y) = (0.1 * f64::from(k % n), 0.1 * f64::from(k / n));
///     [angle.sin(), y, angle.cos()]
/// };
/// let points: Vec<[f64; 3]> = (0..n * n).map(point).collect();
/// let corners = (0..n * (n - 1)).filter(|k| k % n < n - 1);
/// let triangles = corners.flat_map(|k| [[k, k + 1, k + n + 1], [k, k + n + 1, k + n]]);
/// let mesh = TriangleMesh::new(points.len(), triangles.collect())?;
/// let surface = Surface::new(&mesh, &points)?;
///
/// let smooth = SmoothSurface::new(&Serial, surface, &Jet::j6());
/// let place = smooth.project([0.8, 0.65, 0.9]).expect("a mesh with triangles");
/// let found = smooth.at(place);
/// let [x, _, z] = found.position;
/// assert!((x.hypot(z) - 1.0).abs() < 1e-8 && (found.mean - 0.5).abs() < 1e-5);
/// assert!((x * 0.9 - z * 0.8).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SmoothSurface<T: Real> {
    mesh: TriangleMesh,
    positions: Vec<[T; 3]>,
    remainders: Option<Vec<[T; 3]>>,
    lines: Vec<[u32; 2]>,
    /// The mesh cut along the lines, if there are any; its vertices are those of the fits.
    cut: Option<Edited>,
    jet: Jet<T>,
    workspace: Workspace<T, Jet<T>>,
    vertices: Vec<Curvature<T>>,
    /// See [`Self::misfits`].
    misfits: Vec<T>,
    tree: FaceTree<T>,
}

/// A point of a [`SmoothSurface`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SmoothPoint<T> {
    /// The position.
    pub position: [T; 3],
    /// The outward unit normal; 0 where neither fits nor the triangle have one.
    pub normal: [T; 3],
    /// H, positive on a sphere, in 1/length; NaN without a fit.
    pub mean: T,
    /// K, in 1/length²; NaN without a fit.
    pub gaussian: T,
    /// The unit tangent vector of the larger principal curvature; 0 at umbilics and without a fit.
    pub direction: [T; 3],
    /// An error bar of the distance from the surface of which the vertices are exact points: four times the larger of two
    /// disagreements, of the polynomials of the corners with their blend at the point, and of each polynomial with the
    /// vertices around its own, weighted by the squared distance from the corner. 0 at vertices, infinite without a fit.
    pub position_error: T,
    /// Estimates of the errors of H and K: the disagreement of neighbouring fits.
    pub curvature_errors: [T; 2],
}

impl<T: Real> SmoothPoint<T> {
    /// The principal curvatures c₁ ≥ c₂, `H ± √(H² − K)`; both are H where K is larger than H² by errors.
    pub fn principal(&self) -> [T; 2] {
        let root = (self.mean * self.mean - self.gaussian)
            .max(T::zero())
            .sqrt();
        [self.mean + root, self.mean - root]
    }
}

/// A corner of a triangle, with its part of a blend.
#[derive(Clone, Copy)]
struct Corner<T> {
    vertex: usize,
    weight: T,
    found: JetPoint<T>,
    /// The distance of the place from the corner, in lengths of the longest edge.
    away: T,
}

impl<T: Real> SmoothSurface<T> {
    /// The jet with the most accurate positions: of degree 8 from 2500 vertices of the largest component on, of degree 6
    /// below. ([`Jet::for_mesh`] takes degree 4 on small meshes for the sake of forces.)
    pub fn jet_for(mesh: &TriangleMesh) -> Jet<T> {
        let jet = Jet::for_mesh(mesh);
        if jet.highest_degree() < 6 {
            Jet::j6()
        } else {
            jet
        }
    }

    /// Fits the polynomials of a jet to a surface.
    pub fn new(execution: &impl Execution, surface: Surface<'_, T>, jet: &Jet<T>) -> Self {
        Self::with_lines(execution, surface, jet, &[])
    }

    /// Fits the polynomials of a jet to a surface that is folded along these edges: each side is fitted alone.
    ///
    /// # Panics
    /// If a line is not an edge of the mesh.
    pub fn with_lines(
        execution: &impl Execution,
        surface: Surface<'_, T>,
        jet: &Jet<T>,
        lines: &[[u32; 2]],
    ) -> Self {
        let mut copies = None;
        if !lines.is_empty() {
            copies = Some(EditableMesh::with_lines(surface.mesh(), lines).cut());
        }
        let copied = |of: &[[T; 3]]| {
            let copies = copies.as_ref()?.vertices.iter();
            Some(Vec::from_iter(copies.map(|&vertex| of[vertex as usize])))
        };
        let positions = copied(surface.positions());
        let remainders = surface.remainders().and_then(copied);
        let fitted = match (&copies, &positions) {
            (Some(copies), Some(positions)) => {
                Surface::of_checked(&copies.mesh, positions, remainders.as_deref())
            }
            _ => surface,
        };
        let (workspace, vertices, misfits) = fits(execution, fitted, jet);
        Self {
            mesh: surface.mesh().clone(),
            positions: surface.positions().to_vec(),
            remainders: surface.remainders().map(<[_]>::to_vec),
            lines: lines.to_vec(),
            jet: *jet,
            workspace,
            vertices,
            misfits,
            tree: FaceTree::new(surface),
            cut: copies,
        }
    }

    /// The edges along which the surface is folded.
    pub fn lines(&self) -> &[[u32; 2]] {
        &self.lines
    }

    /// The mesh with its positions.
    pub fn surface(&self) -> Surface<'_, T> {
        Surface::of_checked(&self.mesh, &self.positions, self.remainders.as_deref())
    }

    /// H, K and normals of the fits at the vertices; at lines those of one of the sides.
    pub fn vertices(&self) -> &[Curvature<T>] {
        &self.vertices[..self.mesh.vertex_count()]
    }

    /// The highest degree of the polynomials.
    pub fn degree(&self) -> usize {
        self.jet.highest_degree()
    }

    /// [`SmoothPoint::curvature_errors`] at the vertices.
    pub fn curvature_errors(&self) -> &[[T; 2]] {
        &self.workspace.memory().disagreements()[..self.mesh.vertex_count()]
    }

    /// The largest distance of the polynomial of each vertex from the vertices of its one-ring; infinite without a fit.
    pub fn misfits(&self) -> &[T] {
        &self.misfits[..self.mesh.vertex_count()]
    }

    /// The point over a place of the mesh.
    ///
    /// The polynomial of corner i has a point s_i over the point of the flat triangle, with the normal n_i. With the
    /// barycentric coordinates λ, weights are `w_i = λ_i²/Σ λ_j²`. H and K are the means of those at the points s_i, n is the
    /// mean of the n_i, normalised. The mean q of the points s_i lies inside a curved surface; the position is therefore
    /// `q + n Σ w_i t_i`, where `q + t_i n` is on the polynomial of corner i.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn at(&self, place: MeshPoint<T>) -> SmoothPoint<T> {
        self.beside(place, [T::zero(); 3])
    }

    /// As [`Self::at`], over the point at a small offset from that of the flat triangle.
    pub(crate) fn beside(&self, place: MeshPoint<T>, shift: Vec3<T>) -> SmoothPoint<T> {
        let origin = self.position(self.mesh.triangles()[place.triangle][0]);
        let Some(corners) = self.corners(place, shift) else {
            return self.flat_point(place, shift);
        };
        let vector = |of: fn(&JetPoint<T>) -> Vec3<T>| {
            let terms = corners.iter().map(|at| scale(at.weight, of(&at.found)));
            terms.fold([T::zero(); 3], add)
        };
        let number = |of: &dyn Fn(&Corner<T>) -> T| -> T {
            // Corners without weight may have infinite errors, and 0 · ∞ is NaN.
            let blended = corners.iter().filter(|corner| corner.weight > T::zero());
            blended.map(|corner| corner.weight * of(corner)).sum()
        };
        let middle = vector(|found| found.offset);
        let normal = normalise(vector(|found| found.normal));
        let height_of = |corner: &Corner<T>| corner.found.height_over(middle, normal);
        let height = number(&height_of);
        let apart = corners.iter().filter(|corner| corner.weight > T::zero());
        let apart = apart.map(|corner| (height_of(corner) - height).abs());
        let direction = vector(|found| found.direction);
        let disagreements = self.workspace.memory().disagreements();
        let curvature_error = |which: usize| number(&|corner| disagreements[corner.vertex][which]);
        SmoothPoint {
            position: add(origin, add(middle, scale(height, normal))),
            normal,
            mean: number(&|corner| corner.found.curvatures[0]),
            gaussian: number(&|corner| corner.found.curvatures[1]),
            direction: normalise(sub(direction, scale(dot(direction, normal), normal))),
            position_error: T::constant(DOUBTED)
                * apart.fold(
                    number(&|corner| corner.away * corner.away * self.misfits[corner.vertex]),
                    T::max,
                ),
            curvature_errors: [0, 1].map(curvature_error),
        }
    }

    /// As [`Self::at`], of many places.
    pub fn all_at(
        &self,
        execution: &impl Execution,
        places: &[MeshPoint<T>],
    ) -> Vec<SmoothPoint<T>> {
        let mut points = vec![SmoothPoint::default(); places.len()];
        execution.map(&mut points[..], |index, point| {
            *point = self.at(places[index])
        });
        points
    }

    /// For each corner, the point of its polynomial over a place, relative to the first corner, and its weight. Weights have
    /// the sum 1, and are 0 without a fit; `None` if no corner has one.
    fn corners(&self, place: MeshPoint<T>, shift: Vec3<T>) -> Option<[Corner<T>; 3]> {
        let vertices = self.mesh.triangles()[place.triangle];
        let seen = self.surface().seen_from(vertices[0]);
        let places = vertices.map(|vertex| seen.difference(vertex));
        let terms = zip(place.barycentric, places).map(|(weight, place)| scale(weight, place));
        let flat = terms.fold(shift, add);
        let fits = self.fitted().triangles()[place.triangle];
        let over_size = self.longest_edge(place.triangle).reciprocal_or_zero();
        let mut total = T::zero();
        let mut first = None;
        let corners = from_fn(|k| {
            let vertex = fits[k] as usize;
            let mut corner = Corner {
                vertex,
                weight: T::zero(),
                found: JetPoint::default(),
                away: T::zero(),
            };
            let polynomial = self.workspace.memory().polynomial(vertex);
            let weight = place.barycentric[k] * place.barycentric[k];
            if let Some(polynomial) = polynomial.filter(|_| weight > T::zero()) {
                let away = sub(flat, places[k]);
                corner.found = polynomial.beside(away);
                corner.found.offset = add(places[k], corner.found.offset);
                // Directions have no sign.
                let first = *first.get_or_insert(corner.found.direction);
                let sign = T::one().copysign(dot(first, corner.found.direction));
                corner.found.direction = scale(sign, corner.found.direction);
                corner.away = over_size * norm(away);
                corner.weight = weight;
                total += weight;
            }
            corner
        });
        let over = total.reciprocal_or_zero();
        (over > T::zero()).then(|| {
            corners.map(|corner| Corner {
                weight: over * corner.weight,
                ..corner
            })
        })
    }

    /// A point without fits.
    pub(crate) fn flat_point(&self, place: MeshPoint<T>, shift: Vec3<T>) -> SmoothPoint<T> {
        let [a, b, c] = self.mesh.triangles()[place.triangle].map(|k| self.position(k));
        SmoothPoint {
            position: add(self.flat(place), shift),
            normal: normalise(cross(sub(b, a), sub(c, a))),
            mean: T::nan(),
            gaussian: T::nan(),
            direction: [T::zero(); 3],
            position_error: T::infinity(),
            curvature_errors: [T::infinity(); 2],
        }
    }

    /// The place of the mesh over which the surface is nearest to a point; `None` for a mesh without triangles, or a
    /// point that is not finite.
    ///
    /// The search begins at the nearest point of the flat triangles, and moves it by the tangential part of the difference
    /// that is left. It converges for points nearer than about half of the smallest radius of curvature; for farther ones it
    /// finds a place near the best one.
    pub fn project(&self, point: [T; 3]) -> Option<MeshPoint<T>> {
        let mut place = self.tree.nearest(self.surface(), point, None)?;
        let size = self.longest_edge(place.triangle);
        for _ in 0..STEPS {
            let found = self.at(place);
            let left = sub(point, found.position);
            let along = sub(left, scale(dot(left, found.normal), found.normal));
            // False for NaN.
            let is_left = norm(along) > T::epsilon() * size;
            let target = add(self.flat(place), along);
            let next = self
                .tree
                .nearest(self.surface(), target, Some(place.triangle));
            match next.filter(|next| is_left && *next != place) {
                Some(next) => place = next,
                None => break,
            }
        }
        Some(place)
    }

    /// As [`Self::project`], of many points.
    pub fn project_all(
        &self,
        execution: &impl Execution,
        points: &[[T; 3]],
    ) -> Vec<Option<MeshPoint<T>>> {
        let mut places = vec![None; points.len()];
        execution.map(&mut places[..], |index, place| {
            *place = self.project(points[index])
        });
        places
    }

    /// The mesh whose vertices are those of the fits: the mesh, or that cut along the lines.
    fn fitted(&self) -> &TriangleMesh {
        self.cut.as_ref().map_or(&self.mesh, |cut| &cut.mesh)
    }

    /// The vertex of the mesh of which a vertex of [`Self::fitted`] is a copy.
    fn original(&self, vertex: usize) -> u32 {
        match &self.cut {
            Some(cut) => cut.vertices[vertex],
            None => vertex as u32,
        }
    }

    fn flat(&self, place: MeshPoint<T>) -> Vec3<T> {
        let corners = self.mesh.triangles()[place.triangle];
        let terms = zip(corners, place.barycentric);
        let terms = terms.map(|(corner, weight)| scale(weight, self.position(corner)));
        terms.fold([T::zero(); 3], add)
    }

    pub(crate) fn longest_edge(&self, triangle: usize) -> T {
        let [a, b, c] = self.mesh.triangles()[triangle].map(|k| self.position(k));
        norm(sub(b, a)).max(norm(sub(c, a))).max(norm(sub(c, b)))
    }

    fn position(&self, vertex: u32) -> Vec3<T> {
        self.positions[vertex as usize]
    }
}

/// The polynomials of all vertices, their curvatures and misfits.
#[expect(
    clippy::type_complexity,
    reason = "three columns of one table, taken apart at once"
)]
fn fits<T: Real>(
    execution: &impl Execution,
    surface: Surface<'_, T>,
    jet: &Jet<T>,
) -> (Workspace<T, Jet<T>>, Vec<Curvature<T>>, Vec<T>) {
    let mesh = surface.mesh();
    let mut workspace = jet.workspace(mesh);
    workspace
        .for_mesh_mut(mesh)
        .keep_polynomials(jet.highest_degree());
    let mut vertices = vec![Curvature::default(); mesh.vertex_count()];
    jet.curvatures(execution, surface, &mut workspace, &mut vertices);
    let memory = workspace.memory();
    let mut misfits = vec![T::infinity(); mesh.vertex_count()];
    execution.map(&mut misfits[..], |vertex, misfit| {
        let Some(polynomial) = memory.polynomial(vertex) else {
            return;
        };
        let seen = surface.seen_from(vertex as u32);
        let ring = mesh.one_ring(vertex).iter().map(|&other| {
            let offset = seen.difference(other);
            norm(sub(polynomial.offset_beside(offset), offset))
        });
        *misfit = ring.fold(T::zero(), T::max);
    });
    (workspace, vertices, misfits)
}
