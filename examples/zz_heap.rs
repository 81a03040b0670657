#[path = "common/creature.rs"]
mod creature;
#[path = "common/mesh.rs"]
mod mesh;
#[path = "common/random.rs"]
mod random;
#[path = "common/isosurface.rs"]
mod isosurface;
#[path = "common/skin.rs"]
mod skin;
#[path = "common/skeleton.rs"]
mod skeleton;
#[path = "../tests/common/detailed.rs"]
mod detailed;
use detailed::{Form, detailed};
use random::Random;
use rapier3d::prelude::*;
use rapier3d_medial::prelude::*;
use rapier3d_medial::BuildOptions;

type R = (Real, Real);
fn prism(outline: &[R], faces: &[[u32; 3]], [low, high]: [Real; 2]) -> (Vec<Vector>, Vec<[u32; 3]>) {
    let layer = |z: Real| outline.iter().map(move |(x, y)| Vector::new(*x, *y, z));
    let vertices = layer(low).chain(layer(high)).collect();
    let n = outline.len() as u32;
    let caps = faces.iter().flat_map(|[a, b, c]| [[*a, *c, *b], [a + n, b + n, c + n]]);
    let sides = (0..n).flat_map(|k| {
        let next = (k + 1) % n;
        [[k, next, next + n], [k, next + n, k + n]]
    });
    (vertices, caps.chain(sides).collect())
}
fn source(kind: &str) -> (Vec<Vector>, Vec<[u32; 3]>) {
    match kind {
        "T" => {
            let o = [(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (2.0, 2.0), (2.0, 3.0), (-1.0, 3.0), (-1.0, 2.0), (0.0, 2.0)];
            let o = o.map(|(x, y): R| ((x - 0.5) / 3.0, (y - 1.5) / 3.0));
            prism(&o, &[[0, 1, 2], [0, 2, 7], [5, 6, 7], [5, 7, 2], [5, 2, 4], [4, 2, 3]], [-0.4 / 3.0, 0.4 / 3.0])
        }
        "L" => {
            let [a, b, c] = [-0.4, -0.05, 0.6];
            prism(&[(a, a), (c, a), (c, b), (b, b), (b, c), (a, c)], &[[0, 1, 2], [0, 2, 3], [0, 3, 5], [3, 4, 5]], [-0.17, 0.18])
        }
        "U" => {
            let o = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (2.0, 3.0), (2.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)];
            let o = o.map(|(x, y): R| ((x - 1.5) / 3.0, (y - 1.5) / 3.0));
            prism(&o, &[[0, 1, 4], [0, 4, 5], [0, 5, 6], [0, 6, 7], [1, 2, 3], [1, 3, 4]], [-0.15, 0.15])
        }
        _ => {
            return { let m = creature::creature().0; (m.vertices, m.indices) };

        }
    }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let kind = a[1].as_str();
    let n: usize = a[2].parse().unwrap();
    let heaps: u64 = a[3].parse().unwrap();
    let mode = a.get(4).map(|s| s.as_str()).unwrap_or("medial");
    let count: usize = a.get(5).map(|s| s.parse().unwrap()).unwrap_or(12);
    let form = match kind { "Ring" => Some(Form::Ring), "Spider" => Some(Form::Spider), "Bear" => Some(Form::Bear), "Sheet" => Some(Form::Sheet), _ => None };
    let (medial, src) = if let Some(f) = form {
        let m = detailed(f, n);
        let e = m.envelope(0.05);
        (m, e)
    } else {
        let (v, i) = source(kind);
        let (low, high) = v.iter().fold((Vector::splat(1e9), Vector::splat(-1e9)), |(l, h), p| (l.min(*p), h.max(*p)));
        let s = 1.0 / (high - low).max_element();
        let v: Vec<Vector> = v.iter().map(|p| (*p - (low + high) * 0.5) * s).collect();
        let o = BuildOptions { primitives: Some(n), ..Default::default() };
        (MedialMesh::from_trimesh(&v, &i, &o).unwrap().0, (v, i))
    };
    let collider = match mode {
        "parts" => ColliderBuilder::convex_decomposition(&src.0, &src.1),
        "hull" => ColliderBuilder::convex_hull(&src.0).unwrap(),
        _ => ColliderBuilder::medial_mesh(medial.clone()),
    };
    medial.mass_properties(1.0);
    let mut all = Vec::new();
    let mut sums = [0u64; 12];
    let mut secs = [0f64; 4];
    let mut hash = 0u64;
    let steps: usize = std::env::var("STEPS").ok().map_or(240, |s| s.parse().unwrap());
    for seed in 1..=heaps {
        let mut world = PhysicsWorld::new();
        world.insert_collider(ColliderBuilder::cuboid(20.0, 1.0, 20.0).translation(Vector::Y * -1.0), None);
        let mut random = Random(seed);
        for k in 0..count {
            let turn = random.direction() * 3.0;
            let b = RigidBodyBuilder::dynamic().translation(random.direction() * 0.3 + Vector::Y * (1.0 + 0.8 * k as Real)).rotation(turn);
            world.insert(b, collider.clone());
        }
        let effects = match mode {
            "nocont" => Effects::default().continuous(Effect::Off),
            "off" => Effects::default().continuous(Effect::Off).guard(Effect::Off),
            _ => Effects::default(),
        };
        let mut p = MedialPipeline::new(MedialOptions::default().effects(effects));
        for _ in 0..steps {
            let t = cpu_time::ThreadTime::now();
            if mode == "parts" || mode == "hull" { world.step(); all.push(t.elapsed().as_secs_f64() * 1e3); continue; }
            let r = p.step(&mut world);
            all.push(t.elapsed().as_secs_f64() * 1e3);
            let v = [r.pairs as u64, r.jobs as u64, r.contacts as u64, r.continuous_queries, r.events as u64, r.frozen as u64, r.spent, r.culled_nodes, r.elementary_tests, r.muted as u64, r.cache_misses, r.cache_hits];
            if std::env::var("SLOW").is_ok_and(|l| *all.last().unwrap() > l.parse::<f64>().unwrap()) { println!("    seed {seed} step {} ms {:.1} pairs {} jobs {} q {} ev {} fr {} spent {} nodes {} tests {} muted {} | batch {:.1} mute {:.1} event {:.1} step {:.1}", all.len() % steps, all.last().unwrap(), r.pairs, r.jobs, r.continuous_queries, r.events, r.frozen, r.spent, r.culled_nodes, r.elementary_tests, r.muted, r.batch_seconds*1e3, r.mute_seconds*1e3, r.event_seconds*1e3, r.step_seconds*1e3); }
            for (s, x) in sums.iter_mut().zip(v) { *s += x; }
            for (s, x) in secs.iter_mut().zip([r.batch_seconds, r.mute_seconds, r.event_seconds, r.step_seconds]) { *s += x * 1e3; }
        }
        for (_, b) in world.bodies.iter() { for x in b.translation().to_array() { hash = (hash ^ u64::from(x.to_bits())).wrapping_mul(0x100000001b3); } }
    }
    let m = all.len() as f64;
    let mean = all.iter().sum::<f64>() / m;
    let mut s = all.clone(); s.sort_by(f64::total_cmp);
    println!("{kind} {n} ({}) {mode}: mean {mean:.3} p50 {:.2} p99 {:.2} max {:.2} hash {hash:016x}", medial.primitive_count(), s[s.len() / 2], s[s.len() * 99 / 100], s[s.len() - 1]);
    if mode != "parts" && mode != "hull" {
        let n = ["pairs", "jobs", "contacts", "queries", "events", "frozen", "spent", "nodes", "tests", "muted", "miss", "hits"];
        let t: Vec<String> = n.iter().zip(sums).map(|(n, s)| format!("{n} {:.2}", s as f64 / m)).collect();
        println!("  {}", t.join(" "));
        println!("  ms: batch {:.3} mute {:.3} event {:.3} step {:.3}", secs[0] / m, secs[1] / m, secs[2] / m, secs[3] / m);
    }
}
