//! Cholesky's factorisation of a symmetric matrix of which each row is zero before its first entry, as the factor
//! then is too (George and Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981, 4.2). The joints
//! of a chain, in their order, give rows of a few entries, however long the chain is; those of a tree do if the joints
//! of the branches come before that of their stem.

/// The lower half of a symmetric matrix `A`, or its factor `L` with `A = L Lᵀ`, row by row.
#[derive(Default)]
pub struct Skyline {
    /// Rows after each other, each from its first column to the diagonal.
    entries: Vec<f64>,
    /// First column of each row, and where its diagonal is.
    rows: Vec<(usize, usize)>,
}

impl Skyline {
    /// Adds a row of the lower half of a matrix, zero from its first column to the diagonal, and returns its entries.
    /// The first column is no farther than the diagonal.
    pub fn push_row(&mut self, first: usize) -> &mut [f64] {
        let begin = self.entries.len();
        self.entries
            .resize(begin + self.rows.len() + 1 - first, 0.0);
        self.rows.push((first, self.entries.len() - 1));
        &mut self.entries[begin..]
    }

    /// Factors a matrix. `None` where it is not positive definite.
    pub fn factor(mut self) -> Option<Self> {
        for (i, &(first, diagonal)) in self.rows.iter().enumerate() {
            let (done, rest) = self.entries.split_at_mut(diagonal + first - i);
            let row = &mut rest[..=i - first];
            for j in first..i {
                let (other, end) = self.rows[j];
                let common = first.max(other);
                let both = row[common - first..j - first]
                    .iter()
                    .zip(&done[end + common - j..end]);
                let sum: f64 = both.map(|(x, y)| x * y).sum();
                row[j - first] = (row[j - first] - sum) / done[end];
            }
            let (diagonal, left) = row.split_last_mut()?;
            let square = *diagonal - left.iter().map(|x| x * x).sum::<f64>();
            if square.is_nan() || square <= 0.0 {
                return None;
            }
            *diagonal = square.sqrt();
        }
        Some(self)
    }

    /// Replaces `b` by the `x` of `A x = b`, where this is the factor of `A`.
    pub fn solve(&self, b: &mut [f64]) {
        let rows = self.rows.iter().enumerate();
        let left =
            |i: usize, first: usize, diagonal: usize| &self.entries[diagonal + first - i..diagonal];
        for (i, &(first, diagonal)) in rows.clone() {
            let both = left(i, first, diagonal).iter().zip(&b[first..]);
            let sum: f64 = both.map(|(l, x)| l * x).sum();
            b[i] = (b[i] - sum) / self.entries[diagonal];
        }
        for (i, &(first, diagonal)) in rows.rev() {
            b[i] /= self.entries[diagonal];
            let x = b[i];
            for (b, l) in b[first..].iter_mut().zip(left(i, first, diagonal)) {
                *b -= l * x;
            }
        }
    }
}

/// Ranks of bodies that are placed after those from which joints reach them: a body's are above those of all that it
/// carries, which come branch by branch.
pub fn ranks(bodies: usize, joints: impl Iterator<Item = [usize; 2]>) -> Vec<usize> {
    let mut carriers: Vec<Option<usize>> = vec![None; bodies];
    for [a, b] in joints {
        let [near, far] = [a.min(b), a.max(b)];
        carriers[far].get_or_insert(near);
    }
    let mut carried = vec![1; bodies];
    for far in (0..bodies).rev() {
        if let Some(near) = carriers[far].filter(|near| *near != far) {
            carried[near] += carried[far];
        }
    }
    let mut next = vec![0; bodies];
    let mut roots = 0;
    let mut ranks = Vec::with_capacity(bodies);
    for k in 0..bodies {
        let begin = match carriers[k] {
            Some(near) => &mut next[near],
            None => &mut roots,
        };
        let first = *begin;
        *begin += carried[k];
        next[k] = first;
        ranks.push(first + carried[k] - 1);
    }
    ranks
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
        let mut matrix = Skyline::default();
        for i in 0..n {
            let first = (0..i).find(|j| full(i, *j) != 0.0).unwrap_or(i);
            for (j, entry) in matrix.push_row(first).iter_mut().enumerate() {
                *entry = full(i, first + j);
            }
        }
        let b = (0..n).map(|i| (0..n).map(|j| full(i, j) * planted[j]).sum());
        let mut x: Vec<f64> = b.collect();
        matrix.factor().expect("positive definite").solve(&mut x);
        for (x, planted) in x.into_iter().zip(planted) {
            assert!((x - planted).abs() < 1.0e-12, "{x} for {planted}");
        }
        let mut indefinite = Skyline::default();
        indefinite.push_row(0).copy_from_slice(&[1.0]);
        indefinite.push_row(0).copy_from_slice(&[2.0, 1.0]);
        assert!(indefinite.factor().is_none());
    }

    /// A trunk with two branches that have two twigs each: each branch after its twigs, and the trunk last.
    #[test]
    fn branches_come_before_their_stem() {
        let joints = [[0, 1], [0, 2], [1, 3], [4, 1], [2, 5], [2, 6]];
        assert_eq!(ranks(7, joints.into_iter()), [6, 2, 5, 0, 1, 3, 4]);
    }
}
