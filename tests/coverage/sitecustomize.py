"""Python reads this file first where tests/run.sh puts its folder on PYTHONPATH: lines that run are counted then."""
try:
    import coverage
except ImportError:
    pass
else:
    coverage.process_startup()      # if COVERAGE_PROCESS_START names a file of settings
