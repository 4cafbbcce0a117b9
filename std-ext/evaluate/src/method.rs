//! The closed set of bending methods, chosen at run time.
//!
//! A method is chosen once per surface, in one place; everything below is resolved at compile time.
//! Methods run on all threads, and large meshes are reordered.

mod choice;
mod evaluator;
mod fields;
mod options;
mod ordered;

pub(crate) use choice::{Settings, Visitor};
pub use evaluator::{Evaluated, Evaluator};
pub(crate) use fields::Describe;
pub use fields::Fields;
pub use options::{InvalidBandwidth, MethodOptions, UnknownAreas, UnusedOption};

use helfrich::{
    Cotangent, GompperKroll, Hamann, HeatKernel, Jet, Juelicher, KantorNelson, LoopSubdivision,
    Real, StrongForm,
};
use std::fmt;
use std::str::FromStr;

/// What is known of a method beside its formula.
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
    /// Time of an evaluation over that of method B: docs/CHOOSING.md.
    pub relative_cost: f64,
    /// Memory of the prepared method after its first evaluation in bytes, for each vertex, as measured on
    /// meshes of 2562 vertices.
    pub bytes: Bytes,
}

/// Memory of a prepared method in bytes, for each vertex.
#[derive(Clone, Copy, Debug)]
pub enum Bytes {
    /// On any mesh.
    Fixed(u64),
    /// On meshes with five and six neighbours of each vertex, and on others.
    ByValence([u64; 2]),
    /// A fixed part, and a part proportional to the bandwidth in mean areas of a vertex.
    ByBandwidth([f64; 2]),
}

/// Defines [`BendingMethod`] and everything that follows from the list of methods: names,
/// descriptions, and the only place where a name becomes a method of the core.
macro_rules! methods {
    (@is_conservative conservative) => { true };
    (@is_conservative strong_form) => { false };
    (
        all {
            $($(#[$documentation:meta])* $method:ident: $form:ident($make:expr), $description:expr;)*
        }
        by_mesh {
            $(#[$last_documentation:meta])* $last:ident: $last_form:ident($last_make:expr),
            $last_description:expr;
        }
    ) => {
        /// A bending method, by its name in the field and its letter in Guckenberger et al. 2016.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum BendingMethod {
            $($(#[$documentation])* $method,)*
            $(#[$last_documentation])* $last,
        }

        impl BendingMethod {
            /// Every method, with J in its two degrees.
            pub const ALL: [Self; [$(stringify!($method)),*].len()] = [$(Self::$method),*];

            /// Every method, and `jet`, whose degree depends on the mesh.
            pub const NAMED: [Self; Self::ALL.len() + 1] = [$(Self::$method,)* Self::$last];

            /// Whether its forces are the exact gradient of an energy.
            pub const fn is_conservative(self) -> bool {
                match self {
                    $(Self::$method => methods!(@is_conservative $form),)*
                    Self::$last => methods!(@is_conservative $last_form),
                }
            }

            /// The description of the method.
            pub const fn description(self) -> &'static Description {
                match self {
                    $(Self::$method => const { &$description },)*
                    Self::$last => const { &$last_description },
                }
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
                BendingMethod::$last => visitor.$last_form(($last_make)(settings)),
            }
        }
    };
}

methods! {
    all {
        /// A: dihedral angles.
        KantorNelson: conservative(|settings: Settings<'_, T>| KantorNelson::new(settings.modulus)),
        Description {
            name: "kantor-nelson",
            letter: Some("A"),
            label: "A",
            title: "Kantor–Nelson",
            idea: "angles between triangles",
            defines: [false, false, false],
            relative_cost: 0.8,
            bytes: Bytes::Fixed(90),
        };
        /// B: squared cotangent Laplacian.
        GompperKroll: conservative(|settings: Settings<'_, T>| {
            let areas = settings.options.areas_or_default();
            let mut method = GompperKroll::with_areas(settings.modulus, areas);
            method.spontaneous_curvature = settings.spontaneous_curvature.into();
            method
        }),
        Description {
            name: "gompper-kroll",
            letter: Some("B"),
            label: "B",
            title: "Gompper–Kroll",
            idea: "energy of the cotangent Laplacian",
            defines: [true, false, false],
            relative_cost: 1.0,
            bytes: Bytes::Fixed(65),
        };
        /// C: strong form over the cotangent operator.
        Meyer: strong_form(|settings: Settings<'_, T>| {
            settings.strong_form(Cotangent::new(settings.options.areas_or_default()))
        }),
        Description {
            name: "meyer",
            letter: Some("C"),
            label: "C",
            title: "Meyer et al.",
            idea: "cotangent Laplacian, applied twice",
            defines: [true, true, true],
            relative_cost: 1.5,
            bytes: Bytes::Fixed(185),
        };
        /// D: strong form over a heat kernel.
        Belkin: strong_form(|settings: Settings<'_, T>| {
            settings.strong_form(HeatKernel::new(settings.options.bandwidth_or_default()))
        }),
        Description {
            name: "belkin",
            letter: Some("D"),
            label: "D",
            title: "Belkin et al.",
            idea: "heat kernel",
            defines: [true, true, true],
            relative_cost: 330.0,
            bytes: Bytes::ByBandwidth([240.0, 2260.0]),
        };
        /// E: strong form over paraboloids fitted to one-rings.
        Farutin: strong_form(|settings: Settings<'_, T>| {
            settings.strong_form(StrongForm::farutin(settings.modulus).operator)
        }),
        Description {
            name: "farutin",
            letter: Some("E"),
            label: "E",
            title: "Farutin et al.",
            idea: "paraboloids fitted to neighbours",
            defines: [true, true, true],
            relative_cost: 12.0,
            bytes: Bytes::Fixed(250),
        };
        /// S: the limit surface of Loop subdivision.
        Loop: conservative(|settings: Settings<'_, T>| {
            let mut method = LoopSubdivision::new(settings.modulus);
            method.spontaneous_curvature = settings.spontaneous_curvature.into();
            method
        }),
        Description {
            name: "loop",
            letter: Some("S"),
            label: "S",
            title: "Loop",
            idea: "smooth surface by subdivision",
            defines: [true, true, false],
            relative_cost: 7.0,
            // Patches of one kind only, or of many.
            bytes: Bytes::ByValence([1700, 6000]),
        };
        /// Jülicher's: squared mean curvature from dihedral angles.
        Juelicher: conservative(|settings: Settings<'_, T>| {
            let mut method = Juelicher::new(settings.modulus);
            method.spontaneous_curvature = settings.spontaneous_curvature.into();
            method
        }),
        Description {
            name: "juelicher",
            letter: None,
            label: "Jü",
            title: "Jülicher",
            idea: "energy of edge curvatures",
            defines: [true, false, false],
            relative_cost: 3.5,
            bytes: Bytes::Fixed(85),
        };
        /// Hamann's: paraboloids fitted to one-rings in the frame of averaged normals.
        Hamann: conservative(|settings: Settings<'_, T>| {
            let mut method = Hamann::new(settings.modulus);
            method.spontaneous_curvature = settings.spontaneous_curvature.into();
            method
        }),
        Description {
            name: "hamann",
            letter: None,
            label: "Ha",
            title: "Hamann",
            idea: "energy of paraboloids over averaged normals",
            defines: [true, true, false],
            relative_cost: 4.0,
            bytes: Bytes::Fixed(180),
        };
        /// J of degree 4: strong form over osculating jets.
        J4: strong_form(|settings: Settings<'_, T>| settings.strong_form(Jet::j4())),
        Description {
            name: "j4",
            letter: None,
            label: "J4",
            title: "Jets, degree 4",
            idea: "polynomials fitted to more neighbours",
            defines: [true, true, true],
            relative_cost: 30.0,
            bytes: Bytes::Fixed(1450),
        };
        /// J of degree 6.
        J6: strong_form(|settings: Settings<'_, T>| settings.strong_form(Jet::j6())),
        Description {
            name: "j6",
            letter: None,
            label: "J6",
            title: "Jets, degree 6",
            idea: "polynomials fitted to many neighbours",
            defines: [true, true, true],
            relative_cost: 90.0,
            bytes: Bytes::Fixed(2400),
        };
    }
    by_mesh {
        /// J of the degree that suits the mesh.
        Jet: strong_form(|settings: Settings<'_, T>| {
            settings.strong_form(Jet::for_mesh(settings.mesh))
        }),
        Description {
            name: "jet",
            letter: Some("J"),
            label: "J",
            title: "Jets",
            idea: "of the degree that suits the mesh",
            defines: [true, true, true],
            relative_cost: 90.0,
            bytes: Bytes::Fixed(2400),
        };
    }
}

impl BendingMethod {
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

    /// Memory of the prepared method in bytes per vertex, for a mesh of `vertices` vertices with
    /// these fewest and most neighbours of a vertex.
    pub fn bytes(self, options: &MethodOptions, vertices: usize, valences: [usize; 2]) -> u64 {
        match self.description().bytes {
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
    known_methods()
)]
pub struct UnknownMethod {
    name: String,
}

fn known_methods() -> String {
    let known = |method: BendingMethod| match method.letter() {
        Some(letter) => format!("{method} ({letter})"),
        None => method.to_string(),
    };
    let all = BendingMethod::NAMED.into_iter();
    all.map(known).collect::<Vec<_>>().join(", ")
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
