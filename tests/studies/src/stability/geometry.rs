//! Every bending method on every hard surface.

use super::specimen::{self, Specimen, SpecimenError};
use super::{Bound, Evaluation, Group, Outcome, Row, StabilityError};
use helfrich::{Real, SurfaceError, TriangleMesh};
use helfrich_std::method::{BendingMethod, Evaluated, Evaluator, Fields};
use helfrich_std::scalar::{HeldPositions, Scalar};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// A hard surface.
struct Case {
    name: &'static str,
    meaning: &'static str,
    specimen: fn(Scalar) -> Result<Specimen, SpecimenError>,
    /// Clean mesh with which the error is compared.
    clean: Option<Clean>,
    bound: fn(BendingMethod, Scalar) -> Bound,
}

/// A surface without difficulties.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Clean {
    Ellipsoid,
    Irregular,
    Disc,
}

impl Clean {
    fn specimen(self) -> Result<Specimen, SpecimenError> {
        match self {
            Self::Ellipsoid => specimen::clean(),
            Self::Irregular => specimen::irregular(),
            Self::Disc => specimen::disc(0.207161),
        }
    }
}

/// Factor by which the error of a stable method may grow, and the error of other methods at vertices that are
/// not flagged.
const GROWTH: f64 = 10.0;

fn is_jet(method: BendingMethod) -> bool {
    matches!(method, BendingMethod::J4 | BendingMethod::J6)
}

/// Jets are stable; other methods report where they are not.
fn slivers(method: BendingMethod, _scalar: Scalar) -> Bound {
    if is_jet(method) {
        Bound::Stable(GROWTH)
    } else {
        Bound::Reported(GROWTH)
    }
}

fn stable(_method: BendingMethod, _scalar: Scalar) -> Bound {
    Bound::Stable(GROWTH)
}

fn reported(_method: BendingMethod, _scalar: Scalar) -> Bound {
    Bound::Reported(GROWTH)
}

/// No theory bounds the largest error of methods that do not converge on irregular meshes, because it depends
/// on the worst vertex. These bounds are two to three times the errors on this mesh. They record the errors,
/// and show how large they are on a mesh that looks good. Jets lose at most one order of the edge length,
/// which is an eighth.
fn irregular(method: BendingMethod, _scalar: Scalar) -> Bound {
    Bound::Stable(match method {
        // The gradient of mixed areas jumps at right angles.
        BendingMethod::Meyer | BendingMethod::GompperKroll => 3e3,
        BendingMethod::Loop => 3e4,
        BendingMethod::Belkin => 60.0,
        BendingMethod::J4 | BendingMethod::J6 | BendingMethod::Jet => 25.0,
        _ => 300.0,
    })
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
        BendingMethod::Galerkin => 2.0,
        _ => 1.0,
    };
    Bound::Adds(stiffness * DEVIATIONS * deviation / 52.0 * edges)
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
        clean: Some(Clean::Ellipsoid),
        bound: stable,
    },
    Case {
        name: "irregular",
        meaning: "Well-spaced random points on the same ellipsoid, with valences of 3 to \
                  10. Methods that are not consistent on irregular meshes have large, \
                  bounded errors.",
        specimen: |_| specimen::irregular(),
        clean: Some(Clean::Ellipsoid),
        bound: irregular,
    },
    Case {
        name: "needles",
        meaning: "Some vertices are almost at a neighbour: angles of 0.01°.",
        specimen: |_| specimen::needles(1.75e-4),
        clean: Some(Clean::Ellipsoid),
        bound: slivers,
    },
    Case {
        name: "caps",
        meaning: "Some triples of vertices are close together and almost collinear: angles \
                  of 179.98°.",
        specimen: |_| specimen::caps(),
        clean: Some(Clean::Ellipsoid),
        bound: slivers,
    },
    Case {
        name: "tiny needles",
        meaning: "The needles on a surface of size 1e-12 (1e-6 in f32).",
        specimen: |scalar| {
            let scale = if is_single(scalar) { 1e-6 } else { 1e-12 };
            Ok(specimen::needles(1.75e-4)?.scaled(scale))
        },
        clean: Some(Clean::Ellipsoid),
        bound: slivers,
    },
    Case {
        name: "obtuse fans",
        meaning: "At some vertices all triangles are obtuse at a neighbour, so that \
                  Voronoi areas are negative; compared with the irregular mesh.",
        specimen: |_| specimen::obtuse_fans(),
        clean: Some(Clean::Irregular),
        bound: slivers,
    },
    Case {
        name: "coincident vertices",
        meaning: "Some vertices are exactly at a neighbour: triangles without area.",
        specimen: |_| specimen::needles(0.0),
        clean: Some(Clean::Ellipsoid),
        bound: slivers,
    },
    Case {
        name: "nearly coincident vertices",
        meaning: "Some vertices are 1e-12 edge lengths from a neighbour (1e-6 in f32).",
        specimen: |scalar| specimen::needles(if is_single(scalar) { 1e-6 } else { 1e-12 }),
        clean: Some(Clean::Ellipsoid),
        bound: slivers,
    },
    Case {
        name: "valence 3 to 20",
        meaning: "Poles with twenty neighbours, and vertices with three neighbours between \
                  them; compared with the irregular mesh.",
        specimen: |_| specimen::valences(),
        clean: Some(Clean::Irregular),
        bound: slivers,
    },
    Case {
        name: "four vertices",
        meaning: "A tetrahedron. Fits that need more than three neighbours report it.",
        specimen: |_| specimen::four_vertices(),
        clean: None,
        bound: |method, _| match method {
            BendingMethod::Farutin | BendingMethod::J4 | BendingMethod::J6 => {
                Bound::Reported(GROWTH)
            }
            _ => Bound::Stable(GROWTH),
        },
    },
    Case {
        name: "small",
        meaning: "The clean surface at size 1e-12 (1e-6 in f32).",
        specimen: |scalar| {
            let scale = if is_single(scalar) { 1e-6 } else { 1e-12 };
            Ok(specimen::clean()?.scaled(scale))
        },
        clean: Some(Clean::Ellipsoid),
        bound: |_, _| Bound::Stable(1.1),
    },
    Case {
        name: "large",
        meaning: "The clean surface at size 1e12 (1e6 in f32).",
        specimen: |scalar| {
            let scale = if is_single(scalar) { 1e6 } else { 1e12 };
            Ok(specimen::clean()?.scaled(scale))
        },
        clean: Some(Clean::Ellipsoid),
        bound: |_, _| Bound::Stable(1.1),
    },
    Case {
        name: "far away",
        meaning: "The clean surface 1e8 radii from the origin (1e4 in f32): positions are rounded.",
        specimen: |scalar| {
            let offset = if is_single(scalar) { 1e4 } else { 1e8 };
            Ok(specimen::clean()?.moved(offset))
        },
        clean: Some(Clean::Ellipsoid),
        bound: |_, scalar| match scalar {
            Scalar::F32 => Bound::Reported(GROWTH),
            Scalar::F32Pair | Scalar::F64 => Bound::Stable(1.1),
        },
    },
    Case {
        name: "sheets nearly touching",
        meaning: "A red blood cell whose dimples are 0.002 R apart, compared with a normal \
                  one: the two sheets must not influence each other.",
        specimen: |_| specimen::disc(0.002),
        clean: Some(Clean::Disc),
        bound: stable,
    },
    Case {
        name: "cusp",
        meaning: "A drop with a cusp at one vertex.",
        specimen: |_| specimen::cusp(),
        clean: None,
        bound: stable,
    },
    Case {
        name: "genus 1",
        meaning: "A torus.",
        specimen: |_| specimen::torus(642),
        clean: None,
        bound: stable,
    },
    Case {
        name: "genus 2",
        meaning: "A plate with two holes.",
        specimen: |_| specimen::plate(2),
        clean: None,
        bound: stable,
    },
    Case {
        name: "genus 3",
        meaning: "A plate with three holes.",
        specimen: |_| specimen::plate(3),
        clean: None,
        bound: stable,
    },
    Case {
        name: "noise of 1e-5 edges",
        meaning: "A random error of 1e-5 mean edges in every coordinate, compared with the \
                  exact surface.",
        specimen: |_| specimen::noisy(1e-5),
        clean: Some(Clean::Ellipsoid),
        bound: |method, _| noisy(method, 1e-5),
    },
    Case {
        name: "noise of 1e-4 edges",
        meaning: "A random error of 1e-4 mean edges in every coordinate, compared with the \
                  exact surface.",
        specimen: |_| specimen::noisy(1e-4),
        clean: Some(Clean::Ellipsoid),
        bound: |method, _| noisy(method, 1e-4),
    },
    Case {
        name: "noise of 1e-3 edges",
        meaning: "A random error of 1e-3 mean edges in every coordinate, compared with the \
                  exact surface.",
        specimen: |_| specimen::noisy(1e-3),
        clean: Some(Clean::Ellipsoid),
        bound: |method, _| noisy(method, 1e-3),
    },
    Case {
        name: "noise of 1e-2 edges",
        meaning: "A random error of 1e-2 mean edges in every coordinate, compared with the \
                  exact surface.",
        specimen: |_| specimen::noisy(1e-2),
        clean: Some(Clean::Ellipsoid),
        bound: |method, _| noisy(method, 1e-2),
    },
    Case {
        name: "crumpled",
        meaning: "Every vertex is displaced at random by up to half an edge.",
        specimen: |_| specimen::crumpled(0.5),
        clean: None,
        bound: reported,
    },
    Case {
        name: "inverted",
        meaning: "Every vertex is displaced at random by up to two edges, so that \
                  triangles are inside out.",
        specimen: |_| specimen::crumpled(2.0),
        clean: None,
        bound: reported,
    },
];

/// The mesh of a million vertices, which takes minutes.
const LARGE: Case = Case {
    name: "a million vertices",
    meaning: "A torus of 1e6 vertices; in f32 its positions have too few digits, and all are flagged.",
    specimen: |_| specimen::torus(1_000_000),
    clean: None,
    bound: |_, scalar| match scalar {
        Scalar::F32 => Bound::Reported(GROWTH),
        Scalar::F32Pair | Scalar::F64 => Bound::Stable(GROWTH),
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
    let mut clean = CleanErrors::default();
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
                let clean = match case.clean {
                    Some(which) => Some(clean.of(which, method, scalar).map_err(made)?),
                    None => None,
                };
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
                    trial.outcome(clean),
                    (case.bound)(method, scalar),
                ));
            }
        }
    }
    Ok(rows)
}

/// Errors on clean surfaces, each computed once.
#[derive(Default)]
struct CleanErrors {
    specimens: HashMap<Clean, Specimen>,
    errors: HashMap<(Clean, BendingMethod, Scalar), f64>,
}

impl CleanErrors {
    fn of(
        &mut self,
        clean: Clean,
        method: BendingMethod,
        scalar: Scalar,
    ) -> Result<f64, SpecimenError> {
        if let Some(&error) = self.errors.get(&(clean, method, scalar)) {
            return Ok(error);
        }
        let specimen = match self.specimens.entry(clean) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(place) => place.insert(clean.specimen()?),
        };
        let trial = Trial {
            specimen,
            method,
            scalar,
            invariance: false,
        };
        let error = match trial.outcome(None) {
            Outcome::Evaluated(Evaluation {
                error: Some(error), ..
            }) => error,
            _ => f64::NAN,
        };
        self.errors.insert((clean, method, scalar), error);
        Ok(error)
    }
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
    fn outcome(self, clean: Option<f64>) -> Outcome {
        let outcome = match self.scalar {
            Scalar::F32 | Scalar::F32Pair => self.evaluate::<f32>(clean),
            Scalar::F64 => self.evaluate::<f64>(clean),
        };
        outcome.map_or_else(
            |error| Outcome::Refused(error.to_string()),
            Outcome::Evaluated,
        )
    }

    fn evaluate<T: Evaluated>(self, clean: Option<f64>) -> Result<Evaluation, SurfaceError> {
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
        let unflagged = errors.iter().zip(quality.flagged());
        let unflagged = unflagged.filter(|(_, flagged)| !**flagged);
        let unflagged = largest(unflagged.map(|(&error, _)| error));
        let [mut moved, mut scaled] = [None, None];
        if self.invariance {
            scaled = Some(self.scaled(&mut evaluator, mesh, &fields)?);
            if (*scale, *offset) == (1.0, 0.0) {
                moved = Some(self.moved(&mut evaluator, mesh)?);
            }
        }
        let flagged = quality.flagged().iter().filter(|flagged| **flagged).count();
        let known = !errors.is_empty();
        let over = |error: f64| clean.map(|clean| error / clean);
        Ok(Evaluation {
            finite: is_finite(&fields) && energy.is_finite(),
            error: known.then_some(error),
            growth: over(error).filter(|_| known),
            unflagged_growth: over(unflagged).filter(|_| known && flagged < errors.len()),
            moved,
            scaled,
            findings: quality.findings().len(),
            flagged,
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
