#!/usr/bin/env bash
# Gets the public recordings of datasets/manifest.yaml from their source, checks their SHA-256 and puts them into
# ${IDIM_DATA_DIR:-datasets/recordings}. A file appears there whole and checked, or not at all; one that is there and
# right is kept. IDIM_FETCH_BASE_URL replaces https://raw.githubusercontent.com (a mirror, or file:///... for a test).
set -euo pipefail

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
target="${IDIM_DATA_DIR:-${root}/datasets/recordings}"
base="${IDIM_FETCH_BASE_URL:-https://raw.githubusercontent.com}"

for tool in curl sha256sum cut; do
  command -v "${tool}" > /dev/null || { echo "fetch_recordings.sh: '${tool}' is not installed" >&2; exit 1; }
done
work="$(mktemp -d)"
partial=""
trap 'rm -rf "${work}" ${partial:+"${partial}"}' EXIT

sha256_of() { sha256sum "$1" | cut -d ' ' -f 1; }

# fetch FILE SHA256 URL_PATH [HEADER]: with a header, columns 1 to 19 are kept and the header is put in front.
fetch() {
  local file="$1" sha256="$2" url="${base}/$3" header="${4:-}"
  if [[ -f "${target}/${file}" && "$(sha256_of "${target}/${file}")" == "${sha256}" ]]; then
    echo "${file}: there already"
    return
  fi
  if ! curl --fail --silent --show-error --location --retry 3 --output "${work}/source" "${url}"; then
    echo "${file}: cannot be fetched from ${url}" >&2
    exit 1
  fi
  if [[ -n "${header}" ]]; then
    { echo "${header}"; cut -d , -f 1-19 "${work}/source"; } > "${work}/derived"
    mv "${work}/derived" "${work}/source"
  fi
  local found
  found="$(sha256_of "${work}/source")"
  if [[ "${found}" != "${sha256}" ]]; then
    echo "${file}: SHA-256 is ${found}; expected ${sha256} (from ${url}); not kept" >&2
    exit 1
  fi
  mkdir -p "$(dirname "${target}/${file}")"
  partial="${target}/${file}.part"  # in the same folder, so that the rename is atomic
  cp "${work}/source" "${partial}"
  mv "${partial}" "${target}/${file}"
  partial=""
  echo "${file}: fetched"
}

tx40=thanhndv212/figaroh-examples/c0b5c7f0fda10078be55104f9ee76ac106b7a5ee/examples/staubli_TX40/data
ur10e=shamilmamedov/dynamic_calibration/11af40e7/dataset_ur10e/identification_data
ur10e_header=t,q1,q2,q3,q4,q5,q6,dq1,dq2,dq3,dq4,dq5,dq6,v1,v2,v3,v4,v5,v6

fetch tx40/motor_position.csv 5cc1cecc1024ef0e331d0caba06f689456ab789ec3f1e904599c0a8be5c27bc8 "${tx40}/pos_read_data.csv"
fetch tx40/motor_torque.csv f4592f4ba4db42f5d7625688986be25b575ca34d0504b27979ca6b0276bd3af9 "${tx40}/curr_data.csv"
fetch ur10e/free_14.csv 9c6885941c4b80118ace81c0730e1578072f67e8ae4e7a293430a161bd24a2cc \
  "${ur10e}/ur-20_02_19_14harm50sec.csv" "${ur10e_header}"
fetch ur10e/load_14.csv 95385577157bc1202b52e4c82c4084fa2320b317169352935bd0ba490148f949 \
  "${ur10e}/ur-20_02_19_14harm50secLoad.csv" "${ur10e_header}"
fetch ur10e/free_12.csv d3b298ad3d5f4ca4291f86f43c591fc5367a20a825eb4eea6f8b1569d25c4074 \
  "${ur10e}/ur-20_02_12-40sec_12harm.csv" "${ur10e_header}"
echo "Recordings are in ${target}"
