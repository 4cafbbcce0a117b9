//! Sparse maps between fields on meshes.

use crate::element::Execution;
use crate::real::Real;
use alloc::vec::Vec;

/// A sparse linear map `y_i = Σ_j w_ij x_j` in compressed rows, for fields with any number of
/// values per vertex.
///
/// The weights are held in `f64` and rounded to the field's number type when they are used.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stencils {
    sources: usize,
    offsets: Vec<usize>,
    columns: Vec<u32>,
    weights: Vec<f64>,
}

impl Stencils {
    /// The identity map.
    pub(crate) fn identity(count: usize) -> Self {
        Self {
            sources: count,
            offsets: (0..=count).collect(),
            columns: (0..count as u32).collect(),
            weights: alloc::vec![1.0; count],
        }
    }

    /// A map from fields of `sources` entries, without rows yet.
    pub(crate) fn with_capacity(sources: usize, rows: usize, entries: usize) -> Self {
        let mut offsets = Vec::with_capacity(rows + 1);
        offsets.push(0);
        Self {
            sources,
            offsets,
            columns: Vec::with_capacity(entries),
            weights: Vec::with_capacity(entries),
        }
    }

    pub(crate) fn push_row(&mut self, entries: impl IntoIterator<Item = (u32, f64)>) {
        for (column, weight) in entries {
            self.columns.push(column);
            self.weights.push(weight);
        }
        self.offsets.push(self.columns.len());
    }

    /// Number of rows: of entries in the result.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of entries of the fields that the map takes.
    pub fn sources(&self) -> usize {
        self.sources
    }

    /// The columns j and weights w_ij of row i.
    ///
    /// # Panics
    /// If there is no such row.
    #[inline]
    pub fn row(&self, row: usize) -> (&[u32], &[f64]) {
        let range = self.offsets[row]..self.offsets[row + 1];
        (&self.columns[range.clone()], &self.weights[range])
    }

    /// Entry i of the result.
    #[inline]
    pub(crate) fn at<T: Real, const D: usize>(&self, row: usize, field: &[[T; D]]) -> [T; D] {
        let (columns, weights) = self.row(row);
        let mut sum = [T::zero(); D];
        for (&column, &weight) in columns.iter().zip(weights) {
            let weight = T::constant(weight);
            let entry = &field[column as usize];
            for k in 0..D {
                sum[k] += weight * entry[k];
            }
        }
        sum
    }

    /// Sets `result` to the map of a field of D numbers per vertex.
    ///
    /// # Panics
    /// If `field` has fewer entries than [`Self::sources`], or `result` fewer than [`Self::len`].
    pub fn apply<T: Real, const D: usize>(
        &self,
        execution: &impl Execution,
        field: &[[T; D]],
        result: &mut [[T; D]],
    ) {
        execution.map(&mut result[..self.len()], |row, result| {
            *result = self.at(row, field);
        });
    }

    /// The transpose: the map that pulls forces on the result back to forces on the sources.
    pub fn transpose(&self) -> Self {
        let mut offsets = alloc::vec![0usize; self.sources + 1];
        for &column in &self.columns {
            offsets[column as usize + 1] += 1;
        }
        for column in 0..self.sources {
            offsets[column + 1] += offsets[column];
        }
        let mut next = offsets.clone();
        let mut columns = alloc::vec![0u32; self.columns.len()];
        let mut weights = alloc::vec![0.0; self.weights.len()];
        for row in 0..self.len() {
            let (sources, row_weights) = self.row(row);
            for (&source, &weight) in sources.iter().zip(row_weights) {
                let place = &mut next[source as usize];
                columns[*place] = row as u32;
                weights[*place] = weight;
                *place += 1;
            }
        }
        Self {
            sources: self.len(),
            offsets,
            columns,
            weights,
        }
    }

    /// The composition: first this map, then `next`.
    ///
    /// # Panics
    /// If `next` does not take fields of [`Self::len`] entries.
    pub fn then(&self, next: &Self) -> Self {
        assert_eq!(next.sources, self.len(), "maps do not follow each other");
        let mut sum = RowSum::new(self.sources);
        let mut result = Self::with_capacity(self.sources, next.len(), 12 * next.len());
        for row in 0..next.len() {
            let (columns, weights) = next.row(row);
            for (&column, &weight) in columns.iter().zip(weights) {
                sum.add_row(self, column as usize, weight);
            }
            sum.finish(&mut result);
        }
        result
    }
}

/// Builder of a row: a sum of entries in any order.
pub(crate) struct RowSum {
    /// The weight of every source; zero if it is not in the row.
    weights: Vec<f64>,
    met: Vec<bool>,
    columns: Vec<u32>,
}

impl RowSum {
    pub(crate) fn new(sources: usize) -> Self {
        Self {
            weights: alloc::vec![0.0; sources],
            met: alloc::vec![false; sources],
            columns: Vec::new(),
        }
    }

    pub(crate) fn add(&mut self, column: u32, weight: f64) {
        let at = column as usize;
        if !self.met[at] {
            self.met[at] = true;
            self.columns.push(column);
        }
        self.weights[at] += weight;
    }

    /// Adds a row of another map, times `factor`.
    pub(crate) fn add_row(&mut self, map: &Stencils, row: usize, factor: f64) {
        let (columns, weights) = map.row(row);
        for (&column, &weight) in columns.iter().zip(weights) {
            self.add(column, factor * weight);
        }
    }

    /// Appends the row to a map, with columns in the order of their first occurrence, and clears
    /// the builder.
    pub(crate) fn finish(&mut self, map: &mut Stencils) {
        let Self {
            weights,
            met,
            columns,
        } = self;
        map.push_row(columns.drain(..).map(|column| {
            let at = column as usize;
            met[at] = false;
            (column, core::mem::take(&mut weights[at]))
        }));
    }
}
