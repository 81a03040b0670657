// Mesh pairs that stay free: one thread each walks down both sphere trees with a stack of its own, then
// proves the primitive pairs whose balls meet. Source: the walk of src/pair/search.rs, in no order,
// because all that meets has to be looked at. What finds no room, or takes too long, is given up, and
// the CPU has the pair: nothing is cut.

@group(0) @binding(0) var<uniform> params: CullParams;
@group(0) @binding(1) var<storage, read> pairs: array<Pair>;
@group(0) @binding(2) var<storage, read> nodes: array<Node>;
@group(0) @binding(3) var<storage, read> primitives: array<Primitive>;
@group(0) @binding(4) var<storage, read_write> answers: array<u32>;

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

fn answer(pair: u32) -> u32 {
  let a = pairs[pair].sides[0];
  let b = pairs[pair].sides[1];
  let reach = pairs[pair].reach;
  work[0] = vec2<u32>(a.root, b.root);
  open = 1u;
  kept = 0u;
  for (var looks = 0u; open > 0u; looks++) {
    if (open + kept + 4u > WALK_ROOM || looks == WALK_LOOKS) { return GIVEN_UP; }
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
  for (var k = WALK_ROOM - kept; k < WALK_ROOM; k++) {
    if (!stays_free(simplex(a, work[k].x), simplex(b, work[k].y), reach)) { return OPEN; }
  }
  return FREE;
}

@compute @workgroup_size(WALKS)
fn walk(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
  let pair = id.x + id.y * groups.x * WALKS;
  if (pair < params.pairs) { answers[pair] = answer(pair); }
}
