#!/usr/bin/env bash
# Runs the plane jet by Impinge and by OpenFOAM's interFoam, one core each, one after the other, and measures both alike:
# accuracy against CPU time. Installs Debian's openfoam where it is missing (150 MB, with its libraries).
# Usage: jobs/peers.sh [H/DX...]
#   H/DX   particles or cells across the jet; default 10 20 40 (20 minutes)
# Variables: ANGLES (default "60,30").
# Output: output/peers/table.md, peers.png, and the runs. A run that is finished is not run again.
set -euo pipefail
cd "$(dirname "$0")/.."
. jobs/common.sh

resolutions_of "10 20 40" "$@" || {
  sed -n '2,8s/^# //p' "$0" >&2
  exit 2
}
set_up
jobs/install.sh --peers

root=output/peers
mkdir -p "$root"
/usr/bin/python3 jobs/peers.py "$bin" "$root" "${ANGLES:-60,30}" "${resolutions[@]}" | tee "$root/table.md"
