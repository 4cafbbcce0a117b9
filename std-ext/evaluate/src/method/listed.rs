//! Methods as types that can be made for any scalar: the methods of the list, so that tests can cover every
//! method, and others.

use super::{BendingMethod, Description, Settings};
use helfrich::{Conservative, Curvatures, LaplaceBeltrami, Real, StrongForm};
use std::fmt;

/// Type of a method of the list, by its index in [`BendingMethod::NAMED`].
#[derive(Clone, Copy, Debug)]
pub struct Of<const PLACE: usize>;

impl<const PLACE: usize> Of<PLACE> {
    /// The method.
    pub const METHOD: BendingMethod = BendingMethod::NAMED[PLACE];
}

/// A method with a description.
pub trait Described {
    /// The description.
    const DESCRIPTION: &'static Description;
}

impl<const PLACE: usize> Described for Of<PLACE> {
    const DESCRIPTION: &'static Description = BendingMethod::NAMED[PLACE].description();
}

/// A method whose forces are the gradient of its energy.
pub trait ListedEnergy: Described {
    /// The method for the scalar T.
    type Method<T: Real>: Conservative<T> + fmt::Debug + Send + 'static;

    /// Makes the method.
    fn method<T: Real>(settings: Settings<'_, T>) -> Self::Method<T>;
}

/// A method in strong form.
pub trait ListedOperator: Described {
    /// Its operator for the scalar T.
    type Operator<T: Real>: LaplaceBeltrami<T> + Copy + fmt::Debug + Send + Sync + 'static;

    /// Makes the method.
    fn method<T: Real>(settings: Settings<'_, T>) -> StrongForm<T, Self::Operator<T>>;
}

/// An operator for curvatures only.
pub trait ListedCurvatures: Described {
    /// The operator for the scalar T.
    type Method<T: Real>: Curvatures<T> + Copy + fmt::Debug + Send + 'static;

    /// Makes the operator.
    fn method<T: Real>(settings: Settings<'_, T>) -> Self::Method<T>;
}

/// A use of the types of methods; a kind without an implementation is ignored.
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
