#!/usr/bin/env bash
# Instructions a sample of inverse dynamics and regressor of a 6R arm, by callgrind: runs of 1000 and 2000 samples, the
# difference divided by 1000, so that start-up cancels. Repeatable for the same binary.
# Usage: benchmarks/count_instructions.sh [build/release/benchmarks/dynamics_benchmark]
set -euo pipefail
program=${1:-build/release/benchmarks/dynamics_benchmark}
command -v valgrind >/dev/null || { echo "count_instructions: valgrind is missing (apt-get install valgrind)" >&2; exit 1; }
count() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$program" "$1" "$2" 2>&1 | sed -n 's/.*Collected : //p'
}
for what in inverse_dynamics regressor; do
  echo "$what: $((($(count "$what" 2000) - $(count "$what" 1000)) / 1000)) instructions a sample"
done
