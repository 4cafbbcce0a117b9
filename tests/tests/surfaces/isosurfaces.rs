//! Isosurfaces of grids: noise, thin triangles, holes, several components.

use crate::bars::assert_bars;
use helfrich::{AdaptiveJet, MeshError, Surface, TriangleMesh, Verdict};
use helfrich_std::method::{BendingMethod, Evaluator};
use helfrich_tests::isosurface::{marching_cubes, segmentation};
use std::time::Instant;

/// Every edge of a closed isosurface has two triangles, for any set of inner grid nodes.
#[test]
fn surfaces_in_noise_are_closed() {
    for seed in 0..4 {
        let mut random = helfrich_tests::meshes::SplitMix64::new(seed);
        let values = Vec::from_iter((0..512).map(|_| random.symmetric()));
        let (positions, triangles) = marching_cubes(9, |x| {
            if x.iter().any(|x| x.abs() > 0.99) {
                return -1.0;
            }
            let [i, j, k] = x.map(|x| ((x + 1.0) * 4.5).round() as usize - 1);
            values[i + 8 * (j + 8 * k)]
        });
        let mesh = TriangleMesh::new(positions.len(), triangles).expect("a surface");
        assert!(mesh.is_closed());
    }
    let (positions, triangles) = marching_cubes(20, |[x, y, z]| 0.7 - x.hypot(y).hypot(z));
    let mesh = TriangleMesh::new(positions.len(), triangles).expect("a surface");
    let surface = Surface::new(&mesh, &positions).expect("positions");
    let exact = 4.0 / 3.0 * std::f64::consts::PI * 0.343;
    let volume = surface.volume().expect("a closed surface");
    assert!((volume / exact - 1.0).abs() < 0.02, "{volume}");
}

/// Mesh without the triangles at vertices at which holes have left separate fans; `None` if no triangle
/// remains.
pub(crate) fn connected(vertices: usize, mut triangles: Vec<[u32; 3]>) -> Option<TriangleMesh> {
    loop {
        match TriangleMesh::new(vertices, triangles.clone()) {
            Ok(mesh) => return Some(mesh),
            Err(MeshError::Empty) => return None,
            Err(MeshError::NonManifoldVertex { vertex, .. }) => {
                triangles.retain(|corners| !corners.contains(&vertex));
            }
            Err(error) => panic!("{error}"),
        }
    }
}

/// Measures the surfaces of some seeds; prints the longest times per 10⁴ vertices.
fn measure_all(cells: usize, seeds: std::ops::Range<u64>) {
    let mut longest = [0.0_f64; 2];
    let [mut measured, mut told, mut vertices] = [0; 3];
    for seed in seeds {
        let (positions, triangles) = segmentation(cells, seed);
        let Some(mesh) = connected(positions.len(), triangles) else {
            continue;
        };
        measured += 1;
        let surface = Surface::new(&mesh, &positions).expect("positions");
        let per_ten_thousand = 1e4 / (positions.len() as f64).max(2e3);
        let start = Instant::now();
        let fields = Evaluator::new(BendingMethod::J6, 1.0, &mesh).fields(surface);
        longest[0] = longest[0].max(start.elapsed().as_secs_f64() * per_ten_thousand);
        let known = fields.mean.iter().flatten();
        assert!(known.clone().all(|mean| mean.is_finite()), "{seed}");
        let start = Instant::now();
        let jet = AdaptiveJet::default();
        let found = helfrich_std::noise::measured(&jet, surface, &mut |_| true);
        longest[1] = longest[1].max(start.elapsed().as_secs_f64() * per_ten_thousand);
        let found = found.expect("not interrupted");
        vertices += found.len();
        for (vertex, at) in found.iter().enumerate() {
            told += usize::from(at.verdict != Verdict::Unknown);
            assert!(at.mean.value.is_finite() || at.verdict == Verdict::Unknown);
            assert_bars(at, &format!("{seed}, {vertex}"));
        }
    }
    println!("{measured} measured, seconds for 10⁴ vertices {longest:?}");
    assert!(measured > 0);
    // Rough as they are, they are not given up.
    assert!(4 * told > vertices, "{told} of {vertices}");
}

/// No segmentation causes a panic or a value without an error bar.
#[test]
fn segmentations_are_measured() {
    measure_all(18, 0..12);
}

/// Prints times; the goals on an idle machine are 1 s for J6 and 10 s for the adaptive jet.
#[test]
#[ignore = "half an hour: by .ci/long"]
fn thousand_segmentations_are_measured() {
    measure_all(24, 0..1000);
}
