#!/usr/bin/env bash
# Tests the bevy plugin; `--run` builds and runs its example without a window, `--window` the one with a window.
set -euo pipefail
cd "$(dirname "$0")"
case "${1:-}" in
  --run) cargo run --release --example rings ;;
  --window) shift; cargo run --release --features window --example window -- "$@" ;;
  *) cargo test ;;
esac
