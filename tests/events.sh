#!/bin/sh
# The numbers of doc/src/events.rst made anew: tests/events.sh DATA OUT [JOBS]
# DATA holds frank/ and s1000/ (README.md of inputs/30_frank and 31_s1000). Some three hours on two quiet cores, nearly
# all of it for Frank with balls of 7.5 m; started again, it goes on.
set -eu
[ $# -ge 2 ] || { sed -n '2,4s/^# //p' "$0"; exit 2; }
here=$(cd "$(dirname "$0")/.." && pwd)
slope=${SLOPE_TOOLS:-$here/tools}/slope
data=$(cd "$1" && pwd)
jobs=${3:-2}
mkdir -p "$2"
cd "$2"
vary="--vary friction=5:30 --vary rolling=0:0.15 --vary spacing=0.3:1 --vary field_e=0.05:0.5"
chance="--repeat xoffset=0.25,0.5"

for event in frank s1000; do
  case $event in frank) folder=30_frank ;; s1000) folder=31_s1000 ;; esac
  [ -f $event/release.slip.asc ] || "$here/inputs/$folder/prepare.sh" "$data/$event" $event
done

# what each event allows
"$slope" calibrate frank/in.frank --front 3080 --area 3.57e6 --tolerance front=0.05 --tolerance area=0.15 $vary \
  $chance --set d=20 --runs 30 --jobs "$jobs" -o frank.fit
"$slope" calibrate s1000/in.s1000 --observed s1000/deposit.asc --tolerance 0.1 $vary $chance --set d=3 --runs 30 \
  --jobs "$jobs" -o s1000.fit

# its best values with small balls, and what the other event becomes with them
best() {
  /usr/bin/python3 -c 'import sys, yaml
for name, value in yaml.safe_load(open(sys.argv[1] + "/calibrate.yaml"))["best"]["set"].items():
    print(f"--set {name}={value}")' "$1.fit"
}
for event in frank s1000; do
  case $event in
    frank) own="--set d=20,10,7.5"; other=s1000; sizes="--set d=3,1.5" ;;
    s1000) own="--set d=3,1.5"; other=frank; sizes="--set d=20" ;;
  esac
  "$slope" study $event/in.$event $own $(best $event) --jobs "$jobs" -o $event.best
  "$slope" study $other/in.$other $sizes $(best $event) --jobs "$jobs" -o $other.predicted
  "$slope" report $event.best
  "$slope" report $other.predicted
done

# against what was mapped
for run in s1000.best/*/s1000.summary.yaml s1000.predicted/*/s1000.summary.yaml; do
  prefix=${run%.summary.yaml}
  echo "$prefix"
  "$slope" score "$prefix" --observed s1000/deposit.asc --terrain s1000/before.asc
  "$here/inputs/31_s1000/zones.py" "$prefix" --before s1000/before.asc --change "$data/s1000/DEM_of_Difference.asc"
done
"$here/tests/events_table.py" frank.best/*/frank.summary.yaml frank.predicted/*/frank.summary.yaml
