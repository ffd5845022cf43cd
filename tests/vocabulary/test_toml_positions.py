"""Where the keys of a TOML text stand."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from btlang.text.toml import Path as Keys
from btlang.text.toml import find_positions, nearest_position

ROOT = Path(__file__).parents[2]
TEXT = '''# a = 1
a = "x # [b]"  # not [b]
b.c = """
[[d]]
"""
"quoted key" = 'e = 3'
when = 1979-05-27 07:32:00

[[d]]
x = [ # items
  { y = 1, "z" = [true, [2]] },
  3,
]
[d.inner]
f = 1

[[d]]
x = 2

[d.inner]
f = 2
'''


@pytest.mark.parametrize(
    ("path", "line", "begins"),
    [
        (("a",), 2, "a ="),
        (("b", "c"), 3, "b.c"),
        (("b",), 3, "b.c"),
        (("quoted key",), 6, '"quoted key"'),
        (("d",), 9, "[[d]]"),
        (("d", 0, "x", 0, "z", 1, 0), 11, "2]"),
        (("d", 0, "x", 1), 12, "3,"),
        (("d", 0, "inner", "f"), 15, "f = 1"),
        (("d", 1, "x"), 18, "x = 2"),
        (("d", 1, "inner"), 20, "[d.inner]"),
        (("d", 1, "inner", "f"), 21, "f = 2"),
    ],
)
def test_positions(path: Keys, line: int, begins: str) -> None:
    at = find_positions(TEXT)[path]
    assert TEXT.count("\n", 0, at) + 1 == line
    assert TEXT[at:].startswith(begins)


def test_what_is_missing_is_where_it_would_be() -> None:
    found = find_positions(TEXT)
    assert nearest_position(found, ("d", 1, "inner", "g")) == found["d", 1, "inner"]
    assert nearest_position(found, ("g",)) is None


def paths(value: object, path: Keys = ()) -> list[Keys]:
    """All keys and items of a document."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path, *(found for key, item in inner for found in paths(item, (*path, key)))]


@pytest.mark.parametrize(
    "file", [*ROOT.glob("keywords/*/*.toml"), *ROOT.glob("btlang/robots/*/*.toml"), ROOT / "pyproject.toml"]
)
def test_all_keys_of_real_files_are_found(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    assert find_positions(text).keys() == {*paths(tomllib.loads(text))} - {()}


def test_texts_that_are_no_toml_or_too_deep_do_no_harm() -> None:
    for text in ("[", "a", "a = ", "[[a", "a = {", "a = [" * 9999, "\0", '"', "= 1"):
        find_positions(text)
