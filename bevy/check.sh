#!/usr/bin/env bash
# Compiles the bevy example without building it; `--run` builds and runs it.
set -euo pipefail
cd "$(dirname "$0")"
if [ "${1:-}" = --run ]; then
  cargo run --release
else
  cargo check
fi
