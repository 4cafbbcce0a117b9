//! Zero-copy views of point slices. No other file names glam and nalgebra.

use crate::real::Real;
use alloc::vec::Vec;

/// A sequence of points that can be read as `[x, y, z]` triples without a copy.
///
/// Implemented for slices, arrays and vectors of `[T; 3]`, `glam::Vec3` and `glam::DVec3` (feature
/// `glam`), `nalgebra::Point3<T>` and `nalgebra::Vector3<T>` (feature `nalgebra`).
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot be read as a slice of `[x, y, z]` triples",
    label = "not a sequence of tightly packed points",
    note = "points are slices of `[T; 3]`, `glam::Vec3`, `glam::DVec3`, `nalgebra::Point3<T>` or `nalgebra::Vector3<T>`, with the `glam` or `nalgebra` feature of `helfrich`",
    note = "`glam::Vec3A` has a padding lane and cannot be viewed without a copy: store `glam::Vec3`",
    note = "`helfrich` knows glam 0.34 and nalgebra 0.35: points of another version are other types with the same names; `cargo tree -i glam` or `cargo tree -i nalgebra` shows whether there are two versions"
)]
pub trait Points {
    /// The coordinates' type.
    type Scalar: Real;
    /// The points as triples, in the same order and memory.
    fn coordinates(&self) -> &[[Self::Scalar; 3]];
}

/// A [`Points`] sequence that can be written to in place.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot be written as a slice of `[x, y, z]` triples",
    label = "not a sequence of tightly packed points",
    note = "`glam::Vec3A` has a padding lane and cannot be viewed without a copy: store `glam::Vec3`",
    note = "`helfrich` knows glam 0.34 and nalgebra 0.35: points of another version are other types with the same names; `cargo tree -i glam` or `cargo tree -i nalgebra` shows whether there are two versions"
)]
pub trait PointsMut: Points {
    /// The points as triples, in the same order and memory.
    fn coordinates_mut(&mut self) -> &mut [[Self::Scalar; 3]];
}

impl<T: Real> Points for [[T; 3]] {
    type Scalar = T;
    #[inline]
    fn coordinates(&self) -> &[[T; 3]] {
        self
    }
}

impl<T: Real> PointsMut for [[T; 3]] {
    #[inline]
    fn coordinates_mut(&mut self) -> &mut [[T; 3]] {
        self
    }
}

impl<P> Points for Vec<P>
where
    [P]: Points,
{
    type Scalar = <[P] as Points>::Scalar;
    #[inline]
    fn coordinates(&self) -> &[[Self::Scalar; 3]] {
        self.as_slice().coordinates()
    }
}

impl<P> PointsMut for Vec<P>
where
    [P]: PointsMut,
{
    #[inline]
    fn coordinates_mut(&mut self) -> &mut [[Self::Scalar; 3]] {
        self.as_mut_slice().coordinates_mut()
    }
}

impl<P, const N: usize> Points for [P; N]
where
    [P]: Points,
{
    type Scalar = <[P] as Points>::Scalar;
    #[inline]
    fn coordinates(&self) -> &[[Self::Scalar; 3]] {
        self.as_slice().coordinates()
    }
}

impl<P, const N: usize> PointsMut for [P; N]
where
    [P]: PointsMut,
{
    #[inline]
    fn coordinates_mut(&mut self) -> &mut [[Self::Scalar; 3]] {
        self.as_mut_slice().coordinates_mut()
    }
}

#[cfg(feature = "glam")]
mod glam_points {
    use super::{Points, PointsMut};

    impl Points for [glam::Vec3] {
        type Scalar = f32;
        #[inline]
        fn coordinates(&self) -> &[[f32; 3]] {
            bytemuck::cast_slice(self)
        }
    }

    impl PointsMut for [glam::Vec3] {
        #[inline]
        fn coordinates_mut(&mut self) -> &mut [[f32; 3]] {
            bytemuck::cast_slice_mut(self)
        }
    }

    impl Points for [glam::DVec3] {
        type Scalar = f64;
        #[inline]
        fn coordinates(&self) -> &[[f64; 3]] {
            bytemuck::cast_slice(self)
        }
    }

    impl PointsMut for [glam::DVec3] {
        #[inline]
        fn coordinates_mut(&mut self) -> &mut [[f64; 3]] {
            bytemuck::cast_slice_mut(self)
        }
    }
}

#[cfg(feature = "nalgebra")]
mod nalgebra_points {
    use super::{Points, PointsMut};
    use crate::real::Real;
    use bytemuck::Pod;
    use nalgebra::{Point3, Scalar, Vector3};

    impl<T: Real + Scalar + Pod> Points for [Point3<T>] {
        type Scalar = T;
        #[inline]
        fn coordinates(&self) -> &[[T; 3]] {
            bytemuck::cast_slice(self)
        }
    }

    impl<T: Real + Scalar + Pod> PointsMut for [Point3<T>] {
        #[inline]
        fn coordinates_mut(&mut self) -> &mut [[T; 3]] {
            bytemuck::cast_slice_mut(self)
        }
    }

    impl<T: Real + Scalar + Pod> Points for [Vector3<T>] {
        type Scalar = T;
        #[inline]
        fn coordinates(&self) -> &[[T; 3]] {
            bytemuck::cast_slice(self)
        }
    }

    impl<T: Real + Scalar + Pod> PointsMut for [Vector3<T>] {
        #[inline]
        fn coordinates_mut(&mut self) -> &mut [[T; 3]] {
            bytemuck::cast_slice_mut(self)
        }
    }
}
