#!/usr/bin/env bash
# Makes the pictures of README, guide and hard-scenes.md again, and those of three more examples:
# bash docs/images/make.sh
set -euo pipefail
cd "$(dirname "$0")/../.."
cargo run --release --example falling_rings -- --out docs/images --animate
cargo run --release --features cli --bin medial -- compare -o docs/images/compare.png
for name in convex_hull_comparison chain nut_and_bolt factory; do
  cargo run --release --example "$name" -- --out docs/images
done
