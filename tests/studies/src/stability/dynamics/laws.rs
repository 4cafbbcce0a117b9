//! Laws of all runs: energies fall, forces balance, a restart changes no bit, and explicit steps have a
//! limit.

use super::scenes::{CAPSULE, ON_LATTICE, RELAXED};
use super::{Course, Made, course, momentum, quiet, ready};
use crate::stability::{Bound, Group, Outcome, Row, StabilityError};
use helfrich_std::method::BendingMethod;
use helfrich_std::run::{End, run};
use helfrich_std::scalar::Scalar;
use helfrich_std::series::SeriesTable;
use std::cell::Cell;
use std::fs;
use std::path::{Path, PathBuf};

/// Number of messages about the progress.
pub(super) fn count() -> usize {
    conservative().count() + BendingMethod::ALL.len() + RESTARTED.len() + 2
}

/// Methods whose forces are gradients of energies.
fn conservative() -> impl Iterator<Item = BendingMethod> {
    let all = BendingMethod::ALL.into_iter();
    all.filter(|method| method.is_conservative())
}

pub(super) fn rows(tell: &mut dyn FnMut(&str), rows: &mut Vec<Row>) -> Result<(), StabilityError> {
    let mut add =
        |(case, meaning): (&'static str, &'static str), subject, outcome: Made<_>, bound| {
            let outcome = outcome.map_err(|source| StabilityError { case, source })?;
            rows.push(Row::new(
                Group::Dynamics,
                (case, meaning),
                subject,
                outcome,
                bound,
            ));
            Ok(())
        };
    let case = (
        "energy of a relaxation",
        "Largest rise of the energy from one iteration to the next, with constrained area and volume, in units of its rounding.",
    );
    for method in conservative() {
        tell(&format!("{}: {method}", case.0));
        let measured = rise(method).map(Outcome::Measured);
        add(
            case,
            (method.name(), Scalar::F64),
            measured,
            Bound::AtMost(16.0),
        )?;
    }
    let case = (
        "momentum and torque",
        "Largest net force or torque of every effect on two capsules with needles and caps, relative to the sum of the magnitudes of its parts, in units of rounding.",
    );
    for method in BendingMethod::ALL {
        tell(&format!("{}: {method}", case.0));
        let measured = momentum::of_effects(method).map(Outcome::Measured);
        add(
            case,
            (method.name(), Scalar::F64),
            measured,
            Bound::AtMost(64.0),
        )?;
    }
    let case = (
        "momentum of a fluid",
        "Momentum of a lattice after 100 steps minus the contributions of points and walls, in units of rounding of the mass times the speed of sound.",
    );
    tell(case.0);
    for (subject, kernel) in momentum::KERNELS {
        let measured = [
            (Scalar::F32, momentum::of_fluid::<f32>(kernel)),
            (Scalar::F64, momentum::of_fluid::<f64>(kernel)),
        ];
        for (scalar, measured) in measured {
            add(
                case,
                (subject, scalar),
                measured.map(Outcome::Measured),
                Bound::AtMost(1.0),
            )?;
        }
    }
    let case = (
        "restart in mid-run",
        "Number of output files of a resumed run that differ from those of an uninterrupted one in any bit.",
    );
    for (subject, scene, changes) in RESTARTED {
        tell(&format!("{}: {subject}", case.0));
        let measured = differences(scene, changes).map(|count| Outcome::Measured(count as f64));
        add(case, (subject, Scalar::F64), measured, Bound::AtMost(0.0))?;
    }
    let case = (
        "fixed steps at the limit",
        "rk4 steps below and above the longest stable one: the run agrees with rkc2, or is refused with the limit.",
    );
    tell(case.0);
    let [below, above] = at_the_limit().map_err(|source| StabilityError {
        case: case.0,
        source,
    })?;
    add(
        case,
        ("0.95 of it", Scalar::F64),
        Ok(below),
        Bound::RunsNear { most: 0.01 },
    )?;
    add(
        case,
        ("1.05 of it", Scalar::F64),
        Ok(above),
        Bound::Refused("1.05 times"),
    )
}

/// A long vesicle on a coarse mesh.
const COARSE: [&str; 3] = [
    "surface.0.vertices=162",
    "surface.0.family=smooth",
    "surface.0.shape=ellipsoid:0.6,0.6,2.1",
];

/// Largest increase of the energy between two iterations, in units of rounding.
fn rise(method: BendingMethod) -> Made<f64> {
    let method = format!("surface.0.bending.method={method}");
    let mut changes = COARSE.to_vec();
    changes.extend(["output.every=1", "driver.iterations=300", &method]);
    let (file, simulation, positions) = ready(RELAXED, &changes)??;
    let folder = tempfile::tempdir()?;
    let folder = folder.path().join("run");
    let ready = (simulation, positions);
    run(&file.scene, ready, &folder, false, &|| false, &mut quiet)?;
    let series = SeriesTable::read(&folder.join("series.csv"))?;
    let energies = series.column("energy").unwrap_or_default();
    if energies.len() < 10 {
        return Ok(f64::NAN);
    }
    // The first step moves to the constrained area and volume.
    let pairs = energies[1..].windows(2);
    let rises = pairs.map(|pair| (pair[1] - pair[0]) / (f64::EPSILON * pair[0].abs()));
    Ok(rises.fold(0.0, |most, rise| {
        if rise.is_nan() {
            f64::NAN
        } else {
            most.max(rise)
        }
    }))
}

/// Runs that are interrupted and resumed.
const RESTARTED: [(&str, &str, &[&str]); 3] = [
    (
        "relax",
        RELAXED,
        &[
            "surface.0.vertices=162",
            "surface.0.family=smooth",
            "surface.0.shape=ellipsoid:0.6,0.6,2.1",
            "output.surfaces=true",
            "output.checkpoint_every=7",
        ],
    ),
    (
        "boundary-integral",
        CAPSULE,
        &[
            "output.surfaces=true",
            "surface.0.vertices=42",
            "surface.0.viscosity_ratio=3",
        ],
    ),
    (
        "lattice-boltzmann",
        ON_LATTICE,
        &[
            "output.surfaces=true",
            "driver.strain=0.5",
            "surface.0.vertices=42",
        ],
    ),
];

/// Number of files of an interrupted and resumed run that differ from those of an uninterrupted one.
fn differences(scene: &str, changes: &[&str]) -> Made<usize> {
    let folder = tempfile::tempdir()?;
    let drive = |name: &str, resume: bool, stop: &dyn Fn() -> bool| -> Made<End> {
        let (file, simulation, positions) = ready(scene, changes)??;
        let folder = folder.path().join(name);
        let ready = (simulation, positions);
        let summary = run(&file.scene, ready, &folder, resume, stop, &mut quiet)?;
        Ok(summary.end)
    };
    drive("whole", false, &|| false)?;
    let steps = Cell::new(0);
    let stop = || {
        steps.set(steps.get() + 1);
        steps.get() == 11
    };
    if drive("parts", false, &stop)? != End::Interrupted {
        return Ok(usize::MAX);
    }
    drive("parts", true, &|| false)?;
    let [whole, parts] = ["whole", "parts"].map(|name| files(&folder.path().join(name)));
    let (whole, parts) = (whole?, parts?);
    if whole.len() < 3 || whole.len() != parts.len() {
        return Ok(usize::MAX);
    }
    Ok(whole.iter().zip(&parts).filter(|(a, b)| a != b).count())
}

/// Series and surface files of a run, in the order of their names.
fn files(folder: &Path) -> Made<Vec<(PathBuf, Vec<u8>)>> {
    let mut files = Vec::new();
    let mut paths = vec![PathBuf::from("series.csv")];
    for entry in fs::read_dir(folder.join("surfaces"))? {
        paths.push(Path::new("surfaces").join(entry?.file_name()));
    }
    paths.sort();
    for path in paths {
        files.push((path.clone(), fs::read(folder.join(&path))?));
    }
    Ok(files)
}

/// Outcomes of runs with fixed steps of 0.95 and 1.05 times the limit.
fn at_the_limit() -> Made<[Outcome; 2]> {
    const STIFF: [&str; 3] = [
        "surface.0.vertices=42",
        "surface.0.bending.modulus=1",
        "driver.strain=2",
    ];
    let with_step = |step: f64| -> Made<Result<Course, String>> {
        let step = format!("driver.step={step:e}");
        let changes = [STIFF.as_slice(), &["driver.integrator=rk4", &step]].concat();
        course(CAPSULE, &changes)
    };
    // A refusal of a much longer step names the limit.
    let refusal = with_step(1e3)?.err().unwrap_or_default();
    let limit = refusal.split(" times ").nth(1);
    let limit = limit.and_then(|rest| rest.split(',').next()?.parse::<f64>().ok());
    let limit = limit.unwrap_or(f64::NAN);
    let mut below = match with_step(0.95 * limit)? {
        Ok(course) => course,
        Err(refusal) => return Ok([Outcome::Refused(refusal.clone()), Outcome::Refused(refusal)]),
    };
    let adaptive = course(CAPSULE, &STIFF)??;
    let pair = below.deformation.zip(adaptive.deformation);
    below.error = pair.map(|(found, expected)| (found / expected - 1.0).abs());
    let above = match with_step(1.05 * limit)? {
        Ok(course) => Outcome::Ran(course),
        Err(refusal) => Outcome::Refused(refusal),
    };
    Ok([Outcome::Ran(below), above])
}
