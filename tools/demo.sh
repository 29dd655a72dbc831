#!/bin/bash
# A small study: set-up, build, three collapses of inputs/20_embankment with balls of 2.5 m and
# rolling resistance 0, 0.05 and 0.10; then a table and a picture. Results: build/demo.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$top/tools/build.sh"

out=$top/build/demo
deck=$top/inputs/20_embankment
rolling=(0.00 0.05 0.10)
export OMP_NUM_THREADS=1 LMP=$top/build/lmp

run() { # rolling resistance: one collapse in a folder of its own
  local dir=$1/rolling_$2
  rm -rf "$dir" && mkdir -p "$dir"
  cp "$3/in.embankment" "$3/terrain.asc" "$dir"
  echo "demo: collapse with rolling resistance $2 ..."
  if (cd "$dir" && "$LMP" -in in.embankment -var d 2.5 -var rolling "$2" -log log.lammps -screen none); then
    echo "demo: rolling resistance $2 at rest"
  else
    echo "demo: error: see $dir/log.lammps" >&2
    return 1
  fi
}
export -f run

mkdir -p "$out"
printf '%s\n' "${rolling[@]}" | xargs -P 2 -I {} bash -c 'run "$@"' run "$out" {} "$deck"
/usr/bin/python3 "$top/tools/demo.py" "$out" "${rolling[@]}"
