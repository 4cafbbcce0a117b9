//! The kernels.

use crate::counted::{Counted, Operations, operations};
use crate::measured::{Bound, Row, Table};
use crate::{Error, naive};
use helfrich::{
    Bandwidth, Conservative, DualArea, ForceDensity, GompperKroll, HeatKernel, InPlane, Juelicher,
    KantorNelson, LoopSubdivision, Method, NeoHookean, Prepared, Real, Skalak, StrongForm, Surface,
    TriangleMesh,
};
use helfrich_std::execute::Parallel;
use helfrich_std::flow::SingleLayer;
use helfrich_std::flow::lattice_boltzmann::{Lattice, LatticeError, Precision, Setup, Sides};
use helfrich_std::generate::{Family, generate};
use nalgebra::RealField;
use num_traits::One;
use std::hint::black_box;
use std::num::NonZeroUsize;

fn threads(count: usize) -> NonZeroUsize {
    NonZeroUsize::new(count).unwrap_or(NonZeroUsize::MIN)
}

fn parallel(count: usize) -> Parallel {
    Parallel {
        threads: threads(count),
    }
}

fn cast<T: Real>(positions: &[[f64; 3]]) -> Vec<[T; 3]> {
    positions.iter().map(|x| x.map(T::constant)).collect()
}

/// The common part of the rows of a number type.
struct Rows<'a, T> {
    scalar: &'a str,
    surface: Surface<'a, T>,
    /// The same surface in numbers that count.
    counted: Surface<'a, Counted>,
    table: &'a mut Table,
}

/// Every method in a number type.
pub(crate) fn of<T: Real + RealField + Copy>(
    scalar: &str,
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    table: &mut Table,
) -> Result<(), Error> {
    let (own, counted) = (cast::<T>(positions), cast::<Counted>(positions));
    let mut rows = Rows {
        scalar,
        surface: Surface::new(mesh, &own)?,
        counted: Surface::new(mesh, &counted)?,
        table,
    };
    let rings = naive::Rings::new(mesh);
    let one = T::one();
    let (surface, count) = (rows.surface, Counted::one());
    let mut force = vec![[T::zero(); 3]; own.len()];

    naive::squared_laplacian(&rings, &own, &mut force);
    let published = GompperKroll::with_areas(one, DualArea::Voronoi);
    check_force("B", surface, published.clone(), &force)?;
    let naive = &mut || _ = black_box(naive::squared_laplacian(&rings, &own, &mut force));
    let counting = GompperKroll::with_areas(count, DualArea::Voronoi);
    let methods = (|| published.clone(), counting);
    rows.conservative("B", methods, Some(naive));

    let mut force = vec![[T::zero(); 3]; own.len()];
    naive::dihedral(&rings, &own, &mut force);
    check_force("A", surface, KantorNelson::new(one), &force)?;
    let naive = &mut || _ = black_box(naive::dihedral(&rings, &own, &mut force));
    let methods = (|| KantorNelson::new(one), KantorNelson::new(count));
    rows.conservative("A", methods, Some(naive));

    let mut force = vec![[T::zero(); 3]; own.len()];
    naive::edge_curvature(&rings, &own, &mut force);
    check_force("Jülicher", surface, Juelicher::new(one), &force)?;
    let naive = &mut || _ = black_box(naive::edge_curvature(&rings, &own, &mut force));
    let methods = (|| Juelicher::new(one), Juelicher::new(count));
    rows.conservative("Jülicher", methods, Some(naive));

    let methods = (|| LoopSubdivision::new(one), LoopSubdivision::new(count));
    rows.conservative("S", methods, None);

    let law = NeoHookean { shear_modulus: one };
    let in_plane = InPlane::new(law, mesh, surface)?;
    let law = NeoHookean {
        shear_modulus: count,
    };
    let counting = InPlane::new(law, mesh, rows.counted)?;
    rows.conservative("neo-Hookean", (|| in_plane.clone(), counting), None);
    let law = Skalak {
        shear_modulus: one,
        area_ratio: one,
    };
    let in_plane = InPlane::new(law, mesh, surface)?;
    let law = Skalak {
        shear_modulus: count,
        area_ratio: count,
    };
    let counting = InPlane::new(law, mesh, rows.counted)?;
    rows.conservative("Skalak", (|| in_plane.clone(), counting), None);

    let mut density = vec![[T::zero(); 3]; own.len()];
    naive::meyer(&rings, &own, &mut density);
    check_density("C", surface, StrongForm::meyer(one), &density)?;
    let naive = &mut || naive::meyer(&rings, &own, black_box(&mut density));
    let methods = (|| StrongForm::meyer(one), StrongForm::meyer(count));
    rows.density("C", methods, Some(naive));
    let published = StrongForm::new(one, HeatKernel::new(Bandwidth::MixedArea(one)));
    let counting = StrongForm::new(count, HeatKernel::new(Bandwidth::MixedArea(count)));
    let methods = (|| published.clone(), counting);
    rows.density("D", methods, None);
    let methods = (|| StrongForm::farutin(one), StrongForm::farutin(count));
    rows.density("E", methods, None);

    let mut laplacian = vec![T::zero(); own.len()];
    let naive = &mut || naive::jets(&rings, &own, (4, 32, 6.0), black_box(&mut laplacian));
    let methods = (|| StrongForm::j4(one), StrongForm::j4(count));
    rows.density("J4", methods, Some(naive));
    let naive = &mut || naive::jets(&rings, &own, (6, 56, 7.0), black_box(&mut laplacian));
    let methods = (|| StrongForm::j6(one), StrongForm::j6(count));
    rows.density("J6", methods, Some(naive));
    let mut known = vec![[T::zero(); 3]; own.len()];
    let mut prepared = Prepared::new(StrongForm::j6(one), mesh);
    prepared.force_density(surface, &mut known);
    check(
        "J6",
        &laplacian,
        prepared.memory().laplacian_of_mean(),
        0.05,
    )
}

/// The naive version computes the same.
fn check_force<T: Real, M: Conservative<T>>(
    name: &str,
    surface: Surface<'_, T>,
    method: M,
    found: &[[T; 3]],
) -> Result<(), Error> {
    let mut known = vec![[T::zero(); 3]; found.len()];
    Prepared::new(method, surface.mesh()).add_force_and_energy(surface, &mut known);
    let bound = T::epsilon().sqrt().to_f64().unwrap_or(0.0);
    check(name, found.as_flattened(), known.as_flattened(), bound)
}

fn check_density<T: Real, M: ForceDensity<T>>(
    name: &str,
    surface: Surface<'_, T>,
    method: M,
    found: &[[T; 3]],
) -> Result<(), Error> {
    let mut known = vec![[T::zero(); 3]; found.len()];
    Prepared::new(method, surface.mesh()).force_density(surface, &mut known);
    // Rounding of positions, four times differentiated.
    let bound = 1e3 * T::epsilon().sqrt().to_f64().unwrap_or(0.0);
    check(name, found.as_flattened(), known.as_flattened(), bound)
}

fn check<T: Real>(name: &str, found: &[T], known: &[T], bound: f64) -> Result<(), Error> {
    let pairs = || found.iter().zip(known);
    let largest = pairs().fold(T::zero(), |most, (_, known)| most.max(known.abs()));
    let error = pairs().fold(T::zero(), |most, (&a, &b)| most.max((a - b).abs()));
    if error.is_finite() && error <= T::constant(bound) * largest {
        return Ok(());
    }
    Err(format!("the naive version of {name} is {error:?} off, of {largest:?}").into())
}

impl<T: Real> Rows<'_, T> {
    /// The least time of these operations, nanoseconds a vertex.
    fn bound(&self, done: Operations) -> f64 {
        let time = self.table.peak.bound(done, self.scalar == "f32");
        time / self.surface.positions().len() as f64
    }

    fn conservative<M: Conservative<T>, C: Conservative<Counted>>(
        &mut self,
        name: &str,
        (method, counting): (impl Fn() -> M, C),
        mut naive: Option<&mut dyn FnMut()>,
    ) {
        let (surface, counted) = (self.surface, self.counted);
        let mesh = surface.mesh();
        let mut force = vec![[Counted::default(); 3]; mesh.vertex_count()];
        let mut counting = Prepared::new(counting, mesh);
        let done = operations(|| _ = counting.add_force_and_energy(counted, &mut force));
        let mut force = vec![[T::zero(); 3]; mesh.vertex_count()];
        let [mut forces, mut others] = [force.clone(), force.clone()];
        let mut serial = Prepared::new(method(), mesh);
        let mut wide = Prepared::with_execution(method(), mesh, parallel(1));
        let mut both = Prepared::with_execution(method(), mesh, parallel(2));
        let bound = self.bound(done);
        let known = naive.is_some();
        let mut run_naive = || {
            if let Some(run) = &mut naive {
                run();
            }
        };
        self.table.row(Row {
            name: format!("{name} {}", self.scalar),
            count: mesh.vertex_count(),
            naive: if known { Some(&mut run_naive) } else { None },
            serial: Some(&mut || _ = black_box(serial.add_force_and_energy(surface, &mut force))),
            wide: &mut || _ = black_box(wide.add_force_and_energy(surface, &mut forces)),
            both: &mut || _ = black_box(both.add_force_and_energy(surface, &mut others)),
            bound: Bound::Time(bound),
        });
    }

    fn density<M: ForceDensity<T> + Method<T>, C: ForceDensity<Counted>>(
        &mut self,
        name: &str,
        (method, counting): (impl Fn() -> M, C),
        mut naive: Option<&mut dyn FnMut()>,
    ) {
        let (surface, counted) = (self.surface, self.counted);
        let mesh = surface.mesh();
        let mut force = vec![[Counted::default(); 3]; mesh.vertex_count()];
        let mut counting = Prepared::new(counting, mesh);
        let done = operations(|| counting.force_density(counted, &mut force));
        let mut force = vec![[T::zero(); 3]; mesh.vertex_count()];
        let [mut forces, mut others] = [force.clone(), force.clone()];
        let mut serial = Prepared::new(method(), mesh);
        let mut wide = Prepared::with_execution(method(), mesh, parallel(1));
        let mut both = Prepared::with_execution(method(), mesh, parallel(2));
        let bound = self.bound(done);
        let known = naive.is_some();
        let mut run_naive = || {
            if let Some(run) = &mut naive {
                run();
            }
        };
        self.table.row(Row {
            name: format!("{name} {}", self.scalar),
            count: mesh.vertex_count(),
            naive: if known { Some(&mut run_naive) } else { None },
            serial: Some(&mut || serial.force_density(surface, &mut force)),
            wide: &mut || wide.force_density(surface, &mut forces),
            both: &mut || both.force_density(surface, &mut others),
            bound: Bound::Time(bound),
        });
    }
}

/// The single layer on a sphere, all its corrections included, beside bare sums of as many
/// Stokeslets.
pub(crate) fn stokeslets(table: &mut Table) -> Result<(), Error> {
    let made = generate(&"sphere:1".parse()?, Family::Regular, 2562, 1)?;
    let sources: Vec<[f64; 3]> = made
        .mesh
        .edges()
        .iter()
        .map(|ends| {
            let [a, b] = ends.map(|vertex| made.positions[vertex as usize]);
            [0, 1, 2].map(|k| 0.5 * (a[k] + b[k]))
        })
        .collect();
    let forces = sources.clone();
    let mut velocity = vec![[0.0; 3]; made.positions.len()];
    let [mut first, mut second] = [velocity.clone(), velocity.clone()];
    let mut layers = [1, 2].map(|count| SingleLayer::new([&made.mesh], 1.0, threads(count)));
    let [one, two] = &mut layers;
    let pairs = made.positions.len() * sources.len();
    // What a pair cannot do without: the differences, |r|², f·r and the sums, and 1/|r|.
    let least = Operations {
        fast: 24 * pairs as u64,
        slow: 2 * pairs as u64,
    };
    let bound = table.peak.bound(least, false) / pairs as f64;
    table.row(Row {
        name: "Stokeslets f64".to_owned(),
        count: pairs,
        naive: Some(&mut || {
            naive::stokeslets(&made.positions, &sources, &forces, &mut velocity);
        }),
        serial: None,
        wide: &mut || {
            one.set_forces(&made.positions, &made.positions);
            one.add_at_vertices(&mut first);
        },
        both: &mut || {
            two.set_forces(&made.positions, &made.positions);
            two.add_at_vertices(&mut second);
        },
        bound: Bound::Time(bound),
    });
    Ok(())
}

/// A step of the lattice, beside what memory allows: each population read and written once, in
/// place.
pub(crate) fn lattice<T: Precision>(scalar: &str, table: &mut Table) -> Result<(), Error> {
    const EDGE: usize = 96;
    let lattice = |count: usize| -> Result<Lattice<T>, LatticeError> {
        Lattice::new(Setup {
            cells: [EDGE; 3],
            sides: [Sides::Periodic; 3],
            viscosity: 1.0 / 6.0,
            inertia: true,
            threads: threads(count),
        })
    };
    let (mut one, mut two) = (lattice(1)?, lattice(2)?);
    let nodes = EDGE.pow(3);
    let mut bare = vec![T::one(); 19 * nodes];
    let factor = T::constant(0.999);
    table.row(Row {
        name: format!("lattice {scalar}"),
        // An even step and an odd one.
        count: 2 * nodes,
        naive: None,
        serial: None,
        wide: &mut || one.advance(2),
        both: &mut || two.advance(2),
        bound: Bound::Loop(&mut || {
            for _ in 0..2 {
                for value in black_box(&mut bare) {
                    *value *= factor;
                }
            }
        }),
    });
    Ok(())
}
