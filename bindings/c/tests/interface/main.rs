//! Results of the C interface are those of the library to the last bit, and everything that can be wrong with a
//! call is an error with a text.
#![expect(unsafe_code, reason = "calls as a C program makes them")]
#![expect(clippy::unwrap_used, reason = "a test fails by a panic")]

mod beside;
mod equal;
mod errors;
mod smooth;
mod table;

use helfrich::TriangleMesh;
use helfrich_capi::membrane::{Membrane, hf_membrane_free, hf_membrane_new};
use helfrich_capi::mesh::{Mesh, hf_mesh_free, hf_mesh_new};
use helfrich_capi::{Error, Status};
use helfrich_std::generate::{Family, generate};
use std::ffi::{CStr, CString, c_char};
use std::ptr::{null, null_mut};

/// Effects of several kinds: an energy, an in-plane law, and quantities of components.
const EFFECTS: &str = r#"
bending = { method = "gompper-kroll", modulus = 0.02, spontaneous_curvature = 0.3 }
elasticity = { law = "skalak", shear_modulus = 0.7, area_ratio = 1.5 }
volume = { modulus = 20.0 }
"#;

/// A mesh of an ellipsoid.
fn ellipsoid(vertices: usize) -> (TriangleMesh, Vec<[f64; 3]>) {
    let shape = "ellipsoid:1,0.8,0.6".parse().unwrap();
    let made = generate(&shape, Family::Smooth, vertices, 1).unwrap();
    (made.mesh, made.positions)
}

/// Positions off those of the start.
fn moved(positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let shear = |&[x, y, z]: &[f64; 3]| [x + 0.1 * y, 1.1 * y, 0.9 * z - 0.05 * x * y];
    positions.iter().map(shear).collect()
}

fn no_error() -> Error {
    Error {
        status: Status::Internal,
        text: [1; helfrich_capi::status::TEXT_BYTES],
    }
}

/// The status of a call and its text.
fn outcome(call: impl FnOnce(*mut Error) -> Status) -> (Status, String) {
    let mut error = no_error();
    let status = call(&raw mut error);
    assert_eq!(status, error.status);
    // SAFETY: a call ends the text by a zero byte.
    let text = unsafe { CStr::from_ptr(error.text.as_ptr()) };
    (status, text.to_str().unwrap().to_owned())
}

fn succeed(call: impl FnOnce(*mut Error) -> Status) {
    assert_eq!(outcome(call), (Status::Ok, String::new()));
}

/// A handle that frees itself.
struct Handle<T>(*mut T, unsafe extern "C" fn(*mut T));

impl<T> Drop for Handle<T> {
    fn drop(&mut self) {
        // SAFETY: made by the function that belongs to this one.
        unsafe { (self.1)(self.0) }
    }
}

fn mesh_of(mesh: &TriangleMesh) -> Handle<Mesh> {
    let mut handle = null_mut();
    let (triangles, count) = (mesh.triangles().as_ptr(), mesh.triangles().len());
    succeed(|error| unsafe {
        hf_mesh_new(
            mesh.vertex_count(),
            triangles,
            count,
            &raw mut handle,
            error,
        )
    });
    Handle(handle, hf_mesh_free)
}

fn membrane_of(mesh: &TriangleMesh, reference: &[[f64; 3]], effects: &str) -> Handle<Membrane> {
    let mut handle = null_mut();
    let (mesh, effects) = (mesh_of(mesh), CString::new(effects).unwrap());
    let (at, count) = (reference.as_ptr(), reference.len());
    let place = &raw mut handle;
    succeed(|error| unsafe {
        hf_membrane_new(
            mesh.0,
            at,
            count,
            effects.as_ptr(),
            null(),
            0,
            1,
            place,
            error,
        )
    });
    Handle(handle, hf_membrane_free)
}

/// The text that a function writes.
fn text(write: impl FnOnce(*mut c_char, usize, *mut Error) -> Status) -> String {
    let mut bytes: Vec<c_char> = vec![1; 256];
    let (place, capacity) = (bytes.as_mut_ptr(), bytes.len());
    succeed(|error| write(place, capacity, error));
    // SAFETY: the call ends the text by a zero byte.
    let text = unsafe { CStr::from_ptr(bytes.as_ptr()) };
    text.to_str().unwrap().to_owned()
}
