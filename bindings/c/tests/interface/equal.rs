//! Results equal those of the library to the last bit.

use super::{EFFECTS, Handle, ellipsoid, membrane_of, mesh_of, moved, succeed, text};
use helfrich::{
    AdaptiveJet, AnyFunctional, Conservative, Cotangent, DualArea, GompperKroll, InPlane, Penalty,
    Prepared, Quality, Serial, Skalak, Surface, Targets, TriangleMesh,
};
use helfrich_capi::many::hf_membranes_force;
use helfrich_capi::measure::{Measured, hf_measure};
use helfrich_capi::membrane::constraint::{
    hf_membrane_constraint_count, hf_membrane_constraint_gradients, hf_membrane_restore,
};
use helfrich_capi::membrane::engine::hf_membrane_add_force_at;
use helfrich_capi::membrane::{
    hf_membrane_effect_count, hf_membrane_effect_forces, hf_membrane_effect_name,
    hf_membrane_energy, hf_membrane_force, hf_membrane_force_f32, hf_membrane_warnings,
};
use helfrich_capi::mesh::{hf_area, hf_volume};
use helfrich_capi::method::{
    Fields, NO_GAUSSIAN, NO_LAPLACIAN, NO_MEAN, hf_method_fields, hf_method_free, hf_method_new,
};
use helfrich_capi::names::{hf_effect_name, hf_flag_name, hf_method_name, hf_verdict_name};
use helfrich_capi::operator::{
    hf_gradient, hf_mass, hf_mesh_entry_count, hf_stiffness, hf_vertex_areas,
};
use helfrich_std::execute::Parallel;
use helfrich_std::method::{BendingMethod, Evaluator, MethodOptions};
use helfrich_std::scene::Effects;
use std::ffi::CString;
use std::ptr::{null, null_mut};

/// Adds the forces of one effect of the core.
fn add(
    method: impl Conservative<f64>,
    mesh: &TriangleMesh,
    positions: &[[f64; 3]],
    force: &mut [[f64; 3]],
) -> f64 {
    let surface = Surface::new(mesh, positions).unwrap();
    Prepared::new(method, mesh).add_force_and_energy(surface, force)
}

/// The effects of [`EFFECTS`] by the core alone: the energy and the forces of each.
fn by_the_core(
    mesh: &TriangleMesh,
    reference: &[[f64; 3]],
    positions: &[[f64; 3]],
    force: &mut [[f64; 3]],
) -> [f64; 3] {
    let start = Surface::new(mesh, reference).unwrap();
    let bending = GompperKroll {
        modulus: 0.02.into(),
        spontaneous_curvature: 0.3.into(),
        area: DualArea::default(),
    };
    let law = Skalak {
        shear_modulus: 0.7,
        area_ratio: 1.5,
    };
    let volume = Targets::measured(&AnyFunctional::Volume, start);
    [
        add(bending, mesh, positions, force),
        add(
            InPlane::new(law, mesh, start).unwrap(),
            mesh,
            positions,
            force,
        ),
        add(
            Penalty::new(AnyFunctional::Volume, 20.0, volume),
            mesh,
            positions,
            force,
        ),
    ]
}

#[test]
fn membranes_are_those_of_the_core() {
    let (mesh, reference) = ellipsoid(642);
    let positions = moved(&reference);
    let count = positions.len();
    let mut expected = vec![[0.0; 3]; count];
    let energies = by_the_core(&mesh, &reference, &positions, &mut expected);

    let membrane = membrane_of(&mesh, &reference, EFFECTS);
    let (mut energy, mut alone) = (0.0, 0.0);
    let mut force = vec![[f64::NAN; 3]; count];
    let (at, place) = (positions.as_ptr(), force.as_mut_ptr());
    succeed(|error| unsafe {
        hf_membrane_force(membrane.0, at, count, place, &raw mut energy, error)
    });
    assert_eq!(force, expected);
    assert_eq!(energy.to_bits(), energies.iter().sum::<f64>().to_bits());
    succeed(|error| unsafe { hf_membrane_energy(membrane.0, at, count, &raw mut alone, error) });
    assert_eq!(alone.to_bits(), energy.to_bits());

    let names = ["bending", "elasticity", "volume"];
    assert_eq!(unsafe { hf_membrane_effect_count(membrane.0) }, names.len());
    for (index, name) in names.into_iter().enumerate() {
        let found = text(|place, capacity, error| unsafe {
            hf_membrane_effect_name(membrane.0, index, place, capacity, error)
        });
        assert_eq!(found, name);
    }
    let mut each = [0.0; 3];
    let mut forces = vec![[0.0; 3]; 3 * count];
    let (values, all) = (each.as_mut_ptr(), forces.as_mut_ptr());
    succeed(|error| unsafe {
        hf_membrane_effect_forces(membrane.0, at, count, values, all, 3, error)
    });
    assert_eq!(each, energies);
    let sum = |vertex: usize| {
        let parts = [0, 1, 2].map(|effect| forces[effect * count + vertex]);
        [0, 1, 2].map(|axis| 0.0 + parts[0][axis] + parts[1][axis] + parts[2][axis])
    };
    for (vertex, force) in force.iter().enumerate() {
        for (force, sum) in force.iter().zip(sum(vertex)) {
            // Sums in another order: the rounding of two additions of numbers of this size.
            assert!((force - sum).abs() < 1e-12);
        }
    }
}

#[test]
fn twins_round_once() {
    let (mesh, reference) = ellipsoid(162);
    let narrow = Vec::from_iter(moved(&reference).iter().map(|x| x.map(|x| x as f32)));
    let wide = Vec::from_iter(narrow.iter().map(|x| x.map(f64::from)));
    let mut expected = vec![[0.0; 3]; wide.len()];
    let energies = by_the_core(&mesh, &reference, &wide, &mut expected);
    let membrane = membrane_of(&mesh, &reference, EFFECTS);
    let (mut energy, mut force) = (0.0, vec![[0.0; 3]; wide.len()]);
    let (at, count, place) = (narrow.as_ptr(), narrow.len(), force.as_mut_ptr());
    succeed(|error| unsafe {
        hf_membrane_force_f32(membrane.0, at, count, place, &raw mut energy, error)
    });
    assert_eq!(energy, energies.iter().sum::<f64>() as f32);
    let rounded = expected.iter().map(|force| force.map(|force| force as f32));
    assert_eq!(force, Vec::from_iter(rounded));
}

#[test]
fn many_membranes_are_each_of_them() {
    let (mesh, reference) = ellipsoid(162);
    let membranes = Vec::from_iter((0..5).map(|_| membrane_of(&mesh, &reference, EFFECTS)));
    let handles = Vec::from_iter(membranes.iter().map(|membrane| membrane.0));
    let scaled = |k: usize| {
        reference
            .iter()
            .map(move |x| x.map(|x| x * (1.0 + 0.01 * k as f64)))
    };
    let positions = Vec::from_iter((0..5).flat_map(scaled));
    let own = reference.len();
    for threads in [1, 3, 0] {
        let (mut energies, mut forces) = ([0.0; 5], vec![[0.0; 3]; positions.len()]);
        let (list, at, total) = (handles.as_ptr(), positions.as_ptr(), positions.len());
        let (force, energy) = (forces.as_mut_ptr(), energies.as_mut_ptr());
        succeed(|error| unsafe {
            hf_membranes_force(list, 5, at, force, total, energy, threads, error)
        });
        for (k, &energy) in energies.iter().enumerate() {
            let range = k * own..(k + 1) * own;
            let mut expected = vec![[0.0; 3]; own];
            let sum: f64 = by_the_core(&mesh, &reference, &positions[range.clone()], &mut expected)
                .iter()
                .sum();
            assert_eq!(forces[range], expected);
            assert_eq!(energy, sum);
        }
    }
}

#[test]
fn owned_vertices_of_an_engine() {
    let (mesh, reference) = ellipsoid(162);
    let count = reference.len();
    let mut expected = vec![[0.0; 3]; count];
    let positions = moved(&reference);
    by_the_core(&mesh, &reference, &positions, &mut expected);
    // Another order, with other particles between; the last third are ghosts.
    let total = 2 * count;
    let places = Vec::from_iter((0..count).map(|vertex| (2 * ((vertex * 7) % count)) as u32));
    let owned = 4 * count / 3;
    let mut all = vec![[9.0; 3]; total];
    for (&place, position) in places.iter().zip(&positions) {
        all[place as usize] = *position;
    }
    let membrane = membrane_of(&mesh, &reference, EFFECTS);
    let mut force = vec![[0.5; 3]; total];
    let (list, at, into) = (places.as_ptr(), all.as_ptr(), force.as_mut_ptr());
    succeed(|error| unsafe {
        hf_membrane_add_force_at(
            membrane.0,
            list,
            count,
            at,
            total,
            owned,
            into,
            null_mut(),
            error,
        )
    });
    let mut sums = vec![[0.5; 3]; total];
    for (&place, force) in places.iter().zip(&expected) {
        if (place as usize) < owned {
            sums[place as usize] = force.map(|force| 0.5 + force);
        }
    }
    assert_eq!(force, sums);
}

#[test]
fn constraints_are_restored_and_have_gradients() {
    let (mesh, reference) = ellipsoid(162);
    let effects =
        "bending = { method = \"B\", modulus = 1.0 }\nvolume = { constraint = \"exact\" }";
    let membrane = membrane_of(&mesh, &reference, effects);
    assert_eq!(unsafe { hf_membrane_constraint_count(membrane.0) }, 1);
    let mut positions = moved(&reference);
    let (count, mut residual) = (positions.len(), f64::NAN);
    let at = positions.as_mut_ptr();
    succeed(|error| unsafe {
        hf_membrane_restore(membrane.0, at, count, &raw mut residual, error)
    });
    let volume = |positions: &[[f64; 3]]| Surface::new(&mesh, positions).unwrap().volume().unwrap();
    let error = volume(&positions) / volume(&reference) - 1.0;
    // The library holds constraints to this.
    assert!(
        error.abs() < 1e-10 && residual < 1e-10,
        "{error} {residual}"
    );
    let mut gradient = vec![[0.0; 3]; count];
    let place = gradient.as_mut_ptr();
    succeed(|error| unsafe {
        hf_membrane_constraint_gradients(membrane.0, positions.as_ptr(), count, place, 1, error)
    });
    // Volume is homogeneous of degree three: Euler's theorem.
    let pairs = gradient.iter().zip(&positions);
    let sum: f64 = pairs
        .map(|(g, x)| g[0] * x[0] + g[1] * x[1] + g[2] * x[2])
        .sum();
    assert!((sum / (3.0 * volume(&positions)) - 1.0).abs() < 1e-13);
}

#[test]
fn every_method_has_the_fields_of_the_library() {
    let (mesh, positions) = ellipsoid(162);
    let handle = mesh_of(&mesh);
    let count = positions.len();
    for (index, method) in BendingMethod::NAMED.into_iter().enumerate() {
        let name =
            text(|place, capacity, error| unsafe { hf_method_name(index, place, capacity, error) });
        assert_eq!(name, method.name());
        let name = CString::new(name).unwrap();
        let mut made = null_mut();
        succeed(|error| unsafe {
            hf_method_new(
                handle.0,
                name.as_ptr(),
                null(),
                null(),
                0.3,
                0.0,
                2,
                &raw mut made,
                error,
            )
        });
        let made = Handle(made, hf_method_free);
        let (mut mean, mut gaussian) = (vec![9.0; count], vec![9.0; count]);
        let (mut laplacian, mut area) = (vec![9.0; count], vec![9.0; count]);
        let (mut density, mut normal) = (vec![[9.0; 3]; count], vec![[9.0; 3]; count]);
        let mut flags = vec![9; count];
        let wanted = Fields {
            area: area.as_mut_ptr(),
            normal: normal.as_mut_ptr(),
            mean: mean.as_mut_ptr(),
            gaussian: gaussian.as_mut_ptr(),
            laplacian_of_mean: laplacian.as_mut_ptr(),
            force_density: density.as_mut_ptr(),
            flags: flags.as_mut_ptr(),
        };
        let at = positions.as_ptr();
        succeed(|error| unsafe { hf_method_fields(made.0, at, count, &raw const wanted, error) });

        let options = MethodOptions::default();
        let mut evaluator =
            Evaluator::with_options(method, &options, 0.3, &mesh, Parallel::single());
        let surface = Surface::new(&mesh, &positions).unwrap();
        let (fields, findings) = evaluator.fields_and_findings(surface);
        assert_eq!((area, normal), (fields.area, fields.normal), "{method}");
        let or_zero = |values: &[Option<f64>]| -> Vec<f64> {
            values.iter().map(|value| value.unwrap_or(0.0)).collect()
        };
        assert_eq!(mean, or_zero(&fields.mean), "{method}");
        assert_eq!(gaussian, or_zero(&fields.gaussian), "{method}");
        assert_eq!(laplacian, or_zero(&fields.laplacian_of_mean), "{method}");
        let densities = fields
            .force_density
            .iter()
            .map(|value| value.unwrap_or([0.0; 3]));
        assert_eq!(density, Vec::from_iter(densities), "{method}");
        let quality = Quality::gather(&mesh, |report| findings.iter().for_each(|f| report(*f)));
        let defines = method.description().defines;
        for (flag, kinds) in flags.iter().zip(quality.flags()) {
            assert_eq!(flag & (NO_MEAN - 1), *kinds);
            let bits = [NO_MEAN, NO_GAUSSIAN, NO_LAPLACIAN];
            for (bit, defined) in bits.into_iter().zip(defines) {
                assert_eq!(flag & bit == 0, defined, "{method}");
            }
        }
    }
}

#[test]
fn options_are_those_of_the_method() {
    let (mesh, positions) = ellipsoid(162);
    let handle = mesh_of(&mesh);
    let surface = Surface::new(&mesh, &positions).unwrap();
    let (at, count) = (positions.as_ptr(), positions.len());
    for (name, areas, bandwidth) in [("meyer", Some("voronoi"), None), ("D", None, Some("0.7"))] {
        let [name, first, second] =
            [Some(name), areas, bandwidth].map(|text| text.map(|text| CString::new(text).unwrap()));
        let pointer = |text: &Option<CString>| text.as_ref().map_or(null(), |text| text.as_ptr());
        let mut made = null_mut();
        let (name, first, second) = (pointer(&name), pointer(&first), pointer(&second));
        succeed(|error| unsafe {
            hf_method_new(
                handle.0,
                name,
                first,
                second,
                1.0,
                0.0,
                1,
                &raw mut made,
                error,
            )
        });
        let made = Handle(made, hf_method_free);
        let mut mean = vec![9.0; count];
        let mut wanted = Fields {
            area: null_mut(),
            normal: null_mut(),
            mean: mean.as_mut_ptr(),
            gaussian: null_mut(),
            laplacian_of_mean: null_mut(),
            force_density: null_mut(),
            flags: null_mut(),
        };
        succeed(|error| unsafe { hf_method_fields(made.0, at, count, &raw const wanted, error) });
        let options = MethodOptions {
            areas: areas.map(|areas| MethodOptions::parse_areas(areas).unwrap()),
            bandwidth: bandwidth.map(|text| MethodOptions::parse_bandwidth(text).unwrap()),
        };
        let method = if areas.is_some() {
            BendingMethod::Meyer
        } else {
            BendingMethod::Belkin
        };
        let of = |options: &MethodOptions| {
            Evaluator::with_options(method, options, 1.0, &mesh, Parallel::single())
                .fields(surface)
                .mean
        };
        let expected = Vec::from_iter(of(&options).into_iter().map(Option::unwrap_or_default));
        assert_eq!(mean, expected);
        assert_ne!(of(&options), of(&MethodOptions::default()));
        wanted.mean = null_mut();
        succeed(|error| unsafe { hf_method_fields(made.0, at, count, &raw const wanted, error) });
    }
}

#[test]
fn curvatures_have_the_error_bars_of_the_library() {
    let (mesh, positions) = ellipsoid(642);
    let handle = mesh_of(&mesh);
    let count = positions.len();
    let (mut mean, mut error_bar) = (vec![0.0; count], vec![0.0; count]);
    let (mut principal, mut directions) = (vec![[0.0; 2]; count], vec![[[0.0; 3]; 2]; count]);
    let mut verdict = vec![9; count];
    let wanted = Measured {
        mean: mean.as_mut_ptr(),
        mean_error: error_bar.as_mut_ptr(),
        gaussian: null_mut(),
        gaussian_error: null_mut(),
        principal: principal.as_mut_ptr(),
        principal_error: null_mut(),
        directions: directions.as_mut_ptr(),
        force_density: null_mut(),
        force_density_error: null_mut(),
        normal: null_mut(),
        deviation: null_mut(),
        verdict: verdict.as_mut_ptr(),
    };
    let (at, wanted) = (positions.as_ptr(), &raw const wanted);
    succeed(|error| unsafe { hf_measure(handle.0, at, count, 0.0, 0, wanted, error) });
    let surface = Surface::new(&mesh, &positions).unwrap();
    let jet = AdaptiveJet::default();
    let measured = helfrich_std::noise::measured(&jet, surface, &mut |_| true).unwrap();
    for (vertex, at) in measured.iter().enumerate() {
        assert_eq!(
            [mean[vertex], error_bar[vertex]],
            [at.mean.value, at.mean.error]
        );
        assert_eq!(principal[vertex], at.principal.map(|k| k.value));
        assert_eq!(directions[vertex], at.directions.unwrap_or([[0.0; 3]; 2]));
        let name = text(|place, capacity, error| unsafe {
            hf_verdict_name(verdict[vertex] as usize, place, capacity, error)
        });
        assert_eq!(name, helfrich_std::measurement::verdict_name(at.verdict));
    }
}

#[test]
fn matrices_areas_and_gradients() {
    let (mesh, positions) = ellipsoid(162);
    let surface = Surface::new(&mesh, &positions).unwrap();
    let handle = mesh_of(&mesh);
    let (at, count) = (positions.as_ptr(), positions.len());
    let entries = unsafe { hf_mesh_entry_count(handle.0) };
    let operator = Cotangent::new(DualArea::Voronoi);
    let (mut offsets, mut columns) = (vec![0; count + 1], vec![0; entries]);
    let mut values = vec![0.0; entries];
    for (assemble, expected) in [
        (
            hf_stiffness as unsafe extern "C" fn(_, _, _, _, _, _, _, _) -> _,
            operator.stiffness(surface),
        ),
        (hf_mass, operator.mass(surface)),
    ] {
        let (rows, places) = (offsets.as_mut_ptr(), columns.as_mut_ptr());
        let numbers = values.as_mut_ptr();
        succeed(|error| unsafe {
            assemble(handle.0, at, count, rows, places, numbers, entries, error)
        });
        let found = (offsets.clone(), columns.clone(), values.clone());
        assert_eq!(found, expected.into_parts());
    }
    let (mut areas, mut expected) = (vec![0.0; count], vec![0.0; count]);
    let (kind, place) = (CString::new("voronoi").unwrap(), areas.as_mut_ptr());
    succeed(|error| unsafe { hf_vertex_areas(handle.0, at, count, kind.as_ptr(), place, error) });
    operator.dual_areas(&Serial, surface, &mut expected);
    assert_eq!(areas, expected);
    let field = Vec::from_iter(positions.iter().map(|[x, y, _]| x * y));
    let triangles = mesh.triangles().len();
    let (mut gradient, mut expected) = (vec![[0.0; 3]; triangles], vec![[0.0; 3]; triangles]);
    let place = gradient.as_mut_ptr();
    succeed(|error| unsafe {
        hf_gradient(handle.0, at, count, field.as_ptr(), place, triangles, error)
    });
    operator.gradient(&Serial, surface, &field, &mut expected);
    assert_eq!(gradient, expected);
    let (mut area, mut volume) = (0.0, 0.0);
    succeed(|error| unsafe { hf_area(handle.0, at, count, &raw mut area, error) });
    succeed(|error| unsafe { hf_volume(handle.0, at, count, &raw mut volume, error) });
    assert_eq!((area, Some(volume)), (surface.area(), surface.volume()));
}

#[test]
fn warnings_are_those_of_scenes() {
    let (mesh, reference) = ellipsoid(162);
    let of = |effects: &str| {
        let membrane = membrane_of(&mesh, &reference, effects);
        text(|place, capacity, error| unsafe {
            hf_membrane_warnings(membrane.0, place, capacity, error)
        })
    };
    assert_eq!(of(EFFECTS), "");
    // Nothing acts.
    assert!(of("").starts_with("nothing acts on"));
}

#[test]
fn lists_of_names_are_those_of_the_library() {
    for (index, name) in Effects::NAMES.iter().enumerate() {
        let found =
            text(|place, capacity, error| unsafe { hf_effect_name(index, place, capacity, error) });
        assert_eq!(found, *name);
    }
    for (index, name) in helfrich::Finding::KINDS.iter().enumerate() {
        let found =
            text(|place, capacity, error| unsafe { hf_flag_name(index, place, capacity, error) });
        assert_eq!(found, *name);
    }
}
