#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test, whole runs on 2 ranks among them.
# Usage: jobs/test.sh [ctest options, e.g. -L unit]
# IMPINGE_PRESET=sanitize jobs/test.sh runs them with sanitizers; also: assertions, debug, ci.
set -euo pipefail
cd "$(dirname "$0")/.."
. jobs/common.sh

set_up
ctest --preset "$preset" --parallel 2 "$@"
