#!/usr/bin/env bash
# Installs what is missing, builds and tests twice, and checks the style: a release build with every test, and a build
# under AddressSanitizer (leaks too) and UndefinedBehaviorSanitizer. The second has the tests that run what the others
# do not under its eyes (IDIM_TESTS in CMakePresets.json): readers of files good and bad, the programs with every
# estimator, the kernel that counts in octets. It leaves out their repetitions for the same bytes, and the browser,
# which has no sanitizer.
# The last line is the sum over all cases, "N passed, N failed, N skipped"; a build that fails counts as one failure.
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

run_suite() {
  local build=$PWD/build/$1
  cmake --preset "$1" -DIDIM_BUILD_TESTS=ON
  cmake --build --preset "$1" --parallel "$(nproc)"
  rm -rf "$build/test_results" "$build/test_results.xml"
  local status=0 counts passes failures skips
  ctest --preset "$1" --parallel "$(nproc)" --output-junit "$build/test_results.xml" || status=$?
  counts=$(awk -v results="$build/test_results" -f scripts/count_cases.awk "$build/test_results.xml")
  read -r passes failures skips <<<"$counts"
  # ctest may fail without naming a test.
  if [ $status -ne 0 ] && [ "$failures" -eq 0 ]; then failures=1; fi
  echo "$1: $passes passed, $failures failed, $skips skipped, after $SECONDS s"
  passed=$((passed + passes))
  failed=$((failed + failures))
  skipped=$((skipped + skips))
}

scripts/install_dependencies.sh --tests
run_suite release
if scripts/check_style.sh; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
run_suite asan
finish
