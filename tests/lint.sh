#!/bin/bash
# Layout of the C++ (clang-format), style and types of the Python (flake8, mypy), static analysis of the C++ (cppcheck), the
# pages as HTML (sphinx-build).
# Arguments: which of these programs, default all. Prints what is wrong, and ends with status 1 if anything is, with 77 if all
# was skipped. What a program had nothing to say of, build/lint, it does not look at again. JOBS=<n>: processes at a time
# (default 2).
set -euo pipefail
export LC_ALL=C

cd "$(dirname "${BASH_SOURCE[0]}")/.."
export PYTHONPATH=$PWD/tests/coverage SLOPE_GARBAGE=stays
programs=("$@")
(($#)) || programs=(clang-format flake8 mypy cppcheck sphinx-build)
failed=0 ran=0
mkdir -p build/lint
exec 9>build/lint/lock
flock 9 # tests/run.sh begins it beside the build, and its tests may come to it before it is done

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

# clean PROGRAM FILES COMMAND..: run a command, unless it had nothing to say of the files that these words of find name
clean() {
  local program=$1 now
  # shellcheck disable=SC2086
  now=$( { "$program" --version && find . \( -path ./build -o -path ./.lammps -o -path ./.git \) -prune -o -type f $2 -print0 |
    sort -z | xargs -0 sha256sum && sha256sum tests/lint.sh; } 2>&1 | sha256sum)
  if [[ $(cat "build/lint/$program" 2>/dev/null) != "$now" ]]; then
    rm -f "build/lint/$program"
    if "${@:3}"; then echo "$now" >"build/lint/$program"; else failed=1; fi
  fi
}
sources="( -path ./src/* -o -path ./tools/dump2vtk/* -o -path ./tests/cppcheck.txt )"
set -f # the words of find are its own

# --- layout: src/.clang-format ---

layout() {
  local files wrong file layout=(clang-format --style=file:src/.clang-format)
  mapfile -t files < <(find src tools/dump2vtk -name "*.h" -o -name "*.cpp" | sort)
  mapfile -t wrong < <("${layout[@]}" --dry-run "${files[@]}" 2>&1 | sed -n 's/^\([^: ]*\):.*-Wclang-format-violations.*/\1/p' | sort -u)
  for file in "${wrong[@]}"; do
    echo "lint: $file: run clang-format -i --style=file:src/.clang-format on it; it would change"
    "${layout[@]}" "$file" | diff "$file" - | head -n 20 || true
  done
  ((${#wrong[@]} == 0))
}
if usable clang-format "layout of the C++"; then clean clang-format "$sources" layout; fi

# --- Python: .flake8; types of the tools: mypy.ini ---

if usable flake8 "style of the Python"; then clean flake8 "( -name *.py -o -name slope -o -name .flake8 )" flake8; fi
if usable mypy "types of the Python"; then clean mypy "( -name *.py -o -name mypy.ini )" mypy --no-error-summary; fi

# --- static analysis: what is known stands in cppcheck.txt ---

analysis() {
  local rooms check others failed=0
  mkdir -p build/cppcheck # each file alone
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
  return "$failed"
}
if usable cppcheck "static analysis of the C++"; then clean cppcheck "$sources" analysis; fi

# --- pages: every reference resolves, and every formula renders ---

if usable sphinx-build "the pages"; then
  clean sphinx-build "( -path ./doc/* -o -name slope_version.h )" \
    sphinx-build -W --keep-going -q -E -d build/tests/doctrees doc/src build/tests/html
fi

((failed)) || { ((skipped)) && echo "lint: clean, but for what was skipped" || echo "lint: clean"; }
((failed || ran)) || exit 77
exit "$failed"
