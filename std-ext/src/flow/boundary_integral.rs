//! The single layer of Stokes flow on triangulated surfaces.
//!
//! C. Pozrikidis, Boundary Integral and Singularity Methods for Linearized Viscous Flow, Cambridge
//! University Press 1992, chapters 2 and 5.

mod panel;
mod stokeslets;

use glam::DVec3;
use helfrich::TriangleMesh;
use panel::Panel;
use std::f64::consts::PI;
use std::num::NonZeroUsize;
use std::ops::Range;
use stokeslets::{LANES, Source};

/// The velocity that forces on closed or open membranes give to unbounded fluid of viscosity μ,
///
/// `u(x₀) = 1/(8πμ) ∫ G(x − x₀)·q dS`, `G(r) = I/r + r r/r³`, r = |r|,
///
/// q the force per area that the membranes exert on the fluid: linear on flat triangles, and at
/// vertices `q_i = F_i/A_i`, F_i the nodal force and A_i a third of the triangles around.
///
/// Positions, forces and velocities are those of all surfaces, one after the other.
///
/// # Quadrature
/// Three interior points on every triangle, of degree 2, but:
/// * triangles around the vertex x₀ are integrated exactly, in polar coordinates about it;
/// * triangles of *other* surfaces, and all of them for points of the fluid, whose centre is nearer
///   to x₀ than twice their longest edge, are halved in all edges until the parts are farther off
///   than that by their own measure, at most eight times, and take seven points a part, of degree 5.
///
/// The error is of second order in the edge length h whatever the distance of surfaces. Parts of one
/// surface that come nearer to each other than h are not treated apart.
///
/// # Reproducibility
/// Each point sums its sources in one order: results do not depend on the number of threads. They
/// do depend, in the last bits, on whether the processor fuses multiplications and additions.
///
/// # Cost
/// Three sources a triangle for each point, and no memory that grows with their product; nothing is
/// allocated after the first evaluation but what threads need.
#[derive(Clone, Debug)]
pub struct SingleLayer {
    /// Viscosity μ of the fluid, pressure times time.
    pub viscosity: f64,
    /// Number of threads.
    pub threads: NonZeroUsize,
    surfaces: Vec<Part>,
    triangles: Vec<[u32; 3]>,
    /// `ring_triangles[ring_offsets[i]..ring_offsets[i + 1]]` are the triangles around vertex i.
    ring_offsets: Vec<u32>,
    ring_triangles: Vec<u32>,
    state: State,
}

/// Where a surface's vertices and triangles are among those of all.
#[derive(Clone, Debug)]
struct Part {
    vertices: Range<usize>,
    triangles: Range<usize>,
}

/// What follows from positions and forces.
#[derive(Clone, Debug, Default)]
struct State {
    positions: Vec<DVec3>,
    tractions: Vec<DVec3>,
    sources: Vec<Source>,
    centres: Vec<Centre>,
    /// The box of each surface, widened by the reach of its triangles.
    boxes: Vec<[DVec3; 2]>,
}

/// Where a triangle is, and the square of the distance within which it is near.
#[derive(Clone, Copy, Debug)]
struct Centre {
    position: DVec3,
    squared_reach: f64,
}

impl SingleLayer {
    /// The single layer on these surfaces, without forces as yet.
    ///
    /// # Panics
    /// If there are 2³² vertices or more.
    pub fn new<'a>(
        meshes: impl IntoIterator<Item = &'a TriangleMesh>,
        viscosity: f64,
        threads: NonZeroUsize,
    ) -> Self {
        let mut surfaces = Vec::new();
        let mut triangles = Vec::new();
        let mut count = 0;
        for mesh in meshes {
            let (first, first_triangle) = (count, triangles.len());
            count += mesh.vertex_count();
            assert!(
                u32::try_from(count).is_ok(),
                "{count} vertices are too many"
            );
            let moved = |triangle: &[u32; 3]| triangle.map(|vertex| vertex + first as u32);
            triangles.extend(mesh.triangles().iter().map(moved));
            surfaces.push(Part {
                vertices: first..count,
                triangles: first_triangle..triangles.len(),
            });
        }
        let mut ring_offsets = vec![0; count + 1];
        for &vertex in triangles.iter().flatten() {
            ring_offsets[vertex as usize + 1] += 1;
        }
        for vertex in 0..count {
            ring_offsets[vertex + 1] += ring_offsets[vertex];
        }
        let mut next = ring_offsets.clone();
        let mut ring_triangles = vec![0; 3 * triangles.len()];
        for (number, triangle) in triangles.iter().enumerate() {
            for &vertex in triangle {
                let slot = &mut next[vertex as usize];
                ring_triangles[*slot as usize] = number as u32;
                *slot += 1;
            }
        }
        Self {
            viscosity,
            threads,
            surfaces,
            triangles,
            ring_offsets,
            ring_triangles,
            state: State::default(),
        }
    }

    /// Number of vertices of all surfaces.
    pub fn vertex_count(&self) -> usize {
        self.ring_offsets.len() - 1
    }

    /// Puts the vertices at `positions`, with nodal forces F_i of the membranes on the fluid.
    ///
    /// # Panics
    /// If there is not one position and one force a vertex.
    pub fn set_forces(&mut self, positions: &[[f64; 3]], forces: &[[f64; 3]]) {
        assert_eq!(forces.len(), self.vertex_count(), "one force a vertex");
        self.place(positions);
        let Self {
            triangles,
            ring_offsets,
            ring_triangles,
            state,
            ..
        } = self;
        state.tractions.clear();
        for (vertex, &force) in forces.iter().enumerate() {
            let ring = ring_offsets[vertex] as usize..ring_offsets[vertex + 1] as usize;
            let area = |&number: &u32| {
                Panel::new(triangles[number as usize], &state.positions).doubled_area()
            };
            let area = ring_triangles[ring].iter().map(area).sum::<f64>() / 6.0;
            let over = if area.is_normal() { area.recip() } else { 0.0 };
            state.tractions.push(over * DVec3::from(force));
        }
        self.emit();
    }

    /// Puts the vertices at `positions`, with forces per area q_i of the membranes on the fluid.
    ///
    /// # Panics
    /// If there is not one position and one force per area a vertex.
    pub fn set_tractions(&mut self, positions: &[[f64; 3]], tractions: &[[f64; 3]]) {
        assert_eq!(
            tractions.len(),
            self.vertex_count(),
            "one traction a vertex"
        );
        self.place(positions);
        let rows = tractions.iter().copied().map(DVec3::from);
        self.state.tractions.clear();
        self.state.tractions.extend(rows);
        self.emit();
    }

    /// Adds the velocity at every vertex.
    ///
    /// # Panics
    /// If there is not one velocity a vertex, or no forces have been set.
    pub fn add_at_vertices(&self, velocity: &mut [[f64; 3]]) {
        assert_eq!(velocity.len(), self.vertex_count(), "one velocity a vertex");
        let state = &self.state;
        self.add(
            velocity,
            |vertex| state.positions[vertex],
            |vertex, at| {
                let ring =
                    self.ring_offsets[vertex] as usize..self.ring_offsets[vertex + 1] as usize;
                let around = |&number: &u32| {
                    let number = number as usize;
                    let panel = self.panel(number).turned_to(vertex as u32);
                    panel.integral_about_corner(&state.tractions) - self.by_three_points(number, at)
                };
                let own: DVec3 = self.ring_triangles[ring].iter().map(around).sum();
                let others = |part: &Part| !part.vertices.contains(&vertex);
                own + self.near(at, others)
            },
        );
    }

    /// Adds the velocity at points of the fluid, on either side of the surfaces. At a vertex
    /// [`Self::add_at_vertices`] is exact where this ends after eight halvings.
    ///
    /// # Panics
    /// If the numbers of points and velocities differ, or no forces have been set.
    pub fn add_at_points(&self, points: &[[f64; 3]], velocity: &mut [[f64; 3]]) {
        assert_eq!(velocity.len(), points.len(), "one velocity a point");
        let place = |point: usize| DVec3::from(points[point]);
        self.add(velocity, place, |_, at| self.near(at, |_| true));
    }

    /// Sets positions and what follows from them alone.
    fn place(&mut self, positions: &[[f64; 3]]) {
        assert_eq!(
            positions.len(),
            self.vertex_count(),
            "one position a vertex"
        );
        let state = &mut self.state;
        state.positions.clear();
        let points = positions.iter().copied().map(DVec3::from);
        state.positions.extend(points);
        state.centres.clear();
        for &triangle in &self.triangles {
            let panel = Panel::new(triangle, &state.positions);
            state.centres.push(Centre {
                position: panel.centre(),
                squared_reach: panel.squared_reach(),
            });
        }
        state.boxes.clear();
        for part in &self.surfaces {
            let centres = &state.centres[part.triangles.clone()];
            let first = centres
                .first()
                .map_or(DVec3::ZERO, |centre| centre.position);
            let widened = centres.iter().fold([first; 2], |[low, high], centre| {
                let reach = DVec3::splat(centre.squared_reach.sqrt());
                let [below, above] = [centre.position - reach, centre.position + reach];
                [low.min(below), high.max(above)]
            });
            state.boxes.push(widened);
        }
    }

    /// Sets the sources.
    fn emit(&mut self) {
        let state = &mut self.state;
        state.sources.clear();
        for &triangle in &self.triangles {
            let panel = Panel::new(triangle, &state.positions);
            state.sources.extend(panel.sources(&state.tractions));
        }
    }

    fn panel(&self, number: usize) -> Panel<'_> {
        Panel::new(self.triangles[number], &self.state.positions)
    }

    /// What the sum over all sources has of one triangle.
    fn by_three_points(&self, number: usize, at: DVec3) -> DVec3 {
        let sources = &self.state.sources[3 * number..3 * number + 3];
        sources
            .iter()
            .map(|&source| stokeslets::one(at, source))
            .sum()
    }

    /// What the near triangles of some surfaces lack.
    fn near(&self, at: DVec3, of: impl Fn(&Part) -> bool) -> DVec3 {
        let state = &self.state;
        let mut sum = DVec3::ZERO;
        for (part, &[low, high]) in self.surfaces.iter().zip(&state.boxes) {
            if !of(part) || at.cmplt(low).any() || at.cmpgt(high).any() {
                continue;
            }
            for number in part.triangles.clone() {
                let centre = state.centres[number];
                if at.distance_squared(centre.position) < centre.squared_reach {
                    sum += self.panel(number).integral_near(at, &state.tractions)
                        - self.by_three_points(number, at);
                }
            }
        }
        sum
    }

    /// Adds to each entry the sum over all sources at `place(entry)`, and `correction(entry, place)`.
    fn add(
        &self,
        velocity: &mut [[f64; 3]],
        place: impl Fn(usize) -> DVec3 + Sync,
        correction: impl Fn(usize, DVec3) -> DVec3 + Sync,
    ) {
        let state = &self.state;
        assert_eq!(
            state.sources.len(),
            3 * self.triangles.len(),
            "forces are set before velocities are asked for"
        );
        let factor = (8.0 * PI * self.viscosity).recip();
        let run = |first: usize, velocity: &mut [[f64; 3]]| {
            let places = Vec::from_iter((first..first + velocity.len()).map(&place));
            let sums = stokeslets::sums(&places, &state.sources);
            for (k, ((entry, &at), far)) in velocity.iter_mut().zip(&places).zip(sums).enumerate() {
                let sum = far + correction(first + k, at);
                *entry = (DVec3::from(*entry) + factor * sum).to_array();
            }
        };
        let share = velocity.len().div_ceil(self.threads.get());
        let share = share.next_multiple_of(LANES).max(LANES);
        std::thread::scope(|scope| {
            let mut shares = velocity.chunks_mut(share).enumerate();
            let own = shares.next();
            for (number, velocity) in shares {
                let run = &run;
                scope.spawn(move || run(number * share, velocity));
            }
            if let Some((_, velocity)) = own {
                run(0, velocity);
            }
        });
    }
}
