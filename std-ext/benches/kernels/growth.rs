//! How the cost of a vertex grows with their number.

use crate::Error;
use helfrich::{GompperKroll, Prepared, Reordering, Surface, TriangleMesh};
use helfrich_std::execute::Parallel;
use helfrich_std::generate::{Family, generate};
use std::time::Instant;

const ROUNDS: usize = 15;

/// Nanoseconds a vertex that B takes on a mesh: first quartile.
fn time(mesh: &TriangleMesh, positions: &[[f64; 3]]) -> Result<f64, Error> {
    let surface = Surface::new(mesh, positions)?;
    let mut force = vec![[0.0; 3]; positions.len()];
    let mut bending = Prepared::with_execution(GompperKroll::new(1.0), mesh, Parallel::single());
    bending.add_force_and_energy(surface, &mut force);
    let repeats = 20_000 / positions.len() + 1;
    let mut times = Vec::new();
    for _ in 0..ROUNDS {
        let start = Instant::now();
        for _ in 0..repeats {
            bending.add_force_and_energy(surface, &mut force);
        }
        times.push(start.elapsed().as_secs_f64() / repeats as f64);
    }
    times.sort_by(f64::total_cmp);
    Ok(1e9 * times[ROUNDS / 4] / positions.len() as f64)
}

/// As the generator numbers vertices, in no order at all, and in reverse Cuthill–McKee order.
pub(crate) fn print() -> Result<(), Error> {
    println!("\nB f64 on one thread, ns a vertex, and relative to 2562 vertices in order");
    println!(
        "{:>8}{:>10}{:>10}{:>10}{:>10}",
        "N", "as made", "shuffled", "ordered", "growth"
    );
    let mut first = None;
    for vertices in [2562, 40962, 163_842, 655_362] {
        let made = generate(&"discocyte".parse()?, Family::Regular, vertices, 1)?;
        let (mesh, positions) = shuffled(&made.mesh, &made.positions)?;
        let order = Reordering::reverse_cuthill_mckee(&mesh);
        let ordered = order.of_mesh(&mesh)?;
        let as_made = time(&made.mesh, &made.positions)?;
        let worst = time(&mesh, &positions)?;
        let best = time(&ordered, &order.apply(&positions))?;
        let growth = best / *first.get_or_insert(best);
        println!("{vertices:>8}{as_made:>10.1}{worst:>10.1}{best:>10.1}{growth:>10.2}");
    }
    Ok(())
}

fn shuffled(
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
) -> Result<(TriangleMesh, Vec<[f64; 3]>), Error> {
    let mut places: Vec<u32> = (0..positions.len() as u32).collect();
    // D. E. Knuth's linear congruential generator: any will do.
    let mut state = 1_u64;
    for last in (1..places.len()).rev() {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        places.swap(last, (state >> 33) as usize % (last + 1));
    }
    let mut moved = vec![[0.0; 3]; positions.len()];
    for (position, &place) in positions.iter().zip(&places) {
        moved[place as usize] = *position;
    }
    let triangles = mesh.triangles().iter();
    let triangles = triangles.map(|corners| corners.map(|vertex| places[vertex as usize]));
    Ok((
        TriangleMesh::new(positions.len(), triangles.collect())?,
        moved,
    ))
}
