#!/bin/bash
# Set-up, configure, build: build/lmp. Arguments go to cmake, e.g. -D LAMMPS_SIZES=bigbig.
# JOBS=<n> in the environment: number of compilers at a time (default 2).
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

if [[ $top == *[[:space:]]* ]]; then # here, before anything is downloaded
  echo "build: the path of the checkout must have no blanks, with which LAMMPS' own build does not work: move it, got $top" >&2
  exit 2
fi
"$top/tools/setup.sh"
# the source is named each time, or cmake would keep that of the previous build
cmake -S "$top" -B "$top/build" \
  -D LAMMPS_SOURCE_DIR="$(realpath "${LAMMPS_SOURCE_DIR:-$top/.lammps/source}")" "$@"
cmake --build "$top/build" -j "${JOBS:-2}"
