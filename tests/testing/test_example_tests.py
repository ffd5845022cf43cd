"""The shipped examples have tests, which pass and which notice when a mission is changed."""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.testing.runner import run_test
from btlang.testing.test_file import read_tests
from tests.profiles import amount
from tests.testing.mutations import mutations

ROOT = Path(__file__).parent.parent.parent
EXAMPLES = sorted(path.stem for path in (ROOT / "examples").glob("*.txt"))
CAUGHT = 0.8
"""The share of all mutations that the tests of the examples must notice."""


def survivors(example: str) -> tuple[int, list[str]]:
    """How many mutations a mission has, and which of them no test notices."""
    os.chdir(ROOT)
    tests = read_tests(read_source(f"examples/tests/{example}.test.txt"))
    missed: list[str] = []
    count = 0
    for mutation in mutations(tests[0].mission):
        count += 1
        try:
            noticed = any(not run_test(test, mission=mutation.mission).passed for test in tests)
        except MissionError:
            noticed = True  # it can't run
        if not noticed:
            missed.append(f"{example}: {mutation.what}")
    return count, missed


@pytest.mark.long
@pytest.mark.parametrize("example", EXAMPLES)
def test_each_example_has_tests_that_pass(example: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """One of each example in each run, all in the long profile."""
    monkeypatch.chdir(ROOT)
    tests = read_tests(read_source(f"examples/tests/{example}.test.txt"))
    assert tests
    for test in tests[: amount(1, len(tests))]:
        assert run_test(test).problem == ""


@pytest.mark.long
def test_mutations_of_the_examples_are_noticed(capsys: pytest.CaptureFixture[str]) -> None:
    """All mutations of all examples in the long profile, with a report; those of a small one in each run."""
    chosen = EXAMPLES[: amount(0, len(EXAMPLES))] or ["coffee_round"]
    with ProcessPoolExecutor(amount(1, os.cpu_count() or 1), get_context("spawn")) as pool:
        found = list(pool.map(survivors, chosen))
    count, missed = sum(number for number, _ in found), [what for _, each in found for what in each]
    with capsys.disabled():
        print(f"\n{count - len(missed)} of {count} mutations noticed; not: ", *missed, sep="\n  ")
    assert count - len(missed) >= CAUGHT * count
