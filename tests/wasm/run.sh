#!/usr/bin/env bash
# The golden of tests/scenes/determinism.rs, run as WebAssembly by Node.js.
set -euo pipefail
cd "$(dirname "$0")"
rustup target add wasm32-unknown-unknown
cargo build --release --target wasm32-unknown-unknown --target-dir ../../target/wasm
node run.mjs ../../target/wasm/wasm32-unknown-unknown/release/wasm-golden.wasm
