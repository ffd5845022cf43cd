"""Positions and changes of texts, compared with the UTF-16 code units that the protocol counts."""

from __future__ import annotations

import pytest

pytest.importorskip("pygls", reason="the extra lsp isn't installed")

import re

from hypothesis import given
from hypothesis import strategies as st
from lsprotocol import types

from btlang.lsp.documents import MISSION, TABLES, TEST, TREE, Document
from btlang.lsp.positions import TextPositions
from tests.lsp.texts import changed, position_of
from tests.profiles import searches

TEXTS = st.text(st.sampled_from("ab é\n\r\u2028\x0c😀\t"), max_size=30)


@searches(40, 2_000)
@given(TEXTS, st.data())
def test_positions_are_utf_16(text: str, data: st.DataObject) -> None:
    at = data.draw(st.integers(0, len(text)))
    if text[at - 1 : at + 1] == "\r\n":  # no position is inside
        at -= 1
    position = TextPositions(text).position(at)
    assert (position.line, position.character) == position_of(text, at)
    assert TextPositions(text).offset(position) == at


@pytest.mark.parametrize(
    ("line", "column", "at"), [(0, 0, 0), (0, 99, 2), (1, 1, 3), (1, 2, 4), (1, 99, 4), (2, 0, 5), (9, 9, 5)]
)
def test_positions_outside_are_the_nearest(line: int, column: int, at: int) -> None:
    assert TextPositions("ab\n😀\n").offset(types.Position(line, column)) == at


@searches(40, 2_000)
@given(TEXTS, st.lists(st.tuples(st.integers(0, 30), st.integers(0, 30), TEXTS), max_size=4))
def test_a_document_changes_as_its_clients_text(text: str, edits: list[tuple[int, int, str]]) -> None:
    document = Document("file:///a.txt", "btlang", 1, text)
    for number, (start, end, new) in enumerate(edits, 2):
        first, last = sorted((min(start, len(text)), min(end, len(text))))
        place = types.Range(types.Position(*position_of(text, first)), types.Position(*position_of(text, last)))
        document.change(number, [types.TextDocumentContentChangePartial(place, new)])
        text = changed(text, (*position_of(text, first), *position_of(text, last)), new)
        assert document.text == text


def test_messages_move_with_the_text() -> None:
    document = Document("file:///a.txt", "btlang", 1, "wave\ngo to the labb\nnod\n")
    message = {"start": 15, "end": 19, "fix": {"start": 15, "end": 19, "text": "lab"}, "readings": [], "notes": []}
    document.messages = [message]
    document.change(2, [types.TextDocumentContentChangePartial(_range(0, 0, 0, 0), "nod\n")])
    assert (document.messages[0]["start"], document.messages[0]["fix"]["end"]) == (19, 23)
    document.change(3, [types.TextDocumentContentChangePartial(_range(2, 10, 2, 11), "")])
    assert document.messages == []


def _range(line: int, column: int, end_line: int, end_column: int) -> types.Range:
    return types.Range(types.Position(line, column), types.Position(end_line, end_column))


@pytest.mark.parametrize(
    ("name", "language", "kind"),
    [
        ("file:///a/patrol.txt", "btlang", MISSION), ("untitled:Untitled-1", "btlang", MISSION),
        ("file:///a/patrol.test.txt", "btlang", TEST), ("file:///a/world.toml", "toml", TABLES),
        ("file:///a/tree.xml", "xml", TREE), ("untitled:1", "xml", TREE), ("file:///a/p.btproj", "", TREE),
    ],
)  # fmt: skip
def test_what_a_document_is(name: str, language: str, kind: str) -> None:
    document = Document(name, language, 1, "")
    assert document.kind == kind
    assert document.path == (re.sub("^file://", "", name) if name.startswith("file") else "")
