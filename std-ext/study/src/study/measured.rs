//! Measurements of one method on one mesh, and the cache that keeps them.

use super::cache::Cache;
use super::timing::is_scattered;
use serde::{Deserialize, Serialize};

/// The measurements of one method on one mesh.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Measured {
    pub(super) vertices: usize,
    pub(super) ns_per_vertex: f64,
    pub(super) ns_scatter: f64,
    pub(super) bytes_per_vertex: Option<f64>,
    /// Largest and mean error of each quantity that is defined, in the order of all quantities.
    pub(super) errors: Vec<[f64; 2]>,
}

impl Measured {
    /// Caches the measurement, unless times were asked for and scatter: then it will be measured again.
    pub(super) fn keep(&self, key: String, timed: bool, cache: Option<&mut Cache>) {
        if let Some(cache) = cache
            && !(timed && is_scattered(self.ns_scatter))
        {
            cache.insert(key, self);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::provenance::{Build, Provenance};

    #[test]
    fn what_scatters_is_not_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("cache");
        let provenance = Provenance::here(Build {
            commit: "",
            compiler: "",
            profile: "",
            flags: "",
            target: "",
        });
        let measured = |ns_scatter| Measured {
            vertices: 42,
            ns_per_vertex: 100.0,
            ns_scatter,
            bytes_per_vertex: None,
            errors: vec![[0.2, 0.1]],
        };
        let open = || Cache::open(&path, &provenance).expect("a cache").cache;
        let mut cache = open();
        for (name, timed, scatter) in [
            ("steady", true, 0.1),
            ("scattered", true, 0.3),
            ("none", true, f64::NAN),
            ("errors alone", false, f64::NAN),
        ] {
            measured(scatter).keep(name.to_owned(), timed, Some(&mut cache));
        }
        cache.save().expect("a file");
        drop(cache);
        let kept = ["steady", "scattered", "none", "errors alone"];
        let kept = kept.map(|name| open().get::<Measured>(name));
        assert_eq!(kept.map(|kept| kept.is_some()), [true, false, false, true]);
    }
}
