//! The one judge of all engines: it sees states that they recorded and the scenes, and nothing else of them.

use crate::circles::{Curve, Point, Pose, length, linking, minus};
use crate::record::{Run, STATE, Trajectory};
use crate::scenes::{Body, League, RING, World};
use serde::Serialize;

/// A body that ends this far from its free path, metres, felt something.
const FELT: f64 = 0.01;
/// A ring at rest moves by less than this in five seconds, metres.
const DRIFT: f64 = 0.005;

/// Flights at one speed.
#[derive(Default, Serialize)]
pub struct Flights {
    /// Sure hits, those that were not felt, and those that were felt and left the rings linked.
    pub hits: usize,
    pub missed: usize,
    pub linked: usize,
    /// Clear passes, and those of them that were felt.
    pub passes: usize,
    pub ghosts: usize,
}

/// Thrown rings at one speed, over all seeds.
#[derive(Default, Serialize)]
pub struct Thrown {
    /// Pairs of rings whose linking number changed.
    pub changed: usize,
    /// Rings that left the closed room.
    pub outside: usize,
    /// Milliseconds of a step: the mean and the longest.
    pub ms: f64,
    pub longest: f64,
}

#[derive(Default, Serialize)]
pub struct Rest {
    /// Milliseconds of a step in the first and the last four seconds.
    pub falling: f64,
    pub resting: f64,
    /// Rings that moved in the last five seconds, and the farthest of them, metres.
    pub drifting: usize,
    pub farthest: f64,
    pub outside: usize,
}

/// Elastic cubes at one rate, over all seeds: energy over that at the start.
#[derive(Serialize)]
pub struct Elastic {
    pub ends: Vec<f64>,
    pub most: f64,
    pub outside: usize,
    pub ms: f64,
}

/// What an engine made of the scenes.
#[derive(Serialize)]
pub struct Verdict {
    pub engine: String,
    pub version: String,
    pub setting: String,
    pub is_wasm: bool,
    pub flights: Vec<(String, Flights)>,
    pub thrown: Vec<(String, Thrown)>,
    pub rest: Rest,
    pub elastic: Vec<(String, Elastic)>,
}

/// A body's recorded numbers; what is not finite is NaN.
struct State([f64; STATE]);

impl State {
    fn position(&self) -> Point {
        [self.0[0], self.0[1], self.0[2]]
    }

    fn pose(&self) -> Pose {
        let s = &self.0;
        Pose::new(self.position(), [s[3], s[4], s[5], s[6]])
    }

    fn energy(&self, mass: f64, inertia: f64) -> f64 {
        let s = &self.0;
        let square = |k: usize| s[k..k + 3].iter().map(|x| x * x).sum::<f64>();
        0.5 * (mass * square(7) + inertia * square(10))
    }

    fn is_inside(&self, room: [f64; 3]) -> bool {
        let p = self.position();
        (0..3).all(|k| p[k].abs() < room[k])
    }
}

fn states(frame: &[Option<f64>]) -> Vec<State> {
    let bodies = frame.chunks_exact(STATE);
    bodies
        .map(|numbers| State(std::array::from_fn(|k| numbers[k].unwrap_or(f64::NAN))))
        .collect()
}

fn last(trajectory: &Trajectory) -> Vec<State> {
    trajectory
        .frames
        .last()
        .map(|f| states(f))
        .unwrap_or_default()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn lines(poses: impl Iterator<Item = Pose>) -> Vec<Vec<Point>> {
    let circle = Curve::Circle(RING[0]);
    poses.map(|pose| circle.points(&pose)).collect()
}

fn start(body: &Body) -> Pose {
    Pose::new(body.position, body.rotation)
}

fn outside(trajectory: &Trajectory, world: &World) -> usize {
    let end = last(trajectory);
    end.iter().filter(|s| !s.is_inside(world.room)).count()
}

impl Flights {
    fn add(&mut self, world: &World, trajectory: &Trajectory) {
        let end = last(trajectory);
        let time = world.dt * world.steps as f64;
        let felt = end.iter().zip(&world.bodies).any(|(state, body)| {
            let free = |k: usize| body.position[k] + time * body.velocity[k];
            let off = length(minus(state.position(), std::array::from_fn(free)));
            off > FELT
        });
        // What ends nowhere is wrong in both cases.
        let is_lost = end.iter().any(|s| !length(s.position()).is_finite());
        if !world.meets {
            self.passes += 1;
            self.ghosts += usize::from(felt || is_lost);
            return;
        }
        self.hits += 1;
        self.missed += usize::from(!felt || is_lost);
        if felt && !is_lost && world.scene.starts_with("rings") {
            let ends = lines(end.iter().map(State::pose));
            self.linked += usize::from(linking(&ends[0], &ends[1]) != 0);
        }
    }
}

/// Fails where rings are linked at the start that were not planted so: pairs are, neighbours in the list, and no
/// others.
pub fn check_planted(league: &League) -> Result<(), String> {
    let is_thrown = |w: &&World| ["heap", "pairs"].iter().any(|s| w.scene.starts_with(s));
    for world in league.worlds.iter().filter(is_thrown) {
        let lines = lines(world.bodies.iter().map(start));
        for a in 0..lines.len() {
            for b in 0..a {
                let planted = world.scene.starts_with("pairs") && a % 2 == 1 && b == a - 1;
                if (linking(&lines[a], &lines[b]) != 0) != planted {
                    return Err(format!("{}: rings {b} and {a} at the start", world.scene));
                }
            }
        }
    }
    Ok(())
}

/// Which pairs of rings are linked otherwise in the end than at the start.
pub fn changed(world: &World, trajectory: &Trajectory) -> Vec<[usize; 2]> {
    let before = lines(world.bodies.iter().map(start));
    let end = last(trajectory);
    let after = lines(end.iter().map(State::pose));
    let mut changed = Vec::new();
    for a in 0..after.len() {
        for b in 0..a {
            if linking(&before[a], &before[b]) != linking(&after[a], &after[b]) {
                changed.push([a, b]);
            }
        }
    }
    changed
}

impl Rest {
    fn new(world: &World, trajectory: &Trajectory) -> Self {
        let (frames, ms) = (&trajectory.frames, &trajectory.ms);
        let window = (4.0 / world.dt) as usize;
        let seconds = (5.0 / world.dt) as usize / world.every;
        let earlier = states(&frames[frames.len().saturating_sub(seconds + 1)]);
        let ends = last(trajectory);
        let moved = ends.iter().zip(&earlier);
        let moved: Vec<_> = moved
            .map(|(a, b)| length(minus(a.position(), b.position())))
            .collect();
        Self {
            falling: mean(&ms[..window.min(ms.len())]),
            resting: mean(&ms[ms.len().saturating_sub(window)..]),
            drifting: moved.iter().filter(|m| m.is_nan() || **m > DRIFT).count(),
            farthest: moved.iter().copied().fold(0.0, f64::max),
            outside: outside(trajectory, world),
        }
    }
}

impl Elastic {
    fn new(worlds: &[(&World, &Trajectory)], league: &League) -> Self {
        let mut elastic = Self {
            ends: Vec::new(),
            most: 0.0,
            outside: 0,
            ms: 0.0,
        };
        for (world, trajectory) in worlds {
            let shape = &league.shapes[world.bodies[0].shape];
            let of = |s: &State| s.energy(shape.mass, shape.inertia[0]);
            let begin = |b: &Body| {
                let speed = |v: Point| length(v).powi(2);
                0.5 * (shape.mass * speed(b.velocity) + shape.inertia[0] * speed(b.spin))
            };
            let start: f64 = world.bodies.iter().map(begin).sum();
            let energy = |f: &Vec<_>| states(f).iter().map(of).sum::<f64>() / start;
            let energies: Vec<_> = trajectory.frames.iter().map(energy).collect();
            elastic.most = energies.iter().copied().fold(elastic.most, f64::max);
            elastic.ends.extend(energies.last());
            elastic.outside += outside(trajectory, world);
            elastic.ms += mean(&trajectory.ms) / worlds.len() as f64;
        }
        elastic.ends.sort_by(f64::total_cmp);
        elastic
    }
}

/// Worlds with the same scene, in the order of their first appearance.
fn scenes<'a>(
    league: &'a League,
    run: &'a Run,
    kinds: &[&str],
) -> Vec<(String, Vec<(&'a World, &'a Trajectory)>)> {
    let mut found: Vec<(String, Vec<_>)> = Vec::new();
    for pair in league.worlds.iter().zip(&run.worlds) {
        let scene = &pair.0.scene;
        if !kinds.iter().any(|kind| scene.starts_with(kind)) {
            continue;
        }
        match found.iter_mut().find(|(name, _)| name == scene) {
            Some((_, pairs)) => pairs.push(pair),
            None => found.push((scene.clone(), vec![pair])),
        }
    }
    found
}

fn thrown(worlds: &[(&World, &Trajectory)]) -> Thrown {
    let mut all = Thrown::default();
    for (world, trajectory) in worlds {
        all.changed += changed(world, trajectory).len();
        all.outside += outside(trajectory, world);
        all.ms += mean(&trajectory.ms) / worlds.len() as f64;
        all.longest = trajectory.ms.iter().copied().fold(all.longest, f64::max);
    }
    all
}

impl Verdict {
    pub fn new(league: &League, run: &Run) -> Self {
        let flights = |(name, worlds): (String, Vec<(&World, &Trajectory)>)| {
            let mut flights = Flights::default();
            worlds.iter().for_each(|(w, t)| flights.add(w, t));
            (name, flights)
        };
        let of = |kinds: &[&str]| scenes(league, run, kinds).into_iter();
        let rest = of(&["rest"]).next().map(|(_, w)| Rest::new(w[0].0, w[0].1));
        Self {
            engine: run.engine.clone(),
            version: run.version.clone(),
            setting: run.setting.clone(),
            is_wasm: run.is_wasm,
            flights: of(&["rings", "rod"]).map(flights).collect(),
            thrown: of(&["heap", "pairs"])
                .map(|(name, w)| (name, thrown(&w)))
                .collect(),
            rest: rest.unwrap_or_default(),
            elastic: of(&["elastic"])
                .map(|(name, w)| (name, Elastic::new(&w, league)))
                .collect(),
        }
    }
}
