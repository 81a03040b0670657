#[allow(dead_code)]
#[path = "../tests/common/ccd/mod.rs"]
mod ccd;
use ccd::families::Family;
use ccd::rng::Rng;
use ccd::subject::Subject;
use std::time::Instant;
fn main() {
    let mut rng = Rng::new(29);
    let n = 18000;
    let queries: Vec<_> = (0..n).map(|k| Family::ALL[k % 21].query([1 + k % 3, 1 + k / 3 % 3], false, &mut rng)).collect();
    let o = Subject::Single.options(1.0);
    let mut best = [f64::MAX; 2];
    for _ in 0..20 {
        for (k, s) in [Subject::Single, Subject::Lanes].into_iter().enumerate() {
            let mut sum = 0.0;
            for q in queries.chunks(1800) { sum += s.answers(q, &o).iter().map(|a| a.unwrap().time.as_secs_f64()).sum::<f64>(); }
            best[k] = best[k].min(sum * 1e9 / n as f64);
        }
    }
    println!("single {:.0} lanes {:.0}", best[0], best[1]);
}
