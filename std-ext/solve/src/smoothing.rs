//! Smoother positions of the vertices of a mesh, with its volumes kept: by fits that average noise, or by
//! mean-curvature flow.

use crate::dynamics::cholesky::{Factor, Pattern};
use crate::dynamics::cotangents::{self, Cotangents};
use helfrich::{Noise, Smoothing, Surface, VertexKind};
use helfrich_execute::execute::look_for_interruption;
use helfrich_shape::held::{VolumeError, keep_volumes};
use helfrich_shape::noise::{NotQuieted, Quieted, noise_seen};

/// A way to smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smoother {
    /// Removal of the measured noise: see [`Quieted::new`].
    Noise,
    /// Movements onto fits of this scale, whatever the noise is: see [`Quieted::at_scale`].
    Scale(Smoothing),
    /// One step of mean-curvature flow of this time, a length squared: see [`implicit_step`].
    Flow(f64),
}

/// Result of smoothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Smoothed {
    /// The new positions. Each closed component encloses its original volume: see [`keep_volumes`].
    pub positions: Vec<[f64; 3]>,
    /// The noise of the original positions: see [`noise_seen`].
    pub noise: Noise<f64>,
    /// The fits onto which vertices were moved, [`Quieted::TIMES`] times; `None` if they were moved by flow or not at
    /// all.
    pub fits: Option<Smoothing>,
    /// The reason why no vertex was moved: there is no noise, or fits do not reduce it.
    pub unmoved: Option<NotQuieted>,
    /// Root mean square and maximum of the displacements, over the vertices of triangles.
    pub displacements: [f64; 2],
    /// The area before and after.
    pub areas: [f64; 2],
    /// The enclosed volume before and after; `None` if the mesh has a border.
    pub volumes: Option<[f64; 2]>,
}

/// The reason why a surface cannot be smoothed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SmoothingError {
    /// The matrix of the flow is singular to rounding.
    #[error(
        "a flow of the time {time:.3e} is lost in rounding, after which nothing would be left of a surface of the area \
         {area:.3e}: choose a time far below this area"
    )]
    TooLong {
        /// The time, a length squared.
        time: f64,
        /// The area of the surface.
        area: f64,
    },
    /// A component would lose its volume.
    #[error("{0}: smooth less")]
    Volume(#[from] VolumeError),
    /// The caller ended the work.
    #[error("interrupted")]
    Interrupted,
}

/// Smoother positions, on all threads; `watch` gets the part of the work that is done, and ends it by `false`.
///
/// Positions of surfaces without noise, and of those whose noise no fits reduce, keep their bits if [`Smoother::Noise`] is
/// asked for.
///
/// # Errors
/// If the flow is too long, if a volume cannot be kept, or if the work is ended.
///
/// # Panics
/// If the degree of the fits is not 2 to 6.
pub fn smooth(
    surface: Surface<'_, f64>,
    smoother: Smoother,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<Smoothed, SmoothingError> {
    let noise = noise_seen(surface);
    let (mut unmoved, mut fits) = (None, None);
    let mut positions = surface.positions().to_vec();
    let mut take = |quieted: Quieted| {
        fits = Some(quieted.smoothing);
        quieted.positions
    };
    match smoother {
        Smoother::Noise => match Quieted::new(surface, watch) {
            Ok(quieted) => positions = take(quieted),
            Err(NotQuieted::Volume(error)) => return Err(error.into()),
            Err(NotQuieted::Interrupted) => return Err(SmoothingError::Interrupted),
            // Fits around every vertex see noise between creases, which a sample of vertices does not.
            Err(_) if noise.is_seen() => unmoved = Some(NotQuieted::Unresolved(noise)),
            Err(reason) => unmoved = Some(reason),
        },
        Smoother::Scale(scale) => positions = take(Quieted::at_scale(surface, noise, scale)?),
        Smoother::Flow(time) => {
            positions = implicit_step(surface, time)?;
            keep_volumes(surface, &mut positions)?;
        }
    }
    let after = Surface::new(surface.mesh(), &positions);
    let [mut squares, mut largest, mut count] = [0.0_f64; 3];
    for (vertex, (from, to)) in surface.positions().iter().zip(&positions).enumerate() {
        if surface.mesh().vertex_kind(vertex) != VertexKind::Isolated {
            let square = (0..3)
                .map(|axis| (to[axis] - from[axis]).powi(2))
                .sum::<f64>();
            squares += square;
            largest = largest.max(square);
            count += 1.0;
        }
    }
    Ok(Smoothed {
        noise,
        fits,
        unmoved,
        displacements: [(squares / count).sqrt(), largest.sqrt()],
        areas: [surface.area(), after.map_or(f64::NAN, |after| after.area())],
        volumes: surface
            .volume()
            .zip(after.ok().and_then(|after| after.volume()))
            .map(|(before, after)| [before, after]),
        positions,
    })
}

/// Positions after one implicit step of mean-curvature flow, `(M + t S) x = M x₀`, with the cotangent stiffness S and the
/// lumped areas M of x₀, a third of the area of each triangle at its corners. `time` is t, a length squared.
///
/// The step is stable for any t. A sphere of radius R becomes one of radius `R/(1 + 2 t/R²)`, and waves of wavelength λ on a
/// plane are multiplied by `1/(1 + 4 π² t/λ²)`. Vertices move along the surface, too, towards equal angles. Volumes are
/// not kept. Vertices of borders and of no triangle stay where they are. Triangles of less than a thousandth of the mean
/// area count as this large.
///
/// M. Desbrun, M. Meyer, P. Schröder and A. H. Barr, Proc. SIGGRAPH 1999, 317.
///
/// # Errors
/// [`SmoothingError::TooLong`] if the matrix is not positive definite to rounding.
pub fn implicit_step(
    surface: Surface<'_, f64>,
    time: f64,
) -> Result<Vec<[f64; 3]>, SmoothingError> {
    let mesh = surface.mesh();
    let Cotangents {
        mut edges,
        areas,
        total,
    } = Cotangents::new(mesh, surface.positions());
    for entry in &mut edges {
        *entry *= time;
    }
    let diagonal = cotangents::diagonal(mesh, &areas, &edges, [1.0, 1.0]);
    let is_free = |vertex: u32| mesh.vertex_kind(vertex as usize) == VertexKind::Interior;
    // Relative to the centroid of each component, which stays where it is if the component is closed: what is left of a
    // component after a long time is small, and would be lost in the rounding of displacements.
    let (components, count) = mesh.components();
    let mut sums = vec![[0.0; 4]; count];
    for ((&component, &[x, y, z]), &area) in components.iter().zip(surface.positions()).zip(&areas)
    {
        let sum = &mut sums[component as usize];
        *sum = std::array::from_fn(|k| sum[k] + area * [x, y, z, 1.0][k]);
    }
    let centroids = sums
        .iter()
        .map(|[x, y, z, area]| [x, y, z].map(|sum| sum / area));
    let centroids = Vec::from_iter(centroids);
    let centroid = |vertex: usize| centroids[components[vertex] as usize];
    let relative = |vertex: usize| {
        let (at, centroid) = (surface.positions()[vertex], centroid(vertex));
        [0, 1, 2].map(|axis| at[axis] - centroid[axis])
    };
    let of_area = |(vertex, area): (usize, &f64)| relative(vertex).map(|x| area * x);
    let mut moved = Vec::from_iter(areas.iter().enumerate().map(of_area));
    for (ends, entry) in mesh.edges().iter().zip(&mut edges) {
        // Fixed vertices are known: their terms belong to the right side.
        if ends.iter().all(|&end| is_free(end)) {
            continue;
        }
        for [end, other] in [*ends, [ends[1], ends[0]]] {
            let known = relative(other as usize);
            let right = &mut moved[end as usize];
            *right = std::array::from_fn(|axis| right[axis] - *entry * known[axis]);
        }
        *entry = 0.0;
    }
    look_for_interruption();
    let pattern = Pattern::new(mesh);
    look_for_interruption();
    let too_long = SmoothingError::TooLong { time, area: total };
    let mut factor = Factor::new(&pattern, &diagonal, &edges).ok_or(too_long)?;
    factor.solve(&pattern, moved.as_flattened_mut(), 3);
    for (vertex, at) in moved.iter_mut().enumerate() {
        if is_free(vertex as u32) {
            let centroid = centroid(vertex);
            *at = std::array::from_fn(|axis| centroid[axis] + at[axis]);
        } else {
            *at = surface.positions()[vertex];
        }
    }
    Ok(moved)
}
