#!/bin/bash
# The unit tests on ARM (aarch64), under emulation: cross-compiles the rooms without LAMMPS and tests/unit with Debian's
# compiler, and runs them by qemu-user. On an x86-64 machine; not part of ctest.
#
#   tests/arm.sh [DIR [REGEX]]
#
# DIR: output folder (default: build/arm). REGEX: of the tests' names (default: all). JOBS=<n>: number of compilers at a
# time (default 2). Needs the packages g++-aarch64-linux-gnu, qemu-user and googletest.
#
# Exit status: 0 if every test passed, 1 if not, 2 if something is missing.
set -euo pipefail
export LC_ALL=C

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
out=${1:-$top/build/arm} regex=${2:-.} gtest=/usr/src/googletest/googletest
[[ $out != -* ]] || { sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit; }
for needed in aarch64-linux-gnu-g++ qemu-aarch64; do
  command -v $needed >/dev/null || { echo "arm: $needed is missing" >&2; exit 2; }
done
[[ -d $gtest ]] || { echo "arm: $gtest is missing" >&2; exit 2; }
mkdir -p "$out"
out=$(realpath "$out")

rooms=(common contacts deposit ground meshes motion slips) # as in CMakeLists.txt
includes=(-I"$gtest" -I"$gtest/include" -I"$top/src")
for room in "${rooms[@]}"; do includes+=(-I"$top/src/$room"); done
mapfile -t tests < <(cd "$top/tests/unit" && basename -s .cpp test_*.cpp | grep -E "$regex")

# a line of options for each source; they are those of CMakeLists.txt and cmake/ContactKernels.cmake
{
  for source in "$top"/src/*/*.cpp; do
    room=$(basename "$(dirname "$source")")
    [[ " ${rooms[*]} " == *" $room "* && $(head -n 1 "$source") == "// No LAMMPS" ]] || continue
    roots=''
    [[ $source != */slips/* && $source != */contact_kernel* ]] || roots='-fno-math-errno -fno-trapping-math'
    echo "-std=c++11 $roots -c $source -o $out/$room.$(basename "$source" .cpp).o"
  done
  for name in gtest-all gtest_main; do echo "-std=c++14 -c $gtest/src/$name.cc -o $out/$name.o"; done
  for name in "${tests[@]}"; do echo "-std=c++14 -c $top/tests/unit/$name.cpp -o $out/$name.o"; done
} >"$out/sources"
xargs -P "${JOBS:-2}" -L 1 aarch64-linux-gnu-g++ -O3 -Wno-psabi "${includes[@]}" <"$out/sources"
rm -f "$out/librooms.a"
aarch64-linux-gnu-ar qcs "$out/librooms.a" "$out"/*.*.o

failed=0
for name in "${tests[@]}"; do
  aarch64-linux-gnu-g++ "$out/$name.o" "$out"/gtest{-all,_main}.o "$out/librooms.a" -o "$out/$name" -lpthread
  qemu-aarch64 -L /usr/aarch64-linux-gnu "$out/$name" --gtest_brief=1 >"$out/$name.log" 2>&1 || failed=1
  echo "$name: $(tail -1 "$out/$name.log")"
done
exit $failed
