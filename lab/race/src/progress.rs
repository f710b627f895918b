//! Progress of a long run, on stderr and only if it is a terminal.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, stderr};

/// A bar that counts up to a length. If stderr is not a terminal, it shows nothing and costs next
/// to nothing.
#[derive(Clone, Debug)]
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Returns a bar for `length` steps of `what`.
    pub fn new(what: &str, length: u64) -> Self {
        let target = if stderr().is_terminal() {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(length), target);
        let style =
            ProgressStyle::with_template("{prefix} {wide_bar} {pos}/{len} {eta} {msg}").expect("a fixed template");
        Self {
            bar: bar.with_style(style).with_prefix(what.to_owned()),
        }
    }

    /// Counts one more step.
    pub fn step(&self) {
        self.bar.inc(1);
    }

    /// Counts `n` more steps.
    pub fn steps(&self, n: u64) {
        self.bar.inc(n);
    }

    /// Shows a word next to the bar.
    pub fn say(&self, word: &str) {
        self.bar.set_message(word.to_owned());
    }

    /// Returns the number of steps done.
    pub fn done(&self) -> u64 {
        self.bar.position()
    }
}

impl Drop for Progress {
    /// Removes the bar, so that later output starts on a clean line.
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hidden_bar_still_counts() {
        let p = Progress::new("cases", 10);
        p.step();
        p.steps(4);
        p.say("rand");
        assert_eq!(p.done(), 5);
    }
}
