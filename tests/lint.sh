#!/bin/bash
# Layout of the C++ (clang-format), style and types of the Python (flake8, mypy), static analysis of the C++ (cppcheck).
# Prints what is wrong, and ends with status 1 if anything is. JOBS=<n>: processes at a time (default 2).
set -euo pipefail
export LC_ALL=C

cd "$(dirname "${BASH_SOURCE[0]}")/.."
failed=0

# has PROGRAM WHAT: whether it is there; tools/setup.sh leaves out what cannot be had
skipped=0
has() {
  command -v "$1" >/dev/null || { echo "lint: $1 is not installed: $2 is not looked at"; skipped=1; return 1; }
}
# each of clang-format's versions has a layout of its own: the sources have that of this one
layout_of=14
same_layout() {
  local version
  version=$(clang-format --version | sed -E 's/.*version ([0-9]+).*/\1/')
  [[ $version == "$layout_of" ]] || {
    echo "lint: clang-format is version $version, the layout is of version $layout_of: it is not looked at"
    skipped=1
    return 1
  }
}

# --- layout: src/.clang-format ---

files=()
has clang-format "the layout of the C++" && same_layout && files=({src,tools/dump2vtk}/*.h {src,src/plugin,tools/dump2vtk}/*.cpp)
for file in "${files[@]}"; do
  if ! clang-format --style=file:src/.clang-format --dry-run -Werror "$file" >/dev/null 2>&1; then
    echo "lint: $file: run clang-format -i --style=file:src/.clang-format on it; it would change"
    clang-format --style=file:src/.clang-format "$file" | diff "$file" - | head -n 20 || true
    failed=1
  fi
done

# --- Python: .flake8 ---

if has flake8 "the Python"; then flake8 || failed=1; fi

# --- types of the tools: mypy.ini ---

if has mypy "the types of the Python"; then mypy --no-error-summary || failed=1; fi

# --- static analysis: what is known stands in cppcheck.txt ---

if has cppcheck "the C++"; then
  mkdir -p build/cppcheck # what has not changed is not looked at again
  cppcheck --std=c++11 --language=c++ -j "${JOBS:-2}" --cppcheck-build-dir=build/cppcheck \
    --enable=warning,style,performance,portability --suppressions-list=tests/cppcheck.txt --quiet --error-exitcode=1 \
    -I src --suppress=missingInclude --suppress=missingIncludeSystem --suppress=unmatchedSuppression \
    --template='lint: {file}:{line}: {severity}: {message} ({id})' src tools/dump2vtk || failed=1
fi

((failed)) || { ((skipped)) && echo "lint: clean, but for what was not looked at" || echo "lint: clean"; }
exit "$failed"
