//! The part of a convex polygon on one side of a plane (Sutherland and Hodgman, "Reentrant polygon clipping", 1974).

/// The part of a polygon where a linear function of its corners is at most 0. `between` makes the corner at a share
/// (0 to 1) of the way from corner `i` to the one after it.
pub fn part_below<T: Copy>(
    polygon: &[T],
    height: impl Fn(&T) -> f64,
    between: impl Fn(usize, &T, &T, f64) -> T,
) -> Vec<T> {
    let mut part = Vec::with_capacity(polygon.len() + 1);
    for (i, a) in polygon.iter().enumerate() {
        let b = &polygon[(i + 1) % polygon.len()];
        let [at_a, at_b] = [a, b].map(&height);
        if at_a <= 0.0 {
            part.push(*a);
        }
        if (at_a <= 0.0) != (at_b <= 0.0) {
            part.push(between(i, a, b, at_a / (at_a - at_b)));
        }
    }
    part
}
