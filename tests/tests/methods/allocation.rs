//! Evaluations allocate no memory after the first one.

use helfrich::{
    AnyFunctional, Bandwidth, Constraint, Constraints, Cotangent, Curvature, Curvatures, DualArea,
    HeatKernel, Images, InPlane, Interaction, LaplaceBeltrami, Method, NeoHookean, Prepared, Real,
    Repulsion, Rows, Serial, SparseMatrix, Surface, Targets,
};
use helfrich_tests::allocation::{allocations, held};
use helfrich_tests::laws::{
    Candidate, ConservativeCandidate, ConservativeLaw, Law, OperatorLaw, Subject, for_each,
    for_each_conservative, for_each_operator,
};
use helfrich_tests::meshes::{Mesh, hemisphere, icosphere};
use helfrich_tests::potentials::for_each_potential;

#[test]
fn the_counter_counts() {
    assert!(allocations(|| drop(std::hint::black_box(vec![1_u8]))) > 0);
    assert_eq!(allocations(|| ()), 0);
}

/// A mesh, and the same mesh with other positions.
struct Allocation {
    mesh: Mesh,
    moved: Mesh,
}

impl Allocation {
    fn of(mesh: Mesh) -> Self {
        let moved = mesh.map(|[x, y, z]| [1.2 * x + 0.1 * y, y, 0.7 * z]);
        Self { mesh, moved }
    }
}

impl Law for Allocation {
    fn check<C: Candidate>(&mut self, candidate: C) {
        self.check_method(&candidate);
    }
}

impl Allocation {
    fn check_method(&self, candidate: &dyn Subject<f64>) {
        let mut force = vec![[0.0; 3]; self.mesh.positions.len()];
        let (first, second) = (self.mesh.surface(), self.moved.surface());
        let mut prepared = candidate.prepared(1.0, &self.mesh.connectivity);
        prepared.add_force(first, &mut force);
        let count = allocations(|| {
            prepared.add_force(second, &mut force);
            std::hint::black_box(prepared.energy(second));
            prepared.add_force(first, &mut force);
        });
        assert_eq!(count, 0, "{}", candidate.name());

        let mut prepared = candidate.prepared(1.0, &self.mesh.connectivity);
        prepared.energy(first);
        let count = allocations(|| {
            std::hint::black_box(prepared.energy(second));
        });
        assert_eq!(count, 0, "{}: energy alone", candidate.name());
    }
}

impl ConservativeLaw for Allocation {
    fn check<C: ConservativeCandidate>(&mut self, candidate: C) {
        let mut force = vec![[0.0; 3]; self.mesh.positions.len()];
        let method = ConservativeCandidate::method(candidate, 1.0);
        let (first, second) = (self.mesh.surface(), self.moved.surface());
        let mut prepared = Prepared::new(method, &self.mesh.connectivity);
        prepared.add_force_and_energy(first, &mut force);
        let count = allocations(|| {
            prepared.add_force_and_energy(second, &mut force);
        });
        let name = ConservativeCandidate::name(candidate);
        assert_eq!(count, 0, "{name}: force and energy");
    }
}

impl OperatorLaw for Allocation {
    fn check<L: LaplaceBeltrami<f64> + Copy>(&mut self, name: &str, operator: L) {
        let vertices = self.mesh.positions.len();
        let mut workspace = operator.workspace(&self.mesh.connectivity);
        let mut curvature = vec![Curvature::default(); vertices];
        let mut rows = Rows::new();
        let mut laplacian = vec![[0.0; 3]; vertices];
        let mut evaluate = |mesh: &Mesh| {
            let surface = mesh.surface();
            operator.curvatures(&Serial, surface, &mut workspace, &mut curvature);
            operator.assemble(surface, &workspace, &mut rows);
            let (field, result) = (&mesh.positions, &mut laplacian);
            operator.apply(&Serial, surface, &workspace, field, result);
            rows.apply(&Serial, field, result);
            operator.inspect(surface, &workspace, &mut |_| ());
        };
        evaluate(&self.mesh);
        let count = allocations(|| {
            evaluate(&self.moved);
            evaluate(&self.mesh);
        });
        assert_eq!(count, 0, "{name}");
    }
}

#[test]
fn nothing_is_allocated_after_the_first_evaluation() {
    for mesh in [icosphere(2), hemisphere(2)] {
        let mut allocation = Allocation::of(mesh);
        for_each(&mut allocation);
        for_each_conservative(&mut allocation);
        for_each_operator(&mut allocation);
        for_each_potential(&mut allocation);
    }
}

#[test]
fn repulsion_allocates_once() {
    let box_around = Images {
        periods: [3.0, 2.5, 0.0],
        own: true,
    };
    for images in [Images::none(), box_around] {
        check_repulsion(Repulsion {
            modulus: 1.0,
            range: 0.6,
            attraction: 0.0,
            parts: false,
            first_group: None,
            images,
        });
    }
}

fn check_repulsion(repulsion: Repulsion<f64>) {
    let Allocation { mesh, moved } = Allocation::of(icosphere(2));
    let beside = moved.map(|[x, y, z]| [x + 1.5, y, z]);
    let mut memory = Default::default();
    let mut evaluate = |surfaces: [Surface<'_, f64>; 2]| {
        let mut forces = [0, 1].map(|_| vec![[0.0; 3]; mesh.positions.len()]);
        let [first, second] = &mut forces;
        let forces: &mut [&mut [_]] = &mut [first, second];
        let mut energy = 0.0;
        let count = allocations(|| {
            energy = repulsion.add_force_and_energy(&Serial, &surfaces, &mut memory, forces);
            energy = energy.min(repulsion.energy(&Serial, &surfaces, &mut memory));
        });
        assert!(energy > 0.0);
        count
    };
    assert!(evaluate([mesh.surface(), beside.surface()]) > 0);
    assert_eq!(evaluate([beside.surface(), mesh.surface()]), 0);
    assert_eq!(evaluate([mesh.surface(), beside.surface()]), 0);
}

#[test]
fn constraints_allocate_once() {
    let Allocation { mesh, moved } = Allocation::of(icosphere(2));
    let constraints = Constraints {
        constraints: [
            AnyFunctional::Area,
            AnyFunctional::Volume,
            AnyFunctional::MeanCurvature,
        ]
        .map(|functional| Constraint {
            functional,
            targets: Targets::measured(&functional, moved.surface()),
        })
        .to_vec(),
    };
    let mut prepared = Prepared::new(constraints, &mesh.connectivity);
    let disturbed = moved.map(|[x, y, z]| [x, 1.01 * y, z]);
    let mut field = moved.positions.clone();
    let mut evaluate = |from: &Mesh| {
        let mut positions = from.positions.clone();
        let mesh = &mesh.connectivity;
        allocations(|| {
            prepared.with(|constraints, execution, workspace| {
                let corrected = constraints.correct(execution, mesh, &mut positions, workspace);
                assert!(corrected.is_ok(), "{corrected:?}");
                let surface = moved.surface();
                constraints.project(execution, surface, workspace, &mut field);
            });
        })
    };
    assert!(evaluate(&disturbed) > 0);
    assert_eq!(evaluate(&disturbed), 0);
}

#[test]
fn matrices_are_refilled_in_place() {
    let Allocation { mesh, moved } = Allocation::of(icosphere(2));
    let operator = Cotangent::new(DualArea::Mixed);
    let mut workspace = operator.workspace(&mesh.connectivity);
    let mut curvature = vec![Curvature::default(); mesh.positions.len()];
    let mut rows = Rows::new();
    operator.curvatures(&Serial, mesh.surface(), &mut workspace, &mut curvature);
    operator.assemble(mesh.surface(), &workspace, &mut rows);
    let [mut stiffness, mut mass, mut pointwise] = [(); 3].map(|()| SparseMatrix::new());
    let mut fill = |mesh: &Mesh| {
        allocations(|| {
            operator.assemble_stiffness(mesh.surface(), &mut stiffness);
            operator.assemble_mass(mesh.surface(), &mut mass);
            rows.fill_matrix(&mut pointwise);
        })
    };
    assert!(fill(&mesh) > 0);
    assert_eq!(fill(&moved), 0);
}

/// In-plane law whose reference is the mesh itself.
#[derive(Clone, Copy)]
struct Elastic<'a>(&'a Mesh);

impl ConservativeCandidate for Elastic<'_> {
    type ConservativeMethod<T: Real> = InPlane<T, NeoHookean<T>>;
    fn name(self) -> &'static str {
        "neo-Hookean"
    }
    fn method<T: Real>(self, shear_modulus: T) -> Self::ConservativeMethod<T> {
        let (mesh, positions) = (&self.0.connectivity, self.0.positions_in());
        let reference = Surface::new(mesh, &positions).unwrap();
        InPlane::new(NeoHookean { shear_modulus }, mesh, reference).unwrap()
    }
}

#[test]
fn in_plane_laws_allocate_at_the_first_evaluation_only() {
    let mesh = icosphere(2);
    let mut allocation = Allocation::of(mesh.clone());
    Law::check(&mut allocation, Elastic(&mesh));
    ConservativeLaw::check(&mut allocation, Elastic(&mesh));
}

/// The rows of a heat kernel that are searched again have the bits of those that are stored, and their
/// columns are not in memory.
#[test]
fn rows_of_too_many_entries_are_not_stored() {
    let mesh = icosphere(3);
    let (vertices, surface) = (mesh.positions.len(), mesh.surface());
    let evaluated = |stored| {
        let operator = HeatKernel {
            stored,
            ..HeatKernel::new(Bandwidth::MixedArea(1.0))
        };
        let mut curvature = vec![Curvature::default(); vertices];
        let mut laplacian = vec![[0.0; 3]; vertices];
        let (workspace, bytes) = held(|| {
            let mut workspace = operator.workspace(&mesh.connectivity);
            operator.curvatures(&Serial, surface, &mut workspace, &mut curvature);
            workspace
        });
        let mut rows = Rows::new();
        operator.assemble(surface, &workspace, &mut rows);
        let field = &mesh.positions;
        operator.apply(&Serial, surface, &workspace, field, &mut laplacian);
        (rows, curvature, laplacian, bytes)
    };
    let (rows, curvature, laplacian, all) = evaluated(usize::MAX);
    let entries = (0..vertices).map(|row| rows.row(row).0.len()).sum();
    let columns = 4 * entries as isize;
    for (stored, bytes) in [(entries, all), (entries - 1, all - columns)] {
        let found = evaluated(stored);
        assert_eq!(
            (&found.0, &found.1, &found.2),
            (&rows, &curvature, &laplacian)
        );
        assert!(found.3 <= bytes, "{} bytes for {bytes}", found.3);
    }
}
