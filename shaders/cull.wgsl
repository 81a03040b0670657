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

// The pair that a cluster pair belongs to: the last whose first cluster pair is not after it.
fn pair_of(item: u32) -> u32 {
  var low = 0u;
  var high = params.pairs;
  while (high - low > 1u) {
    let middle = (low + high) / 2u;
    if (pairs[middle].first <= item) { low = middle; } else { high = middle; }
  }
  return low;
}

@compute @workgroup_size(64)
fn cull_clusters(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
  let item = id.x + id.y * groups.x * 64u;
  if (item >= params.cluster_pairs) { return; }
  let pair = pair_of(item);
  let local = item - pairs[pair].first;
  let width = pairs[pair].sides[1].clusters;
  let i = pairs[pair].sides[0].first_cluster + local / width;
  let j = pairs[pair].sides[1].first_cluster + local % width;
  if (meet(pair, sweep(pair, 0u, clusters[i].bound), sweep(pair, 1u, clusters[j].bound))) {
    let k = atomicAdd(&counters[TILES], 1u);
    if (k < params.tile_capacity) { tiles[k] = Tile(pair, i, j); }
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

var<workgroup> second: array<Swept, 64>;

// One group for each cluster pair, one thread for each primitive of its first cluster.
@compute @workgroup_size(64)
fn cull_primitives(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
  let item = group.x + group.y * groups.x;
  let live = item < min(atomicLoad(&counters[TILES]), params.tile_capacity);
  let tile = tiles[select(0u, item, live)];
  let a = clusters[tile.a];
  let b = clusters[tile.b];
  if (live && lane < b.count) {
    second[lane] = sweep(tile.pair, 1u, primitives[b.first + lane].bound);
  }
  workgroupBarrier();
  if (!live || lane >= a.count) { return; }
  let first = sweep(tile.pair, 0u, primitives[a.first + lane].bound);
  var found = array<u32, 2>(0u, 0u);
  for (var k = 0u; k < b.count; k++) {
    if (meet(tile.pair, first, second[k])) { found[k >> 5u] |= 1u << (k & 31u); }
  }
  let count = countOneBits(found[0]) + countOneBits(found[1]);
  if (count == 0u) { return; }
  var k = atomicAdd(&counters[NEAR], count);
  for (var word = 0u; word < 2u; word++) {
    var bits = found[word];
    while (bits != 0u) {
      let bit = countTrailingZeros(bits);
      bits &= bits - 1u;
      if (k < params.near_capacity) { near[k] = Tile(tile.pair, a.first + lane, b.first + word * 32u + bit); }
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
