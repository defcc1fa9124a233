#!/usr/bin/env bash
# Installs what is missing, builds the programs, identifies the TX-40 of the synthetic study that comes with the
# sources and says where the report is. The programs are then in build/release/apps/, ready for other studies.
set -euo pipefail
cd "$(dirname "$0")/.."
if [ $# -gt 0 ]; then
  echo "usage: $0    (for another study: build/release/apps/idim_identify STUDY --estimator=wls --output=DIR)" >&2
  exit 1
fi

scripts/install_dependencies.sh
cmake --preset release
cmake --build --preset release --target apps/all

program=build/release/apps/idim_identify
study=datasets/tx40_synthetic/study.yaml
output=out/tx40_synthetic
for needed in "$program" "$study"; do
  if [ ! -e "$needed" ]; then
    echo "$0: $needed is not there; are these sources complete?" >&2
    exit 1
  fi
done
"$program" "$study" --estimator=wls --output="$output"
echo
echo "Report (open it in a browser): $PWD/$output/report.html"
echo "Numbers: $PWD/$output/estimate.json, $PWD/$output/residuals.csv"
