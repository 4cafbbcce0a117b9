//! Every bending method on every hard surface.

mod trial;

use super::specimen::{self, Specimen, SpecimenError};
use super::{Bound, Group, Row, StabilityError};
use helfrich_std::method::BendingMethod::{
    self, Belkin, Farutin, Galerkin, GompperKroll, Hamann, J4, J6, J8, Juelicher, KantorNelson,
    Loop, Meyer,
};
use helfrich_std::scalar::Scalar;
use std::cell::OnceCell;
use std::collections::HashMap;
use trial::Trial;

/// A hard surface.
struct Case {
    name: &'static str,
    meaning: &'static str,
    specimen: fn(Scalar) -> Result<Specimen, SpecimenError>,
    bound: fn(BendingMethod, Scalar) -> Bound,
}

/// Bound on the largest error of f on the clean mesh, relative to the largest |f|.
///
/// No theory bounds the largest error of methods that do not converge at every vertex, and of the others it
/// bounds only the order. These bounds are at most 1.6 times the errors on this mesh: those of A, S, Jülicher
/// and Hamann, which diverge at vertices of valence 5, are larger than f itself, where only the slope shows the
/// sign.
fn clean(method: BendingMethod) -> f64 {
    match method {
        KantorNelson => 10.0,
        Juelicher | Hamann => 5.0,
        Loop => 2.0,
        GompperKroll | Meyer | Belkin => 0.4,
        Farutin => 0.15,
        _ => 0.02,
    }
}

/// Largest deviation of the slope from 1 on the clean mesh. Edges of 0.12 are a third of the smallest radius of
/// curvature, 0.36, so a method of second order is off by some tenth.
const CLEAN_SLOPE: f64 = 0.2;

/// On other meshes. With the wrong sign a slope of 0.25 or more deviates by 1.25 or more.
const SLOPE: f64 = 0.75;

/// Factor by which the error of a stable method may grow, and the error of other methods at vertices that are
/// not flagged.
const GROWTH: f64 = 10.0;

fn near(error: f64, flagged: f64) -> Bound {
    Bound::Near {
        error,
        slope: SLOPE,
        flagged,
    }
}

fn undisturbed(method: BendingMethod) -> Bound {
    Bound::Near {
        error: clean(method),
        slope: CLEAN_SLOPE,
        flagged: 0.0,
    }
}

/// Jets are stable; other methods report where they are not: at most in this part of the vertices, which are
/// those in thin triangles. The limit surface of method S depends on two rings more. H and f of method G are those
/// of jets, of degree 4 on these meshes.
fn slivers(method: BendingMethod, [flagged, by_loop]: [f64; 2]) -> Bound {
    match method {
        Galerkin | J4 | J6 | J8 => near(GROWTH * clean(method), 0.0),
        Loop => near(GROWTH * clean(method), by_loop),
        _ => near(GROWTH * clean(method), flagged),
    }
}

/// At each of the twelve places, the moved vertex and the twelve corners of the thin triangles and their
/// neighbours are flagged: 0.27 of all.
fn needles(method: BendingMethod, _scalar: Scalar) -> Bound {
    slivers(method, [0.27, 0.8])
}

/// No theory bounds the largest error of methods that do not converge on irregular meshes, because it depends
/// on the worst vertex. These bounds are at most twice the errors on this mesh, at vertices that are not
/// flagged. They record the errors, and show how large they are on a mesh that looks good. Jets lose at most
/// one order of the edge length, which is an eighth.
fn irregular(method: BendingMethod, _scalar: Scalar) -> Bound {
    let error = match method {
        // The gradient of mixed areas jumps at right angles.
        KantorNelson | GompperKroll | Meyer | Juelicher => 350.0,
        Loop => 3e4,
        Hamann => 1.5e3,
        Farutin => 15.0,
        Belkin => 6.0,
        _ => 0.2,
    };
    match method {
        // An error of 190 times the largest f leaves no slope.
        KantorNelson => Bound::Near {
            error,
            slope: f64::INFINITY,
            flagged: 0.06,
        },
        Loop => near(error, 0.3),
        Galerkin | J4 | J6 | J8 | Belkin | Hamann => near(error, 0.0),
        _ => near(error, 0.06),
    }
}

/// Four in five vertices are in thin triangles or have three neighbours. Errors are bounded as on the irregular
/// mesh; with three neighbours nothing that S needs is regular.
fn valences(method: BendingMethod, scalar: Scalar) -> Bound {
    let most = match irregular(method, scalar) {
        Bound::Near { error, .. } => error,
        _ => f64::INFINITY,
    };
    match method {
        KantorNelson => Bound::Near {
            error: most,
            slope: f64::INFINITY,
            flagged: 0.82,
        },
        Loop => near(most, 1.0),
        // Vertices on circles of latitude lie in rows.
        Galerkin | J4 | J6 | J8 => near(most, 0.07),
        Belkin | Hamann => near(most, 0.0),
        Farutin => near(most, 0.1),
        _ => near(most, 0.82),
    }
}

/// Noise of `edges` mean edge lengths in every coordinate adds at most this to the largest error of f, relative
/// to the largest |f|, for any method.
///
/// A normal displacement w of a plane makes f = κ Δ²w. On an even lattice with edges h, the Laplacian of the
/// six neighbours has weights of 2/(3h²), and Δ² has the square of 2/(3h²) times 42 in the middle, and −10, 1
/// and 2 six times each. Independent displacements with the standard deviation δ give f the deviation
/// √(42² + 6 · 105) (2/3)² κ δ/h⁴ = 21.7 κ δ/h⁴, and the largest of 642 is 3.2 deviations. Edges of the mesh
/// are 0.12 long on average, the shortest, where f is largest, 0.08; the largest |f| is 52 κ.
fn noisy(method: BendingMethod, edges: f64) -> Bound {
    const DEVIATIONS: f64 = 3.2;
    let [mean, shortest]: [f64; 2] = [0.12, 0.08];
    let deviation = 21.7 * mean / shortest.powi(4);
    // Noise is the same everywhere: it is found, and then all vertices are flagged, or not.
    near(clean(method) + DEVIATIONS * deviation / 52.0 * edges, 1.0)
}

/// Around holes and at rims, jets of degree 8 have too few neighbours, and say so.
fn plate(method: BendingMethod) -> Bound {
    Bound::Finite {
        flagged: if method == J8 { 0.45 } else { 0.1 },
    }
}

fn is_single(scalar: Scalar) -> bool {
    scalar != Scalar::F64
}

const CASES: &[Case] = &[
    Case {
        name: "clean",
        meaning: "A relaxed mesh of 642 vertices on an ellipsoid.",
        specimen: |_| specimen::clean(),
        bound: |method, _| undisturbed(method),
    },
    Case {
        name: "irregular",
        meaning: "Random points on the same ellipsoid, with valences of 3 to 10.",
        specimen: |_| specimen::irregular(),
        bound: irregular,
    },
    Case {
        name: "needles",
        meaning: "Some vertices almost at a neighbour: angles of 0.01°.",
        specimen: |_| specimen::needles(1.75e-4),
        bound: needles,
    },
    Case {
        name: "caps",
        meaning: "Close and almost collinear triples of vertices: angles of 179.98°.",
        specimen: |_| specimen::caps(),
        bound: |method, _| match method {
            // Three vertices on a line are a row of the fits around them.
            Galerkin | J4 => near(GROWTH * clean(method), 0.24),
            J6 | J8 => near(GROWTH * clean(method), 0.15),
            _ => slivers(method, [0.45, 0.96]),
        },
    },
    Case {
        name: "tiny needles",
        meaning: "The needles on a surface of size 1e-12 (1e-6 in f32).",
        specimen: |scalar| {
            let scale = if is_single(scalar) { 1e-6 } else { 1e-12 };
            Ok(specimen::needles(1.75e-4)?.scaled(scale))
        },
        bound: needles,
    },
    Case {
        name: "obtuse fans",
        meaning: "Triangles around some vertices are obtuse: negative Voronoi areas.",
        specimen: |_| specimen::obtuse_fans(),
        bound: |method, _| slivers(method, [0.3, 0.84]),
    },
    Case {
        name: "coincident vertices",
        meaning: "Some vertices exactly at a neighbour.",
        specimen: |_| specimen::needles(0.0),
        bound: needles,
    },
    Case {
        name: "nearly coincident vertices",
        meaning: "Some vertices 1e-12 edges from a neighbour (1e-6 in f32).",
        specimen: |scalar| specimen::needles(if is_single(scalar) { 1e-6 } else { 1e-12 }),
        bound: needles,
    },
    Case {
        name: "valence 3 to 20",
        meaning: "Poles with twenty neighbours, and vertices with three.",
        specimen: |_| specimen::valences(),
        bound: valences,
    },
    Case {
        name: "four vertices",
        meaning: "A tetrahedron.",
        specimen: |_| specimen::four_vertices(),
        bound: |method, _| match method {
            Belkin | Hamann => Bound::Finite { flagged: 0.0 },
            _ => Bound::Reported,
        },
    },
    Case {
        name: "small",
        meaning: "The clean surface at size 1e-12 (1e-6 in f32).",
        specimen: |scalar| {
            let scale = if is_single(scalar) { 1e-6 } else { 1e-12 };
            Ok(specimen::clean()?.scaled(scale))
        },
        bound: |method, _| undisturbed(method),
    },
    Case {
        name: "large",
        meaning: "The clean surface at size 1e12 (1e6 in f32).",
        specimen: |scalar| {
            let scale = if is_single(scalar) { 1e6 } else { 1e12 };
            Ok(specimen::clean()?.scaled(scale))
        },
        bound: |method, _| undisturbed(method),
    },
    Case {
        name: "far away",
        meaning: "The clean surface 1e8 radii from the origin (1e4 in f32): positions are rounded.",
        specimen: |scalar| {
            let offset = if is_single(scalar) { 1e4 } else { 1e8 };
            Ok(specimen::clean()?.moved(offset))
        },
        bound: |method, scalar| match scalar {
            // Coordinates near 1e4 are multiples of 2⁻¹⁰; rounding to them has a standard deviation of
            // 2⁻¹⁰/√12, or 2.3e-3 edges.
            Scalar::F32 => noisy(method, 2.3e-3),
            Scalar::F32Pair | Scalar::F64 => undisturbed(method),
        },
    },
    Case {
        name: "sheets nearly touching",
        meaning: "A red blood cell whose dimples are 0.002 R apart.",
        specimen: |_| specimen::disc(0.002),
        bound: |method, _| match method {
            // Edges of 0.13 R resolve neither the rim nor the dimples well, jets of degree 8 least of all, which flag a quarter of it.
            KantorNelson => near(2.0, 0.0),
            Galerkin | J4 => near(0.5, 0.0),
            J6 => near(0.6, 0.0),
            J8 => near(0.7, 0.3),
            _ => near(1.0, 0.0),
        },
    },
    Case {
        name: "cusp",
        meaning: "A drop with a cusp at one vertex.",
        specimen: |_| specimen::cusp(),
        bound: |_, _| Bound::Finite { flagged: 0.4 },
    },
    Case {
        name: "genus 1",
        meaning: "A torus.",
        specimen: |_| specimen::torus(642),
        bound: |method, _| match method {
            // Another energy: its f is not that of bending.
            KantorNelson => near(1.0, 0.0),
            // Fits of degree 8 have a sixth of the vertices of this mesh.
            Hamann | J8 => near(0.2, 0.0),
            _ => near(0.1, 0.0),
        },
    },
    Case {
        name: "genus 2",
        meaning: "A plate with two holes.",
        specimen: |_| specimen::plate(2),
        bound: |method, _| plate(method),
    },
    Case {
        name: "genus 3",
        meaning: "A plate with three holes.",
        specimen: |_| specimen::plate(3),
        bound: |method, _| plate(method),
    },
    Case {
        name: "noise of 1e-5 edges",
        meaning: "Random errors of every coordinate, in mean edges.",
        specimen: |_| specimen::noisy(1e-5),
        bound: |method, _| noisy(method, 1e-5),
    },
    Case {
        name: "noise of 1e-4 edges",
        meaning: "The same.",
        specimen: |_| specimen::noisy(1e-4),
        bound: |method, _| noisy(method, 1e-4),
    },
    Case {
        name: "noise of 1e-3 edges",
        meaning: "The same.",
        specimen: |_| specimen::noisy(1e-3),
        bound: |method, _| noisy(method, 1e-3),
    },
    Case {
        name: "noise of 1e-2 edges",
        meaning: "The same.",
        specimen: |_| specimen::noisy(1e-2),
        bound: |method, _| noisy(method, 1e-2),
    },
    Case {
        name: "crumpled",
        meaning: "Every vertex displaced at random by up to half an edge.",
        specimen: |_| specimen::crumpled(0.5),
        bound: |_, _| Bound::Reported,
    },
    Case {
        name: "inverted",
        meaning: "The same by up to two edges: triangles are inside out.",
        specimen: |_| specimen::crumpled(2.0),
        bound: |_, _| Bound::Reported,
    },
];

/// The mesh of a million vertices, which takes minutes.
const LARGE: Case = Case {
    name: "a million vertices",
    meaning: "A torus of 1e6 vertices; in f32 its positions have too few digits, and all are flagged.",
    specimen: |_| specimen::torus(1_000_000),
    bound: |_, scalar| match scalar {
        Scalar::F32 => Bound::Reported,
        Scalar::F32Pair | Scalar::F64 => Bound::Finite { flagged: 1.0 },
    },
};

/// The number of rows.
pub(super) fn count(large: bool) -> usize {
    (CASES.len() + usize::from(large)) * BendingMethod::ALL.len() * Scalar::ALL.len()
}

/// Evaluates every case with every method and number type; `tell` receives the number of earlier rows.
pub(super) fn rows(
    large: bool,
    tell: &mut dyn FnMut(usize, &str),
) -> Result<Vec<Row>, StabilityError> {
    let cases = CASES.iter().chain(large.then_some(&LARGE));
    let mut rows = Vec::new();
    for case in cases {
        let made = |source: SpecimenError| StabilityError {
            case: case.name,
            source: source.into(),
        };
        let mut specimens = HashMap::new();
        for scalar in Scalar::ALL {
            let specimen = (case.specimen)(scalar).map_err(made)?;
            specimens.insert(scalar, (specimen, OnceCell::new()));
        }
        for method in BendingMethod::ALL {
            for scalar in Scalar::ALL {
                tell(rows.len(), &format!("{}: {method} {scalar}", case.name));
                let (specimen, noisy) = &specimens[&scalar];
                let trial = Trial {
                    specimen,
                    noisy,
                    method,
                    scalar,
                    invariance: case.name != LARGE.name,
                };
                rows.push(Row::new(
                    Group::Geometry,
                    (case.name, case.meaning),
                    (method.name(), scalar),
                    trial.outcome(),
                    (case.bound)(method, scalar),
                ));
            }
        }
    }
    Ok(rows)
}
