#!/bin/bash
# A small study: set-up, build, three collapses of inputs/20_embankment with balls of 2.5 m and
# rolling resistance 0, 0.05 and 0.10; then a table, a report and its pictures. Results: build/demo.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
if [[ ! -x $top/build/lmp ]]; then
  echo "demo: the first time set-up takes a few minutes and the build of LAMMPS 5 to 10 on two cores. Then a small study" \
    "of three collapses: half a minute"
fi
"$top/tools/build.sh"

out=$top/build/demo
deck=$top/inputs/20_embankment
rm -rf "$out"    # so that all runs are made with the present program and deck
LMP=$top/build/lmp "$top/tools/slope" study "$deck/in.embankment" --set d=2.5 \
  --set rolling=0,0.05,0.10 --road "$deck/road.csv" --local -o "$out"
"$top/tools/slope" report "$out" --reference "$deck/reference.yaml" --pictures
