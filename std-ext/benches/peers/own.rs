//! Meshes, exact values, results and times of helfrich, for the comparison with other programs by
//! `std-ext/benches/peers/run`. Numbers of files are f64, little endian.
//!
//! ```console
//! cargo run --profile bench --example beside_peers -- meshes FOLDER
//! ```
#![expect(clippy::print_stdout, reason = "the result")]

use helfrich::subdivision::Subdivision;
use helfrich::{AdaptiveJet, Curvature, Curvatures, Jet, Method, Surface};
use helfrich_std::execute::{Parallel, with_threads};
use helfrich_std::generate::{AnyShape, Family, generate};
use helfrich_std::io;
use helfrich_std::measurement::Measurement;
use helfrich_std::method::{BendingMethod, Evaluator, MethodOptions};
use helfrich_std::remesh::{EdgeLengths, MeshRequest, OfNoise, remeshed};
use std::error::Error;
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::path::Path;
use std::time::Instant;

/// Vertices of the meshes.
const SIZES: [usize; 3] = [2562, 10_242, 40_962];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Vec::from_iter(std::env::args().skip(1));
    let arguments = Vec::from_iter(arguments.iter().map(String::as_str));
    match arguments[..] {
        ["meshes", folder] => meshes(Path::new(folder)),
        ["curvatures", mesh, ref methods @ ..] => methods
            .iter()
            .try_for_each(|method| curvatures(Path::new(mesh), method)),
        ["jet", mesh] => jet(Path::new(mesh)),
        ["read", mesh] => read(Path::new(mesh)),
        ["subdivide", mesh, levels] => subdivide(Path::new(mesh), levels.parse()?),
        ["remesh", mesh, output] => remesh(Path::new(mesh), Path::new(output)),
        ["accuracy", mesh] => accuracy(Path::new(mesh)),
        _ => Err(
            "meshes FOLDER | curvatures MESH METHOD… | jet MESH | read MESH | subdivide MESH \
                  LEVELS | remesh MESH OUTPUT | accuracy MESH"
                .into(),
        ),
    }
}

/// Discocytes as PLY files, beside each of them a file of exact H, K and f, the force density along the
/// normal for κ = 1, at each vertex; and one of 655 362 vertices in two formats, to read.
fn meshes(folder: &Path) -> Result<(), Box<dyn Error>> {
    let shape: AnyShape = "discocyte".parse()?;
    for family in [Family::Regular, Family::Irregular] {
        for vertices in SIZES {
            let made = generate(&shape, family, vertices, 0)?;
            let path = folder.join(format!("{family}-{}.ply", made.mesh.vertex_count()));
            io::write(&path, &made.positions, &made.mesh)?;
            let exact = made.preimages.iter().map(|&preimage| {
                let point = helfrich::shapes::Shape::at(&shape, preimage);
                [point.mean, point.gaussian, point.force_density(1.0)]
            });
            write_values(&path.with_extension("exact"), exact)?;
        }
    }
    let large = generate(&shape, Family::Regular, 655_362, 0)?;
    for name in ["large.ply", "large.obj"] {
        io::write(&folder.join(name), &large.positions, &large.mesh)?;
    }
    Ok(())
}

fn write_values(path: &Path, values: impl Iterator<Item = [f64; 3]>) -> std::io::Result<()> {
    std::fs::write(
        path,
        Vec::from_iter(values.flatten().flat_map(f64::to_le_bytes)),
    )
}

/// Prints the seconds of the first evaluation, with all that is prepared once for a mesh, and of another
/// one, on one thread, and writes H, K and f to `MESH.METHOD`.
fn curvatures(path: &Path, method: &str) -> Result<(), Box<dyn Error>> {
    let file = io::read(path)?;
    let surface = Surface::new(&file.mesh, &file.positions)?;
    let options = MethodOptions::default();
    let start = Instant::now();
    let kind: BendingMethod = method.parse()?;
    let mut evaluator =
        Evaluator::<f64>::with_options(kind, &options, 1.0, &file.mesh, Parallel::single());
    evaluator.evaluate(surface);
    let first = start.elapsed().as_secs_f64();
    let start = Instant::now();
    evaluator.evaluate(surface);
    let again = start.elapsed().as_secs_f64();
    println!("{method} {first} {again}");
    let fields = evaluator.last_fields(surface);
    let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let values = (0..file.positions.len()).map(|vertex| {
        let normal = fields.normal[vertex];
        let along = |force: [f64; 3]| (0..3).map(|axis| force[axis] * normal[axis]).sum();
        let force = fields.force_density[vertex].map(along);
        [fields.mean[vertex], fields.gaussian[vertex], force].map(number)
    });
    write_values(&path.with_extension(method), values)?;
    Ok(())
}

/// The same of jets that choose their scale, which have no second evaluation.
fn jet(path: &Path) -> Result<(), Box<dyn Error>> {
    let file = io::read(path)?;
    let surface = Surface::new(&file.mesh, &file.positions)?;
    let start = Instant::now();
    let measured = Measurement::new(surface, &AdaptiveJet::default(), &mut |_| true);
    let seconds = start.elapsed().as_secs_f64();
    println!("jet {seconds} {seconds}");
    let fields = measured.ok_or("the measurement was stopped")?.fields(1.0);
    let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let values = (0..file.positions.len()).map(|vertex| {
        [
            number(fields.mean[vertex]),
            number(fields.gaussian[vertex]),
            f64::NAN,
        ]
    });
    write_values(&path.with_extension("jet"), values)?;
    Ok(())
}

/// Prints the seconds to read a mesh, with the neighbours of its triangles.
fn read(path: &Path) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    black_box(io::read(path)?);
    println!("{}", start.elapsed().as_secs_f64());
    Ok(())
}

/// Prints the seconds to refine a mesh by Loop's rules.
fn subdivide(path: &Path, levels: u32) -> Result<(), Box<dyn Error>> {
    let io::MeshFile {
        mut mesh,
        mut positions,
        ..
    } = io::read(path)?;
    let start = Instant::now();
    for _ in 0..levels {
        let fine = Subdivision::new(&mesh, 1)?;
        positions = fine.refine(&positions);
        mesh = fine.into_mesh();
    }
    println!("{}", start.elapsed().as_secs_f64());
    black_box((mesh, positions));
    Ok(())
}

/// Prints the seconds to make even triangles with the same number of vertices, on one thread.
fn remesh(path: &Path, output: &Path) -> Result<(), Box<dyn Error>> {
    let file = io::read(path)?;
    let surface = Surface::new(&file.mesh, &file.positions)?;
    let request = MeshRequest {
        lengths: EdgeLengths::Uniform(1.0),
        vertices: Some(file.positions.len()),
        creases: 60_f64.to_radians(),
        noise: OfNoise::Refused,
    };
    let start = Instant::now();
    let new = with_threads(NonZeroUsize::MIN, || {
        remeshed(surface, &request, &mut |_| true)
    })?;
    println!("{}", start.elapsed().as_secs_f64());
    let positions = new.made.points.iter().map(|point| point.position);
    io::write(output, &Vec::from_iter(positions), &new.made.mesh)?;
    Ok(())
}

/// Prints of a mesh near the discocyte its number of vertices, its smallest angle in degrees, the largest error of H by
/// jets of degree 6 over the largest exact |H|, and the largest distance of a vertex from the surface.
fn accuracy(path: &Path) -> Result<(), Box<dyn Error>> {
    let shape: AnyShape = "discocyte".parse()?;
    let io::MeshFile {
        mesh, positions, ..
    } = io::read(path)?;
    let surface = Surface::new(&mesh, &positions)?;
    let mut angle = f64::INFINITY;
    for triangle in 0..mesh.triangles().len() {
        let angles = surface.triangle_angles(triangle);
        angle = angles.into_iter().fold(angle, f64::min);
    }
    let mut workspace = Jet::j6().workspace(&mesh);
    let mut found = vec![Curvature::default(); positions.len()];
    Jet::j6().curvatures(&Parallel::new(), surface, &mut workspace, &mut found);
    let (mut error, mut distance, mut largest) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (&[x, y, z], curvature) in positions.iter().zip(&found) {
        // Preimages have x and y of the surface, and z over half of the thickness there.
        let mut preimage = [x, y, (1.0 - x * x - y * y).max(1e-6).sqrt().copysign(z)];
        let mut exact = helfrich::shapes::Shape::at(&shape, preimage);
        for _ in 0..4 {
            let length = preimage.iter().map(|x| x * x).sum::<f64>().sqrt();
            exact = helfrich::shapes::Shape::at(&shape, preimage.map(|x| x / length));
            if exact.position[2] != 0.0 {
                preimage[2] *= z / (exact.position[2] * length);
            }
        }
        let [a, b, c] = exact.position;
        distance = distance.max((x - a).hypot(y - b).hypot(z - c));
        error = error.max((curvature.mean - exact.mean).abs());
        largest = largest.max(exact.mean.abs());
    }
    println!(
        "{} {} {} {distance}",
        positions.len(),
        angle.to_degrees(),
        error / largest
    );
    Ok(())
}
