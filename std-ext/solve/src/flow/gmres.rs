//! Linear systems of fields by generalised minimal residuals.
//!
//! Y. Saad, M. H. Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856; restarted, with modified
//! Gram–Schmidt and plane rotations as in algorithm 6.9 of Y. Saad, Iterative Methods for Sparse
//! Linear Systems, SIAM 2003.

/// A field: one vector per vertex.
type Field = Vec<[f64; 3]>;

/// Sets the second field to A times the first.
pub type Product<'a> = dyn FnMut(&[[f64; 3]], &mut [[f64; 3]]) + 'a;

/// The rounding error of sums of orthogonal parts, relative.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Solves `A x = b` for fields where only the product with A is known.
///
/// A need not be symmetric or definite. Each product adds a direction in which the residual `|b − A
/// x|` is minimised; after [`restart`](Self::restart) directions the method restarts. Sums run in a
/// fixed order, so that the same products give the same bits.
///
/// Memory for `restart + 2` fields is kept from one solution to the next.
#[derive(Clone, Debug)]
pub struct Gmres {
    /// Tolerance of the residual, relative to |b|.
    pub tolerance: f64,
    /// Largest number of directions before a restart, at least 1.
    pub restart: usize,
    /// Largest number of products with A.
    pub products: usize,
    /// Orthonormal directions; the first `restart + 1` hold the basis.
    basis: Vec<Field>,
    /// Columns of the rotated triangle, `restart` entries each.
    triangle: Vec<f64>,
    /// Cosine and sine of each plane rotation.
    rotations: Vec<[f64; 2]>,
    /// The residual in the rotated basis.
    rest: Vec<f64>,
    /// A product, before it becomes a direction.
    product: Field,
}

/// Report of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// Whether the residual is within the tolerance.
    pub converged: bool,
    /// Number of products with A.
    pub products: usize,
    /// `|b − A x|/|b|` from the recurrence; NaN or infinite if b is.
    pub residual: f64,
}

impl Gmres {
    /// A solver with this tolerance, relative to |b|, and at most 30 directions and 100 products.
    pub fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            restart: 30,
            products: 100,
            basis: Vec::new(),
            triangle: Vec::new(),
            rotations: Vec::new(),
            rest: Vec::new(),
            product: Vec::new(),
        }
    }

    /// Solves `A x = b`, `apply` being the product with A.
    ///
    /// `solution` holds the first guess, and in the end the best x that was found, converged or
    /// not: it is always finite. A guess that is not finite counts as zero; `b = 0` gives `x = 0`.
    /// A product that is not finite ends the solution, and so does one that leaves no new direction.
    ///
    /// # Panics
    /// If `right` and `solution` differ in length.
    pub fn solve(
        &mut self,
        apply: &mut Product<'_>,
        right: &[[f64; 3]],
        solution: &mut [[f64; 3]],
    ) -> Solved {
        assert_eq!(
            right.len(),
            solution.len(),
            "as many entries of x as there are of b"
        );
        let length = norm(right);
        let finite = solution.as_flattened().iter().all(|x| x.is_finite());
        if !finite || length == 0.0 {
            solution.fill([0.0; 3]);
        }
        let mut solved = Solved {
            converged: length == 0.0,
            products: 0,
            residual: if length.is_finite() { 1.0 } else { length },
        };
        if length == 0.0 {
            solved.residual = 0.0;
        }
        if length == 0.0 || !length.is_finite() {
            return solved;
        }
        self.prepare(right.len());
        loop {
            let before = solved.products;
            if self.cycle(apply, right, length, solution, &mut solved)
                || solved.products >= self.products
                || solved.products == before
            {
                return solved;
            }
        }
    }

    /// Allocates memory.
    fn prepare(&mut self, count: usize) {
        let restart = self.restart.max(1);
        self.basis.resize(restart + 1, Vec::new());
        for field in self.basis.iter_mut().chain([&mut self.product]) {
            field.resize(count, [0.0; 3]);
        }
        self.triangle.resize(restart * restart, 0.0);
        self.rotations.resize(restart, [1.0, 0.0]);
        self.rest.resize(restart + 1, 0.0);
    }

    /// Iterates until the next restart; true if no further progress is possible.
    fn cycle(
        &mut self,
        apply: &mut Product<'_>,
        right: &[[f64; 3]],
        length: f64,
        solution: &mut [[f64; 3]],
        solved: &mut Solved,
    ) -> bool {
        let Self {
            tolerance,
            basis,
            triangle,
            rotations,
            rest,
            product,
            ..
        } = self;
        let restart = rotations.len();
        // The residual of the start.
        basis[0].copy_from_slice(right);
        if solution.as_flattened().iter().any(|&x| x != 0.0) {
            if solved.products >= self.products {
                return true;
            }
            solved.products += 1;
            apply(solution, product);
            add_scaled(&mut basis[0], -1.0, product);
        }
        let size = norm(&basis[0]);
        if !size.is_finite() {
            // A guess whose product is infinite is discarded.
            solution.fill([0.0; 3]);
            solved.residual = 1.0;
            return false;
        }
        solved.residual = size / length;
        solved.converged = solved.residual <= *tolerance;
        if solved.converged {
            return true;
        }
        scale(&mut basis[0], size.recip());
        rest[0] = size;

        let mut columns = 0;
        let mut ended = false;
        while columns < restart && solved.products < self.products && !ended {
            let (known, new) = basis.split_at_mut(columns + 1);
            let new = &mut new[0];
            apply(&known[columns], new);
            solved.products += 1;
            let size = norm(new);
            if !size.is_finite() {
                ended = true;
                break;
            }
            let column = &mut triangle[columns * restart..][..restart];
            for (entry, direction) in column.iter_mut().zip(&*known) {
                *entry = dot(direction, new);
                add_scaled(new, -*entry, direction);
            }
            let mut below = norm(new);
            // The rest is rounding: A maps the span of the directions onto itself.
            if below <= ROUNDING * size {
                below = 0.0;
                ended = true;
            } else {
                scale(new, below.recip());
            }
            for (k, &[cosine, sine]) in rotations[..columns].iter().enumerate() {
                let [upper, lower] = [column[k], column[k + 1]];
                column[k] = cosine * upper + sine * lower;
                column[k + 1] = cosine * lower - sine * upper;
            }
            let diagonal = column[columns].hypot(below);
            if diagonal <= ROUNDING * size {
                // The product adds no new direction, so this direction is dropped.
                ended = true;
                break;
            }
            let [cosine, sine] = [column[columns] / diagonal, below / diagonal];
            rotations[columns] = [cosine, sine];
            column[columns] = diagonal;
            rest[columns + 1] = -sine * rest[columns];
            rest[columns] *= cosine;
            columns += 1;
            solved.residual = rest[columns].abs() / length;
            solved.converged = solved.residual <= *tolerance;
            ended |= solved.converged;
        }

        if !self.advance(columns, solution) {
            solved.residual = size / length;
            solved.converged = false;
            ended = true;
        }
        ended
    }

    /// Adds the combination of the first directions to the solution. If the result is not finite, as
    /// for a nearly singular triangle, the solution is kept, and the return value is false.
    fn advance(&mut self, columns: usize, solution: &mut [[f64; 3]]) -> bool {
        let Self {
            basis,
            triangle,
            rotations,
            rest,
            product,
            ..
        } = self;
        let restart = rotations.len();
        // Back substitution, in the memory of the rotated residual.
        for k in (0..columns).rev() {
            let known = (k + 1..columns).map(|j| triangle[j * restart + k] * rest[j]);
            rest[k] = (rest[k] - known.sum::<f64>()) / triangle[k * restart + k];
        }
        product.copy_from_slice(solution);
        for (&factor, direction) in rest[..columns].iter().zip(&*basis) {
            add_scaled(product, factor, direction);
        }
        let is_finite = product.as_flattened().iter().all(|x| x.is_finite());
        if is_finite {
            solution.copy_from_slice(product);
        }
        is_finite
    }
}

fn dot(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let rows = a.iter().zip(b);
    rows.map(|([a, b, c], [x, y, z])| a * x + b * y + c * z)
        .sum()
}

fn norm(a: &[[f64; 3]]) -> f64 {
    dot(a, a).sqrt()
}

fn scale(a: &mut [[f64; 3]], factor: f64) {
    a.as_flattened_mut().iter_mut().for_each(|x| *x *= factor);
}

/// `y += factor x`.
fn add_scaled(y: &mut [[f64; 3]], factor: f64, x: &[[f64; 3]]) {
    let rows = y.as_flattened_mut().iter_mut().zip(x.as_flattened());
    rows.for_each(|(y, x)| *y += factor * x);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A full matrix of `3 count` rows, well conditioned and not symmetric.
    fn matrix(count: usize) -> Vec<Vec<f64>> {
        let size = 3 * count;
        let entry = |i: usize, j: usize| {
            let wave = (1.0 + (i * i) as f64 + 7.0 * (i * j) as f64).sin() / size as f64;
            if i == j { 2.0 + (i as f64).sin() } else { wave }
        };
        (0..size)
            .map(|i| (0..size).map(|j| entry(i, j)).collect())
            .collect()
    }

    fn product(matrix: &[Vec<f64>], x: &[[f64; 3]], y: &mut [[f64; 3]]) {
        for (row, y) in matrix.iter().zip(y.as_flattened_mut()) {
            *y = row.iter().zip(x.as_flattened()).map(|(a, x)| a * x).sum();
        }
    }

    fn field(count: usize) -> Field {
        (0..count)
            .map(|k| [1.0, 2.0, 3.0].map(|phase| (phase + 0.7 * k as f64).cos()))
            .collect()
    }

    fn distance(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
        let mut apart = a.to_vec();
        add_scaled(&mut apart, -1.0, b);
        norm(&apart)
    }

    #[test]
    fn systems_are_solved_with_and_without_restarts() {
        let matrix = matrix(40);
        let expected = field(40);
        let mut right = expected.clone();
        product(&matrix, &expected, &mut right);
        let mut products = Vec::new();
        for restart in [30, 3, 1, 0] {
            let mut gmres = Gmres {
                restart,
                ..Gmres::new(1e-10)
            };
            let mut x = vec![[0.0; 3]; 40];
            let solved = gmres.solve(&mut |v, w| product(&matrix, v, w), &right, &mut x);
            assert!(solved.converged && solved.residual <= 1e-10, "{solved:?}");
            let mut rest = vec![[0.0; 3]; 40];
            product(&matrix, &x, &mut rest);
            add_scaled(&mut rest, -1.0, &right);
            let residual = norm(&rest) / norm(&right);
            // The recurrence is the residual, to rounding.
            assert!((residual - solved.residual).abs() < 1e-14, "{residual}");
            assert!(distance(&x, &expected) < 1e-9 * norm(&expected));
            products.push(solved.products);
            // The same again is the same to the last bit, whatever is left in memory.
            let first = x;
            let mut x = vec![[0.0; 3]; 40];
            let again = gmres.solve(&mut |v, w| product(&matrix, v, w), &right, &mut x);
            assert!(again == solved && x == first);
        }
        assert!(products[0] < products[1], "{products:?}");
    }

    #[test]
    fn good_guesses_save_products() {
        let matrix = matrix(20);
        let right = field(20);
        let mut gmres = Gmres::new(1e-8);
        let mut x = vec![[0.0; 3]; 20];
        let cold = gmres.solve(&mut |v, w| product(&matrix, v, w), &right, &mut x);
        let again = gmres.solve(&mut |v, w| product(&matrix, v, w), &right, &mut x);
        assert_eq!(again.products, 1);
        assert!(again.converged);
        x[3][1] += 1e-6;
        let warm = gmres.solve(&mut |v, w| product(&matrix, v, w), &right, &mut x);
        assert!(
            warm.converged && warm.products < cold.products,
            "{warm:?} {cold:?}"
        );
        x[3][1] = f64::NAN;
        let bad = gmres.solve(&mut |v, w| product(&matrix, v, w), &right, &mut x);
        assert_eq!(bad, cold);
    }

    #[test]
    fn multiples_of_the_identity_take_one_product() {
        let right = field(5);
        let mut x = vec![[0.0; 3]; 5];
        let mut twice = |v: &[[f64; 3]], w: &mut [[f64; 3]]| {
            w.copy_from_slice(v);
            scale(w, 2.0);
        };
        let solved = Gmres::new(1e-12).solve(&mut twice, &right, &mut x);
        assert!(solved.converged && solved.products == 1, "{solved:?}");
        scale(&mut x, 2.0);
        assert!(distance(&x, &right) < 1e-14);
    }

    #[test]
    fn what_cannot_be_solved_is_said() {
        let right = field(4);
        let mut gmres = Gmres::new(1e-10);
        let zero = [[0.0; 3]; 4];

        // b = 0.
        let mut x = right.clone();
        let mut copy = |v: &[[f64; 3]], w: &mut [[f64; 3]]| w.copy_from_slice(v);
        let solved = gmres.solve(&mut copy, &zero, &mut x);
        assert!(solved.converged && solved.residual == 0.0 && x == zero);
        assert!(gmres.solve(&mut copy, &[], &mut []).converged);

        // A = 0, and A of rank 1 that misses b.
        let mut x = zero.to_vec();
        let mut nothing = |_: &[[f64; 3]], w: &mut [[f64; 3]]| w.fill([0.0; 3]);
        let solved = gmres.solve(&mut nothing, &right, &mut x);
        assert!(!solved.converged && solved.residual == 1.0 && x == zero);
        let mut first = |v: &[[f64; 3]], w: &mut [[f64; 3]]| {
            w.fill([0.0; 3]);
            w[0][0] = v[0][0];
        };
        let solved = gmres.solve(&mut first, &right, &mut x);
        assert!(!solved.converged && solved.products < 5, "{solved:?}");
        assert!(x.as_flattened().iter().all(|x| x.is_finite()));

        // A that turns by a right angle needs both directions.
        let mut turn =
            |v: &[[f64; 3]], w: &mut [[f64; 3]]| w.copy_from_slice(&[[-v[0][1], v[0][0], v[0][2]]]);
        let mut x = [[0.0; 3]];
        let solved = gmres.solve(&mut turn, &[[1.0, 0.0, 0.0]], &mut x);
        assert!(solved.converged && solved.products == 2, "{solved:?}");
        assert!(distance(&x, &[[0.0, -1.0, 0.0]]) < 1e-15);

        // Numbers that are none, from A or in b; too few products.
        let mut calls = 0;
        let mut spoilt = |v: &[[f64; 3]], w: &mut [[f64; 3]]| {
            calls += 1;
            w.copy_from_slice(v);
            w[0][0] *= 3.0;
            if calls > 1 {
                w[1][1] = f64::NAN;
            }
        };
        let mut x = zero.to_vec();
        let solved = gmres.solve(&mut spoilt, &right, &mut x);
        assert!(!solved.converged && solved.residual < 1.0, "{solved:?}");
        assert!(x.as_flattened().iter().all(|x| x.is_finite()) && x != zero);
        let mut right = right;
        right[2][0] = f64::INFINITY;
        let solved = gmres.solve(&mut copy, &right, &mut x);
        assert!(!solved.converged && solved.products == 0);
        gmres.products = 0;
        let solved = gmres.solve(&mut copy, &field(4), &mut x);
        assert!(!solved.converged && solved.products == 0);
    }
}
