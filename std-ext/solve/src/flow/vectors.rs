//! Single and double precision as pulp's vectors, behind one name.

use helfrich::Real;
use helfrich_execute::team::Pod;
use pulp::Simd;
use std::ops::{Add, Div, Mul, Sub};

/// The numbers of large sums and of populations: `f32` and `f64`.
pub trait Vectors: Real + Pod {
    /// A vector of these numbers.
    type Of<S: Simd>: Copy;

    fn rows<S: Simd>(row: &[Self]) -> (&[Self::Of<S>], &[Self]);
    fn rows_mut<S: Simd>(row: &mut [Self]) -> (&mut [Self::Of<S>], &mut [Self]);
    fn splat<S: Simd>(simd: S, value: Self) -> Self::Of<S>;
    /// The vector of these entries, padded with zeros.
    fn load<S: Simd>(simd: S, start: &[Self]) -> Self::Of<S>;
    /// Stores the first entries, as many as fit.
    fn store<S: Simd>(simd: S, start: &mut [Self], vector: Self::Of<S>);
    fn plus<S: Simd>(simd: S, a: Self::Of<S>, b: Self::Of<S>) -> Self::Of<S>;
    fn minus<S: Simd>(simd: S, a: Self::Of<S>, b: Self::Of<S>) -> Self::Of<S>;
    fn times<S: Simd>(simd: S, a: Self::Of<S>, b: Self::Of<S>) -> Self::Of<S>;
    fn over<S: Simd>(simd: S, a: Self::Of<S>, b: Self::Of<S>) -> Self::Of<S>;
    /// `a b + c`, rounded once where the processor can.
    fn times_plus<S: Simd>(simd: S, a: Self::Of<S>, b: Self::Of<S>, c: Self::Of<S>) -> Self::Of<S>;
    fn root<S: Simd>(simd: S, a: Self::Of<S>) -> Self::Of<S>;
    /// `a` where `test` is a normal number above 0, and 0 elsewhere.
    fn where_positive<S: Simd>(simd: S, test: Self::Of<S>, a: Self::Of<S>) -> Self::Of<S>;
}

/// A vector that is computed with.
#[derive(Clone, Copy)]
pub(super) struct Vector<T: Vectors, S: Simd> {
    simd: S,
    entries: T::Of<S>,
}

impl<T: Vectors, S: Simd> Vector<T, S> {
    #[inline(always)]
    pub(super) fn new(simd: S, entries: T::Of<S>) -> Self {
        Self { simd, entries }
    }

    #[inline(always)]
    pub(super) fn splat(simd: S, value: T) -> Self {
        Self::new(simd, T::splat(simd, value))
    }

    #[inline(always)]
    pub(super) fn constant(simd: S, value: f64) -> Self {
        Self::splat(simd, T::constant(value))
    }

    #[inline(always)]
    pub(super) fn entries(self) -> T::Of<S> {
        self.entries
    }

    /// `self factor + term`, rounded once where the processor can.
    #[inline(always)]
    pub(super) fn times_plus(self, factor: Self, term: Self) -> Self {
        let entries = T::times_plus(self.simd, self.entries, factor.entries, term.entries);
        Self::new(self.simd, entries)
    }

    #[inline(always)]
    pub(super) fn times(self, factor: f64) -> Self {
        self * Self::constant(self.simd, factor)
    }

    #[inline(always)]
    pub(super) fn reciprocal(self) -> Self {
        Self::constant(self.simd, 1.0) / self
    }

    #[inline(always)]
    pub(super) fn root(self) -> Self {
        Self::new(self.simd, T::root(self.simd, self.entries))
    }

    /// Itself where `test` is a normal number above 0, and 0 elsewhere.
    #[inline(always)]
    pub(super) fn where_positive(self, test: Self) -> Self {
        let entries = T::where_positive(self.simd, test.entries, self.entries);
        Self::new(self.simd, entries)
    }
}

impl<T: Vectors, S: Simd> Add for Vector<T, S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.simd, T::plus(self.simd, self.entries, other.entries))
    }
}

impl<T: Vectors, S: Simd> Sub for Vector<T, S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.simd, T::minus(self.simd, self.entries, other.entries))
    }
}

impl<T: Vectors, S: Simd> Mul for Vector<T, S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::new(self.simd, T::times(self.simd, self.entries, other.entries))
    }
}

impl<T: Vectors, S: Simd> Div for Vector<T, S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self::new(self.simd, T::over(self.simd, self.entries, other.entries))
    }
}

impl Vectors for f32 {
    type Of<S: Simd> = S::f32s;

    #[inline(always)]
    fn rows<S: Simd>(row: &[Self]) -> (&[S::f32s], &[Self]) {
        S::as_simd_f32s(row)
    }
    #[inline(always)]
    fn rows_mut<S: Simd>(row: &mut [Self]) -> (&mut [S::f32s], &mut [Self]) {
        S::as_mut_simd_f32s(row)
    }
    #[inline(always)]
    fn splat<S: Simd>(simd: S, value: Self) -> S::f32s {
        simd.splat_f32s(value)
    }
    #[inline(always)]
    fn load<S: Simd>(simd: S, start: &[Self]) -> S::f32s {
        simd.partial_load_f32s(start)
    }
    #[inline(always)]
    fn store<S: Simd>(simd: S, start: &mut [Self], vector: S::f32s) {
        simd.partial_store_f32s(start, vector);
    }
    #[inline(always)]
    fn plus<S: Simd>(simd: S, a: S::f32s, b: S::f32s) -> S::f32s {
        simd.add_f32s(a, b)
    }
    #[inline(always)]
    fn minus<S: Simd>(simd: S, a: S::f32s, b: S::f32s) -> S::f32s {
        simd.sub_f32s(a, b)
    }
    #[inline(always)]
    fn times<S: Simd>(simd: S, a: S::f32s, b: S::f32s) -> S::f32s {
        simd.mul_f32s(a, b)
    }
    #[inline(always)]
    fn over<S: Simd>(simd: S, a: S::f32s, b: S::f32s) -> S::f32s {
        simd.div_f32s(a, b)
    }
    #[inline(always)]
    fn times_plus<S: Simd>(simd: S, a: S::f32s, b: S::f32s, c: S::f32s) -> S::f32s {
        simd.mul_add_e_f32s(a, b, c)
    }
    #[inline(always)]
    fn root<S: Simd>(simd: S, a: S::f32s) -> S::f32s {
        simd.sqrt_f32s(a)
    }
    #[inline(always)]
    fn where_positive<S: Simd>(simd: S, test: S::f32s, a: S::f32s) -> S::f32s {
        let positive = simd.greater_than_or_equal_f32s(test, simd.splat_f32s(f32::MIN_POSITIVE));
        simd.select_f32s(positive, a, simd.splat_f32s(0.0))
    }
}

impl Vectors for f64 {
    type Of<S: Simd> = S::f64s;

    #[inline(always)]
    fn rows<S: Simd>(row: &[Self]) -> (&[S::f64s], &[Self]) {
        S::as_simd_f64s(row)
    }
    #[inline(always)]
    fn rows_mut<S: Simd>(row: &mut [Self]) -> (&mut [S::f64s], &mut [Self]) {
        S::as_mut_simd_f64s(row)
    }
    #[inline(always)]
    fn splat<S: Simd>(simd: S, value: Self) -> S::f64s {
        simd.splat_f64s(value)
    }
    #[inline(always)]
    fn load<S: Simd>(simd: S, start: &[Self]) -> S::f64s {
        simd.partial_load_f64s(start)
    }
    #[inline(always)]
    fn store<S: Simd>(simd: S, start: &mut [Self], vector: S::f64s) {
        simd.partial_store_f64s(start, vector);
    }
    #[inline(always)]
    fn plus<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s {
        simd.add_f64s(a, b)
    }
    #[inline(always)]
    fn minus<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s {
        simd.sub_f64s(a, b)
    }
    #[inline(always)]
    fn times<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s {
        simd.mul_f64s(a, b)
    }
    #[inline(always)]
    fn over<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s {
        simd.div_f64s(a, b)
    }
    #[inline(always)]
    fn times_plus<S: Simd>(simd: S, a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s {
        simd.mul_add_e_f64s(a, b, c)
    }
    #[inline(always)]
    fn root<S: Simd>(simd: S, a: S::f64s) -> S::f64s {
        simd.sqrt_f64s(a)
    }
    #[inline(always)]
    fn where_positive<S: Simd>(simd: S, test: S::f64s, a: S::f64s) -> S::f64s {
        let positive = simd.greater_than_or_equal_f64s(test, simd.splat_f64s(f64::MIN_POSITIVE));
        simd.select_f64s(positive, a, simd.splat_f64s(0.0))
    }
}
