#!/usr/bin/env bash
# The GPU tests once more on SwiftShader, a second driver: tests/gpu/swiftshader.sh [ICD.json]
# Without an argument the driver that comes with Debian's package `chromium` is taken. Fails where there
# is none, and when a test fails; further arguments go to the tests.
set -euo pipefail
cd "$(dirname "$0")/../.."
icd=${1:-/usr/lib/chromium/vk_swiftshader_icd.json}
shift || true
test -f "$icd" || { echo "no driver at $icd: apt-get install chromium" >&2; exit 1; }
VK_DRIVER_FILES=$icd VK_ICD_FILENAMES=$icd MEDIAL_REQUIRE_GPU=1 \
  cargo test --all-features --test gpu -- --nocapture "$@" | tee target/swiftshader.txt
# Another driver in its place would show nothing new.
grep -q SwiftShader target/swiftshader.txt || { echo 'not run on SwiftShader' >&2; exit 1; }
