#!/bin/bash
# Are faults that are put into the code on purpose found by the short run? See mutants/mutants.py.
exec nice -n 10 /usr/bin/python3 "$(dirname "${BASH_SOURCE[0]}")/mutants/mutants.py" "$@"
