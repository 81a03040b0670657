//! Two fast bodies: those that surely meet exchange an impulse, those that surely do not fly on.

use crate::bodies::*;
use crate::oracle::*;
use crate::random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;

/// Free flights that get deeper than this, a length, surely meet; those that stay further apart
/// surely do not. In between lies what sampling, and the gap at which bodies meet, leave open.
pub const SURE: [Real; 2] = [-0.02, 0.02];

/// An open hook, thick at one end and thin at the other.
pub fn hook() -> MedialMesh {
    let count = 9;
    let spheres = (0..count).map(|i| {
        let s = i as Real / (count - 1) as Real;
        let angle = 4.4 * s;
        let center = Vector::new(0.4 * angle.cos(), 0.2 * s, 0.4 * angle.sin());
        MedialSphere::new(center, 0.1 - 0.06 * s)
    });
    let edges = (1..count as u32).map(|i| [i - 1, i]).collect();
    MedialMesh::new(spheres.collect(), edges, vec![]).expect("a hook")
}

/// A link: two straight sides and two round ends.
pub fn link() -> MedialMesh {
    use std::f32::consts::PI;
    let spheres: Vec<_> = (0..12)
        .map(|i| {
            let (end, k) = if i < 6 { (1.0, i) } else { (-1.0, i - 6) };
            let angle = PI * (k as Real / 5.0) + if end > 0.0 { 0.0 } else { PI };
            let center = Vector::new(0.25 * angle.cos(), 0.0, 0.4 * end + 0.25 * angle.sin());
            MedialSphere::new(center, 0.07)
        })
        .collect();
    let edges = (0..12).map(|i| [i, (i + 1) % 12]).collect();
    MedialMesh::new(spheres, edges, vec![]).expect("a link")
}

pub fn rod() -> MedialMesh {
    let ends = [-0.5, 0.5].map(|z| MedialSphere::new(Vector::new(0.0, 0.0, z), 0.05));
    MedialMesh::new(ends.to_vec(), vec![[0, 1]], vec![]).expect("a rod")
}

/// Who steps the world.
#[derive(Clone, Copy, Debug, PartialEq)]
enum By {
    Us,
    Rapier,
    RapierBullets,
    RapierSoftCcd,
}

const ALL: [By; 4] = [By::Us, By::Rapier, By::RapierBullets, By::RapierSoftCcd];

/// Velocities of both bodies after each step.
fn velocities(solids: [&Solid; 2], flights: [&Flight; 2], by: By) -> Vec<[Vector; 2]> {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    let mut pipeline = attached(&mut world);
    let handles = [0, 1].map(|k| {
        let handle = world.insert(flights[k].body(), solids[k].collider()).0;
        let body = &mut world.bodies[handle];
        body.set_allow_fast_rotation(true);
        body.enable_ccd(by == By::RapierBullets);
        if by == By::RapierSoftCcd {
            body.set_soft_ccd_prediction(10.0);
        }
        handle
    });
    let step = |_| {
        if by == By::Us {
            pipeline.step(&mut world);
        } else {
            world.step();
        }
        handles.map(|h| world.bodies[h].linvel())
    };
    (0..STEPS).map(step).collect()
}

/// How far a velocity is from that at the start, from which on it is another.
const CHANGED: Real = 1.0e-3;

/// Whether either body's velocity changed.
pub fn collides(flights: [&Flight; 2], velocities: &[[Vector; 2]]) -> bool {
    let last = velocities.last().expect("steps");
    (0..2).any(|k| last[k].distance(flights[k].linvel) > CHANGED)
}

/// Error of the first change of velocity, and of the final velocities, in units of what the reference
/// changes.
pub fn errors(flights: [&Flight; 2], ours: &[[Vector; 2]], truth: &[[Vector; 2]]) -> [Real; 2] {
    let start = [flights[0].linvel, flights[1].linvel];
    let first = |all: &[[Vector; 2]]| {
        let changed = all.iter().find(|v| v[0].distance(start[0]) > CHANGED);
        changed.map_or(Vector::ZERO, |v| v[0] - start[0])
    };
    let (a, b) = (first(ours), first(truth));
    let [last, right] = [ours, truth].map(|v| *v.last().expect("steps"));
    let off: Real = (0..2).map(|k| last[k].distance(right[k])).sum();
    let changed: Real = (0..2).map(|k| right[k].distance(start[k])).sum();
    [
        a.distance(b) / b.length().max(CHANGED),
        off / changed.max(CHANGED),
    ]
}

/// What became of the sure contacts and the sure misses, by who stepped.
#[derive(Default)]
struct Count {
    contacts: u32,
    clear: u32,
    missed: [u32; 4],
    ghosts: [u32; 4],
    /// Of the first sure contacts, at most [`COMPARED`] of a count.
    errors: Vec<[Real; 2]>,
}

/// Sure contacts of a full-size count whose velocities are compared with sub-stepped rapier.
const COMPARED: usize = 300;

impl Count {
    /// Error below which a share of the cases lies.
    fn quantile(&self, which: usize, share: Real) -> Real {
        let mut all: Vec<_> = self.errors.iter().map(|e| e[which]).collect();
        all.sort_by(Real::total_cmp);
        all[((all.len() - 1) as Real * share) as usize]
    }
}

fn count(seed: u64, cases: u32, by: &[By], second: impl Fn(&mut Random) -> Solid) -> Count {
    let mut random = Random(seed);
    let shapes = [hook(), link(), rod(), ring(12, 0.4, 0.08)];
    let mut count = Count::default();
    let compare = by.len() == ALL.len();
    for case in 0..cases {
        let first = Solid::Medial(shapes[(random.unit() * 4.0) as usize].clone());
        let second = second(&mut random);
        let solids = [&first, &second];
        let flights = meeting(&mut random);
        let flights = [&flights[0], &flights[1]];
        let least = least_distance(solids, flights);
        let sure = !(SURE[0]..=SURE[1]).contains(&least);
        count.contacts += u32::from(least < SURE[0]);
        count.clear += u32::from(least > SURE[1]);
        for &by in by.iter().filter(|_| sure) {
            let moved = velocities(solids, flights, by);
            let collided = collides(flights, &moved);
            let (missed, ghost) = (least < 0.0 && !collided, least > 0.0 && collided);
            count.missed[by as usize] += u32::from(missed);
            count.ghosts[by as usize] += u32::from(ghost);
            if by == By::Us && (missed || ghost) {
                println!("seed {seed}, case {case}: wrong, nearest {least} m: {flights:?}");
            }
            let compared = by == By::Us && compare && least < 0.0 && count.errors.len() < COMPARED;
            if compared {
                let truth = sub_stepped(solids, flights);
                if collides(flights, &truth) {
                    count.errors.push(errors(flights, &moved, &truth));
                }
            }
        }
    }
    println!(
        "seed {seed}: {} sure contacts, {} sure misses; {ALL:?}: missed {:?}, ghosts {:?}",
        count.contacts, count.clear, count.missed, count.ghosts
    );
    if compare {
        let row = |which| [0.5, 0.95].map(|share| count.quantile(which, share));
        let (first, last, n) = (row(0), row(1), count.errors.len());
        println!("  of {n}: first change p50/p95 {first:.3?}, final velocity {last:.3?}");
    }
    count
}

fn check(count: &Count) {
    assert!(
        count.contacts >= 30 && count.clear >= 20,
        "cases do not represent"
    );
    assert!(count.missed[1] > count.contacts / 3, "cases are easy");
    assert_eq!((count.missed[0], count.ghosts[0]), (0, 0));
}

fn any_medial(random: &mut Random) -> Solid {
    let shapes = [hook(), link(), rod(), ring(12, 0.4, 0.08)];
    Solid::Medial(shapes[(random.unit() * 4.0) as usize].clone())
}

fn any_cuboid(random: &mut Random) -> Solid {
    let mut side = || random.within(0.05, 0.5);
    Solid::Cuboid(Vector::new(side(), side(), side()))
}

fn any_hull(random: &mut Random) -> Solid {
    let mut corner = |_| random.direction() * random.within(0.2, 0.5);
    let points: Vec<_> = (0..14).map(&mut corner).collect();
    Solid::Other(SharedShape::convex_hull(&points).expect("a hull"))
}

/// Surface of a T: two boxes, one across the other's end.
fn any_trimesh(random: &mut Random) -> Solid {
    let mut side = || random.within(0.06, 0.25);
    let (thin, wide, long) = (side(), side() + 0.2, side() + 0.15);
    let (mut vertices, mut indices) = Cuboid::new(Vector::new(wide, thin, thin)).to_trimesh();
    let (stem, triangles) = Cuboid::new(Vector::new(thin, long, thin)).to_trimesh();
    let shift = Vector::new(0.0, -thin - long, 0.0);
    let first = vertices.len() as u32;
    vertices.extend(stem.iter().map(|v| *v + shift));
    indices.extend(triangles.iter().map(|t| t.map(|i| i + first)));
    Solid::Other(SharedShape::trimesh(vertices, indices).expect("a surface"))
}

fn any_round(random: &mut Random) -> Solid {
    let mut size = || random.within(0.08, 0.4);
    let (a, b) = (size(), size());
    Solid::Other(match (random.unit() * 3.0) as u32 {
        0 => SharedShape::ball(a),
        1 => SharedShape::capsule_y(a, b),
        _ => SharedShape::cylinder(a, b),
    })
}

fn any_compound(random: &mut Random) -> Solid {
    let mut at = || Pose::new(random.direction() * 0.3, random.direction());
    let parts = vec![
        (at(), SharedShape::cuboid(0.3, 0.08, 0.1)),
        (at(), SharedShape::ball(0.15)),
        (at(), SharedShape::capsule_z(0.2, 0.07)),
    ];
    Solid::Other(SharedShape::compound(parts))
}

type Partner = (&'static str, fn(&mut Random) -> Solid);

/// Partners other than medial ones and cuboids.
const PARTNERS: [Partner; 4] = [
    ("hull", any_hull),
    ("trimesh", any_trimesh),
    ("ball, capsule, cylinder", any_round),
    ("compound", any_compound),
];

#[test]
#[ignore = "minutes in release: the table of docs/measurements/with-rapier.md, of which CI runs a part"]
fn full_size() {
    let medial = count(9001, 12_000, &ALL, any_medial);
    let cuboid = count(9002, 3_000, &ALL, any_cuboid);
    assert!(medial.contacts + cuboid.contacts >= 5_000 && medial.clear >= 1_000);
    check(&medial);
    check(&cuboid);
}

#[test]
#[ignore = "minutes in release: the table of docs/measurements/with-rapier.md, of which CI runs a part"]
fn full_partners() {
    let counts = PARTNERS.map(|(name, any)| {
        println!("medial and {name}");
        count(9003, 1_500, &ALL, any)
    });
    counts.iter().for_each(check);
}

#[test]
fn a_medial_body_and_any_other() {
    for (_, any) in PARTNERS {
        check(&count(73, 100, &ALL[..2], any));
    }
}

#[test]
fn two_medial_bodies() {
    check(&count(71, 100, &ALL[..2], any_medial));
}

#[test]
fn a_medial_body_and_a_cuboid() {
    check(&count(72, 100, &ALL[..2], any_cuboid));
}

/// Two thin rods head-on at 2 × 60 m/s, crossing at right angles (rapier#984): without the event loop
/// most of these passed through each other, whatever rapier's options.
#[test]
fn crossed_rods_head_on() {
    for phase in 0..16 {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let mut pipeline = attached(&mut world);
        let mut throw = |x: Real, turn: Real| {
            let pose = Pose::new(Vector::new(x, 0.0, 0.0), Vector::new(turn, 0.0, 0.0));
            let speed = Vector::new(-60.0 * x.signum(), 0.0, 0.0);
            let body = RigidBodyBuilder::dynamic().pose(pose).linvel(speed);
            world.insert(body, ColliderBuilder::medial_mesh(rod())).0
        };
        let right = throw(3.0 + phase as Real / 16.0, 0.0);
        let left = throw(-3.0, std::f32::consts::FRAC_PI_2);
        for _ in 0..12 {
            pipeline.step(&mut world);
        }
        let x = |h: RigidBodyHandle| world.bodies[h].translation().x;
        assert!(x(right) > x(left), "phase {phase}");
    }
}

/// Symptom: a ball without friction that spins, met its neighbour and was struck again late in the step, pushed the
/// neighbour aside at 1.6 m/s. Cause: the contact met before turned with the ball. Three balls in a row have no reason
/// to move aside.
#[test]
fn a_spinning_ball_that_is_struck_again_pushes_nothing_aside() {
    for spin in [10.0, 60.0, 300.0] {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::ZERO;
        let dt = world.integration_parameters.dt;
        // The first strikes the second after a tenth of the step, the third the first after nine tenths.
        let starts = [
            (0.0, 20.0, spin),
            (0.2 + 2.0 * dt, 0.0, 0.0),
            (-0.2 - 44.0 * dt, 60.0, 0.0),
        ];
        let balls = starts.map(|(x, speed, spin)| {
            let body = RigidBodyBuilder::dynamic()
                .translation(Vector::X * x)
                .linvel(Vector::X * speed)
                .angvel(Vector::Z * spin);
            let ball = ColliderBuilder::medial_mesh(MedialMesh::ball(0.1).expect("a ball"));
            world.insert(body, ball.friction(0.0)).0
        });
        MedialPipeline::default().step(&mut world);
        let [a, b, c] = balls.map(|ball| world.bodies[ball].linvel());
        let aside = [a, b, c].map(|v| v.y.abs().max(v.z.abs()));
        assert!(aside.iter().all(|v| *v < 1.0e-3), "spin {spin}: {aside:?}");
        // The second impact is passed on to the ball in front.
        assert!(b.x >= a.x - 1.0e-3 && a.x > 20.0, "{a} {b} {c}");
        assert!((a.x + b.x + c.x - 80.0).abs() < 1.0e-3, "{a} {b} {c}");
    }
}
