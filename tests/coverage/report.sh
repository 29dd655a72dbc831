#!/bin/bash
# Called by tests/run.sh with a floor (%): what the tests ran of the tools, the least covered modules first.
set -euo pipefail
coverage=(/usr/bin/python3 -m coverage)
unset COVERAGE_PROCESS_START # this is not to be counted
settings=$(dirname "${BASH_SOURCE[0]}")/coverage.ini

"${coverage[@]}" combine -q --rcfile="$settings" "$SLOPE_COVERAGE"
"${coverage[@]}" report --rcfile="$settings" --sort=cover > "$SLOPE_COVERAGE/report.txt"
echo "lines of the tools that the tests ran, the ten modules with the least, and all:"
sed -n '3,12p' "$SLOPE_COVERAGE/report.txt"
grep "^TOTAL" "$SLOPE_COVERAGE/report.txt"
"${coverage[@]}" report --rcfile="$settings" --fail-under="$1" > /dev/null || {
  echo "run: must be at least $1 % of the lines of tools/slope_tools: see $SLOPE_COVERAGE/report.txt" >&2
  exit 2
}
