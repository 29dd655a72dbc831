#!/bin/bash
# Builds everything, then runs lint.sh and every test. Arguments go to ctest, e.g. -L unit.
# JOBS=<n> in the environment: number of compilers, and of tests, at a time (default 2).
# Without arguments it ends with the share of the lines of the tools that the tests ran, and fails below 85 %.
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
floor=85

"$top/tools/build.sh"
lint=0
"$top/tests/lint.sh" || lint=$?

# lines are counted by coverage, in the tests' own processes and in those that they start
counted=0
if (($# == 0)) && /usr/bin/python3 -c "import coverage" 2>/dev/null; then
  counted=1
  export SLOPE_TOOLS_SOURCE=$top/tools/slope_tools SLOPE_COVERAGE=$top/build/coverage
  export COVERAGE_PROCESS_START=$top/tests/coverage/coverage.ini
  rm -rf "$SLOPE_COVERAGE"
  mkdir -p "$SLOPE_COVERAGE"
fi

tests=0
ctest --test-dir "$top/build" -j "${JOBS:-2}" --output-on-failure "$@" || tests=$?

if ((counted)); then
  "$top/tests/coverage/report.sh" "$floor" || ((tests)) || tests=$?
fi
((tests == 0)) || exit "$tests"
exit "$lint"
