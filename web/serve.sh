#!/usr/bin/env bash
# Builds the page and serves it: http://localhost:8080, or another port as argument. Wants Node.js.
set -euo pipefail
cd "$(dirname "$0")"
bash build.sh
node serve.mjs target/site "${1:-8080}"
