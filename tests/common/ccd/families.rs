//! Families of hard queries: bodies, motions and placements drawn on purpose where continuous
//! collision queries are known to fail.
//!
//! Most queries are placed: at a chosen time the first body is moved along the witness normal until
//! the signed distance there is a chosen gap. That is exact: with `n` and `y = |y| n` of the
//! nearest spheres, moving by `δ n` changes both bounds of the distance by `δ`, as long as
//! `|y| + δ ≥ 0`. So hits, misses and grazing are drawn in the proportion wanted.

use super::distance::{Goal, distance};
use super::extremes;
use super::motion::{Ball, Motion, Paths, Query, Rigid};
use super::rng::Rng;
use super::shapes::{self, Spheres};
use nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::TAU;

/// What makes a query hard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// No rotation.
    Translation,
    /// Rotation by 0.01 to 0.3 rad in the step.
    SmallRotation,
    /// Rotation by 0.3 rad to a full turn.
    LargeRotation,
    /// Passing at a distance of 0 (a quarter) or ±1e-7 to ±0.1 sizes, tangentially.
    Grazing,
    /// Touching within ±1e-4 sizes at the start, then separating.
    TouchSeparating,
    /// Touching within ±1e-4 sizes at the start, then approaching.
    TouchApproaching,
    /// Overlapping at the start, half of them with crossing medial surfaces.
    Overlapping,
    /// Thickness and one extent 1e-4 of the length.
    Thin,
    /// One body 1e-4 of the other's size.
    Disparity,
    /// Parallel or collinear axes, some within 1e-7.
    Parallel,
    /// Spheres of a body with the same centre, and bodies concentric when nearest.
    Coincident,
    /// A sphere that contains the others of its body, some touching it from inside.
    Contained,
    /// Zero length, area or radius.
    ZeroSize,
    /// All lengths times 1e-4.
    Tiny,
    /// All lengths times 1e4.
    Huge,
    /// Positions at 1e4 sizes.
    FarAway,
    /// The same motion for both: the paper's degenerate parabola.
    Still,
    /// Crossing 1e3 sizes in the step.
    Fast,
    /// In contact twice in the step, apart in between.
    TwoContacts,
    /// Two copies of a body, and of its motion, within a few units in the last place of `f32`.
    NearEqual,
    /// A step of length zero.
    ZeroStep,
    /// Axes at an angle of 1e-9 to 1e-2, no or hardly any thickness, crossing face to face.
    NearParallel,
    /// Lengths of up to 1e6 radii.
    Needle,
    /// No thickness at all, crossing.
    Wire,
    /// Bodies up to 10 km from their own origin, from the world's, or from both.
    FarOrigin,
    /// Balls of 1e-6 to 1e-2 sizes that cross 1 to 1e4 sizes in the step, half of them straight at the
    /// other body.
    Bullet,
    /// Axes on one line, along which they move, through each other or side by side.
    Coaxial,
    /// One body 10 to 1,000 sizes long and wide.
    Long,
}

impl Family {
    /// Every family.
    pub const ALL: [Self; 21] = [
        Self::Translation,
        Self::SmallRotation,
        Self::LargeRotation,
        Self::Grazing,
        Self::TouchSeparating,
        Self::TouchApproaching,
        Self::Overlapping,
        Self::Thin,
        Self::Disparity,
        Self::Parallel,
        Self::Coincident,
        Self::Contained,
        Self::ZeroSize,
        Self::Tiny,
        Self::Huge,
        Self::FarAway,
        Self::Still,
        Self::Fast,
        Self::TwoContacts,
        Self::NearEqual,
        Self::ZeroStep,
    ];

    /// Those made to break a certificate: their queries are judged at the default tolerances and at 0.
    pub const EXTREME: [Self; 7] = [
        Self::NearParallel,
        Self::Needle,
        Self::Wire,
        Self::FarOrigin,
        Self::Bullet,
        Self::Coaxial,
        Self::Long,
    ];

    /// Length of a body of this family.
    pub fn size(self) -> f64 {
        match self {
            Self::Tiny => 1.0e-4,
            Self::Huge => 1.0e4,
            _ => 1.0,
        }
    }

    /// A query between primitives of the given numbers of spheres, on straight paths or in rigid
    /// motion. All its numbers are `f32` values, so that no precision under test rounds them.
    pub fn query(self, counts: [usize; 2], rigid: bool, rng: &mut Rng) -> Query {
        if Self::EXTREME.contains(&self) {
            let mut query = extremes::query(self, counts, rigid, rng);
            query.map(&|x| f64::from(x as f32));
            return query;
        }
        let mut plan = Plan::new(self, counts, rng);
        self.adjust(&mut plan, rng);
        let mut query = plan.draw(rigid, rng);
        if self == Self::TwoContacts {
            meet_twice(&mut query, rng);
        } else {
            plan.place(&mut query, rng);
        }
        self.finish(&mut query, rng);
        query.map(&|x| f64::from(x as f32));
        query
    }

    /// What differs from two bodies of size 1 that pass each other in translation.
    fn adjust(self, plan: &mut Plan, rng: &mut Rng) {
        let half_turns = if rng.chance(0.5) {
            0.0
        } else {
            rng.log_range(0.01, TAU)
        };
        match self {
            Self::SmallRotation => plan.angle = rng.log_range(0.01, 0.3),
            Self::LargeRotation => plan.angle = rng.range(0.3, TAU),
            Self::Grazing => {
                plan.angle = half_turns;
                plan.gap =
                    [0.0, 1.0, 1.0, 1.0][rng.below(4)] * rng.sign() * rng.log_range(1.0e-7, 0.1);
                plan.rate = Some(0.0);
            }
            Self::TouchSeparating | Self::TouchApproaching => {
                plan.angle = half_turns;
                plan.time = 0.0;
                plan.gap = [0.0, rng.sign() * rng.log_range(1.0e-9, 1.0e-4)][rng.below(2)];
                let speed = rng.log_range(1.0e-3, 3.0);
                plan.rate = Some(if self == Self::TouchSeparating {
                    speed
                } else {
                    -speed
                });
            }
            Self::Overlapping => {
                plan.angle = half_turns;
                plan.time = 0.0;
                plan.gap = -rng.log_range(1.0e-4, 1.0);
                plan.crossing = rng.chance(0.5);
            }
            Self::Still => {
                plan.travel = 0.0;
                plan.gap = rng.sign() * rng.log_range(1.0e-6, 1.0);
            }
            Self::Fast => {
                plan.travel = rng.range(500.0, 2000.0);
                plan.angle = half_turns;
            }
            Self::TwoContacts => {
                plan.angle = rng.range(1.0, TAU);
                plan.travel = rng.range(0.5, 2.0);
            }
            Self::NearEqual => {
                plan.angle = half_turns;
                plan.travel = [0.0, rng.log_range(1.0e-6, 1.0)][rng.below(2)];
                plan.gap = rng.sign() * rng.log_range(1.0e-7, 1.0);
            }
            Self::ZeroStep => {
                plan.time = 0.0;
                plan.gap = rng.sign() * rng.log_range(1.0e-6, 1.0);
            }
            Self::Coincident => plan.crossing = rng.chance(0.3),
            Self::Translation => {}
            _ => plan.angle = half_turns,
        }
    }

    /// What is done to a query once it is placed.
    fn finish(self, query: &mut Query, rng: &mut Rng) {
        match self {
            Self::Tiny | Self::Huge => query.scale(self.size()),
            Self::FarAway => {
                let offset = rng.direction() * 1.0e4;
                query.shift(0, offset);
                query.shift(1, offset);
            }
            Self::ZeroStep => query.stop(),
            _ => {}
        }
    }
}

/// What a query is drawn from.
pub(super) struct Plan {
    pub(super) bodies: [Spheres; 2],
    /// Copies of one body and its motion, disturbed in the last places.
    copies: bool,
    /// Angle turned by each body in the step.
    pub(super) angle: f64,
    /// Relative displacement of the bodies in the step.
    pub(super) travel: f64,
    /// Time at which the bodies are placed.
    pub(super) time: f64,
    /// Signed distance then.
    pub(super) gap: f64,
    /// Rate of the signed distance then, per step; `None` leaves what was drawn.
    pub(super) rate: Option<f64>,
    /// Interpolated centres that coincide then, instead of a gap.
    pub(super) crossing: bool,
    /// Bound of the size of both bodies together.
    pub(super) reach: f64,
    /// Direction of the relative displacement, of bodies that are not turned at the start.
    pub(super) heading: Option<Vector3<f64>>,
    /// The same turn for both, at the start and in the step.
    pub(super) together: bool,
}

impl Plan {
    pub(super) fn new(family: Family, counts: [usize; 2], rng: &mut Rng) -> Self {
        Self {
            bodies: shapes::pair(family, counts, rng),
            copies: family == Family::NearEqual,
            angle: 0.0,
            travel: rng.range(0.5, 5.0),
            time: rng.range(0.1, 0.9),
            gap: rng.range(-0.3, 0.6),
            rate: None,
            crossing: false,
            reach: 4.0,
            heading: None,
            together: false,
        }
    }

    /// Both bodies in the origin, with their motions.
    pub(super) fn draw(&self, rigid: bool, rng: &mut Rng) -> Query {
        let seconds = [1.0, 1.0 / 60.0][rng.below(2)];
        let common = rng.in_ball() * rng.range(0.0, 2.0);
        let mut motions = [
            self.motion(common, seconds, rng),
            self.motion(common, seconds, rng),
        ];
        if self.copies {
            motions[1] = motions[0];
        }
        if self.together {
            motions[1].rotation = motions[0].rotation;
            motions[1].angvel = motions[0].angvel;
        }
        if self.travel == 0.0 && !self.copies {
            motions[1].linvel = motions[0].linvel;
            for motion in &mut motions {
                motion.angvel = Vector3::zeros();
            }
        } else {
            let heading = self.heading.unwrap_or_else(|| rng.direction());
            motions[1].linvel += heading * (self.travel / seconds);
        }
        let ball = |(center, radius)| Ball {
            center,
            radius,
            displacement: Vector3::zeros(),
        };
        let balls = [0, 1].map(|i| self.bodies[i].iter().copied().map(ball).collect());
        let query = Query {
            balls,
            motion: Motion::Rigid(Box::new(motions), seconds),
        };
        if rigid { query } else { query.straightened() }
    }

    fn motion(&self, common: Vector3<f64>, seconds: f64, rng: &mut Rng) -> Rigid {
        let turn = match self.heading {
            None => rng.direction() * rng.range(0.0, TAU),
            Some(_) => Vector3::zeros(),
        };
        let pose = UnitQuaternion::from_scaled_axis(turn);
        Rigid {
            translation: Vector3::zeros(),
            rotation: [pose.i, pose.j, pose.k, pose.w],
            local_center: rng.in_ball() * 0.5,
            linvel: common / seconds,
            angvel: rng.direction() * (self.angle / seconds),
        }
    }

    /// Moves the first body so that it is where it should be at the planned time.
    pub(super) fn place(&self, query: &mut Query, rng: &mut Rng) {
        let weights = shapes::weights(query.balls[0].len() * query.balls[1].len(), rng);
        let (y, radius) = Paths::new(query).at(self.time).blend(&weights);
        if self.crossing {
            query.shift(0, -y);
            return;
        }
        // Anywhere apart first: three bounding radii are at most 2 + 1 sizes each.
        let apart = self.reach + 2.0 * radius;
        query.shift(0, rng.direction() * apart - y);
        let paths = Paths::new(query);
        let near = distance(&paths.at(self.time), Goal::Value);
        if let Some(rate) = self.rate {
            let now = paths.velocity(self.time, &near.weights).dot(&near.normal);
            query.speed_up(0, near.normal * (rate - now), self.time);
        }
        // Not past the nearest centres: beyond, the bodies would part again on the other side.
        let deepest = -0.9 * paths.at(self.time).blend(&near.weights).1;
        query.shift(0, near.normal * (self.gap.max(deepest) - near.upper));
    }
}

/// Makes two interpolated spheres of the bodies concentric at one time, and two others at a later
/// time, by moving the first body with a constant velocity. Two single spheres on straight paths
/// cannot part in between, so they meet once.
fn meet_twice(query: &mut Query, rng: &mut Rng) {
    let (first, second) = (rng.range(0.1, 0.35), rng.range(0.65, 0.95));
    let paths = Paths::new(query);
    let corners = query.balls[0].len() * query.balls[1].len();
    let [y1, y2] = [first, second].map(|t| paths.at(t).blend(&shapes::weights(corners, rng)).0);
    if corners == 1 && query.motion == Motion::Straight {
        query.shift(0, -y1);
        return;
    }
    query.shift(0, -y1);
    query.speed_up(0, (y1 - y2) / (second - first), first);
}
