#!/usr/bin/env bash
# Builds the page and tests it in a headless Chromium; pictures go to web/target/pictures. Wants Node.js and
# chromium (or the program that CHROMIUM names).
set -euo pipefail
cd "$(dirname "$0")"
bash build.sh
node test/page.mjs target/site target/pictures
