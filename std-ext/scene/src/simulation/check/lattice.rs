//! Checks of meshes in a box of fluid on a lattice: errors where a mesh is impossible, warnings
//! where the method is not accurate.

use crate::flow::lattice_boltzmann::limits::{
    COMPRESSION, FREE_BOX, INERTIA, ImmersedMembrane, OSCILLATING,
};
use crate::info::MeshInfo;
use crate::scene::{AXES, Flow, InteractionScene, LatticeBoltzmann, SceneFile, SurfaceScene};
use crate::six::rounded;

/// Range of the mean edge in node spacings. Longer edges leave gaps through which fluid leaks;
/// shorter edges only make the membrane stiffer.
const EDGES: [f64; 2] = [0.3, 1.5];

/// Reynolds numbers above which inertia affects D.
const REYNOLDS: f64 = 0.1;

/// Reports a surface that the lattice does not resolve, or that does not fit between its walls.
pub(super) fn in_the_box(
    scene: &SurfaceScene,
    mesh: &MeshInfo,
    lattice: &LatticeBoltzmann,
    problem: &mut impl FnMut(&str, String),
) {
    let name = &scene.name;
    let radius = mesh.enclosed_radius();
    if radius < lattice.spacing {
        problem(
            "",
            format!(
                "the radius of \"{name}\" is {}, less than the distance of two nodes, {}: choose a \
                 `spacing` of {} or less",
                rounded(radius),
                rounded(lattice.spacing),
                rounded(radius / 6.0)
            ),
        );
        return;
    }
    let walls = lattice.walls();
    let corners = lattice.corners();
    // What the kernel of a vertex needs between it and a wall.
    let distance = 0.5 * (lattice.kernel.points() - 1) as f64 * lattice.spacing;
    for axis in 0..3 {
        let [lowest, highest] = mesh.corners.map(|corner| corner[axis]);
        let [low, high] = corners.map(|corner| corner[axis]);
        let along = AXES[axis];
        if walls[axis] && (lowest < low + distance || highest > high - distance) {
            let needed =
                2.0 * f64::max(
                    highest - lattice.centre[axis],
                    lattice.centre[axis] - lowest,
                ) + 2.0 * distance;
            problem(
                "position",
                format!(
                    "\"{name}\" reaches from {} to {} along {along}, and the walls are at {} and {}: \
                     its vertices need a distance of {} to them: move it, or choose a `box` of {} \
                     along {along}",
                    rounded(lowest),
                    rounded(highest),
                    rounded(low),
                    rounded(high),
                    rounded(distance),
                    rounded(needed + lattice.spacing)
                ),
            );
            return;
        }
        if !walls[axis] && highest - lowest > high - low {
            problem(
                "",
                format!(
                    "\"{name}\" is {} long along {along}, and the box, which is periodic there, {}: it \
                     would meet itself: choose a longer `box`",
                    rounded(highest - lowest),
                    rounded(high - low)
                ),
            );
            return;
        }
    }
}

/// Reports an obstacle that contains no node, with the reason.
pub(super) fn off_the_nodes(
    name: &str,
    mesh: &MeshInfo,
    lattice: &LatticeBoltzmann,
) -> Option<String> {
    let walls = lattice.walls();
    let [low, high] = lattice.corners();
    let [lowest, highest] = mesh.corners;
    let outside =
        |&axis: &usize| walls[axis] && (highest[axis] <= low[axis] || lowest[axis] >= high[axis]);
    if let Some(axis) = (0..3).find(outside) {
        return Some(format!(
            "the obstacle \"{name}\" reaches from {} to {} along {}, and the fluid is between walls at \
             {} and {}: move it, or leave it out",
            rounded(lowest[axis]),
            rounded(highest[axis]),
            AXES[axis],
            rounded(low[axis]),
            rounded(high[axis])
        ));
    }
    let thin = |&axis: &usize| highest[axis] - lowest[axis] < lattice.spacing;
    (0..3).find(thin).map(|axis| {
        format!(
            "the obstacle \"{name}\" is {} thick along {}, less than the distance of two nodes, {}: \
             choose a thicker one, or a smaller `spacing`",
            rounded(highest[axis] - lowest[axis]),
            AXES[axis],
            rounded(lattice.spacing)
        )
    })
}

/// Warnings about a membrane on a lattice, each with the path of its key.
pub(super) fn doubts(
    file: &SceneFile,
    index: usize,
    surface: &SurfaceScene,
    mesh: &MeshInfo,
    lattice: &LatticeBoltzmann,
) -> Vec<(String, String)> {
    let mut doubts = Doubts {
        file,
        name: &surface.name,
        lattice,
        membrane: surface.membrane_on(mesh),
        ratio: surface.viscosity_ratio.unwrap_or(1.0),
        found: Vec::new(),
    };
    doubts.compression();
    doubts.edges(index, mesh);
    doubts.room();
    doubts.inertia();
    doubts.steps();
    doubts.found
}

/// A membrane on a lattice, and doubts about it.
struct Doubts<'a> {
    file: &'a SceneFile,
    name: &'a str,
    lattice: &'a LatticeBoltzmann,
    membrane: ImmersedMembrane,
    /// The viscosity ratio.
    ratio: f64,
    found: Vec<(String, String)>,
}

impl Doubts<'_> {
    fn step_key(&self) -> &'static str {
        first_written(self.file, ["driver.step", "driver.lattice_viscosity"])
    }

    fn nodes_key(&self) -> &'static str {
        first_written(self.file, ["driver.spacing", "driver.resolution"])
    }

    /// A distance of nodes as the scene calls it.
    fn spacing(&self, spacing: f64) -> String {
        // `resolution` counts nodes of the smallest surface, which need not be this one.
        let alone = self.file.scene.surfaces.len() == 1;
        match alone && self.file.has("driver.resolution") {
            true => format!(
                "a `resolution` of {}",
                rounded(self.membrane.radius / spacing)
            ),
            false => format!("a `spacing` of {}", rounded(spacing)),
        }
    }

    /// Whether the membrane compresses the fluid.
    fn compression(&mut self) {
        let Self {
            name,
            lattice,
            membrane,
            ..
        } = *self;
        let pressure = lattice.parameters().pressure(&[membrane]);
        let compression = lattice.parameters().compression(pressure);
        if compression > COMPRESSION {
            let excess = compression / COMPRESSION;
            // Without a density, the density of the lattice is proportional to the step.
            let change = match lattice.density {
                None => format!(
                    "choose a `step` of {}, or a `lattice_viscosity` of {}",
                    rounded(lattice.step / excess),
                    rounded(lattice.lattice_viscosity / excess)
                ),
                Some(_) => format!(
                    "choose a `step` of {}, which is a viscosity of {} on the lattice",
                    rounded(lattice.step / excess.sqrt()),
                    rounded(lattice.lattice_viscosity / excess.sqrt())
                ),
            };
            self.found.push((
                self.step_key().to_owned(),
                format!(
                    "\"{name}\" changes the density of the fluid by 3 P = {}, 3 μγ̇/Ca of an elastic one, on \
                     the lattice, above {COMPRESSION}: its volume shrinks by as much, and 1 % of it raises D by \
                     2 %: {change}",
                    rounded(compression)
                ),
            ));
        }
    }

    /// Whether edges are as long as nodes are apart, about.
    fn edges(&mut self, index: usize, mesh: &MeshInfo) {
        let Self {
            name,
            lattice,
            membrane,
            ..
        } = *self;
        let edge = membrane.edge / lattice.spacing;
        let [shortest, longest] = EDGES;
        let at = self.file.scene.path_of(index);
        let vertices = match self.file.has(&format!("{at}.vertices")) {
            true => format!("{at}.vertices"),
            false => format!("{at}.mesh"),
        };
        if edge > longest {
            self.found.push((
                vertices,
                format!(
                    "edges of \"{name}\" are {} nodes long in the mean, above {longest}: fluid leaks between \
                     its vertices: choose more `vertices`, {} say, or {}",
                    rounded(edge),
                    4 * mesh.vertices - 6,
                    self.spacing(membrane.edge / longest)
                ),
            ));
        } else if edge < shortest {
            self.found.push((
                vertices,
                format!(
                    "edges of \"{name}\" are {} nodes long in the mean, below {shortest}: too short for the nodes, \
                     and the stiffer membrane needs shorter steps: choose fewer `vertices`, or {}",
                    rounded(edge),
                    self.spacing(membrane.edge / (2.0 * shortest))
                ),
            ));
        }
    }

    /// Whether the box is so large that the membrane does not feel its ends.
    fn room(&mut self) {
        let Self {
            name,
            lattice,
            membrane,
            ..
        } = *self;
        let size = lattice.size();
        let needed = FREE_BOX * membrane.radius;
        // Walls of channels are part of the problem, and lengths rounded to whole nodes are long enough.
        let free = |&axis: &usize| {
            let wall = matches!(lattice.flow, Flow::Channel { .. }) && lattice.walls()[axis];
            !wall && size[axis] < needed - lattice.spacing
        };
        // Many surfaces in a periodic box form a suspension, whose box does not stand for unbounded fluid.
        let alone = self.file.scene.surfaces.len() == 1;
        if let Some(axis) = (0..3)
            .filter(free)
            .min_by(|&a, &b| size[a].total_cmp(&size[b]))
            .filter(|_| alone)
        {
            let ratio = size[axis] / membrane.radius;
            let what = match lattice.walls()[axis] {
                true => "walls",
                false => "images",
            };
            let path = first_written(self.file, ["driver.box", "driver"]);
            let known = membrane.between_walls(ratio, self.ratio);
            let by = known.map_or(String::new(), |known| {
                format!(", D by about {} = {}", known.term, rounded(known.value))
            });
            self.found.push((
                path.to_owned(),
                format!(
                    "the box is {} radii of \"{name}\" long along {}, below {FREE_BOX}: it is influenced by its \
                     {what}{by}: choose {} or more",
                    rounded(ratio),
                    AXES[axis],
                    rounded(needed)
                ),
            ));
        }
    }

    /// Whether inertia exceeds what Stokes flow allows.
    fn inertia(&mut self) {
        let Self {
            name,
            lattice,
            membrane,
            ..
        } = *self;
        let pressure = lattice.parameters().pressure(&[membrane]);
        let reynolds = lattice.parameters().reynolds(membrane.radius, pressure);
        if lattice.density.is_some() && reynolds > REYNOLDS {
            self.found.push((
                "driver.density".to_owned(),
                format!(
                    "the Reynolds number ργ̇a²/μ of \"{name}\" is {}, above {REYNOLDS}: inertia raises D; for \
                     Stokes flow leave `density` out",
                    rounded(reynolds)
                ),
            ));
        }
        if lattice.density.is_none() && reynolds > INERTIA {
            let excess = reynolds / INERTIA;
            self.found.push((
                self.step_key().to_owned(),
                format!(
                    "the lattice gives the flow about \"{name}\" a Reynolds number γ̇a²/ν of {}, above \
                     {INERTIA}, and it lags behind the forces: choose a `step` of {}, a `lattice_viscosity` of \
                     {}, or {}",
                    rounded(reynolds),
                    rounded(lattice.step / excess),
                    rounded(lattice.lattice_viscosity * excess),
                    self.spacing(lattice.spacing * excess.sqrt())
                ),
            ));
        }
    }

    /// Whether explicit steps are stable.
    fn steps(&mut self) {
        let Self {
            name,
            lattice,
            membrane,
            ..
        } = *self;
        let barriers = Vec::from_iter(
            self.file
                .scene
                .interactions
                .iter()
                .map(InteractionScene::barrier),
        );
        let stiff = lattice.parameters().membrane_limits(&[membrane]);
        let barrier = lattice.parameters().barrier_limit(&[membrane], &barriers);
        let adhesion = lattice.parameters().adhesion_limit(&[membrane]);
        for limit in stiff.into_iter().chain([barrier, adhesion]) {
            let most = OSCILLATING * limit.step;
            if lattice.step > most {
                let path = first_written(self.file, ["driver.step", self.nodes_key()]);
                self.found.push((
                    path.to_owned(),
                    format!(
                        "steps of {} are more than twice {}, which the {} of \"{name}\" allows: the membrane \
                         oscillates at the scale of its mesh: choose a `step` of {}, or fewer `vertices`",
                        rounded(lattice.step),
                        rounded(limit.step),
                        limit.name,
                        rounded(limit.step)
                    ),
                ));
            }
        }
    }
}

/// The first of two keys, if it was written, otherwise the second.
fn first_written<'a>(file: &SceneFile, [first, second]: [&'a str; 2]) -> &'a str {
    if file.has(first) { first } else { second }
}
