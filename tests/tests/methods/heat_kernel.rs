//! Method D: its known behaviour, including where it stalls and diverges.

use helfrich::laplacian::LaplaceBeltrami;
use helfrich::{Bandwidth, Curvature, Curvatures, HeatKernel, Method, Rows, Serial, StrongForm};
use helfrich_std::generate::{Family, GeneratedMesh, generate};
use helfrich_tests::accuracy::{StrongFormErrors, of_strong_form, surface};
use helfrich_tests::laws::{check_operator, findings_on_small_meshes};
use helfrich_tests::tolerance::{self, Tolerance};

/// Two entries of a symmetric matrix that are computed separately, relative to their value.
const SYMMETRY: Tolerance = Tolerance::new(
    1e-13,
    "products of a few factors, in another order; the exponential's argument is up to 36 and multiplies \
     its rounding by that",
);

fn made(family: Family, vertices: usize) -> GeneratedMesh {
    generate(&"discocyte".parse().unwrap(), family, vertices, 1).unwrap()
}

/// Bandwidth as published: the mixed area of each vertex.
fn published() -> HeatKernel<f64> {
    HeatKernel::new(Bandwidth::MixedArea(1.0))
}

fn on_discocyte(family: Family, vertices: usize) -> StrongFormErrors {
    of_strong_form(StrongForm::new(1.0, published()), &made(family, vertices))
}

#[test]
fn laws() {
    check_operator("heat kernel", HeatKernel::default());
    check_operator("heat kernel, published bandwidth", published());
    let narrow = HeatKernel::new(Bandwidth::MixedArea(0.25));
    check_operator("narrow heat kernel", narrow);
}

#[test]
fn tiny_and_open_meshes_give_finite_values() {
    findings_on_small_meshes(HeatKernel::default());
    findings_on_small_meshes(published());
}

/// With the published bandwidth nothing converges: f stalls on regular meshes, and grows on irregular ones.
#[test]
fn force_density_stalls_on_regular_and_diverges_on_irregular_meshes() {
    let found = [642, 2562, 10242].map(|n| on_discocyte(Family::Regular, n));
    for (found, expected) in found.iter().zip([0.92, 0.60, 0.29]) {
        let error = found.force_density.max;
        tolerance::PUBLISHED_ERROR.assert(error, expected, expected, "f on regular meshes");
    }
    // Once √h resolves the dimple, H is of order 1 and more.
    assert!(found[1].mean.max < 0.1 && found[2].mean.max < 0.4 * found[1].mean.max);
    let found = [642, 2562].map(|n| on_discocyte(Family::Irregular, n));
    assert!(found[1].force_density.max > 2.0 * found[0].force_density.max);
}

/// The two sides of the dimple are 0.2 R apart, within the kernel's range: if vertices were found by distance
/// in space, the error of H would be of the order of H.
#[test]
fn sheets_that_lie_close_together_are_not_coupled() {
    let made = made(Family::Regular, 2562);
    let surface = surface(&made);
    let operator = published();
    let mut workspace = operator.workspace(&made.mesh);
    let mut curvature = vec![Curvature::default(); made.mesh.vertex_count()];
    operator.curvatures(&Serial, surface, &mut workspace, &mut curvature);
    let mut rows = Rows::new();
    operator.assemble(surface, &workspace, &mut rows);
    let radius = |[x, y, _]: [f64; 3]| x.hypot(y);
    let mut across = 0;
    for (vertex, &x) in made.positions.iter().enumerate() {
        if radius(x) > 0.12 {
            continue;
        }
        let reach = 12.0 * curvature[vertex].area.sqrt();
        let others = made.positions.iter();
        across += others
            .filter(|y| y[2] * x[2] < 0.0 && reach > (y[2] - x[2]).abs())
            .count();
        let (columns, _) = rows.row(vertex);
        assert!(columns.len() > 200);
        let same_side = |&column: &u32| made.positions[column as usize][2] * x[2] > 0.0;
        assert!(columns.iter().all(same_side));
    }
    assert!(
        across > 100,
        "the test needs sheets within reach of each other"
    );
}

/// On irregular meshes, a bandwidth that shrinks more slowly than the triangles gives much smaller errors of
/// Δ_S H than one of a fixed number of triangles.
#[test]
fn a_wider_kernel_smooths_irregular_meshes() {
    let made = made(Family::Irregular, 2562);
    let area = surface(&made).area() / 2562.0;
    let wide = HeatKernel::new(Bandwidth::Global(2.0 * area));
    let wide = of_strong_form(StrongForm::new(1.0, wide), &made);
    let narrow = of_strong_form(StrongForm::new(1.0, published()), &made);
    assert!(wide.laplacian_of_mean.max < 0.2 * narrow.laplacian_of_mean.max);
}

/// With one bandwidth for all vertices, `A_i c_ij = A_j c_ji` with barycentric areas.
#[test]
fn a_global_bandwidth_gives_a_symmetric_operator() {
    let made = made(Family::Regular, 642);
    let surface = surface(&made);
    let operator = HeatKernel::new(Bandwidth::Global(surface.area() / 2568.0));
    let mut workspace = operator.workspace(&made.mesh);
    let mut curvature = vec![Curvature::default(); made.mesh.vertex_count()];
    operator.curvatures(&Serial, surface, &mut workspace, &mut curvature);
    let mut rows = Rows::new();
    operator.assemble(surface, &workspace, &mut rows);
    let mut areas = vec![0.0; made.mesh.vertex_count()];
    let barycentric = helfrich::Cotangent::new(helfrich::DualArea::Barycentric);
    barycentric.dual_areas(&Serial, surface, &mut areas);
    for row in 0..rows.len() {
        let (columns, coefficients) = rows.row(row);
        for (&column, &coefficient) in columns.iter().zip(coefficients) {
            let (back, others) = rows.row(column as usize);
            let place = back.iter().position(|&back| back as usize == row).unwrap();
            let (here, there) = (
                areas[row] * coefficient,
                areas[column as usize] * others[place],
            );
            SYMMETRY.assert(here, there, there, "A c");
        }
    }
}
