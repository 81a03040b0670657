//! Progress, cancellation and the budget of fits: the stages of a build report to one object, which calls the user's
//! callback, times the stages and adds up the memory of their arrays and the work of fits.

use crate::error::BuildError;
use crate::math::Real;
use crate::meshing::options::Progress;
use std::ops::ControlFlow;
use web_time::Instant;

/// The stages of a build and the share of its time that each takes, measured on meshes of 5k to
/// 30k triangles at 500 primitives. Only the progress bar's evenness depends on them.
const STAGES: [(&str, f64); 12] = [
    ("surface", 0.01),
    ("samples", 0.01),
    ("delaunay", 0.04),
    ("inner balls", 0.01),
    ("sheets", 0.01),
    ("simplify", 0.12),
    ("refit", 0.29),
    ("insert", 0.05),
    ("swaps", 0.20),
    ("enclose", 0.05),
    ("measure", 0.20),
    ("mass", 0.01),
];

/// Items between two reports of [`Watch::every`]. A build is to answer a request to stop within 200 ms; items of half a
/// microsecond take less than 10 ms between two reports. More frequent reports would only cost time.
const EVERY: usize = 1 << 14;

/// Share of the remaining progress that an attempt takes: how many attempts there will be is not known.
const ATTEMPT: f64 = 0.25;

/// Nodes and triangles that the searches of all fits of a build may look at: so many, and so many more for each search.
/// The first is five to ten seconds' work. Clean meshes take 5 to 31 for each search, the more the larger the error; a
/// surface of 1,600 random triangles takes 430, since each triangle is as long as the body, and its box holds most of
/// it. Searches for ways out of the solid add to the work, not to the number of searches.
const MOST_FIT_WORK: [u64; 2] = [100_000_000, 32];

/// Bytes of an array, with what it has in reserve.
pub fn bytes_of<T>(array: &Vec<T>) -> usize {
    array.capacity() * size_of::<T>()
}

/// Passes progress to the caller and its wish to stop to the stages.
pub struct Watch<'a> {
    callback: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
    stage: &'static str,
    start: f64,
    share: f64,
    /// Fraction at which the stages of an attempt begin, and the share of all that they have.
    from: f64,
    span: f64,
    /// Never falls, though a stage may be entered more than once.
    fraction: f64,
    since: Instant,
    seconds: Vec<(&'static str, f64)>,
    /// Bytes held to the end, and the most held at any time.
    kept: usize,
    peak: usize,
    /// Searches of fits, and nodes and triangles that they have looked at.
    fit_searches: u64,
    fit_work: u64,
    is_fit_cut: bool,
}

impl<'a> Watch<'a> {
    /// Starts the clock.
    pub fn new(callback: &'a mut dyn FnMut(Progress) -> ControlFlow<()>) -> Self {
        Self {
            callback,
            stage: "",
            start: 0.0,
            share: 0.0,
            from: 0.0,
            span: 1.0,
            fraction: 0.0,
            since: Instant::now(),
            seconds: Vec::new(),
            kept: 0,
            peak: 0,
            fit_searches: 0,
            fit_work: 0,
            is_fit_cut: false,
        }
    }

    /// Says that all stages come again: they share a quarter of what is left.
    pub fn attempt(&mut self) {
        self.from = self.fraction;
        self.span = ATTEMPT * (1.0 - self.fraction);
    }

    /// Ends the running stage and begins `stage`.
    pub fn begin(&mut self, stage: &'static str) -> Result<(), BuildError> {
        self.end();
        self.stage = stage;
        self.start = STAGES
            .iter()
            .take_while(|s| s.0 != stage)
            .map(|s| s.1)
            .sum();
        self.share = STAGES.iter().find(|s| s.0 == stage).map_or(0.0, |s| s.1);
        self.at(0.0)
    }

    /// Reports that `part` of the running stage is done. Stages call it about every millisecond.
    pub fn at(&mut self, part: f64) -> Result<(), BuildError> {
        let done = self.start + self.share * part.clamp(0.0, 1.0);
        let done = self.from + self.span * done;
        self.fraction = self.fraction.max(done.min(1.0));
        let progress = Progress {
            stage: self.stage,
            fraction: self.fraction as Real,
        };
        match (self.callback)(progress) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(BuildError::Cancelled { stage: self.stage }),
        }
    }

    /// Reports again where the build is, so that the caller may stop it.
    pub fn again(&mut self) -> Result<(), BuildError> {
        self.at(0.0)
    }

    /// Reports at each [`EVERY`]th item, so that the caller may stop a long loop over small ones.
    pub fn every(&mut self, item: usize) -> Result<(), BuildError> {
        if item.is_multiple_of(EVERY) {
            self.at(0.0)?;
        }
        Ok(())
    }

    /// Takes down arrays that are held to the end of the build, besides those before.
    pub fn keep(&mut self, bytes: usize) {
        self.kept += bytes;
        self.hold(0);
    }

    /// Takes down what is held for a while, besides what is kept.
    pub fn hold(&mut self, bytes: usize) {
        self.peak = self.peak.max(self.kept + bytes);
    }

    /// Most bytes held at any time.
    pub fn peak(&self) -> usize {
        self.peak
    }

    /// Takes down searches of a fit, and how many nodes and triangles they looked at.
    pub fn count_fit(&mut self, searches: usize, work: u64) {
        self.fit_searches += searches as u64;
        self.fit_work += work;
    }

    /// Whether a fit is to end here, or not to begin, because fits have looked at more than a `share` of what a build
    /// may spend on them. That this happened is kept.
    pub fn ends_fit(&mut self, share: f64) -> bool {
        let [fixed, of_each] = MOST_FIT_WORK;
        let most = (share * fixed as f64) as u64 + of_each * self.fit_searches;
        let ends = self.fit_work > most;
        self.is_fit_cut |= ends;
        ends
    }

    /// Whether a fit ended early, or was left out.
    pub fn is_fit_cut(&self) -> bool {
        self.is_fit_cut
    }

    /// Ends the build: the last report, and the seconds of each stage in order of first entry.
    pub fn finish(mut self) -> Result<Vec<(&'static str, f64)>, BuildError> {
        self.end();
        (self.from, self.span, self.start, self.share) = (0.0, 1.0, 1.0, 0.0);
        self.at(1.0)?;
        Ok(self.seconds)
    }

    fn end(&mut self) {
        let elapsed = self.since.elapsed().as_secs_f64();
        self.since = Instant::now();
        if self.stage.is_empty() {
            return;
        }
        match self.seconds.iter_mut().find(|s| s.0 == self.stage) {
            Some(s) => s.1 += elapsed,
            None => self.seconds.push((self.stage, elapsed)),
        }
    }
}
