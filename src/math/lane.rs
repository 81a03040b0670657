//! One trait over `f32`, `f64` and `wide::f32x8`, so that a kernel is written once and serves as
//! the scalar path, the double-precision reference and the SIMD path.
//!
//! Kernels are branch-free where lanes may differ: both sides are computed and [`Lane::select`]
//! picks. Products and sums are never fused: a fused result would differ between processors, and
//! a world must not.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};
use wide::f32x8;

/// Result of a comparison of lanes: `bool`, or one bit pattern per lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// True in all lanes, or in none.
    fn splat(value: bool) -> Self;
    /// Whether any lane is true.
    fn any(self) -> bool;
}

/// A number, or several numbers processed in step.
pub trait Lane:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The result of a comparison.
    type Mask: Mask;
    /// Distance from 1 to the next number (2⁻²³ or 2⁻⁵²).
    const EPSILON: f64;
    /// A positive number far below any squared length met, and far above underflow.
    const TINY: f64;

    /// The same value in all lanes.
    fn splat(value: f64) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// The smaller of two; `other` where `self` is not a number.
    fn min(self, other: Self) -> Self;
    /// The larger of two; `other` where `self` is not a number.
    fn max(self, other: Self) -> Self;
    /// `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`.
    fn le(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is true, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// 0.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }
    /// 1.
    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }
    /// Clamped to `[0, 1]`.
    #[inline(always)]
    fn clamp01(self) -> Self {
        self.max(Self::zero()).min(Self::one())
    }
}

/// A scalar lane: adds what only one number at a time needs.
pub trait Scalar: Lane<Mask = bool> + PartialOrd {
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// Whether neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// Converts rapier's scalar, exactly.
    fn from_real(value: parry3d::math::Real) -> Self;
    /// Converts to double precision, exactly.
    fn to_f64(self) -> f64;
}

/// Eight lanes of `f32` whose members can be read.
pub trait Octet: Lane {
    /// Packs eight members.
    fn from_array(values: [f32; 8]) -> Self;
    /// Unpacks the eight members.
    fn to_array(self) -> [f32; 8];
    /// Truth values as bits, lane 0 lowest.
    fn bits(mask: Self::Mask) -> u8;
    /// Lane `i` of row `k` becomes lane `k` of row `i`.
    fn transpose(rows: [Self; 8]) -> [Self; 8];
}

impl Octet for f32x8 {
    #[inline(always)]
    fn from_array(values: [f32; 8]) -> Self {
        f32x8::from(values)
    }
    #[inline(always)]
    fn to_array(self) -> [f32; 8] {
        f32x8::to_array(self)
    }
    #[inline(always)]
    fn bits(mask: f32x8) -> u8 {
        mask.to_bitmask() as u8
    }
    #[inline(always)]
    fn transpose(rows: [Self; 8]) -> [Self; 8] {
        f32x8::transpose(rows)
    }
}

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
}

macro_rules! impl_scalar {
    ($t:ty, $tiny:expr, $sin_cos:path) => {
        impl Lane for $t {
            type Mask = bool;
            const EPSILON: f64 = <$t>::EPSILON as f64;
            const TINY: f64 = $tiny;
            #[inline(always)]
            fn splat(value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$t>::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$t>::abs(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
        }
        impl Scalar for $t {
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                $sin_cos(self)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                <$t>::is_finite(self)
            }
            #[inline(always)]
            fn from_real(value: parry3d::math::Real) -> Self {
                value as $t
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self as f64
            }
        }
    };
}
impl_scalar!(f32, 1.0e-30, super::portable::sin_cos_f32);
impl_scalar!(f64, 1.0e-200, super::portable::sin_cos_f64);

impl Mask for f32x8 {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        let zero = f32x8::splat(0.0);
        if value { zero.simd_le(zero) } else { zero }
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.to_bitmask() != 0
    }
}

impl Lane for f32x8 {
    type Mask = f32x8;
    const EPSILON: f64 = f32::EPSILON as f64;
    const TINY: f64 = <f32 as Lane>::TINY;
    #[inline(always)]
    fn splat(value: f64) -> Self {
        f32x8::splat(value as f32)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f32x8::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f32x8::abs(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.fast_min(other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.fast_max(other)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> f32x8 {
        self.simd_lt(other)
    }
    #[inline(always)]
    fn le(self, other: Self) -> f32x8 {
        self.simd_le(other)
    }
    #[inline(always)]
    fn select(mask: f32x8, yes: Self, no: Self) -> Self {
        mask.bitselect(yes, no)
    }
}

/// A point or direction whose coordinates are lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3<L> {
    /// First coordinate.
    pub x: L,
    /// Second coordinate.
    pub y: L,
    /// Third coordinate.
    pub z: L,
}

impl<L: Lane> Vec3<L> {
    /// A vector from three coordinates.
    #[inline(always)]
    pub fn new(x: L, y: L, z: L) -> Self {
        Self { x, y, z }
    }
    /// The origin.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::new(L::zero(), L::zero(), L::zero())
    }
    /// Inner product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> L {
        self.x * other.x + self.y * other.y + self.z * other.z
    }
    /// Cross product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }
    /// Squared length.
    #[inline(always)]
    pub fn length_sq(self) -> L {
        self.dot(self)
    }
    /// Sum of the members' sizes.
    #[inline(always)]
    pub fn taxicab(self) -> L {
        self.x.abs() + self.y.abs() + self.z.abs()
    }
    /// Length.
    #[inline(always)]
    pub fn length(self) -> L {
        self.length_sq().sqrt()
    }
    /// `yes` where the mask is true, else `no`.
    #[inline(always)]
    pub fn select(mask: L::Mask, yes: Self, no: Self) -> Self {
        Self::new(
            L::select(mask, yes.x, no.x),
            L::select(mask, yes.y, no.y),
            L::select(mask, yes.z, no.z),
        )
    }
}

impl<S: Scalar> Vec3<S> {
    /// Converts rapier's vector, exactly when `S` is `f64`.
    #[inline(always)]
    pub fn from_vector(v: parry3d::math::Vector) -> Self {
        Self::new(S::from_real(v.x), S::from_real(v.y), S::from_real(v.z))
    }
    /// Converts to rapier's vector, rounded when `S` is `f64`.
    #[inline(always)]
    pub fn to_vector(self) -> parry3d::math::Vector {
        let r = |s: S| s.to_f64() as parry3d::math::Real;
        parry3d::math::Vector::new(r(self.x), r(self.y), r(self.z))
    }
    /// Whether all coordinates are finite.
    #[inline(always)]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }
}

impl<L: Lane> Add for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}
impl<L: Lane> Sub for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}
impl<L: Lane> Mul<L> for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: L) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}
impl<L: Lane> Neg for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}
