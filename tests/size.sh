#!/bin/bash
# A family of slides with balls of 2 d, d, d/2 and d/4 (doc/src/sensitivity.rst): tests/size.sh OUT [FINER:SEEDS ...]
# FINER:SEEDS, such as 0.5:3 1:3 2:3 4:1 (the default): which sizes, and how many runs of each case. Writes OUT/size.csv, a line
# a run; CASES in the environment: which. More than an hour on a quiet core, most of it for d/4; started again, it goes on.
set -euo pipefail
[ $# -ge 1 ] || { sed -n '2,4s/^# //p' "$0"; exit 2; }
here=$(cd "$(dirname "$0")/.." && pwd)
export LMP=${LMP:-$here/build/lmp} OMP_NUM_THREADS=1
family=(/usr/bin/python3 "$here/tests/size_family.py")
out=$1
shift
[ $# -gt 0 ] || set -- 0.5:3 1:3 2:3 4:1
mkdir -p "$out"
table=$out/size.csv
[ -f "$table" ] || "${family[@]}" head > "$table"
TIMEFORMAT=%U       # of a run: its processor time, s

for sizes in "$@"; do
  finer=${sizes%:*}
  for name in ${CASES:-$("${family[@]}" list)}; do
    [ -d "$out/$name" ] || { "${family[@]}" site "$name" "$out/$name.new"; mv "$out/$name.new" "$out/$name"; }
    for seed in $(seq "${sizes#*:}"); do
      grep -q "^$name,$finer,$seed," "$table" && continue
      prefix=$name.$finer.$seed
      rolling=$("${family[@]}" rolling "$name")
      d=$(awk -v finer="$finer" '$2 == "d" { print $4 / finer; exit }' "$out/$name/site/in.site")
      ( cd "$out/$name/site"
        rm -f "$prefix".*
        { time "$LMP" -in in.site -screen none -log "$prefix.log" -var out "$prefix" -var d "$d" -var packing "$seed" \
          -var rolling "$rolling" \
          -var film 1; } 2> "$prefix.cpu" )
      line=$("${family[@]}" row "$name" "$out/$name" "$out/$name/site/$prefix" "$finer" "$seed" "$d" \
        "$(tail -1 "$out/$name/site/$prefix.cpu")")
      echo "$line" >> "$table"
      rm -f "$out/$name/site/$prefix".*.dump "$out/$name/site/$prefix".*.restart
    done
  done
done
