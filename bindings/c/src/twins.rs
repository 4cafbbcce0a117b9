//! Functions for numbers in f64, with their twins in f32.

/// Makes a function for each number type, `$N` in its arguments, under two names that are written out: searches
/// find them. Each takes the error of the call as its last argument, and returns a status. cbindgen sees the
/// functions once macros are expanded (`.ci/bindings-c`).
macro_rules! twins {
    (
        $(#[$doc:meta])*
        fn $wide:ident, $narrow:ident<$d:tt $N:ident>($($arguments:tt)*) |$call:ident| $work:expr
    ) => {
        // `$d` is the `$` of `$N`, which this macro cannot write for the other one itself.
        macro_rules! twin {
            ($d(#[$d doc:meta])* $d name:ident $d $N:ident) => {
                $d(#[$d doc])*
                #[unsafe(no_mangle)]
                pub unsafe extern "C" fn $d name(
                    $($arguments)*
                    error: *mut $crate::status::Error,
                ) -> $crate::status::Status {
                    // SAFETY: the caller keeps the contract of this library.
                    unsafe { $crate::call::guarded(error, |$call| $work) }
                }
            };
        }
        twin! { $(#[$doc])* $wide f64 }
        twin! { #[doc = concat!(" Twin of ", stringify!($wide), " in f32.")] $narrow f32 }
    };
}
