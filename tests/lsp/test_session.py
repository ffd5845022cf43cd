"""A long session of random edits: what a client sees in the end is what it would see had it just opened the text."""

from __future__ import annotations

import pytest

pytest.importorskip("pygls", reason="the extra lsp isn't installed")

from random import Random
from typing import Any

from lsprotocol import types

from tests.lsp.client import Client, client, run
from tests.lsp.texts import changed, position_of
from tests.profiles import amount

TEXT = """patrol is go to the kitchen, then wave
the depot is at (3, 4)
# all of it
repeat 2 times:
    patrol
    go to the depot and nod twice
if the path is clear and the battery is full or bumped, wave
remember the distance to Alice as gap
say "😀 hello" then nod
go to Bob, then wave at him
"""
PIECES = (
    "wave", " then ", "nod\n", "go to the lab", "go to the labb ", "\n", "\r\n", "\r", "    ", ",", '"', "(", ")", "é",
    "😀", "\u2028", "\x0c", "# ", "patrol", "patrol means nod\n", "the attic is at (1, 1)\n", "if bumped, ",
    "otherwise:\n", ":", "him", "twice", " and ", " or ", "\ufeff", "set count to 3\n", "{count}", "a",
)  # fmt: skip
ROUND = 40  # edits between two comparisons


def edited(random: Random, text: str) -> tuple[tuple[int, int, int, int], str]:
    """A random change: mostly a few characters at one place, rarely many."""
    start = random.randrange(len(text) + 1)
    length = random.choice((0, 0, 0, 1, 1, 2, 5, random.randrange(60)))
    end = min(start + length, len(text))
    new = "".join(random.choices(PIECES, k=random.choice((0, 1, 1, 1, 2)))) if len(text) < 900 else ""
    return (*position_of(text, start), *position_of(text, end)), new


async def shown(editor: Client, uri: str) -> list[Any]:
    """All that a client sees of a document."""
    document = types.TextDocumentIdentifier(uri)
    everything = types.Range(types.Position(0, 0), types.Position(9_999, 0))
    messages = await editor.settled(uri)
    return [
        [(each.range, each.code, each.message) for each in messages],
        [(each.title, each.edit and each.edit.changes and list(each.edit.changes.values()))
         for each in await editor.actions(uri, everything)],
        await editor.ask(editor.text_document_document_symbol_async, types.DocumentSymbolParams(document)),
        await editor.ask(editor.text_document_folding_range_async, types.FoldingRangeParams(document)),
        await editor.ask(editor.text_document_semantic_tokens_full_async, types.SemanticTokensParams(document)),
        await editor.ask(editor.text_document_inlay_hint_async, types.InlayHintParams(document, everything)),
    ]  # fmt: skip


@pytest.mark.long
def test_a_session_of_edits_ends_as_a_fresh_text() -> None:
    async def check() -> None:
        random, text = Random(7), TEXT
        async with client() as editor:
            uri = editor.open("file:///nowhere/session.txt", text)
            await editor.settled(uri)
            for number in range(amount(80, 10_000)):
                place, new = edited(random, text)
                text = changed(text, place, new)
                editor.change(uri, number + 2, (place, new))
                if random.random() < 0.1:
                    line, column = position_of(text, random.randrange(len(text) + 1))
                    asked = types.CompletionParams(types.TextDocumentIdentifier(uri), types.Position(line, column))
                    await editor.ask(editor.text_document_completion_async, asked)
                if number % ROUND == ROUND - 1:
                    fresh = editor.open("file:///nowhere/fresh.txt", text)
                    assert await shown(editor, uri) == await shown(editor, fresh), (number, text, editor.log)
                    assert editor.published[uri][-1].version == number + 2

    run(check())
