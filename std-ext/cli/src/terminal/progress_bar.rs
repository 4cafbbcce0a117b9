//! A progress bar for long commands.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

/// Number of characters of the bar.
const BAR: usize = 30;
/// Number of characters of a line, narrow enough for common terminals.
const LINE: usize = 79;
/// The shortest time between two updates of the bar.
const EVERY: Duration = Duration::from_millis(100);

/// A progress bar on standard error; it does nothing if that is not a terminal.
#[derive(Debug)]
pub struct ProgressBar {
    started: Instant,
    drawn: Option<Instant>,
    visible: bool,
}

impl Default for ProgressBar {
    fn default() -> Self {
        Self {
            started: Instant::now(),
            drawn: None,
            visible: io::stderr().is_terminal(),
        }
    }
}

impl ProgressBar {
    /// Shows the fraction of the work that is done, from 0 to 1, and a message.
    pub fn show(&mut self, fraction: f64, message: &str) {
        let soon = self.drawn.is_some_and(|drawn| drawn.elapsed() < EVERY);
        if !self.visible || soon {
            return;
        }
        self.drawn = Some(Instant::now());
        let line = line(fraction, self.started.elapsed(), message);
        self.write(&line);
    }

    /// Removes the bar.
    pub fn clear(&mut self) {
        if self.drawn.take().is_some() {
            self.write("");
        }
    }

    /// Replaces the line. Errors are ignored, because the bar is not essential.
    fn write(&self, line: &str) {
        let mut out = io::stderr().lock();
        let _ = write!(out, "\r\x1b[2K{line}").and_then(|()| out.flush());
    }
}

impl Drop for ProgressBar {
    fn drop(&mut self) {
        self.clear();
    }
}

/// The line: bar, percentage, elapsed and remaining time, message.
fn line(fraction: f64, elapsed: Duration, message: &str) -> String {
    let fraction = fraction.clamp(0.0, 1.0);
    let full = (fraction * BAR as f64) as usize;
    let bar = "█".repeat(full) + &"░".repeat(BAR - full);
    let remaining = if fraction > 0.0 {
        let seconds = elapsed.as_secs_f64() * (1.0 / fraction - 1.0);
        clock(seconds as u64)
    } else {
        "–".to_owned()
    };
    let percent = (100.0 * fraction) as u32;
    let line = format!(
        "{bar} {percent:>3} %  {}, {remaining} left  {message}",
        clock(elapsed.as_secs())
    );
    line.chars()
        .map(|character| {
            if character.is_control() {
                ' '
            } else {
                character
            }
        })
        .take(LINE)
        .collect()
}

/// Hours, minutes and seconds.
fn clock(seconds: u64) -> String {
    let (hours, minutes, seconds) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    format!("{hours:02}:{minutes:02}:{seconds:02}")
}

#[cfg(test)]
mod tests {
    use super::line;
    use std::time::Duration;

    #[test]
    fn the_remaining_time_is_said_to_be_left() {
        let line = line(0.25, Duration::from_secs(60), "load 1");
        assert!(
            line.contains(" 25 %  00:01:00, 00:03:00 left  load 1"),
            "{line}"
        );
    }
}
