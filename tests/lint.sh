#!/bin/bash
# Layout of the C++ (clang-format), style of the Python (flake8), static analysis of the C++ (cppcheck).
# Prints what is wrong, and ends with status 1 if anything is. JOBS=<n>: processes at a time (default 2).
set -euo pipefail
export LC_ALL=C

cd "$(dirname "${BASH_SOURCE[0]}")/.."
failed=0

for program in clang-format flake8 cppcheck; do
  command -v "$program" >/dev/null || { echo "lint: $program is not there: run tools/setup.sh" >&2; exit 2; }
done

# --- layout: src/.clang-format, LAMMPS' own ---

# not yet laid out: off the list with each that is
unlaid=(
  src/ball_sweep.h src/contact_balls.h src/contact_energy.h src/contact_force.h src/contact_geometry.h
  src/contact_kernel.cpp src/contact_kernel.h src/contact_law.h src/contact_list.h src/contact_passes.h
  src/create_balls.cpp src/delete_balls.cpp src/deposit_blocks.h src/deposit_losses.h src/elevation_grid.cpp
  src/fix_deposit_grid.h src/fix_wall_gran_balls.cpp src/intervals.h src/lammps_compat.h src/lone_contact.h
  src/motion_record.cpp src/number_rows.cpp src/oscillator.h src/plan_line.cpp src/polygon.cpp src/polygon.h
  src/rank_zero.h src/region_columns.cpp src/region_polygon.cpp src/region_surface.cpp src/region_terrain.cpp
  src/style_argument.h src/yaml_text.h
)
for file in src/*.h src/*.cpp src/plugin/*.cpp; do
  laid=1
  clang-format --style=file --dry-run -Werror "$file" >/dev/null 2>&1 || laid=0
  if [[ " ${unlaid[*]:-} " == *" $file "* ]]; then
    ((laid)) && { echo "lint: $file is laid out well: take it off the list in tests/lint.sh"; failed=1; }
  elif ((!laid)); then
    echo "lint: $file: run clang-format -i on it; it would change"
    clang-format --style=file "$file" | diff "$file" - | head -n 20 || true
    failed=1
  fi
done

# --- Python: .flake8 ---

flake8 || failed=1

# --- static analysis: what is known stands in cppcheck.txt ---

mkdir -p build/cppcheck # what has not changed is not looked at again
cppcheck --std=c++11 --language=c++ -j "${JOBS:-2}" --cppcheck-build-dir=build/cppcheck \
  --enable=warning,style,performance,portability --suppressions-list=tests/cppcheck.txt --quiet --error-exitcode=1 \
  -I src --suppress=missingInclude --suppress=missingIncludeSystem --suppress=unmatchedSuppression \
  --template='lint: {file}:{line}: {severity}: {message} ({id})' src || failed=1

((failed)) || echo "lint: clean"
exit "$failed"
