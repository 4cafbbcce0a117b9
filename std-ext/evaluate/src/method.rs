//! The closed set of bending methods, chosen at run time.
//!
//! The choice is made once a surface; from there on everything is resolved at compile time. Methods
//! run on all threads, and large meshes in an order of their own.

mod ordered;

use self::ordered::Ordered;
use crate::execute::Parallel;
use helfrich::bending::StrongFormMemory;
use helfrich::laplacian::CotangentMemory;
use helfrich::{
    Cotangent, Curvature, DualArea, Execution, Finding, GompperKroll, Jet, Juelicher, KantorNelson,
    LaplaceBeltrami, LoopSubdivision, Method, Prepared, Quality, Real, Serial, StrongForm, Surface,
    TriangleMesh, VertexKind,
};
use std::fmt;
use std::str::FromStr;

/// A bending method, by its name in the field and its letter in Guckenberger et al. 2016.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BendingMethod {
    /// A: dihedral angles.
    KantorNelson,
    /// B: squared cotangent Laplacian.
    GompperKroll,
    /// C: strong form over the cotangent operator.
    Meyer,
    /// D: strong form over a heat kernel.
    Belkin,
    /// E: strong form over paraboloids fitted to one-rings.
    Farutin,
    /// S: the limit surface of Loop subdivision.
    Loop,
    /// Jülicher's: squared mean curvature from dihedral angles.
    Juelicher,
    /// J of degree 4: strong form over osculating jets.
    J4,
    /// J of degree 6.
    J6,
    /// J of the degree that suits the mesh.
    Jet,
}

impl BendingMethod {
    /// Every method, with J in its two degrees.
    pub const ALL: [Self; 9] = [
        Self::KantorNelson,
        Self::GompperKroll,
        Self::Meyer,
        Self::Belkin,
        Self::Farutin,
        Self::Loop,
        Self::Juelicher,
        Self::J4,
        Self::J6,
    ];

    /// The long name, as on the command line, and the letter if the method has one.
    fn names(self) -> (&'static str, Option<&'static str>) {
        match self {
            Self::KantorNelson => ("kantor-nelson", Some("A")),
            Self::GompperKroll => ("gompper-kroll", Some("B")),
            Self::Meyer => ("meyer", Some("C")),
            Self::Belkin => ("belkin", Some("D")),
            Self::Farutin => ("farutin", Some("E")),
            Self::Loop => ("loop", Some("S")),
            Self::Juelicher => ("juelicher", None),
            Self::J4 => ("j4", None),
            Self::J6 => ("j6", None),
            Self::Jet => ("jet", Some("J")),
        }
    }

    /// The long name, as on the command line.
    pub fn name(self) -> &'static str {
        self.names().0
    }

    /// Whether its forces are the exact gradient of an energy.
    pub fn is_conservative(self) -> bool {
        matches!(
            self,
            Self::KantorNelson | Self::GompperKroll | Self::Loop | Self::Juelicher
        )
    }

    /// The paper's letter, or J for the jets; `None` for what has none.
    pub fn letter(self) -> Option<&'static str> {
        self.names().1
    }
}

impl fmt::Display for BendingMethod {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

/// A name that is no method's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "there is no bending method `{name}`: the methods are {}",
    known_methods()
)]
pub struct UnknownMethod {
    name: String,
}

fn known_methods() -> String {
    let known = |method: BendingMethod| match method.letter() {
        Some(letter) => format!("{method} ({letter})"),
        None => method.to_string(),
    };
    let all = BendingMethod::ALL.into_iter().chain([BendingMethod::Jet]);
    all.map(known).collect::<Vec<_>>().join(", ")
}

impl FromStr for BendingMethod {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, UnknownMethod> {
        let matches = |method: &Self| {
            let (long, letter) = method.names();
            long.eq_ignore_ascii_case(name) || letter.is_some_and(|l| l.eq_ignore_ascii_case(name))
        };
        Self::ALL
            .into_iter()
            .chain([Self::Jet])
            .find(matches)
            .ok_or_else(|| UnknownMethod {
                name: name.to_owned(),
            })
    }
}

/// All that a method says of a surface, a value a vertex; `None` where it says nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Fields<T> {
    /// Mixed area.
    pub area: Vec<T>,
    /// Outward unit normal; 0 where there is none.
    pub normal: Vec<[T; 3]>,
    /// Mean curvature H, positive on a sphere.
    pub mean: Vec<Option<T>>,
    /// Gaussian curvature K.
    pub gaussian: Vec<Option<T>>,
    /// Δ_S H.
    pub laplacian_of_mean: Vec<Option<T>>,
    /// Force density f; for methods with nodal forces, F over the mixed area.
    pub force_density: Vec<Option<[T; 3]>>,
}

/// A bending method made ready for one mesh.
#[derive(Debug)]
pub struct Evaluator<T: Real> {
    prepared: Box<dyn Evaluate<T>>,
    ordered: Option<Ordered<T>>,
    force: Vec<[T; 3]>,
}

impl<T: Real> Evaluator<T> {
    /// Prepares `method` with bending modulus `modulus` for a mesh, on all threads that there are.
    pub fn new(method: BendingMethod, modulus: T, mesh: &TriangleMesh) -> Self
    where
        T: Evaluated,
    {
        Self::on_threads(method, modulus, mesh, Parallel::new())
    }

    /// As [`Self::new`], on so many threads: no bit depends on their number.
    pub fn on_threads(
        method: BendingMethod,
        modulus: T,
        mesh: &TriangleMesh,
        threads: Parallel,
    ) -> Self
    where
        T: Evaluated,
    {
        T::evaluator(method, modulus, mesh, threads)
    }

    /// The same with loops of the caller's choice.
    fn with_execution<X>(
        method: BendingMethod,
        modulus: T,
        mesh: &TriangleMesh,
        execution: X,
    ) -> Self
    where
        X: Execution + Copy + fmt::Debug + 'static,
    {
        let ordered = Ordered::of(mesh);
        let vertices = mesh.vertex_count();
        let mesh = ordered.as_ref().map_or(mesh, Ordered::mesh);
        let prepared = match method {
            BendingMethod::KantorNelson => prepare(KantorNelson::new(modulus), mesh, execution),
            BendingMethod::GompperKroll => prepare(GompperKroll::new(modulus), mesh, execution),
            BendingMethod::Meyer => prepare(StrongForm::meyer(modulus), mesh, execution),
            BendingMethod::Belkin => prepare(StrongForm::belkin(modulus), mesh, execution),
            BendingMethod::Farutin => prepare(StrongForm::farutin(modulus), mesh, execution),
            BendingMethod::Loop => prepare(LoopSubdivision::new(modulus), mesh, execution),
            BendingMethod::Juelicher => prepare(Juelicher::new(modulus), mesh, execution),
            BendingMethod::J4 => prepare(StrongForm::j4(modulus), mesh, execution),
            BendingMethod::J6 => prepare(StrongForm::j6(modulus), mesh, execution),
            BendingMethod::Jet => prepare(
                StrongForm::new(modulus, Jet::for_mesh(mesh)),
                mesh,
                execution,
            ),
        };
        Self {
            prepared,
            ordered,
            force: vec![[T::zero(); 3]; vertices],
        }
    }

    /// One evaluation as a simulation makes it: nodal forces with the energy for conservative
    /// methods, force densities with the curvatures for those in strong form.
    pub fn evaluate(&mut self, surface: Surface<'_, T>) {
        match &mut self.ordered {
            None => {
                self.force.fill([T::zero(); 3]);
                self.prepared.evaluate(surface, &mut self.force);
            }
            Some(ordered) => {
                let (surface, force) = ordered.parts(surface);
                force.fill([T::zero(); 3]);
                self.prepared.evaluate(surface, force);
                ordered.put_back(&mut self.force);
            }
        }
    }

    /// What the last evaluation found: nodal forces, or force densities for methods in strong form.
    pub fn force(&self) -> &[[T; 3]] {
        &self.force
    }

    /// The energy of a surface.
    pub fn energy(&mut self, surface: Surface<'_, T>) -> T {
        match &mut self.ordered {
            None => self.prepared.energy(surface),
            Some(ordered) => self.prepared.energy(ordered.parts(surface).0),
        }
    }

    /// Evaluates, and collects all that the method says.
    pub fn fields(&mut self, surface: Surface<'_, T>) -> Fields<T> {
        self.evaluate(surface);
        self.last_fields(surface)
    }

    /// [`Self::fields`] of the last evaluation, which was of this surface: nothing is evaluated.
    pub fn last_fields(&mut self, surface: Surface<'_, T>) -> Fields<T> {
        match &mut self.ordered {
            None => Fields::collect(&mut *self.prepared, surface, &self.force),
            Some(ordered) => {
                let (surface, force) = ordered.parts(surface);
                let fields = Fields::collect(&mut *self.prepared, surface, force);
                ordered.undo(&fields)
            }
        }
    }

    /// What makes the last evaluation, which was of this surface, less trustworthy than usual, with a
    /// flag for each vertex.
    pub fn quality(&self, surface: Surface<'_, T>) -> Quality {
        Quality::gather(surface.mesh(), |report| self.inspect(surface, report))
    }

    /// What makes the last evaluation, which was of this surface, less trustworthy than usual.
    pub fn findings(&self, surface: Surface<'_, T>) -> Vec<Finding> {
        let mut findings = Vec::new();
        self.inspect(surface, &mut |finding| findings.push(finding));
        findings
    }

    fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        let Some(ordered) = &self.ordered else {
            return self.prepared.inspect(surface, report);
        };
        let (mut positions, mut remainders) = (Vec::new(), Vec::new());
        let order = ordered.order();
        let surface = order.of_surface(surface, ordered.mesh(), &mut positions, &mut remainders);
        self.prepared.inspect(surface, &mut |finding| {
            report(order.undo_finding(finding));
        });
    }
}

/// A number type that methods are evaluated in.
pub trait Evaluated: Real {
    /// See [`Evaluator::on_threads`]: on one alone, as any number type can be evaluated.
    fn evaluator(
        method: BendingMethod,
        modulus: Self,
        mesh: &TriangleMesh,
        _threads: Parallel,
    ) -> Evaluator<Self> {
        Evaluator::with_execution(method, modulus, mesh, Serial)
    }
}

// Functions without parameters of type: methods are compiled here, and not again in every crate that
// evaluates them.
impl Evaluated for f32 {
    fn evaluator(
        method: BendingMethod,
        modulus: f32,
        mesh: &TriangleMesh,
        threads: Parallel,
    ) -> Evaluator<f32> {
        Evaluator::with_execution(method, modulus, mesh, threads)
    }
}

impl Evaluated for f64 {
    fn evaluator(
        method: BendingMethod,
        modulus: f64,
        mesh: &TriangleMesh,
        threads: Parallel,
    ) -> Evaluator<f64> {
        Evaluator::with_execution(method, modulus, mesh, threads)
    }
}

impl Evaluator<f64> {
    /// Jets of the highest degree, 8: slow, and no method of scenes; what the others are compared with
    /// where nothing is known exactly.
    pub fn reference(modulus: f64, mesh: &TriangleMesh) -> Self {
        let jet = Jet {
            degree: 8,
            neighbours: 96,
            most_neighbours: 192,
            sharpness: 7.0,
            conditioning: 0.003,
        };
        let method = StrongForm::new(modulus, jet);
        Self {
            prepared: prepare(method, mesh, Parallel::new()),
            ordered: None,
            force: vec![[0.0; 3]; mesh.vertex_count()],
        }
    }
}

fn prepare<T: Real, M, X>(method: M, mesh: &TriangleMesh, execution: X) -> Box<dyn Evaluate<T>>
where
    M: Method<T>,
    X: Execution,
    Prepared<T, M, X>: Evaluate<T> + 'static,
{
    Box::new(Prepared::with_execution(method, mesh, execution))
}

/// What a prepared method can be asked for, whichever it is.
trait Evaluate<T: Real>: fmt::Debug {
    /// Adds nodal forces to `force`, or sets it to force densities: see [`Evaluator::evaluate`].
    fn evaluate(&mut self, surface: Surface<'_, T>, force: &mut [[T; 3]]);

    /// Sets what the method says in `fields`, from what [`Self::evaluate`] made of `force`.
    fn collect(&mut self, surface: Surface<'_, T>, force: &[[T; 3]], fields: &mut Fields<T>);

    /// See [`helfrich::Energy::energy`].
    fn energy(&mut self, surface: Surface<'_, T>) -> T;

    /// See [`Method::inspect`].
    fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding));
}

impl<T, X> Evaluate<T> for Prepared<T, KantorNelson<T>, X>
where
    T: Real,
    X: Execution + fmt::Debug,
{
    fn evaluate(&mut self, surface: Surface<'_, T>, force: &mut [[T; 3]]) {
        self.add_force_and_energy(surface, force);
    }

    fn collect(&mut self, _surface: Surface<'_, T>, force: &[[T; 3]], fields: &mut Fields<T>) {
        fields.set_density(force);
    }

    fn energy(&mut self, surface: Surface<'_, T>) -> T {
        self.energy(surface)
    }

    fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        self.inspect(surface, report);
    }
}

impl<T, X> Evaluate<T> for Prepared<T, GompperKroll<T>, X>
where
    T: Real,
    X: Execution + fmt::Debug,
{
    fn evaluate(&mut self, surface: Surface<'_, T>, force: &mut [[T; 3]]) {
        self.add_force_and_energy(surface, force);
    }

    fn collect(&mut self, surface: Surface<'_, T>, force: &[[T; 3]], fields: &mut Fields<T>) {
        fields.set_density(force);
        let mut mean = vec![T::zero(); force.len()];
        self.with(|method, execution, (), memory| {
            method.mean_curvature(execution, surface, memory, &fields.normal, &mut mean);
        });
        fields.set_mean(surface.mesh(), &mean);
    }

    fn energy(&mut self, surface: Surface<'_, T>) -> T {
        self.energy(surface)
    }

    fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        self.inspect(surface, report);
    }
}

impl<T, X> Evaluate<T> for Prepared<T, Juelicher<T>, X>
where
    T: Real,
    X: Execution + fmt::Debug,
{
    fn evaluate(&mut self, surface: Surface<'_, T>, force: &mut [[T; 3]]) {
        self.add_force_and_energy(surface, force);
    }

    fn collect(&mut self, surface: Surface<'_, T>, force: &[[T; 3]], fields: &mut Fields<T>) {
        fields.set_density(force);
        let mut mean = vec![T::zero(); force.len()];
        self.with(|method, execution, plan, memory| {
            method.mean_curvature(execution, plan, surface, memory, &mut mean);
        });
        fields.set_mean(surface.mesh(), &mean);
    }

    fn energy(&mut self, surface: Surface<'_, T>) -> T {
        self.energy(surface)
    }

    fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        self.inspect(surface, report);
    }
}

impl<T, X> Evaluate<T> for Prepared<T, LoopSubdivision<T>, X>
where
    T: Real,
    X: Execution + fmt::Debug,
{
    fn evaluate(&mut self, surface: Surface<'_, T>, force: &mut [[T; 3]]) {
        self.add_force_and_energy(surface, force);
    }

    fn collect(&mut self, surface: Surface<'_, T>, force: &[[T; 3]], fields: &mut Fields<T>) {
        fields.set_density(force);
        let mut curvature = vec![Curvature::default(); force.len()];
        self.with(|method, execution, plan, memory| {
            method.curvature(execution, plan, surface, memory, &mut curvature);
        });
        fields.set_curvature(&curvature);
    }

    fn energy(&mut self, surface: Surface<'_, T>) -> T {
        self.energy(surface)
    }

    fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        self.inspect(surface, report);
    }
}

impl<T, L, X> Evaluate<T> for Prepared<T, StrongForm<T, L>, X>
where
    T: Real,
    X: Execution + fmt::Debug,
    L: LaplaceBeltrami<T, Plan: fmt::Debug, Memory: fmt::Debug> + fmt::Debug + Sync,
{
    fn evaluate(&mut self, surface: Surface<'_, T>, force: &mut [[T; 3]]) {
        self.force_density(surface, force);
    }

    fn collect(&mut self, surface: Surface<'_, T>, force: &[[T; 3]], fields: &mut Fields<T>) {
        fields.set_strong_form(surface.mesh(), self.memory(), force);
    }

    fn energy(&mut self, surface: Surface<'_, T>) -> T {
        self.energy(surface)
    }

    fn inspect(&self, surface: Surface<'_, T>, report: &mut dyn FnMut(Finding)) {
        self.inspect(surface, report);
    }
}

fn where_defined<V: Copy>(values: &[V], defined: impl Fn(usize) -> bool) -> Vec<Option<V>> {
    values
        .iter()
        .enumerate()
        .map(|(vertex, &value)| defined(vertex).then_some(value))
        .collect()
}

impl<T: Real> Fields<T> {
    /// All that a method says of the surface that it has been evaluated on, with this force.
    fn collect(prepared: &mut dyn Evaluate<T>, surface: Surface<'_, T>, force: &[[T; 3]]) -> Self {
        let vertices = surface.mesh().vertex_count();
        let mut curvature = vec![Curvature::default(); vertices];
        let mut memory = CotangentMemory::default();
        let cotangent = Cotangent::new(DualArea::Mixed);
        let plan = Method::<T>::plan(&cotangent, surface.mesh());
        cotangent.measure(&Serial, &plan, surface, &mut memory, &mut curvature);
        let mut fields = Fields {
            area: curvature.iter().map(|vertex| vertex.area).collect(),
            normal: curvature.iter().map(|vertex| vertex.normal).collect(),
            mean: vec![None; vertices],
            gaussian: vec![None; vertices],
            laplacian_of_mean: vec![None; vertices],
            force_density: vec![None; vertices],
        };
        prepared.collect(surface, force, &mut fields);
        // A vertex that was left out: the method's 0 there is no curvature.
        prepared.inspect(surface, &mut |finding| match finding {
            Finding::ZeroArea { vertex } | Finding::TooFewNeighbours { vertex } => {
                fields.clear(vertex as usize);
            }
            _ => {}
        });
        fields
    }

    /// Nothing is said of a vertex, but for a nodal force over a mixed area that is not 0.
    fn clear(&mut self, vertex: usize) {
        self.mean[vertex] = None;
        self.gaussian[vertex] = None;
        self.laplacian_of_mean[vertex] = None;
        if self.area[vertex] <= T::zero() {
            self.force_density[vertex] = None;
        }
    }

    fn set_density(&mut self, force: &[[T; 3]]) {
        let over = |force: [T; 3], area: T| {
            let density = force.map(|component| component / area);
            let defined = area > T::zero() && density.iter().all(|component| component.is_finite());
            defined.then_some(density)
        };
        self.force_density = force
            .iter()
            .zip(&self.area)
            .map(|(&force, &area)| over(force, area))
            .collect();
    }

    fn set_mean(&mut self, mesh: &TriangleMesh, mean: &[T]) {
        let interior = |vertex| mesh.vertex_kind(vertex) == VertexKind::Interior;
        self.mean = where_defined(mean, interior);
    }

    fn set_curvature(&mut self, curvature: &[Curvature<T>]) {
        let interior = |vertex: usize| curvature[vertex].kind == VertexKind::Interior;
        let mean: Vec<T> = curvature.iter().map(|vertex| vertex.mean).collect();
        let gaussian: Vec<T> = curvature.iter().map(|vertex| vertex.gaussian).collect();
        self.normal = curvature.iter().map(|vertex| vertex.normal).collect();
        self.mean = where_defined(&mean, interior);
        self.gaussian = where_defined(&gaussian, interior);
    }

    fn set_strong_form<M>(
        &mut self,
        mesh: &TriangleMesh,
        memory: &StrongFormMemory<T, M>,
        density: &[[T; 3]],
    ) {
        let surrounded = |vertex| mesh.is_surrounded(vertex);
        self.set_curvature(memory.curvature());
        self.laplacian_of_mean = where_defined(memory.laplacian_of_mean(), surrounded);
        self.force_density = where_defined(density, surrounded);
    }
}
