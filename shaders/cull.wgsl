// Mesh pairs to primitive pairs, in three stages: clusters whose bounds meet, primitives of those
// whose bounds meet, and of these the ones that are not proven free. Lists that overflow are counted
// in full, never cut silently: the host grows them and asks again.

@group(0) @binding(0) var<uniform> params: CullParams;
@group(0) @binding(1) var<storage, read> pairs: array<Pair>;
@group(0) @binding(2) var<storage, read> clusters: array<Cluster>;
@group(0) @binding(3) var<storage, read> primitives: array<Primitive>;
@group(0) @binding(4) var<storage, read_write> counters: array<atomic<u32>>;
@group(0) @binding(5) var<storage, read_write> tiles: array<Tile>;
@group(0) @binding(6) var<storage, read_write> near: array<Tile>;
@group(0) @binding(7) var<storage, read_write> survivors: array<Survivor>;
@group(0) @binding(8) var<storage, read_write> dispatch: array<u32>;

// The pair of a group, once for all its threads: what they read in step costs one reading.
var<workgroup> placed: array<Side, 2>;
var<workgroup> reach: f32;
// Of each side what may meet anything of the other.
var<workgroup> kept: array<array<Swept, 64>, 2>;
var<workgroup> kept_index: array<array<u32, 64>, 2>;
var<workgroup> kept_count: array<atomic<u32>, 2>;

fn fetch(pair: u32, lane: u32) {
  if (lane < 2u) {
    placed[lane] = pairs[pair].sides[lane];
    atomicStore(&kept_count[lane], 0u);
  }
  if (lane == 0u) { reach = pairs[pair].reach; }
}

fn keep(side: u32, index: u32, swept: Swept) {
  let k = atomicAdd(&kept_count[side], 1u);
  kept[side][k] = swept;
  kept_index[side][k] = index;
}

// The pair that a group belongs to: the last whose first group is not after it.
fn pair_of(group: u32) -> u32 {
  var low = 0u;
  var high = params.pairs;
  while (high - low > 1u) {
    let middle = (low + high) / 2u;
    if (pairs[middle].first <= group) { low = middle; } else { high = middle; }
  }
  return low;
}

// One group for each 64 clusters of a pair's first mesh, against all of its second, 64 at a time.
// Clusters that miss the other mesh's ball are gone before they are paired.
@compute @workgroup_size(64)
fn cull_clusters(@builtin(workgroup_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
  let group = id.x + id.y * groups.x;
  let live = group < params.groups;
  let pair = pair_of(min(group, params.groups - 1u));
  let others = select(0u, pairs[pair].sides[1].clusters, live);
  fetch(pair, lane);
  workgroupBarrier();
  let a = placed[0];
  let b = placed[1];
  let within = reach;
  let whole_a = sweep(a, a.bound);
  let whole_b = sweep(b, b.bound);
  let own = (group - pairs[pair].first) * 64u + lane;
  if (live && own < a.clusters) {
    let swept = sweep(a, clusters[a.first_cluster + own].bound);
    if (meet(swept, whole_b, within)) { keep(0u, a.first_cluster + own, swept); }
  }
  for (var base = 0u; base < others; base += 64u) {
    if (base + lane < others) {
      let index = b.first_cluster + base + lane;
      let swept = sweep(b, clusters[index].bound);
      if (meet(whole_a, swept, within)) { keep(1u, index, swept); }
    }
    workgroupBarrier();
    let rows = atomicLoad(&kept_count[0]);
    let columns = atomicLoad(&kept_count[1]);
    for (var i = lane >> 3u; i < rows; i += 8u) {
      let row = kept[0][i];
      for (var j = lane & 7u; j < columns; j += 8u) {
        if (meet(row, kept[1][j], within)) {
          let k = atomicAdd(&counters[TILES], 1u);
          if (k < params.tile_capacity) { tiles[k] = Tile(pair, kept_index[0][i], kept_index[1][j]); }
        }
      }
    }
    workgroupBarrier();
    if (lane == 0u) { atomicStore(&kept_count[1], 0u); }
    workgroupBarrier();
  }
}

// Groups for n items, `each` to a group, folded into two dimensions below the limit of one.
fn set_dispatch(at: u32, n: u32, each: u32) {
  let groups = (n + each - 1u) / each;
  let x = min(groups, MAX_GROUPS);
  dispatch[at] = x;
  dispatch[at + 1u] = (groups + max(x, 1u) - 1u) / max(x, 1u);
  dispatch[at + 2u] = 1u;
}

@compute @workgroup_size(1)
fn arrange_primitives() {
  set_dispatch(0u, min(atomicLoad(&counters[TILES]), params.tile_capacity), 1u);
}

fn chosen_side(second: bool, a: Side, b: Side) -> Side {
  var s = a;
  for (var k = 0u; k < 3u; k++) {
    s.start[k] = select(a.start[k], b.start[k], second);
    s.end[k] = select(a.end[k], b.end[k], second);
  }
  s.turn = select(a.turn, b.turn, second);
  return s;
}

fn chosen_swept(second: bool, a: Swept, b: Swept) -> Swept {
  return Swept(select(a.start, b.start, second), select(a.chord, b.chord, second), select(a.radius, b.radius, second));
}

// One group for each cluster pair. Primitives that miss the other cluster's ball are gone before they
// are paired.
@compute @workgroup_size(64)
fn cull_primitives(@builtin(workgroup_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
  let group = id.x + id.y * groups.x;
  let live = group < min(atomicLoad(&counters[TILES]), params.tile_capacity);
  let tile = tiles[select(0u, group, live)];
  fetch(tile.pair, lane);
  workgroupBarrier();
  let a = placed[0];
  let b = placed[1];
  let within = reach;
  let first = clusters[tile.a];
  let second = clusters[tile.b];
  let whole_a = sweep(a, first.bound);
  let whole_b = sweep(b, second.bound);
  // One half of the threads for each side.
  let is_b = lane >= 32u;
  let other = chosen_swept(is_b, whole_b, whole_a);
  let side = chosen_side(is_b, a, b);
  let start = select(first.first, second.first, is_b);
  let count = select(0u, select(first.count, second.count, is_b), live);
  for (var k = lane & 31u; k < count; k += 32u) {
    let swept = sweep(side, primitives[start + k].bound);
    if (meet(swept, other, within)) { keep(u32(is_b), start + k, swept); }
  }
  workgroupBarrier();
  // Row i, column j: bit j / 8 of byte i / 8 of the thread that has it.
  let rows = atomicLoad(&kept_count[0]);
  let columns = atomicLoad(&kept_count[1]);
  var found = array<u32, 2>(0u, 0u);
  for (var i = lane >> 3u; i < rows; i += 8u) {
    let row = kept[0][i];
    for (var j = lane & 7u; j < columns; j += 8u) {
      if (meet(row, kept[1][j], within)) { found[i >> 5u] |= 1u << ((i & 24u) + (j >> 3u)); }
    }
  }
  let hits = countOneBits(found[0]) + countOneBits(found[1]);
  if (hits == 0u) { return; }
  var k = atomicAdd(&counters[NEAR], hits);
  for (var word = 0u; word < 2u; word++) {
    var bits = found[word];
    while (bits != 0u) {
      let bit = countTrailingZeros(bits);
      bits &= bits - 1u;
      let i = word * 32u + (bit & 24u) + (lane >> 3u);
      let j = (bit & 7u) * 8u + (lane & 7u);
      if (k < params.near_capacity) { near[k] = Tile(tile.pair, kept_index[0][i], kept_index[1][j]); }
      k++;
    }
  }
}

@compute @workgroup_size(1)
fn arrange_proofs() {
  set_dispatch(3u, min(atomicLoad(&counters[NEAR]), params.near_capacity), 64u);
}

@compute @workgroup_size(64)
fn prove(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
  let item = id.x + id.y * groups.x * 64u;
  if (item >= min(atomicLoad(&counters[NEAR]), params.near_capacity)) { return; }
  let n = near[item];
  let lower = free_until(n.pair, n.a, n.b);
  if (lower >= 1.0) { return; }
  let k = atomicAdd(&counters[SURVIVORS], 1u);
  if (k < params.survivor_capacity) {
    survivors[k] = Survivor(n.pair, primitives[n.a].index, primitives[n.b].index, lower);
  }
}
