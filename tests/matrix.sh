#!/bin/bash
# Builds the package against several LAMMPS in every way that it can be built, runs the tests of
# each, and prints a table. Logs and builds stay in the output folder; a build that is there goes on.
#
#   tests/matrix.sh [--fetch SUITE]... [--only WAY]... [--tests REGEX] [-o DIR] [TREE]...
#
# TREE          a LAMMPS source tree, or an archive of one (.tar.gz, .tar.xz), which is unpacked into DIR/source
# --fetch SUITE a Debian release (bookworm, trixie, sid): the LAMMPS of its source package is fetched
#               into DIR/source/SUITE from the mirror that this machine's apt uses
# --only WAY    smallbig-mpi, smallbig-serial, bigbig-mpi, bigbig-serial (sizes and MPI of LAMMPS),
#               shared (liblammps.so, for Python and the library interface), packages (OPENMP and
#               MOLECULE: suffix omp and bonds, see decks/test_packages.py) or plugin (slopeplugin.so
#               in a stock lmp of the same source); default: all of them
# --tests REGEX only these tests, as ctest -R; "none" builds alone, without tests, and a plugin without an lmp for it
# -o DIR        output folder (default: build/matrix)
# JOBS=<n>      number of compilers at a time (default 2). ccache is used if it is installed.
# BUILD_TYPE=<type> CMake's (default Release; None compiles without optimisation, for whether it compiles at all)
#
# Exit status: 0 if everything was built and every test passed, 1 if not, 2 for wrong arguments.
set -euo pipefail
export LC_ALL=C

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
all_ways=(smallbig-mpi smallbig-serial bigbig-mpi bigbig-serial shared packages plugin)
out=$top/build/matrix
tests=
suites=() ways=() trees=()

die() { echo "matrix: $*" >&2; exit 2; }

while (($#)); do
  case $1 in
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit ;;
    --fetch | --only | --tests | -o)
      (($# > 1)) || die "$1: value is missing"
      case $1 in
        --fetch) suites+=("$2") ;;
        --only) [[ " ${all_ways[*]} " == *" $2 "* ]] || die "--only must be one of ${all_ways[*]}, got $2"
                ways+=("$2") ;;
        --tests) tests=$2 ;;
        -o) out=$2 ;;
      esac
      shift 2 ;;
    -*) die "unknown option $1, see --help" ;;
    *) trees+=("$1"); shift ;;
  esac
done
((${#suites[@]} + ${#trees[@]})) || die "needs a TREE or --fetch SUITE, see --help"
((${#ways[@]})) || ways=("${all_ways[@]}")
for tree in "${trees[@]}"; do
  [[ -f $tree || -e $tree/cmake/CMakeLists.txt ]] || die "$tree is no LAMMPS source tree, nor an archive of one"
done
mkdir -p "$out"
out=$(realpath "$out")

# --- sources in archives, and those that Debian has ---

# shellcheck source=/dev/null
. "$top/tools/upstream_source.sh"

# unpack ARCHIVE: -> its folder DIR/source/NAME, in $tree
unpack() {
  local tmp name
  name=$(basename "$1")
  tree=$out/source/${name%%.t*}
  [[ -d $tree ]] && return
  mkdir -p "$out/source"
  tmp=$(mktemp -d "$out/source/tmp.XXXXXX")
  # shellcheck disable=SC2064 # this folder
  trap "rm -rf '$tmp'" RETURN EXIT
  unpack_source "$1" "$tmp" || die "$1: $(reason "$tmp/log")"
  mv -T "$tmp/tree" "$tree"
}

for k in "${!trees[@]}"; do
  [[ -f ${trees[k]} ]] || continue
  unpack "${trees[k]}"
  trees[k]=$tree
done
for suite in "${suites[@]}"; do
  [[ -d $out/source/$suite ]] || echo "matrix: fetching the LAMMPS source of Debian $suite (up to 220 MB)"
  reason=$(debian_source "$suite" "$out/source/$suite" 2>&1) || die "$reason"
  trees+=("$out/source/$suite")
done

# --- builds ---

common=(-D CMAKE_BUILD_TYPE="${BUILD_TYPE:-Release}")
[[ $tests == none ]] && common+=(-D BUILD_TESTING=OFF)
if command -v ccache >/dev/null; then
  # all ways share what they can: the same code for libraries and programs, no headers ahead
  common+=(-D CMAKE_CXX_COMPILER_LAUNCHER=ccache -D CMAKE_POSITION_INDEPENDENT_CODE=ON
    -D CMAKE_DISABLE_PRECOMPILE_HEADERS=ON)
fi

# build FOLDER SOURCE OPTION...: configure and build; logs beside the folder
build() {
  local folder=$1 source=$2
  shift 2
  cmake -S "$source" -B "$folder" "${common[@]}" "$@" >"$folder.configure.log" 2>&1 &&
    cmake --build "$folder" -j "${JOBS:-2}" >"$folder.build.log" 2>&1
}

# A stock lmp -> FOLDER/lmp. LAMMPS is one folder down as in our own build, so that ccache finds
# there what it knows; before 2022 its program is put where it says.
stock() {
  local folder=$1 tree=$2
  mkdir -p "$folder.source"
  cat >"$folder.source/CMakeLists.txt" <<EOF
cmake_minimum_required(VERSION 3.22)
project(stock C CXX)
add_subdirectory("$tree/cmake" lammps)
set_target_properties(lmp PROPERTIES RUNTIME_OUTPUT_DIRECTORY "\${CMAKE_BINARY_DIR}")
EOF
  build "$folder" "$folder.source" -D BUILD_SHARED_LIBS=ON -D BUILD_MPI=ON -D BUILD_OMP=OFF -D BUILD_TOOLS=OFF \
    -D PKG_GRANULAR=ON -D PKG_MISC=ON -D PKG_PLUGIN=ON -D PKG_RIGID=ON
}

# row CELLS: a line of the table, on the screen and in DIR/table.txt
row() { printf '%-12s %-16s %-7s %6s %6s %7s %8s  %s\n' "$@" | tee -a "$out/table.txt"; }

# one TREE WAY: a row of the table
one() {
  local tree=$1 way=$2 began=$SECONDS version folder options
  version=$(sed -n 's/.*LAMMPS_VERSION "\(.*\)".*/\1/p' "$tree/src/version.h" | tr -d ' ')
  folder=$out/$version-$way
  options=(-D LAMMPS_SOURCE_DIR="$tree" -D SLOPE_NATIVE=OFF)
  case $way in
    *-mpi) options+=(-D LAMMPS_SIZES="${way%-*}" -D BUILD_MPI=ON) ;;
    *-serial) options+=(-D LAMMPS_SIZES="${way%-*}" -D BUILD_MPI=OFF) ;;
    shared) options+=(-D BUILD_SHARED_LIBS=ON) ;;
    packages) options+=(-D BUILD_OMP=ON -D PKG_OPENMP=ON -D PKG_MOLECULE=ON) ;;
    plugin) options+=(-D SLOPE_PLUGIN=ON -D SLOPE_STOCK_LMP="$folder.stock/lmp") ;;
  esac

  [[ -t 1 ]] && printf '%s %s: building ...\r' "$version" "$way"
  if ! { [[ $way != plugin || $tests == none ]] || stock "$folder.stock" "$tree"; } || ! build "$folder" "$top" "${options[@]}"; then
    row "$version" "$way" FAILED - - - $((SECONDS - began)) "$folder*.log"
    return 1
  fi
  if [[ $tests == none ]]; then
    row "$version" "$way" ok - - - $((SECONDS - began)) ""
    return
  fi

  [[ -t 1 ]] && printf '%s %s: testing ... \r' "$version" "$way"
  local status=0 passed failed skipped
  ctest --test-dir "$folder" ${tests:+-R "$tests"} >"$folder.test.log" 2>&1 || status=1
  # pytest says how many, of GoogleTest each is a test of ctest
  read -r passed failed skipped < <(awk '
    match($0, /[0-9]+ passed/) { p += substr($0, RSTART) } match($0, /[0-9]+ failed/) { f += substr($0, RSTART) }
    match($0, /[0-9]+ error/) { f += substr($0, RSTART) } match($0, /[0-9]+ skipped/) { s += substr($0, RSTART) }
    /^\[  PASSED  \] [0-9]+ test/ { p += $4 } /^\[  FAILED  \] [0-9]+ test/ { f += $4 }
    END { print p + 0, f + 0, s + 0 }' "$folder/Testing/Temporary/LastTest.log")
  row "$version" "$way" ok "$passed" "$failed" "$skipped" $((SECONDS - began)) \
    "$( ((status)) && sed -n 's/^.*[0-9] - \([a-z]*\.[^ ]*\) (.*/\1/p' "$folder.test.log" | sort -u | xargs)"
  return "$status"
}

status=0
: >"$out/table.txt"
row LAMMPS way build passed failed skipped seconds "failed tests, logs"
for tree in "${trees[@]}"; do
  for way in "${ways[@]}"; do
    one "$(realpath "$tree")" "$way" || status=1
  done
done
exit "$status"
