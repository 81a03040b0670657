#!/usr/bin/env bash
# GPU tests and benches on the machine at hand, from a clean clone with a Rust toolchain and a driver:
#   benches/gpu_figures.sh [OUT.json]
# Writes the figures as one JSON, by default benches/results/ADAPTER.json. Fails without an adapter, and
# when a test fails. For another driver than the default one, set VK_DRIVER_FILES, as for SwiftShader:
#   VK_DRIVER_FILES=/usr/lib/chromium/vk_swiftshader_icd.json benches/gpu_figures.sh swiftshader.json
set -euo pipefail
out=${1:+$(realpath -m "$1")}
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

MEDIAL_REQUIRE_GPU=1 cargo test --release --features gpu --test gpu 2>&1 | tee "$work/tests.txt"
for features in gpu gpu,parallel; do
  cargo bench --features "$features" --bench gpu_batch -- --json "$work/$features.json" | tee "$work/$features.txt"
  test -s "$work/$features.json" || { echo 'no figures: no adapter?' >&2; exit 1; }
done
cargo bench --features gpu --bench gpu_host -- --json "$work/host.json" | tee "$work/host.txt"

field() { sed -n "s/^  \"$1\": \"\(.*\)\",\?$/\1/p" "$work/gpu.json"; }
if [ -z "$out" ]; then
  mkdir -p benches/results
  out=benches/results/$(field adapter | tr -cs 'A-Za-z0-9\n' '-' | sed 's/-$//').json
fi
tests=$(sed -n 's/^test result: ok\. \([0-9]*\) passed.*/\1/p' "$work/tests.txt")
{
  printf '{\n"commit": "%s",\n"date": "%s",\n"tests_passed": %s,\n' \
    "$(git describe --always --dirty)" "$(date -u +%F)" "$tests"
  printf '"serial": %s,\n"parallel": %s,\n' "$(cat "$work/gpu.json")" "$(cat "$work/gpu,parallel.json")"
  printf '"host": %s\n}\n' "$(cat "$work/host.json")"
} > "$out"
echo "$out"
