#!/usr/bin/env bash
# What can be checked of the sources without running them; says what is wrong and fails if anything is.
#
#   scripts/check_style.sh           clang-format on all files, the rules for comments
#   scripts/check_style.sh --tidy    also clang-tidy on what the last commits changed (at most ten files)
#   scripts/check_style.sh --tidy-all    also clang-tidy on all files
# clang-tidy takes the compile commands of build/release, which must be configured.
set -euo pipefail
cd "$(dirname "$0")/.."
case "${1-}" in
  "" | --tidy | --tidy-all) ;;
  *) echo "usage: $0 [--tidy | --tidy-all]" >&2; exit 1 ;;
esac
status=0
rooms=(core residuals solvers apps tests benchmarks)

mapfile -t sources < <(find "${rooms[@]}" -name node_modules -prune -o \( -name '*.cc' -o -name '*.h' \) -print | sort)
clang-format --dry-run -Werror "${sources[@]}" || status=1
if [ -f scripts/check_comments.py ]; then python3 scripts/check_comments.py || status=1; fi

# Added or changed in the last commits, newest first; a file that only moved is not changed.
changed_files() {
  git log -n 30 --no-merges -M --diff-filter=AM --name-only --format= -- "${rooms[@]/%//*.cc}" | awk '!seen[$0]++' |
    while read -r file; do [ ! -f "$file" ] || echo "$file"; done
}
case "${1-}" in
  --tidy) mapfile -t files < <(changed_files | head -n 10 || true) ;;
  --tidy-all) mapfile -t files < <(printf '%s\n' "${sources[@]}" | grep '\.cc$') ;;
  *) files=() ;;
esac
if [ ${#files[@]} -gt 0 ]; then
  # The compile commands are GCC's: clang knows not all of its warnings.
  printf '%s\n' "${files[@]}" | xargs --max-args=1 --max-procs="$(nproc)" \
    clang-tidy --quiet -p build/release --extra-arg=-Wno-unknown-warning-option || status=1
fi
[ $status -eq 0 ] && echo "$0: ${#sources[@]} files formatted, ${#files[@]} by clang-tidy"
exit $status
