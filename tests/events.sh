#!/bin/bash
# The numbers of doc/src/events.rst made anew: tests/events.sh DATA OUT [JOBS]
# DATA holds frank/ and s1000/ (README.md of inputs/30_frank and 31_s1000). One to two hours on two quiet cores, most of it
# for small balls; started again, it goes on.
set -euo pipefail
[ $# -ge 2 ] || { sed -n '2,4s/^# //p' "$0"; exit 2; }
here=$(cd "$(dirname "$0")/.." && pwd)
slope=${SLOPE_TOOLS:-$here/tools}/slope
data=$(cd "$1" && pwd)
jobs=${3:-2}
mkdir -p "$2"
cd "$2"
looked_for=(--vary friction=5:30 --vary rolling=0:0.15 --vary spacing=0.3:1 --vary field_e=0.05:0.5
  --repeat "xoffset=0.25,0.5")

[ -f frank/release.slip.asc ] || "$here/inputs/30_frank/prepare.sh" "$data/frank" frank
[ -f s1000/release.slip.asc ] || "$here/inputs/31_s1000/prepare.sh" "$data/s1000" s1000

# what each event allows
"$slope" calibrate frank/in.frank --front 3080 --front-is 99 --area 3.57e6 --tolerance front=0.05 --tolerance area=0.15 \
  "${looked_for[@]}" --set d=20 --runs 44 --jobs "$jobs" -o frank.fit
"$slope" calibrate s1000/in.s1000 --observed s1000/deposit.asc --tolerance 0.1 \
  "${looked_for[@]}" --set d=3 --runs 44 --jobs "$jobs" -o s1000.fit

# best FIT: --set NAME=VALUE of each of its best values, in the array values
best() {
  mapfile -t values < <(/usr/bin/python3 -c 'import sys, yaml
for name, value in yaml.safe_load(open(sys.argv[1] + "/calibrate.yaml"))["best"]["set"].items():
    print("--set", f"{name}={value}", sep="\n")' "$1")
}

# its best values with small balls, and what the other event becomes with them
best frank.fit
"$slope" study frank/in.frank --set d=20,12,7.5 "${values[@]}" --jobs "$jobs" -o frank.best
"$slope" study s1000/in.s1000 --set d=3,1.5 --set speed=30 "${values[@]}" --jobs "$jobs" -o s1000.predicted
best s1000.fit
"$slope" study s1000/in.s1000 --set d=3,1.5 --set speed=30 "${values[@]}" --jobs "$jobs" -o s1000.best
"$slope" study frank/in.frank --set d=20,12 "${values[@]}" --jobs "$jobs" -o frank.predicted
for study in frank.best frank.predicted s1000.best s1000.predicted; do "$slope" report "$study"; done

# against what was mapped
for summary in s1000.best/*/s1000.summary.yaml s1000.predicted/*/s1000.summary.yaml; do
  prefix=${summary%.summary.yaml}
  echo "$prefix"
  "$slope" score "$prefix" --observed s1000/deposit.asc --terrain s1000/before.asc
  "$here/inputs/31_s1000/zones.py" "$prefix" --before s1000/before.asc --change "$data/s1000/DEM_of_Difference.asc"
done
"$here/tests/events_table.py" frank.best/*/frank.summary.yaml frank.predicted/*/frank.summary.yaml
