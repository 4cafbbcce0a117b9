//! Numbers at the nodes and elements of Gmsh's files.

use super::super::{Column, ColumnPlace, ParseError};
use super::{COUNT, DOUBLE, INT, Reader, TAG};

impl Reader<'_> {
    /// Reads a section of numbers; those of one component become a column, with NaN where there are none.
    pub(super) fn data(&mut self, is_of_nodes: bool) -> Result<(), ParseError> {
        let texts: usize = self.tokens.parsed("the number of texts")?;
        self.tokens.line();
        let mut name = None;
        for _ in 0..texts {
            let line = self.tokens.line();
            let line = line.ok_or_else(|| self.tokens.expected("a text", None, None))?;
            let text = String::from_utf8_lossy(line);
            name.get_or_insert(text.trim_matches('"').to_owned());
        }
        for _ in 0..self.tokens.parsed::<usize>("the number of real numbers")? {
            self.tokens
                .parsed::<f64>("a real number, such as the time")?;
        }
        // The step, the number of components and the number of items.
        let mut integers = [0; 3];
        for at in 0..self.tokens.parsed::<usize>("the number of whole numbers")? {
            let number: usize = self.tokens.parsed("a whole number")?;
            if let Some(integer) = integers.get_mut(at) {
                *integer = number;
            }
        }
        if self.tokens.binary.is_some() {
            self.tokens.line();
        }
        let [_, components, count] = integers;
        let (tags, places, place) = match is_of_nodes {
            true => (
                &self.nodes,
                self.cells.builder.positions.len(),
                ColumnPlace::Vertices,
            ),
            false => (
                &self.elements,
                self.cells.triangles.len(),
                ColumnPlace::Triangles,
            ),
        };
        if components != 1 {
            for _ in 0..count {
                self.tokens.integer(INT, TAG)?;
                for _ in 0..components {
                    self.tokens.float(DOUBLE, "a number")?;
                }
            }
            return Ok(());
        }
        // An empty section takes few bytes, whatever the number of nodes.
        if count < places / 2 {
            return Err(self.tokens.expected(COUNT, Some(b"few"), None));
        }
        let mut values = vec![f64::NAN; places];
        for _ in 0..count {
            let tag = self.tokens.integer(INT, TAG)?;
            let value = self.tokens.float(DOUBLE, "a number")?;
            if let Some(known) = tags.get(&tag).and_then(|&at| values.get_mut(at as usize)) {
                *known = value;
            }
        }
        let name = name.unwrap_or_default();
        self.columns.push(Column {
            name,
            place,
            values,
        });
        Ok(())
    }
}
