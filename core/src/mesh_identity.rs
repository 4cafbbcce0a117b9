//! The identity of a mesh.

use crate::mesh::TriangleMesh;
use core::fmt;

/// The identity of a mesh: a fingerprint of its vertices and triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MeshIdentity {
    fingerprint: u64,
    vertices: usize,
    triangles: usize,
}

impl MeshIdentity {
    pub(crate) fn of(mesh: &TriangleMesh) -> Self {
        Self {
            fingerprint: mesh.fingerprint(),
            vertices: mesh.vertex_count(),
            triangles: mesh.triangles().len(),
        }
    }

    /// Panics unless `mesh` is the one of this identity; the message names the method `M` and ends with
    /// `remedy`.
    #[inline]
    #[track_caller]
    pub(crate) fn expect<M>(&self, mesh: &TriangleMesh, remedy: &str) {
        if self.fingerprint != mesh.fingerprint() {
            self.refuse(mesh, core::any::type_name::<M>(), remedy);
        }
    }

    #[cold]
    #[inline(never)]
    #[track_caller]
    fn refuse(&self, mesh: &TriangleMesh, method: &str, remedy: &str) -> ! {
        let other = Self::of(mesh);
        let same = (self.vertices, self.triangles) == (other.vertices, other.triangles);
        panic!(
            "{} was prepared for a mesh of {} vertices and {} triangles, and is used with another \
             mesh of {} vertices and {} triangles{}: {remedy}",
            WithoutPaths(method),
            self.vertices,
            self.triangles,
            other.vertices,
            other.triangles,
            if same {
                " (as many, but other ones)"
            } else {
                ""
            },
        );
    }
}

/// Panics unless memory that depends on a parameter of the method `M` was made with the value that the
/// method has now.
#[inline]
#[track_caller]
pub(crate) fn expect_parameter<M, P: PartialEq + fmt::Debug>(parameter: &str, made: P, now: P) {
    assert!(
        made == now,
        "{} was prepared with {parameter} {made:?}, and is used with {now:?}: make a workspace of \
         this method, by Method::workspace or Prepared::new",
        WithoutPaths(core::any::type_name::<M>()),
    );
}

/// The name of a type without the modules in it.
pub(crate) struct WithoutPaths<'a>(pub(crate) &'a str);

impl fmt::Display for WithoutPaths<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_separator = |c: char| !(c.is_alphanumeric() || c == '_' || c == ':');
        for part in self.0.split_inclusive(is_separator) {
            let name = part.rfind("::").map_or(part, |at| &part[at + 2..]);
            formatter.write_str(name)?;
        }
        Ok(())
    }
}
