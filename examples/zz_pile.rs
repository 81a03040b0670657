#[path = "../benches/torus/mod.rs"]
mod torus;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use std::time::Instant;
use torus::{ring, surface};

fn world(shape: SharedShape, rings: usize, seed: u32) -> PhysicsWorld {
    let mut world = PhysicsWorld::default();
    let side = if rings > 100 { 6 } else { 3 };
    let half = 0.75 * side as Real;
    let slab =
        |x: Real, y: Real, z: Real, at: Vector| ColliderBuilder::cuboid(x, y, z).translation(at);
    let tall = 60.0;
    world.insert_collider(slab(50.0, 0.5, 50.0, Vector::NEG_Y * 0.5), None);
    for axis in [Vector::X, Vector::NEG_X] {
        world.insert_collider(slab(0.5, tall, 50.0, axis * (half + 0.5)), None);
    }
    for axis in [Vector::Z, Vector::NEG_Z] {
        world.insert_collider(slab(50.0, tall, 0.5, axis * (half + 0.5)), None);
    }
    let mass = ring(27).mass_properties(1000.0);
    let collider = ColliderBuilder::new(shape).density(0.0);
    for k in 0..rings {
        let (layer, place) = (k / (side * side), k % (side * side));
        let at = |i: usize| (i as Real - 0.5 * (side - 1) as Real) * 1.4;
        let center = Vector::new(
            at(place % side),
            0.6 + 0.5 * layer as Real,
            at(place / side),
        );
        let tilt = Vector::new(0.3, 0.0, 0.2) * (((k as u32 + seed) % 7) as Real - 3.0);
        let body = RigidBodyBuilder::dynamic()
            .pose(Pose::new(center, tilt))
            .additional_mass_properties(mass)
            .can_sleep(false);
        world.insert(body, collider.clone());
    }
    world
}
fn main() {
    let env = |n: &str, d: usize| {
        std::env::var(n)
            .ok()
            .and_then(|s| s.parse().ok())
            .unwrap_or(d)
    };
    let (rings, settle, steps, seeds) = (
        env("RINGS", 200),
        env("SETTLE", 240),
        env("STEPS", 270),
        env("SEEDS", 3),
    );
    let only = env("ONLY", 0) == 1;
    let (points, triangles) = surface();
    let vhacd = SharedShape::convex_decomposition(&points, &triangles);
    let reps = env("REPS", 7);
    let mut ratios = vec![];
    let mut sum = [0.0; 6];
    for seed in env("FIRST", 0) as u32..(env("FIRST", 0) + seeds) as u32 {
        let mut t: [Vec<f64>; 6] = std::array::from_fn(|_| vec![f64::INFINITY; steps]);
        let mut last = String::new();
        for _ in 0..reps {
            let mut a = world(SharedShape::medial_mesh(ring(27)), rings, seed);
            let mut b = world(vhacd.clone(), rings, seed);
            let mut p = MedialPipeline::new(MedialOptions::default());
            p.attach(&mut a);
            for _ in 0..settle {
                p.step(&mut a);
                if !only {
                    b.step();
                }
            }
            let ctl = |w: &str| {
                if let Ok(f) = std::env::var("CTL") {
                    use std::io::Write;
                    std::fs::OpenOptions::new()
                        .write(true)
                        .open(f)
                        .unwrap()
                        .write_all(w.as_bytes())
                        .unwrap();
                    std::thread::sleep(std::time::Duration::from_millis(20));
                }
            };
            ctl("enable\n");
            let (mut jobs, mut misses, mut pairs, mut nodes, mut tests) = (0, 0, 0, 0, 0);
            for k in 0..steps {
                let c = Instant::now();
                let r = p.step(&mut a);
                let all = [
                    c.elapsed().as_secs_f64(),
                    r.batch_seconds,
                    r.mute_seconds,
                    r.step_seconds,
                    r.event_seconds,
                ];
                for (t, x) in t.iter_mut().zip(all) {
                    t[k] = t[k].min(x);
                }
                jobs += r.jobs;
                misses += r.cache_misses;
                pairs += r.pairs;
                nodes += r.culled_nodes;
                tests += r.elementary_tests;
            }
            ctl("disable\n");
            if !only {
                for k in 0..steps {
                    let c = Instant::now();
                    b.step();
                    t[5][k] = t[5][k].min(c.elapsed().as_secs_f64());
                }
            }
            let count = |w: &PhysicsWorld| {
                let mut n = [0; 5];
                for pair in w.narrow_phase.contact_pairs() {
                    n[0] += 1;
                    let k = pair
                        .solver_manifolds()
                        .iter()
                        .filter(|m| !m.data.solver_contacts.is_empty())
                        .count();
                    n[1] += (k > 0) as usize;
                    n[2] += k;
                    n[3] += pair
                        .solver_manifolds()
                        .iter()
                        .map(|m| m.data.solver_contacts.len())
                        .sum::<usize>();
                    n[4] += pair.manifolds().len();
                }
                n
            };
            let n = steps;
            last = format!(
                "pairs {} jobs {:.1} misses {:.1} nodes {} tests {} | medial [pairs, active, manifolds, contacts, all] {:?} vhacd {:?}",
                pairs / n,
                jobs as f64 / n as f64,
                misses as f64 / n as f64,
                nodes as usize / n,
                tests as usize / n,
                count(&a),
                count(&b)
            );
        }
        let m: Vec<f64> = t
            .iter()
            .map(|v| v.iter().sum::<f64>() / v.len() as f64 * 1e6)
            .collect();
        for (s, x) in sum.iter_mut().zip(&m) {
            *s += x / seeds as f64;
        }
        println!(
            "seed {seed}: total {:.0} batch {:.0} mute {:.0} step {:.0} event {:.0} | vhacd {:.0} ratio {:.2} | {last}",
            m[0],
            m[1],
            m[2],
            m[3],
            m[4],
            m[5],
            m[0] / m[5]
        );
        ratios.push(m[0] / m[5]);
    }
    ratios.sort_by(f64::total_cmp);
    println!(
        "mean: total {:.1} batch {:.1} mute {:.1} step {:.1} event {:.1} vhacd {:.1} ratio {:.2} ratios {:.2?}",
        sum[0],
        sum[1],
        sum[2],
        sum[3],
        sum[4],
        sum[5],
        sum[0] / sum[5],
        ratios
    );
}
