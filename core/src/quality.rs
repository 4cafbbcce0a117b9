//! Findings about the surface itself, for methods to report.

use crate::diagnostic::Finding;
use crate::lane::Lane;
use crate::mesh::VertexKind;
use crate::real::Real;
use crate::surface::Surface;
use crate::triangle::{DualArea, Triangle, Voronoi};
use crate::vec3::{Vec3, add, dot};
use alloc::vec;
use alloc::vec::Vec;

/// Height over longest edge below which a triangle is thin: needles below 1.8°, caps above 176.4°.
const THIN: f64 = 1.0 / 32.0;

/// The fraction of the area around a vertex below which a signed area counts as cancelled; a third
/// is normal.
const SMALL: f64 = 1.0 / 32.0;

/// Ratio of the longest to the shortest edge at a vertex above which edges are uneven.
const UNEVEN: f64 = 8.0;

/// Sums over the triangles around a vertex.
#[derive(Clone)]
struct Fan<T> {
    area: T,
    area_vector: Vec3<T>,
    /// Whether a triangle is turned against the others.
    is_folded: bool,
}

/// The triangles around a vertex; none around an isolated one.
fn around<T: Real>(surface: Surface<'_, T>, vertex: usize) -> impl Iterator<Item = Triangle<T>> {
    let mesh = surface.mesh();
    let ring = mesh.one_ring(vertex);
    let count = match mesh.vertex_kind(vertex) {
        VertexKind::Interior => ring.len(),
        VertexKind::Boundary | VertexKind::Isolated => ring.len().saturating_sub(1),
    };
    (0..count).map(move |place| {
        let (a, b, c) = (vertex as u32, ring[place], ring[(place + 1) % ring.len()]);
        Triangle::new([
            surface.difference(b, c),
            surface.difference(c, a),
            surface.difference(a, b),
        ])
    })
}

impl<T: Real> Triangle<T> {
    /// Whether the height is a small fraction of the longest edge; false for a triangle without
    /// extent.
    fn is_thin(&self) -> bool {
        let squared = self.edges.map(|edge| dot(edge, edge));
        let longest = squared.into_iter().fold(T::zero(), T::max);
        self.doubled_area < T::constant(THIN) * longest
    }
}

impl<T: Real> Fan<T> {
    /// Whether a random error of the positions causes an error of Δ_S H as large as `scale`.
    fn is_lost(&self, deviation: T, scale: T) -> bool {
        // An error σ of the positions becomes one of about 10 σ/A², whatever the method.
        let over = (self.area * T::constant(1.0 / 3.0)).reciprocal_or_zero();
        T::constant(10.0) * deviation * over * over >= scale && over > T::zero()
    }
}

impl<T: Real> Surface<'_, T> {
    /// Reports triangles that have no area or are so thin that division by their area amplifies
    /// errors, and vertices with edges of very different lengths.
    pub(crate) fn report_uneven_mesh(&self, report: &mut dyn FnMut(Finding)) {
        for index in 0..self.mesh().triangles().len() {
            let triangle = self.triangle(index);
            let index = index as u32;
            if triangle.reciprocal == T::zero() {
                report(Finding::DegenerateTriangle { triangle: index });
            } else if triangle.is_thin() {
                report(Finding::ThinTriangle { triangle: index });
            }
        }
        for vertex in 0..self.mesh().vertex_count() {
            if self.is_uneven(vertex) {
                let vertex = vertex as u32;
                report(Finding::Uneven { vertex });
            }
        }
    }

    /// Reports vertices with fewer than four or more than nine neighbours.
    pub(crate) fn report_valences(&self, report: &mut dyn FnMut(Finding)) {
        let mesh = self.mesh();
        for vertex in 0..mesh.vertex_count() {
            let interior = mesh.is_interior(vertex);
            if interior && !(4..=9).contains(&mesh.valence(vertex)) {
                let vertex = vertex as u32;
                report(Finding::UnusualValence { vertex });
            }
        }
    }

    /// Combines [`Self::report_uneven_mesh`] and [`Self::report_valences`] in one finding, for a
    /// method whose value at a vertex depends on all vertices within `rings` edges.
    pub(crate) fn report_uneven_within(&self, rings: u32, report: &mut dyn FnMut(Finding)) {
        for vertex in 0..self.mesh().vertex_count() {
            if self.is_uneven_within(rings, vertex) {
                let vertex = vertex as u32;
                report(Finding::Uneven { vertex });
            }
        }
    }

    fn is_uneven_within(&self, rings: u32, vertex: usize) -> bool {
        let mesh = self.mesh();
        let thin = || around(*self, vertex).any(|triangle| triangle.is_thin());
        let interior = mesh.is_interior(vertex);
        let unusual = interior && !(4..=9).contains(&mesh.valence(vertex));
        let ring = || mesh.one_ring(vertex).iter();
        let beyond = || rings > 0 && ring().any(|&v| self.is_uneven_within(rings - 1, v as usize));
        unusual || self.is_uneven(vertex) || thin() || beyond()
    }

    /// Whether a triangle has no area only because its edges are so short that the square of an area is
    /// no normal number.
    pub(crate) fn has_areas_below_range(&self) -> bool {
        let least = T::min_positive_value() / T::epsilon();
        (0..self.mesh().triangles().len()).any(|triangle| {
            let triangle = self.triangle(triangle);
            let squared = triangle.edges.map(|edge| dot(edge, edge));
            let longest = squared.into_iter().fold(T::zero(), T::max);
            triangle.doubled_area == T::zero() && longest > T::zero() && longest * longest < least
        })
    }

    /// Whether the edges at a vertex have very different lengths.
    fn is_uneven(&self, vertex: usize) -> bool {
        let squared = self.spokes(vertex).map(|edge| dot(edge, edge));
        let (least, most) = squared.fold((T::max_value(), T::zero()), |(least, most), squared| {
            (least.min(squared), most.max(squared))
        });
        most > T::constant(UNEVEN * UNEVEN) * least
    }

    /// The sums around every vertex.
    fn fans(&self) -> Vec<Fan<T>> {
        let mesh = self.mesh();
        let none = Fan {
            area: T::zero(),
            area_vector: [T::zero(); 3],
            is_folded: false,
        };
        let mut fans = vec![none; mesh.vertex_count()];
        let vectors = || {
            let corners = mesh.triangles().iter().enumerate();
            corners.map(|(index, corners)| (corners.map(|v| v as usize), self.triangle(index)))
        };
        for (corners, triangle) in vectors() {
            for vertex in corners {
                let fan = &mut fans[vertex];
                fan.area += T::constant(0.5) * triangle.doubled_area;
                fan.area_vector = add(fan.area_vector, triangle.area_vector);
            }
        }
        for (corners, triangle) in vectors() {
            for vertex in corners {
                let fan = &mut fans[vertex];
                fan.is_folded |= dot(triangle.area_vector, fan.area_vector) < T::zero();
            }
        }
        fans
    }

    /// Reports vertices where the surface folds back, or where the rounding of stored positions is
    /// too large for a fourth derivative. Both affect every method.
    pub(crate) fn report_rough_vertices(&self, report: &mut dyn FnMut(Finding)) {
        let scale = self.fourth_derivative();
        for (vertex, fan) in self.fans().iter().enumerate() {
            let place = vertex as u32;
            if fan.is_folded {
                report(Finding::Folded { vertex: place });
            }
            let over = (fan.area * T::constant(1.0 / 3.0)).reciprocal_or_zero();
            // Coefficients of Δ_S are a few times 1/A, and H is at most of the order of 1/√A.
            let largest = T::constant(64.0) * over * over.sqrt();
            let has_extent = || self.spokes(vertex).any(|edge| edge != [T::zero(); 3]);
            if !largest.is_finite() || (over == T::zero() && has_extent()) {
                report(Finding::OutOfRange { vertex: place });
                continue;
            }
            // The error of a rounded position is a fifth of the last digit.
            let deviation = T::constant(0.2) * self.last_digit(vertex);
            if fan.is_lost(deviation, scale) {
                report(Finding::RoundedPosition { vertex: place });
            }
        }
    }

    /// Reports vertices where noise with this standard deviation is too large for a fourth
    /// derivative.
    pub(crate) fn report_noisy_vertices(&self, deviation: T, report: &mut dyn FnMut(Finding)) {
        let scale = self.fourth_derivative();
        for (vertex, fan) in self.fans().iter().enumerate() {
            if fan.is_lost(deviation, scale) {
                let vertex = vertex as u32;
                report(Finding::NoisyPosition { vertex });
            }
        }
    }

    /// 1/R³ of the sphere with this area: the scale of a fourth derivative.
    fn fourth_derivative(&self) -> T {
        let squared = T::constant(4.0) * T::PI() * self.area().reciprocal_or_zero();
        squared * squared.sqrt()
    }

    /// The largest last digit of a vertex's coordinates, as they are stored.
    fn last_digit(&self, vertex: usize) -> T {
        let largest = |position: [T; 3]| {
            position
                .into_iter()
                .fold(T::zero(), |most, x| most.max(x.abs()))
        };
        let stored = match self.remainders() {
            None => largest(self.positions()[vertex]),
            Some(remainders) => largest(remainders[vertex]),
        };
        T::epsilon() * stored
    }

    /// Reports areas that a method cannot divide by with confidence: `area(i)` is that of vertex i,
    /// `None` if the method does not divide there.
    pub(crate) fn report_areas(
        &self,
        kind: DualArea,
        area: impl Fn(usize) -> Option<T>,
        report: &mut dyn FnMut(Finding),
    ) {
        let mesh = self.mesh();
        // The Voronoi area of each vertex, and that of its triangles.
        let mut sums = vec![[T::zero(); 2]; mesh.vertex_count()];
        if kind != DualArea::Barycentric {
            for (index, corners) in mesh.triangles().iter().enumerate() {
                let triangle = self.triangle(index);
                let half = T::constant(0.5) * triangle.doubled_area;
                for (&vertex, own) in corners.iter().zip(triangle.dual_areas(Voronoi)) {
                    let [voronoi, all] = &mut sums[vertex as usize];
                    *voronoi += own;
                    *all += half;
                }
            }
        }
        for (vertex, &[voronoi, all]) in sums.iter().enumerate() {
            let Some(area) = area(vertex) else { continue };
            let vertex = vertex as u32;
            if area.abs() < T::min_positive_value() {
                report(Finding::ZeroArea { vertex });
            } else if kind == DualArea::Mixed && voronoi <= T::zero() {
                report(Finding::ClampedArea { vertex });
            } else if kind == DualArea::Voronoi && area < T::zero() {
                report(Finding::NegativeArea { vertex });
            } else if kind == DualArea::Voronoi && area < T::constant(SMALL) * all {
                report(Finding::SmallArea { vertex });
            }
        }
    }
}
