//! The series of a run: a CSV file with a named column per quantity and a row per time.
//!
//! Every row is written by one call to the operating system, so that a run that is killed leaves
//! at most one torn line, the last. A resumed run truncates the file to the rows of its checkpoint
//! and continues. The file is then, byte for byte, that of an uninterrupted run.
//!
//! Numbers have enough digits to identify every `f64`; `NaN`, `inf` and `-inf` are kept.

use crate::io::replace_file;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Read, Seek, Write};
use std::path::{Path, PathBuf};

/// The name of the first column.
pub const TIME: &str = "time";

/// The name of the first column for drivers without time.
pub const ITERATION: &str = "iteration";

/// The reason why a series cannot be written or read. The message is one line that starts with the
/// name of the file.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct SeriesError {
    /// The file.
    pub path: PathBuf,
    /// The problem.
    pub problem: SeriesProblem,
}

/// Problems of a series.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SeriesProblem {
    /// The operating system refused to read or write the file.
    #[error("{0}")]
    Inaccessible(io::Error),
    /// The first column is neither the time nor the iteration.
    #[error("the first column is `{found}`: it has to be `{TIME}` or `{ITERATION}`")]
    NoTime {
        /// The value found.
        found: String,
    },
    /// A name that CSV readers would split, or an empty one.
    #[error(
        "the column name {name:?} is empty or has a comma, a quotation mark, a control character or \
         a space at an end"
    )]
    Name {
        /// The name.
        name: String,
    },
    /// Two columns have the same name.
    #[error("two columns are called `{name}`: names must be unique")]
    RepeatedName {
        /// The name.
        name: String,
    },
    /// A row has more or fewer numbers than there are columns.
    #[error("line {line}: {found} numbers, but there are {columns} columns")]
    WrongLength {
        /// The line, from 1.
        line: u64,
        /// Number of values.
        found: usize,
        /// The expected number.
        columns: usize,
    },
    /// A field of a row is not a number.
    #[error("line {line}, column `{column}`: expected a number, found `{found}`")]
    NotANumber {
        /// The line, from 1.
        line: u64,
        /// The column.
        column: String,
        /// The content found.
        found: String,
    },
    /// The columns of the file are not those of the run.
    #[error("the columns are `{found}`, but the run writes `{expected}`")]
    OtherColumns {
        /// The file's first line.
        found: String,
        /// The expected content.
        expected: String,
    },
    /// Rows of the checkpoint are missing.
    #[error(
        "there are {found} complete rows, but the checkpoint was written after {expected}: the file \
         was cut, replaced or taken away; put it back, or begin another run"
    )]
    TooFewRows {
        /// Number of rows.
        found: u64,
        /// The expected number.
        expected: u64,
    },
    /// Another program has written to the file.
    #[error(
        "the file has {found} bytes, and the run has written {expected}: another program has changed \
         it, and no more rows are added; `--resume` continues from the last checkpoint if the rows up \
         to there are unchanged"
    )]
    Changed {
        /// Length of the file.
        found: u64,
        /// Length to which the run has written it.
        expected: u64,
    },
    /// The bytes are not valid text, or a line is too long.
    #[error("line {line}: is not a row of numbers")]
    NotARow {
        /// The line, from 1.
        line: u64,
    },
}

impl SeriesProblem {
    fn of(self, path: &Path) -> SeriesError {
        SeriesError {
            path: path.to_owned(),
            problem: self,
        }
    }
}

impl From<io::Error> for SeriesProblem {
    fn from(error: io::Error) -> Self {
        Self::Inaccessible(error)
    }
}

/// A writer of a series.
#[derive(Debug)]
pub struct Series {
    path: PathBuf,
    file: File,
    columns: usize,
    rows: u64,
    /// The file's length in bytes, all of them complete lines.
    length: u64,
    /// The row that is being written.
    line: String,
}

impl Series {
    /// Starts a series with these columns, the first of them `time` or `iteration`. An existing file is
    /// replaced.
    ///
    /// # Errors
    /// If the columns are not valid in a CSV file, or the file cannot be written.
    pub fn create(path: &Path, columns: &[&str]) -> Result<Self, SeriesError> {
        let create = || {
            let header = header(columns)?;
            replace_file(path, |out| out.write_all(header.as_bytes()))?;
            Self::open(path, columns, 0, header.len() as u64)
        };
        create().map_err(|problem: SeriesProblem| problem.of(path))
    }

    /// Continues a series after its first `rows` rows; all that follows is cut off, complete or
    /// torn.
    ///
    /// # Errors
    /// If the file cannot be read or written, its columns are others, or it has fewer rows. The file is
    /// then unchanged.
    pub fn resume(path: &Path, columns: &[&str], rows: u64) -> Result<Self, SeriesError> {
        let resume = || {
            let header = header(columns)?;
            let mut lines = match Lines::open(path) {
                Err(error) if error.kind() == io::ErrorKind::NotFound => {
                    return Err(SeriesProblem::TooFewRows {
                        found: 0,
                        expected: rows,
                    });
                }
                lines => lines?,
            };
            let found = lines.next()?.unwrap_or_default();
            if found != header.trim_end() {
                return Err(SeriesProblem::OtherColumns {
                    found: found.to_owned(),
                    expected: header.trim_end().to_owned(),
                });
            }
            for found in 0..rows {
                let Some(row) = lines.next()? else {
                    return Err(SeriesProblem::TooFewRows {
                        found,
                        expected: rows,
                    });
                };
                numbers(row, found + 2, columns)?;
            }
            let length = lines.length;
            drop(lines);
            let series = Self::open(path, columns, rows, length)?;
            series.file.set_len(length)?;
            Ok(series)
        };
        resume().map_err(|problem: SeriesProblem| problem.of(path))
    }

    fn open(path: &Path, columns: &[&str], rows: u64, length: u64) -> Result<Self, SeriesProblem> {
        Ok(Self {
            path: path.to_owned(),
            file: Self::append_to(path)?,
            columns: columns.len(),
            rows,
            length,
            line: String::new(),
        })
    }

    /// Appends a row, one number per column; it has been passed to the operating system when this
    /// returns.
    ///
    /// # Errors
    /// If there are more or fewer numbers than columns, or the file cannot be written: it keeps
    /// the rows that it had.
    pub fn append(&mut self, row: &[f64]) -> Result<(), SeriesError> {
        if row.len() != self.columns {
            let problem = SeriesProblem::WrongLength {
                line: self.rows + 2,
                found: row.len(),
                columns: self.columns,
            };
            return Err(problem.of(&self.path));
        }
        self.line.clear();
        for (column, value) in row.iter().enumerate() {
            let separator = if column == 0 { "" } else { "," };
            // Writing to a string cannot fail.
            let _ = write!(self.line, "{separator}{value:?}");
        }
        self.line.push('\n');
        self.keep().map_err(|problem| problem.of(&self.path))?;
        if let Err(error) = self.file.write_all(self.line.as_bytes()) {
            // Part of the row may have been written, for example to a full disk. If it cannot be
            // removed, readers skip it.
            let _ = self.file.set_len(self.length);
            return Err(SeriesProblem::Inaccessible(error).of(&self.path));
        }
        self.length += self.line.len() as u64;
        self.rows += 1;
        Ok(())
    }

    /// Syncs all rows to the disk and returns their number, which a checkpoint has to store for
    /// [`Self::resume`].
    ///
    /// # Errors
    /// Any error of the operating system, or a change of the file by another program.
    pub fn mark(&mut self) -> Result<u64, SeriesError> {
        let marked = self.keep().and_then(|()| Ok(self.file.sync_data()?));
        marked.map_err(|problem| problem.of(&self.path))?;
        Ok(self.rows)
    }

    /// Ensures that the rows so far are in the file. If the file was deleted, it is written again
    /// from the content that the operating system still holds.
    fn keep(&mut self) -> Result<(), SeriesProblem> {
        let expected = self.length;
        match fs::metadata(&self.path) {
            Ok(metadata) if metadata.len() == expected => Ok(()),
            Ok(metadata) => Err(SeriesProblem::Changed {
                found: metadata.len(),
                expected,
            }),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                let mut rows = Vec::new();
                self.file.rewind()?;
                self.file.read_to_end(&mut rows)?;
                let found = rows.len() as u64;
                if found != expected {
                    return Err(SeriesProblem::Changed { found, expected });
                }
                replace_file(&self.path, |out| out.write_all(&rows))?;
                self.file = Self::append_to(&self.path)?;
                Ok(())
            }
            Err(error) => Err(error.into()),
        }
    }

    fn append_to(path: &Path) -> io::Result<File> {
        fs::OpenOptions::new().read(true).append(true).open(path)
    }
}

/// A series that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesTable {
    /// The names of the columns.
    pub columns: Vec<String>,
    /// The rows, one number a column.
    pub rows: Vec<Vec<f64>>,
}

impl SeriesTable {
    /// Reads a series. A torn last line is skipped, because the run may still be writing it.
    ///
    /// # Errors
    /// If the file cannot be read or is not a series; see [`SeriesProblem`].
    pub fn read(path: &Path) -> Result<Self, SeriesError> {
        let read = || {
            let mut lines = Lines::open(path)?;
            let header = lines.next()?.unwrap_or_default().to_owned();
            let columns: Vec<&str> = header.split(',').collect();
            check_names(&columns)?;
            let mut rows = Vec::new();
            while let Some(row) = lines.next()? {
                rows.push(numbers(row, rows.len() as u64 + 2, &columns)?);
            }
            Ok(Self {
                columns: columns.into_iter().map(str::to_owned).collect(),
                rows,
            })
        };
        read().map_err(|problem: SeriesProblem| problem.of(path))
    }

    /// The numbers of a column from the first row to the last; none if there is no such column.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let column = self.columns.iter().position(|column| column == name)?;
        Some(self.rows.iter().map(|row| row[column]).collect())
    }
}

/// The first line.
fn header(columns: &[&str]) -> Result<String, SeriesProblem> {
    check_names(columns)?;
    Ok(columns.join(",") + "\n")
}

fn check_names(columns: &[&str]) -> Result<(), SeriesProblem> {
    let first = columns.first().copied().unwrap_or_default();
    if ![TIME, ITERATION].contains(&first) {
        let found = first.to_owned();
        return Err(SeriesProblem::NoTime { found });
    }
    for (at, &name) in columns.iter().enumerate() {
        let splits = |c: char| c == ',' || c == '"' || c.is_control();
        let named = || name.to_owned();
        if name.is_empty() || name.trim() != name || name.contains(splits) {
            return Err(SeriesProblem::Name { name: named() });
        }
        if columns[..at].contains(&name) {
            return Err(SeriesProblem::RepeatedName { name: named() });
        }
    }
    Ok(())
}

/// The numbers of a row.
fn numbers(row: &str, line: u64, columns: &[&str]) -> Result<Vec<f64>, SeriesProblem> {
    let found = row.split(',').count();
    if found != columns.len() {
        return Err(SeriesProblem::WrongLength {
            line,
            found,
            columns: columns.len(),
        });
    }
    let number = |(cell, column): (&str, &&str)| {
        cell.parse().map_err(|_| SeriesProblem::NotANumber {
            line,
            column: (*column).to_owned(),
            found: cell.to_owned(),
        })
    };
    row.split(',').zip(columns).map(number).collect()
}

/// The complete lines of a file.
struct Lines {
    file: BufReader<File>,
    line: Vec<u8>,
    /// Number of lines read so far.
    count: u64,
    /// Their length in bytes.
    length: u64,
}

impl Lines {
    /// Maximal length of a line, far above that of rows: a file without line breaks is not read
    /// completely.
    const LONGEST: u64 = 1 << 20;

    fn open(path: &Path) -> io::Result<Self> {
        Ok(Self {
            file: BufReader::new(File::open(path)?),
            line: Vec::new(),
            count: 0,
            length: 0,
        })
    }

    /// The next line without its end; none if there is no further one that has an end.
    fn next(&mut self) -> Result<Option<&str>, SeriesProblem> {
        self.line.clear();
        let mut limited = self.file.by_ref().take(Self::LONGEST);
        let read = limited.read_until(b'\n', &mut self.line)? as u64;
        let line = self.count + 1;
        if self.line.pop_if(|last| *last == b'\n').is_none() {
            return match read {
                Self::LONGEST => Err(SeriesProblem::NotARow { line }),
                _ => Ok(None),
            };
        }
        self.count = line;
        self.length += read;
        match str::from_utf8(&self.line) {
            Ok(text) => Ok(Some(text)),
            Err(_) => Err(SeriesProblem::NotARow { line }),
        }
    }
}

/// A cell of a CSV file, on one line.
#[doc(hidden)]
pub fn quoted(text: &str) -> String {
    let line = text.replace(['\n', '\r'], " ");
    if line.contains([',', '"']) {
        format!("\"{}\"", line.replace('"', "\"\""))
    } else {
        line
    }
}
