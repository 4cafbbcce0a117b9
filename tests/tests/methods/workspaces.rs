//! Every function that takes a workspace refuses one of another mesh.

use crate::range::refusal;
use helfrich::{
    AnyFunctional, AreaDifference, Aspiration, BoundaryLength, Conservative, Constraint,
    Constraints, ControlPoints, CorrectedCurvature, Curvature, Curvatures, Dissipation,
    EnclosedVolume, EndPull, Energy, Force, ForceDensity, Functional, GompperKroll, Gravity,
    Hamann, InPlane, Juelicher, KantorNelson, LaplaceBeltrami, LoopSubdivision, MaterialParameter,
    MembraneViscosity, Method, NeoHookean, Paraboloid, PatchFunctional, PointLoads, Prepared,
    Projected, Rows, Serial, StrongForm, Surface, Targets, TotalArea, TotalGaussianCurvature,
    TotalMeanCurvature, TriangleMesh, VertexNormals, Workspace,
};
use helfrich_tests::laws::{
    Candidate, ConservativeCandidate, ConservativeLaw, Law, OperatorLaw, for_each,
    for_each_conservative, for_each_operator,
};
use helfrich_tests::meshes::{Mesh, bent, icosphere};
use helfrich_tests::potentials::for_each_potential;

/// A mesh, and three others: with the same numbers of vertices and triangles, with fewer, and with more.
struct Meshes {
    own: Mesh,
    others: [Mesh; 3],
}

impl Meshes {
    fn new() -> Self {
        let own = icosphere(2).map(bent);
        let mut triangles = own.connectivity.triangles().to_vec();
        triangles.rotate_left(1);
        let turned = Mesh::new(own.positions.clone(), triangles);
        let others = [turned, icosphere(1).map(bent), icosphere(3).map(bent)];
        Self { own, others }
    }

    /// Uses a workspace on its own mesh, and checks that copies are refused on each of the others.
    fn refused<M: Method<f64>>(
        &self,
        name: &str,
        method: &M,
        mut act: impl FnMut(&mut Workspace<f64, M>, &Mesh),
    ) {
        let mut workspace = method.workspace(&self.own.connectivity);
        self.refused_by(name, &mut |on_copy, mesh| {
            let mut copy;
            let used = if on_copy {
                copy = workspace.clone();
                &mut copy
            } else {
                &mut workspace
            };
            act(used, mesh);
        });
    }

    /// As [`Self::refused`], and compiled once: `act` uses the workspace or a copy of it.
    fn refused_by(&self, name: &str, act: &mut dyn FnMut(bool, &Mesh)) {
        // The first evaluation allocates everything that a workspace can hold.
        act(false, &self.own);
        for other in &self.others {
            let message = refusal(|| act(true, other));
            let message = message.unwrap_or_else(|| {
                let vertices = other.positions.len();
                panic!("{name}: accepted a mesh of {vertices} vertices")
            });
            self.assert_documented(name, &message, other, "Method::workspace");
        }
        act(false, &self.own);
    }

    /// Checks that the message names both meshes and the remedy.
    fn assert_documented(&self, name: &str, message: &str, other: &Mesh, remedy: &str) {
        let [expected, given] = [&self.own, other].map(|mesh| {
            let mesh = &mesh.connectivity;
            let (vertices, triangles) = (mesh.vertex_count(), mesh.triangles().len());
            format!("{vertices} vertices and {triangles} triangles")
        });
        let documented = format!(
            " was prepared for a mesh of {expected}, and is used with another mesh of {given}"
        );
        assert!(message.contains(&documented), "{name}: {message}");
        assert!(message.contains(remedy), "{name}: {message}");
        assert!(!message.contains("::bending::"), "{name}: {message}");
    }
}

/// One vector per vertex of the largest mesh.
fn vectors() -> Vec<[f64; 3]> {
    vec![[0.25, 0.5, 1.0]; 642]
}

impl Meshes {
    fn check_energy<M: Energy<f64>>(&self, name: &str, method: &M) {
        self.refused(name, method, |workspace, mesh| {
            std::hint::black_box(method.energy(&Serial, mesh.surface(), workspace));
        });
        self.refused(name, method, |workspace, mesh| {
            method.inspect(mesh.surface(), workspace, &mut |_| ());
        });
    }

    fn check_force<M: Force<f64>>(&self, name: &str, method: &M) {
        self.refused(name, method, |workspace, mesh| {
            method.add_force(&Serial, mesh.surface(), workspace, &mut vectors());
        });
    }

    fn check_conservative<M: Conservative<f64>>(&self, name: &str, method: &M) {
        self.check_energy(name, method);
        self.check_force(name, method);
        self.refused(name, method, |workspace, mesh| {
            method.add_force_and_energy(&Serial, mesh.surface(), workspace, &mut vectors());
        });
    }

    fn check_density<M: ForceDensity<f64>>(&self, name: &str, method: &M) {
        self.refused(name, method, |workspace, mesh| {
            method.force_density(&Serial, mesh.surface(), workspace, &mut vectors());
        });
    }

    fn check_curvatures<M: Curvatures<f64>>(&self, name: &str, method: &M) {
        self.refused(name, method, |workspace, mesh| {
            let mut curvature = vec![Curvature::default(); 642];
            method.curvatures(&Serial, mesh.surface(), workspace, &mut curvature);
        });
    }

    fn check_functional<F: Functional<f64>>(&self, name: &str, functional: &F) {
        self.refused(name, functional, |workspace, mesh| {
            functional.values(&Serial, mesh.surface(), workspace, &mut [0.0]);
        });
        self.refused(name, functional, |workspace, mesh| {
            let mut gradient = vectors();
            functional.add_gradient(&Serial, mesh.surface(), workspace, &[1.0], &mut gradient);
        });
        self.refused(name, functional, |workspace, mesh| {
            functional.inspect(mesh.surface(), workspace, &mut |_| ());
        });
    }
}

impl Law for Meshes {
    fn check<C: Candidate>(&mut self, candidate: C) {
        let method = candidate.method(1.0);
        self.check_energy(candidate.name(), &method);
        self.check_force(candidate.name(), &method);
        let projected = Projected(method);
        self.check_energy(candidate.name(), &projected);
        self.check_force(candidate.name(), &projected);
    }
}

impl ConservativeLaw for Meshes {
    fn check<C: ConservativeCandidate>(&mut self, candidate: C) {
        self.check_conservative(candidate.name(), &candidate.method(1.0));
    }
}

impl OperatorLaw for Meshes {
    fn check<L: LaplaceBeltrami<f64> + Copy>(&mut self, name: &str, operator: L) {
        let measure = |workspace: &mut Workspace<f64, L>, mesh: &Mesh| {
            let mut curvature = vec![Curvature::default(); 642];
            operator.curvatures(&Serial, mesh.surface(), workspace, &mut curvature);
        };
        self.check_curvatures(name, &operator);
        self.refused(name, &operator, |workspace, mesh| {
            if mesh.connectivity == self.own.connectivity {
                measure(workspace, mesh);
            }
            let mut laplacian = vectors();
            operator.apply(
                &Serial,
                mesh.surface(),
                workspace,
                &vectors(),
                &mut laplacian,
            );
        });
        self.refused(name, &operator, |workspace, mesh| {
            if mesh.connectivity == self.own.connectivity {
                measure(workspace, mesh);
            }
            operator.assemble(mesh.surface(), workspace, &mut Rows::new());
        });
        self.refused(name, &operator, |workspace, mesh| {
            operator.inspect(mesh.surface(), workspace, &mut |_| ());
        });
    }
}

#[test]
fn methods_refuse_workspaces_of_other_meshes() {
    let mut meshes = Meshes::new();
    for_each(&mut meshes);
    for_each_conservative(&mut meshes);
    for_each_potential(&mut meshes);
    let (shear, dilational) = (1.0, 2.0);
    let viscosity = MembraneViscosity { shear, dilational };
    meshes.refused("viscosity", &viscosity, |workspace, mesh| {
        let (surface, velocities) = (mesh.surface(), vectors());
        viscosity.dissipated_power(&Serial, surface, workspace, &velocities);
    });
    let viscosities = (viscosity, viscosity);
    meshes.refused("viscosity", &viscosities, |workspace, mesh| {
        let (surface, velocities, mut force) = (mesh.surface(), vectors(), vectors());
        viscosities.add_dissipative_force(&Serial, surface, workspace, &velocities, &mut force);
    });
    meshes.refused("viscosity", &viscosity, |workspace, mesh| {
        viscosity.inspect(mesh.surface(), workspace, &mut |_| ());
    });
}

#[test]
fn operators_refuse_workspaces_of_other_meshes() {
    let mut meshes = Meshes::new();
    for_each_operator(&mut meshes);
    meshes.check_density("C", &StrongForm::meyer(1.0));
    meshes.check_density("D", &Projected(StrongForm::belkin(1.0)));
    meshes.check_density("E", &StrongForm::farutin(1.0));
    meshes.check_density("J4", &Projected(StrongForm::j4(1.0)));
    meshes.check_density("S", &LoopSubdivision::new(1.0));
}

#[test]
fn functionals_and_effects_refuse_workspaces_of_other_meshes() {
    let meshes = Meshes::new();
    meshes.check_functional("area", &TotalArea);
    meshes.check_functional("volume", &EnclosedVolume);
    meshes.check_functional("mean curvature", &TotalMeanCurvature);
    meshes.check_functional("Gaussian curvature", &TotalGaussianCurvature);
    meshes.check_functional("boundary", &BoundaryLength);
    for quantity in [
        AnyFunctional::Area,
        AnyFunctional::Volume,
        AnyFunctional::MeanCurvature,
        AnyFunctional::OfPatches(PatchFunctional::Area),
        AnyFunctional::OfPatches(PatchFunctional::Volume),
    ] {
        meshes.check_functional("quantity", &quantity);
    }
    meshes.check_conservative("area difference", &AreaDifference::new(1.0, 20.0));
    let (weight, level) = ([0.0, 0.0, 1.0], [0.0; 3]);
    meshes.check_conservative("gravity", &Gravity { weight, level });
    let pipette = Aspiration {
        pressure: 1.0,
        mouth: level,
        axis: weight,
        width: 0.1,
    };
    meshes.check_conservative("aspiration", &pipette);
    let own = &meshes.own.connectivity;
    let loads = PointLoads::new(own, vec![(3, [1.0, 0.0, 0.0])]).expect("a load");
    meshes.check_conservative("loads", &loads);
    let (axis, depths) = ([1.0, 0.0, 0.0], [0.1; 2]);
    let (force, stiffness, length) = (1.0, 0.0, 0.0);
    let pull = EndPull {
        axis,
        depths,
        force,
        stiffness,
        length,
    };
    meshes.check_conservative("end pull", &pull);
    let law = NeoHookean { shear_modulus: 1.0 };
    let elastic = InPlane::new(law, own, meshes.own.surface()).expect("a reference");
    meshes.check_conservative("in-plane", &elastic);

    let functional = AnyFunctional::Area;
    let targets = Targets::measured(&functional, meshes.own.surface());
    let constraint = Constraint {
        functional,
        targets,
    };
    let constraints = vec![constraint];
    let constraints = Constraints { constraints };
    meshes.refused("constraints", &constraints, |workspace, mesh| {
        let (mesh, mut positions) = (&mesh.connectivity, mesh.positions.clone());
        let corrected = constraints.correct(&Serial, mesh, &mut positions, workspace);
        corrected.expect("it is there");
    });
    meshes.refused("constraints", &constraints, |workspace, mesh| {
        constraints.project(&Serial, mesh.surface(), workspace, &mut vectors());
    });
}

/// Functions of methods that belong to no trait.
#[test]
fn curvatures_refuse_workspaces_of_other_meshes() {
    let meshes = Meshes::new();
    meshes.check_curvatures("B", &GompperKroll::new(1.0));
    let method = GompperKroll::new(1.0);
    meshes.refused("B", &method, |workspace, mesh| {
        let (surface, normals, mut mean) = (mesh.surface(), vectors(), vec![0.0; 642]);
        method.mean_curvature_along(&Serial, surface, workspace, &normals, &mut mean);
    });
    meshes.check_curvatures("Jülicher", &Juelicher::new(1.0));
    meshes.check_curvatures("C", &StrongForm::meyer(1.0));
    meshes.check_curvatures("J4", &Projected(StrongForm::j4(1.0)));
    let method = LoopSubdivision::new(1.0);
    meshes.check_curvatures("S", &method);
    meshes.refused("S", &method, |workspace, mesh| {
        method.limit_positions(&Serial, mesh.surface(), workspace, &mut vectors());
    });
    meshes.refused("S", &method, |workspace, mesh| {
        method.area_and_volume(&Serial, mesh.surface(), workspace);
    });
    meshes.refused("S", &method, |workspace, mesh| {
        let (surface, mut solver, mut density) = (mesh.surface(), Default::default(), vectors());
        method.consistent_force_density(&Serial, surface, workspace, &mut solver, &mut density);
    });
}

/// A reference shape belongs to one mesh: on a mesh with as many triangles in another order, values would
/// belong to other triangles.
#[test]
fn references_of_another_mesh_are_refused() {
    let meshes = Meshes::new();
    let (own, surface) = (&meshes.own.connectivity, meshes.own.surface());
    let law = NeoHookean { shear_modulus: 1.0 };
    let elastic = InPlane::new(law, own, surface).expect("a reference");
    let hinged = KantorNelson::new(1.0).with_reference(own, surface);
    let hinged = hinged.expect("a reference");
    for other in &meshes.others {
        let mesh: &TriangleMesh = &other.connectivity;
        let message = refusal(|| drop(Prepared::<f64, _>::new(elastic.clone(), mesh)));
        let message = message.expect("refused");
        meshes.assert_documented("InPlane", &message, other, "InPlane::new");
        let message = refusal(|| drop(Prepared::<f64, _>::new(hinged.clone(), mesh)));
        let message = message.expect("refused");
        meshes.assert_documented("A", &message, other, "KantorNelson::with_reference");
    }
    let again = TriangleMesh::new(own.vertex_count(), own.triangles().to_vec()).expect("a mesh");
    let surface = Surface::new(&again, &meshes.own.positions).expect("positions");
    let elastic = Prepared::new(elastic, &again).energy(surface);
    let hinged = Prepared::new(hinged, &again).energy(surface);
    assert_eq!([elastic, hinged], [0.0; 2], "equal meshes are the same");
}

/// An operator can be applied only after it has measured a surface.
#[test]
fn operators_are_applied_to_measured_surfaces_only() {
    struct Measures(Mesh);
    impl OperatorLaw for Measures {
        fn check<L: LaplaceBeltrami<f64> + Copy>(&mut self, name: &str, operator: L) {
            let (mesh, surface) = (&self.0.connectivity, self.0.surface());
            let mut prepared = Prepared::new(operator, mesh);
            let (mut laplacian, mut rows) = (vectors(), Rows::new());
            let applied = refusal(|| prepared.apply(surface, &vectors(), &mut laplacian));
            let assembled = refusal(|| prepared.assemble(surface, &mut rows));
            for message in [applied, assembled] {
                let message = message.unwrap_or_else(|| panic!("{name}: nothing refused"));
                assert!(message.contains("measured no surface"), "{name}: {message}");
            }
            assert_eq!(
                prepared.curvatures(surface).len(),
                mesh.vertex_count(),
                "{name}"
            );
            prepared.apply(surface, &vectors(), &mut laplacian);
            let (field, mut scalars) = (vec![0.5; 642], vec![f64::NAN; 642]);
            prepared.apply_to_scalar(surface, &field, &mut scalars);
            prepared.assemble(surface, &mut rows);
            for vertex in 0..mesh.vertex_count() {
                assert_eq!(
                    (laplacian[vertex], scalars[vertex]),
                    ([0.0; 3], 0.0),
                    "{name}"
                );
            }
            assert_eq!(rows.len(), mesh.vertex_count(), "{name}");
        }
    }
    for_each_operator(&mut Measures(icosphere(2).map(bent)));
}

/// A workspace that depends on a parameter serves only methods with the same parameter.
#[test]
fn workspaces_of_other_parameters_are_refused() {
    fn refused<M: Energy<f64>>(made: &M, used: &M, parameter: &str) {
        let mesh = icosphere(2).map(bent);
        let mut workspace = made.workspace(&mesh.connectivity);
        made.energy(&Serial, mesh.surface(), &mut workspace);
        let message = refusal(|| {
            used.energy(&Serial, mesh.surface(), &mut workspace);
        });
        let message = message.unwrap_or_else(|| panic!("{parameter}: accepted"));
        for part in [" was prepared with ", parameter, "Method::workspace"] {
            assert!(message.contains(part), "{message}");
        }
        made.energy(&Serial, mesh.surface(), &mut workspace);
    }
    let (j4, j6) = (StrongForm::j4(1.0), StrongForm::j6(1.0));
    refused(&j4, &j6, "so many neighbours: 64, and is used with 112");
    refused(&j6, &j4, "so many neighbours: 112, and is used with 64");
    let [published, guarded] =
        [false, true].map(|guarded| StrongForm::new(1.0, Paraboloid { guarded }));
    refused(
        &published,
        &guarded,
        "`guarded` false, and is used with true",
    );
    let [nodes, hybrid] = [ControlPoints::Nodes, ControlPoints::Hybrid]
        .map(|controls| LoopSubdivision::with_controls(1.0, controls));
    refused(
        &nodes,
        &hybrid,
        "control points Nodes, and is used with Hybrid",
    );
}

/// The same law for an operator for curvatures only.
#[test]
fn workspaces_of_other_normals_are_refused() {
    let mesh = icosphere(2).map(bent);
    let [averaged, fitted] = [VertexNormals::Averaged, VertexNormals::Fitted]
        .map(|normals| CorrectedCurvature { normals });
    let mut workspace = averaged.workspace(&mesh.connectivity);
    let mut curvature = vec![Curvature::default(); mesh.positions.len()];
    let message = refusal(|| {
        fitted.curvatures(&Serial, mesh.surface(), &mut workspace, &mut curvature);
    });
    let message = message.expect("refused");
    let documented = "normals Averaged, and is used with Fitted";
    assert!(message.contains(documented), "{message}");
}

/// Spontaneous curvatures with too few or too many values are refused.
#[test]
fn spontaneous_curvatures_for_other_meshes_are_refused() {
    let mesh = icosphere(2).map(bent);
    let check = |name: &str, energy: &dyn Fn(MaterialParameter<f64>)| {
        let vertices = mesh.positions.len();
        for count in [3, vertices - 1, vertices + 1] {
            let values = MaterialParameter::PerVertex(vec![0.5; count]);
            let message = refusal(|| energy(values));
            let message = message.unwrap_or_else(|| panic!("{name}: accepted {count}"));
            let documented = format!(
                "has {count} spontaneous curvatures, one per vertex, and is used with a mesh of \
                 {vertices} vertices"
            );
            assert!(message.contains(&documented), "{name}: {message}");
        }
        energy(MaterialParameter::PerVertex(vec![0.5; vertices]));
    };
    macro_rules! check {
        ($($method:expr),*) => {
            $(check(stringify!($method), &|values| {
                let mut method = $method;
                method.spontaneous_curvature = values;
                Prepared::new(method, &mesh.connectivity).energy(mesh.surface());
            });)*
        };
    }
    check!(
        GompperKroll::new(1.0),
        Juelicher::new(1.0),
        Hamann::new(1.0),
        LoopSubdivision::new(1.0),
        StrongForm::meyer(1.0),
        StrongForm::j4(1.0)
    );
}
