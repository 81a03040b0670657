#!/usr/bin/env bash
# The league: installs the other engines under target/league, runs the same scenes on all, and judges them.
#
#   bash benches/league/run.sh           all scenes
#   bash benches/league/run.sh --quick   a few short ones: whether everything runs
#
# An engine that cannot be installed is named and left out. Needs Rust; Python 3 and Node.js for the others.
set -euo pipefail
cd "$(dirname "$0")/../.."
source=$PWD/benches/league
out=$PWD/target/league
rm -rf "$out/runs"
mkdir -p "$out/runs"

bench() { cargo bench --quiet --bench league -- "$@"; }
say() { printf '\n== %s\n' "$*" >&2; }

# engine NAME LOG PACKAGE COMMAND...: runs an engine's program where its package, a folder under $out, is there.
engine() {
  local name=$1 log=$2 package=$3
  shift 3
  if ! compgen -G "$out/$package" > /dev/null; then
    say "$name is missing and left out (see $out/$log)"
  elif ! (cd "$out" && "$@" "$out/scenes.json" "$out/runs"); then
    say "$name failed and is left out"
  fi
}

say 'installing'
rm -f "$out"/*.log
[ -d "$out/venv" ] || python3 -m venv "$out/venv" >> "$out/pip.log" 2>&1 || true
for package in mujoco-core==4.0.0 pybullet==3.2.7; do
  "$out/venv/bin/pip" install --quiet "$package" >> "$out/pip.log" 2>&1 || true
done
for package in jolt-physics@1.1.0 physx-js-webidl@2.7.3; do
  npm install --silent --no-audit --no-fund --prefix "$out" "$package" >> "$out/npm.log" 2>&1 || true
done
# JavaScript finds its packages beside its files.
cp "$source"/*.mjs "$out"

say 'scenes'
bench scenes "$@"
say "running, load $(cut -d' ' -f1-3 /proc/loadavg)"
bench run
python=$out/venv/bin/python
packages='venv/lib/python*/site-packages'
engine MuJoCo pip.log "$packages/mujoco" "$python" "$source/in_mujoco.py"
engine Bullet pip.log "$packages/pybullet*.so" "$python" "$source/in_bullet.py"
engine Jolt npm.log node_modules/jolt-physics node in_jolt.mjs
engine PhysX npm.log node_modules/physx-js-webidl node in_physx.mjs
say "judging, load $(cut -d' ' -f1-3 /proc/loadavg), commit $(git rev-parse --short HEAD)"
bench judge
