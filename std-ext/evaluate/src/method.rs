//! Bending methods, chosen at run time: the methods of the list, and others as [`OwnMethod`].
//!
//! A method is chosen once per surface, in one place; everything below is resolved at compile time.
//! Methods run on all threads, and large meshes are reordered.

mod border;
mod choice;
mod evaluator;
mod fields;
mod listed;
mod operator;
mod options;
mod own;
mod relative;

pub use choice::Settings;
pub(crate) use choice::Visitor;
pub use evaluator::{Compiled, Evaluated, Evaluator, Wanted};
pub use fields::Fields;
pub use listed::{Described, ListVisitor, ListedCurvatures, ListedEnergy, ListedOperator, Of};
pub use operator::{NoOperator, OperatorMatrix};
pub use options::{InvalidBandwidth, MethodOptions, UnknownAreas, UnusedOption};
pub use own::{AnyMethod, OwnMethod, RepeatedName};

use helfrich::{
    ControlPoints, CorrectedCurvature, Cotangent, Galerkin, GompperKroll, Hamann, HeatKernel, Jet,
    Juelicher, KantorNelson, LoopSubdivision, Paraboloid, Real, StrongForm, VertexNormals,
};
use relative::relative;
use std::fmt;
use std::str::FromStr;

/// Description of a method, apart from its formula.
#[derive(Clone, Copy, Debug)]
pub struct Description {
    /// The long name, as on the command line.
    pub name: &'static str,
    /// The letter in Guckenberger et al. 2016, or J for the jets; `None` for methods without one.
    pub letter: Option<&'static str>,
    /// A short label, for curves.
    pub label: &'static str,
    /// The name in titles.
    pub title: &'static str,
    /// The idea in a few words.
    pub idea: &'static str,
    /// Whether the method defines H, K and Δ_S H at a vertex.
    pub defines: [bool; 3],
}

/// Cost of a method of the list.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// Time of an evaluation of f, or of H and K for operators without a force, relative to that of method B.
    pub relative: f64,
    /// Memory of the prepared method after its first evaluation in bytes per vertex, as measured on meshes of
    /// 2562 vertices.
    pub bytes: Bytes,
}

/// Memory of a prepared method in bytes per vertex.
#[derive(Clone, Copy, Debug)]
pub enum Bytes {
    /// The same number of bytes on any mesh.
    Fixed(u64),
    /// Bytes on meshes whose vertices have five or six neighbours, and bytes on other meshes.
    ByValence([u64; 2]),
    /// A fixed part, and a part proportional to the bandwidth in mean areas of a vertex.
    ByBandwidth([f64; 2]),
}

/// Defines [`BendingMethod`] and everything that follows from the list of methods: names, descriptions, the
/// methods as types, and the only place where a name selects a method of the core.
///
/// An entry consists of the kind of the method, its type for the scalar T (in strong form, the type of its
/// operator), its constructor, its description and its memory; its time is in `relative.rs`. The kinds are those of
/// [`Visitor`].
macro_rules! methods {
    (@is_conservative energy) => { true };
    (@is_conservative energy_and_curvatures) => { true };
    (@is_conservative energy_and_density) => { true };
    (@is_conservative $form:ident) => { false };
    (@has_force curvatures) => { false };
    (@has_force $form:ident) => { true };
    (@listed curvatures $method:ident $type:ty, $make:expr) => {
        impl ListedCurvatures for Of<{ BendingMethod::$method as usize }> {
            type Method<T: Real> = $type;

            fn method<T: Real>(settings: Settings<'_, T>) -> $type {
                ($make)(settings)
            }
        }
    };
    (@listed strong_form $method:ident $type:ty, $make:expr) => {
        impl ListedOperator for Of<{ BendingMethod::$method as usize }> {
            type Operator<T: Real> = $type;

            fn method<T: Real>(settings: Settings<'_, T>) -> StrongForm<T, $type> {
                ($make)(settings)
            }
        }
    };
    (@listed $form:ident $method:ident $type:ty, $make:expr) => {
        impl ListedEnergy for Of<{ BendingMethod::$method as usize }> {
            type Method<T: Real> = $type;

            fn method<T: Real>(settings: Settings<'_, T>) -> $type {
                ($make)(settings)
            }
        }
    };
    (@visit curvatures $method:ident $visitor:ident) => {
        $visitor.curvatures(Of::<{ BendingMethod::$method as usize }>);
    };
    (@visit strong_form $method:ident $visitor:ident) => {
        $visitor.strong_form(Of::<{ BendingMethod::$method as usize }>);
    };
    (@visit $form:ident $method:ident $visitor:ident) => {
        $visitor.energy(Of::<{ BendingMethod::$method as usize }>);
    };
    (
        all {
            $(
                $(#[$documentation:meta])*
                $method:ident: $form:ident($type:ty, $make:expr), $description:expr, $bytes:expr;
            )*
        }
        by_mesh {
            $(#[$by_mesh_documentation:meta])*
            $by_mesh:ident: $by_mesh_form:ident($by_mesh_type:ty, $by_mesh_make:expr),
            $by_mesh_description:expr, $by_mesh_bytes:expr;
        }
        curvatures_only {
            $(
                $(#[$measure_documentation:meta])*
                $measure:ident: $measure_form:ident($measure_type:ty, $measure_make:expr),
                $measure_description:expr, $measure_bytes:expr;
            )*
        }
    ) => {
        /// A bending method, by its name in the field and its letter in Guckenberger et al. 2016, or an
        /// operator for curvatures only.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum BendingMethod {
            $($(#[$documentation])* $method,)*
            $(#[$by_mesh_documentation])* $by_mesh,
            $($(#[$measure_documentation])* $measure,)*
        }

        impl BendingMethod {
            /// Every bending method, with J in its three degrees.
            pub const ALL: [Self; [$(stringify!($method)),*].len()] = [$(Self::$method),*];

            /// Every operator for curvatures only.
            pub const CURVATURES: [Self; [$(stringify!($measure)),*].len()] =
                [$(Self::$measure),*];

            /// Every bending method, the one that is chosen by the mesh, and every operator for
            /// curvatures only.
            pub const NAMED: [Self; Self::ALL.len() + 1 + Self::CURVATURES.len()] =
                [$(Self::$method,)* Self::$by_mesh, $(Self::$measure,)*];

            /// Whether its forces are the exact gradient of an energy.
            pub const fn is_conservative(self) -> bool {
                match self {
                    $(Self::$method => methods!(@is_conservative $form),)*
                    Self::$by_mesh => methods!(@is_conservative $by_mesh_form),
                    $(Self::$measure => methods!(@is_conservative $measure_form),)*
                }
            }

            /// Whether it has forces: operators for curvatures only have none.
            pub const fn has_force(self) -> bool {
                match self {
                    $(Self::$method => methods!(@has_force $form),)*
                    Self::$by_mesh => methods!(@has_force $by_mesh_form),
                    $(Self::$measure => methods!(@has_force $measure_form),)*
                }
            }

            /// Whether its degree and scale follow from the mesh and from the noise, so that surfaces can be measured
            /// with error bars ([`helfrich::AdaptiveJet`]).
            pub const fn has_error_bars(self) -> bool {
                matches!(self, Self::$by_mesh)
            }

            /// The description of the method.
            pub const fn description(self) -> &'static Description {
                match self {
                    $(Self::$method => const { &$description },)*
                    Self::$by_mesh => const { &$by_mesh_description },
                    $(Self::$measure => const { &$measure_description },)*
                }
            }

            /// The cost of the method.
            pub const fn cost(self) -> Cost {
                let bytes = match self {
                    $(Self::$method => $bytes,)*
                    Self::$by_mesh => $by_mesh_bytes,
                    $(Self::$measure => $measure_bytes,)*
                };
                Cost { relative: relative(self), bytes }
            }
        }

        /// Calls `visitor` with the method of this name.
        pub(crate) fn choose<T: Real, V: Visitor<T>>(
            method: BendingMethod,
            settings: Settings<'_, T>,
            visitor: V,
        ) -> V::Output {
            match method {
                $(BendingMethod::$method => visitor.$form(($make)(settings)),)*
                BendingMethod::$by_mesh => visitor.$by_mesh_form(($by_mesh_make)(settings)),
                $(BendingMethod::$measure => visitor.$measure_form(($measure_make)(settings)),)*
            }
        }

        $(methods!(@listed $form $method $type, $make);)*
        $(methods!(@listed $measure_form $measure $measure_type, $measure_make);)*

        /// Hands the type of every method of [`BendingMethod::ALL`] and
        /// [`BendingMethod::CURVATURES`] to `visitor`, in their order.
        pub fn for_each_listed(visitor: &mut impl ListVisitor) {
            $(methods!(@visit $form $method visitor);)*
            $(methods!(@visit $measure_form $measure visitor);)*
        }
    };
}

methods! {
    all {
        /// A: dihedral angles.
        KantorNelson: energy(KantorNelson<T>, |settings: Settings<'_, T>| KantorNelson::new(settings.modulus.at(0))),
        Description {
            name: "kantor-nelson",
            letter: Some("A"),
            label: "A",
            title: "Kantor–Nelson",
            idea: "angles between triangles",
            defines: [false, false, false],
        },
        Bytes::Fixed(90);
        /// B: squared cotangent Laplacian.
        GompperKroll: energy_and_curvatures(GompperKroll<T>, |settings: Settings<'_, T>| GompperKroll {
            modulus: settings.modulus,
            spontaneous_curvature: settings.spontaneous_curvature,
            area: settings.options.areas_or_default(),
        }),
        Description {
            name: "gompper-kroll",
            letter: Some("B"),
            label: "B",
            title: "Gompper–Kroll",
            idea: "energy of the cotangent Laplacian",
            defines: [true, false, false],
        },
        Bytes::Fixed(65);
        /// C: strong form over the cotangent operator.
        Meyer: strong_form(Cotangent, |settings: Settings<'_, T>| {
            let areas = settings.options.areas_or_default();
            settings.strong_form(Cotangent::new(areas))
        }),
        Description {
            name: "meyer",
            letter: Some("C"),
            label: "C",
            title: "Meyer et al.",
            idea: "cotangent Laplacian, applied twice",
            defines: [true, true, true],
        },
        Bytes::Fixed(185);
        /// D: strong form over a heat kernel.
        Belkin: strong_form(HeatKernel<T>, |settings: Settings<'_, T>| {
            let bandwidth = settings.options.bandwidth_or_default();
            settings.strong_form(HeatKernel::new(bandwidth))
        }),
        Description {
            name: "belkin",
            letter: Some("D"),
            label: "D",
            title: "Belkin et al.",
            idea: "heat kernel",
            defines: [true, true, true],
        },
        Bytes::ByBandwidth([240.0, 2260.0]);
        /// E: strong form over paraboloids fitted to one-rings.
        Farutin: strong_form(Paraboloid, |settings: Settings<'_, T>| {
            settings.strong_form(Paraboloid::default())
        }),
        Description {
            name: "farutin",
            letter: Some("E"),
            label: "E",
            title: "Farutin et al.",
            idea: "paraboloids fitted to neighbours",
            defines: [true, true, true],
        },
        Bytes::Fixed(250);
        /// S: the limit surface of Loop subdivision.
        Loop: energy_and_curvatures(LoopSubdivision<T>, |settings: Settings<'_, T>| LoopSubdivision {
            modulus: settings.modulus,
            spontaneous_curvature: settings.spontaneous_curvature,
            controls: ControlPoints::default(),
        }),
        Description {
            name: "loop",
            letter: Some("S"),
            label: "S",
            title: "Loop",
            idea: "smooth surface by subdivision",
            defines: [true, true, false],
        },
        // Meshes with patches of few kinds, and meshes with patches of many.
        Bytes::ByValence([1700, 6000]);
        /// Jülicher's: squared mean curvature from dihedral angles.
        Juelicher: energy_and_curvatures(Juelicher<T>, |settings: Settings<'_, T>| Juelicher {
            modulus: settings.modulus,
            spontaneous_curvature: settings.spontaneous_curvature,
        }),
        Description {
            name: "juelicher",
            letter: None,
            label: "Jü",
            title: "Jülicher",
            idea: "energy of edge curvatures",
            defines: [true, false, false],
        },
        Bytes::Fixed(85);
        /// Hamann's: paraboloids fitted to one-rings in the frame of averaged normals.
        Hamann: energy_and_curvatures(Hamann<T>, |settings: Settings<'_, T>| Hamann {
            modulus: settings.modulus,
            spontaneous_curvature: settings.spontaneous_curvature,
        }),
        Description {
            name: "hamann",
            letter: None,
            label: "Ha",
            title: "Hamann",
            idea: "energy of paraboloids over averaged normals",
            defines: [true, true, false],
        },
        Bytes::Fixed(180);
        /// G: blended osculating jets.
        Galerkin: energy_and_density(Galerkin<T>, |settings: Settings<'_, T>| Galerkin {
            modulus: settings.modulus,
            spontaneous_curvature: settings.spontaneous_curvature,
        }),
        Description {
            name: "galerkin",
            letter: Some("G"),
            label: "G",
            title: "Galerkin",
            idea: "energy of blended polynomials",
            defines: [true, true, false],
        },
        Bytes::Fixed(18500);
        /// J of degree 4: strong form over osculating jets.
        J4: strong_form(Jet<T>, |settings: Settings<'_, T>| settings.strong_form(Jet::j4())),
        Description {
            name: "j4",
            letter: None,
            label: "J4",
            title: "Jets, degree 4",
            idea: "polynomials fitted to more neighbours",
            defines: [true, true, true],
        },
        Bytes::Fixed(1600);
        /// J of degree 6.
        J6: strong_form(Jet<T>, |settings: Settings<'_, T>| settings.strong_form(Jet::j6())),
        Description {
            name: "j6",
            letter: None,
            label: "J6",
            title: "Jets, degree 6",
            idea: "polynomials fitted to many neighbours",
            defines: [true, true, true],
        },
        Bytes::Fixed(2550);
        /// J of degree 8.
        J8: strong_form(Jet<T>, |settings: Settings<'_, T>| settings.strong_form(Jet::j8())),
        Description {
            name: "j8",
            letter: None,
            label: "J8",
            title: "Jets, degree 8",
            idea: "polynomials fitted to twice as many neighbours",
            defines: [true, true, true],
        },
        Bytes::Fixed(4300);
    }
    by_mesh {
        /// J of the degree that suits the mesh.
        Jet: strong_form(Jet<T>, |settings: Settings<'_, T>| {
            let jet = Jet::for_mesh(settings.mesh);
            settings.strong_form(jet)
        }),
        Description {
            name: "jet",
            letter: Some("J"),
            label: "J",
            title: "Jets",
            idea: "of the degree that suits the mesh",
            defines: [true, true, true],
        },
        Bytes::Fixed(4300);
    }
    curvatures_only {
        /// Corrected curvature measures with averaged normals.
        Corrected: curvatures(CorrectedCurvature, |_: Settings<'_, T>| CorrectedCurvature {
            normals: VertexNormals::Averaged,
        }),
        Description {
            name: "corrected",
            letter: None,
            label: "CA",
            title: "Corrected measures, averaged normals",
            idea: "curvature of interpolated normals",
            defines: [true, true, false],
        },
        Bytes::Fixed(80);
        /// Corrected curvature measures with normals of jets.
        CorrectedFit: curvatures(CorrectedCurvature, |_: Settings<'_, T>| CorrectedCurvature {
            normals: VertexNormals::Fitted,
        }),
        Description {
            name: "corrected-fit",
            letter: None,
            label: "CF",
            title: "Corrected measures, fitted normals",
            idea: "curvature of interpolated normals of jets",
            defines: [true, true, false],
        },
        Bytes::Fixed(1560);
    }
}

impl BendingMethod {
    /// The long name, as on the command line.
    pub fn name(self) -> &'static str {
        self.description().name
    }

    /// The names of all methods with their letters, separated by commas.
    pub fn names() -> String {
        let name = |method: Self| match method.letter() {
            Some(letter) => format!("{method} ({letter})"),
            None => method.to_string(),
        };
        Self::NAMED.map(name).join(", ")
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

    /// Memory of the prepared method in bytes per vertex, for a mesh of `vertices` vertices with these
    /// smallest and largest valences.
    pub fn bytes(self, options: &MethodOptions, vertices: usize, valences: [usize; 2]) -> u64 {
        match self.cost().bytes {
            Bytes::Fixed(bytes) => bytes,
            Bytes::ByValence([even, uneven]) => {
                let is_even = valences[0] >= 5 && valences[1] <= 6;
                if is_even { even } else { uneven }
            }
            Bytes::ByBandwidth([fixed, each]) => {
                (fixed + each * options.bandwidth_in_mean_areas(vertices)) as u64
            }
        }
    }

    /// The letter in the article, or J for the jets; `None` for other methods.
    pub fn letter(self) -> Option<&'static str> {
        self.description().letter
    }
}

impl fmt::Display for BendingMethod {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

/// A name that does not belong to a method.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "there is no bending method `{name}`: the methods are {}",
    BendingMethod::names()
)]
pub struct UnknownMethod {
    name: String,
}

impl FromStr for BendingMethod {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, UnknownMethod> {
        let matches = |method: &Self| {
            let Description {
                name: long, letter, ..
            } = method.description();
            long.eq_ignore_ascii_case(name) || letter.is_some_and(|l| l.eq_ignore_ascii_case(name))
        };
        Self::NAMED
            .into_iter()
            .find(matches)
            .ok_or_else(|| UnknownMethod {
                name: name.to_owned(),
            })
    }
}
