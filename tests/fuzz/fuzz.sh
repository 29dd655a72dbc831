#!/bin/bash
# Coverage-guided fuzzing of the C++ readers by clang's libFuzzer, with AddressSanitizer and
# UndefinedBehaviorSanitizer. (The Python readers: fuzz_readers.py.)
#
#   tests/fuzz/fuzz.sh [TARGET...] [--seconds N] [-o DIR]
#
# TARGET       elevation_grid, polygon, dump_reader (default: all, one after the other)
# --seconds N  for each target (default 600)
# -o DIR       output folder (default: build/fuzz): programs, corpus, logs, and in found/ what fails;
#              such a file belongs into tests/fuzz/found/TARGET, from where the tests replay it
#
# Exit status: 0 if nothing was found, 1 if something was, 2 for wrong arguments.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
top=$here/../..
all=(elevation_grid polygon dump_reader)
targets=() seconds=600 out=$top/build/fuzz

die() { echo "fuzz: $*" >&2; exit 2; }

while (($#)); do
  case $1 in
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit ;;
    --seconds | -o)
      (($# > 1)) || die "$1: value is missing"
      [[ $1 == -o ]] && out=$2 || seconds=$2
      shift 2 ;;
    *) [[ " ${all[*]} " == *" $1 "* ]] || die "TARGET must be of ${all[*]}, got $1"
       targets+=("$1"); shift ;;
  esac
done
[[ $seconds =~ ^[1-9][0-9]*$ ]] || die "--seconds must be a whole number >= 1, got $seconds"
command -v clang++ >/dev/null || die "clang++ must be installed (Debian package clang)"
((${#targets[@]})) || targets=("${all[@]}")

status=0
for target in "${targets[@]}"; do
  mkdir -p "$out/corpus/$target" "$out/found"
  case $target in
    dump_reader) folder=$top/tools/dump2vtk names=(dump_reader line_reader numbers) libraries=-lz ;;
    *) folder=$top/src/common names=("$target") libraries= ;;
  esac
  # lines and files longer than the reader's buffers are in reach of small inputs
  sources=()
  for name in "${names[@]}"; do
    sed 's/= 1 << 20;/= 1 << 12;/' "$folder/$name.cpp" >"$out/$name.cpp"
    sources+=("$out/$name.cpp")
  done
  clang++ -std=c++17 -g -O1 -fno-omit-frame-pointer -fsanitize=fuzzer,address,undefined \
    -fno-sanitize-recover=undefined -I "$top/src/common" -I "$folder" -I "$here" \
    "$here/fuzz_$target.cpp" "${sources[@]}" "$top/src/common/text_file.cpp" ${libraries:+"$libraries"} -o "$out/fuzz_$target"
  "$out/fuzz_$target" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=3000 -print_final_stats=1 \
    -dict="$here/words" -artifact_prefix="$out/found/$target." "$out/corpus/$target" "$here/seeds/$target" \
    >"$out/$target.log" 2>&1 || status=1
  echo "$target: $(sed -n 's/^stat::number_of_executed_units: *//p' "$out/$target.log") executions," \
    "$(find "$out/found" -name "$target.*" | wc -l) findings"
done
exit "$status"
