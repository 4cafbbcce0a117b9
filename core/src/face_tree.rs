//! The nearest point of flat triangles, by a hierarchy of bounding boxes.
//!
//! C. Ericson, Real-Time Collision Detection (2005), sections 5.1.5 and 6.2.

use crate::lane::Lane;
use crate::real::Real;
use crate::surface::Surface;
use crate::vec3::{Vec3, add, dot, scale, sub};
use alloc::vec;
use alloc::vec::Vec;
use core::array::from_fn;
use core::iter::zip;

/// Most triangles of a leaf.
const LEAF: usize = 4;

/// A box, and its children, or the triangles of a leaf.
#[derive(Clone, Debug)]
struct BoxNode<T> {
    low: Vec3<T>,
    high: Vec3<T>,
    /// The triangles below, as places in the order of the tree.
    start: u32,
    end: u32,
    /// The second child, 0 for a leaf; the first one is the next node.
    second: u32,
}

/// A place on a mesh: a triangle, and barycentric coordinates, which are not negative and have the sum 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshPoint<T> {
    /// The triangle.
    pub triangle: usize,
    /// The weights of its corners, in order.
    pub barycentric: [T; 3],
}

/// The triangles of a surface in a binary tree of boxes.
#[derive(Clone, Debug)]
pub(crate) struct FaceTree<T> {
    nodes: Vec<BoxNode<T>>,
    order: Vec<u32>,
}

impl<T: Real> FaceTree<T> {
    pub(crate) fn new(surface: Surface<'_, T>) -> Self {
        let triangles = surface.mesh().triangles();
        let boxes = (0..triangles.len()).map(|triangle| bounds(surface, triangle));
        let boxes = Vec::from_iter(boxes);
        let mut order = Vec::from_iter(0..triangles.len() as u32);
        let mut nodes = Vec::new();
        if !order.is_empty() {
            divide(&boxes, &mut order, 0, &mut nodes);
        }
        Self { nodes, order }
    }

    /// The point of the triangles that is nearest to `point`; `None` without triangles, or if no distance is a number. The
    /// search is short if `first` is a triangle nearby. Of triangles at the same distance it is that, or else the first in
    /// the order of the tree, which depends on the mesh alone.
    pub(crate) fn nearest(
        &self,
        surface: Surface<'_, T>,
        point: Vec3<T>,
        first: Option<usize>,
    ) -> Option<MeshPoint<T>> {
        let mut best = None;
        let mut least = T::infinity();
        let mut visit = |triangle: usize, least: &mut T| {
            let (barycentric, squared) = nearest_of(surface, triangle, point);
            if squared < *least {
                *least = squared;
                best = Some(MeshPoint {
                    triangle,
                    barycentric,
                });
            }
        };
        if let Some(first) = first {
            visit(first, &mut least);
        }
        let mut pending = vec![0_u32];
        while let Some(number) = pending.pop() {
            let Some(node) = self.nodes.get(number as usize) else {
                continue;
            };
            if node.squared_distance(point) >= least {
                continue;
            }
            if node.second == 0 {
                for &triangle in &self.order[node.start as usize..node.end as usize] {
                    visit(triangle as usize, &mut least);
                }
                continue;
            }
            let children = [number + 1, node.second];
            let [first, second] =
                children.map(|child| self.nodes[child as usize].squared_distance(point));
            let [near, far] = if second < first {
                [children[1], children[0]]
            } else {
                children
            };
            pending.extend([far, near]);
        }
        best
    }

    /// Calls a function with all pairs of triangles whose boxes meet, the lower number first, in any order.
    pub(crate) fn meeting_pairs(&self, surface: Surface<'_, T>, visit: &mut impl FnMut([u32; 2])) {
        let boxes = self.order.iter();
        let boxes = boxes.map(|&triangle| bounds(surface, triangle as usize));
        let boxes = Vec::from_iter(boxes);
        let mut pending = Vec::from_iter((!self.nodes.is_empty()).then_some([0_u32; 2]));
        while let Some(numbers) = pending.pop() {
            let [one, other] = numbers.map(|number| &self.nodes[number as usize]);
            if !meet([one.low, one.high], [other.low, other.high]) {
                continue;
            }
            let children = |number: u32, node: &BoxNode<T>| match node.second {
                0 => [number; 2],
                second => [number + 1, second],
            };
            let [ones, others] = [children(numbers[0], one), children(numbers[1], other)];
            match (one.second, other.second) {
                (0, 0) => {
                    for first in one.start..one.end {
                        // Within a leaf each pair once.
                        let start = if numbers[0] == numbers[1] {
                            first + 1
                        } else {
                            other.start
                        };
                        for second in start..other.end {
                            let [first, second] = [first, second].map(|place| place as usize);
                            if meet(boxes[first], boxes[second]) {
                                let [a, b] = [self.order[first], self.order[second]];
                                visit([a.min(b), a.max(b)]);
                            }
                        }
                    }
                }
                (0, _) => pending.extend(others.map(|child| [numbers[0], child])),
                (_, 0) => pending.extend(ones.map(|child| [child, numbers[1]])),
                _ => {
                    pending.extend([0, 1].map(|k| [ones[k], others[k]]));
                    pending.push([ones[0], others[1]]);
                    if numbers[0] != numbers[1] {
                        pending.push([ones[1], others[0]]);
                    }
                }
            }
        }
    }
}

/// Whether boxes have a common point.
fn meet<T: Real>([low, high]: [Vec3<T>; 2], [other_low, other_high]: [Vec3<T>; 2]) -> bool {
    let meet_along = |axis: usize| low[axis] <= other_high[axis] && other_low[axis] <= high[axis];
    meet_along(0) && meet_along(1) && meet_along(2)
}

impl<T: Real> BoxNode<T> {
    fn squared_distance(&self, point: Vec3<T>) -> T {
        let sides = zip(point, zip(self.low, self.high));
        let outside = sides.map(|(at, (low, high))| (low - at).max(at - high).max(T::zero()));
        outside.map(|outside| outside * outside).sum()
    }
}

/// The least and the largest coordinates of a triangle.
pub(crate) fn bounds<T: Real>(surface: Surface<'_, T>, triangle: usize) -> [Vec3<T>; 2] {
    let corners = surface.mesh().triangles()[triangle];
    let corners = corners.map(|corner| surface.positions()[corner as usize]);
    let pick = |choose: fn(T, T) -> T| {
        from_fn(|axis| choose(choose(corners[0][axis], corners[1][axis]), corners[2][axis]))
    };
    [pick(T::min), pick(T::max)]
}

/// Appends the tree of the triangles in `order`, of which the first has this place.
fn divide<T: Real>(
    boxes: &[[Vec3<T>; 2]],
    order: &mut [u32],
    place: u32,
    nodes: &mut Vec<BoxNode<T>>,
) {
    let mut low = [T::infinity(); 3];
    let mut high = [-T::infinity(); 3];
    for &triangle in &*order {
        let [least, most] = boxes[triangle as usize];
        for axis in 0..3 {
            low[axis] = low[axis].min(least[axis]);
            high[axis] = high[axis].max(most[axis]);
        }
    }
    let own = nodes.len();
    nodes.push(BoxNode {
        low,
        high,
        start: place,
        end: place + order.len() as u32,
        second: 0,
    });
    if order.len() <= LEAF {
        return;
    }
    let extent = sub(high, low);
    let longest = [1, 2].into_iter().fold(0, |longest, axis| {
        if extent[axis] > extent[longest] {
            axis
        } else {
            longest
        }
    });
    // Twice the middle of a box; the number decides between equal ones.
    let key = |triangle: u32| {
        let [low, high] = boxes[triangle as usize];
        low[longest] + high[longest]
    };
    let middle = order.len() / 2;
    order.select_nth_unstable_by(middle, |&a, &b| {
        let by_key = key(a).partial_cmp(&key(b));
        by_key.unwrap_or(core::cmp::Ordering::Equal).then(a.cmp(&b))
    });
    let (below, above) = order.split_at_mut(middle);
    divide(boxes, below, place, nodes);
    nodes[own].second = nodes.len() as u32;
    divide(boxes, above, place + middle as u32, nodes);
}

/// The barycentric coordinates of the point of a triangle that is nearest to `point`, and the squared distance.
pub(crate) fn nearest_of<T: Real>(
    surface: Surface<'_, T>,
    triangle: usize,
    point: Vec3<T>,
) -> ([T; 3], T) {
    let [a, b, c] =
        surface.mesh().triangles()[triangle].map(|corner| surface.positions()[corner as usize]);
    let (ab, ac, to) = (sub(b, a), sub(c, a), sub(point, a));
    let squared = |barycentric: [T; 3]| {
        let [_, along_b, along_c] = barycentric;
        let left = sub(to, add(scale(along_b, ab), scale(along_c, ac)));
        (barycentric, dot(left, left))
    };
    // Inside: the normal equations of the plane.
    let (bb, bc, cc) = (dot(ab, ab), dot(ab, ac), dot(ac, ac));
    let (by_b, by_c) = (dot(to, ab), dot(to, ac));
    let over = (bb * cc - bc * bc).reciprocal_or_zero();
    let along_b = (cc * by_b - bc * by_c) * over;
    let along_c = (bb * by_c - bc * by_b) * over;
    let along_a = T::one() - along_b - along_c;
    let zero = T::zero();
    if over > zero && along_a >= zero && along_b >= zero && along_c >= zero {
        return squared([along_a, along_b, along_c]);
    }
    // Otherwise on one of the edges.
    let clamped = |x: T| x.max(zero).min(T::one());
    let on_b = clamped(by_b * bb.reciprocal_or_zero());
    let on_c = clamped(by_c * cc.reciprocal_or_zero());
    let across = sub(ac, ab);
    let between = dot(sub(to, ab), across) * dot(across, across).reciprocal_or_zero();
    let between = clamped(between);
    let one = T::one();
    [[one - on_c, zero, on_c], [zero, one - between, between]]
        .into_iter()
        .map(squared)
        .fold(squared([one - on_b, on_b, zero]), |best, other| {
            if other.1 < best.1 { other } else { best }
        })
}
