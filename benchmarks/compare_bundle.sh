#!/usr/bin/env bash
# Cost of the errors-in-variables bundle: beside ODRPACK and plain Ceres on a 2R arm, beside plain Ceres on a 6R arm,
# and from 1 000 to 100 000 samples of the 6R arm. Every run is a process of its own, on one thread.
# Usage: benchmarks/compare_bundle.sh [build/release/benchmarks/bundle_benchmark]
# In the environment:
#   SAMPLES=100000 SERIES="1000 3000 10000 30000 100000" CERES_6R=1000 REPETITIONS=3 JOINT_NOISE=1
# An empty SERIES leaves the 6R arm out.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${1:-build/release/benchmarks/bundle_benchmark}
python=/usr/bin/python3  # Debian's own, which has Debian's scipy
if ! $python -c 'import scipy.odr' 2>/dev/null; then
  echo "$0: ODRPACK is missing: $python has no scipy.odr. scripts/install_dependencies.sh --benchmarks installs it" >&2
  exit 1
fi
if [ ! -x "$program" ]; then
  echo "$0: $program is missing: cmake --build --preset release --target bundle_benchmark" >&2
  exit 1
fi
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
samples=${SAMPLES:-100000} series=${SERIES-1000 3000 10000 30000 100000} ceres_6r=${CERES_6R:-1000}
repetitions=${REPETITIONS:-3} joint_noise=${JOINT_NOISE:-1}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

solve() {  # DATA SOLVER REPETITION
  "$program" --data="$folder/$1" --solver="$2" --result="$folder/$1.$2.$3.json"
}
"$program" --arm=2r --samples="$samples" --joint_noise="$joint_noise" --data="$folder/2r" --write
for k in $(seq "$repetitions"); do
  solve 2r closed "$k"
  $python benchmarks/bundle_odrpack.py "$folder/2r" "$folder/2r.odrpack.$k.json"
  solve 2r ceres "$k"
done
$python benchmarks/bundle_odrpack.py "$folder/2r" "$folder/2r.odrpack_tight.1.json" --tight
for size in $series; do
  "$program" --arm=6r --samples="$size" --joint_noise="$joint_noise" --data="$folder/6r_$size" --write
  for k in $(seq "$repetitions"); do solve "6r_$size" closed "$k"; done
  if [ "$size" = "$ceres_6r" ]; then solve "6r_$size" ceres 1; fi
done
$python benchmarks/bundle_table.py "$folder"
