"""Small mistakes in sound missions: never a traceback, the same from both parsers, and mostly the right suggestion."""

from __future__ import annotations

from collections import Counter

import pytest

from tests.benchmarks.mutations import checked, cure_of, mutants
from tests.profiles import amount


@pytest.mark.long
def test_mutations() -> None:
    cures: Counter[str] = Counter()
    for mutant in mutants(amount(320, 3600), 3):
        result = checked(mutant)
        assert not result.crash, f"{mutant.where}\n{mutant.text}\n{result.crash}"
        if mutant.kind == "misspelt" and result.tree is None:
            cures[cure_of(mutant, result.problems)] += 1
    assert cures["repairs it"] >= 0.9 * (cures.total() - cures["another word"]), cures
