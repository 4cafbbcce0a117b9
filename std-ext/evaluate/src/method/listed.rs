//! The methods of the list as types, to be made for any scalar: what holds for every method can be
//! tested for every method.

use super::{BendingMethod, Settings};
use helfrich::{Conservative, Curvatures, LaplaceBeltrami, Real, StrongForm};
use std::fmt;

/// The type of a method of the list, by its place in [`BendingMethod::NAMED`].
#[derive(Clone, Copy, Debug)]
pub struct Of<const PLACE: usize>;

impl<const PLACE: usize> Of<PLACE> {
    /// The method.
    pub const METHOD: BendingMethod = BendingMethod::NAMED[PLACE];
}

/// A method of the list whose forces are the gradient of its energy.
pub trait ListedEnergy {
    /// The method for the scalar T.
    type Method<T: Real>: Conservative<T>;

    /// Makes the method.
    fn method<T: Real>(settings: Settings<'_, T>) -> Self::Method<T>;
}

/// A method of the list in strong form.
pub trait ListedOperator {
    /// Its operator for the scalar T.
    type Operator<T: Real>: LaplaceBeltrami<T> + Copy + fmt::Debug + Sync + 'static;

    /// Makes the method.
    fn method<T: Real>(settings: Settings<'_, T>) -> StrongForm<T, Self::Operator<T>>;
}

/// An operator of the list for curvatures only.
pub trait ListedCurvatures {
    /// The operator for the scalar T.
    type Method<T: Real>: Curvatures<T> + Copy;

    /// Makes the operator.
    fn method<T: Real>(settings: Settings<'_, T>) -> Self::Method<T>;
}

/// A use of the types of methods; a kind that is of no use is passed over.
pub trait ListVisitor {
    /// Takes a method with an energy.
    fn energy<const PLACE: usize>(&mut self, _method: Of<PLACE>)
    where
        Of<PLACE>: ListedEnergy,
    {
    }

    /// Takes a method in strong form.
    fn strong_form<const PLACE: usize>(&mut self, _method: Of<PLACE>)
    where
        Of<PLACE>: ListedOperator,
    {
    }

    /// Takes an operator for curvatures only.
    fn curvatures<const PLACE: usize>(&mut self, _method: Of<PLACE>)
    where
        Of<PLACE>: ListedCurvatures,
    {
    }
}
