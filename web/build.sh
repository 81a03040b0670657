#!/usr/bin/env bash
# Makes the page in web/target/site: the crate as WebAssembly, meshes baked by it, and the files of site/.
# Wants a Rust toolchain and Node.js.
set -euo pipefail
cd "$(dirname "$0")"
rustup target add wasm32-unknown-unknown
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/target}
cargo build --release --lib --target wasm32-unknown-unknown
mkdir -p target/site
cargo run --quiet --manifest-path bindgen/Cargo.toml -- \
  "$CARGO_TARGET_DIR"/wasm32-unknown-unknown/release/medial_web.wasm target/site
if [ ! -f target/site/creature.medial ]; then
  node bake.mjs target/site
fi
cp site/* target/site/
