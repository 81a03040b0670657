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

// Of each side what may meet anything of the other, and the whole that it was tested against.
var<workgroup> whole: array<Swept, 2>;
var<workgroup> kept: array<array<Swept, 64>, 2>;
var<workgroup> kept_index: array<array<u32, 64>, 2>;
var<workgroup> kept_count: array<atomic<u32>, 2>;

fn keep(pair: u32, side: u32, index: u32, ball: vec4<f32>) {
  let swept = sweep(pair, side, ball);
  if (!meet(pair, whole[1u - side], swept)) { return; }
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
  if (group >= params.groups) { return; }
  let pair = pair_of(group);
  let first = pairs[pair].sides[0].first_cluster;
  let second = pairs[pair].sides[1].first_cluster;
  let others = pairs[pair].sides[1].clusters;
  let own = (group - pairs[pair].first) * 64u + lane;
  if (lane < 2u) {
    whole[lane] = sweep(pair, lane, pairs[pair].sides[lane].bound);
    atomicStore(&kept_count[lane], 0u);
  }
  workgroupBarrier();
  if (own < pairs[pair].sides[0].clusters) { keep(pair, 0u, first + own, clusters[first + own].bound); }
  for (var base = 0u; base < others; base += 64u) {
    if (base + lane < others) { keep(pair, 1u, second + base + lane, clusters[second + base + lane].bound); }
    workgroupBarrier();
    let rows = atomicLoad(&kept_count[0]);
    let columns = atomicLoad(&kept_count[1]);
    for (var i = lane >> 3u; i < rows; i += 8u) {
      for (var j = lane & 7u; j < columns; j += 8u) {
        if (meet(pair, kept[0][i], kept[1][j])) {
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

// One group for each cluster pair. Primitives that miss the other cluster's ball are gone before they
// are paired.
@compute @workgroup_size(64)
fn cull_primitives(@builtin(workgroup_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
  let group = id.x + id.y * groups.x;
  let live = group < min(atomicLoad(&counters[TILES]), params.tile_capacity);
  let tile = tiles[select(0u, group, live)];
  let a = clusters[tile.a];
  let b = clusters[tile.b];
  if (lane < 2u) {
    whole[lane] = sweep(tile.pair, lane, select(a.bound, b.bound, lane == 1u));
    atomicStore(&kept_count[lane], 0u);
  }
  workgroupBarrier();
  for (var k = select(a.count + b.count, lane, live); k < a.count + b.count; k += 64u) {
    let side = u32(k >= a.count);
    let index = select(a.first + k, b.first + k - a.count, side == 1u);
    keep(tile.pair, side, index, primitives[index].bound);
  }
  workgroupBarrier();
  // Row i, column j: bit j / 8 of byte i / 8 of the thread that has it.
  let rows = atomicLoad(&kept_count[0]);
  let columns = atomicLoad(&kept_count[1]);
  var found = array<u32, 2>(0u, 0u);
  for (var i = lane >> 3u; i < rows; i += 8u) {
    for (var j = lane & 7u; j < columns; j += 8u) {
      if (meet(tile.pair, kept[0][i], kept[1][j])) { found[i >> 5u] |= 1u << ((i & 24u) + (j >> 3u)); }
    }
  }
  let count = countOneBits(found[0]) + countOneBits(found[1]);
  if (count == 0u) { return; }
  var k = atomicAdd(&counters[NEAR], count);
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
