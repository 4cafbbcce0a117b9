//! Functions for numbers in f64, with their twins in f32.

/// Defines one function for f64 and one for f32; `$N` in the arguments is the number type. Both names are written
/// out, so that text searches find them. Each function has a last argument, the error of the call, and returns a
/// status. cbindgen reads the source after the expansion of macros (`.ci/bindings-c`).
macro_rules! twins {
    (
        $(#[$doc:meta])*
        fn $wide:ident, $narrow:ident<$d:tt $N:ident>($($arguments:tt)*) |$call:ident| $work:expr
    ) => {
        // `$d` is the token `$`, without which this macro cannot write the variables of `twin!`.
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
