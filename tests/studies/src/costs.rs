//! Costs of all methods relative to method B, measured in turn in one process. [`documents`] writes them into the
//! program and the guides.

pub mod documents;

use helfrich::Surface;
use helfrich_std::effect::{Effect, Lumping};
use helfrich_std::execute::{Parallel, with_threads};
use helfrich_std::flow::SingleLayer;
use helfrich_std::generate::{AnyShape, Family, GenerateError, GeneratedMesh, generate};
use helfrich_std::method::{AnyMethod, BendingMethod, Evaluator, MethodOptions};
use helfrich_std::provenance::{Provenance, date};
use serde::{Deserialize, Serialize};
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::time::{Duration, Instant, SystemTime};

/// Costs of all methods on one machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Costs {
    /// The commit of the sources.
    pub commit: String,
    /// Time of the measurement.
    pub date: String,
    /// Compiler and profile.
    pub build: String,
    /// Processor, vectors and threads.
    pub machine: String,
    /// Largest distance of the quartiles of a ratio over its median: large if the machine had other work.
    pub scatter: f64,
    /// Cost of each method, in the order of the list.
    pub methods: Vec<MethodCost>,
    /// Cost of method G on each family.
    pub galerkin: Vec<GalerkinCost>,
}

/// The cost of a method, on one thread in f64.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MethodCost {
    /// The method's name.
    pub method: String,
    /// Time of an evaluation of f over that of method B; of H and K for operators without a force.
    pub relative: f64,
    /// Time of this evaluation in nanoseconds per vertex.
    pub nanoseconds: f64,
    /// Memory of workspace and forces in bytes per vertex.
    pub bytes: f64,
    /// Time of forces for a flow over that of a velocity by boundary integrals; `None` for operators without a force.
    pub flow: Option<f64>,
}

/// The cost of method G on one family, in force densities of J6.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GalerkinCost {
    /// The family's name.
    pub family: String,
    /// Time of energy and nodal forces.
    pub energy: f64,
    /// Time of the force density.
    pub density: f64,
}

/// Number of vertices of the meshes on which times are measured.
const MANY: usize = 10_242;

/// Number of vertices of the meshes on which memory is measured.
const SEVERAL: usize = 2562;

/// Number of vertices of a capsule in flow.
const FEW: usize = 642;

/// Rounds in which all evaluations are timed in turn.
const ROUNDS: usize = 9;

/// Least duration of the evaluations of one kind in a round.
const WHILE: Duration = Duration::from_millis(20);

/// Something that is timed.
type Contender<'a> = Box<dyn FnMut() + 'a>;

/// Measures the costs; `progress` receives the fraction that is done and the current work. `allocated` is the number
/// of bytes that the program has allocated.
///
/// # Errors
/// If a mesh cannot be made.
pub fn costs(
    provenance: &Provenance,
    allocated: &dyn Fn() -> usize,
    progress: &mut dyn FnMut(f64, &str),
) -> Result<Costs, GenerateError> {
    // Levels of optimisation differ between crates.
    let profile = provenance.build.profile.split(',').next();
    let profile = profile.unwrap_or_default();
    with_threads(NonZeroUsize::MIN, || {
        let mut measured = Costs {
            commit: provenance.build.commit.to_owned(),
            date: date(SystemTime::now()),
            build: format!("{}, {profile} build", provenance.build.compiler),
            machine: provenance.machine(),
            scatter: 0.0,
            methods: Vec::new(),
            galerkin: Vec::new(),
        };
        progress(0.0, "all methods");
        measured.add_methods(allocated)?;
        for (number, family) in [Family::Irregular, Family::Regular, Family::Relaxed]
            .into_iter()
            .enumerate()
        {
            progress(0.4 + 0.15 * number as f64, "method G");
            measured.add_galerkin(family)?;
        }
        progress(0.9, "in flow");
        measured.add_flow()?;
        Ok(measured)
    })
}

impl Costs {
    fn add_methods(&mut self, allocated: &dyn Fn() -> usize) -> Result<(), GenerateError> {
        let [many, several] = [MANY, SEVERAL].map(|vertices| discocyte(Family::Regular, vertices));
        let (many, several) = (many?, several?);
        // The first is that to which the others are compared.
        let mut methods = Vec::from(BendingMethod::NAMED);
        methods.sort_by_key(|&method| method != BendingMethod::GompperKroll);
        let contenders = methods.iter().map(|&method| evaluation(method, &many));
        let [seconds, relative] = self.medians(contenders.collect());
        for method in BendingMethod::NAMED {
            let before = allocated();
            let mut evaluate = evaluation(method, &several);
            evaluate();
            let bytes = allocated().saturating_sub(before) as f64;
            let place = methods.iter().take_while(|&&other| other != method).count();
            self.methods.push(MethodCost {
                method: method.to_string(),
                relative: rounded(relative[place]),
                nanoseconds: rounded(1e9 * seconds[place] / many.positions.len() as f64),
                bytes: rounded(bytes / several.positions.len() as f64),
                flow: None,
            });
        }
        Ok(())
    }

    fn add_galerkin(&mut self, family: Family) -> Result<(), GenerateError> {
        let made = discocyte(family, MANY)?;
        let [_, relative] = self.medians(vec![
            evaluation(BendingMethod::J6, &made),
            bending(BendingMethod::Galerkin, Lumping::Own, &made),
            evaluation(BendingMethod::Galerkin, &made),
        ]);
        self.galerkin.push(GalerkinCost {
            family: family.name().to_owned(),
            energy: rounded(relative[1]),
            density: rounded(relative[2]),
        });
        Ok(())
    }

    fn add_flow(&mut self) -> Result<(), GenerateError> {
        let made = discocyte(Family::Regular, FEW)?;
        let mut layer = SingleLayer::new([&made.mesh], 1.0, NonZeroUsize::MIN);
        layer.set_cluster_tolerance(0.0);
        let tractions = vec![[1.0, 0.0, 0.0]; FEW];
        let mut velocity = vec![[0.0; 3]; FEW];
        let mut contenders: Vec<Contender<'_>> = vec![Box::new(|| {
            layer.set_tractions(&made.positions, &tractions);
            layer.add_at_vertices(&mut velocity);
        })];
        for method in BendingMethod::ALL {
            contenders.push(bending(method, Lumping::Thirds, &made));
        }
        let [_, relative] = self.medians(contenders);
        for (method, &share) in BendingMethod::ALL.iter().zip(&relative[1..]) {
            for cost in &mut self.methods {
                if cost.method == method.name() {
                    cost.flow = Some(rounded(share));
                }
            }
        }
        Ok(())
    }

    /// Medians of the times in seconds, and of their ratios to the first in the same round.
    fn medians(&mut self, mut contenders: Vec<Contender<'_>>) -> [Vec<f64>; 2] {
        let mut rounds = Vec::new();
        for contender in &mut contenders {
            contender();
        }
        for _ in 0..ROUNDS {
            let times = contenders.iter_mut().map(|contender| {
                let (start, mut times) = (Instant::now(), Vec::new());
                while times.is_empty() || start.elapsed() < WHILE {
                    let one = Instant::now();
                    contender();
                    times.push(one.elapsed().as_secs_f64());
                }
                quartiles(times)[1]
            });
            rounds.push(Vec::from_iter(times));
        }
        let of = |place: usize, ratio: bool| {
            let values = rounds.iter().map(|round| match ratio {
                true => round[place] / round[0],
                false => round[place],
            });
            quartiles(values.collect())
        };
        for place in 0..contenders.len() {
            let [low, middle, high] = of(place, true);
            self.scatter = rounded(self.scatter.max((high - low) / middle));
        }
        [false, true].map(|ratio| {
            (0..contenders.len())
                .map(|place| of(place, ratio)[1])
                .collect()
        })
    }
}

fn discocyte(family: Family, vertices: usize) -> Result<GeneratedMesh, GenerateError> {
    let discocyte = helfrich::shapes::Discocyte::new(1.0).expect("a radius");
    generate(&AnyShape::Discocyte(discocyte), family, vertices, 1)
}

/// An evaluation as `helfrich study` times it.
fn evaluation(method: BendingMethod, made: &GeneratedMesh) -> Contender<'_> {
    let options = MethodOptions::default();
    let threads = Parallel::single();
    let mut evaluator: Evaluator<f64> =
        AnyMethod::from(method).evaluator(&options, 1.0, &made.mesh, threads);
    Box::new(move || evaluator.evaluate(surface(made)))
}

/// Nodal forces and energy as in scenes.
fn bending(method: BendingMethod, lumping: Lumping, made: &GeneratedMesh) -> Contender<'_> {
    let options = MethodOptions::default();
    let material = [1.0, 0.0].map(Into::into);
    let effect = Effect::bending("bending", method, &options, material, lumping, &made.mesh);
    let mut effect = effect.expect("a method with a force, and constant moduli");
    let mut force = vec![[0.0; 3]; made.positions.len()];
    Box::new(move || {
        black_box(effect.add_force(surface(made), &mut force));
    })
}

fn surface(made: &GeneratedMesh) -> Surface<'_, f64> {
    Surface::new(&made.mesh, &made.positions).expect("generated positions are finite")
}

/// First quartile, median and third quartile.
fn quartiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_unstable_by(f64::total_cmp);
    let last = values.len() - 1;
    [last / 4, last / 2, last - last / 4].map(|place| values[place])
}

/// Three digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
