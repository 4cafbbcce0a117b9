//! The closed set of bending methods, chosen at run time.
//!
//! The choice is made once a surface; from there on everything is resolved at compile time.

use helfrich::bending::StrongFormMemory;
use helfrich::laplacian::CotangentMemory;
use helfrich::{
    Cotangent, Curvature, DualArea, Finding, GompperKroll, Jet, KantorNelson, LaplaceBeltrami,
    LoopSubdivision, Method, Prepared, Real, Serial, StrongForm, Surface, TriangleMesh, VertexKind,
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
    /// S: the limit surface of Loop subdivision.
    Loop,
    /// J of degree 4: strong form over osculating jets.
    J4,
    /// J of degree 6.
    J6,
}

impl BendingMethod {
    /// Every method, in the order of the paper's letters.
    pub const ALL: [Self; 6] = [
        Self::KantorNelson,
        Self::GompperKroll,
        Self::Meyer,
        Self::Loop,
        Self::J4,
        Self::J6,
    ];

    /// The long name, as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::KantorNelson => "kantor-nelson",
            Self::GompperKroll => "gompper-kroll",
            Self::Meyer => "meyer",
            Self::Loop => "loop",
            Self::J4 => "j4",
            Self::J6 => "j6",
        }
    }

    /// The paper's letter.
    pub fn letter(self) -> &'static str {
        match self {
            Self::KantorNelson => "A",
            Self::GompperKroll => "B",
            Self::Meyer => "C",
            Self::Loop => "S",
            Self::J4 => "J4",
            Self::J6 => "J6",
        }
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
    let known = BendingMethod::ALL.map(|method| format!("{method} ({})", method.letter()));
    known.join(", ")
}

impl FromStr for BendingMethod {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, UnknownMethod> {
        let matches = |method: &Self| {
            method.name().eq_ignore_ascii_case(name) || method.letter().eq_ignore_ascii_case(name)
        };
        Self::ALL
            .into_iter()
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
#[derive(Clone, Debug)]
pub struct Evaluator<T: Real> {
    prepared: PreparedMethod<T>,
    force: Vec<[T; 3]>,
}

#[derive(Clone, Debug)]
enum PreparedMethod<T: Real> {
    KantorNelson(Prepared<T, KantorNelson<T>>),
    GompperKroll(Prepared<T, GompperKroll<T>>),
    Meyer(Prepared<T, StrongForm<T, Cotangent>>),
    Loop(Prepared<T, LoopSubdivision<T>>),
    Jet(Prepared<T, StrongForm<T, Jet<T>>>),
}

impl<T: Real> Evaluator<T> {
    /// Prepares `method` with bending modulus `modulus` for a mesh.
    pub fn new(method: BendingMethod, modulus: T, mesh: &TriangleMesh) -> Self {
        let prepared = match method {
            BendingMethod::KantorNelson => {
                PreparedMethod::KantorNelson(Prepared::new(KantorNelson::new(modulus), mesh))
            }
            BendingMethod::GompperKroll => {
                PreparedMethod::GompperKroll(Prepared::new(GompperKroll::new(modulus), mesh))
            }
            BendingMethod::Meyer => {
                PreparedMethod::Meyer(Prepared::new(StrongForm::meyer(modulus), mesh))
            }
            BendingMethod::Loop => {
                PreparedMethod::Loop(Prepared::new(LoopSubdivision::new(modulus), mesh))
            }
            BendingMethod::J4 => PreparedMethod::Jet(Prepared::new(StrongForm::j4(modulus), mesh)),
            BendingMethod::J6 => PreparedMethod::Jet(Prepared::new(StrongForm::j6(modulus), mesh)),
        };
        Self {
            prepared,
            force: vec![[T::zero(); 3]; mesh.vertex_count()],
        }
    }

    /// One evaluation as a simulation makes it: nodal forces with the energy for conservative
    /// methods, force densities with the curvatures for those in strong form.
    pub fn evaluate(&mut self, surface: Surface<'_, T>) {
        self.force.fill([T::zero(); 3]);
        match &mut self.prepared {
            PreparedMethod::KantorNelson(method) => {
                method.add_force_and_energy(surface, &mut self.force);
            }
            PreparedMethod::GompperKroll(method) => {
                method.add_force_and_energy(surface, &mut self.force);
            }
            PreparedMethod::Meyer(method) => method.force_density(surface, &mut self.force),
            PreparedMethod::Loop(method) => {
                method.add_force_and_energy(surface, &mut self.force);
            }
            PreparedMethod::Jet(method) => method.force_density(surface, &mut self.force),
        }
    }

    /// Evaluates, and collects all that the method says.
    pub fn fields(&mut self, surface: Surface<'_, T>) -> Fields<T> {
        self.evaluate(surface);
        let mesh = surface.mesh();
        let mut curvature = vec![Curvature::default(); mesh.vertex_count()];
        let mut memory = CotangentMemory::default();
        let cotangent = Cotangent::new(DualArea::Mixed);
        cotangent.measure(
            &Serial,
            &Method::<T>::plan(&cotangent, mesh),
            surface,
            &mut memory,
            &mut curvature,
        );
        let mut fields = Fields {
            area: curvature.iter().map(|vertex| vertex.area).collect(),
            normal: curvature.iter().map(|vertex| vertex.normal).collect(),
            mean: vec![None; mesh.vertex_count()],
            gaussian: vec![None; mesh.vertex_count()],
            laplacian_of_mean: vec![None; mesh.vertex_count()],
            force_density: vec![None; mesh.vertex_count()],
        };
        match &mut self.prepared {
            PreparedMethod::KantorNelson(_) => fields.set_density(&self.force),
            PreparedMethod::GompperKroll(method) => {
                fields.set_density(&self.force);
                let mut mean = vec![T::zero(); mesh.vertex_count()];
                method.with(|method, execution, (), memory| {
                    let normals = &fields.normal;
                    method.mean_curvature(execution, surface, memory, normals, &mut mean);
                });
                let interior = |vertex| mesh.vertex_kind(vertex) == VertexKind::Interior;
                fields.mean = where_defined(&mean, interior);
            }
            PreparedMethod::Loop(method) => {
                fields.set_density(&self.force);
                method.with(|method, execution, plan, memory| {
                    method.curvature(execution, plan, surface, memory, &mut curvature);
                });
                fields.set_curvature(&curvature);
            }
            PreparedMethod::Meyer(method) => {
                fields.set_strong_form(mesh, method.memory(), &self.force);
            }
            PreparedMethod::Jet(method) => {
                fields.set_strong_form(mesh, method.memory(), &self.force);
            }
        }
        // A vertex that was left out: the method's 0 there is no curvature.
        for finding in self.findings(surface) {
            match finding {
                Finding::ZeroArea { vertex } | Finding::TooFewNeighbours { vertex } => {
                    fields.clear(vertex as usize);
                }
                _ => {}
            }
        }
        fields
    }

    /// What makes the last evaluation less trustworthy than usual.
    pub fn findings(&self, surface: Surface<'_, T>) -> Vec<Finding> {
        let mut findings = Vec::new();
        let mut report = |finding| findings.push(finding);
        match &self.prepared {
            PreparedMethod::KantorNelson(method) => method.inspect(surface, &mut report),
            PreparedMethod::GompperKroll(method) => method.inspect(surface, &mut report),
            PreparedMethod::Meyer(method) => method.inspect(surface, &mut report),
            PreparedMethod::Loop(method) => method.inspect(surface, &mut report),
            PreparedMethod::Jet(method) => method.inspect(surface, &mut report),
        }
        findings
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
            (area > T::zero()).then(|| force.map(|component| component / area))
        };
        self.force_density = force
            .iter()
            .zip(&self.area)
            .map(|(&force, &area)| over(force, area))
            .collect();
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
