#!/usr/bin/env bash
# Starts the viewer without a display and a GPU, steps, and takes a picture of its window:
#   viewer/screenshot.sh [PICTURE [options of the viewer ...]]
# Installs what it needs on Debian: Xvfb, Mesa's software Vulkan, ImageMagick.
set -euo pipefail
cd "$(dirname "$0")"
picture=$(realpath -m "${1:-target/viewer.png}")
shift || true
needs=(xvfb mesa-vulkan-drivers libvulkan1 imagemagick libx11-xcb1 libxkbcommon-x11-0 libxcursor1 libxi6)
if ! dpkg -s "${needs[@]}" >/dev/null 2>&1; then
  apt-get update && apt-get install -y "${needs[@]}"
fi
cargo build --release
mkdir -p "$(dirname "$picture")"

log=$(mktemp)
coproc display { exec Xvfb -displayfd 1 -screen 0 1280x800x24 -nolisten tcp 2>/dev/null; }
screen=$display_PID
read -r number <&"${display[0]}"
export DISPLAY=":$number" VK_ICD_FILENAMES=${VK_ICD_FILENAMES:-/usr/share/vulkan/icd.d/lvp_icd.x86_64.json}
viewer=
trap 'kill $viewer $screen 2>/dev/null || true; rm -f "$log"' EXIT
"${CARGO_TARGET_DIR:-target}/release/medial-viewer" --steps 150 "$@" >"$log" 2>&1 &
viewer=$!
for _ in $(seq 600); do
  grep -q '^ready' "$log" && break
  kill -0 "$viewer" 2>/dev/null || { cat "$log" >&2; exit 1; }
  sleep 1
done
grep '^ready' "$log" || { echo 'the viewer did not get ready' >&2; cat "$log" >&2; exit 1; }
import -window root "$picture"
echo "$picture"
