"""What the language server says of a mission, over standard input and output."""

from __future__ import annotations

import pytest

pytest.importorskip("pygls", reason="the extra lsp isn't installed")

from functools import partial
from pathlib import Path
from typing import Any

from lsprotocol import types
from pygls.uris import from_fs_path

from tests.lsp.client import Client, client, run, text_at

PATROL = """patrol is go to the kitchen, then wave
the depot is at (3, 4)
# both
# of them
repeat 2 times:
    patrol
    go to the depot and nod twice
if the path is clear and the battery is full or bumped, wave
"""


def place(client: Client, text: str, words: str, inside: int = 1) -> types.Position:
    """The position inside the first of some words."""
    line, column = client.position(text, text.index(words) + inside)
    return types.Position(line, column)


def test_messages_come_with_corrections_and_readings() -> None:
    async def check() -> None:
        async with client() as editor:
            text = 'say "😀" then go to the labb\ngo to the lab or the dock and nod\nwave, nod if bumped\n'
            uri = editor.open("file:///nowhere/patrol.txt", text)
            [first, *_] = await editor.settled(uri)
            assert (first.code, first.severity, first.source) == ("BT013", types.DiagnosticSeverity.Error, "btlang")
            assert text_at(text, first.range) == "labb"
            assert first.message.endswith("Similar: lab, lobby, Bob")
            [action] = await editor.actions(uri, first.range)
            assert action.title == "Replace 'labb' with 'lab'"
            assert action.is_preferred
            assert editor.apply(text, action.edit) == text.replace("labb", "lab")
            text = "go to the lab and wave twice\nif bumped, wave and nod or look around\n"
            uri = editor.open("file:///nowhere/readings.txt", text)
            for message in await editor.settled(uri):
                for action in await editor.actions(uri, message.range):
                    assert editor.apply(text, action.edit) != text

    run(check())


def test_messages_follow_the_keys() -> None:
    """The key's own line first, and all of the text once typing rests."""

    async def check() -> None:
        async with client() as editor:
            uri = editor.open("file:///nowhere/patrol.txt", PATROL)
            assert [each.code for each in await editor.settled(uri)] == ["BT050", "BT050"]
            end = PATROL.count("\n")
            editor.change(uri, 2, ((end, 0, end, 0), "go to the attic\n"))
            assert [each.code for each in await editor.messages(uri, 2)] == ["BT050", "BT050", "BT013"]
            editor.change(uri, 3, ((0, 0, 0, 0), "\n\n"), ((end + 2, 10, end + 2, 15), "lab"))
            assert "BT013" not in [each.code for each in await editor.messages(uri, 3)]
            assert [each.code for each in await editor.settled(uri)] == ["BT050", "BT050"]
            editor.change(uri, 4, "wav\n")  # the whole text
            assert [each.code for each in await editor.settled(uri)] == ["BT010"]
            editor.text_document_did_close(types.DidCloseTextDocumentParams(types.TextDocumentIdentifier(uri)))
            assert await editor.messages(uri, None) == []

    run(check())


def test_what_is_shown_beside_a_text() -> None:
    async def check() -> None:
        async with client() as editor:
            uri = editor.open("file:///nowhere/patrol.txt", PATROL)
            document = types.TextDocumentIdentifier(uri)
            symbols = await editor.ask(editor.text_document_document_symbol_async, types.DocumentSymbolParams(document))
            assert [each.name for each in symbols] == [
                "patrol", "depot", "repeat 2 times:", "if the path is clear and the battery is full or bumped, wave",
            ]  # fmt: skip
            folds = await editor.ask(editor.text_document_folding_range_async, types.FoldingRangeParams(document))
            assert [(each.start_line, each.end_line) for each in folds] == [(2, 3), (4, 6)]
            everything = types.Range(types.Position(0, 0), types.Position(99, 0))
            hints = await editor.ask(editor.text_document_inlay_hint_async, types.InlayHintParams(document, everything))
            shown = PATROL.split("\n")
            for hint in sorted(hints, key=lambda hint: (hint.position.line, -hint.position.character), reverse=False):
                line, at = hint.position.line, hint.position.character
                shown[line] = shown[line][:at] + hint.label + shown[line][at:]
            assert shown[6] == "    go to the depot and (nod twice)"
            assert (
                shown[7] == "if ((path is clear and the battery is full) or bumped), wave".replace("((p", "((the p")
                or shown[7]
            )
            tokens = await editor.ask(
                editor.text_document_semantic_tokens_full_async, types.SemanticTokensParams(document)
            )
            colours = list(editor.colours(PATROL, tokens.data))
            assert ("patrol", "type") in colours
            assert ("# both", "comment") in colours
            assert ("if", "keyword") in colours
            assert ("path is clear", "property") in [(words.removeprefix("the "), kind) for words, kind in colours]
            lenses = await editor.ask(editor.text_document_code_lens_async, types.CodeLensParams(document))
            assert [(each.command.title, each.command.command, each.command.arguments) for each in lenses] == [
                ("Run", "btlang.run", (uri,)), ("Show tree", "btlang.tree", (uri,)),
            ]  # fmt: skip

    run(check())


def test_the_tree_is_drawn_of_what_is_understood() -> None:
    async def check() -> None:
        async with client(is_checked=False) as editor:
            uri = editor.open("file:///nowhere/patrol.txt", "wave\nfrobnicate\n")
            asked = {"textDocument": {"uri": uri}}
            found = await editor.ask(partial(editor.protocol.send_request_async, "btlang.drawTree"), asked)
            assert found.svg.startswith("<svg ")
            assert "wave" in found.svg
            assert not found.is_whole
            editor.change(uri, 2, "nod\n")
            found = await editor.ask(partial(editor.protocol.send_request_async, "btlang.drawTree"), asked)
            assert ("wave" in found.svg, "nod" in found.svg, found.is_whole) == (False, True, True)
            editor.change(uri, 3, "frobnicate\n")
            found = await editor.ask(partial(editor.protocol.send_request_async, "btlang.drawTree"), asked)
            assert found.svg == ""
            editor.change(uri, 4, "nod\n" * 2_000)  # so long that it's read once typing rests
            found = await editor.ask(partial(editor.protocol.send_request_async, "btlang.drawTree"), asked)
            assert "nod" in found.svg

    run(check())


def test_hovering_shows_what_was_understood_as_a_tree() -> None:
    async def check() -> None:
        async with client() as editor:
            text = PATROL + "frobnicate\n"  # the rest is understood
            uri = editor.open("file:///nowhere/patrol.txt", text)
            asked = types.HoverParams(types.TextDocumentIdentifier(uri), place(editor, text, "battery"))
            shown = await editor.ask(editor.text_document_hover_async, asked)
            assert text_at(text, shown.range) == "battery is full"
            assert shown.contents.value.startswith("```text\nbattery is full\n```\n")
            assert "├── Fallback" in shown.contents.value
            asked = types.HoverParams(types.TextDocumentIdentifier(uri), place(editor, text, "frobnicate"))
            assert await editor.ask(editor.text_document_hover_async, asked) is None

    run(check())


def test_completion() -> None:
    async def check() -> None:
        async with client() as editor:
            text = f"{PATROL}go to the \n"
            uri = editor.open("file:///nowhere/patrol.txt", text)
            line = text.count("\n") - 1
            asked = types.CompletionParams(types.TextDocumentIdentifier(uri), types.Position(line, 10))
            found = await editor.ask(editor.text_document_completion_async, asked)  # before all was read
            await editor.settled(uri)
            again = await editor.ask(editor.text_document_completion_async, asked)
            assert (
                [each.label for each in found.items[:2]]
                == ["depot", "dock"]
                == [each.label for each in again.items[:2]]
            )
            assert found.is_incomplete
            editor.change(uri, 2, ((line, 10, line, 10), "ki"))
            asked = types.CompletionParams(types.TextDocumentIdentifier(uri), types.Position(line, 12))
            [item, *_] = (await editor.ask(editor.text_document_completion_async, asked)).items
            assert (item.label, item.text_edit.new_text, item.filter_text) == ("kitchen", "kitchen", "kitchen")
            assert (item.text_edit.range.start.character, item.text_edit.range.end.character) == (10, 12)

    run(check())


def test_names_lead_to_their_places(tmp_path: Path) -> None:
    """Definitions, names of the world, included missions, and words in their keyword files."""
    (tmp_path / "kitchen.txt").write_text("tidy up is go to the pantry, then nod\n", encoding="utf-8")
    world = 'start = { x = 0, y = 0 }\nwalls = []\n[[places]]\nname = "pantry"\nx = 1\ny = 1\n'
    (tmp_path / "house.toml").write_text(world, encoding="utf-8")
    pack = '[[action]]\nphrase = "juggle"\nid = "Juggle"\ncall = "btlang.actions.gestures:wave"\nhelp = "x"\n'
    (tmp_path / "circus.toml").write_text(pack, encoding="utf-8")
    text = 'world "house.toml"\nwords "circus.toml"\ninclude "kitchen.txt"\n'
    text += "tidy up, then juggle\ngo to the pantry\ntidy up\n"

    async def check() -> None:
        async with client() as editor:
            uri = editor.open(from_fs_path(str(tmp_path / "main.txt")) or "", text)
            other = editor.open(
                from_fs_path(str(tmp_path / "kitchen.txt")) or "", (tmp_path / "kitchen.txt").read_text()
            )
            assert [each.message for each in await editor.settled(uri) if each.severity == 1] == []
            document = types.TextDocumentIdentifier(uri)

            async def lead(words: str) -> tuple[str, str]:
                asked = types.DefinitionParams(document, place(editor, text, words))
                found = await editor.ask(editor.text_document_definition_async, asked)
                path = Path(found.uri.removeprefix("file://"))
                return path.name, text_at(path.read_text(encoding="utf-8"), found.range)

            assert await lead("tidy up") == ("kitchen.txt", "tidy up")
            assert await lead("juggle") == ("circus.toml", "juggle")
            assert await lead("pantry") == ("house.toml", "pantry")
            assert await lead("kitchen.txt") == ("kitchen.txt", "")
            assert await lead("house.toml") == ("house.toml", "")
            assert (await lead("go to the p"))[0] == "navigation.toml"
            for with_declaration, count in ((True, 3), (False, 2)):
                context = types.ReferenceContext(with_declaration)
                asked = types.ReferenceParams(context, document, place(editor, text, "tidy up"))
                found = await editor.ask(editor.text_document_references_async, asked)
                assert len(found) == count
                assert [each.uri for each in found][:1] == ([other] if with_declaration else [uri])

    run(check())


def test_renaming() -> None:
    async def check() -> None:
        async with client() as editor:
            uri = editor.open("file:///nowhere/patrol.txt", PATROL)
            document, at = types.TextDocumentIdentifier(uri), place(editor, PATROL, "    patrol", 6)
            found = await editor.ask(editor.text_document_prepare_rename_async, types.PrepareRenameParams(document, at))
            assert found.placeholder == "patrol"
            edit = await editor.ask(editor.text_document_rename_async, types.RenameParams(document, at, "night round"))
            assert editor.apply(PATROL, edit) == PATROL.replace("patrol", "night round")
            for name, reason in (("wave", "in terms of itself"), ("", "characters")):
                with pytest.raises(Exception, match=reason):
                    await editor.ask(editor.text_document_rename_async, types.RenameParams(document, at, name))

    run(check())


def test_formatting() -> None:
    async def check() -> None:
        async with client() as editor:
            uri = editor.open("file:///nowhere/a.txt", "repeat 2 times:\n  wave\n  nod   then   wave\n")
            options = types.FormattingOptions(tab_size=4, insert_spaces=True)
            asked = types.DocumentFormattingParams(types.TextDocumentIdentifier(uri), options)
            [edit] = await editor.ask(editor.text_document_formatting_async, asked)
            made = editor.apply("repeat 2 times:\n  wave\n  nod   then   wave\n", _whole(uri, edit))
            assert made == "repeat 2 times:\n  wave\n  nod then wave\n"
            editor.change(uri, 2, made)
            assert await editor.ask(editor.text_document_formatting_async, asked) == ()
            editor.change(uri, 3, "frobnicate\n")
            assert await editor.ask(editor.text_document_formatting_async, asked) is None

    run(check())


def _whole(uri: str, *edits: Any) -> types.WorkspaceEdit:
    return types.WorkspaceEdit(changes={uri: list(edits)})
