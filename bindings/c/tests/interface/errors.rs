//! Everything that can be wrong with a call is an error with a text that says what would be right.

use super::{EFFECTS, ellipsoid, membrane_of, mesh_of, outcome};
use helfrich::TriangleMesh;
use helfrich_capi::Status;
use helfrich_capi::many::hf_membranes_force;
use helfrich_capi::membrane::{hf_membrane_force, hf_membrane_new, hf_membrane_warnings};
use helfrich_capi::mesh::{hf_area_f32, hf_mesh_new, hf_mesh_read, hf_volume};
use helfrich_capi::method::hf_method_new;
use helfrich_capi::names::hf_method_name;
use helfrich_capi::operator::hf_gradient;
use helfrich_capi::status::hf_status_text;
use helfrich_std::scene::Effects;
use std::ffi::{CStr, CString};
use std::ptr::{null, null_mut};

/// Checks status and text.
#[track_caller]
pub(super) fn fails((status, text): (Status, String), expected: Status, part: &str) {
    assert_eq!(status, expected, "{text}");
    assert!(text.contains(part), "{text}");
}

#[test]
fn arrays_that_do_not_fit() {
    let (mesh, reference) = ellipsoid(162);
    let membrane = membrane_of(&mesh, &reference, EFFECTS);
    let (count, at) = (reference.len(), reference.as_ptr());
    let mut force = vec![[0.0; 3]; count];
    let place = force.as_mut_ptr();
    let evaluate = |handle, at, count, place| {
        outcome(|error| unsafe { hf_membrane_force(handle, at, count, place, null_mut(), error) })
    };
    fails(
        evaluate(null_mut(), at, count, place),
        Status::NullPointer,
        "`membrane` is NULL",
    );
    fails(
        evaluate(membrane.0, null(), count, place),
        Status::NullPointer,
        "`positions` is NULL",
    );
    fails(
        evaluate(membrane.0, at, count, null_mut()),
        Status::NullPointer,
        "`force` is NULL",
    );
    let few = evaluate(membrane.0, at, count - 1, place);
    fails(few, Status::InvalidCount, "has 161 entries: 162 are needed");
    let huge = evaluate(membrane.0, at, usize::MAX, place);
    fails(huge, Status::InvalidCount, "162 are needed");
    fails(
        evaluate(membrane.0, place, count, place),
        Status::InvalidArgument,
        "overlaps",
    );
    let odd = evaluate(membrane.0, at, count, place.wrapping_byte_add(4));
    fails(odd, Status::InvalidArgument, "misaligned");
    let mut broken = reference.clone();
    broken[17][1] = f64::NAN;
    let nan = evaluate(membrane.0, broken.as_ptr(), count, place);
    fails(nan, Status::InvalidPositions, "coordinate y of vertex 17");
    // It stays usable.
    assert_eq!(evaluate(membrane.0, at, count, place).0, Status::Ok);
    let same = [membrane.0; 2];
    let twice = [reference.clone(), reference.clone()].concat();
    let (mut forces, mut energies) = (twice.clone(), [0.0; 2]);
    let (list, at, into) = (same.as_ptr(), twice.as_ptr(), forces.as_mut_ptr());
    let energy = energies.as_mut_ptr();
    let repeated = outcome(|error| unsafe {
        hf_membranes_force(list, 2, at, into, 2 * count, energy, 1, error)
    });
    fails(
        repeated,
        Status::InvalidArgument,
        "the same object at 0 and 1",
    );
    let too_few = outcome(|error| unsafe {
        hf_membranes_force(list, 1, at, into, 2 * count, energy, 1, error)
    });
    fails(too_few, Status::InvalidCount, "162 are needed");
}

/// Fields and results that are not finite have a place, and a remedy.
#[test]
fn numbers_that_are_not_finite() {
    let (mesh, reference) = ellipsoid(162);
    let handle = mesh_of(&mesh);
    let (count, at) = (reference.len(), reference.as_ptr());
    let triangles = mesh.triangles().len();
    let mut gradient = vec![[0.0; 3]; triangles];
    for wrong in [f64::NAN, f64::INFINITY] {
        let mut field = vec![1.0; count];
        field[7] = wrong;
        let (field, into) = (field.as_ptr(), gradient.as_mut_ptr());
        let refused = outcome(|error| unsafe {
            hf_gradient(handle.0, at, count, field, into, triangles, error)
        });
        let part = format!("`field` is {wrong} at vertex 7: finite numbers are needed");
        fails(refused, Status::InvalidArgument, &part);
    }
    // Finite, and beyond the numbers of f32 or f64 together.
    let large = Vec::from_iter(reference.iter().map(|x| x.map(|x| (1e30 * x) as f32)));
    let mut area = 0.0_f32;
    let beyond = outcome(|error| unsafe {
        hf_area_f32(handle.0, large.as_ptr(), count, &raw mut area, error)
    });
    fails(
        beyond,
        Status::Undefined,
        "`area` is inf, beyond the numbers",
    );
    let [above, deep] = [10.0, -1e4]
        .map(|height| Vec::from_iter(reference.iter().map(|&[x, y, z]| [x, y, z + height])));
    let wall = "adhesion = { strength = 1.0, distance = 0.1, range = 0.1 }";
    let membrane = membrane_of(&mesh, &above, wall);
    let mut force = vec![[0.0; 3]; count];
    let into = force.as_mut_ptr();
    let inside = outcome(|error| unsafe {
        hf_membrane_force(membrane.0, deep.as_ptr(), count, into, null_mut(), error)
    });
    fails(inside, Status::Undefined, "`force` at vertex 0 is");
    // It stays usable.
    let there = outcome(|error| unsafe {
        hf_membrane_force(membrane.0, above.as_ptr(), count, into, null_mut(), error)
    });
    assert_eq!(there.0, Status::Ok, "{}", there.1);
}

/// The energy of bending of an open surface says what it leaves out.
#[test]
fn energies_of_open_surfaces_are_told_of() {
    let (mesh, reference) = ellipsoid(162);
    let open = mesh.triangles()[1..].to_vec();
    let open = TriangleMesh::new(mesh.vertex_count(), open).unwrap();
    let effects = "bending = { method = \"gompper-kroll\", modulus = 1.0 }";
    let told = |mesh: &TriangleMesh| {
        let membrane = membrane_of(mesh, &reference, effects);
        let mut text = [0; 4000];
        let warned = outcome(|error| unsafe {
            hf_membrane_warnings(membrane.0, text.as_mut_ptr(), text.len(), error)
        });
        assert_eq!(warned.0, Status::Ok, "{}", warned.1);
        // SAFETY: a call ends the text by a zero byte.
        let text = unsafe { CStr::from_ptr(text.as_ptr()) };
        text.to_str()
            .unwrap()
            .contains("leaves out about half a row of triangles")
    };
    assert!(told(&open) && !told(&mesh));
}

#[test]
fn meshes_that_are_none() {
    let new = |vertices, triangles: &[[u32; 3]]| {
        let mut mesh = null_mut();
        let (rows, count) = (triangles.as_ptr(), triangles.len());
        outcome(|error| unsafe { hf_mesh_new(vertices, rows, count, &raw mut mesh, error) })
    };
    fails(new(3, &[]), Status::InvalidMesh, "empty");
    fails(new(3, &[[0, 1, 3]]), Status::InvalidMesh, "names vertex 3");
    let triangle = [[0_u32, 1, 2]];
    let missing =
        outcome(|error| unsafe { hf_mesh_new(3, triangle.as_ptr(), 1, null_mut(), error) });
    fails(missing, Status::NullPointer, "`mesh`");
    let mut mesh = null_mut();
    let path = CString::new("no-such-file.off").unwrap();
    let unread = outcome(|error| unsafe { hf_mesh_read(path.as_ptr(), 0, &raw mut mesh, error) });
    fails(unread, Status::UnreadableFile, "no-such-file.off");
    let open = TriangleMesh::new(3, triangle.to_vec()).unwrap();
    let (handle, mut volume) = (mesh_of(&open), 0.0);
    let at = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let volume =
        outcome(|error| unsafe { hf_volume(handle.0, at.as_ptr(), 3, &raw mut volume, error) });
    fails(volume, Status::Undefined, "3 boundary edges");
}

#[test]
fn texts_of_effects_are_checked_as_scenes_are() {
    let (mesh, reference) = ellipsoid(162);
    let handle = mesh_of(&mesh);
    let (at, count) = (reference.as_ptr(), reference.len());
    let new = |effects: &[u8]| {
        let (effects, mut made) = (CString::new(effects).unwrap(), null_mut());
        let place = &raw mut made;
        outcome(|error| unsafe {
            hf_membrane_new(
                handle.0,
                at,
                count,
                effects.as_ptr(),
                null(),
                0,
                1,
                place,
                error,
            )
        })
    };
    fails(new(b"\nbending = 1"), Status::InvalidEffects, "effects:2:");
    fails(
        new(b"bendin = {}"),
        Status::InvalidEffects,
        "did you mean `bending`?",
    );
    fails(
        new(b"shape = \"sphere:1\""),
        Status::InvalidEffects,
        "no key `shape`",
    );
    fails(new(b"= 3"), Status::InvalidEffects, "TOML");
    fails(
        new(b"bending = {method = \"J\", modulus = -1}"),
        Status::InvalidEffects,
        "`modulus` is -1",
    );
    let column = b"bending = {method = \"J\", modulus = {column = \"kappa\"}}";
    fails(new(column), Status::InvalidEffects, "no column \"kappa\"");
    fails(new(b"\xff"), Status::InvalidArgument, "UTF-8");
    // All names that it lists are keys that it knows.
    for name in Effects::NAMES {
        let (_, text) = new(format!("{name} = 1").as_bytes());
        assert!(text.contains(name) && !text.contains("no key"), "{text}");
    }
}

#[test]
fn methods_and_names() {
    let (mesh, _) = ellipsoid(162);
    let handle = mesh_of(&mesh);
    let with = |name: &str, areas, modulus, curvature| {
        let (name, mut made) = (CString::new(name).unwrap(), null_mut());
        let place = &raw mut made;
        outcome(|error| unsafe {
            hf_method_new(
                handle.0,
                name.as_ptr(),
                areas,
                null(),
                modulus,
                curvature,
                1,
                place,
                error,
            )
        })
    };
    let new = |name: &str, modulus, curvature| with(name, null(), modulus, curvature);
    let voronoi = with("j6", c"voronoi".as_ptr(), 1.0, 0.0);
    fails(voronoi, Status::InvalidArgument, "has no option `areas`");
    let unknown = with("meyer", c"barycentre".as_ptr(), 1.0, 0.0);
    fails(
        unknown,
        Status::InvalidArgument,
        "mixed, voronoi or barycentric",
    );
    fails(
        new("meier", 1.0, 0.0),
        Status::InvalidArgument,
        "no bending method `meier`",
    );
    fails(new("j6", 0.0, 0.0), Status::InvalidArgument, "above 0");
    fails(new("j6", f64::NAN, 0.0), Status::InvalidArgument, "above 0");
    fails(new("j6", f64::INFINITY, 0.0), Status::InvalidArgument, "");
    fails(new("j6", 1.0, f64::NAN), Status::InvalidArgument, "");
    fails(
        new("A", 1.0, 0.1),
        Status::InvalidArgument,
        "no spontaneous curvature",
    );
    let mut text = [0; 3];
    let short = outcome(|error| unsafe { hf_method_name(0, text.as_mut_ptr(), 3, error) });
    fails(short, Status::InvalidCount, "14 are needed");
    let beyond = outcome(|error| unsafe { hf_method_name(999, text.as_mut_ptr(), 3, error) });
    fails(beyond, Status::InvalidArgument, "counted from 0");
    let known = (0..12).map(|status| {
        // SAFETY: the texts are static.
        unsafe { CStr::from_ptr(hf_status_text(status)) }
            .to_str()
            .unwrap()
    });
    let known = Vec::from_iter(known);
    assert_eq!(known[0], "no error");
    assert_eq!(&known[10..], ["unknown status"; 2]);
    assert!(!known[..10].contains(&"unknown status"));
}
