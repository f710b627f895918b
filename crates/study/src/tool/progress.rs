//! Progress bars on stderr, visible on a terminal only.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lin_canny_cli::output::progress;
use lin_canny_study::{RunProgress, Study};

/// Returns a spinner for work of unknown length.
pub(super) fn wait(what: &'static str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    bar.enable_steady_tick(TICK);
    match ProgressStyle::with_template("{spinner} {prefix} {elapsed}") {
        Ok(style) => bar.with_style(style).with_prefix(what),
        Err(_) => bar,
    }
}

const TICK: Duration = Duration::from_millis(200);

/// Shows the progress of a run until it ends.
pub(super) async fn shown<T>(
    what: &'static str,
    study: &Arc<Study>,
    counts: &RunProgress,
    run: impl Future<Output = T>,
) -> T {
    let (bar, before) = (progress(what, 0), study.rows());
    let mut run = std::pin::pin!(run);
    let mut tick = tokio::time::interval(TICK);
    loop {
        tokio::select! {
            ended = &mut run => {
                bar.finish_and_clear();
                return ended;
            }
            _ = tick.tick() => {
                bar.set_length(counts.total.load(Ordering::Relaxed));
                let known = counts.known.load(Ordering::Relaxed);
                bar.set_position(known + study.rows() - before);
            }
        }
    }
}
