//! The single layer: velocities due to forces of membranes in fluid of one viscosity.

use super::beside::Rule;
use super::far::{self, Far};
use super::geometry::{Geometry, Near};
use super::kernel::{Gradient, Kernel, Stokeslet, source};
use super::panel::Panel;
use super::sums;
use crate::flow::vectors::Vectors;
use glam::DVec3;
use helfrich::TriangleMesh;
use std::f64::consts::PI;
use std::num::NonZeroUsize;

/// The ratio of the error of interpolated Stokeslets to that of their sums: errors of distant clusters
/// have both signs, and near vertices, whose contributions are the largest, have none. The ratio was
/// measured as 4 for needles, and from 15 to 100 for spheres, discocytes and tori of 1000 to 160 000
/// vertices.
const INTERPOLATION: f64 = 8.0;

/// Least tolerance with which sums over clusters have single precision: their rounding errors are 1e-7 to 1e-6 by the
/// measure of [`SingleLayer::set_cluster_tolerance`].
const SINGLE: f64 = 1e-5;

/// The velocity due to forces of closed or open membranes in unbounded fluid of viscosity μ,
///
/// `u(x₀) = 1/(8πμ) ∫ G(x − x₀)·q dS`, `G(r) = I/r + r r/r³`, r = |r|,
///
/// with q the force per area that the membranes exert on the fluid. q is linear on flat triangles,
/// and `q_i = F_i/A_i` at vertices, with F_i the nodal force and A_i a third of the area of the
/// triangles around. The pressure, which vanishes far away, is `p(x₀) = −1/(4π) ∫ r·q/r³ dS`.
///
/// Positions, forces and velocities are those of all surfaces, one after the other.
///
/// # Quadrature
/// Every triangle is integrated with the midpoints of its three edges, which neighbours share; the
/// rule is exact to degree 2. Exceptions are:
/// * triangles around the vertex x₀ are integrated exactly, in polar coordinates about it;
/// * other triangles whose centre is nearer to x₀ than twice their longest edge take seven points,
///   of degree 5. With midpoints of edges their error would be of first order in the edge length h;
/// * near triangles of *other* surfaces, near triangles of the same surface that *face* x₀, and all
///   near triangles for points of the fluid are subdivided by halving their edges, at most eight
///   times, until no part is near by this criterion. Each part takes seven points. For the
///   pressure, the value of q at the nearest point is integrated exactly, and only the rest is
///   subdivided; there triangles up to twice as far away take seven points.
///
/// A triangle faces a vertex where their normals are more than a right angle apart, as in dimples
/// and folds. The error of the velocity is of second order in h for any distance between surfaces.
/// The error of the pressure is of first order on a surface, and grows logarithmically with
/// decreasing distance from an edge that is nearer than h/100.
///
/// # Reproducibility
/// Each point sums its sources in a fixed order, so results do not depend on the number of threads.
/// Their last bits depend on whether the processor fuses multiplications and additions: those of single
/// precision for sums over clusters with a tolerance of 1e-5 or more.
///
/// # Cost
/// One source per edge for each point, half as many as three per triangle. No memory grows with the
/// product of their numbers; after the first evaluation only threads allocate. With
/// [`Self::set_cluster_tolerance`] time is proportional to the number of vertices, up to a logarithm.
#[derive(Clone, Debug)]
pub struct SingleLayer {
    /// Viscosity μ of the fluid, pressure times time.
    pub viscosity: f64,
    /// Number of threads.
    pub threads: NonZeroUsize,
    geometry: Geometry,
    tractions: Vec<DVec3>,
    /// Positions and forces.
    sources: Vec<[f64; 6]>,
    far: Far,
}

impl SingleLayer {
    /// The single layer on these surfaces, before forces are set.
    ///
    /// # Panics
    /// If there are 2³² vertices or more.
    pub fn new<'a>(
        meshes: impl IntoIterator<Item = &'a TriangleMesh>,
        viscosity: f64,
        threads: NonZeroUsize,
    ) -> Self {
        Self {
            viscosity,
            threads,
            geometry: Geometry::new(meshes),
            tractions: Vec::new(),
            sources: Vec::new(),
            far: Far::default(),
        }
    }

    /// Sums velocities over clusters of vertices and edges instead of all pairs, with this tolerance; 0
    /// for all pairs. Set forces afterwards.
    ///
    /// The root mean square of errors is the tolerance times the root mean square of the velocities
    /// that forces of the same magnitudes would cause if all had the same direction. For needles it is
    /// up to twice as large, for rounder bodies a tenth to a half of it. Errors of single vertices are
    /// at most ten times as large. Pressures, surface tensions and other forces whose contributions
    /// cancel cause smaller velocities with the same error. Tolerances above 1e-3 save no time and
    /// count as 1e-3.
    pub fn set_cluster_tolerance(&mut self, tolerance: f64) {
        self.far = Far::new(INTERPOLATION, tolerance, tolerance >= SINGLE);
        self.sources.clear();
    }

    /// Number of vertices of all surfaces.
    pub fn vertex_count(&self) -> usize {
        self.geometry.vertex_count()
    }

    /// Sets positions and nodal forces F_i of the membranes on the fluid.
    ///
    /// # Panics
    /// If there is not one position and one force per vertex.
    pub fn set_forces(&mut self, positions: &[[f64; 3]], forces: &[[f64; 3]]) {
        assert_eq!(forces.len(), self.vertex_count(), "one force a vertex");
        self.geometry.place(positions);
        let geometry = &self.geometry;
        self.tractions.clear();
        for (vertex, &force) in forces.iter().enumerate() {
            let doubled_area = |&number: &u32| geometry.panel(number as usize).doubled_area();
            let ring = geometry.ring(vertex).iter();
            let area = ring.map(doubled_area).sum::<f64>() / 6.0;
            let over = if area.is_normal() { area.recip() } else { 0.0 };
            self.tractions.push(over * DVec3::from(force));
        }
        self.emit();
    }

    /// Sets positions and forces per area q_i of the membranes on the fluid.
    ///
    /// # Panics
    /// If there is not one position and one force per area per vertex.
    pub fn set_tractions(&mut self, positions: &[[f64; 3]], tractions: &[[f64; 3]]) {
        assert_eq!(
            tractions.len(),
            self.vertex_count(),
            "one traction a vertex"
        );
        self.geometry.place(positions);
        let rows = tractions.iter().copied().map(DVec3::from);
        self.tractions.clear();
        self.tractions.extend(rows);
        self.emit();
    }

    /// Adds the velocity at every vertex.
    ///
    /// # Panics
    /// If there is not one velocity per vertex, or no forces have been set.
    pub fn add_at_vertices(&self, velocity: &mut [[f64; 3]]) {
        assert_eq!(
            velocity.len(),
            self.vertex_count(),
            "one velocity per vertex"
        );
        self.assert_placed();
        if self.far.single() {
            self.add_in::<f32>(velocity);
        } else {
            self.add_in::<f64>(velocity);
        }
    }

    /// Adds the velocity at every vertex, with sums in this precision.
    fn add_in<T: Vectors>(&self, velocity: &mut [[f64; 3]]) {
        let geometry = &self.geometry;
        let units = self.far.units(Stokeslet, &self.sources);
        let (rule, exact_rule) = (Rule::<T>::new(units), Rule::<f64>::new(units));
        far::add::<T, _, _, _, _, _, _>(
            Stokeslet,
            self.far.at_vertices(),
            self.threads,
            &self.sources,
            (8.0 * PI * self.viscosity).recip(),
            velocity,
            |vertex| geometry.position(vertex).to_array(),
            |vertex| {
                let at = geometry.position(vertex);
                let around = |&number: &u32| {
                    let panel = geometry.panel(number as usize);
                    let turned = panel.turned_to(vertex as u32);
                    let exact = turned.stokeslets_about_corner(turned.of(&self.tractions));
                    exact - DVec3::from(self.by_middles(Stokeslet, panel, at))
                };
                let ring = geometry.ring(vertex).iter();
                let own: DVec3 = ring.clone().map(around).sum();
                let close = |number| geometry.has_close_middle(number, at);
                let mut cancels = ring.copied().any(|number| close(number as usize));
                let (mut beside, mut exact, mut across) = (Vec::new(), Vec::new(), DVec3::ZERO);
                for (number, near) in geometry.near_vertex(vertex) {
                    let is_close = close(number);
                    cancels |= is_close;
                    match near {
                        Near::Beside if is_close || geometry.is_thin(number) => {
                            exact.push(exact_rule.of(self.seen_from(at, number)));
                        }
                        Near::Beside => beside.push(rule.of(self.seen_from(at, number))),
                        Near::Across => across += self.lacking(number, at),
                    }
                }
                let beside = DVec3::from(rule.corrections(Stokeslet, &beside));
                let exact = DVec3::from(exact_rule.corrections(Stokeslet, &exact));
                ((own + beside + exact + across).to_array(), cancels)
            },
        );
    }

    /// Adds the velocity at points of the fluid, on either side of the surfaces. For vertices use
    /// [`Self::add_at_vertices`], which integrates exactly where this method stops after eight
    /// halvings.
    ///
    /// # Panics
    /// If the numbers of points and velocities differ, or no forces have been set.
    pub fn add_at_points(&self, points: &[[f64; 3]], velocity: &mut [[f64; 3]]) {
        assert_eq!(velocity.len(), points.len(), "one velocity a point");
        self.assert_placed();
        let targets = self.far.points(points, self.threads);
        far::add::<f64, _, _, _, _, _, _>(
            Stokeslet,
            self.far.at(targets.as_ref()),
            self.threads,
            &self.sources,
            (8.0 * PI * self.viscosity).recip(),
            velocity,
            |point| points[point],
            |point| {
                let at = points[point].into();
                let near = self.geometry.near_point(at, 1);
                let lacking = near.map(|number| self.lacking(number, at));
                (lacking.sum::<DVec3>().to_array(), false)
            },
        );
    }

    /// Adds the pressure at points of the fluid, on either side of the surfaces.
    ///
    /// # Panics
    /// If the numbers of points and pressures differ, or no forces have been set.
    pub fn add_pressure_at_points(&self, points: &[[f64; 3]], pressure: &mut [f64]) {
        assert_eq!(pressure.len(), points.len(), "one pressure a point");
        self.assert_placed();
        sums::add(
            Gradient,
            self.threads,
            &self.sources,
            -(4.0 * PI).recip(),
            pressure.as_chunks_mut().0,
            |point| points[point],
            |point| {
                let at = points[point].into();
                let lacking = |number| {
                    let panel = self.geometry.panel(number);
                    let [near] = panel.gradients(at, panel.of(&self.tractions));
                    let [far] = self.by_middles(Gradient, panel, at);
                    near - far
                };
                [self.geometry.near_point(at, 2).map(lacking).sum()]
            },
        );
    }

    fn assert_placed(&self) {
        assert_eq!(
            self.sources.len(),
            self.geometry.edge_count(),
            "forces are set before velocities are asked for"
        );
    }

    /// Sets the sources.
    fn emit(&mut self) {
        self.sources.clear();
        let geometry = &self.geometry;
        for edge in 0..geometry.edge_count() {
            let [one, other] = geometry.normals(edge);
            let weight = (one.length() + other.length()) / 6.0;
            let force = weight * geometry.mean(edge, &self.tractions);
            self.sources.push(source(&[geometry.middle(edge), force]));
        }
        let reach = |edge| geometry.reach(edge);
        self.far.place(self.threads, geometry, &self.sources, reach);
    }

    /// The contribution of one triangle to the sum over all sources.
    fn by_middles<K: Kernel<f64, 3, 6, N>, const N: usize>(
        &self,
        kernel: K,
        panel: Panel<'_>,
        at: DVec3,
    ) -> [f64; N] {
        let mut sum = [0.0; N];
        for source in sources(panel, &self.tractions) {
            sum = kernel.add_one(at.to_array(), &source, sum);
        }
        sum
    }

    /// The correction of the velocity by a near triangle across a gap.
    fn lacking(&self, number: usize, at: DVec3) -> DVec3 {
        let panel = self.geometry.panel(number);
        let better = panel.stokeslets(at, panel.of(&self.tractions));
        DVec3::from(better) - DVec3::from(self.by_middles(Stokeslet, panel, at))
    }

    /// The corners of a triangle relative to a point, and the tractions there times the area.
    fn seen_from(&self, at: DVec3, number: usize) -> [[f64; 6]; 3] {
        let panel = self.geometry.panel(number);
        let (corners, tractions) = (panel.corners_from(at), panel.of(&self.tractions));
        let area = 0.5 * panel.doubled_area();
        [0, 1, 2].map(|k| source(&[corners[k], area * tractions[k]]))
    }
}

/// The contribution of a triangle to the midpoints of its edges.
fn sources(panel: Panel<'_>, tractions: &[DVec3]) -> [[f64; 6]; 3] {
    let weight = panel.doubled_area() / 6.0;
    panel
        .points(panel.of(tractions))
        .map(|(x, q)| source(&[x, weight * q]))
}
