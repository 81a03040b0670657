//! Cholesky's factorisation of a symmetric matrix of which each row is zero before its first entry, as the factor
//! then is too (George and Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981, 4.2). The joints
//! of a chain, in their order, give rows of a few entries, however long the chain is.

/// `A = L Lᵀ`, row by row.
pub struct Skyline {
    /// First column of each row.
    first: Vec<usize>,
    /// Rows, each from its first column to the diagonal.
    rows: Vec<Vec<f64>>,
}

impl Skyline {
    /// Factors the lower half of a matrix: for each row its first column, and entries from there to the diagonal.
    /// `None` where it is not positive definite.
    pub fn factor(lower: Vec<(usize, Vec<f64>)>) -> Option<Self> {
        let (first, rows): (Vec<usize>, Vec<Vec<f64>>) = lower.into_iter().unzip();
        let mut factor = Self { first, rows };
        for i in 0..factor.rows.len() {
            let (done, rest) = factor.rows.split_at_mut(i);
            let row = rest.first_mut()?;
            let begin = factor.first[i];
            for j in begin..i {
                let common = begin.max(factor.first[j]);
                let (diagonal, other) = done[j].split_last()?;
                let both = row[common - begin..]
                    .iter()
                    .zip(&other[common - factor.first[j]..]);
                let sum: f64 = both.map(|(x, y)| x * y).sum();
                row[j - begin] = (row[j - begin] - sum) / diagonal;
            }
            let (diagonal, left) = row.split_last_mut()?;
            let square = *diagonal - left.iter().map(|x| x * x).sum::<f64>();
            if square.is_nan() || square <= 0.0 {
                return None;
            }
            *diagonal = square.sqrt();
        }
        Some(factor)
    }

    /// The `x` of `A x = b`.
    pub fn solve(&self, mut b: Vec<f64>) -> Vec<f64> {
        let rows = self.rows.iter().zip(&self.first).enumerate();
        for (i, (row, &begin)) in rows.clone() {
            let (left, diagonal) = row.split_at(i - begin);
            let sum: f64 = left.iter().zip(&b[begin..]).map(|(l, x)| l * x).sum();
            b[i] = (b[i] - sum) / diagonal[0];
        }
        for (i, (row, &begin)) in rows.rev() {
            let (left, diagonal) = row.split_at(i - begin);
            b[i] /= diagonal[0];
            let x = b[i];
            for (b, l) in b[begin..].iter_mut().zip(left) {
                *b -= l * x;
            }
        }
        b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix `M Mᵀ` with entries planted left of the diagonal where a chain has them, and a planted solution.
    #[test]
    fn a_planted_solution_is_found() {
        let n = 20;
        let entry = |i: usize, j: usize| match i - j {
            0 => 2.0 + (i % 3) as f64,
            d if d <= 1 + i % 4 => 0.3 * (((i * 7 + j * 3) % 5) as f64 - 2.0),
            _ => 0.0,
        };
        let planted: Vec<f64> = (0..n).map(|i| (i as f64 * 0.7).sin()).collect();
        let full = |i: usize, j: usize| -> f64 {
            let both = 0..=i.min(j);
            both.map(|k| entry(i, k) * entry(j, k)).sum()
        };
        let row = |i: usize| {
            let first = (0..i).find(|j| full(i, *j) != 0.0).unwrap_or(i);
            (first, (first..=i).map(|j| full(i, j)).collect())
        };
        let b = (0..n).map(|i| (0..n).map(|j| full(i, j) * planted[j]).sum());
        let factor = Skyline::factor((0..n).map(row).collect()).expect("positive definite");
        for (x, planted) in factor.solve(b.collect()).into_iter().zip(planted) {
            assert!((x - planted).abs() < 1.0e-12, "{x} for {planted}");
        }
        let indefinite = vec![(0, vec![1.0]), (0, vec![2.0, 1.0])];
        assert!(Skyline::factor(indefinite).is_none());
    }
}
