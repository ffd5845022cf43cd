"""Texts of which nothing is understood: one message, and each fault of those of which something is."""

from __future__ import annotations

import pytest

import btlang

_UNKNOWN = [f"qx{letter} zw{letter}" for letter in "abcdefgh"]


@pytest.mark.parametrize("parser", ["shunting-yard", "lark"])
@pytest.mark.parametrize(("lines", "told"), [(_UNKNOWN, 1), (_UNKNOWN[:4], 4), ([*_UNKNOWN, "wave"], 8)])
def test_what_is_told(lines: list[str], told: int, parser: str) -> None:
    with pytest.raises(btlang.MissionError) as refused:
        btlang.parse_tree("\n".join(lines), parser=parser)
    assert [problem.code for problem in refused.value.diagnostics] == ["BT010"] * told
