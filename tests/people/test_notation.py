"""The samples are well formed: their trees are in the notation, of nodes that are known, with words that load."""

from __future__ import annotations

import re

import pytest

import btlang
from btlang.tree.catalogue import CATALOGUE
from btlang.vocabulary.load import load_vocabulary
from btlang.vocabulary.shipped import ENGLISH
from tests.people.notation import FOLDER, parsed, samples, written

NEW = {"Choose", "TimeOfDay", "WaitForTime"}
"""Nodes of sentences that the language doesn't read yet."""
PACK, WORLD = str(FOLDER / "people.toml"), str(FOLDER / "world.toml")
SAMPLES = samples()


def test_there_are_enough_of_each_kind() -> None:
    files = {path.name for path in FOLDER.glob("*.txt")}
    assert all(sum(sample.file == file for sample in SAMPLES) >= 25 for file in files)
    assert len(SAMPLES) >= 200
    assert len({sample.text for sample in SAMPLES}) == len(SAMPLES)
    assert sum(sample.refused or sample.warned for sample in SAMPLES) >= 10
