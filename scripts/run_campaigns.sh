#!/usr/bin/env bash
# Runs the statistical tests with all their draws (the suite takes a part) and writes what they found into
# benchmarks/results/<test>.json, with commit, draws and seeds. Hours on two cores for all of them.
#
#   scripts/run_campaigns.sh [TEST...]    e.g. statistics_slow_test; none: all that are labelled "slow"
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install_dependencies.sh --tests
cmake --preset release -DIDIM_BUILD_TESTS=ON
cmake --build --preset release --parallel "$(nproc)" --target tests/all

tests=("$@")
if [ ${#tests[@]} -eq 0 ]; then
  mapfile -t tests < <(find tests -name '*_slow_test.cc' -printf '%h\n' | sed 's,.*/,,; s,$,_slow_test,' | sort -u)
fi
commit=$(git rev-parse HEAD)
[ -z "$(git status --porcelain --untracked-files=no)" ] || commit+=" with changes"
mkdir -p benchmarks/results
status=0
for test in "${tests[@]}"; do
  raw=$(mktemp)
  IDIM_DRAWS=full GTEST_OUTPUT=json:$raw "build/release/tests/$test" || status=1
  python3 scripts/campaign_result.py "$test" "$commit" "$raw" >"benchmarks/results/$test.json"
  rm "$raw"
done
exit $status
