#!/usr/bin/env bash
# Installs what is missing, then builds and tests twice: a release build with every test, and a build under
# AddressSanitizer (leaks too) and UndefinedBehaviorSanitizer. The second leaves out (CMakePresets.json) what would run
# no line of ours that the others do not: the tests labelled "slow" (statistics over many draws), those that a program
# run again writes the same bytes, and those of what a browser, which has no sanitizer, makes of a report.
# The last line is the sum, "N passed, N failed, N skipped"; a build that fails counts as one failure.
set -euo pipefail
cd "$(dirname "$0")/.."
if [ $# -gt 0 ]; then
  echo "usage: $0" >&2
  exit 1
fi

passed=0
failed=0
skipped=0
finish() {
  trap - EXIT
  echo "$passed passed, $failed failed, $skipped skipped"
  [ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
  exit
}
# Reached early only when a command below fails, or on an interrupt.
trap 'failed=$((failed + 1)); finish' EXIT

# attribute NAME FILE: a count in the head of a JUnit file.
attribute() { grep -o -m 1 "[[:space:]]$1=\"[0-9]*\"" "$2" | head -n 1 | tr -dc '0-9'; }

run_suite() {
  local preset=$1
  local results=$PWD/build/$preset/test_results.xml
  cmake --preset "$preset" -DIDIM_BUILD_TESTS=ON
  cmake --build --preset "$preset" --parallel "$(nproc)"
  rm -f "$results"
  local status=0
  ctest --preset "$preset" --parallel "$(nproc)" --output-junit "$results" || status=$?
  local tests failures not_run passes
  tests=$(attribute tests "$results")
  failures=$(attribute failures "$results")
  not_run=$(($(attribute disabled "$results") + $(attribute skipped "$results")))
  # ctest may fail without naming a test, and a test without a result has not passed.
  if [ $status -ne 0 ] && [ "$failures" -eq 0 ]; then failures=1; fi
  passes=$((tests - failures - not_run))
  passed=$((passed + (passes > 0 ? passes : 0)))
  failed=$((failed + failures))
  skipped=$((skipped + not_run))
}

scripts/install_dependencies.sh --tests
run_suite release
run_suite asan
finish
