"""Of all tests in Python."""


def pytest_configure(config):
    config.addinivalue_line("markers", "long: not part of the short run of tests/run.sh; an entry of ctest of its own")
