#!/usr/bin/env bash
# Whether this tree gives the results that a commit gave: builds both, runs idim_identify (wls, eiv), idim_compare and
# idim_close_loop of each on the same studies, on one thread and on two where a program takes --threads, and compares
# estimate.json, loop.json, comparison.json, residuals.csv and exit codes byte for byte but for "seconds".
#
#   scripts/compare_with_commit.sh [options] COMMIT [STUDY...]
#
# STUDY: study.yaml files of this tree; default: those of the TX-40, the synthetic TX-40 and the UR10e in datasets/,
# whose public recordings are looked for as docs/files.md says.
#   --quick                 without the loops, which take minutes
#   --ignore KEY            without this key of the JSON files; may be given again
#   --reference-build DIR   a build of COMMIT that is there already
#   --build DIR             a build of this tree that is there already and up to date; default: build/release, built now
#   --output DIR            where results go; default: build/compare
#
# A line per file, then their sum. Ends with 0 where all is the same, 1 where something differs,
# 2 where it cannot be told.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD

fail() { echo "$0: $*" >&2; exit 2; }
usage() { sed -n '2,17s/^# \{0,1\}//p' "$0" >&2; exit 2; }

quick=no reference_build='' build='' output=build/compare ignore=()
while [ $# -gt 0 ]; do
  case $1 in
    --quick) quick=yes; shift ;;
    --ignore|--reference-build|--build|--output)
      [ $# -ge 2 ] || fail "$1 needs a value"
      case $1 in
        --ignore) ignore+=(--ignore "$2") ;;
        --reference-build) reference_build=$2 ;;
        --build) build=$2 ;;
        --output) output=$2 ;;
      esac
      shift 2 ;;
    -*) usage ;;
    *) break ;;
  esac
done
[ $# -ge 1 ] || usage
commit=$(git rev-parse --verify --quiet "$1^{commit}") || fail "there is no commit '$1'"
shift
studies=("$@")
if [ ${#studies[@]} -eq 0 ]; then
  studies=(datasets/tx40/study.yaml datasets/tx40_synthetic/study.yaml datasets/ur10e/study.yaml)
fi
for study in "${studies[@]}"; do [ -f "$study" ] || fail "there is no study '$study'"; done

# build_tree SOURCE BUILD: its programs alone.
build_tree() {
  cmake -S "$1" -B "$2" -G Ninja -DCMAKE_BUILD_TYPE=Release -DIDIM_BUILD_TESTS=OFF -DIDIM_BUILD_BENCHMARKS=OFF \
    -DIDIM_ECHARTS_JS="$root/core/report/node_modules/echarts/dist/echarts.min.js" ${IDIM_CMAKE_FLAGS-} >&2 &&
    cmake --build "$2" --target apps/all >&2
}

if [ -z "$reference_build" ]; then
  source_folder=$output/$commit
  reference_build=$source_folder/build
  mkdir -p "$source_folder"
  git archive "$commit" | tar -x -C "$source_folder"
  build_tree "$source_folder" "$reference_build" || fail "$commit does not build"
fi
if [ -z "$build" ]; then
  build=build/release
  cmake --preset release ${IDIM_CMAKE_FLAGS-} >&2 && cmake --build "$build" --target apps/all >&2 ||
    fail "this tree does not build"
fi

programs=(idim_identify idim_compare)
[ $quick = yes ] || programs+=(idim_close_loop)
for tree in "$reference_build" "$build"; do
  for program in "${programs[@]}"; do
    [ -x "$tree/apps/$program" ] || fail "there is no program '$tree/apps/$program'"
  done
done

# run FOLDER PROGRAM ARGUMENTS...: its results and its exit code, there.
run() {
  local folder=$1 code=0
  shift
  mkdir -p "$folder"
  "$@" --output="$folder" >"$folder/out" 2>"$folder/err" || code=$?
  echo $code >"$folder/exit_code"
}

# name STUDY: "tx40" of datasets/tx40/study.yaml, "tx40_study_split" of another file in that folder.
name() {
  local folder file
  folder=$(basename "$(dirname "$(realpath "$1")")")
  file=$(basename "$1" .yaml)
  [ "$file" = study ] && echo "$folder" || echo "${folder}_$file"
}

# run_all BUILD FOLDER
run_all() {
  rm -rf "$2"
  local study threads program
  for study in "${studies[@]}"; do
    local to=$2/$(name "$study")
    for estimator in wls eiv; do
      run "$to/identify_$estimator" "$1/apps/idim_identify" "$study" --estimator=$estimator
    done
    for program in "${programs[@]:1}"; do
      for threads in 1 2; do
        run "$to/${program#idim_}_threads_$threads" "$1/apps/$program" "$study" --threads=$threads
      done
    done
  done
}

run_all "$reference_build" "$output/reference"
run_all "$build" "$output/this"
status=0
python3 scripts/compare_outputs.py ${ignore[@]+"${ignore[@]}"} "$output/reference" "$output/this" || status=$?

# The number of threads changes nothing.
for one in "$output"/this/*/*_threads_1; do
  two=${one%1}2
  if ! lines=$(python3 scripts/compare_outputs.py "$one" "$two"); then
    echo "one thread and two differ: ${one#"$output/this/"}"
    sed '$d; /  same$/d; s/^/  /' <<<"$lines"
    [ $status -ne 0 ] || status=1
  fi
done
exit $status
