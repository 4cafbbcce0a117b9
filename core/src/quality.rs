//! Findings about the surface itself, for methods to report.

use crate::diagnostic::Finding;
use crate::lane::Lane;
use crate::mesh::VertexKind;
use crate::real::Real;
use crate::surface::Surface;
use crate::triangle::{DualArea, Triangle, Voronoi};
use crate::vec3::{Vec3, add, dot};

/// Height over longest edge below which a triangle is thin: needles below 1.8°, caps above 176.4°.
const THIN: f64 = 1.0 / 32.0;

/// The fraction of the area around a vertex below which a signed area counts as cancelled; a third
/// is normal.
const SMALL: f64 = 1.0 / 32.0;

/// Ratio of the longest to the shortest edge at a vertex above which edges are uneven.
const UNEVEN: f64 = 8.0;

/// Sums over the triangles around a vertex.
struct Fan<T> {
    area: T,
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
    fn new(surface: Surface<'_, T>, vertex: usize) -> Self {
        // Triangles are not computed again, except those of vertices with many.
        let mut vectors = [[T::zero(); 3]; 10];
        let mut area = T::zero();
        let mut whole = [T::zero(); 3];
        let mut count = 0;
        for triangle in around(surface, vertex) {
            if let Some(vector) = vectors.get_mut(count) {
                *vector = triangle.area_vector;
            }
            count += 1;
            area += T::constant(0.5) * triangle.doubled_area;
            whole = add(whole, triangle.area_vector);
        }
        let is_against = |vector: &Vec3<T>| dot(*vector, whole) < T::zero();
        let others = || around(surface, vertex).map(|triangle| triangle.area_vector);
        let is_folded = match vectors.get(..count) {
            Some(all) => all.iter().any(is_against),
            None => others().any(|vector| is_against(&vector)),
        };
        Self { area, is_folded }
    }

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

    /// Reports vertices where the surface folds back, or where the rounding of stored positions is
    /// too large for a fourth derivative. Both affect every method.
    pub(crate) fn report_rough_vertices(&self, report: &mut dyn FnMut(Finding)) {
        let scale = self.fourth_derivative();
        for vertex in 0..self.mesh().vertex_count() {
            let fan = Fan::new(*self, vertex);
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
        for vertex in 0..self.mesh().vertex_count() {
            if Fan::new(*self, vertex).is_lost(deviation, scale) {
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
        let voronoi = |vertex: usize| {
            let areas = around(*self, vertex).map(|triangle| triangle.dual_areas(Voronoi)[0]);
            areas.fold(T::zero(), |sum, area| sum + area)
        };
        let is_obtuse = |triangle: Triangle<T>| triangle.dots.iter().any(|&dot| dot < T::zero());
        for vertex in 0..self.mesh().vertex_count() {
            let Some(area) = area(vertex) else { continue };
            let place = vertex as u32;
            if area.abs() < T::min_positive_value() {
                report(Finding::ZeroArea { vertex: place });
                continue;
            }
            match kind {
                DualArea::Barycentric => {}
                DualArea::Voronoi => {
                    let all = || Fan::new(*self, vertex).area;
                    if area < T::zero() {
                        report(Finding::NegativeArea { vertex: place });
                    } else if area < T::constant(SMALL) * all() {
                        report(Finding::SmallArea { vertex: place });
                    }
                }
                DualArea::Mixed => {
                    // Only obtuse triangles have corners with negative areas.
                    if around(*self, vertex).any(is_obtuse) && voronoi(vertex) <= T::zero() {
                        report(Finding::ClampedArea { vertex: place });
                    }
                }
            }
        }
    }
}
