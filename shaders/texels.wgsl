// Records in textures of four words a texel, row after row, as src/batch/gpu/texels.rs writes them. Neighbouring
// threads read different ones.
// Whole texels with no test of a bound come at a few times the speed of a storage buffer's words on
// lavapipe, which fetches those thread by thread. On no real GPU has it been measured.

fn texel(records: texture_2d<u32>, at: u32) -> vec4<u32> {
  return textureLoad(records, vec2<u32>(at % TEXELS, at / TEXELS), 0);
}

fn reals(records: texture_2d<u32>, at: u32) -> vec4<f32> { return bitcast<vec4<f32>>(texel(records, at)); }

fn three(records: texture_2d<u32>, at: u32) -> array<vec4<f32>, 3> {
  return array<vec4<f32>, 3>(reals(records, at), reals(records, at + 1u), reals(records, at + 2u));
}
