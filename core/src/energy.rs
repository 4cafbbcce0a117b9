//! What can be asked of a method: energy, nodal force, force density; and sums of methods.

use crate::element::{Execution, Serial};
use crate::mesh::TriangleMesh;
use crate::quality::Quality;
use crate::real::Real;
use crate::surface::Surface;

/// A method or effect in its three lifetimes: parameters in the value itself, what follows from
/// the connectivity in its plan, what follows from the positions in memory that the caller lends.
///
/// [`Prepared`] keeps the three together.
pub trait Method<T: Real> {
    /// What is worked out once for a mesh, and can be shared by surfaces with the same mesh.
    type Plan;
    /// Memory for one evaluation at a time. It grows at the first evaluation and is reused after;
    /// after an evaluation it holds what that evaluation found.
    type Memory: Default;

    /// Works out the plan for a mesh.
    fn plan(&self, mesh: &TriangleMesh) -> Self::Plan;

    /// Reports what made the last evaluation in `memory` less trustworthy than usual; nothing is
    /// counted unless this is called.
    fn inspect(
        &self,
        _plan: &Self::Plan,
        _surface: Surface<'_, T>,
        _memory: &Self::Memory,
        _report: &mut dyn FnMut(Finding),
    ) {
    }
}

/// Something that makes an evaluation less trustworthy than usual, and where.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Finding {
    /// The area that the method gives to this vertex is zero: the vertex was left out.
    ZeroArea {
        /// The vertex.
        vertex: u32,
    },
    /// The signed area that the method gives to this vertex is negative, and was used as it is.
    NegativeArea {
        /// The vertex.
        vertex: u32,
    },
    /// The neighbours of this vertex do not carry the fit that was asked for, but one of lower degree.
    ReducedDegree {
        /// The vertex.
        vertex: u32,
        /// The degree that was fitted.
        degree: u8,
    },
    /// The neighbours of this vertex carry no fit at all: it was left out.
    TooFewNeighbours {
        /// The vertex.
        vertex: u32,
    },
    /// The signed area that the method gives to this vertex is less than a thirty-second of the
    /// triangles around it: what is divided by it is amplified.
    SmallArea {
        /// The vertex.
        vertex: u32,
    },
    /// The signed area of this vertex is zero or negative, and was replaced by a mixed one.
    ClampedArea {
        /// The vertex.
        vertex: u32,
    },
    /// The neighbours of this vertex lie near a conic section through it and determine the fit
    /// badly: it amplifies what the neighbours deviate from a paraboloid.
    Amplified {
        /// The vertex.
        vertex: u32,
    },
    /// The longest edge at this vertex is more than eight times the shortest (for methods that reach
    /// farther, at a vertex within two edges, or a triangle there is thin): formulas that take the
    /// mesh to be even are off by powers of that.
    Uneven {
        /// The vertex.
        vertex: u32,
    },
    /// This vertex has fewer than four or more than nine neighbours: formulas that are exact for six
    /// have an error there that refinement does not reduce.
    UnusualValence {
        /// The vertex.
        vertex: u32,
    },
    /// A triangle at this vertex faces against the others around it: the surface folds back.
    Folded {
        /// The vertex.
        vertex: u32,
    },
    /// The position of this vertex is stored with so few digits for the distance of its neighbours
    /// that a fourth derivative is lost in rounding: its error is of the order of 1/R³, R the radius
    /// of the sphere with the same area. Keep positions near the origin or in pairs, see
    /// [`Surface::with_remainders`].
    RoundedPosition {
        /// The vertex.
        vertex: u32,
    },
    /// This triangle has no area and contributes nothing.
    DegenerateTriangle {
        /// The triangle.
        triangle: u32,
    },
    /// The height of this triangle is less than a thirty-second of its longest edge (a needle below
    /// 1.8°, a cap above 176.4°): what is divided by its area is amplified.
    ThinTriangle {
        /// The triangle.
        triangle: u32,
    },
}

/// An energy of a surface.
///
/// Laws: invariant under translation, rotation and relabelling of the surface, to rounding.
pub trait Energy<T: Real>: Method<T> {
    /// The energy E.
    fn energy(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
    ) -> T;
}

/// Nodal forces F_i: what the membrane exerts on its surroundings at vertex i, in units of force.
///
/// Laws: rotate with the surface, do not change under its translation, follow a relabelling.
pub trait Force<T: Real>: Method<T> {
    /// Adds the nodal forces to `force`, one entry a vertex.
    ///
    /// # Panics
    /// If `force` has fewer entries than the surface has vertices.
    fn add_force(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        force: &mut [[T; 3]],
    );
}

/// Force density f: force per area of membrane, as methods in strong form find it.
///
/// Integrated over the area that belongs to a vertex it is the nodal force.
pub trait ForceDensity<T: Real>: Method<T> {
    /// Sets `density`, one entry a vertex.
    ///
    /// # Panics
    /// If `density` has fewer entries than the surface has vertices.
    fn force_density(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        density: &mut [[T; 3]],
    );
}

/// A force that is the exact negative gradient of its own discrete energy.
///
/// Laws: F_i = −∂E/∂x_i, exact but for rounding; therefore ΣF = 0 and Σ x × F = 0, unless the energy is
/// one of something outside, as weight and loads are.
pub trait Conservative<T: Real>: Energy<T> + Force<T> {
    /// Adds the nodal forces to `force` and returns the energy, in one evaluation.
    ///
    /// # Panics
    /// If `force` has fewer entries than the surface has vertices.
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        force: &mut [[T; 3]],
    ) -> T {
        self.add_force(execution, plan, surface, memory, force);
        self.energy(execution, plan, surface, memory)
    }
}

/// A method with its plan and memory, ready to be evaluated again and again for surfaces with the
/// mesh it was prepared for. Nothing is allocated after the first evaluation.
#[derive(Clone, Debug)]
pub struct Prepared<T: Real, M: Method<T>, X = Serial> {
    method: M,
    plan: M::Plan,
    memory: M::Memory,
    execution: X,
}

impl<T: Real, M: Method<T>> Prepared<T, M> {
    /// Works out the plan of `method` for a mesh; evaluations are serial.
    pub fn new(method: M, mesh: &TriangleMesh) -> Self {
        Self::with_execution(method, mesh, Serial)
    }
}

impl<T: Real, M: Method<T>, X: Execution> Prepared<T, M, X> {
    /// Works out the plan of `method` for a mesh; evaluations run as `execution` does.
    pub fn with_execution(method: M, mesh: &TriangleMesh, execution: X) -> Self {
        let plan = method.plan(mesh);
        Self {
            method,
            plan,
            memory: M::Memory::default(),
            execution,
        }
    }

    /// The method.
    pub fn method(&self) -> &M {
        &self.method
    }

    /// The method, to change a parameter that its plan does not depend on.
    pub fn method_mut(&mut self) -> &mut M {
        &mut self.method
    }

    /// What the last evaluation left.
    pub fn memory(&self) -> &M::Memory {
        &self.memory
    }

    /// Gives every part to `evaluate`: for what a method offers beyond the common traits.
    pub fn with<R>(&mut self, evaluate: impl FnOnce(&M, &X, &M::Plan, &mut M::Memory) -> R) -> R {
        evaluate(&self.method, &self.execution, &self.plan, &mut self.memory)
    }

    /// See [`Energy::energy`].
    pub fn energy(&mut self, surface: Surface<'_, T>) -> T
    where
        M: Energy<T>,
    {
        self.method
            .energy(&self.execution, &self.plan, surface, &mut self.memory)
    }

    /// See [`Force::add_force`].
    ///
    /// # Panics
    /// If `force` has fewer entries than the surface has vertices.
    pub fn add_force(&mut self, surface: Surface<'_, T>, force: &mut [[T; 3]])
    where
        M: Force<T>,
    {
        self.method.add_force(
            &self.execution,
            &self.plan,
            surface,
            &mut self.memory,
            force,
        );
    }

    /// See [`Conservative::add_force_and_energy`].
    ///
    /// # Panics
    /// If `force` has fewer entries than the surface has vertices.
    pub fn add_force_and_energy(&mut self, surface: Surface<'_, T>, force: &mut [[T; 3]]) -> T
    where
        M: Conservative<T>,
    {
        let Self {
            method,
            plan,
            memory,
            execution,
        } = self;
        method.add_force_and_energy(execution, plan, surface, memory, force)
    }

    /// See [`ForceDensity::force_density`].
    ///
    /// # Panics
    /// If `density` has fewer entries than the surface has vertices.
    pub fn force_density(&mut self, surface: Surface<'_, T>, density: &mut [[T; 3]])
    where
        M: ForceDensity<T>,
    {
        self.method.force_density(
            &self.execution,
            &self.plan,
            surface,
            &mut self.memory,
            density,
        );
    }

    /// See [`Method::inspect`].
    pub fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        self.method
            .inspect(&self.plan, surface, &self.memory, report);
    }

    /// What [`Self::inspect`] reports, with a flag for each vertex that it concerns.
    pub fn quality(&self, surface: Surface<'_, T>) -> Quality {
        Quality::gather(surface.mesh(), |report| self.inspect(surface, report))
    }
}

/// The sum of two methods; longer sums nest: `(a, (b, c))`.
impl<T: Real, A: Method<T>, B: Method<T>> Method<T> for (A, B) {
    type Plan = (A::Plan, B::Plan);
    type Memory = (A::Memory, B::Memory);

    fn plan(&self, mesh: &TriangleMesh) -> Self::Plan {
        (self.0.plan(mesh), self.1.plan(mesh))
    }

    fn inspect(
        &self,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &Self::Memory,
        report: &mut dyn FnMut(Finding),
    ) {
        self.0.inspect(&plan.0, surface, &memory.0, report);
        self.1.inspect(&plan.1, surface, &memory.1, report);
    }
}

impl<T: Real, A: Energy<T>, B: Energy<T>> Energy<T> for (A, B) {
    fn energy(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
    ) -> T {
        self.0.energy(execution, &plan.0, surface, &mut memory.0)
            + self.1.energy(execution, &plan.1, surface, &mut memory.1)
    }
}

impl<T: Real, A: Force<T>, B: Force<T>> Force<T> for (A, B) {
    fn add_force(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        force: &mut [[T; 3]],
    ) {
        self.0
            .add_force(execution, &plan.0, surface, &mut memory.0, force);
        self.1
            .add_force(execution, &plan.1, surface, &mut memory.1, force);
    }
}

impl<T: Real, A: Conservative<T>, B: Conservative<T>> Conservative<T> for (A, B) {
    fn add_force_and_energy(
        &self,
        execution: &impl Execution,
        plan: &Self::Plan,
        surface: Surface<'_, T>,
        memory: &mut Self::Memory,
        force: &mut [[T; 3]],
    ) -> T {
        self.0
            .add_force_and_energy(execution, &plan.0, surface, &mut memory.0, force)
            + self
                .1
                .add_force_and_energy(execution, &plan.1, surface, &mut memory.1, force)
    }
}
