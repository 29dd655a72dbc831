#!/bin/bash
# Layout of the C++ (clang-format), style and types of the Python (flake8, mypy), static analysis of the C++ (cppcheck).
# Prints what is wrong, and ends with status 1 if anything is. JOBS=<n>: processes at a time (default 2).
set -euo pipefail
export LC_ALL=C

cd "$(dirname "${BASH_SOURCE[0]}")/.."
failed=0

for program in clang-format flake8 mypy cppcheck; do
  command -v "$program" >/dev/null || { echo "lint: $program is not there: run tools/setup.sh" >&2; exit 2; }
done

# --- layout: src/.clang-format ---

for file in src/*.h src/*.cpp src/plugin/*.cpp; do
  if ! clang-format --style=file --dry-run -Werror "$file" >/dev/null 2>&1; then
    echo "lint: $file: run clang-format -i on it; it would change"
    clang-format --style=file "$file" | diff "$file" - | head -n 20 || true
    failed=1
  fi
done

# --- Python: .flake8 ---

flake8 || failed=1

# --- types of the tools: mypy.ini ---

mypy --no-error-summary || failed=1

# --- static analysis: what is known stands in cppcheck.txt ---

mkdir -p build/cppcheck # what has not changed is not looked at again
cppcheck --std=c++11 --language=c++ -j "${JOBS:-2}" --cppcheck-build-dir=build/cppcheck \
  --enable=warning,style,performance,portability --suppressions-list=tests/cppcheck.txt --quiet --error-exitcode=1 \
  -I src --suppress=missingInclude --suppress=missingIncludeSystem --suppress=unmatchedSuppression \
  --template='lint: {file}:{line}: {severity}: {message} ({id})' src || failed=1

((failed)) || echo "lint: clean"
exit "$failed"
