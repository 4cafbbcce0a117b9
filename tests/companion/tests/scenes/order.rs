//! Meshes that are large enough to be evaluated in an internal order of vertices.

use helfrich::{GompperKroll, Prepared, Quality};
use helfrich_std::dynamics::Problem;
use helfrich_std::flow::Membranes;
use helfrich_std::io::{PointField, PointValues, write_vtp};
use helfrich_std::ordered::Ordered;
use helfrich_std::run::{End, run};
use helfrich_std::scene::{Overrides, SceneFile};
use helfrich_std::simulation::{Simulation, build};
use helfrich_tests::meshes::{Mesh, SplitMix64, bent, icosphere, norm};
use helfrich_tests::tolerance;
use std::cell::Cell;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Two components, of which the smaller has the higher vertex numbers.
fn two() -> Mesh {
    let (large, small) = (icosphere(5).map(bent), icosphere(5).map(bent));
    let count = large.positions.len() as u32;
    let beside = small
        .positions
        .iter()
        .map(|x| [4.0 + 0.5 * x[0], 0.5 * x[1], 0.5 * x[2]]);
    let triangles = small.connectivity.triangles().iter();
    let triangles = triangles.map(|triangle| triangle.map(|vertex| vertex + count));
    let positions = large.positions.iter().copied().chain(beside).collect();
    let all = large
        .connectivity
        .triangles()
        .iter()
        .copied()
        .chain(triangles);
    Mesh::new(positions, all.collect())
}

/// Simulation of a mesh with columns, in a scene with this driver and these effects.
fn simulation(mesh: &Mesh, driver: &str, effects: &str) -> (Simulation, Vec<[f64; 3]>) {
    let folder = TempDir::new().unwrap();
    let of = |value: fn([f64; 3]) -> f64| Vec::from_iter(mesh.positions.iter().map(|&x| value(x)));
    let columns = [
        ("kappa", of(|x| 2.0 + x[0].sin())),
        ("H0", of(|x| x[1])),
        ("label", of(|x| if x[2] > 0.1 { 1.0 } else { 2.0 })),
    ];
    let fields = Vec::from_iter(columns.iter().map(|(name, values)| PointField {
        name,
        values: PointValues::Scalars(values),
    }));
    let path = folder.path().join("two.vtp");
    write_vtp(&path, &mesh.connectivity, &mesh.positions, None, &fields).unwrap();
    let text =
        format!("units = \"none\"\n[driver]\n{driver}\n[[surface]]\nmesh = \"two.vtp\"\n{effects}");
    let path = folder.path().join("scene.toml");
    let file = SceneFile::parse(&text, &path, &Overrides::default());
    let file = file.unwrap_or_else(|errors| panic!("{errors}"));
    build(&file).unwrap_or_else(|error| panic!("{error}"))
}

/// Checks that a field on the relabelled mesh has the same values.
fn assert_follows(what: &str, field: &[[f64; 3]], relabelled: &[[f64; 3]], new: &[usize]) {
    let largest = field.iter().map(|&x| norm(x)).fold(0.0, f64::max);
    for (vertex, (&value, &place)) in field.iter().zip(new).enumerate() {
        let found = relabelled[place];
        let off = norm([0, 1, 2].map(|axis| found[axis] - value[axis]));
        assert!(
            off <= tolerance::RELABELLED.value * largest,
            "{what} at vertex {vertex}: {found:?} instead of {value:?}"
        );
    }
}

/// The mesh, the same mesh relabelled, and the new number of each vertex.
fn both() -> ([Mesh; 2], Vec<usize>) {
    let mesh = two();
    let (relabelled, new) = mesh.relabelled(3);
    for mesh in [&mesh, &relabelled] {
        assert!(Ordered::<f64>::of(&mesh.connectivity).is_some());
    }
    ([mesh, relabelled], new)
}

/// The numbering of vertices, triangles and components has no influence on effects and constraints.
#[test]
fn effects_follow_the_numbers_of_the_scene() {
    let effects = "
bending = { method = \"B\", modulus = { column = \"kappa\" }, spontaneous_curvature = { column = \"H0\" } }
border_tension = { value = 3, domains = { column = \"label\" } }
gaussian_bending.modulus = { column = \"H0\" }
elasticity = { law = \"skalak\", shear_modulus = 1, area_ratio = 2, reference.scale = 0.9 }
volume = { modulus = 5, target = 3 }
area_difference = { modulus = 1, target = 20 }
area.constraint = \"exact\"
pressure.value = 1
gravity = { density_difference = 1, acceleration = [0, 0, -1] }
stretching = { axis = [1, 0.1, 0.2], force = 1 }
";
    let (meshes, new) = both();
    let [(mut given, at), (mut other, there)] = meshes
        .each_ref()
        .map(|mesh| simulation(mesh, "kind = \"relax\"", effects));
    let found = other.resolve(&there);
    for (acting, other) in given.resolve(&at).iter().zip(&found) {
        assert_follows(&acting.effect, &acting.force, &other.force, &new);
    }
    let mut forces = [&at, &there].map(|positions| vec![[0.0; 3]; positions.len()]);
    given.evaluate(&at, &mut forces[0]);
    other.evaluate(&there, &mut forces[1]);
    assert_follows("all effects", &forces[0], &forces[1], &new);

    let mut gradients = forces.map(|force| vec![force]);
    given.constraint_gradients(&at, &mut gradients[0]);
    other.constraint_gradients(&there, &mut gradients[1]);
    assert_follows("area", &gradients[0][0], &gradients[1][0], &new);

    let moved = |x: &[f64; 3]| [1.01 * x[0], x[1], 1.02 * x[2]];
    let [mut here, mut there] =
        [&at, &there].map(|positions| Vec::from_iter(positions.iter().map(moved)));
    let before = here.clone();
    assert!(given.restore(&mut here) <= 1e-12 && other.restore(&mut there) <= 1e-12);
    assert!(norm([0, 1, 2].map(|axis| here[5][axis] - before[5][axis])) > 1e-4);
    assert_follows("restored positions", &here, &there, &new);
}

/// Numbering has no influence on a method in strong form and viscous membranes in a flow either.
#[test]
fn viscous_forces_follow_the_numbers_of_the_scene() {
    let effects = "
bending = { method = \"C\", modulus = 1 }
local_area.modulus = 1
membrane_viscosity.shear = 1
";
    let driver = "kind = \"boundary-integral\"\nviscosity = 1\nduration = 1";
    let (meshes, new) = both();
    let [(mut given, at), (mut other, there)] = meshes
        .each_ref()
        .map(|mesh| simulation(mesh, driver, effects));
    let mut forces = [&at, &there].map(|positions| vec![[0.0; 3]; positions.len()]);
    given.set_forces(&at, &mut forces[0]).unwrap();
    other.set_forces(&there, &mut forces[1]).unwrap();
    assert_follows("forces", &forces[0], &forces[1], &new);

    let mut random = SplitMix64::new(8);
    let velocities = random.directions(at.len());
    let mut relabelled = velocities.clone();
    for (velocity, &place) in velocities.iter().zip(&new) {
        relabelled[place] = *velocity;
    }
    let mut forces = forces.map(|force| vec![[0.0; 3]; force.len()]);
    given.add_viscous_forces(&at, &velocities, &mut forces[0]);
    other.add_viscous_forces(&there, &relabelled, &mut forces[1]);
    assert_follows("viscous forces", &forces[0], &forces[1], &new);
}

/// Messages name the vertex numbers of the scene's mesh.
#[test]
fn messages_have_the_numbers_of_the_scene() {
    let mesh = two();
    let lowest = mesh.positions.iter().map(|x| x[2]).fold(0.0, f64::min);
    let wall = 0.9 * lowest;
    let below = mesh.positions.iter().position(|x| x[2] <= wall).unwrap();
    let folder = TempDir::new().unwrap();
    helfrich_std::io::write(
        &folder.path().join("two.ply"),
        &mesh.positions,
        &mesh.connectivity,
    )
    .unwrap();
    let text = format!(
        "units = \"none\"\n[driver]\nkind = \"relax\"\n[[surface]]\nmesh = \"two.ply\"\nbending = {{ \
         method = \"B\", modulus = 1 }}\nadhesion = {{ strength = 1, distance = 0.5, wall = [0, 0, \
         {wall:?}] }}\n"
    );
    let path = folder.path().join("scene.toml");
    let file = SceneFile::parse(&text, &path, &Overrides::default()).unwrap();
    let message = build(&file).unwrap_err().to_string();
    assert!(message.contains(&format!("vertex {below} ")), "{message}");
}

/// Findings name them, too: a vertex that almost touches its neighbour degrades the triangles around both.
#[test]
fn findings_have_the_numbers_of_the_scene() {
    const MOVED: usize = 4000;
    let mut mesh = two();
    let near = mesh.positions[mesh.connectivity.one_ring(MOVED)[0] as usize];
    mesh.positions[MOVED] =
        [0, 1, 2].map(|axis| near[axis] + 0.01 * (mesh.positions[MOVED][axis] - near[axis]));
    let bending = "bending = { method = \"B\", modulus = 1 }";
    let (mut simulation, positions) = simulation(&mesh, "kind = \"relax\"", bending);
    simulation.evaluate(&positions, &mut vec![[0.0; 3]; positions.len()]);
    let body = &simulation.bodies()[0];
    let surface = body.surface(&positions).unwrap();
    let found = Quality::gather(body.mesh(), |report| {
        body.inspect(&body.effects()[0], surface, report);
    });
    let mut prepared = Prepared::new(GompperKroll::new(1.0), body.mesh());
    prepared.add_force_and_energy(surface, &mut vec![[0.0; 3]; positions.len()]);
    let expected = Quality::gather(body.mesh(), |report| prepared.inspect(surface, report));
    assert!(found.flagged()[MOVED]);
    assert_eq!(found.flagged(), expected.flagged());
}

/// A run that is interrupted and resumed writes the bits of one that is not: checkpoints and series have the
/// vertex numbers of the scene's mesh.
#[test]
fn runs_go_on_from_their_stored_bits() {
    let text = r#"
units = "none"
[driver]
kind = "relax"
iterations = 6
[output]
every = 1
pictures = false
surfaces = false
[[surface]]
shape = "ellipsoid:1,1,0.8"
family = "irregular"
vertices = 20500
bending = { method = "B", modulus = 1 }
volume.constraint = "exact"
"#;
    let file = SceneFile::parse(text, Path::new("scene.toml"), &Overrides::default()).unwrap();
    let folder = TempDir::new().unwrap();
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    let go = |out: &Path, resume: bool, stop: usize| {
        let built = build(&file).unwrap();
        assert!(Ordered::<f64>::of(built.0.bodies()[0].mesh()).is_some());
        let steps = Cell::new(0);
        let interrupted = || {
            steps.set(steps.get() + 1);
            steps.get() >= stop
        };
        let summary = run(&file.scene, built, out, resume, &interrupted, &mut |_| {});
        summary.unwrap_or_else(|error| panic!("{error}")).end
    };
    let end = go(&whole, false, usize::MAX);
    assert_ne!(end, End::Interrupted);
    let mut now = go(&parts, false, 3);
    assert_eq!(now, End::Interrupted);
    while now == End::Interrupted {
        now = go(&parts, true, 3);
    }
    assert_eq!(now, end);
    let [whole, parts] = [whole, parts].map(|out| fs::read(out.join("series.csv")).unwrap());
    assert!(whole == parts, "the series differ");
}
