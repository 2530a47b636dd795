#!/usr/bin/env bash
# Fuzzes the readers of case files, snapshots and checkpoints, one after the other, with libFuzzer and sanitizers.
# Usage: tests/fuzz.sh [SECONDS [READER...]]
#   SECONDS  for each reader, default 600
#   READER   case, snapshot, checkpoint; default all
# Output: output/fuzz/<reader>.log, the inputs found in output/fuzz/<reader>/; an input that breaks a reader is
# output/fuzz/<reader>-crash-... (leak, timeout, oom). To keep it, put it into tests/fuzz/corpus/<reader>/.
set -euo pipefail
cd "$(dirname "$0")/.."
export IMPINGE_PRESET=fuzz
. jobs/common.sh

seconds=${1:-600}
readers=("${@:2}")
[ ${#readers[@]} -gt 0 ] || readers=(case snapshot checkpoint)
if ! [[ "$seconds ${readers[*]}" =~ ^[1-9][0-9]*(\ (case|snapshot|checkpoint))+$ ]]; then
  sed -n '2,7s/^# //p' "$0" >&2
  exit 2
fi
jobs/install.sh --tools
set_up

root=output/fuzz
broken=0
for reader in "${readers[@]}"; do
  mkdir -p "$root/$reader"
  echo "== $reader, $seconds s"
  "build/fuzz/tests/${reader}_fuzz" -max_total_time="$seconds" -timeout=10 -max_len=50000 -print_final_stats=1 \
    -artifact_prefix="$root/$reader-" "$root/$reader" "tests/fuzz/corpus/$reader" >"$root/$reader.log" 2>&1 || broken=1
  grep -E 'ERROR|SUMMARY|Test unit written|runtime error|number_of_executed_units|DONE|peak_rss' "$root/$reader.log" ||
    tail -3 "$root/$reader.log"
done
exit $broken
