//! The scenes of the table, each run by every row in turn.

use crate::common::median;
use crate::fast_pairs::{SURE, collides, errors, hook, link, rod};
use crate::heaps::{Findings, loops, throw};
use crate::oracle::{Flight, STEPS, Solid, least_distance, meeting, sub_stepped};
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use rapier3d_medial::rapier::Tuning;
use std::fmt;
use std::time::Instant;

/// Grid of a heap.
pub const HEAP: [usize; 3] = [3, 3, 3];
/// Steps of a heap.
const HEAP_STEPS: usize = 100;
/// Grid of the loops that come to rest.
pub const FEW: [usize; 3] = [2, 2, 2];
/// Steps in which they do.
pub const CALM_STEPS: usize = 480;

/// Who steps a world.
#[derive(Clone, Copy)]
pub enum Stepper {
    Medial(Effects, Tuning),
    Rapier,
}

/// A world and who steps it.
pub struct Stage {
    pub world: PhysicsWorld,
    pipeline: Option<MedialPipeline>,
    seconds: Vec<f64>,
    total: [f64; 6],
}

impl Stage {
    pub fn new(mut world: PhysicsWorld, stepper: Stepper) -> Self {
        let mut options = MedialOptions::default();
        let tuning = match stepper {
            Stepper::Medial(effects, tuning) => {
                options.effects = effects;
                Some(tuning)
            }
            Stepper::Rapier => None,
        };
        // Contacts and casts are this crate's in every row.
        let mut pipeline = MedialPipeline::new(options);
        pipeline.attach(&mut world);
        pipeline.set_tuning(tuning.unwrap_or_default());
        Self {
            world,
            pipeline: tuning.is_some().then_some(pipeline),
            seconds: Vec::new(),
            total: [0.0; 6],
        }
    }

    pub fn step(&mut self) {
        let clock = Instant::now();
        let Some(pipeline) = &mut self.pipeline else {
            self.world.step();
            self.seconds.push(clock.elapsed().as_secs_f64());
            return;
        };
        let report = pipeline.step(&mut self.world);
        self.seconds.push(clock.elapsed().as_secs_f64());
        let counts = [
            report.continuous_queries as usize,
            report.events,
            report.frozen,
            report.stops,
            report.muted,
            report.contacts,
        ];
        for (sum, count) in self.total.iter_mut().zip(counts) {
            *sum += count as f64;
        }
    }
}

/// The least time of each step over the turns.
#[derive(Default)]
struct Times(Vec<f64>);

impl Times {
    fn take(&mut self, turn: &[f64]) {
        if self.0.is_empty() {
            self.0 = turn.to_vec();
        }
        for (least, new) in self.0.iter_mut().zip(turn) {
            *least = least.min(*new);
        }
    }

    /// Mean of the steps, in µs.
    fn mean(&self) -> f64 {
        1.0e6 * self.0.iter().sum::<f64>() / self.0.len() as f64
    }
}

fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = (sorted.len().saturating_sub(1)) as f64 * share;
    sorted.get(at as usize).copied().unwrap_or(f64::NAN)
}

struct Case {
    solids: [Solid; 2],
    flights: [Flight; 2],
    meets: bool,
    /// Velocities by sub-stepped rapier, of the first sure contacts.
    truth: Option<Vec<[Vector; 2]>>,
}

/// Pairs of fast bodies of which it is known whether they meet.
pub struct Flights {
    cases: Vec<Case>,
    pub contacts: usize,
    pub clear: usize,
}

#[derive(Default)]
pub struct FlightRow {
    times: f64,
    missed: usize,
    ghosts: usize,
    errors: [Vec<f64>; 2],
    counts: [f64; 3],
}

impl fmt::Display for FlightRow {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:.1} | {}", self.times, self.findings())
    }
}

impl FlightRow {
    /// All but the time.
    pub fn findings(&self) -> String {
        let q = |which: usize| [0.5, 0.95].map(|s| quantile(&self.errors[which], s));
        let ([a, b], [c, d], [x, y, z]) = (q(0), q(1), self.counts);
        format!(
            "{} | {} | {a:.2} / {b:.2} | {c:.2} / {d:.2} | {x:.1}, {y:.1}, {z:.1}",
            self.missed, self.ghosts
        )
    }
}

impl Flights {
    /// `compared`: how many sure contacts are compared with sub-stepped rapier.
    pub fn new(seed: u64, cases: usize, compared: usize) -> Self {
        let mut random = Random(seed);
        let shapes = [hook(), link(), rod(), crate::bodies::ring(12, 0.4, 0.08)];
        let mut this = Self {
            cases: Vec::new(),
            contacts: 0,
            clear: 0,
        };
        for _ in 0..cases {
            let mut any = || Solid::Medial(shapes[(random.unit() * 4.0) as usize].clone());
            let solids = [any(), any()];
            let flights = meeting(&mut random);
            let (s, f) = ([&solids[0], &solids[1]], [&flights[0], &flights[1]]);
            let least = least_distance(s, f);
            if (SURE[0]..=SURE[1]).contains(&least) {
                continue;
            }
            let meets = least < 0.0;
            this.contacts += usize::from(meets);
            this.clear += usize::from(!meets);
            let wanted = meets && this.contacts <= compared;
            let truth = wanted.then(|| sub_stepped(s, f));
            this.cases.push(Case {
                truth: truth.filter(|v| collides(f, v)),
                solids,
                flights,
                meets,
            });
        }
        this
    }

    pub fn run(&self, steppers: &[Stepper], turns: usize) -> Vec<FlightRow> {
        let mut rows: Vec<FlightRow> = steppers.iter().map(|_| FlightRow::default()).collect();
        let n = self.cases.len() as f64;
        for case in &self.cases {
            let mut times: Vec<Times> = steppers.iter().map(|_| Times::default()).collect();
            let flights = [&case.flights[0], &case.flights[1]];
            for turn in 0..turns {
                for (k, stepper) in steppers.iter().enumerate() {
                    let (stage, velocities) = fly(case, *stepper);
                    times[k].take(&stage.seconds);
                    if turn > 0 {
                        continue;
                    }
                    let row = &mut rows[k];
                    let collided = collides(flights, &velocities);
                    row.missed += usize::from(case.meets && !collided);
                    row.ghosts += usize::from(!case.meets && collided);
                    if let Some(truth) = &case.truth {
                        let off = errors(flights, &velocities, truth);
                        (0..2).for_each(|i| row.errors[i].push(off[i].into()));
                    }
                    let [queries, events, _, stops, ..] = stage.total;
                    for (sum, count) in row.counts.iter_mut().zip([queries, events, stops]) {
                        *sum += count / n;
                    }
                }
            }
            for (row, times) in rows.iter_mut().zip(times) {
                row.times += times.mean() / n;
            }
        }
        rows
    }
}

fn fly(case: &Case, stepper: Stepper) -> (Stage, Vec<[Vector; 2]>) {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let handles = [0, 1].map(|k| {
        let collider = case.solids[k].collider();
        let handle = world.insert(case.flights[k].body(), collider).0;
        world.bodies[handle].set_allow_fast_rotation(true);
        handle
    });
    let mut stage = Stage::new(world, stepper);
    let step = |_| {
        stage.step();
        handles.map(|h| stage.world.bodies[h].linvel())
    };
    let velocities = (0..STEPS).map(step).collect();
    (stage, velocities)
}

/// Violent heaps.
#[derive(Default)]
pub struct Heaps {
    micros: Vec<f64>,
    found: Findings,
    counts: [f64; 4],
}

impl fmt::Display for Heaps {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let mean = self.micros.iter().sum::<f64>() / self.micros.len() as f64;
        write!(f, "{mean:.0} | {}", self.findings())
    }
}

impl Heaps {
    /// All but the time.
    pub fn findings(&self) -> String {
        let [queries, events, frozen, stops] = self.counts;
        let Findings {
            wrong_links,
            depth,
            energy,
            ..
        } = self.found;
        format!(
            "{wrong_links} | {depth:.2} | {energy:.4} | {queries:.1}, {events:.1}, {frozen:.2}, {stops:.2}"
        )
    }
}

pub fn medial(mesh: &MedialMesh) -> ColliderBuilder {
    ColliderBuilder::medial_mesh(mesh.clone())
}

impl Heaps {
    pub fn run(
        [first, seeds]: [u64; 2],
        (speed, restitution): (Real, Real),
        steppers: &[Stepper],
        turns: usize,
    ) -> Vec<Self> {
        let mut rows: Vec<Self> = steppers.iter().map(|_| Self::default()).collect();
        let shapes = loops();
        for heap in 0..seeds {
            let mut times: Vec<Times> = steppers.iter().map(|_| Times::default()).collect();
            for turn in 0..turns {
                for (k, stepper) in steppers.iter().enumerate() {
                    let collider = |mesh: &MedialMesh| medial(mesh).restitution(restitution);
                    let (mut world, bodies) = throw(&shapes, HEAP, speed, first + heap, collider);
                    // rapier's integration of gyroscopic forces gains energy in free flight, a third in
                    // a second at 100 rad/s: the judge of energy would see nothing else.
                    for (_, body) in world.bodies.iter_mut() {
                        body.enable_gyroscopic_forces(false);
                    }
                    let mut stage = Stage::new(world, *stepper);
                    let mut found = Findings::default();
                    for _ in 0..HEAP_STEPS {
                        stage.step();
                        if turn == 0 {
                            found.look(&stage.world, &bodies);
                        }
                    }
                    times[k].take(&stage.seconds);
                    if turn == 0 {
                        let row = &mut rows[k];
                        row.found.wrong_links += found.wrong_links;
                        row.found.depth = row.found.depth.max(found.depth);
                        row.found.energy = row.found.energy.max(found.energy);
                        for (sum, count) in row.counts.iter_mut().zip(stage.total) {
                            *sum += count / (HEAP_STEPS * seeds as usize) as f64;
                        }
                    }
                }
            }
            for (row, times) in rows.iter_mut().zip(times) {
                row.micros.push(times.mean());
            }
        }
        rows
    }
}

/// Loops that fall and come to rest.
#[derive(Default)]
pub struct Calm {
    micros: Vec<f64>,
    last: Vec<f64>,
    awake: usize,
    counts: [f64; 4],
}

impl fmt::Display for Calm {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [all, last] = [&self.micros, &self.last].map(|m| median(&mut m.clone()));
        let [queries, muted, events, contacts] = self.counts;
        write!(
            f,
            "{all:.1} | {last:.1} | {} | {queries:.2}, {muted:.2}, {events:.2} | {contacts:.1}",
            self.awake
        )
    }
}

impl Calm {
    pub fn run([first, seeds]: [u64; 2], steppers: &[Stepper], turns: usize) -> Vec<Self> {
        let mut rows: Vec<Self> = steppers.iter().map(|_| Self::default()).collect();
        let shapes = loops();
        for fall in 0..seeds {
            let mut times: Vec<Times> = steppers.iter().map(|_| Times::default()).collect();
            for turn in 0..turns {
                for (k, stepper) in steppers.iter().enumerate() {
                    let (world, bodies) = throw(&shapes, FEW, 3.0, first + fall, medial);
                    let mut stage = Stage::new(world, *stepper);
                    (0..CALM_STEPS).for_each(|_| stage.step());
                    times[k].take(&stage.seconds);
                    if turn > 0 {
                        continue;
                    }
                    let row = &mut rows[k];
                    let awake = |h: RigidBodyHandle| !stage.world.bodies[h].is_sleeping();
                    row.awake += bodies.iter().filter(|(h, _)| awake(*h)).count();
                    let [queries, events, _, _, muted, contacts] = stage.total;
                    let counts = [queries, muted, events, contacts];
                    for (sum, count) in row.counts.iter_mut().zip(counts) {
                        *sum += count / (CALM_STEPS * seeds as usize) as f64;
                    }
                }
            }
            for (row, times) in rows.iter_mut().zip(times) {
                row.micros.push(times.mean());
                let last = Times(times.0[CALM_STEPS - 60..].to_vec());
                row.last.push(last.mean());
            }
        }
        rows
    }
}
