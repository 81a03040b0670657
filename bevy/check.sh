#!/usr/bin/env bash
# Tests the bevy plugin; `--run` builds and runs its example.
set -euo pipefail
cd "$(dirname "$0")"
if [ "${1:-}" = --run ]; then
  cargo run --release --example rings
else
  cargo test
fi
