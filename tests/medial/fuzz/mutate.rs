//! Bytes to try: good ones, broken in the ways that files break, and numbers that are seldom expected.

/// SplitMix64 (Steele, Lea, Flood 2014).
pub struct Rng(u64);

impl Rng {
    /// The numbers of one case of one target.
    pub fn of_case(target: usize, case: u64) -> Self {
        Self(case.wrapping_mul(64).wrapping_add(target as u64) ^ 0x5eed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A whole number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() % count.max(1) as u64) as usize
    }

    /// In `[-1, 1)`.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    }

    pub fn pick<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }

    /// Mostly of a common size, sometimes awkward, sometimes any bits at all.
    pub fn number(&mut self) -> f32 {
        match self.below(16) {
            0 => f32::from_bits(self.bits() as u32),
            1 | 2 => *self.pick(&AWKWARD),
            _ => 2.0 * self.unit(),
        }
    }
}

pub const AWKWARD: [f32; 12] = [
    0.0,
    -0.0,
    1.0,
    1.0e-45,
    1.0e-30,
    1.0e-6,
    1.0e4,
    1.0e18,
    -1.0e18,
    f32::MAX,
    f32::INFINITY,
    f32::NAN,
];

const WORDS: [u32; 12] = [
    0,
    1,
    2,
    0x7f,
    0xff,
    0xffff,
    0x1_0000,
    0x0fff_ffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_fffe,
    0xffff_ffff,
];

/// Words of the text formats, and numbers that they should not hold.
const TOKENS: [&str; 44] = [
    "nan",
    "inf",
    "-inf",
    "1e39",
    "1e-46",
    "-0",
    "0x10",
    "-1",
    "0",
    "1",
    "4294967295",
    "4294967296",
    "-2147483648",
    "18446744073709551615",
    "18446744073709551616",
    "99999999999999999999999999",
    "\n",
    "\r\n",
    " ",
    "\t",
    "#",
    "\\\n",
    "/",
    "//",
    "\0",
    "\u{feff}",
    "v ",
    "f ",
    "e ",
    "OFF ",
    "COFF\n",
    "solid ",
    "endsolid\n",
    "facet normal ",
    "outer loop\n",
    "vertex ",
    "ply\n",
    "format ascii 1.0\n",
    "format binary_big_endian 1.0\n",
    "element vertex 4000000000\n",
    "element face 4000000000\n",
    "property list uchar int vertex_indices\n",
    "property double x\n",
    "end_header\n",
];

/// Largest input tried, in bytes.
const MOST: usize = 1 << 16;

/// One of `seeds`, broken in one to eight ways.
pub fn broken(rng: &mut Rng, seeds: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = rng.pick(seeds).clone();
    for _ in 0..=rng.below(8) {
        break_once(rng, &mut bytes, seeds);
    }
    bytes.truncate(MOST);
    bytes
}

fn break_once(rng: &mut Rng, bytes: &mut Vec<u8>, seeds: &[Vec<u8>]) {
    let at = rng.below(bytes.len() + 1);
    let end = (at + 1 + rng.below(64)).min(bytes.len());
    match rng.below(11) {
        0 => overwrite(bytes, at, &[rng.bits() as u8]),
        1 => {
            let bit = 1 << rng.below(8);
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= bit;
            }
        }
        2 => overwrite(bytes, at & !3, &rng.pick(&WORDS).to_le_bytes()),
        3 => overwrite(bytes, at, &rng.pick(&WORDS).to_be_bytes()),
        4 => overwrite(bytes, at & !3, &rng.number().to_le_bytes()),
        5 => bytes.truncate(at),
        6 => drop(bytes.drain(at..end)),
        7 => {
            let again = bytes[at..end].to_vec();
            let times = 1 + rng.below(40);
            drop(bytes.splice(at..at, again.repeat(times)));
        }
        8 => drop(bytes.splice(at..at, rng.pick(&TOKENS).bytes())),
        9 => {
            // A token of the text for another.
            let blank = |b: &u8| b.is_ascii_whitespace();
            let from = bytes[..at].iter().rposition(blank).map_or(0, |i| i + 1);
            let to = at + bytes[at..].iter().position(blank).unwrap_or(0);
            drop(bytes.splice(from..to.max(from), rng.pick(&TOKENS).bytes()));
        }
        _ => {
            let other = rng.pick(seeds);
            let from = rng.below(other.len() + 1);
            bytes.truncate(at);
            bytes.extend(&other[from..]);
        }
    }
}

fn overwrite(bytes: &mut [u8], at: usize, with: &[u8]) {
    for (byte, new) in bytes.iter_mut().skip(at).zip(with) {
        *byte = *new;
    }
}
