"""Small mistakes in good files: each is read, or gets a message; what is read can be written and read again."""

from __future__ import annotations

import random
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TypeVar

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.frontends.btcpp.origin import XmlOrigin
from btlang.frontends.btcpp.reader import read_xml
from btlang.text.source import Source
from tests.corpus.same import content, written
from tests.profiles import amount

Made = TypeVar("Made")
GOOD = sorted((Path(__file__).parent / "good").glob("*.xml"))
ROUNDS = amount(15, 400)
_PIECES = (
    "<",
    ">",
    "/",
    '"',
    "'",
    "&",
    "--",
    "<!--",
    "-->",
    "=",
    " ",
    "\n",
    "ID",
    "é",
    "<Wave/>",
    "</Sequence>",
    "{",
    "]]>",
    "<?",
)


def mutated(text: str, draw: random.Random) -> str:
    """With a part taken away, doubled, moved or put in."""
    first = draw.randrange(len(text))
    last = min(len(text), first + draw.choice((1, 1, 2, 5, 20)))
    kind = draw.randrange(4)
    if kind == 0:
        return text[:first] + text[last:]
    if kind == 1:
        return text[:last] + text[first:]
    if kind == 2:
        to = draw.randrange(len(text))
        return text[:to] + text[first:last] + text[to:]
    return text[:first] + draw.choice(_PIECES) + text[first:]


def made_or_told(make: Callable[[], Made]) -> tuple[Made | None, set[str]]:
    """What was made, or the codes of what is wrong."""
    try:
        return make(), set()
    except MissionError as error:
        assert str(error)  # noqa: PT017, it can be shown
        return None, {problem.code for problem in error.diagnostics}


@pytest.mark.long
@pytest.mark.parametrize("path", GOOD, ids=lambda path: path.stem)
def test_mistakes(path: Path) -> None:
    draw = random.Random(path.stem)
    text = read_source(str(path)).text
    for _ in range(ROUNDS):
        source = Source(mutated(text, draw), str(path))
        tree, codes = made_or_told(partial(read_xml, source))
        if tree is None:
            assert all(code.startswith("BT12") for code in codes)
            continue
        assert isinstance(tree.origin, XmlOrigin)
        again, codes = made_or_told(partial(written, tree, tree.origin.dialect))
        other, more = made_or_told(partial(written, tree, 7 - tree.origin.dialect))
        if again is None or other is None:
            assert codes | more == {"BT129"}
            continue
        assert content(again) == content(source.text)
        assert read_xml(Source(again, str(path))) == tree
        assert read_xml(Source(other, str(path))) == tree
