#!/bin/bash
# Builds everything, then runs lint.sh and the tests.
#
#   tests/run.sh            the short run: all tests but those with the label long, which are listed at the end
#   tests/run.sh --all      all tests; it ends with the share of the lines of the tools that they ran, and fails below 85 %
#   tests/run.sh ARGUMENT.. the tests that ctest chooses by these arguments, e.g. -L unit
#
# JOBS=<n> in the environment: number of compilers, and of tests, at a time (default 2).
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
floor=85
last=$top/build/last_all # what the last --all ended with

kind=chosen choice=("$@")
if (($# == 0)); then kind=short choice=(-LE "^long$"); fi
if [[ ${1-} == --all ]]; then
  (($# == 1)) || { echo "run: --all must be the only argument, got $*" >&2; exit 2; }
  kind=all choice=()
fi

"$top/tools/build.sh"
lint=0
"$top/tests/lint.sh" || lint=$?

# lines are counted by coverage, in the tests' own processes and in those that they start
counted=0
if [[ $kind == all ]] && /usr/bin/python3 -c "import coverage" 2>/dev/null; then
  counted=1
  export SLOPE_TOOLS_SOURCE=$top/tools/slope_tools SLOPE_COVERAGE=$top/build/coverage
  export COVERAGE_PROCESS_START=$top/tests/coverage/coverage.ini
  rm -rf "$SLOPE_COVERAGE"
  mkdir -p "$SLOPE_COVERAGE"
fi

tests=0 began=$SECONDS
ctest --test-dir "$top/build" -j "${JOBS:-2}" --output-on-failure "${choice[@]}" || tests=$?
took=$((SECONDS - began))

if ((counted)); then
  "$top/tests/coverage/report.sh" "$floor" || ((tests)) || tests=$?
fi

# what was not tested
sed -nE 's/^SKIPPED \[([0-9]+)\] (.*\/)?(.*)\.py:[0-9]+: (.*)/\1 \3: \4/p' \
  "$top/build/Testing/Temporary/LastTest.log" | awk '{ n = $1; $1 = ""; count[$0] += n }
    END { for (what in count) print "skipped: " count[what] " of" what }' | sort -k 4
if [[ $kind == short ]]; then
  echo "left out of the short run, see tests/run.sh --all:"
  ctest --test-dir "$top/build" -N -L "^long$" | sed -n 's/^ *Test *#[0-9]*: /  /p'
fi
if [[ $kind == all ]]; then
  echo "$(date "+%Y-%m-%d %H:%M"), commit $(git -C "$top" rev-parse --short HEAD 2>/dev/null || echo unknown)," \
    "$took s, $( ((tests)) && echo failed || echo passed)" >"$last"
fi
[[ $kind == chosen ]] || echo "last run of --all: $(cat "$last" 2>/dev/null || echo "none in this build")"
((tests == 0)) || exit "$tests"
exit "$lint"
