"""The canonical layout: another tree never, the same text when done twice, all words and comments in their order."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from btlang.api import format_mission, parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.mission.reader import read_mission
from btlang.passes import compile_mission
from btlang.printer.layout import format_layout
from btlang.text.source import Source
from btlang.text.words import split
from btlang.tree.node import Tree
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.load import load_vocabulary
from tests.examples.cases import world_of
from tests.language import sentences
from tests.language.letters import letters
from tests.printer.test_sentence import MISSIONS
from tests.profiles import cases, searches

_BLANKS = ["", " ", "  ", "\t", " \t ", "\u00a0", "\f", "\ufeff"]
_COMMENTS = ["", "", "", "# one", "#", '#two "x', "# (;,.  a \t b", "# it's # here"]
_few = st.integers(0, 3)


@st.composite
def mangled(draw: st.DrawFn) -> str:
    """A mission whose layout nobody would choose."""
    text = sentences.english(draw(sentences.missions))
    if draw(st.booleans()):
        text = text.replace("\n", "\nprint 'a  b # c' then say \"d ,e\"\n", draw(st.integers(0, 1)))
    step, end = draw(st.sampled_from(["  ", "\t", "   ", " "])), draw(st.sampled_from(["\n", "\r\n"]))
    margin = draw(st.sampled_from(["", "  ", "\t"]))
    blank, comment = st.sampled_from(_BLANKS), st.sampled_from(_COMMENTS)
    lines: list[str] = []
    for line in text.split("\n"):
        lines += draw(st.lists(st.builds(lambda gap, n, note: gap * n + note, blank, _few, comment), max_size=2))
        content = line.lstrip(" ")
        level = (len(line) - len(content)) // 2
        parts = re.findall(r"'[^']*'|\"[^\"]*\"|[\w']+|[^\w\s]", content)
        spread = "".join(f"{draw(_gap(left, right))}{right}" for left, right in zip(["", *parts], parts, strict=False))
        lines.append(margin + step * level + spread + draw(blank) + (draw(comment) if parts else ""))
    return end.join(lines)


def _gap(left: str, right: str) -> st.SearchStrategy[str]:
    """Blanks between two words; there need be none beside a mark."""
    if not left:
        return st.just("")
    apart = left[-1].isalnum() and right[0].isalnum()
    apart = apart or "'" in (left[-1], right[0])
    return st.sampled_from([blank for blank in _BLANKS if blank or not apart])


def compiled(text: str, vocabulary: Lexicon) -> Tree:
    return compile_mission(read_mission(Source(text), vocabulary).mission, vocabulary, needs_command=False)


def comments(text: str) -> list[str]:
    """In order, without blanks at their ends; what is quoted is no comment."""
    bare = re.sub(r"\"[^\"\n]*\"|(?<!\w)'[^'\n]*'(?!\w)|(#[^\n]*)", lambda found: found[1] or "", text)
    return [comment.strip(" \t\r\f\u00a0\ufeff") for comment in re.findall(r"#[^\n]*", bare)]


def check_layout(text: str, vocabulary: Lexicon) -> None:
    before = split(Source(text), vocabulary.orthography)
    done = format_layout(Source(text), vocabulary.orthography)
    assert format_layout(Source(done), vocabulary.orthography) == done
    after = split(Source(done), vocabulary.orthography)
    assert [w for w in after.words if w != "\n"] == [w for w in before.words if w != "\n"]
    assert len(after.lines) == len(before.lines)
    assert len(after.articles) == len(before.articles)
    assert compiled(done, vocabulary) == compiled(text, vocabulary)
    assert comments(done) == comments(text)
    assert "".join(done.split()) == "".join(text.replace("\ufeff", "").split())
    assert not re.search(r"[ \t\r]$|\n\n\n|\A\n", done, re.MULTILINE)
    assert done.endswith("\n")
    assert not done.endswith("\n\n")


@searches(30, 3000)
@given(mangled())
@example('u then(say"a"then say"b" );v.w')
@example("if p:\n        # deep\n    u\n  # between\n    v\n# out\nw")
@example("u 3 times.2 .5 s")
def test_any_layout(text: str) -> None:
    try:
        compiled(text, letters())
    except MissionError:
        return
    check_layout(text, letters())


@cases("path", MISSIONS, usual=34, first=1, ids=lambda path: path.stem)
def test_missions_that_ship(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(path.parent)  # where it includes from
    text = path.read_bytes().decode("utf-8")
    where = world_of(path, text)
    done = format_mission(Source(text, str(path), may_load=True), world=where)
    assert format_mission(Source(done, str(path), may_load=True), world=where) == done
    trees = [parse_tree(Source(laid, str(path), may_load=True), world=where).tree for laid in (text, done)]
    assert trees[0] == trees[1]
    assert comments(done) == comments(text)


LAYOUTS = [
    ("wave", "wave\n"),
    ("  wave\r\n  nod", "wave\nnod\n"),
    ("wave ,nod,then   turn left .Stop !", "wave, nod, then turn left. Stop!\n"),
    ("wave ;nod;;stop", "wave; nod;; stop\n"),
    ("( wave then nod )twice", "(wave then nod) twice\n"),
    ("wave then(nod)", "wave then (nod)\n"),
    ("say\"a  b\"then say  'c ,d' ", "say \"a  b\" then say 'c ,d'\n"),
    ("move forward 1.5 m.move forward 2m", "move forward 1.5 m. move forward 2m\n"),
    ("turn left -5 degrees (then", None),
    ("hut is at(3 ,4)facing  90  degrees;wave", "hut is at (3, 4) facing 90 degrees; wave\n"),
    ("in parallel :\n wave\n say hi", "in parallel:\n  wave\n  say hi\n"),
    ("charge to 20 % . wave", "charge to 20 %. wave\n"),
    ("\n\n\nwave\n\n\n\nnod\n\n", "wave\n\nnod\n"),
    ("if bumped :\n\twave#now\n\totherwise : nod", "if bumped:\n  wave  #now\n  otherwise: nod\n"),
    ("if bumped :\n\twave#now\n\notherwise :\n\n      nod", "if bumped:\n  wave  #now\n\notherwise:\n\n  nod\n"),
    ("repeat:\n   wave\n   # in\n# out\nnod", "repeat:\n  wave\n  # in\n# out\nnod\n"),
    ("repeat:\n   # first\n   wave\n # last", "repeat:\n  # first\n  wave\n# last\n"),
    ("#a\n   wave   # b \t\n#c", "#a\nwave  # b\n#c\n"),
    ("say “Hello ,  you”", "say “Hello ,  you”\n"),
    ("wave and\u00a0nod\f", "wave and nod\n"),
    ("bow is wave", "bow is wave\n"),
    ("if bumped:\n wave,  # one\n  # two\n   nod,\n  then stop\n wave",
     "if bumped:\n  wave,  # one\n      # two\n      nod,\n      then stop\n  wave\n"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "expected"), LAYOUTS, ids=[repr(text) for text, _ in LAYOUTS])
def test_layout(text: str, expected: str | None) -> None:
    if expected is None:
        with pytest.raises(MissionError):
            format_mission(text)
        return
    assert format_mission(text) == expected
    check_layout(text, load_vocabulary())
