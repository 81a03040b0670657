//! Points and boxes in the builder's frame: in `f64`, scaled so that the longest side of the triangle mesh is 1, and
//! centred at the origin.

use crate::math::lane::Vec3;

/// A point or direction in the builder's frame.
pub type Point = Vec3<f64>;

/// Coordinate of a point by index of the axis.
#[inline]
pub fn coordinate(p: Point, axis: usize) -> f64 {
    match axis {
        0 => p.x,
        1 => p.y,
        _ => p.z,
    }
}

/// The direction of `v`, or zero where `v` has no length.
#[inline]
pub fn direction(v: Point) -> Point {
    let length = v.length();
    if length > 0.0 {
        v * (1.0 / length)
    } else {
        Point::zero()
    }
}

/// A unit vector at right angles to the unit vector `n`.
pub fn perpendicular(n: Point) -> Point {
    // The axis farthest from `n`: the cross product keeps a length of at least √(2/3).
    let (x, y, z) = (n.x.abs(), n.y.abs(), n.z.abs());
    let axis = if x <= y && x <= z {
        Point::new(1.0, 0.0, 0.0)
    } else if y <= z {
        Point::new(0.0, 1.0, 0.0)
    } else {
        Point::new(0.0, 0.0, 1.0)
    };
    direction(n.cross(axis))
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Smallest coordinates.
    pub lo: Point,
    /// Largest coordinates.
    pub hi: Point,
}

impl Bounds {
    /// The box of nothing: any union with it is the other.
    pub const EMPTY: Self = Self {
        lo: Point {
            x: f64::MAX,
            y: f64::MAX,
            z: f64::MAX,
        },
        hi: Point {
            x: f64::MIN,
            y: f64::MIN,
            z: f64::MIN,
        },
    };

    /// The smallest box around points.
    pub fn of(points: impl IntoIterator<Item = Point>) -> Self {
        points
            .into_iter()
            .fold(Self::EMPTY, |b, p| b.union(Self { lo: p, hi: p }))
    }

    /// The box around a ball.
    pub fn of_ball(center: Point, radius: f64) -> Self {
        let r = Point::new(radius, radius, radius);
        Self {
            lo: center - r,
            hi: center + r,
        }
    }

    /// The smallest box around both.
    #[inline]
    pub fn union(self, o: Self) -> Self {
        Self {
            lo: Point::new(
                self.lo.x.min(o.lo.x),
                self.lo.y.min(o.lo.y),
                self.lo.z.min(o.lo.z),
            ),
            hi: Point::new(
                self.hi.x.max(o.hi.x),
                self.hi.y.max(o.hi.y),
                self.hi.z.max(o.hi.z),
            ),
        }
    }

    /// Middle of the box.
    pub fn center(&self) -> Point {
        self.lo * 0.5 + self.hi * 0.5
    }

    /// Lengths of its sides.
    pub fn sides(&self) -> Point {
        self.hi - self.lo
    }

    /// Length of its longest side.
    pub fn longest_side(&self) -> f64 {
        let s = self.sides();
        s.x.max(s.y).max(s.z)
    }

    /// Axis of its longest side.
    pub fn longest_axis(&self) -> usize {
        let s = self.sides();
        if s.x >= s.y && s.x >= s.z {
            0
        } else if s.y >= s.z {
            1
        } else {
            2
        }
    }

    /// Squared distance to the box; 0 inside.
    #[inline]
    pub fn distance_sq(&self, p: Point) -> f64 {
        let x = (self.lo.x - p.x).max(p.x - self.hi.x).max(0.0);
        let y = (self.lo.y - p.y).max(p.y - self.hi.y).max(0.0);
        let z = (self.lo.z - p.z).max(p.z - self.hi.z).max(0.0);
        x * x + y * y + z * z
    }

    /// Whether two boxes are within `distance` of each other along each axis.
    pub fn is_near(&self, o: &Self, distance: f64) -> bool {
        let gap = |lo: Point, hi: Point| {
            let gap = lo - hi;
            gap.x.max(gap.y).max(gap.z)
        };
        gap(self.lo, o.hi).max(gap(o.lo, self.hi)) <= distance
    }

    /// Distance to the box's farthest corner.
    pub fn farthest(&self, p: Point) -> f64 {
        let (lo, hi) = (p - self.lo, self.hi - p);
        let far = |l: f64, h: f64| l.abs().max(h.abs());
        Point::new(far(lo.x, hi.x), far(lo.y, hi.y), far(lo.z, hi.z)).length()
    }
}
