#!/bin/bash
# The unit tests on ARM (aarch64), under emulation: cross-compiles the rooms without LAMMPS and tests/unit with Debian's
# compiler, and runs them by qemu-user. On an x86-64 machine; 10 minutes on two cores; not part of ctest.
#
#   tests/arm.sh [DIR]
#
# DIR: output folder (default: build/arm). JOBS=<n>: number of compilers at a time (default 2).
# Needs the packages g++-aarch64-linux-gnu, qemu-user and googletest.
#
# Exit status: 0 if every test passed, 1 if not, 2 if something is missing.
set -euo pipefail
export LC_ALL=C

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
out=${1:-$top/build/arm} gtest=/usr/src/googletest/googletest
[[ $out != -* ]] || { sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit; }
for program in aarch64-linux-gnu-g++ qemu-aarch64; do
  command -v $program >/dev/null || { echo "arm: $program is missing" >&2; exit 2; }
done
[[ -d $gtest ]] || { echo "arm: $gtest is missing" >&2; exit 2; }
mkdir -p "$out"
out=$(realpath "$out")

rooms=(common contacts deposit ground meshes motion slips) # as in CMakeLists.txt: free of LAMMPS
includes=(-I"$gtest" -I"$gtest/include" -I"$top/src")
for room in "${rooms[@]}"; do includes+=(-I"$top/src/$room"); done

# compile SOURCE OBJECT STANDARD; the options are those of CMakeLists.txt and cmake/ContactKernels.cmake
compile() {
  local options=(-O3 -std="$3" -Wno-psabi "${includes[@]}")
  [[ $1 != */slips/* && $1 != */contact_kernel* ]] || options+=(-fno-math-errno -fno-trapping-math)
  aarch64-linux-gnu-g++ "${options[@]}" -c "$1" -o "$2"
}

run() { # each line: SOURCE OBJECT STANDARD
  local running=0 source object standard
  while read -r source object standard; do
    compile "$source" "$object" "$standard" &
    ((++running < ${JOBS:-2})) || { wait -n && running=$((running - 1)); }
  done
  while ((running-- > 0)); do wait -n; done
}

for room in "${rooms[@]}"; do
  for source in "$top/src/$room"/*.cpp; do echo "$source $out/$room.$(basename "$source" .cpp).o c++11"; done
done >"$out/sources"
for source in "$gtest"/src/gtest-all.cc "$gtest"/src/gtest_main.cc "$top"/tests/unit/test_*.cpp; do
  name=$(basename "$source")
  echo "$source $out/${name%.*}.o c++14"
done >>"$out/sources"
run <"$out/sources"
rm -f "$out/librooms.a"
for room in "${rooms[@]}"; do ar qc "$out/librooms.a" "$out/$room".*.o; done
aarch64-linux-gnu-ranlib "$out/librooms.a"

failed=0 passed=0
for source in "$top"/tests/unit/test_*.cpp; do
  name=$(basename "$source" .cpp)
  aarch64-linux-gnu-g++ -static "$out/$name.o" "$out"/gtest{-all,_main}.o "$out/librooms.a" -o "$out/$name" -lpthread
  if qemu-aarch64 "$out/$name" --gtest_brief=1 >"$out/$name.log" 2>&1; then
    passed=$((passed + $(sed -n 's/^\[  PASSED  \] \([0-9]*\) test.*/\1/p' "$out/$name.log")))
  else
    failed=1
    echo "$name failed: $out/$name.log"
  fi
done
echo "$passed unit tests passed on $(qemu-aarch64 --version | head -1)"
exit $failed
