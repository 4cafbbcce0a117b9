//! Plots of series, with several computed curves and published ones.
//!
//! Published curves are read from CSV files with the header `curve,x,y` and one line per point.
//! Empty lines and lines that begin with `#` are skipped. Names with commas must be in quotation
//! marks, which are doubled inside names. All points with the same name form one curve.

use crate::io::without_mark;
use crate::picture::{Axis, Canvas, Chart, Curve, Marks, PictureError, Point};
use crate::scene::shipped_file;
pub use crate::scene::unit_of;
use crate::series::SeriesTable;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// The head of a file of published curves.
pub const CURVES_HEAD: &str = "curve,x,y";

/// The name of hollow marks.
pub const UNRESOLVED: &str = "hollow: unresolved";

/// The longest file of published curves, in bytes.
const LONGEST: u64 = 1 << 24;

/// A published curve.
#[derive(Clone, Debug, PartialEq)]
pub struct PublishedCurve {
    /// Its name.
    pub name: String,
    /// Its points, in the order of the file; all of them finite.
    pub points: Vec<[f64; 2]>,
}

/// The reason why a file of published curves cannot be read. The message is one line that starts
/// with the name of the file.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct CurvesError {
    /// The file.
    pub path: PathBuf,
    /// The problem.
    pub problem: CurvesProblem,
}

/// Problems of a file of published curves. A file without the head is not quoted, because the scene of somebody
/// else may name any.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CurvesProblem {
    /// The operating system refused to read the file.
    #[error("cannot be read: {0}")]
    Unreadable(io::Error),
    /// The file is too long.
    #[error("is longer than {LONGEST} bytes: published curves have some hundred points")]
    TooLong,
    /// The bytes are not valid text.
    #[error("line {line}: is not UTF-8 text")]
    NoText {
        /// The line, from 1.
        line: usize,
    },
    /// The first line is not the head.
    #[error("line {line}: the head has to be `{CURVES_HEAD}`")]
    Head {
        /// The line, from 1.
        line: usize,
    },
    /// The file has no points.
    #[error("there is no curve: a head `{CURVES_HEAD}` and at least one point are needed")]
    Empty,
    /// A line has more or fewer than three fields.
    #[error(
        "line {line}: {found} fields: three are needed, `{CURVES_HEAD}`, a name with commas in \
         quotation marks"
    )]
    Fields {
        /// The line, from 1.
        line: usize,
        /// Number of fields.
        found: usize,
    },
    /// A quotation mark is not closed, or something follows it.
    #[error(
        "line {line}: a name begins with a quotation mark that does not end it before the comma"
    )]
    Quotation {
        /// The line, from 1.
        line: usize,
    },
    /// A curve has no name.
    #[error("line {line}: the curve has no name")]
    NoName {
        /// The line, from 1.
        line: usize,
    },
    /// A coordinate is not a finite number.
    #[error("line {line}, {axis}: expected a finite number, found `{found}`")]
    NotANumber {
        /// The line, from 1.
        line: usize,
        /// `x` or `y`.
        axis: &'static str,
        /// The content found.
        found: String,
    },
}

/// Reads a file of published curves, in the order in which their names first appear.
///
/// # Errors
/// If the file cannot be read or holds no curves; see [`CurvesProblem`].
pub fn read_curves(path: &Path) -> Result<Vec<PublishedCurve>, CurvesError> {
    let read = || {
        if let Some(shipped) = shipped_file(path) {
            return parsed(shipped);
        }
        let mut bytes = Vec::new();
        let file = File::open(path).map_err(CurvesProblem::Unreadable)?;
        let read = file.take(LONGEST + 1).read_to_end(&mut bytes);
        if read.map_err(CurvesProblem::Unreadable)? as u64 > LONGEST {
            return Err(CurvesProblem::TooLong);
        }
        parsed(&bytes)
    };
    read().map_err(|problem| CurvesError {
        path: path.to_owned(),
        problem,
    })
}

/// Parses the content of such a file.
///
/// # Errors
/// If there are no curves; see [`CurvesProblem`].
pub fn parsed(bytes: &[u8]) -> Result<Vec<PublishedCurve>, CurvesProblem> {
    let bytes = without_mark(bytes);
    let mut curves: Vec<PublishedCurve> = Vec::new();
    let mut has_head = false;
    for (number, bytes) in bytes.split(|&byte| byte == b'\n').enumerate() {
        let line = number + 1;
        let text = str::from_utf8(bytes).map_err(|_| CurvesProblem::NoText { line })?;
        let text = text.trim();
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        if !has_head {
            let fields = Vec::from_iter(text.split(',').map(str::trim));
            if fields.join(",") != CURVES_HEAD {
                return Err(CurvesProblem::Head { line });
            }
            has_head = true;
            continue;
        }
        let (name, point) = point(text, line)?;
        match curves.iter_mut().find(|curve| curve.name == name) {
            Some(curve) => curve.points.push(point),
            None => curves.push(PublishedCurve {
                name,
                points: vec![point],
            }),
        }
    }
    if curves.is_empty() {
        return Err(CurvesProblem::Empty);
    }
    Ok(curves)
}

/// The name and the point of a line.
fn point(text: &str, line: usize) -> Result<(String, [f64; 2]), CurvesProblem> {
    let (name, rest) = match text.strip_prefix('"') {
        Some(quoted) => {
            let quotation = || CurvesProblem::Quotation { line };
            let mut name = String::new();
            let mut left = quoted;
            loop {
                let (part, after) = left.split_once('"').ok_or_else(quotation)?;
                name.push_str(part);
                left = after;
                match after.strip_prefix('"') {
                    Some(after) => {
                        name.push('"');
                        left = after;
                    }
                    None => break,
                }
            }
            let after = left.trim_start();
            let rest = after.strip_prefix(',');
            if rest.is_none() && !after.is_empty() {
                return Err(quotation());
            }
            (name, rest)
        }
        None => match text.split_once(',') {
            Some((name, rest)) => (name.to_owned(), Some(rest)),
            None => (text.to_owned(), None),
        },
    };
    let numbers = rest.map_or(Vec::new(), |rest| rest.split(',').collect());
    let &[x, y] = numbers.as_slice() else {
        let found = 1 + numbers.len();
        return Err(CurvesProblem::Fields { line, found });
    };
    let name = name.trim().to_owned();
    if name.is_empty() {
        return Err(CurvesProblem::NoName { line });
    }
    let number = |axis, text: &str| match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(CurvesProblem::NotANumber {
            line,
            axis,
            found: text.trim().to_owned(),
        }),
    };
    Ok((name, [number("x", x)?, number("y", y)?]))
}

/// Columns of series over other columns, beside published curves.
#[derive(Clone, Debug)]
pub struct SeriesPlot<'a> {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The title; none if it is empty.
    pub title: &'a str,
    /// Name and unit of the horizontal axis, and of the vertical axis.
    pub labels: [&'a str; 2],
    /// Computed curves, drawn as lines.
    pub curves: &'a [SeriesCurve<'a>],
    /// Whether their points have marks.
    pub marked: bool,
    /// Further points of computed curves, by the number of the curve, which are drawn as hollow marks
    /// with [`UNRESOLVED`] in the legend.
    pub hollow: &'a [(usize, Vec<[f64; 2]>)],
    /// Published curves, drawn as marks joined by dashed lines; a single point is a mark.
    pub published: &'a [PublishedCurve],
}

/// A curve of a [`SeriesPlot`].
#[derive(Clone, Copy, Debug)]
pub struct SeriesCurve<'a> {
    /// Its name in the legend; an empty name leaves it out.
    pub name: &'a str,
    /// The numbers.
    pub table: &'a SeriesTable,
    /// The column on the horizontal axis.
    pub against: &'a str,
    /// The column on the vertical axis.
    pub column: &'a str,
}

/// The reason why series cannot be plotted. The message is one line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlotError {
    /// A series has no such column.
    #[error("there is no column `{column}`: there are {}", known.join(", "))]
    NoColumn {
        /// The column.
        column: String,
        /// The existing columns.
        known: Vec<String>,
    },
    /// The picture cannot be drawn.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

impl SeriesPlot<'_> {
    /// Draws the plot. Rows in which a number is not finite interrupt the line.
    ///
    /// # Errors
    /// If a column is missing, or the size impossible; see [`PlotError`].
    pub fn draw(&self) -> Result<Canvas, PlotError> {
        let points = self.curves.iter().map(SeriesCurve::points);
        let points = points.collect::<Result<Vec<_>, _>>()?;
        // The colours are the same with and without published curves.
        let curve = |name: &str, points: &[[f64; 2]], line, style| Curve {
            hollow: false,
            name: name.to_owned(),
            // Marks make a series of one row visible, too.
            marks: match points {
                [_] => Marks::Points,
                _ => line,
            },
            points: points.iter().copied().map(Point::from).collect(),
            style: Some(style),
            ..Curve::default()
        };
        let line = match self.marked {
            true => Marks::LineAndPoints,
            false => Marks::Line,
        };
        let computed = self.curves.iter().zip(&points).enumerate();
        let computed = computed.map(|(style, (own, points))| curve(own.name, points, line, style));
        let published = self.published.iter().zip(self.curves.len()..);
        let published = published
            .map(|(own, style)| curve(&own.name, &own.points, Marks::DashesAndPoints, style));
        let hollow = self.hollow.iter().enumerate();
        let hollow = hollow.map(|(index, (style, points))| Curve {
            hollow: true,
            ..curve(
                if index == 0 { UNRESOLVED } else { "" },
                points,
                Marks::Points,
                *style,
            )
        });
        let chart = Chart {
            title: self.title.to_owned(),
            axes: self.labels.map(|label| Axis {
                label: label.to_owned(),
                ..Axis::default()
            }),
            // Lines are drawn last, over the marks.
            curves: published.chain(computed).chain(hollow).collect(),
            guides: Vec::new(),
        };
        Ok(chart.draw(self.size)?)
    }
}

impl SeriesCurve<'_> {
    fn points(&self) -> Result<Vec<[f64; 2]>, PlotError> {
        let column = |name: &str| {
            self.table.column(name).ok_or_else(|| PlotError::NoColumn {
                column: name.to_owned(),
                known: self.table.columns.clone(),
            })
        };
        let rows = column(self.against)?.into_iter().zip(column(self.column)?);
        Ok(rows.map(|(x, y)| [x, y]).collect())
    }
}

/// The columns of a series for a name, each with its name in the legend: the column of that name
/// or, if there is none, the columns `NAME_SURFACE` of all surfaces. Empty if there are none.
pub fn columns_of<'a>(
    table: &SeriesTable,
    name: &str,
    surfaces: impl IntoIterator<Item = &'a str>,
) -> Vec<(String, String)> {
    let has = |column: &str| table.columns.iter().any(|known| known == column);
    if has(name) {
        return vec![(name.to_owned(), name.to_owned())];
    }
    let own = surfaces
        .into_iter()
        .map(|surface| (surface.to_owned(), format!("{name}_{surface}")));
    own.filter(|(_, column)| has(column)).collect()
}

/// The label of an axis for a column: its symbol, where a common one exists.
pub fn axis_label(column: &str) -> &str {
    match column {
        "strain" => "γ̇t",
        "deformation" => "D",
        "inclination" => "inclination (degrees)",
        column => column,
    }
}
