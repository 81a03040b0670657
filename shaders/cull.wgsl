// Mesh pairs that stay free, in two stages. Source: the walk of src/pair/search.rs, in no order,
// because all that meets has to be looked at. A thread walks down both sphere trees with a stack of its
// own, and takes its next mesh pair when it is done with one: neighbours that run in step do not
// wait for the longest walk. Then a thread each proves the primitive pairs whose balls meet. What finds no
// room, or takes too long, is given up, and the CPU has the pair: nothing is cut.

@group(0) @binding(0) var<uniform> params: CullParams;
@group(0) @binding(1) var<storage, read> pairs: array<Pair>;
@group(0) @binding(2) var<storage, read> nodes: array<Node>;
@group(0) @binding(3) var<storage, read> primitives: array<Primitive>;
@group(0) @binding(4) var<storage, read_write> meetings: array<Meeting>;
// What is known of each pair; last how many primitive pairs meet, and how many mesh pairs are taken.
@group(0) @binding(5) var<storage, read_write> answers: array<atomic<u32>>;

// From below, what is still to be looked at: on either side a node, or two neighbours where its index is
// marked so. From above, primitive pairs whose balls meet.
var<private> work: array<vec2<u32>, WALK_ROOM>;
var<private> open: u32;
var<private> kept: u32;

// The mark of two neighbours; in a node's `below`, that of a leaf.
const MARK = 0x80000000u;

struct Part { swept: Swept, radius: f32, index: u32, below: u32 }

fn part(side: Side, index: u32) -> Part {
  let bound = nodes[index].bound;
  return Part(sweep(side, bound), bound.w, index, nodes[index].below);
}

// Two nodes that meet are to be looked at again: both split where they are about as large, else the
// larger one. One place writes for both outcomes: to write costs as much as to compare.
fn consider(wanted: bool, p: Part, q: Part, reach: f32) {
  let met = wanted && meet(p.swept, q.swept, reach);
  let p_leaf = p.below >= MARK;
  let q_leaf = q.below >= MARK;
  let leaves = p_leaf && q_leaf;
  let split = vec2<bool>(
    leaves || (!p_leaf && (q_leaf || p.radius * WALK_SIMILAR >= q.radius)),
    leaves || (!q_leaf && (p_leaf || q.radius * WALK_SIMILAR >= p.radius)),
  );
  let next = select(vec2<u32>(p.index, q.index), vec2<u32>(p.below, q.below) ^ vec2<u32>(MARK), split);
  if (met) { work[select(open, WALK_ROOM - 1u - kept, leaves)] = next; }
  open += u32(met && !leaves);
  kept += u32(met && leaves);
}


// Splits the node pair on top.
fn look(a: Side, b: Side, reach: f32) {
  open--;
  let top = work[open];
  let both = top >= vec2<u32>(MARK);
  let first = top & vec2<u32>(MARK - 1u);
  let second = first + select(vec2<u32>(0u), vec2<u32>(1u), both);
  let p0 = part(a, first.x);
  let q0 = part(b, first.y);
  let p1 = part(a, second.x);
  let q1 = part(b, second.y);
  consider(true, p0, q0, reach);
  consider(both.x, p1, q0, reach);
  consider(both.y, p0, q1, reach);
  consider(both.x && both.y, p1, q1, reach);
}

// Hands the primitive pairs of a mesh pair on. What fits is written in any case: room that is counted and
// not written would hold pairs of the batch before.
fn hand_on(pair: u32, whole: bool) {
  kept = select(0u, kept, whole);
  let at = atomicAdd(&answers[params.pairs], kept);
  for (var k = 0u; k < kept && at + k < params.room; k++) {
    meetings[at + k] = Meeting(work[WALK_ROOM - 1u - k], pair, 0u);
  }
  atomicStore(&answers[pair], select(GIVEN_UP, FREE, whole && at + kept <= params.room));
}

@compute @workgroup_size(WALKS)
fn walk() {
  var pair = params.pairs;
  var a: Side;
  var b: Side;
  var reach = 0.0;
  var looks = 0u;
  var whole = true;
  loop {
    if (open == 0u) {
      if (pair < params.pairs) { hand_on(pair, whole); }
      pair = atomicAdd(&answers[params.pairs + 1u], 1u);
      if (pair >= params.pairs) { break; }
      a = pairs[pair].sides[0];
      b = pairs[pair].sides[1];
      reach = pairs[pair].reach;
      work[0] = vec2<u32>(a.root, b.root);
      open = 1u;
      kept = 0u;
      looks = 0u;
      whole = true;
    }
    // A few before the next look whether it is done: that is checked for all neighbours at once.
    for (var k = 0u; k < WALK_STRETCH && open > 0u; k++) {
      looks++;
      whole = open + kept + 4u <= WALK_ROOM && looks <= WALK_LOOKS;
      if (whole) { look(a, b, reach); } else { open = 0u; }
    }
  }
}

// Of a mesh pair that is given up, or of which one primitive pair is not proven, the others are skipped.
@compute @workgroup_size(WALKS)
fn prove(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
  let count = min(atomicLoad(&answers[params.pairs]), params.room);
  for (var k = id.x + id.y * groups.x * WALKS; k < count; k += groups.x * groups.y * WALKS) {
    let met = meetings[k];
    if (atomicLoad(&answers[met.pair]) != FREE) { continue; }
    let a = simplex(pairs[met.pair].sides[0], met.primitives.x);
    let b = simplex(pairs[met.pair].sides[1], met.primitives.y);
    if (!stays_free(a, b, pairs[met.pair].reach)) { atomicMax(&answers[met.pair], OPEN); }
  }
}
