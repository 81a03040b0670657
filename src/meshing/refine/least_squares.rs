//! Damped linear least squares for the changes of balls, by conjugate gradients.
//!
//! Unknowns: four per ball, `x = (Δc, Δr)`. A row with weights `α`, normal `n` and residual `d` asks
//! for `Σ αₖ (n·Δcₖ + Δrₖ) = d`. The normal equations `(Jᵀ W J + Λ) x = Jᵀ W d` are never formed:
//! conjugate gradients need only products with `J`, and its diagonal as the preconditioner
//! (Hestenes and Stiefel, 1952; Marquardt, 1963, for the damping `Λ`).

use crate::meshing::refine::residuals::ResidualRow;

/// Iterations at most; the change is limited afterwards, so the last digits do not matter.
const ITERATIONS: usize = 25;

/// Ends when the preconditioned residual, squared, has fallen by this factor.
const CONVERGED: f64 = 1e-5;

/// Share of the mean diagonal that a ball's damping refers to, besides its own: balls that few
/// samples answer to are held.
const SHARED: f64 = 0.02;

/// The changes of all balls, four numbers each: centre and radius. `damping` is one factor a ball.
pub fn solve(rows: &[ResidualRow], damping: &[f64]) -> Vec<[f64; 4]> {
    let n = damping.len();
    let mut rhs = vec![[0.0; 4]; n];
    let mut diagonal = vec![[0.0; 4]; n];
    for row in rows {
        let normal = [row.normal.x, row.normal.y, row.normal.z, 1.0];
        for (&v, &w) in row.corners.iter().zip(&row.weights) {
            for k in 0..4 {
                let g = normal[k] * w;
                rhs[v as usize][k] += row.weight * g * row.residual;
                diagonal[v as usize][k] += row.weight * g * g;
            }
        }
    }
    let total: f64 = diagonal.iter().flatten().sum();
    let shared = SHARED * total / (4 * n.max(1)) as f64;
    let mut lambda = vec![0.0; n];
    for ((lambda, diagonal), &factor) in lambda.iter_mut().zip(&mut diagonal).zip(damping) {
        let own = diagonal.iter().sum::<f64>() / 4.0;
        *lambda = (shared + own) * factor + f64::MIN_POSITIVE.sqrt();
        diagonal.iter_mut().for_each(|d| *d += *lambda);
    }
    let dot = |a: &[[f64; 4]], b: &[[f64; 4]]| -> f64 {
        a.iter()
            .zip(b)
            .map(|(a, b)| a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3])
            .sum()
    };
    let scaled = |r: &[[f64; 4]]| -> Vec<[f64; 4]> {
        let divide = |(r, d): (&[f64; 4], &[f64; 4])| [0, 1, 2, 3].map(|k| r[k] / d[k]);
        r.iter().zip(&diagonal).map(divide).collect()
    };
    let mut x = vec![[0.0; 4]; n];
    let mut r = rhs;
    let mut z = scaled(&r);
    let mut p = z.clone();
    let mut rz = dot(&r, &z);
    let enough = CONVERGED * rz;
    for _ in 0..ITERATIONS {
        if rz <= enough || rz <= 0.0 {
            break;
        }
        let ap = product(rows, &lambda, &p);
        let step = rz / dot(&p, &ap);
        for i in 0..n {
            for k in 0..4 {
                x[i][k] += step * p[i][k];
                r[i][k] -= step * ap[i][k];
            }
        }
        z = scaled(&r);
        let next = dot(&r, &z);
        let share = next / rz;
        rz = next;
        for (p, z) in p.iter_mut().zip(&z) {
            *p = [0, 1, 2, 3].map(|k| z[k] + share * p[k]);
        }
    }
    x
}

/// `(Jᵀ W J + Λ) x`.
fn product(rows: &[ResidualRow], lambda: &[f64], x: &[[f64; 4]]) -> Vec<[f64; 4]> {
    let damped = |(x, l): (&[f64; 4], &f64)| x.map(|x| x * l);
    let mut out: Vec<[f64; 4]> = x.iter().zip(lambda).map(damped).collect();
    for row in rows {
        let n = row.normal;
        let mut sum = 0.0;
        for (&v, &w) in row.corners.iter().zip(&row.weights) {
            let [a, b, c, r] = x[v as usize];
            sum += w * (n.x * a + n.y * b + n.z * c + r);
        }
        sum *= row.weight;
        for (&v, &w) in row.corners.iter().zip(&row.weights) {
            let (o, s) = (&mut out[v as usize], sum * w);
            *o = [o[0] + s * n.x, o[1] + s * n.y, o[2] + s * n.z, o[3] + s];
        }
    }
    out
}
