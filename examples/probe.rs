#[allow(dead_code)]
#[path = "../tests/common/ccd/mod.rs"]
mod ccd;
use ccd::families::Family;
use ccd::motion::Query;
use ccd::rng::Rng;
use rapier3d_medial::elementary::bracket::{Limits, bracket};
use rapier3d_medial::elementary::many::{Lanes, brackets};
use rapier3d_medial::elementary::path::LinearPath;
use rapier3d_medial::elementary::test_list::{Domain, ElementaryTest};
use rapier3d_medial::math::lane::Vec3;
use std::hint::black_box;
use std::time::Instant;
const QUERIES: usize = 60_000;
const MIX: [(&str, Family, f64); 10] = [
    ("separate", Family::Translation, 8.0),
    ("approaching", Family::Translation, 0.0),
    ("small rotation", Family::SmallRotation, 0.0),
    ("large rotation", Family::LargeRotation, 0.0),
    ("grazing", Family::Grazing, 0.0),
    ("touching at the start", Family::TouchApproaching, 0.0),
    ("fast", Family::Fast, 0.0),
    ("thin", Family::Thin, 0.0),
    ("parallel", Family::Parallel, 0.0),
    ("zero size", Family::ZeroSize, 0.0),
];
fn path(query: &Query, test: &ElementaryTest) -> LinearPath<f64> {
    LinearPath::new(test, 0.0, |second, i| {
        let ball = &query.balls[usize::from(second)][usize::from(i)];
        let [c, d] = [ball.center, ball.displacement].map(|v| Vec3::new(v.x, v.y, v.z));
        (c, d, ball.radius)
    })
}
fn main() {
    for (domain, counts, test) in [
        (
            Domain::Box,
            [2, 2],
            ElementaryTest::cone_cone([0, 1], [0, 1]),
        ),
        (Domain::Triangle, [1, 3], ElementaryTest::sphere_slab(0)),
    ] {
        let mut rng = Rng::new(29);
        let drawn: Vec<Query> = (0..QUERIES)
            .map(|i| {
                let (_, family, apart) = MIX[i % MIX.len()];
                let mut query = family.query(counts, false, &mut rng);
                query.shift(0, rng.direction() * apart);
                query
            })
            .collect();
        let paths: Vec<_> = drawn.iter().map(|q| path(q, &test)).collect();
        let limits = Limits {
            tolerance: 1e-6,
            time_tolerance: 1e-6,
            start: 0.0,
            horizon: 1.0,
            max_iterations: 64,
        };
        println!("{domain:?}");
        if std::env::args().nth(1).is_some() {
            let v = |v: Vec3<f64>| Vec3::new(v.x as f32, v.y as f32, v.z as f32);
            let single: Vec<LinearPath<f32>> = paths
                .iter()
                .map(|p| LinearPath {
                    start: p.start.map(v),
                    rate: p.rate.map(v),
                    radius: p.radius.map(|r| r as f32),
                })
                .collect();
            let l32 = Limits {
                tolerance: 1e-6f32,
                time_tolerance: 1e-6,
                start: 0.0,
                horizon: 1.0,
                max_iterations: 64,
            };
            let rounds: usize = std::env::args().nth(1).unwrap().parse().unwrap();
            let mut it = [0u64; 2];
            let n = QUERIES / 1000;
            let mut best = vec![[f64::MAX; 4]; n];
            let mut time = |slot: &mut f64, work: &mut dyn FnMut()| {
                let c = Instant::now();
                work();
                *slot = slot.min(c.elapsed().as_secs_f64() * 1e9);
            };
            for _ in 0..rounds {
                it = [0, 0];
                for (k, lanes) in [Lanes::Fastest, Lanes::Baseline].into_iter().enumerate() {
                    for (i, b) in single.chunks(1000).enumerate() {
                        time(&mut best[i][k], &mut || {
                            black_box(brackets(black_box(b), domain, &l32, lanes));
                        });
                    }
                }
                for (i, b) in single.chunks(1000).enumerate() {
                    time(&mut best[i][2], &mut || {
                        for p in b {
                            it[0] +=
                                black_box(bracket(black_box(p), domain, &l32)).iterations as u64;
                        }
                    });
                }
                for (i, b) in paths.chunks(1000).enumerate() {
                    time(&mut best[i][3], &mut || {
                        for p in b {
                            it[1] +=
                                black_box(bracket(black_box(p), domain, &limits)).iterations as u64;
                        }
                    });
                }
            }
            let sum = |k: usize| best.iter().map(|b| b[k]).sum::<f64>() / QUERIES as f64;
            println!(
                "{domain:?} min ns: avx {:.1} base {:.1} f32 {:.0} (it {:.3}) f64 {:.0} (it {:.3})",
                sum(0),
                sum(1),
                sum(2),
                it[0] as f64 / 6e4,
                sum(3),
                it[1] as f64 / 6e4
            );
            continue;
        }
        for k in 0..MIX.len() {
            let own: Vec<_> = paths.iter().skip(k).step_by(MIX.len()).collect();
            let b: Vec<_> = own.iter().map(|p| bracket(*p, domain, &limits)).collect();
            let n = b.len() as f64;
            let iters = b.iter().map(|b| b.iterations as f64).sum::<f64>() / n;
            let h = |i: u32| b.iter().filter(|b| b.iterations == i).count() as f64 / n * 100.0;
            let mut best = f64::MAX;
            for _ in 0..5 {
                let c = Instant::now();
                for p in &own {
                    black_box(bracket(black_box(*p), domain, &limits));
                }
                best = best.min(c.elapsed().as_secs_f64() * 1e9 / n);
            }
            println!(
                "{:24} hits {:4.0}% iters {:.2}  0:{:.0} 1:{:.0} 2:{:.0} 3:{:.0} 4:{:.0} 5+:{:.0}  ns {:.0} ns/iter {:.0}",
                MIX[k].0,
                100.0 * b.iter().filter(|b| b.contact).count() as f64 / n,
                iters,
                h(0),
                h(1),
                h(2),
                h(3),
                h(4),
                100.0 - h(0) - h(1) - h(2) - h(3) - h(4),
                best,
                best / iters.max(0.01)
            );
        }
        let mut best = f64::MAX;
        let mut it = 0u64;
        for _ in 0..5 {
            let c = Instant::now();
            it = 0;
            for p in &paths {
                it += black_box(bracket(black_box(p), domain, &limits)).iterations as u64;
            }
            best = best.min(c.elapsed().as_secs_f64() * 1e9 / QUERIES as f64);
        }
        println!("mixed ns {best:.0} iters {:.3}", it as f64 / QUERIES as f64);
    }
}
