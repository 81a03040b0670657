// Primitive pairs that may come within reach, of many mesh pairs, in two stages. Source: the walk of
// src/pair/search.rs, in no order, because all that meets has to be looked at. A thread walks down both
// sphere trees with a stack of its own, and takes its next mesh pair when it is done with one: neighbours
// that run in step do not wait for the longest walk. Then a thread each proves the primitive pairs whose
// balls meet, or lists them. What finds no room, or takes too long, is given up, and the CPU has the pair:
// nothing is cut. src/batch/gpu/near.rs reads the list and counts it.

@group(0) @binding(0) var<uniform> params: CullParams;
@group(0) @binding(1) var pairs: texture_2d<u32>;
@group(0) @binding(2) var nodes: texture_2d<u32>;
@group(0) @binding(3) var primitives: texture_2d<u32>;
// Primitive pairs whose balls meet: both indices, that of the mesh pair, and the batch's stamp. An entry without the
// stamp is of a batch before.
@group(0) @binding(4) var<storage, read_write> meetings: array<vec4<u32>>;
// Primitive pairs that are not proven free, in no order.
@group(0) @binding(5) var<storage, read_write> near: array<vec4<u32>>;
// Answer of each mesh pair: 0 before, FREE and how many primitive pairs are not proven free, or OPEN; last how many primitive
// pairs meet, how many mesh pairs are taken, and how many primitive pairs are listed.
@group(0) @binding(6) var<storage, read_write> answers: array<atomic<u32>>;

// The first of two neighbouring nodes on either side; which of their four pairs are left to be looked at
// is in the highest bits of its own. One node that was not split is the first with a neighbour that never
// meets.
var<private> first: vec2<u32>;
var<private> left: u32;
// Stack, from below, of such pairs that wait, with what is left of each; from above, primitive pairs whose balls
// meet. The place for the next of either is written whether or not there is one.
var<private> work: array<vec2<u32>, WALK_ROOM>;
var<private> open: u32;
var<private> kept: u32;
// Number of primitive pairs of this mesh pair that were handed on.
var<private> handed_on: u32;

// Mark of a leaf in a node's `below`.
const MARK = 0x80000000u;

// Place in an index of the highest bits, which keep what is left: fewer nodes than that fit the texture.
const LEFT = 28u;

fn side(pair: u32, k: u32) -> Side {
  let at = pair * PAIR + k * SIDE;
  return Side(three(pairs, at), three(pairs, at + 3u), reals(pairs, at + 6u));
}

// Roots, bits of the reach, and whether there is to be a list.
fn roots(pair: u32) -> vec4<u32> { return texel(pairs, pair * PAIR + 2u * SIDE); }

fn ball(side: Side, node: u32) -> Swept { return sweep(side, reals(nodes, node * NODE)); }

fn primitive(side: Side, index: u32) -> Simplex {
  let spheres = three(primitives, index * PRIMITIVE);
  return Simplex(sweep(side, spheres[0]), sweep(side, spheres[1]), sweep(side, spheres[2]));
}

// Takes the next pair of nodes and looks which of their children meet: both nodes are split where they
// are about as large, else the larger one. Two leaves are kept.
fn look(a: Side, b: Side, reach: f32) {
  if (left == 0u) {
    open--;
    let top = work[open];
    left = top.x >> LEFT;
    first = vec2<u32>(top.x & ((1u << LEFT) - 1u), top.y);
  }
  let next = firstTrailingBit(left);
  left &= left - 1u;
  let index = first + vec2<u32>(next & 1u, next >> 1u);
  let p = texel(nodes, index.x * NODE + 1u);
  let q = texel(nodes, index.y * NODE + 1u);
  let below = vec2<u32>(p.x, q.x);
  let radius = bitcast<vec2<f32>>(vec2<u32>(p.y, q.y));
  let leaf = below >= vec2<u32>(MARK);
  let leaves = leaf.x && leaf.y;
  let split = vec2<bool>(
    !leaf.x && (leaf.y || radius.x * WALK_SIMILAR >= radius.y),
    !leaf.y && (leaf.x || radius.y * WALK_SIMILAR >= radius.x),
  );
  let parts = select(index, below, split);
  let p0 = ball(a, parts.x);
  let q0 = ball(b, parts.y);
  let p1 = ball(a, parts.x + u32(split.x));
  let q1 = ball(b, parts.y + u32(split.y));
  var met = u32(meet(p0, q0, reach));
  met += u32(split.x && meet(p1, q0, reach)) << 1u;
  met += u32(split.y && meet(p0, q1, reach)) << 2u;
  met += u32(split.x && split.y && meet(p1, q1, reach)) << 3u;
  let deeper = met != 0u && !leaves;
  // One place for both: to write costs as much as to compare.
  let wait = vec2<u32>(first.x | (left << LEFT), first.y);
  work[select(open, WALK_ROOM - 1u - kept, leaves)] = select(wait, below ^ vec2<u32>(MARK), leaves);
  open += u32(deeper && left != 0u);
  kept += u32(leaves);
  if (deeper) {
    first = parts;
    left = met;
  }
}

// Hands the primitive pairs found so far on; returns whether there was room for all.
fn hand_on(pair: u32) -> bool {
  let at = atomicAdd(&answers[params.pairs], kept);
  var k = 0u;
  for (; k < kept && at + k < params.room; k++) {
    meetings[at + k] = vec4<u32>(work[WALK_ROOM - 1u - k], pair, params.stamp);
  }
  let all = k == kept;
  handed_on += kept;
  kept = 0u;
  return all;
}

@compute @workgroup_size(WALKS)
fn walk() {
  var pair = params.pairs;
  var a: Side;
  var b: Side;
  var reach = 0.0;
  var lists = false;
  var looks = 0u;
  var whole = true;
  var taken = 0u;
  loop {
    if (left == 0u && open == 0u) {
      if (pair < params.pairs) {
        whole = hand_on(pair) && whole;
        atomicStore(&answers[pair], select(GIVEN_UP, FREE + handed_on, whole));
      }
      taken++;
      if (taken > WALK_PAIRS) { break; }
      pair = atomicAdd(&answers[params.pairs + 1u], 1u);
      if (pair >= params.pairs) { break; }
      a = side(pair, 0u);
      b = side(pair, 1u);
      let last = roots(pair);
      reach = bitcast<f32>(last.z);
      lists = last.w != 0u;
      first = last.xy;
      left = 1u;
      handed_on = 0u;
      looks = 0u;
      whole = true;
    }
    // A few before the next look whether it is done: that is checked for all neighbours at once.
    for (var k = 0u; k < WALK_STRETCH && (left | open) != 0u; k++) {
      looks++;
      whole = open + kept < WALK_ROOM && looks <= select(FIRST_LOOKS, WALK_LOOKS, lists);
      if (whole) { look(a, b, reach); } else { left = 0u; open = 0u; }
    }
    if (open + kept + WALK_STRETCH >= WALK_ROOM) {
      let all = hand_on(pair);
      if (!all || handed_on > select(FIRST_FINDS, WALK_FINDS, lists)) { whole = false; left = 0u; open = 0u; }
    }
  }
}

// Each proof brings the mesh pair's answer nearer to FREE; what is not proven is listed. So the answer says how
// many have to be on the list: a proof that was never begun, or an entry that found no room, is missed there. Without
// a list the first that is not proven decides, and the others are skipped.
@compute @workgroup_size(WALKS)
fn prove(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
  let count = min(atomicLoad(&answers[params.pairs]), params.room);
  for (var k = id.x + id.y * groups.x * WALKS; k < count; k += groups.x * groups.y * WALKS) {
    let met = meetings[k];
    let pair = met.z;
    if (met.w != params.stamp || atomicLoad(&answers[pair]) - FREE > WALK_FINDS + WALK_ROOM) { continue; }
    let last = roots(pair);
    let a = primitive(side(pair, 0u), met.x);
    let b = primitive(side(pair, 1u), met.y);
    if (stays_free(a, b, bitcast<f32>(last.z))) {
      atomicSub(&answers[pair], 1u);
    } else if (last.w == 0u) {
      atomicMax(&answers[pair], OPEN);
    } else {
      let at = atomicAdd(&answers[params.pairs + 2u], 1u);
      if (at < params.near_room) { near[at] = vec4<u32>(met.xy, pair, params.stamp); }
    }
  }
}
