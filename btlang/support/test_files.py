"""The names of files of tests; apart from what reads them, which most commands don't need."""

ENDING = ".test.txt"
"""The ending of files in which `btc test` looks for tests."""


def is_test_file(path: str) -> bool:
    """Return whether a file has tests, by its name."""
    return path.endswith(ENDING)
