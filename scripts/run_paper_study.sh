#!/usr/bin/env bash
# Installs what is missing, builds what is needed, and runs the study of Gautier & Briot (2014) on simulated recordings:
# Tables I to VIII into datasets/paper_study/README.md, Fig. 2 into out/paper_study/report.html.
set -euo pipefail
cd "$(dirname "$0")/.."
if [ $# -gt 0 ]; then
  echo "usage: $0" >&2
  exit 1
fi

scripts/install_dependencies.sh
cmake --preset release
cmake --build --preset release --target paper_study
build/release/apps/paper_study --study=datasets/paper_study --output=out/paper_study
