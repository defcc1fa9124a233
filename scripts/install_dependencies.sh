#!/usr/bin/env bash
# Installs what idim needs to build and run: Debian packages (Debian 12 or a later one, or an Ubuntu that has them),
# and the plotting library of the reports by npm. Does nothing, quickly, where all of it is there.
#
#   scripts/install_dependencies.sh            to build the libraries, programs, tests and benchmarks
#   scripts/install_dependencies.sh --tests    also the browser in which the tests open the reports, Doxygen, the compiler of the
#                                              sanitized build and what checks style
#   scripts/install_dependencies.sh --benchmarks   also ODRPACK, the peer of benchmarks/compare_bundle.sh
set -euo pipefail
cd "$(dirname "$0")/.."

packages=(
  g++ cmake ninja-build git ca-certificates python3
  libeigen3-dev libceres-dev libsuitesparse-dev libboost-dev   # linear algebra, least squares, statistics
  libyaml-cpp-dev nlohmann-json3-dev liburdfdom-dev libcsv-dev # files
  libgoogle-glog-dev libgflags-dev                             # checks and command lines
  libgtest-dev libgmock-dev libbenchmark-dev
  libopenblas-dev                                              # the peer of benchmarks/tsqr_benchmark.cc
)
case "${1-}" in
  "") ;;
  --tests) packages+=(chromium doxygen clang libclang-rt-14-dev clang-format clang-tidy python3) ;;
  --benchmarks) packages+=(python3-scipy) ;;
  *) echo "usage: $0 [--tests | --benchmarks]" >&2; exit 1 ;;
esac
# Any npm will do, not only the packaged one.
[ -n "$(command -v npm)" ] || packages+=(npm)

if ! command -v dpkg-query >/dev/null; then
  echo "$0: this script knows Debian packages only. Install the equivalents of: ${packages[*]}" >&2
  exit 1
fi
missing=()
for package in "${packages[@]}"; do
  state=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$state" = installed ] || missing+=("$package")
done

if [ "${#missing[@]}" -gt 0 ]; then
  echo "installing: ${missing[*]}"
  as_root=(env DEBIAN_FRONTEND=noninteractive)
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "$0: neither root nor sudo. As root: apt-get install --no-install-recommends ${missing[*]}" >&2
      exit 1
    fi
    as_root=(sudo "${as_root[@]}")
  fi
  "${as_root[@]}" apt-get update --quiet
  "${as_root[@]}" apt-get install --quiet --yes --no-install-recommends "${missing[@]}"
fi

# The plotting library that is embedded in the reports, at the version that the lock file fixes.
report=core/report
if [ -f $report/package.json ] && [ ! $report/node_modules/.package-lock.json -nt $report/package-lock.json ]; then
  npm ci --ignore-scripts --no-audit --no-fund --prefix $report
  touch $report/node_modules/.package-lock.json
fi
