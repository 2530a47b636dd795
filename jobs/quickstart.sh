#!/usr/bin/env bash
# From a fresh checkout to a validated jet: installs what is missing, builds, runs input/jet60-quick.toml on 2 ranks,
# measures the result against the analytic jet, draws it, and writes a page to open in a browser. About two minutes after
# the installs.
# Usage: jobs/quickstart.sh
set -euo pipefail
cd "$(dirname "$0")/.."
. jobs/common.sh

set_up
run_mpi 2 "$bin/impinge" input/jet60-quick.toml --set output.directory=output/jet60-quick
"$bin/impinge-validate" output/jet60-quick
"$bin/impinge-report" output/jet60-quick || [ $? -eq 3 ] # 3: packages are missing, on a cluster
