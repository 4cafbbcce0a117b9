//! Exit codes, messages and output files of the repository's programs.

mod progress_bar;

pub use progress_bar::ProgressBar;

use helfrich_std::execute::{Interruption, interruptible, look_for_interruption};
use helfrich_std::io::{check_replaceable, is_same_file, replace_file};
#[cfg(unix)]
use signal_hook::consts::SIGHUP;
use signal_hook::consts::{SIGINT, SIGTERM};
use std::error::Error;
use std::ffi::c_int;
use std::fmt::Display;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::{self, ExitCode};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread;
use std::time::Duration;

/// The reason why a program ends early.
#[derive(Debug)]
pub enum Failure {
    /// Exit code 2.
    Input(Box<dyn Error>),
    /// Exit code 3.
    Output(String),
    /// A run that ended early and has printed the reason; its exit code.
    Unfinished(u8),
}

impl Failure {
    /// The arguments or an input file are invalid.
    pub fn input(error: impl Error + 'static) -> Self {
        Self::Input(Box::new(error))
    }

    /// A mesh file is invalid.
    pub fn mesh(path: &Path, error: impl Display) -> Self {
        Self::Input(format!("{}: {error}", path.display()).into())
    }

    /// An output could not be written.
    pub fn output(target: impl Display, error: &io::Error) -> Self {
        Self::Output(format!("{target}: {error}"))
    }
}

/// The exit code of a program; prints the reason if it ended early.
pub fn ended(result: Result<(), Failure>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Unfinished(code)) => ExitCode::from(code),
        Err(Failure::Input(error)) => {
            say(format_args!("error: {error}"));
            ExitCode::from(2)
        }
        Err(Failure::Output(message)) => {
            say(format_args!("error: {message}"));
            ExitCode::from(3)
        }
    }
}

/// Writes a line to standard error. Errors are ignored, because the exit code still reports the
/// result; `eprintln!` would panic if standard error is closed.
pub fn say(line: impl Display) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Writes to standard output; a closed pipe is not an error.
///
/// # Errors
/// If standard output cannot be written to.
pub fn print(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    let mut out = BufWriter::new(Interruptible(&mut out));
    match write(&mut out).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::output("standard output", &error))
        }
        _ => Ok(()),
    }
}

/// Writes a file completely or not at all.
///
/// # Errors
/// If the file cannot be written.
pub fn save(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Failure> {
    let written = replace_file(path, |out| {
        let mut out = BufWriter::new(Interruptible(out));
        write(&mut out)?;
        out.flush()
    });
    written.map_err(|error| Failure::output(path.display(), &error))
}

/// The file that an option names; none for `-`, standard output.
pub fn file_named(option: Option<&PathBuf>) -> Option<&Path> {
    let path = option.filter(|path| path.as_os_str() != "-")?;
    Some(path)
}

/// Checks before the work starts that outputs can be written, each to a file of its own.
///
/// # Errors
/// If an output cannot be written, or two have the same name.
pub fn check_outputs<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    let paths = Vec::from_iter(paths);
    for (at, path) in paths.iter().enumerate() {
        if paths[..at].iter().any(|other| is_same_file(other, path)) {
            let message = format!("{}: two outputs have this name", path.display());
            return Err(Failure::Input(message.into()));
        }
        check_replaceable(path).map_err(|error| Failure::output(path.display(), &error))?;
    }
    Ok(())
}

/// Becomes true when the program is asked to stop. A second request ends the program at once: what is on the
/// disk is complete.
///
/// No thread waits for signals: what one allocates would count as memory of the method that a study
/// measures at that time.
pub fn interruption() -> Arc<AtomicBool> {
    static STOP: OnceLock<Arc<AtomicBool>> = OnceLock::new();
    let registered = || {
        let stop = Arc::new(AtomicBool::new(false));
        for &signal in SIGNALS {
            // Without a handler an interrupt ends the run at once: the last checkpoint remains. The flag is set
            // by the second of these handlers, so that the first acts on a second signal.
            let _ = signal_hook::flag::register_conditional_default(signal, Arc::clone(&stop));
            let _ = signal_hook::flag::register(signal, Arc::clone(&stop));
        }
        stop
    };
    Arc::clone(STOP.get_or_init(registered))
}

/// Time that work has to end by itself when the program is asked to stop. Some steps on large meshes, such as
/// the search for a cache-friendly order, do not look for the request, and would take longer.
const GRACE: Duration = Duration::from_millis(700);

/// Does work that ends within a second after the program is asked to stop.
///
/// # Errors
/// The messages of the work, and that it was interrupted.
pub fn until_stopped<R>(work: impl FnOnce() -> Result<R, Failure>) -> Result<R, Failure> {
    let stop = interruption();
    // If no thread can be started, the end may take longer.
    let _ = thread::Builder::new().spawn(move || {
        while !stop.load(Ordering::Relaxed) {
            thread::sleep(GRACE / 10);
        }
        thread::sleep(GRACE);
        process::exit(130);
    });
    interruptible(Interruption::by_flag(interruption()), work)
        .unwrap_or(Err(Failure::Unfinished(130)))
}

/// Output that looks for an interruption each time it is written to.
struct Interruptible<'a>(&'a mut dyn Write);

impl Write for Interruptible<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        look_for_interruption();
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// The signals that ask a program to stop: from the keyboard, from other programs, and from a terminal
/// that is closed.
#[cfg(unix)]
const SIGNALS: &[c_int] = &[SIGINT, SIGTERM, SIGHUP];
#[cfg(not(unix))]
const SIGNALS: &[c_int] = &[SIGINT, SIGTERM];
