#!/usr/bin/env bash
# A new user's first hour, replayed: the README's package in an empty folder, in a debug build, and every command of
# the README and the guide as printed there. Needs what the README says: a Rust toolchain.
#
#   bash tests/first_hour.sh            the package and the command line
#   bash tests/first_hour.sh --all      the README's examples as well (minutes)
set -euo pipefail
repo=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
say() { printf '\n== %s\n' "$*"; }

# block FILE LANGUAGE N: the N-th fenced block of that language.
block() {
  awk -v want="$2" -v n="$3" '
    /^```/ { if (inside) { inside = 0 } else { inside = 1; hit = ($0 == "```" want) && ++seen == n }; next }
    inside && hit' "$1"
}

say 'the package of the README, from nothing'
cargo new --quiet --vcs none "$work/game"
block "$repo/README.md" toml 1 | sed "s|\.\./rapier3d-medial|$repo|" > "$work/add"
sed -i '/^\[dependencies\]/d' "$work/game/Cargo.toml"
cat "$work/add" >> "$work/game/Cargo.toml"
block "$repo/README.md" rust 1 > "$work/game/src/main.rs"
cargo build --quiet --manifest-path "$work/game/Cargo.toml" --target-dir "$repo/target/first_hour"
start=$(date +%s%N)
( cd "$work/game" && timeout 20 "$repo/target/first_hour/debug/game" ) > "$work/told" 2> "$work/progress" &
pid=$!
for _ in $(seq 100); do
  [ -s "$work/progress" ] && break
  sleep 0.01
done
first=$(( ($(date +%s%N) - start) / 1000000 ))
[ -s "$work/progress" ] || { echo "no progress within a second"; exit 1; }
wait $pid || { echo "the README's program fails, or takes more than 20 s"; exit 1; }
echo "progress after $first ms, the end after $(( ($(date +%s%N) - start) / 1000000 )) ms:"
cat "$work/told"
grep -q 'it rests at' "$work/told"

say 'the commands of the guide'
# A body: a frame of square section.
awk 'BEGIN {
  for (z = -0.1; z < 0.2; z += 0.2) for (r = 0.5; r > 0.2; r -= 0.2) {
    print "v", -r, -r, z; print "v", r, -r, z; print "v", r, r, z; print "v", -r, r, z
  }
  for (k = 1; k <= 4; k++) { n = k % 4 + 1
    print "f", k, k+4, n+4, n; print "f", k+8, n+8, n+12, k+12; print "f", k, n, n+8, k+8; print "f", k+4, k+12, n+12, n+4
  } }' > "$work/body.obj"
cargo build --quiet --release --features cli --bin medial --manifest-path "$repo/Cargo.toml"
medial="${CARGO_TARGET_DIR:-$repo/target}/release/medial"
{
  sed -n 's/^cargo run --release --features cli --bin medial -- //p' "$repo/docs/guide.md"
  grep -o '`medial [^`]*body\.obj[^`]*`' "$repo/docs/guide.md" | sed 's/`medial \(.*\)`/\1/'
} |
  while read -r arguments; do
    echo "medial $arguments"
    ( cd "$work" && eval "\"$medial\" $arguments" )
  done

if [ "${1:-}" = --all ]; then
  say 'the commands of the README'
  grep -h '^cargo run --release --example' "$repo/README.md" |
    while read -r command; do
      echo "$command"
      ( cd "$repo" && eval "$command" )
    done
fi
say done
