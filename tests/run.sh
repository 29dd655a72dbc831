#!/bin/bash
# Builds everything, then runs lint.sh and every test. Arguments go to ctest, e.g. -L unit.
# JOBS=<n> in the environment: number of compilers, and of tests, at a time (default 2).
set -euo pipefail

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

"$top/tools/build.sh"
lint=0
"$top/tests/lint.sh" || lint=$?
ctest --test-dir "$top/build" -j "${JOBS:-2}" --output-on-failure "$@"
exit "$lint"
