"""Python reads this file first where its folder is on PYTHONPATH, as in the tests: lines that run are counted then."""
import gc
import os

if os.environ.get("SLOPE_GARBAGE") == "stays":      # looking for it takes a quarter of a linter's time
    gc.disable()
try:
    import coverage
except ImportError:
    pass
else:
    coverage.process_startup()      # if COVERAGE_PROCESS_START names a file of settings
