//! Eight lanes of `f32` in one AVX register, for processors that have it. Users of a crate set no
//! build flags, so the choice is made at run time, by [`crate::elementary::many`].
//!
//! The same operations in the same order as [`wide::f32x8`], so the same bits.

use super::lane::{Lane, Mask, Octet};
use pulp::x86::V3;
use std::arch::x86_64::__m256;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Eight numbers. Use only inside a dispatch that found [`V3`]: see [`simd`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct F32x8Avx(__m256);

/// Eight truth values, all bits of a lane set or none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MaskAvx(__m256);

/// Proof that the processor has AVX, for the operations below.
#[inline(always)]
#[expect(unsafe_code, reason = "the one audited exception of this crate")]
fn simd() -> V3 {
    // SAFETY: both types are private to the crate, and the only code that names them is
    // `elementary::many::brackets`, in a branch taken after `V3::try_new()` returned a token.
    unsafe { V3::new_unchecked() }
}

/// Number of the comparison `<` for AVX; false for NaN.
const LESS: i32 = std::arch::x86_64::_CMP_LT_OQ;
/// Number of the comparison `<=` for AVX; false for NaN.
const LESS_OR_EQUAL: i32 = std::arch::x86_64::_CMP_LE_OQ;

macro_rules! binary {
    ($type:ident, $trait:ident, $method:ident, $intrinsic:ident) => {
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(simd().avx.$intrinsic(self.0, other.0))
            }
        }
    };
}
binary!(F32x8Avx, Add, add, _mm256_add_ps);
binary!(F32x8Avx, Sub, sub, _mm256_sub_ps);
binary!(F32x8Avx, Mul, mul, _mm256_mul_ps);
binary!(F32x8Avx, Div, div, _mm256_div_ps);
binary!(MaskAvx, BitAnd, bitand, _mm256_and_ps);
binary!(MaskAvx, BitOr, bitor, _mm256_or_ps);

impl Neg for F32x8Avx {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(simd().avx._mm256_xor_ps(self.0, Self::splat(-0.0).0))
    }
}

impl Not for MaskAvx {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(simd().avx._mm256_xor_ps(self.0, Self::splat(true).0))
    }
}

impl Mask for MaskAvx {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        let bits = if value { u32::MAX } else { 0 };
        Self(simd().avx._mm256_set1_ps(f32::from_bits(bits)))
    }
    #[inline(always)]
    fn any(self) -> bool {
        simd().avx._mm256_movemask_ps(self.0) != 0
    }
}

impl Lane for F32x8Avx {
    type Mask = MaskAvx;
    const EPSILON: f64 = f32::EPSILON as f64;
    const TINY: f64 = <f32 as Lane>::TINY;
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(simd().avx._mm256_set1_ps(value as f32))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(simd().avx._mm256_sqrt_ps(self.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(simd().avx._mm256_andnot_ps(Self::splat(-0.0).0, self.0))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(simd().avx._mm256_min_ps(self.0, other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(simd().avx._mm256_max_ps(self.0, other.0))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> MaskAvx {
        MaskAvx(simd().avx._mm256_cmp_ps::<LESS>(self.0, other.0))
    }
    #[inline(always)]
    fn le(self, other: Self) -> MaskAvx {
        MaskAvx(simd().avx._mm256_cmp_ps::<LESS_OR_EQUAL>(self.0, other.0))
    }
    #[inline(always)]
    fn select(mask: MaskAvx, yes: Self, no: Self) -> Self {
        Self(simd().avx._mm256_blendv_ps(no.0, yes.0, mask.0))
    }
}

impl Octet for F32x8Avx {
    #[inline(always)]
    fn from_array(values: [f32; 8]) -> Self {
        Self(bytemuck::cast(values))
    }
    #[inline(always)]
    fn to_array(self) -> [f32; 8] {
        bytemuck::cast(self.0)
    }
    #[inline(always)]
    fn bits(mask: MaskAvx) -> u8 {
        simd().avx._mm256_movemask_ps(mask.0) as u8
    }
    #[inline(always)]
    fn transpose(rows: [Self; 8]) -> [Self; 8] {
        // Pairs of rows, then quartets, then halves.
        let [a, b, c, d, e, f, g, h] = rows;
        let (ab, cd) = (a.interleave(b), c.interleave(d));
        let (ef, gh) = (e.interleave(f), g.interleave(h));
        let top = [ab[0].pairs(cd[0]), ab[1].pairs(cd[1])];
        let bottom = [ef[0].pairs(gh[0]), ef[1].pairs(gh[1])];
        let ([r0, r4], [r1, r5]) = (
            top[0][0].halves(bottom[0][0]),
            top[0][1].halves(bottom[0][1]),
        );
        let ([r2, r6], [r3, r7]) = (
            top[1][0].halves(bottom[1][0]),
            top[1][1].halves(bottom[1][1]),
        );
        [r0, r1, r2, r3, r4, r5, r6, r7]
    }
}

/// Steps of the transposition; each half of a register on its own but in the last.
impl F32x8Avx {
    #[inline(always)]
    fn interleave(self, other: Self) -> [Self; 2] {
        let avx = simd().avx;
        [
            Self(avx._mm256_unpacklo_ps(self.0, other.0)),
            Self(avx._mm256_unpackhi_ps(self.0, other.0)),
        ]
    }
    #[inline(always)]
    fn pairs(self, other: Self) -> [Self; 2] {
        let avx = simd().avx;
        [
            Self(avx._mm256_shuffle_ps::<0b01_00_01_00>(self.0, other.0)),
            Self(avx._mm256_shuffle_ps::<0b11_10_11_10>(self.0, other.0)),
        ]
    }
    #[inline(always)]
    fn halves(self, other: Self) -> [Self; 2] {
        let avx = simd().avx;
        [
            Self(avx._mm256_permute2f128_ps::<0x20>(self.0, other.0)),
            Self(avx._mm256_permute2f128_ps::<0x31>(self.0, other.0)),
        ]
    }
}
