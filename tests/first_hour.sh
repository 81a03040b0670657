#!/usr/bin/env bash
# A new user's first hour, replayed: the README's package in an empty folder, in a debug build, and the commands of
# README and guide as printed there, each of which has to print something within five seconds of its start. Needs a
# Rust toolchain and `script` (util-linux), which stands for a terminal.
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

# run COMMAND: runs it in $work as in a terminal; its first output, after cargo's own lines, must come soon.
run() {
  echo "\$ $1"
  local command=${1/cargo run/cargo run --manifest-path "$repo/Cargo.toml"} built start first=
  # What cargo builds is not part of the time.
  case $command in
    cargo\ run*) built=${command/cargo run/cargo build --quiet}; ( cd "$work" && eval "${built%% -- *}" ) ;;
  esac
  : > "$work/told"
  start=$(date +%s%N)
  ( cd "$work" && exec script --quiet --return --flush --command "$command" /dev/null ) < /dev/null > "$work/told" &
  local pid=$!
  while kill -0 $pid 2> /dev/null && [ -z "$first" ]; do
    grep -qavE 'Finished|Running|Blocking|^[[:space:]]*$' "$work/told" && first=$(( ($(date +%s%N) - start) / 1000000 ))
    sleep 0.02
  done
  wait $pid || { cat "$work/told"; echo "fails: $1"; exit 1; }
  tr '\r' '\n' < "$work/told" | grep -avE 'Finished|Running|Blocking|\?25|█|^[[:space:]]*$' | tail -n 12 || true
  echo "first output after ${first:-0} ms, the end after $(( ($(date +%s%N) - start) / 1000000 )) ms"
  [ "${first:-0}" -lt 5000 ] || { echo "no output within five seconds: $1"; exit 1; }
}

# commands FILE: the lines of its blocks, and the passages in backticks, that call the program or an example.
commands() {
  sed -n '/^cargo run --release/p' "$1"
  grep -oE '`(cargo run --release|medial) [^`]*`' "$1" | tr -d '`' | grep -E ' (body|my)\.(obj|medial)' || true
}

say 'the commands of README and guide'
# A body: a frame of square section.
awk 'BEGIN {
  for (z = -0.1; z < 0.2; z += 0.2) for (r = 0.5; r > 0.2; r -= 0.2) {
    print "v", -r, -r, z; print "v", r, -r, z; print "v", r, r, z; print "v", -r, r, z
  }
  for (k = 1; k <= 4; k++) { n = k % 4 + 1
    print "f", k, k+4, n+4, n; print "f", k+8, n+8, n+12, k+12; print "f", k, n, n+8, k+8; print "f", k+4, k+12, n+12, n+4
  } }' > "$work/body.obj"
cp "$work/body.obj" "$work/my.obj"
cargo build --quiet --release --features cli --bin medial --manifest-path "$repo/Cargo.toml"
PATH="${CARGO_TARGET_DIR:-$repo/target}/release:$PATH"
{ commands "$repo/docs/guide.md"; commands "$repo/README.md" | grep -v -- '--example'; } > "$work/commands"
[ "$(wc -l < "$work/commands")" -ge 5 ] || { echo 'README and guide have fewer commands than they had'; exit 1; }
while read -r command <&3; do run "$command"; done 3< "$work/commands"

if [ "${1:-}" = --all ]; then
  say 'the examples of the README'
  # The main one, as a command, and those of the table, by name.
  {
    commands "$repo/README.md" | grep -- '--example'
    sed -n '/^| name | shows |/,/^$/p' "$repo/README.md" | grep -oE '^\|( `[^`]*`,?)+' | grep -oE '`[^`]*`' | tr -d '`' |
      sed 's/^/cargo run --release --example /; s/FILE/body.obj/'
  } > "$work/examples"
  while read -r command <&3; do run "$command"; done 3< "$work/examples"
fi
say done
