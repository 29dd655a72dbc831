#!/bin/bash
# Builds everything, lint and pages beside it, then runs the tests: those in C++ by ctest, those in Python by pytest.
#
#   tests/run.sh             the short run: all tests but those with the mark long
#   tests/run.sh --all       all tests; it ends with the share of the lines of the tools that they ran, and fails below 85 %
#   tests/run.sh --changed [COMMIT]
#                            the tests that what differs from a commit (default HEAD) can touch, see tests/changed.py
#   tests/run.sh ARGUMENT..  the tests that ctest chooses by these arguments, e.g. -L unit or -R tools.site
#
# The short run and --all keep the times of all tests in build/times.csv. --times also writes those of files into
# tests/times.csv, which says which files begin first: after the short run.
# JOBS=<n> in the environment: number of compilers, and of tests in C++, at a time (default 2). Two more of those in Python, as
# they wait for what they start.
set -euo pipefail
export LC_ALL=C

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
jobs=${JOBS:-2}
floor=85
last=$top/build/last_all # what the last --all ended with

kind=short keep_times=0 commit=HEAD most=1
case ${1-} in
  "") ;;
  --times) keep_times=1 ;;
  --all) kind=all ;;
  --changed) kind=changed commit=${2-HEAD} most=2 ;;
  *) kind=chosen ;;
esac
if [[ $kind != chosen ]] && (($# > most)); then
  echo "run: $1 must be the only argument, got $*" >&2
  exit 2
fi

if [[ $kind != chosen ]]; then
  "$top/tools/setup.sh"
  # beside the build, whose beginning leaves processors free: the tests find what it had nothing to say of
  JOBS=1 "$top/tests/lint.sh" &>/dev/null &
fi
"$top/tools/build.sh"
built=$SECONDS
if [[ $kind == chosen ]]; then
  exec ctest --test-dir "$top/build" -j "$jobs" --output-on-failure "$@"
fi

# lines are counted by coverage, in the tests' own processes and in those that they start
counted=0
if [[ $kind == all ]] && /usr/bin/python3 -c "import coverage" 2>/dev/null; then
  counted=1
  export SLOPE_TOOLS_SOURCE=$top/tools/slope_tools SLOPE_COVERAGE=$top/build/coverage
  export COVERAGE_PROCESS_START=$top/tests/coverage/coverage.ini
  rm -rf "$SLOPE_COVERAGE"
  mkdir -p "$SLOPE_COVERAGE"
fi

# files of the tests, which go at the end; and cases that several of them work on, see tests/conftest.py
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export SLOPE_SHARED=$work/shared SLOPE_TIMES=$top/build/times.csv TMPDIR=$work
mkdir "$SLOPE_SHARED"
: >"$SLOPE_TIMES"

units=(-L unit) files=("$top/tests/decks" "$top/tests/tools") mark=()
if [[ $kind == short ]]; then mark=(-m "not long"); fi
if [[ $kind == changed ]]; then
  mark=(-m "not long")
  mapfile -t files < <("$top/tests/changed.py" "$commit" "$work/units")
  units=(-R "$(cat "$work/units")")
fi

failed=0
ctest --test-dir "$top/build" -j "$jobs" --output-on-failure "${units[@]}" >"$work/ctest.log" &
ctest=$!
# in a fresh build: Python compiles the tests and the tools once, not in each of the workers
if ((${#files[@]})) && [[ ! -d $top/build/tests/pycache ]]; then
  sh "$top/build/tests/pytest.sh" --collect-only "${files[@]}" >/dev/null || true
fi
if ((${#files[@]})); then
  sh "$top/build/tests/pytest.sh" -n "$((jobs + 2))" --dist loadfile --basetemp "$work/pytest" "${mark[@]}" "${files[@]}" |
    tee "$work/pytest.log" || failed=1
fi
wait "$ctest" || failed=1
grep -v " Passed " "$work/ctest.log" | sed '/^ *Start /d' || true
if ((counted)); then
  "$top/tests/coverage/report.sh" "$floor" || failed=1
fi

if [[ $kind != all ]]; then
  echo "left out, see tests/run.sh --all: $(grep -cE "pytest\.mark\.long" -r "$top/tests" --include="*.py" | awk -F: '
    $2 { n += $2; files++ } END { print n " marks long in " files " files" }')"
else
  echo "$(date "+%Y-%m-%d %H:%M"), commit $(git -C "$top" rev-parse --short HEAD 2>/dev/null || echo unknown)," \
    "$((SECONDS - built)) s, $( ((failed)) && echo failed || echo passed)" >"$last"
fi
echo "last run of --all: $(cat "$last" 2>/dev/null || echo "none in this build")"
keep=()
if ((keep_times)); then keep=(--keep); fi
"$top/tests/times.py" "$SLOPE_TIMES" "${keep[@]}"
# the sums of this shell's children: minutes and seconds
times >"$work/times" # not in a pipe, where it would be of another shell
awk -v built="$built" -v wall="$SECONDS" 'function s(t) { split(t, p, "m"); return p[1] * 60 + p[2] }
  NR == 2 { printf "wall %d s, build %d s of it; user %d s, system %d s, build included\n", wall, built, s($1), s($2) }' "$work/times"
awk '/tests passed, [0-9]+ tests failed out of/ { failed += $4; passed += $NF - $4 }
  / (passed|failed|error)/ && / in [0-9.]+s/ { gsub(/=/, ""); for (i = 2; i <= NF; i++) { if ($i ~ /^passed/) passed += $(i - 1)
    if ($i ~ /^(failed|error)/) failed += $(i - 1); if ($i ~ /^skipped/) skipped += $(i - 1) } }
  END { printf "%d passed, %d failed, %d skipped\n", passed, failed, skipped }' "$work"/*.log
exit "$failed"
