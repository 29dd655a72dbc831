#!/bin/bash
# Layout of the C++ (clang-format), style and types of the Python (flake8, mypy), static analysis of the C++ (cppcheck).
# Arguments: which of these programs, default all. Prints what is wrong, and ends with status 1 if anything is, with 77 if all
# was skipped. JOBS=<n>: processes at a time (default 2).
set -euo pipefail
export LC_ALL=C

cd "$(dirname "${BASH_SOURCE[0]}")/.."
export PYTHONPATH=$PWD/tests/coverage SLOPE_GARBAGE=stays
programs=("$@")
(($#)) || programs=(clang-format flake8 mypy cppcheck)
failed=0 ran=0

# usable PROGRAM WHAT: whether it is asked for and there, in the version that the sources are clean with (Debian 12's; another
# one finds other things, and has another layout)
declare -A versions=([clang-format]=14 [mypy]=1.0 [cppcheck]=2.10)
skipped=0
usable() {
  local version wanted=${versions[$1]:-}
  [[ " ${programs[*]} " == *" $1 "* ]] || return 1
  if ! command -v "$1" >/dev/null; then
    echo "lint: $1 is not installed, skipped: $2"
  elif version=$("$1" --version | sed -nE '1s/^[^0-9]*([0-9.]+).*/\1/p') && [[ -n $wanted && $version. != "$wanted."* ]]; then
    echo "lint: $1 is version $version, the sources are clean with $wanted, skipped: $2"
  else
    ran=1
    return 0
  fi
  skipped=1
  return 1
}

# --- layout: src/.clang-format ---

if usable clang-format "layout of the C++"; then
  mapfile -t files < <(find src tools/dump2vtk -name "*.h" -o -name "*.cpp" | sort)
  layout=(clang-format --style=file:src/.clang-format)
  mapfile -t wrong < <("${layout[@]}" --dry-run "${files[@]}" 2>&1 | sed -n 's/^\([^: ]*\):.*-Wclang-format-violations.*/\1/p' | sort -u)
  for file in "${wrong[@]}"; do
    echo "lint: $file: run clang-format -i --style=file:src/.clang-format on it; it would change"
    "${layout[@]}" "$file" | diff "$file" - | head -n 20 || true
    failed=1
  done
fi

# --- Python: .flake8; types of the tools: mypy.ini ---

if usable flake8 "style of the Python"; then flake8 || failed=1; fi
if usable mypy "types of the Python"; then mypy --no-error-summary || failed=1; fi

# --- static analysis: what is known stands in cppcheck.txt ---

if usable cppcheck "static analysis of the C++"; then
  mkdir -p build/cppcheck # what has not changed is not looked at again
  mapfile -t rooms < <(find src -mindepth 1 -type d)
  check=(cppcheck --std=c++11 --language=c++ -j "${JOBS:-2}" --enable=warning,style,performance,portability --quiet
    --suppressions-list=tests/cppcheck.txt --error-exitcode=1 -I src "${rooms[@]/#/-I}" --suppress=missingInclude
    --suppress=missingIncludeSystem --suppress=unmatchedSuppression
    --template='lint: {file}:{line}: {severity}: {message} ({id})')
  # lines for other processors once, in the source that has all of simd4.h; what LAMMPS' lists of styles take is no source
  others=src/contacts/contact_kernel_baseline.cpp
  "${check[@]}" --cppcheck-build-dir=build/cppcheck -i "$others" -U__clang__ -U__AVX__ -U__AVX512F__ -U__FAST_MATH__ \
    -U{FIX,PAIR,REGION,COMMAND}_CLASS src tools/dump2vtk || failed=1
  "${check[@]}" "$others" || failed=1
fi

((failed)) || { ((skipped)) && echo "lint: clean, but for what was skipped" || echo "lint: clean"; }
((failed || ran)) || exit 77
exit "$failed"
