//! Batches: blocks of queries over threads, outside of the lock of the interpreter.
//!
//! Every block of [`BLOCK`] queries begins with a fresh state, so that the answers do not depend on
//! the number of threads, bit for bit. Where each answer is a function of its query alone, blocks may
//! have other sizes.

use std::iter::Enumerate;
use std::ops::Range;
use std::slice::ChunksMut;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::errors::refused;

/// Queries that share a state.
pub(crate) const BLOCK: usize = 1024;

/// Maximum number of queries between two readings of the clock.
const CLOCK_STRIDE: usize = 64;

/// Time between two checks for signals and progress.
pub(crate) const BREATH: Duration = Duration::from_millis(50);

/// How a batch is answered: the state that a block begins with, and the answers of a few queries
/// from the index given on.
pub(crate) trait Batch: Sync {
    /// What a block keeps from query to query.
    type State: Send;
    /// The answer of a query.
    type Row: Send;
    /// Number of queries between two readings of the clock.
    const CLOCK_STRIDE: usize = CLOCK_STRIDE;

    /// Number of queries that share a state, of so many on so many threads.
    fn block(&self, _count: usize, _threads: usize) -> usize {
        BLOCK
    }

    fn start(&self) -> PyResult<Self::State>;
    fn answer(&self, state: &mut Self::State, first: usize, rows: &mut [Self::Row]) -> PyResult<()>;
}

/// The number of threads, and whom to tell about progress.
pub(crate) struct Run<'py> {
    threads: usize,
    progress: Option<Bound<'py, PyAny>>,
}

impl<'py> Run<'py> {
    /// Returns the run of a batch of `count` queries. `progress` is a callable with the arguments
    /// done and total, or `True` for a bar of tqdm.
    pub(crate) fn new(
        py: Python<'py>,
        count: usize,
        threads: usize,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        if threads == 0 {
            return Err(refused("threads is 0 (expected at least 1)"));
        }
        Ok(Self {
            threads: threads.min(count.div_ceil(BLOCK)).max(1),
            progress: reporter(py, count, progress)?,
        })
    }

    /// Reports how much of a call is done.
    pub(crate) fn report(&self, done: usize, total: usize) -> PyResult<()> {
        if let Some(report) = &self.progress {
            report.call1((done, total))?;
        }
        Ok(())
    }

    /// Answers all queries of a batch.
    pub(crate) fn rows<B: Batch>(&self, py: Python<'_>, batch: &B, rows: &mut [B::Row]) -> PyResult<()> {
        let total = rows.len();
        let block = batch.block(total, self.threads).max(1);
        let queue = Queue {
            batch,
            block,
            blocks: Mutex::new(rows.chunks_mut(block).enumerate()),
            done: AtomicUsize::new(0),
        };
        let mut jobs: Vec<Option<Job<B>>> = (0..self.threads).map(|_| None).collect();
        loop {
            let until = Instant::now() + BREATH;
            let is_finished = py.detach(|| queue.breath(&mut jobs, until))?;
            py.check_signals()?;
            self.report(queue.done.load(Ordering::Relaxed), total)?;
            if is_finished {
                return Ok(());
            }
        }
    }

    /// Takes steps one after another, until one returns false.
    pub(crate) fn steps(
        &self,
        py: Python<'_>,
        total: usize,
        mut step: impl FnMut(usize) -> PyResult<bool> + Send,
    ) -> PyResult<()> {
        let (mut done, mut goes_on) = (0, true);
        while goes_on && done < total {
            let until = Instant::now() + BREATH;
            py.detach(|| -> PyResult<()> {
                while goes_on && done < total {
                    goes_on = step(done)?;
                    done += 1;
                    if Instant::now() >= until {
                        break;
                    }
                }
                Ok(())
            })?;
            py.check_signals()?;
            self.report(done, total)?;
        }
        Ok(())
    }

    /// Answers parts of a batch one after another, each by a function that uses all threads.
    pub(crate) fn parts<T: Send>(
        &self,
        py: Python<'_>,
        total: usize,
        size: usize,
        answer: impl Fn(Range<usize>) -> PyResult<T> + Sync,
    ) -> PyResult<Vec<T>> {
        let mut all = Vec::new();
        for first in (0..total).step_by(size.max(1)) {
            let part = first..total.min(first.saturating_add(size));
            let end = part.end;
            all.push(py.detach(|| answer(part))?);
            py.check_signals()?;
            self.report(end, total)?;
        }
        Ok(all)
    }
}

/// Returns the callable of a caller with the arguments done and total; that of a bar of tqdm for
/// `True`.
pub(crate) fn reporter<'py>(
    py: Python<'py>,
    count: usize,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let Some(progress) = progress else { return Ok(None) };
    let found = py
        .import("lin_canny._progress")?
        .call_method1("reporter", (progress, count))?;
    Ok(Some(found).filter(|report| !report.is_none()))
}

/// A block in work: its state, and the rows that are left.
struct Job<'a, B: Batch> {
    state: B::State,
    first: usize,
    rows: &'a mut [B::Row],
}

/// The blocks that no thread has taken.
struct Queue<'a, 'b, B: Batch> {
    batch: &'b B,
    block: usize,
    blocks: Mutex<Enumerate<ChunksMut<'a, B::Row>>>,
    done: AtomicUsize,
}

impl<'a, B: Batch> Queue<'a, '_, B> {
    /// Works on all jobs until the time given; returns whether all blocks are done.
    fn breath(&self, jobs: &mut [Option<Job<'a, B>>], until: Instant) -> PyResult<bool> {
        if let [job] = jobs {
            return self.work(job, until);
        }
        let jobs: Vec<Mutex<&mut Option<Job<'a, B>>>> = jobs.iter_mut().map(Mutex::new).collect();
        let work = |job: &Mutex<&mut Option<Job<'a, B>>>| {
            let mut job = job.lock().unwrap_or_else(PoisonError::into_inner);
            self.work(&mut job, until)
        };
        std::thread::scope(|scope| {
            let spawn = |job| {
                let thread = std::thread::Builder::new().spawn_scoped(scope, move || work(job));
                thread.map_err(|_| job)
            };
            let threads: Vec<_> = jobs.iter().map(spawn).collect();
            let mut is_finished = true;
            for thread in threads {
                is_finished &= match thread {
                    Ok(thread) => {
                        let ended = thread.join();
                        ended.map_err(|_| PyRuntimeError::new_err("a thread of the batch panicked"))??
                    }
                    // The system has no thread left: this one does the work.
                    Err(job) => work(job)?,
                };
            }
            Ok(is_finished)
        })
    }

    fn work(&self, job: &mut Option<Job<'a, B>>, until: Instant) -> PyResult<bool> {
        loop {
            let mut current = match job.take() {
                Some(current) => current,
                None => match self.next()? {
                    Some(current) => current,
                    None => return Ok(true),
                },
            };
            let count = B::CLOCK_STRIDE.min(current.rows.len());
            let (now, later) = std::mem::take(&mut current.rows).split_at_mut(count);
            self.batch.answer(&mut current.state, current.first, now)?;
            self.done.fetch_add(count, Ordering::Relaxed);
            if !later.is_empty() {
                (current.first, current.rows) = (current.first + count, later);
                *job = Some(current);
            }
            if Instant::now() >= until {
                return Ok(false);
            }
        }
    }

    fn next(&self) -> PyResult<Option<Job<'a, B>>> {
        let block = self.blocks.lock().unwrap_or_else(PoisonError::into_inner).next();
        block
            .map(|(k, rows)| {
                Ok(Job {
                    state: self.batch.start()?,
                    first: k * self.block,
                    rows,
                })
            })
            .transpose()
    }
}
