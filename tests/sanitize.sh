#!/bin/bash
# Runs the tests with what finds errors of memory and undefined behaviour: the unit and deck tests
# under AddressSanitizer and UndefinedBehaviorSanitizer (a build of LAMMPS and package of its own),
# a deck run twice in a process under LeakSanitizer, and the unit tests, a small collapse, its
# restart and two ranks under valgrind. Several hours on two cores, not part of ctest. A build that is
# there goes on.
#
#   tests/sanitize.sh [--only PART]... [--tests REGEX] [-o DIR]
#
# --only PART    asan, leaks (both with the build of its own) or valgrind (with build/lmp, which
#                tools/build.sh makes); default: all of them
# --tests REGEX  of asan only these tests, as ctest -R
# -o DIR         output folder (default: build/sanitize)
# JOBS=<n>       number of compilers at a time (default 2). ccache is used if it is installed.
# LAMMPS_SOURCE_DIR: the LAMMPS source tree (default: the one that tools/setup.sh fetches)
#
# What is found is in DIR, a file per process, and shown at the end. Undefined behaviour inside of
# LAMMPS is listed, and is no failure. Memory that Open MPI never frees is left out: valgrind knows
# it by openmpi.supp, LeakSanitizer by having no function of LAMMPS or the package in its stack.
#
# Exit status: 0 if every test passed and nothing was found, 1 if not, 2 for wrong arguments.
set -euo pipefail
export LC_ALL=C

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
out=$top/build/sanitize
parts=() tests=

die() { echo "sanitize: $*" >&2; exit 2; }

while (($#)); do
  case $1 in
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit ;;
    --only | --tests | -o)
      (($# > 1)) || die "$1: value is missing"
      case $1 in
        --only) [[ $2 =~ ^(asan|leaks|valgrind)$ ]] || die "--only must be asan, leaks or valgrind, got $2"
                parts+=("$2") ;;
        --tests) tests=$2 ;;
        -o) out=$2 ;;
      esac
      shift 2 ;;
    *) die "unknown argument $1, see --help" ;;
  esac
done
((${#parts[@]})) || parts=(asan leaks valgrind)
mkdir -p "$out"
out=$(realpath "$out")
asan=$(realpath -m "$out/build") lmp=$top/build/lmp python=/usr/bin/python3
if [[ " ${parts[*]} " == *" valgrind "* ]]; then
  command -v valgrind >/dev/null || die "valgrind must be installed (Debian package valgrind)"
  [[ -x $lmp ]] || die "build/lmp must be there for valgrind, see tools/build.sh"
fi

# also for what valgrind runs, outside of ctest
export OMP_NUM_THREADS=1 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
# -O1: readable stacks; the run stops at no undefined behaviour, or LAMMPS' own would end every test
flags="-fsanitize=address,undefined -fno-omit-frame-pointer"
build() {
  local launcher=()
  command -v ccache >/dev/null && launcher=(-D CMAKE_CXX_COMPILER_LAUNCHER=ccache)
  cmake -S "$top" -B "$asan" -D CMAKE_BUILD_TYPE=RelWithDebInfo "${launcher[@]}" \
    -D CMAKE_CXX_FLAGS="$flags" -D CMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -g1" \
    -D LAMMPS_SOURCE_DIR="$(realpath "${LAMMPS_SOURCE_DIR:-$top/.lammps/source}")" >"$out/configure.log" 2>&1 &&
    cmake --build "$asan" -j "${JOBS:-2}" >"$out/build.log" 2>&1
}

status=0
# part NAME COMMAND...: run it, its output to DIR/NAME.log, what sanitizers say to DIR/NAME.PID
part() {
  local name=$1 began=$SECONDS result=ok
  shift
  rm -f "$out/$name".*
  "$@" >"$out/$name.log" 2>&1 || result=FAILED
  findings "$name" >"$out/$name.findings"
  [[ -s $out/$name.findings ]] && result=FOUND
  [[ $result == ok ]] || status=1
  printf '%-10s %-7s %5d s  %s\n' "$name" "$result" $((SECONDS - began)) "$(tail -n 1 "$out/$name.log")"
  head -n 40 "$out/$name.findings"
}

# what of the files DIR/NAME.PID is of the package or of LAMMPS: errors of memory in any case, undefined
# behaviour only in our files, leaks only with a function of ours or of LAMMPS
findings() {
  "$python" - "$top/src/" "$out/$1" <<'EOF'
import collections, glob, re, sys
src, prefix = sys.argv[1:]
lammps = collections.Counter()
for path in glob.glob(prefix + ".[0-9]*"):
    for block in re.split(r"\n(?=\S*:\d+:\d+: runtime error|Direct leak|Indirect leak|==\d+==ERROR|==\d+== \n)",
                          open(path, errors="replace").read()):
        undefined = re.search(r"^(\S+): runtime error: (.*)", block, re.M)
        if undefined and src not in undefined[1]:
            lammps[f"{undefined[1]}: {undefined[2][:90]}"] += 1
        elif re.search(r"^(Direct|Indirect) leak", block):
            if ("LAMMPS_NS" in block or src in block) and not re.search("ompi_mpi_(init|finalize)", block):
                print(block)
        elif undefined or ("Sanitizer" in block and "LeakSanitizer" not in block) or \
                re.search(r"^==\d+== +at ", block, re.M):
            print(block)
if lammps:
    with open(prefix + ".lammps", "w") as out:
        out.writelines(f"{count:6d} {what}\n" for what, count in lammps.most_common())
EOF
}

echo "part       result   time  (logs in $out)"
for name in "${parts[@]}"; do
  log=log_path=$out/$name
  case $name in
    asan | leaks)
      build || { echo "the build failed, see $out/build.log"; exit 1; }
      export ASAN_OPTIONS=detect_leaks=0:$log UBSAN_OPTIONS=print_stacktrace=1:$log ;;&
    asan)
      part asan ctest --test-dir "$asan" --output-on-failure -L 'unit|decks' ${tests:+-R "$tests"} ;;
    leaks)
      # Open MPI leaks, too: that must not be the exit status of a good run
      export LMP=$asan/lmp ASAN_OPTIONS=detect_leaks=1:fast_unwind_on_malloc=0:$log LSAN_OPTIONS=exitcode=0
      part leaks "$python" -m pytest -q -p no:cacheprovider "$top/tests/decks/test_again.py" ;;
    valgrind)
      unset ASAN_OPTIONS UBSAN_OPTIONS LSAN_OPTIONS
      memcheck=(valgrind --quiet --error-exitcode=9 --leak-check=full --num-callers=40 --log-file="$out/valgrind.%p"
        "--errors-for-leak-kinds=definite,indirect" "--show-leak-kinds=definite,indirect"
        --suppressions=/usr/share/openmpi/openmpi-valgrind.supp --suppressions="$top/tests/openmpi.supp")
      printf '#!/bin/bash\nexec %s "$@"\n' "$(printf '%q ' "${memcheck[@]}" "$lmp")" >"$out/lmp-valgrind"
      chmod +x "$out/lmp-valgrind"
      export LMP=$out/lmp-valgrind
      # shellcheck disable=SC2317 # by part
      memchecks() {
        for test in "$top"/build/tests/test_*; do
          # without those that take a second or more otherwise
          [[ -x $test && -f $test ]] && { "${memcheck[@]}" "$test" \
            --gtest_filter='-*Large*:*closed*:*no_way_under*:*AgreesWith*:*enormous*' || return 1; }
        done
        "$python" -m pytest -q -p no:cacheprovider "$top/tests/decks/test_again.py" -k same_numbers
      }
      part valgrind memchecks ;;
  esac
done
exit "$status"
