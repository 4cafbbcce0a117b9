//! Viscosity, and repulsion of surfaces: results of the library, exact values, and errors.

use super::errors::fails;
use super::{ellipsoid, mesh_of, moved, outcome, succeed};
use helfrich::interaction::RepulsionMemory;
use helfrich::{Images, Interaction, MembraneViscosity, Prepared, Repulsion, Serial, Surface};
use helfrich_capi::Status;
use helfrich_capi::beside::{
    hf_repulsion, hf_repulsion_f32, hf_viscous_force, hf_viscous_force_f32,
};
use helfrich_capi::mesh::Mesh;
use std::ptr::{null, null_mut};

#[test]
fn viscous_forces_are_those_of_the_core() {
    let (mesh, positions) = ellipsoid(162);
    let (handle, velocities) = (mesh_of(&mesh), moved(&positions));
    let (at, count) = (positions.as_ptr(), positions.len());
    let viscous = |velocities: &[[f64; 3]], shear, dilational| {
        let (mut force, mut power) = (vec![[f64::NAN; 3]; count], f64::NAN);
        let (place, moving) = (force.as_mut_ptr(), velocities.as_ptr());
        let total = &raw mut power;
        succeed(|error| unsafe {
            hf_viscous_force(
                handle.0, at, moving, count, shear, dilational, place, total, error,
            )
        });
        (force, power)
    };
    let surface = Surface::new(&mesh, &positions).unwrap();
    let (shear, dilational) = (0.7, 0.3);
    let mut core = Prepared::new(MembraneViscosity { shear, dilational }, &mesh);
    let mut expected = vec![[0.0; 3]; count];
    core.add_dissipative_force(surface, &velocities, &mut expected);
    let (force, power) = viscous(&velocities, shear, dilational);
    assert_eq!(force, expected);
    assert_eq!(power, core.dissipated_power(surface, &velocities));

    // Growth at the rate 1, v = x, strains every triangle by d = P: the power is η_d (tr d)² A = 4 η_d A.
    let (_, growing) = viscous(&positions, shear, dilational);
    let exact = 4.0 * dilational * surface.area();
    assert!((growing / exact - 1.0).abs() < 1e-12, "{growing} {exact}");

    let narrow = |points: &[[f64; 3]]| Vec::from_iter(points.iter().map(|x| x.map(|x| x as f32)));
    let (at, moving) = (narrow(&positions), narrow(&velocities));
    let (mut single, mut force) = (0.0_f32, vec![[0.0_f32; 3]; count]);
    let (at, moving, place) = (at.as_ptr(), moving.as_ptr(), force.as_mut_ptr());
    succeed(|error| unsafe {
        hf_viscous_force_f32(
            handle.0,
            at,
            moving,
            count,
            0.7,
            0.3,
            place,
            &raw mut single,
            error,
        )
    });
    // Some hundred triangles with numbers that are rounded to 24 bits.
    assert!((f64::from(single) / power - 1.0).abs() < 1e-5);
}

/// Two surfaces of one mesh, a gap apart along x, one after the other.
fn neighbours(positions: &[[f64; 3]], gap: f64) -> Vec<[f64; 3]> {
    let other = positions.iter().map(|&[x, y, z]| [x + 2.0 + gap, y, z]);
    positions.iter().copied().chain(other).collect()
}

#[test]
fn repulsion_is_that_of_the_core() {
    let (mesh, positions) = ellipsoid(642);
    let handle = mesh_of(&mesh);
    let all = neighbours(&positions, 0.1);
    let (count, total) = (positions.len(), all.len());
    let meshes = [handle.0.cast_const(); 2];
    for periods in [[0.0; 3], [4.25, 0.0, 0.0]] {
        let images = Images { periods, own: true };
        let core = Repulsion {
            modulus: 3.0,
            range: 0.2,
            attraction: 0.0,
            parts: false,
            first_group: None,
            images,
        };
        let mut expected = vec![[0.0; 3]; total];
        let (first, second) = expected.split_at_mut(count);
        let surfaces = [&all[..count], &all[count..]].map(|x| Surface::new(&mesh, x).unwrap());
        let mut memory = RepulsionMemory::default();
        let mut forces = [first, second];
        let energy = core.add_force_and_energy(&Serial, &surfaces, &mut memory, &mut forces);
        assert!(energy > 0.0);
        let pushed: f64 = expected[..count].iter().map(|force| force[0]).sum();
        // Away from the other surface; in the box the image on the other side pushes less.
        assert!(pushed < 0.0);
        for threads in [1, 2] {
            let (mut found, mut force) = (0.0, vec![[f64::NAN; 3]; total]);
            let (list, at, place) = (meshes.as_ptr(), all.as_ptr(), force.as_mut_ptr());
            let (box_, sum) = (&raw const periods, &raw mut found);
            succeed(|error| unsafe {
                hf_repulsion(
                    list, 2, at, place, total, 3.0, 0.2, box_, sum, threads, error,
                )
            });
            assert_eq!((found, &force), (energy, &expected));
        }
        let narrow = Vec::from_iter(all.iter().map(|x| x.map(|x| x as f32)));
        let (mut single, mut force) = (0.0, vec![[0.0; 3]; total]);
        let (list, at, place) = (meshes.as_ptr(), narrow.as_ptr(), force.as_mut_ptr());
        let lengths = periods.map(|length| length as f32);
        let (box_, sum) = (&raw const lengths, &raw mut single);
        succeed(|error| unsafe {
            hf_repulsion_f32(list, 2, at, place, total, 3.0, 0.2, box_, sum, 1, error)
        });
        // Positions rounded to 24 bits are 1e-6 of the gap away, and the energy grows with a power of the gap.
        assert!((f64::from(single) / energy - 1.0).abs() < 1e-4);
    }
}

#[test]
fn mistakes_are_refused() {
    let (mesh, positions) = ellipsoid(162);
    let (handle, all) = (mesh_of(&mesh), neighbours(&positions, 0.1));
    let (count, total) = (positions.len(), all.len());
    let mut force = vec![[0.0; 3]; total];
    let (at, place) = (all.as_ptr(), force.as_mut_ptr());
    let viscous = |shear, dilational| {
        outcome(|error| unsafe {
            let power = null_mut();
            hf_viscous_force(
                handle.0, at, at, count, shear, dilational, place, power, error,
            )
        })
    };
    assert_eq!(viscous(0.0, 0.0).0, Status::Ok);
    let negative = viscous(-1.0, 0.0);
    fails(negative, Status::InvalidArgument, "`shear` is -1");
    let none = viscous(1.0, f64::NAN);
    fails(none, Status::InvalidArgument, "`dilational` is NaN");
    for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut moving = positions.clone();
        moving[5][1] = wrong;
        let moving = outcome(|error| unsafe {
            let (moving, power) = (moving.as_ptr(), null_mut());
            hf_viscous_force(handle.0, at, moving, count, 1.0, 1.0, place, power, error)
        });
        fails(moving, Status::InvalidArgument, "`velocities` is [");
    }
    let fast = vec![[1e300, 0.0, -1e300]; count];
    let moving = Vec::from_iter(
        fast.iter()
            .zip(&positions)
            .map(|(v, x)| [v[0] * x[1], 0.0, v[2]]),
    );
    let beyond = outcome(|error| unsafe {
        let (moving, mut power) = (moving.as_ptr(), 0.0);
        let sum = &raw mut power;
        hf_viscous_force(handle.0, at, moving, count, 1.0, 1.0, place, sum, error)
    });
    // The sum has infinite terms of both signs.
    fails(
        beyond,
        Status::Undefined,
        "`power` is NaN, beyond the numbers",
    );

    let repel = |second: *const Mesh, total, modulus, range, periods: [f64; 3]| {
        let meshes = [handle.0.cast_const(), second];
        let (list, box_) = (meshes.as_ptr(), &raw const periods);
        outcome(|error| unsafe {
            let energy = null_mut();
            hf_repulsion(
                list, 2, at, place, total, modulus, range, box_, energy, 1, error,
            )
        })
    };
    let same = handle.0.cast_const();
    assert_eq!(repel(same, total, 1.0, 0.5, [0.0; 3]).0, Status::Ok);
    let missing = repel(null(), total, 1.0, 0.5, [0.0; 3]);
    fails(missing, Status::NullPointer, "`meshes`");
    let few = repel(same, total - 1, 1.0, 0.5, [0.0; 3]);
    fails(few, Status::InvalidCount, "324 are needed");
    let short = repel(same, total, 1.0, 0.5, [9.0, 0.4, 0.0]);
    fails(short, Status::InvalidArgument, "at most 0.4, the length");
    let unbounded = repel(same, total, 1.0, f64::INFINITY, [0.0; 3]);
    fails(unbounded, Status::InvalidArgument, "`range` is inf");
    let none = repel(same, total, 0.0, 0.5, [0.0; 3]);
    fails(none, Status::InvalidArgument, "`modulus` is 0");
    let negative = repel(same, total, 1.0, 0.5, [0.0, -1.0, 0.0]);
    fails(negative, Status::InvalidArgument, "`periods` is -1");
    let coincident = positions.repeat(2);
    let touching = outcome(|error| unsafe {
        let (list, at, mut energy) = ([same; 2], coincident.as_ptr(), 0.0);
        let (list, sum) = (list.as_ptr(), &raw mut energy);
        hf_repulsion(list, 2, at, place, total, 1.0, 0.5, null(), sum, 1, error)
    });
    fails(
        touching,
        Status::Undefined,
        "touches another surface at vertex",
    );
    let mut broken = all.clone();
    broken[count + 3][2] = f64::NAN;
    let meshes = [same; 2];
    let unplaced = outcome(|error| unsafe {
        let (list, at, energy) = (meshes.as_ptr(), broken.as_ptr(), null_mut());
        hf_repulsion(
            list,
            2,
            at,
            place,
            total,
            1.0,
            0.5,
            null(),
            energy,
            1,
            error,
        )
    });
    fails(unplaced, Status::InvalidPositions, "surface 1:");
}
