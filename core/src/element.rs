//! Formulas of one mesh element, and the loops that run them.
//!
//! An *element* is a small group of vertices: the three of a triangle, the four of a hinge. A
//! kernel computes the contributions of an element to its corners; a loop runs it over all elements
//! and accumulates the contributions at the vertices, in the order of the elements. The serial loop is
//! [`Serial`]; other loops (wider lanes, several threads) implement [`Execution`] and change no
//! formula.

mod energy;

pub use energy::{ElementEnergy, ElementMemory};

use crate::lane::Lane;
use crate::real::Real;
use crate::reduction;
use crate::surface::Surface;
use crate::triangle::Triangle;
use crate::vec3;
use alloc::vec::Vec;

/// The corners of an element. Only differences of their positions are available.
#[derive(Clone, Copy, Debug)]
pub struct Corners<L, const CORNERS: usize> {
    positions: [[L; 3]; CORNERS],
}

impl<L: Lane, const CORNERS: usize> Corners<L, CORNERS> {
    /// The corners of one element.
    ///
    /// # Panics
    /// If a vertex does not exist.
    #[inline(always)]
    pub fn of(surface: Surface<'_, L>, element: [u32; CORNERS]) -> Self
    where
        L: Real,
    {
        Self {
            positions: element.map(|vertex| surface.position_near(vertex, element[0])),
        }
    }

    /// x_to − x_from, corners counted from 0.
    #[inline(always)]
    pub fn difference(&self, from: usize, to: usize) -> [L; 3] {
        vec3::sub(self.positions[to], self.positions[from])
    }
}

impl<L: Lane> Corners<L, 3> {
    #[inline(always)]
    pub(crate) fn triangle(&self) -> Triangle<L> {
        Triangle::new([
            self.difference(1, 2),
            self.difference(2, 0),
            self.difference(0, 1),
        ])
    }
}

/// A formula of one element.
///
/// Laws: the result depends on differences of positions only. A kernel that has no branch depending
/// on values and calls no function that is not inlined becomes vector instructions.
pub trait ElementKernel<T: Real, const CORNERS: usize, const IN: usize, const OUT: usize>:
    Sync
{
    /// The contributions of element `element` to each of its corners, from the corners' positions and
    /// `IN` numbers known at each.
    fn evaluate(
        &self,
        element: usize,
        corners: &Corners<T, CORNERS>,
        input: &[[T; IN]; CORNERS],
    ) -> [[T; OUT]; CORNERS];
}

/// Output with a slot for each vertex, which can be divided among workers: slices, slices with
/// several entries per slot, and tuples of these.
pub trait Slots: Sized + Send {
    /// One vertex's part.
    type Slot;
    /// Number of slots; for a tuple, the number of its shortest part.
    fn count(&self) -> usize;
    /// The slots 0 … `middle` − 1, and those from `middle` on.
    ///
    /// # Panics
    /// If there are fewer slots than `middle`.
    fn split_at(self, middle: usize) -> (Self, Self);
    /// An iterator over the slots. The slots of a tuple end with the shortest of its parts.
    fn into_slots(self) -> impl Iterator<Item = Self::Slot>;
}

impl<'a, O: Send> Slots for &'a mut [O] {
    type Slot = &'a mut O;
    #[inline]
    fn count(&self) -> usize {
        self.len()
    }
    #[inline]
    fn split_at(self, middle: usize) -> (Self, Self) {
        self.split_at_mut(middle)
    }
    #[inline]
    fn into_slots(self) -> impl Iterator<Item = &'a mut O> {
        self.iter_mut()
    }
}

/// A slice with `stride` consecutive entries for each vertex.
#[derive(Debug)]
pub struct Strided<'a, O> {
    entries: &'a mut [O],
    stride: usize,
}

impl<'a, O> Strided<'a, O> {
    /// The slice `entries`, `stride` to a slot.
    ///
    /// # Panics
    /// If `stride` is 0.
    pub fn new(entries: &'a mut [O], stride: usize) -> Self {
        assert!(stride > 0, "a slot needs at least one entry");
        Self { entries, stride }
    }
}

impl<'a, O: Send> Slots for Strided<'a, O> {
    type Slot = &'a mut [O];
    #[inline]
    fn count(&self) -> usize {
        self.entries.len() / self.stride
    }
    #[inline]
    fn split_at(self, middle: usize) -> (Self, Self) {
        let (low, high) = self.entries.split_at_mut(middle * self.stride);
        (
            Self {
                entries: low,
                stride: self.stride,
            },
            Self {
                entries: high,
                stride: self.stride,
            },
        )
    }
    #[inline]
    fn into_slots(self) -> impl Iterator<Item = &'a mut [O]> {
        self.entries.chunks_exact_mut(self.stride)
    }
}

/// A slice with a varying number of consecutive entries for each vertex, given by offsets.
#[derive(Debug)]
pub struct Ragged<'a, O> {
    entries: &'a mut [O],
    offsets: &'a [usize],
}

impl<'a, O> Ragged<'a, O> {
    /// The slice `entries`, of which slot k has those from `offsets[k]` up to `offsets[k + 1]`.
    ///
    /// # Panics
    /// If the offsets do not start at 0 and end at the number of entries.
    pub fn new(entries: &'a mut [O], offsets: &'a [usize]) -> Self {
        assert!(
            offsets.first() == Some(&0) && offsets.last() == Some(&entries.len()),
            "the offsets must lead from the first entry to the end"
        );
        Self { entries, offsets }
    }
}

impl<'a, O: Send> Slots for Ragged<'a, O> {
    type Slot = &'a mut [O];
    #[inline]
    fn count(&self) -> usize {
        self.offsets.len() - 1
    }
    #[inline]
    fn split_at(self, middle: usize) -> (Self, Self) {
        let (low, high) = (&self.offsets[..=middle], &self.offsets[middle..]);
        let (before, after) = self.entries.split_at_mut(low[middle] - low[0]);
        (
            Self {
                entries: before,
                offsets: low,
            },
            Self {
                entries: after,
                offsets: high,
            },
        )
    }
    #[inline]
    fn into_slots(self) -> impl Iterator<Item = &'a mut [O]> {
        let mut entries = self.entries;
        self.offsets.windows(2).map(move |ends| {
            let (slot, rest) = core::mem::take(&mut entries).split_at_mut(ends[1] - ends[0]);
            entries = rest;
            slot
        })
    }
}

impl<A: Slots, B: Slots> Slots for (A, B) {
    type Slot = (A::Slot, B::Slot);
    #[inline]
    fn count(&self) -> usize {
        self.0.count().min(self.1.count())
    }
    #[inline]
    fn split_at(self, middle: usize) -> (Self, Self) {
        let (low, high) = (self.0.split_at(middle), self.1.split_at(middle));
        ((low.0, high.0), (low.1, high.1))
    }
    #[inline]
    fn into_slots(self) -> impl Iterator<Item = Self::Slot> {
        self.0.into_slots().zip(self.1.into_slots())
    }
}

/// A computation over consecutive slots.
pub trait SlotKernel<S, O: Slots>: Sync {
    /// Sets the slots `start`, `start + 1`, …, up to the end of the output. The result in a slot
    /// must not depend on the previous content of `scratch`, nor on which other slots the same call
    /// sets.
    fn set(&self, scratch: &mut S, start: usize, slots: O);
}

/// A closure as a kernel: one slot after the other.
struct Closure<F>(F);

impl<S, O: Slots, F: Fn(&mut S, usize, O::Slot) + Sync> SlotKernel<S, O> for Closure<F> {
    #[inline(always)]
    fn set(&self, scratch: &mut S, start: usize, slots: O) {
        for (k, slot) in slots.into_slots().enumerate() {
            (self.0)(scratch, start + k, slot);
        }
    }
}

/// Loops over elements and vertices.
///
/// Laws: every loop does what its documentation says, in whatever order. Sums are grouped by the
/// number of terms alone, so that results do not depend on the division of work.
pub trait Execution {
    /// Adds to the `output` of each vertex the contributions of `kernel` for all elements around
    /// it, in the order of the elements. `input` has an entry for each vertex, or none if `IN` is
    /// 0.
    ///
    /// # Panics
    /// If an element names a vertex without position or input, or `output` has fewer entries than
    /// the surface has vertices.
    fn scatter<T, K, const CORNERS: usize, const IN: usize, const OUT: usize>(
        &self,
        kernel: &K,
        surface: Surface<'_, T>,
        elements: &[[u32; CORNERS]],
        input: &[[T; IN]],
        output: &mut [[T; OUT]],
    ) where
        T: Real,
        K: ElementKernel<T, CORNERS, IN, OUT>;

    /// Calls `set(k, slot)` once for every slot k of `output`.
    ///
    /// For little work per slot: executions that compile loops for wider vectors cannot compile
    /// closures in this way, only the kernels of [`Self::run`].
    fn map<O: Slots>(&self, output: O, set: impl Fn(usize, O::Slot) + Sync) {
        self.map_with(&mut Vec::new(), output, |(), k, slot| set(k, slot));
    }

    /// Calls `set(scratch, k, slot)` once for every slot k of `output`. `scratches` grows to one
    /// entry per worker. Results must not depend on the content of `scratch` at the start of a
    /// call.
    fn map_with<S: Default + Send, O: Slots>(
        &self,
        scratches: &mut Vec<S>,
        output: O,
        set: impl Fn(&mut S, usize, O::Slot) + Sync,
    ) {
        self.run(scratches, output, &Closure(set));
    }

    /// [`Self::map_with`] for a kernel. A kernel sets several slots at once and, unlike a closure,
    /// can be compiled as part of the loop.
    fn run<S: Default + Send, O: Slots>(
        &self,
        scratches: &mut Vec<S>,
        output: O,
        kernel: &impl SlotKernel<S, O>,
    );

    /// Σ `term(k)` for k in 0 … `count` − 1.
    fn sum<T: Real>(&self, count: usize, term: impl Fn(usize) -> T + Sync) -> T;
}

/// Number of elements that [`scatter_onto`] gathers before it evaluates their formula: enough to
/// vectorise the loop, and few enough for the first-level cache.
pub const BATCH: usize = 32;

/// The checks that every [`Execution::scatter`] has to make.
///
/// # Panics
/// If `output` has fewer entries than the surface has vertices.
pub fn check_output<T: Real, O>(surface: Surface<'_, T>, output: &[O]) {
    let vertices = surface.positions().len();
    assert!(
        output.len() >= vertices,
        "the output has {} entries, the surface {vertices} vertices",
        output.len()
    );
}

/// The entries of an output that belong to vertices.
///
/// # Panics
/// As [`check_output`].
pub(crate) fn of_vertices<'a, T: Real, O>(
    surface: Surface<'_, T>,
    output: &'a mut [O],
) -> &'a mut [O] {
    check_output(surface, output);
    &mut output[..surface.positions().len()]
}

/// Scatters `elements` onto the vertices `start`, `start + 1`, …, one per entry of `output`: adds
/// to these as [`Execution::scatter`] does, and to no other vertex. All executions use this
/// function.
///
/// The formula runs over a batch of elements in one loop without branches. Compilers vectorise this
/// loop with the width that the calling function allows, because this function is inlined there.
///
/// # Panics
/// If an element around them names a vertex without position or input.
#[inline(always)]
pub fn scatter_onto<T, K, const CORNERS: usize, const IN: usize, const OUT: usize>(
    kernel: &K,
    surface: Surface<'_, T>,
    elements: &[[u32; CORNERS]],
    input: &[[T; IN]],
    start: usize,
    output: &mut [[T; OUT]],
) where
    T: Real,
    K: ElementKernel<T, CORNERS, IN, OUT>,
{
    let all = start == 0 && output.len() >= surface.positions().len();
    let place = |vertex: u32| (vertex as usize).wrapping_sub(start);
    let mut positions = [[[T::zero(); BATCH]; 3]; CORNERS];
    let mut values = [[[T::zero(); IN]; BATCH]; CORNERS];
    // An array for each number, into which vectors are stored as they are.
    let mut contributions = [[[T::zero(); BATCH]; OUT]; CORNERS];
    for (number, batch) in elements.chunks(BATCH).enumerate() {
        let near = |element: &[u32; CORNERS]| element.iter().any(|&v| place(v) < output.len());
        if !all && !batch.iter().any(near) {
            continue;
        }
        let count = batch.len().min(BATCH);
        for e in 0..count {
            for corner in 0..CORNERS {
                let vertex = batch[e][corner];
                let position = surface.position_near(vertex, batch[e][0]);
                for axis in 0..3 {
                    positions[corner][axis][e] = position[axis];
                }
                if IN > 0 {
                    values[corner][e] = input[vertex as usize];
                }
            }
        }
        for e in 0..count {
            let mut corners = [[T::zero(); 3]; CORNERS];
            let mut known = [[T::zero(); IN]; CORNERS];
            for corner in 0..CORNERS {
                for axis in 0..3 {
                    corners[corner][axis] = positions[corner][axis][e];
                }
                known[corner] = values[corner][e];
            }
            let corners = Corners { positions: corners };
            let given = kernel.evaluate(number * BATCH + e, &corners, &known);
            for corner in 0..CORNERS {
                for k in 0..OUT {
                    contributions[corner][k][e] = given[corner][k];
                }
            }
        }
        for e in 0..count {
            for corner in 0..CORNERS {
                if let Some(sum) = output.get_mut(place(batch[e][corner])) {
                    for k in 0..OUT {
                        sum[k] += contributions[corner][k][e];
                    }
                }
            }
        }
    }
}

/// One element after the other, on one thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Serial;

impl Execution for Serial {
    #[inline]
    fn scatter<T, K, const CORNERS: usize, const IN: usize, const OUT: usize>(
        &self,
        kernel: &K,
        surface: Surface<'_, T>,
        elements: &[[u32; CORNERS]],
        input: &[[T; IN]],
        output: &mut [[T; OUT]],
    ) where
        T: Real,
        K: ElementKernel<T, CORNERS, IN, OUT>,
    {
        check_output(surface, output);
        scatter_onto(kernel, surface, elements, input, 0, output);
    }

    #[inline]
    fn map<O: Slots>(&self, output: O, set: impl Fn(usize, O::Slot) + Sync) {
        for (k, slot) in output.into_slots().enumerate() {
            set(k, slot);
        }
    }

    #[inline]
    fn run<S: Default + Send, O: Slots>(
        &self,
        scratches: &mut Vec<S>,
        output: O,
        kernel: &impl SlotKernel<S, O>,
    ) {
        if scratches.is_empty() {
            scratches.push(S::default());
        }
        kernel.set(&mut scratches[0], 0, output);
    }

    #[inline]
    fn sum<T: Real>(&self, count: usize, term: impl Fn(usize) -> T + Sync) -> T {
        reduction::sum(count, &term)
    }
}
