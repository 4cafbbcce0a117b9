//! Every bending method on every hard surface.

use super::specimen::{self, Specimen, SpecimenError};
use super::{Bound, Evaluation, Group, Outcome, Row, StabilityError};
use helfrich::{Real, SurfaceError, TriangleMesh};
use helfrich_std::method::BendingMethod::{
    self, Belkin, Farutin, Galerkin, GompperKroll, Hamann, J4, J6, Juelicher, KantorNelson, Loop,
    Meyer,
};
use helfrich_std::method::{Evaluated, Evaluator, Fields};
use helfrich_std::scalar::{HeldPositions, Scalar};
use std::collections::HashMap;

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
/// those in thin triangles. The limit surface of method S depends on two rings more; the jets of method G all have
/// a thin triangle among their neighbours on this mesh, and are reported everywhere.
fn slivers(method: BendingMethod, [flagged, by_loop]: [f64; 2]) -> Bound {
    match method {
        J4 | J6 => near(GROWTH * clean(method), 0.0),
        Galerkin => Bound::Reported,
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
        J4 | J6 | Belkin | Hamann => near(error, 0.0),
        _ => near(error, 0.06),
    }
}

/// Four in five vertices are in thin triangles or have three neighbours. Errors are bounded as on the irregular
/// mesh; with three neighbours nothing that G and S need is regular.
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
        Galerkin => near(1.0, 1.0),
        // Vertices on circles of latitude lie in rows.
        J4 | J6 => near(most, 0.07),
        Belkin | Hamann => near(most, 0.0),
        Farutin => near(most, 0.1),
        _ => near(most, 0.82),
    }
}

/// Where f is not known. The patches of G are reported as unresolved wherever normals of neighbours differ by
/// 10⁻³, which they do on all of these surfaces.
fn finite(method: BendingMethod, flagged: f64) -> Bound {
    Bound::Finite {
        flagged: if method == Galerkin { 1.0 } else { flagged },
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
///
/// The patches of Galerkin's method are stiffer at the scale of edges than the lattice: up to 14 (π/h)⁴ on
/// a plane instead of 36/h⁴ = 0.37 (π/h)⁴, for waves that few vertices take part in. Twice the bound of the
/// lattice holds on this mesh.
fn noisy(method: BendingMethod, edges: f64) -> Bound {
    const DEVIATIONS: f64 = 3.2;
    let [mean, shortest]: [f64; 2] = [0.12, 0.08];
    let deviation = 21.7 * mean / shortest.powi(4);
    let stiffness = match method {
        Galerkin => 2.0,
        _ => 1.0,
    };
    // Noise is the same everywhere: it is found, and then all vertices are flagged, or not.
    near(
        clean(method) + stiffness * DEVIATIONS * deviation / 52.0 * edges,
        1.0,
    )
}

fn is_single(scalar: Scalar) -> bool {
    scalar != Scalar::F64
}

const CASES: &[Case] = &[
    Case {
        name: "clean",
        meaning: "A relaxed mesh of 642 vertices on an ellipsoid, with which most other \
                  cases are compared.",
        specimen: |_| specimen::clean(),
        bound: |method, _| undisturbed(method),
    },
    Case {
        name: "irregular",
        meaning: "Well-spaced random points on the same ellipsoid, with valences of 3 to \
                  10. Methods that are not consistent on irregular meshes have large, \
                  bounded errors.",
        specimen: |_| specimen::irregular(),
        bound: irregular,
    },
    Case {
        name: "needles",
        meaning: "Some vertices are almost at a neighbour: angles of 0.01°.",
        specimen: |_| specimen::needles(1.75e-4),
        bound: needles,
    },
    Case {
        name: "caps",
        meaning: "Some triples of vertices are close together and almost collinear: angles \
                  of 179.98°.",
        specimen: |_| specimen::caps(),
        bound: |method, _| match method {
            // Three vertices on a line are a row of the fits around them.
            J4 => near(GROWTH * clean(method), 0.24),
            J6 => near(GROWTH * clean(method), 0.15),
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
        meaning: "At some vertices all triangles are obtuse at a neighbour, so that \
                  Voronoi areas are negative.",
        specimen: |_| specimen::obtuse_fans(),
        bound: |method, _| slivers(method, [0.3, 0.84]),
    },
    Case {
        name: "coincident vertices",
        meaning: "Some vertices are exactly at a neighbour: triangles without area.",
        specimen: |_| specimen::needles(0.0),
        bound: needles,
    },
    Case {
        name: "nearly coincident vertices",
        meaning: "Some vertices are 1e-12 edge lengths from a neighbour (1e-6 in f32).",
        specimen: |scalar| specimen::needles(if is_single(scalar) { 1e-6 } else { 1e-12 }),
        bound: needles,
    },
    Case {
        name: "valence 3 to 20",
        meaning: "Poles with twenty neighbours, and vertices with three neighbours between \
                  them.",
        specimen: |_| specimen::valences(),
        bound: valences,
    },
    Case {
        name: "four vertices",
        meaning: "A tetrahedron. Fits that need more than three neighbours report it.",
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
        meaning: "A red blood cell whose dimples are 0.002 R apart: the two sheets must not influence each other.",
        specimen: |_| specimen::disc(0.002),
        bound: |method, _| match method {
            // Edges of 0.13 R resolve neither the rim nor the dimples well.
            KantorNelson => near(2.0, 0.0),
            Galerkin => near(0.1, 0.6),
            J4 | J6 => near(0.5, 0.0),
            _ => near(1.0, 0.0),
        },
    },
    Case {
        name: "cusp",
        meaning: "A drop with a cusp at one vertex.",
        specimen: |_| specimen::cusp(),
        bound: |method, _| finite(method, 0.4),
    },
    Case {
        name: "genus 1",
        meaning: "A torus.",
        specimen: |_| specimen::torus(642),
        bound: |method, _| match method {
            // Another energy: its f is not that of bending.
            KantorNelson => near(1.0, 0.0),
            Galerkin => near(0.02, 0.36),
            Hamann => near(0.2, 0.0),
            _ => near(0.1, 0.0),
        },
    },
    Case {
        name: "genus 2",
        meaning: "A plate with two holes.",
        specimen: |_| specimen::plate(2),
        bound: |method, _| finite(method, 0.1),
    },
    Case {
        name: "genus 3",
        meaning: "A plate with three holes.",
        specimen: |_| specimen::plate(3),
        bound: |method, _| finite(method, 0.1),
    },
    Case {
        name: "noise of 1e-5 edges",
        meaning: "A random error of 1e-5 mean edges in every coordinate, compared with the \
                  exact surface.",
        specimen: |_| specimen::noisy(1e-5),
        bound: |method, _| noisy(method, 1e-5),
    },
    Case {
        name: "noise of 1e-4 edges",
        meaning: "A random error of 1e-4 mean edges in every coordinate, compared with the \
                  exact surface.",
        specimen: |_| specimen::noisy(1e-4),
        bound: |method, _| noisy(method, 1e-4),
    },
    Case {
        name: "noise of 1e-3 edges",
        meaning: "A random error of 1e-3 mean edges in every coordinate, compared with the \
                  exact surface.",
        specimen: |_| specimen::noisy(1e-3),
        bound: |method, _| noisy(method, 1e-3),
    },
    Case {
        name: "noise of 1e-2 edges",
        meaning: "A random error of 1e-2 mean edges in every coordinate, compared with the \
                  exact surface.",
        specimen: |_| specimen::noisy(1e-2),
        bound: |method, _| noisy(method, 1e-2),
    },
    Case {
        name: "crumpled",
        meaning: "Every vertex is displaced at random by up to half an edge.",
        specimen: |_| specimen::crumpled(0.5),
        bound: |_, _| Bound::Reported,
    },
    Case {
        name: "inverted",
        meaning: "Every vertex is displaced at random by up to two edges, so that \
                  triangles are inside out.",
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
            specimens.insert(scalar, (case.specimen)(scalar).map_err(made)?);
        }
        for method in BendingMethod::ALL {
            for scalar in Scalar::ALL {
                tell(rows.len(), &format!("{}: {method} {scalar}", case.name));
                let trial = Trial {
                    specimen: &specimens[&scalar],
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

/// One method on one surface in one number type.
#[derive(Clone, Copy)]
struct Trial<'a> {
    specimen: &'a Specimen,
    method: BendingMethod,
    scalar: Scalar,
    /// Whether the surface is also evaluated after a translation and a scaling.
    invariance: bool,
}

impl Trial<'_> {
    fn outcome(self) -> Outcome {
        let outcome = match self.scalar {
            Scalar::F32 | Scalar::F32Pair => self.evaluate::<f32>(),
            Scalar::F64 => self.evaluate::<f64>(),
        };
        outcome.map_or_else(
            |error| Outcome::Refused(error.to_string()),
            Outcome::Evaluated,
        )
    }

    fn evaluate<T: Evaluated>(self) -> Result<Evaluation, SurfaceError> {
        let Specimen {
            mesh,
            scale,
            offset,
            ..
        } = self.specimen;
        let mut evaluator = Evaluator::<T>::new(self.method, T::one(), mesh);
        let held = self.held(|x| scale * (x + offset));
        let surface = held.surface(mesh)?;
        let fields = evaluator.fields(surface);
        let quality = evaluator.quality(surface);
        let energy = evaluator.energy(surface);
        let errors = self.errors(&fields);
        let error = largest(errors.iter().copied());
        let flags = quality.flagged();
        let flagged = flags.iter().filter(|flagged| **flagged).count();
        let counts = |vertex: usize| !flags[vertex] || flagged == flags.len();
        let unflagged = errors.iter().zip(flags);
        let unflagged = unflagged.filter(|(_, flagged)| !**flagged);
        let unflagged = largest(unflagged.map(|(&error, _)| error));
        let [mut moved, mut scaled] = [None, None];
        if self.invariance {
            scaled = Some(self.scaled(&mut evaluator, mesh, &fields)?);
            if (*scale, *offset) == (1.0, 0.0) {
                moved = Some(self.moved(&mut evaluator, mesh)?);
            }
        }
        let known = !errors.is_empty();
        Ok(Evaluation {
            finite: is_finite(&fields) && energy.is_finite(),
            error: known.then_some(error),
            unflagged_error: (known && flagged < flags.len()).then_some(unflagged),
            slope: known.then(|| self.slope(&fields, counts)),
            moved,
            scaled,
            findings: quality.findings().len(),
            flagged,
            vertices: flags.len(),
            checksum: checksum(&fields),
        })
    }

    /// Positions with `map` applied to each coordinate, in the number type.
    fn held<T: Real>(self, map: impl Fn(f64) -> f64) -> HeldPositions<T> {
        let positions = self.specimen.positions.iter().map(|x| x.map(&map));
        HeldPositions::new(self.scalar, &Vec::from_iter(positions))
    }

    /// |f − exact f| at each vertex, relative to the largest |exact f|. A vertex without a value has the whole
    /// exact f as its error. Empty if f is not known exactly.
    fn errors<T: Real>(self, fields: &Fields<T>) -> Vec<f64> {
        let exact = &self.specimen.exact;
        let scale = exact.iter().map(|point| point.force_density(1.0).abs());
        let scale = scale.fold(0.0, f64::max);
        // κ/L³ at the size L of the surface.
        let unit = self.specimen.scale.powi(3);
        let error = |(found, point): (&Option<[T; 3]>, &helfrich::shapes::ExactPoint<f64>)| {
            let value = point.force_density(1.0);
            let found = found.unwrap_or([T::zero(); 3]).map(double);
            let part = |axis: usize| unit * found[axis] - value * point.normal[axis];
            let [x, y, z] = [part(0), part(1), part(2)];
            x.hypot(y).hypot(z) / scale
        };
        fields.force_density.iter().zip(exact).map(error).collect()
    }

    /// Σ A f_found·n f/Σ A f² over the vertices that count; a vertex without a value has none.
    fn slope<T: Real>(self, fields: &Fields<T>, counts: impl Fn(usize) -> bool) -> f64 {
        let unit = self.specimen.scale.powi(3);
        let (mut product, mut square) = (0.0, 0.0);
        for (vertex, point) in self.specimen.exact.iter().enumerate() {
            if !counts(vertex) {
                continue;
            }
            let (area, exact) = (double(fields.area[vertex]), point.force_density(1.0));
            let found = fields.force_density[vertex].unwrap_or([T::zero(); 3]);
            let along = (0..3).map(|axis| double(found[axis]) * point.normal[axis]);
            product += area * unit * along.sum::<f64>() * exact;
            square += area * exact * exact;
        }
        product / square
    }

    /// Change of f if positions are multiplied by a power of two, relative to exact scaling.
    fn scaled<T: Evaluated>(
        self,
        evaluator: &mut Evaluator<T>,
        mesh: &TriangleMesh,
        fields: &Fields<T>,
    ) -> Result<f64, SurfaceError> {
        let Specimen { scale, offset, .. } = self.specimen;
        // A small surface is enlarged, a large one reduced.
        let exponent = if is_single(self.scalar) { 20 } else { 40 };
        let factor = 2.0_f64.powi(if *scale > 1.0 { -exponent } else { exponent });
        let held = self.held(|x| factor * (scale * (x + offset)));
        let there = evaluator.fields(held.surface(mesh)?);
        Ok(defect(fields, &there, factor.powi(3)))
    }

    /// Change of f if positions on a grid are moved by a multiple of its pitch.
    fn moved<T: Evaluated>(
        self,
        evaluator: &mut Evaluator<T>,
        mesh: &TriangleMesh,
    ) -> Result<f64, SurfaceError> {
        let pitch = 2.0_f64.powi(if is_single(self.scalar) { -20 } else { -49 });
        let grid = |x: f64| (x / pitch).round() * pitch;
        let (here, there) = (self.held(grid), self.held(|x| grid(x) + 5.0));
        let here = evaluator.fields(here.surface(mesh)?);
        let there = evaluator.fields(there.surface(mesh)?);
        Ok(defect(&here, &there, 1.0))
    }
}

fn double<T: Real>(value: T) -> f64 {
    value.to_f64().unwrap_or(f64::NAN)
}

/// Largest of non-negative numbers; infinity if any is NaN.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| {
        if value.is_nan() {
            f64::INFINITY
        } else {
            most.max(value)
        }
    })
}

/// Largest deviation of f from `factor` times the other f, relative to the largest |f|.
fn defect<T: Real>(fields: &Fields<T>, other: &Fields<T>, factor: f64) -> f64 {
    let vectors = |fields: &Fields<T>| {
        let vector = |f: &Option<[T; 3]>| f.map(|f| f.map(double)).unwrap_or_default();
        Vec::from_iter(fields.force_density.iter().flat_map(vector))
    };
    let (here, there) = (vectors(fields), vectors(other));
    let pairs = here.iter().zip(&there);
    let most = largest(here.iter().map(|f| f.abs()));
    let change = largest(pairs.map(|(here, there)| (here - factor * there).abs()));
    if change == 0.0 { 0.0 } else { change / most }
}

/// Fowler, Noll and Vo's hash (FNV-1a) of the bits of f.
fn checksum<T: Real>(fields: &Fields<T>) -> u64 {
    let vectors = fields.force_density.iter().flatten().flatten();
    let bytes = vectors.flat_map(|&f| double(f).to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

fn is_finite<T: Real>(fields: &Fields<T>) -> bool {
    let Fields {
        area,
        normal,
        mean,
        gaussian,
        laplacian_of_mean,
        force_density,
    } = fields;
    let scalars = [mean, gaussian, laplacian_of_mean];
    let scalars = scalars.into_iter().flatten().flatten();
    let vectors = normal.iter().chain(force_density.iter().flatten());
    let mut all = scalars.chain(area).chain(vectors.flatten());
    all.all(|value| value.is_finite())
}
