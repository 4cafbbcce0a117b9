//! Methods that are not in the list, together with listed ones.

use super::evaluator::Preparing;
use super::{
    BendingMethod, Compiled, Description, Evaluator, ListedCurvatures, ListedEnergy,
    ListedOperator, MethodOptions, Settings, Visitor,
};
use crate::act::Act;
use crate::execute::Parallel;
use helfrich::{Curvatures, TriangleMesh};
use serde::{Serialize, Serializer};
use std::fmt;

/// A method of the list or one of your own.
///
/// Two methods are equal if their names are equal.
#[derive(Clone, Copy, Debug)]
pub enum AnyMethod {
    /// A method of the list.
    Listed(BendingMethod),
    /// Any other method.
    Own(OwnMethod),
}

impl AnyMethod {
    /// The description of the method.
    pub const fn description(self) -> &'static Description {
        match self {
            Self::Listed(method) => method.description(),
            Self::Own(method) => method.description,
        }
    }

    /// The long name, as on the command line.
    pub fn name(self) -> &'static str {
        self.description().name
    }

    /// A short label, for curves.
    pub fn label(self) -> &'static str {
        self.description().label
    }

    /// The name in titles.
    pub fn title(self) -> &'static str {
        self.description().title
    }

    /// The idea in a few words.
    pub fn idea(self) -> &'static str {
        self.description().idea
    }

    /// Whether its forces are the exact gradient of an energy.
    pub const fn is_conservative(self) -> bool {
        match self {
            Self::Listed(method) => method.is_conservative(),
            Self::Own(method) => matches!(method.form, Form::Energy),
        }
    }

    /// See [`BendingMethod::has_error_bars`].
    pub const fn has_error_bars(self) -> bool {
        match self {
            Self::Listed(method) => method.has_error_bars(),
            Self::Own(_) => false,
        }
    }

    /// Whether it has forces: operators for curvatures only have none.
    pub const fn has_force(self) -> bool {
        match self {
            Self::Listed(method) => method.has_force(),
            Self::Own(method) => !matches!(method.form, Form::Curvatures),
        }
    }

    /// Prepares the method as [`Evaluator::with_options`] does.
    pub fn evaluator<T: Compiled>(
        self,
        options: &MethodOptions,
        modulus: T,
        mesh: &TriangleMesh,
        threads: Parallel,
    ) -> Evaluator<T> {
        match self {
            Self::Listed(method) => {
                Evaluator::with_options(method, options, modulus, mesh, threads)
            }
            Self::Own(method) => T::own_evaluator(method, modulus, mesh, threads),
        }
    }

    /// Checks that no two methods of your own have the same name.
    ///
    /// # Errors
    /// The first name that occurs twice.
    pub fn check_names(methods: &[Self]) -> Result<(), RepeatedName> {
        for (index, method) in methods.iter().enumerate() {
            if matches!(method, Self::Own(_)) && methods[..index].contains(method) {
                let name = method.name();
                return Err(RepeatedName { name });
            }
        }
        Ok(())
    }
}

/// Error for two methods of your own with the same name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "there are two methods of your own with the name `{name}`: results are identified by names; choose \
     another for one of them, or leave it out"
)]
pub struct RepeatedName {
    /// The name.
    pub name: &'static str,
}

impl PartialEq for AnyMethod {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for AnyMethod {}

impl PartialEq<BendingMethod> for AnyMethod {
    fn eq(&self, other: &BendingMethod) -> bool {
        *self == Self::Listed(*other)
    }
}

impl From<BendingMethod> for AnyMethod {
    fn from(method: BendingMethod) -> Self {
        Self::Listed(method)
    }
}

impl From<OwnMethod> for AnyMethod {
    fn from(method: OwnMethod) -> Self {
        Self::Own(method)
    }
}

impl fmt::Display for AnyMethod {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl Serialize for AnyMethod {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Function that makes a method evaluable in one number type.
pub(super) type Make<T> = fn(Settings<'_, T>, Preparing<'_, T, Parallel>) -> Box<dyn Act<T>>;

#[derive(Clone, Copy, Debug)]
enum Form {
    Energy,
    Strong,
    Curvatures,
}

/// A method that is not in the list, for `study`, `recommend` and the page. It is compiled in f32 and f64
/// where it is named.
///
/// The compiler checks its [`Description`]: the name must be new and easy to type in a shell, and the
/// quantities that it claims to define must be possible for a method of its kind.
///
/// ```
/// use helfrich::{CorrectedCurvature, Real, VertexNormals};
/// use helfrich_evaluate::method::{Described, Description, ListedCurvatures, OwnMethod, Settings};
///
/// struct Mine;
///
/// impl Described for Mine {
///     const DESCRIPTION: &'static Description = &Description {
///         name: "mine",
///         letter: None,
///         label: "M",
///         title: "Mine",
///         idea: "curvature of interpolated normals",
///         defines: [true, true, false],
///     };
/// }
///
/// impl ListedCurvatures for Mine {
///     type Method<T: Real> = CorrectedCurvature;
///
///     fn method<T: Real>(_: Settings<'_, T>) -> CorrectedCurvature {
///         CorrectedCurvature { normals: VertexNormals::Averaged }
///     }
/// }
///
/// const MINE: OwnMethod = OwnMethod::curvatures::<Mine>();
/// ```
///
/// A name that is already taken is a compile error:
///
/// ```compile_fail
/// # use helfrich::{CorrectedCurvature, Real, VertexNormals};
/// # use helfrich_evaluate::method::{Described, Description, ListedCurvatures, OwnMethod, Settings};
/// # struct Mine;
/// # impl Described for Mine {
/// #     const DESCRIPTION: &'static Description = &Description {
/// #         name: "meyer", letter: None, label: "M", title: "Mine", idea: "", defines: [true, true, false],
/// #     };
/// # }
/// # impl ListedCurvatures for Mine {
/// #     type Method<T: Real> = CorrectedCurvature;
/// #     fn method<T: Real>(_: Settings<'_, T>) -> CorrectedCurvature {
/// #         CorrectedCurvature { normals: VertexNormals::Averaged }
/// #     }
/// # }
/// const MINE: OwnMethod = OwnMethod::curvatures::<Mine>();
/// ```
#[derive(Clone, Copy, Debug)]
pub struct OwnMethod {
    description: &'static Description,
    form: Form,
    pub(super) single: Make<f32>,
    pub(super) double: Make<f64>,
}

impl OwnMethod {
    /// A method with an energy that defines no curvatures.
    pub const fn energy<M: ListedEnergy>() -> Self {
        Self {
            description: const { checked(M::DESCRIPTION, [false; 3], [false; 3]) },
            form: Form::Energy,
            single: |settings, preparing| preparing.energy(M::method(settings)),
            double: |settings, preparing| preparing.energy(M::method(settings)),
        }
    }

    /// A method with an energy that defines H, or H and K.
    pub const fn energy_and_curvatures<M: ListedEnergy>() -> Self
    where
        M::Method<f32>: Curvatures<f32>,
        M::Method<f64>: Curvatures<f64>,
    {
        Self {
            description: const { checked(M::DESCRIPTION, [true, false, false], [true, true, false]) },
            form: Form::Energy,
            single: |settings, preparing| preparing.energy_and_curvatures(M::method(settings)),
            double: |settings, preparing| preparing.energy_and_curvatures(M::method(settings)),
        }
    }

    /// A method in strong form, which defines H, K and Δ_S H.
    pub const fn strong_form<M: ListedOperator>() -> Self {
        Self {
            description: const { checked(M::DESCRIPTION, [true; 3], [true; 3]) },
            form: Form::Strong,
            single: |settings, preparing| preparing.strong_form(M::method(settings)),
            double: |settings, preparing| preparing.strong_form(M::method(settings)),
        }
    }

    /// An operator without a force, which defines H and K.
    pub const fn curvatures<M: ListedCurvatures>() -> Self {
        Self {
            description: const { checked(M::DESCRIPTION, [true, true, false], [true, true, false]) },
            form: Form::Curvatures,
            single: |settings, preparing| preparing.curvatures(M::method(settings)),
            double: |settings, preparing| preparing.curvatures(M::method(settings)),
        }
    }
}

/// Checks a description of a method that must define at least `least` and at most `most` of H, K and Δ_S H.
const fn checked(
    description: &'static Description,
    least: [bool; 3],
    most: [bool; 3],
) -> &'static Description {
    let Description {
        name,
        letter,
        defines,
        ..
    } = description;
    let mut characters = name.as_bytes();
    assert!(!characters.is_empty(), "the name of a method is empty");
    while let [character, rest @ ..] = characters {
        assert!(
            matches!(character, b'a'..=b'z' | b'0'..=b'9' | b'-'),
            "the name of a method has lower-case letters, digits and hyphens only: it is typed in a \
             shell, and files are named after it"
        );
        characters = rest;
    }
    assert!(
        !is_taken(name),
        "the name of the method is that of a method of the list: choose another"
    );
    if let Some(letter) = letter {
        assert!(
            !is_taken(letter),
            "the letter of the method is that of a method of the list: choose another, or none"
        );
    }
    let mut quantity = 0;
    while quantity < defines.len() {
        let defined = defines[quantity];
        assert!(
            defined || !least[quantity],
            "a method of this kind defines more of H, K and Δ_S H than its description says"
        );
        assert!(
            most[quantity] || !defined,
            "a method of this kind does not define all of H, K and Δ_S H that its description says"
        );
        quantity += 1;
    }
    description
}

/// Whether a method of the list has this name or letter, or whether it is the name for all methods.
const fn is_taken(name: &str) -> bool {
    let mut place = 0;
    while place < BendingMethod::NAMED.len() {
        let listed = BendingMethod::NAMED[place].description();
        if name.eq_ignore_ascii_case(listed.name) {
            return true;
        }
        if let Some(letter) = listed.letter
            && name.eq_ignore_ascii_case(letter)
        {
            return true;
        }
        place += 1;
    }
    name.eq_ignore_ascii_case("all")
}
