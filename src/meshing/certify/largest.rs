//! Branch and bound: the largest distance over a surface that comes in pieces.
//!
//! The distance to a set changes by at most the way one moves. So a piece with centre `c` and radius
//! `ρ` holds no point farther than `d(c) + ρ`. Pieces that could exceed the largest distance found so
//! far, `h`, by more than a slack are cut, the others dropped. What is left in the end: a distance `h`
//! reached at a sample, and the certainty that no point exceeds it by more than the slack. A piece too
//! small to cut leaves what its bound, `d(c) + ρ`, is above `h` in the end, whether it gave a sample or not.
//!
//! The first levels are searched in breadth, which soon finds most of `h`, the rest in depth, where
//! neighbouring pieces follow each other, share hints and need no memory.

use crate::error::BuildError;

/// Distances below this (longest side 1) have the slack of this one: nobody needs them closer.
const SMALL: f64 = 2e-3;

/// Share of its budget by which a search may be ahead of the part of the surface that is done, since large errors lie
/// close together. Beyond it the slack grows, until the rest catches up; surfaces with the same error everywhere, from
/// which no piece stands out, would otherwise take far more than the budget.
const AHEAD: f64 = 0.5;

/// Share of the budget with each of which, beyond [`AHEAD`], the slack doubles.
const STEP: f64 = 0.125;

/// Pieces smaller than this (longest side 1) are not cut, whatever they may hide.
const FINEST: f64 = 1e-4;

/// Levels of more pieces than this are searched in depth.
const WIDE: usize = 8_192;

/// Share to within which the largest distances are made certain after the search, by searching the pieces that gave
/// them.
const POLISH: f64 = 0.02;

/// Largest number of pieces examined for that.
const POLISH_BUDGET: usize = 4_000;

/// Largest number of pieces with large distances that are searched again for that.
const LEADERS: usize = 32;

/// Share of the largest distance found so far that a piece has to exceed to be searched again.
const LEADING: f64 = 0.8;

/// Pieces between two reports of progress: where a fit is far off, each may take ten milliseconds.
const TICK: usize = 16;

/// Distance at the centre of a piece, as far as it tells something.
pub enum Look {
    /// Nothing in the piece can matter.
    Settled,
    /// Distance of the centre to the other surface, reached by a sample there.
    Distance(f64),
    /// A sample near it has the first distance; its own is at most the second.
    Near(f64, f64),
    /// The centre gives no sample of its own, but other points of the piece may; its own distance is at most this.
    Hidden(f64),
}

/// A surface in pieces, to find the largest distance over.
pub trait DividedSurface {
    /// A piece of it.
    type Piece: Copy;
    /// Distance from a piece's centre to its farthest point.
    fn radius(&self, piece: &Self::Piece) -> f64;
    /// Examines the centre of a piece of radius `rho`: `best` is the largest distance so far, and a
    /// distance up to `allowed` at the centre settles the piece.
    fn look(&mut self, piece: &Self::Piece, rho: f64, best: f64, allowed: f64) -> Look;
    /// What the last look cost beyond the usual, in usual looks.
    fn extra_work(&self) -> f64 {
        0.0
    }
    /// Cuts a piece into smaller ones.
    fn cut(&self, piece: Self::Piece, pieces: &mut Vec<Self::Piece>);
}

/// How closely to look.
#[derive(Clone, Copy)]
pub struct Effort {
    /// Slack as a share of the largest distance.
    pub slack: f64,
    /// Share of the budget that it may take.
    pub share: f64,
    /// Once a larger distance is found the search ends.
    pub enough: f64,
}

impl Effort {
    /// Effort for what a build returns: a slack of a quarter of the distance.
    pub const FINE: Self = Self {
        slack: 0.25,
        share: 1.0,
        enough: f64::INFINITY,
    };

    /// Effort for what a quick build returns: twice that slack, which takes half of the pieces.
    pub const COARSE: Self = Self {
        slack: 0.5,
        ..Self::FINE
    };

    /// Effort for what is known to be right also between the points measured: a quarter of the budget.
    pub const CHECK: Self = Self {
        share: 0.25,
        ..Self::FINE
    };

    /// Effort for what a build reports besides its result: four times that slack, and half of the budget.
    pub const REPORT: Self = Self {
        slack: 1.0,
        share: 0.5,
        enough: f64::INFINITY,
    };
}

/// A search for the largest distance.
pub struct LargestDistance<'a, S: DividedSurface> {
    side: &'a mut S,
    /// The largest distance found.
    pub best: f64,
    /// Distances up to this do not matter.
    floor: f64,
    effort: Effort,
    /// Pieces that gave large distances.
    leaders: Vec<(f64, S::Piece)>,
    /// Bound of the distances in the pieces that were too small to cut.
    given_up: f64,
    /// Pieces to examine, those examined, what that cost in usual pieces, and the share of the surface that is done.
    budget: f64,
    examined: usize,
    spent: f64,
    done: f64,
    /// Largest slack with which a piece was dropped.
    widest: f64,
}

impl<'a, S: DividedSurface> LargestDistance<'a, S> {
    /// A search for distances above `floor`, with the distance `start` found before, over about
    /// the effort's share of `budget` pieces.
    pub fn new(side: &'a mut S, start: f64, floor: f64, effort: Effort, budget: f64) -> Self {
        Self {
            side,
            best: start,
            floor,
            effort,
            leaders: Vec::new(),
            given_up: 0.0,
            budget: budget * effort.share,
            examined: 0,
            spent: 0.0,
            done: 0.0,
            widest: 0.0,
        }
    }

    /// Length by which a distance may exceed the best and the floor, unless the search ended early.
    pub fn slack(&self) -> f64 {
        self.widest.max(self.given_up - self.high())
    }

    /// What was spent of the budget so far.
    pub fn spent(&self) -> f64 {
        self.spent
    }

    /// Distance that must be exceeded to matter.
    fn high(&self) -> f64 {
        self.best.max(self.floor)
    }

    fn slack_now(&self) -> f64 {
        let ahead = self.spent / self.budget - self.done - AHEAD;
        let slack = self.effort.slack * self.high().max(SMALL);
        match (ahead / STEP).ceil() {
            doubled if doubled > 0.0 => slack * doubled.min(32.0).exp2(),
            _ => slack,
        }
    }

    /// Cuts pieces level by level, until none is left or there are many, which are returned.
    pub fn in_breadth(
        &mut self,
        mut level: Vec<S::Piece>,
        mut tick: impl FnMut(f64) -> Result<(), BuildError>,
    ) -> Result<Vec<S::Piece>, BuildError> {
        while !level.is_empty() && level.len() <= WIDE && self.best <= self.effort.enough {
            let mut next = Vec::new();
            for (i, piece) in level.into_iter().enumerate() {
                if i % TICK == 0 {
                    tick(0.0)?;
                }
                self.examine(piece, self.slack_now(), &mut next);
            }
            level = next;
        }
        Ok(level)
    }

    /// Settles piece after piece, and then looks closer at those that gave the most.
    pub fn in_depth(
        &mut self,
        pieces: impl Iterator<Item = S::Piece> + Clone,
        mut tick: impl FnMut(f64) -> Result<(), BuildError>,
    ) -> Result<(), BuildError> {
        let size = |side: &S, piece: &S::Piece| side.radius(piece).powi(2);
        let whole: f64 = pieces.clone().map(|piece| size(self.side, &piece)).sum();
        let mut done = 0.0;
        let mut waiting = Vec::new();
        for piece in pieces {
            self.done = done / whole.max(f64::MIN_POSITIVE);
            done += size(self.side, &piece);
            waiting.push(piece);
            while let Some(piece) = waiting.pop() {
                if self.best > self.effort.enough {
                    return Ok(());
                }
                if self.examined.is_multiple_of(TICK) {
                    tick(self.done)?;
                }
                self.examine(piece, self.slack_now(), &mut waiting);
            }
        }
        self.keep_leaders();
        waiting.extend(self.leaders.iter().rev().map(|leader| leader.1));
        for i in 0..POLISH_BUDGET {
            let Some(piece) = waiting.pop() else { break };
            if i % TICK == 0 {
                tick(1.0)?;
            }
            let slack = (1.0 + POLISH) * self.best - self.high();
            self.examine(piece, slack, &mut waiting);
        }
        Ok(())
    }

    /// Keeps the pieces of the largest distances, those first.
    fn keep_leaders(&mut self) {
        // A stable sort: ties stay in the order of the search.
        self.leaders.sort_by(|x, y| y.0.total_cmp(&x.0));
        self.leaders.truncate(LEADERS);
    }

    /// Looks at a piece; cuts it unless it can be dropped.
    fn examine(&mut self, piece: S::Piece, slack: f64, pieces: &mut Vec<S::Piece>) {
        self.examined += 1;
        self.widest = self.widest.max(slack);
        let rho = self.side.radius(&piece);
        let allowed = self.high() + slack - rho;
        let look = self.side.look(&piece, rho, self.best, allowed);
        self.spent += 1.0 + self.side.extra_work();
        let (sample, bound) = match look {
            Look::Settled => return,
            Look::Hidden(bound) => (0.0, bound),
            Look::Distance(d) => (d, d),
            Look::Near(sample, bound) => (sample, bound),
        };
        if sample > self.best {
            self.best = sample;
        }
        if sample > LEADING * self.best {
            self.leaders.push((sample, piece));
            if self.leaders.len() > 8 * LEADERS {
                self.keep_leaders();
            }
        }
        if bound <= self.high() + slack - rho {
            return;
        }
        if rho > FINEST {
            self.side.cut(piece, pieces);
        } else {
            self.given_up = self.given_up.max(bound + rho);
        }
    }
}
