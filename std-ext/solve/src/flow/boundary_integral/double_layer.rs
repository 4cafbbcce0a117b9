//! The double layer on surfaces between fluids of different viscosities.

use super::beside::Rule;
use super::far::{self, Far};
use super::geometry::{Geometry, Near};
use super::kernel::{Kernel, SolidAngle, Stresslet, StressletPressure, Units, source};
use super::panel::Panel;
use super::sums;
use crate::flow::{Gmres, Solved};
use glam::DVec3;
use helfrich::TriangleMesh;
use std::f64::consts::PI;
use std::num::NonZeroUsize;
use std::ops::Range;

/// `−6/(8π)`, the factors of T and of the integral.
const FACTOR: f64 = -0.75 / PI;

/// The error of interpolated stresslets over that of their sums, as for the single layer; measured
/// ratios are 3 for needles, and otherwise from 8 to 100.
const INTERPOLATION: f64 = 4.0;

/// The contribution of fluids with different viscosities inside closed surfaces to the velocity.
///
/// λ_j is the viscosity inside surface j, and Λ_j that of the fluid around it, both relative to the
/// fluid outside of all surfaces; Λ_j is 1 unless surface j lies inside another one. The velocity
/// on the surfaces obeys
///
/// `u(x₀) = b(x₀) + Σ_j (Λ_j − λ_j)/(8π) ∫_j [u(x) − u(x₀)]·T(x − x₀)·n dS`, `T(r) = −6 r r r/r⁵`,
///
/// where n points outward and b is the ambient flow plus the [single layer](super::SingleLayer) of the
/// outer viscosity. [`Self::solve`] solves this linear equation. At other points of the fluid
///
/// `λ u(x₀) = b(x₀) + Σ_j (Λ_j − λ_j)/(8π) ∫_j u(x)·T(x − x₀)·n dS`,
///
/// with λ the ratio of the viscosity there to that of the outer fluid, [`Self::viscosity_ratios`].
/// The pressure is that of b plus `μ Σ_j (Λ_j − λ_j)/(2π) ∫_j u·∇∇(1/r)·n dS` on both sides, with μ
/// the outer viscosity.
///
/// Surfaces are outside each other or, with [`Self::set_surroundings`], nested. Positions and velocities
/// are those of all surfaces, one after the other; surfaces with λ = Λ take no time.
///
/// # Nested surfaces
/// The sum of the reciprocal theorems in the fluids of each viscosity has the stresses of both
/// sides of a surface in the single layer and the difference of viscosities in the double layer. On
/// surface i, (Λ_i + λ_i)/2 takes the place of λ, and the integrals are principal values. `∫_j T·n
/// dS` is 0 outside j, −4π on it and −8π inside. The terms subtracted with u(x₀) are therefore
/// `u(x₀) (Λ_i − λ_i)/2` for surface i and, by a telescoping sum, `u(x₀) Σ (Λ_j − λ_j) = u(x₀) (1 −
/// Λ_i)` for the surfaces around it. In total the factor of u(x₀) is 1 on every surface, nested or
/// not.
///
/// # Quadrature
/// Triangles are flat, u is linear on them, and quadrature points are those of the single layer.
/// For triangles that the single layer subdivides, the value of u at the nearest point is
/// integrated exactly, and the rest in parts. Triangles around x₀ lie in planes through it and
/// contribute nothing. The error is of second order in the edge length for any distance between
/// surfaces; the error of the pressure is as for the single layer.
///
/// Results do not depend on the number of threads.
#[derive(Clone, Debug)]
pub struct DoubleLayer {
    /// Number of threads.
    pub threads: NonZeroUsize,
    viscosity_ratios: Vec<f64>,
    /// Λ − λ of each surface.
    drops: Vec<f64>,
    /// The surfaces, each after the one that contains it.
    order: Vec<usize>,
    /// Whether each surface is closed.
    closed: Vec<bool>,
    geometry: Geometry,
    velocities: Vec<DVec3>,
    /// For each edge its middle, a third of the triangles' normals times area and Λ − λ, and the
    /// velocity.
    sources: Vec<[f64; 9]>,
    far: Far,
    /// The near triangles of each vertex on surfaces where viscosities differ, for all products of a
    /// solution.
    near: Vec<Vec<(usize, Near)>>,
}

impl DoubleLayer {
    /// The double layer on these surfaces, which are outside each other, before velocities are set.
    /// Viscosity ratios must be positive and finite.
    ///
    /// # Panics
    /// If there is not one viscosity ratio per surface, or 2³² vertices or more.
    pub fn new<'a>(
        meshes: impl IntoIterator<Item = &'a TriangleMesh>,
        viscosity_ratios: &[f64],
        threads: NonZeroUsize,
    ) -> Self {
        let mut closed = Vec::new();
        let geometry = Geometry::new(meshes.into_iter().inspect(|mesh| {
            closed.push(mesh.is_closed());
        }));
        assert_eq!(
            viscosity_ratios.len(),
            geometry.surfaces.len(),
            "one viscosity ratio a surface"
        );
        Self {
            threads,
            viscosity_ratios: viscosity_ratios.to_vec(),
            drops: viscosity_ratios.iter().map(|ratio| 1.0 - ratio).collect(),
            order: (0..closed.len()).collect(),
            closed,
            geometry,
            velocities: Vec::new(),
            sources: Vec::new(),
            far: Far::default(),
            near: Vec::new(),
        }
    }

    /// Sums velocities over clusters of vertices and edges instead of all pairs, with this tolerance; 0
    /// for all pairs. Set positions afterwards.
    ///
    /// The root mean square of errors is the tolerance times that of the velocities u, and times the
    /// largest `|Λ_j − λ_j|`: at most twice that for needles, a hundredth to a half for rounder bodies.
    /// Errors of single vertices are at most ten times as large. Tolerances above 1e-3 save no time
    /// and count as 1e-3.
    pub fn set_cluster_tolerance(&mut self, tolerance: f64) {
        self.far = Far::new(INTERPOLATION, tolerance, false);
        self.velocities.clear();
    }

    /// Sets, for each surface, the innermost surface that contains all of it, whose fluid surrounds it.
    /// Open surfaces have the surrounding fluid on both sides. Set positions afterwards.
    ///
    /// # Panics
    /// If there is not one entry per surface, or if surfaces contain each other in a cycle.
    pub fn set_surroundings(&mut self, surroundings: &[Option<usize>]) {
        let count = self.viscosity_ratios.len();
        assert_eq!(surroundings.len(), count, "one entry a surface");
        let depth = |surface: usize| {
            let chain =
                std::iter::successors(surroundings[surface], |&around| surroundings[around]);
            let depth = chain.take(count + 1).count();
            assert!(depth < count, "surface {surface} lies in itself");
            depth
        };
        self.order.sort_by_key(|&surface| depth(surface));
        for (surface, around) in surroundings.iter().enumerate() {
            let outside = around.map_or(1.0, |around| self.viscosity_ratios[around]);
            self.drops[surface] = match self.closed[surface] {
                true => outside - self.viscosity_ratios[surface],
                false => 0.0,
            };
        }
        self.velocities.clear();
    }

    /// Number of vertices of all surfaces.
    pub fn vertex_count(&self) -> usize {
        self.geometry.vertex_count()
    }

    /// Sets positions; all velocities are zero then.
    ///
    /// # Panics
    /// If there is not one position per vertex.
    pub fn set_positions(&mut self, positions: &[[f64; 3]]) {
        self.geometry.place(positions);
        self.velocities.clear();
        self.velocities.resize(positions.len(), DVec3::ZERO);
        self.sources.clear();
        let mut reaches = Vec::new();
        for (edge, drop) in edges(&self.geometry, &self.drops) {
            let [one, other] = self.geometry.normals(edge);
            let normal = drop / 6.0 * (one + other);
            let middle = self.geometry.middle(edge);
            self.sources.push(source(&[middle, normal, DVec3::ZERO]));
            reaches.push(self.geometry.reach(edge));
        }
        let reach = |source: usize| reaches[source];
        self.far
            .place(self.threads, &self.geometry, &self.sources, reach);
        self.near.resize(positions.len(), Vec::new());
        let (geometry, drops) = (&self.geometry, &self.drops);
        let differ = |&(number, _): &(usize, Near)| drops[geometry.surface(number)] != 0.0;
        sums::distribute(self.threads, &mut self.near, |first, rows| {
            for (k, row) in rows.iter_mut().enumerate() {
                row.clear();
                row.extend(geometry.near_vertex(first + k).filter(differ));
            }
        });
    }

    /// Sets the velocity u at every vertex.
    ///
    /// # Panics
    /// If there is not one velocity per vertex, or no positions have been set.
    pub fn set_velocities(&mut self, velocity: &[[f64; 3]]) {
        self.assert_placed();
        assert_eq!(
            velocity.len(),
            self.vertex_count(),
            "one velocity per vertex"
        );
        let rows = velocity.iter().copied().map(DVec3::from);
        self.velocities.clear();
        self.velocities.extend(rows);
        let edges = edges(&self.geometry, &self.drops);
        for ((edge, _), source) in edges.zip(&mut self.sources) {
            let velocity = self.geometry.mean(edge, &self.velocities);
            source[6..].copy_from_slice(&velocity.to_array());
        }
    }

    /// Adds `Σ_j (Λ_j − λ_j)/(8π) ∫_j [u(x) − u(x₀)]·T(x − x₀)·n dS` at every vertex x₀.
    ///
    /// # Panics
    /// If there is not one velocity per vertex, or no positions have been set.
    pub fn add_at_vertices(&self, sum: &mut [[f64; 3]]) {
        self.assert_placed();
        assert_eq!(sum.len(), self.vertex_count(), "one velocity per vertex");
        let geometry = &self.geometry;
        let target = |vertex: usize| source(&[geometry.position(vertex), self.velocities[vertex]]);
        let rule = Rule::<f64>::new(Units::NONE);
        far::add::<f64, _, _, _, _, _, _>(
            Stresslet,
            self.far.at_vertices(),
            self.threads,
            &self.sources,
            FACTOR,
            sum,
            target,
            |vertex| {
                let at = geometry.position(vertex);
                let velocity = self.velocities[vertex];
                let (mut beside, mut across) = (Vec::new(), DVec3::ZERO);
                for &(number, near) in &self.near[vertex] {
                    let drop = self.drop(number);
                    match near {
                        Near::Beside => {
                            beside.push(rule.of(self.seen_from(at, velocity, number, drop)));
                        }
                        Near::Across => across += self.lacking(number, drop, at, velocity),
                    }
                }
                let beside = DVec3::from(rule.corrections(Stresslet, &beside));
                ((beside + across).to_array(), false)
            },
        );
    }

    /// Adds `Σ_j (Λ_j − λ_j)/(8π) ∫_j u(x)·T(x − x₀)·n dS` at points of the fluid x₀, on either side of
    /// the surfaces. The velocity there is the sum of everything over [`Self::viscosity_ratios`].
    ///
    /// # Panics
    /// If the numbers of points and velocities differ, or no positions have been set.
    pub fn add_at_points(&self, points: &[[f64; 3]], sum: &mut [[f64; 3]]) {
        self.assert_placed();
        assert_eq!(sum.len(), points.len(), "one velocity a point");
        let target = |point: usize| source(&[points[point].into(), DVec3::ZERO]);
        let targets = self.far.points(points, self.threads);
        far::add::<f64, _, _, _, _, _, _>(
            Stresslet,
            self.far.at(targets.as_ref()),
            self.threads,
            &self.sources,
            FACTOR,
            sum,
            target,
            |point| {
                let at = points[point].into();
                let near = self.geometry.near_point(at, 1);
                let near = near.map(|number| (number, self.drop(number)));
                let near = near.filter(|&(_, drop)| drop != 0.0);
                let lacking = |(number, drop)| self.lacking(number, drop, at, DVec3::ZERO);
                let lacking = near.map(lacking);
                (lacking.sum::<DVec3>().to_array(), false)
            },
        );
    }

    /// Adds the pressure at points of the fluid, on either side of the surfaces, for an outer fluid
    /// of viscosity μ. The result is not divided by a viscosity ratio.
    ///
    /// # Panics
    /// If the numbers of points and pressures differ, or no positions have been set.
    pub fn add_pressure_at_points(
        &self,
        viscosity: f64,
        points: &[[f64; 3]],
        pressure: &mut [f64],
    ) {
        self.assert_placed();
        assert_eq!(pressure.len(), points.len(), "one pressure a point");
        sums::add(
            StressletPressure,
            self.threads,
            &self.sources,
            viscosity / (2.0 * PI),
            pressure.as_chunks_mut().0,
            |point| points[point],
            |point| {
                let at = points[point].into();
                let lacking = |number| {
                    let panel = self.geometry.panel(number);
                    let drop = self.drop(number);
                    let values = panel.of(&self.velocities);
                    let [near] = panel.stresslet_pressures(at, values);
                    let sources = sources(panel, drop, values);
                    let [far] = by_middles(StressletPressure, points[point], &sources);
                    drop * near - far
                };
                [self.geometry.near_point(at, 2).map(lacking).sum()]
            },
        );
    }

    /// Sets each entry to the ratio of the viscosity at a point of the fluid to that of the outer
    /// fluid: λ_j of the innermost surface j that contains the point, and 1 outside of all
    /// surfaces. The solid angle of the surface decides whether a point is inside, which is correct
    /// to rounding at any distance.
    ///
    /// # Panics
    /// If the numbers of points and ratios differ, or no positions have been set.
    pub fn viscosity_ratios(&self, points: &[[f64; 3]], ratios: &mut [f64]) {
        self.assert_placed();
        assert_eq!(ratios.len(), points.len(), "one ratio a point");
        ratios.fill(1.0);
        let mut turns = vec![[0.0]; points.len()];
        for &surface in &self.order {
            let drop = self.drops[surface];
            if drop == 0.0 {
                continue;
            }
            let triangles = &self.geometry.surfaces[surface].triangles;
            turns.fill([0.0]);
            sums::add(
                SolidAngle,
                self.threads,
                self.sources_of(surface),
                (4.0 * PI * drop).recip(),
                &mut turns,
                |point| points[point],
                |point| self.lacking_angle(triangles, points[point].into()),
            );
            for (entry, [turns]) in ratios.iter_mut().zip(&turns) {
                if *turns > 0.5 {
                    *entry = self.viscosity_ratios[surface];
                }
            }
        }
    }

    /// The sources on a surface where viscosities differ.
    fn sources_of(&self, surface: usize) -> &[[f64; 9]] {
        let parts = self.geometry.surfaces.iter().zip(&self.drops);
        let before = parts.take(surface).filter(|&(_, &drop)| drop != 0.0);
        let first = before.map(|(part, _)| part.edges.len()).sum::<usize>();
        &self.sources[first..][..self.geometry.surfaces[surface].edges.len()]
    }

    /// Solves `u = b + Σ_j (Λ_j − λ_j)/(8π) ∫_j [u − u(x₀)]·T·n dS` on the surfaces: `right` is b;
    /// `velocity` is the initial guess, and then u. Afterwards the velocities of the layer are u,
    /// converged or not.
    ///
    /// # Panics
    /// If there is not one entry of `right` and `velocity` per vertex, or no positions have been set.
    pub fn solve(
        &mut self,
        gmres: &mut Gmres,
        right: &[[f64; 3]],
        velocity: &mut [[f64; 3]],
    ) -> Solved {
        let mut apply = |velocity: &[[f64; 3]], product: &mut [[f64; 3]]| {
            self.set_velocities(velocity);
            product.fill([0.0; 3]);
            self.add_at_vertices(product);
            let rows = product.as_flattened_mut().iter_mut();
            for (product, velocity) in rows.zip(velocity.as_flattened()) {
                *product = velocity - *product;
            }
        };
        let solved = gmres.solve(&mut apply, right, velocity);
        self.set_velocities(velocity);
        solved
    }

    fn assert_placed(&self) {
        assert_eq!(
            self.velocities.len(),
            self.vertex_count(),
            "positions are set before velocities"
        );
    }

    /// Λ − λ of the surface of a triangle.
    fn drop(&self, number: usize) -> f64 {
        self.drops[self.geometry.surface(number)]
    }

    /// The correction by a near triangle across a gap, at a point with this velocity.
    fn lacking(&self, number: usize, drop: f64, at: DVec3, velocity: DVec3) -> DVec3 {
        let panel = self.geometry.panel(number);
        let values = panel.of(&self.velocities);
        let better = panel.stresslets(at, values.map(|value| value - velocity));
        let target = source(&[at, velocity]);
        let far = by_middles(Stresslet, target, &sources(panel, drop, values));
        drop * DVec3::from(better) - DVec3::from(far)
    }

    /// The corners of a triangle relative to a point with this velocity, the normal times Λ − λ and the
    /// area, and the relative velocities.
    fn seen_from(&self, at: DVec3, velocity: DVec3, number: usize, drop: f64) -> [[f64; 9]; 3] {
        let panel = self.geometry.panel(number);
        let (corners, values) = (panel.corners_from(at), panel.of(&self.velocities));
        let normal = 0.5 * drop * panel.doubled_normal();
        [0, 1, 2].map(|k| source(&[corners[k], normal, values[k] - velocity]))
    }

    /// The correction by near triangles of a surface to its solid angle times Λ − λ.
    fn lacking_angle(&self, range: &Range<usize>, at: DVec3) -> [f64; 1] {
        let near = self.geometry.near_point(at, 1);
        let lacking = |number| {
            let panel = self.geometry.panel(number);
            let drop = self.drop(number);
            let sources = sources(panel, drop, [DVec3::ZERO; 3]);
            let [far] = by_middles(SolidAngle, at.to_array(), &sources);
            drop * panel.solid_angle(at) - far
        };
        [near
            .filter(|number| range.contains(number))
            .map(lacking)
            .sum()]
    }
}

/// The edges with sources, and Λ − λ of each.
fn edges(geometry: &Geometry, drops: &[f64]) -> impl Iterator<Item = (usize, f64)> {
    let surfaces = geometry.surfaces.iter().zip(drops);
    surfaces
        .filter(|&(_, &drop)| drop != 0.0)
        .flat_map(|(part, &drop)| part.edges.clone().map(move |edge| (edge, drop)))
}

/// The contribution of a triangle to the midpoints of its edges.
fn sources(panel: Panel<'_>, drop: f64, velocities: [DVec3; 3]) -> [[f64; 9]; 3] {
    let normal = drop / 6.0 * panel.doubled_normal();
    panel
        .points(velocities)
        .map(|(x, u)| source(&[x, normal, u]))
}

/// The contribution of one triangle to the sum over all sources.
fn by_middles<K: Kernel<f64, T, 9, N>, const T: usize, const N: usize>(
    kernel: K,
    target: [f64; T],
    sources: &[[f64; 9]; 3],
) -> [f64; N] {
    let mut sum = [0.0; N];
    for source in sources {
        sum = kernel.add_one(target, source, sum);
    }
    sum
}
