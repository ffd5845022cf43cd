"""What the language server says of tests, TOML files and trees in XML."""

from __future__ import annotations

import pytest

pytest.importorskip("pygls", reason="the extra lsp isn't installed")

from pathlib import Path

from lsprotocol import types
from pygls.uris import from_fs_path

from tests.lsp.client import client, run, text_at

TESTS = """test "it waves":
  run "wave.txt"
  then within 10 s the robot has said "hi"

test "it is broken":
  run "wave.txt"
  then it frobnicates
"""
WORDS = """[[action]]
phrase = "juggle"
id = "Juggle"
call = "circus.acts:juggle"
needs = [""]
colour = "red"
"""
WORLD = """start = { x = 0, y = 0 }
walls = []
[[places]]
name = "pantry"
x = 1
"""
ROBOT = """name = "rover"
radius = -1
"""
XML = """<root BTCPP_format="4" main_tree_to_execute="Main">
  <BehaviorTree ID="Main">
    <Sequence>
      <SubTree ID="Round"/>
      <Drive place="lab"/>
    </Sequence>
  </BehaviorTree>
  <BehaviorTree ID="Round">
    <Drvie place="dock"/>
  </BehaviorTree>
  <TreeNodesModel>
    <Action ID="Drive"><input_port name="place"/></Action>
  </TreeNodesModel>
</root>
"""


def test_tests(tmp_path: Path) -> None:
    (tmp_path / "wave.txt").write_text("wave\n", encoding="utf-8")
    (tmp_path / "wave.test.txt").write_text(TESTS, encoding="utf-8")

    async def check() -> None:
        async with client() as editor:
            uri = editor.open(from_fs_path(str(tmp_path / "wave.test.txt")) or "", TESTS)
            document = types.TextDocumentIdentifier(uri)
            assert [text_at(TESTS, each.range) for each in await editor.settled(uri)][-1] == "it frobnicates"
            symbols = await editor.ask(editor.text_document_document_symbol_async, types.DocumentSymbolParams(document))
            assert [(each.name, each.range.end.line) for each in symbols] == [("it waves", 2), ("it is broken", 6)]
            lenses = await editor.ask(editor.text_document_code_lens_async, types.CodeLensParams(document))
            assert [each.command.arguments for each in lenses] == [
                (uri,), (uri, "it waves"), (uri, "it is broken"),
            ]  # fmt: skip
            asked_file = types.DefinitionParams(document, types.Position(1, 8))
            found = await editor.ask(editor.text_document_definition_async, asked_file)
            assert found.uri == from_fs_path(str(tmp_path / "wave.txt"))
            editor.change(uri, 2, ((7, 0, 7, 0), "  fin"))
            asked = types.CompletionParams(document, types.Position(7, 5))
            found = await editor.ask(editor.text_document_completion_async, asked)
            assert [each.label for each in found.items] == ["finally"]
            mission = editor.open(from_fs_path(str(tmp_path / "wave.txt")) or "", "wave\n")
            asked_lens = types.CodeLensParams(types.TextDocumentIdentifier(mission))
            lenses = await editor.ask(editor.text_document_code_lens_async, asked_lens)
            assert [(each.command.title, each.command.arguments) for each in lenses][2:] == [("Test", (uri,))]

    run(check())


def test_tables() -> None:
    async def check() -> None:
        async with client() as editor:
            for name, text, code, words in (
                ("circus.toml", WORDS, "BT060", "colour"), ("house.toml", WORLD, "BT070", '"y"'),
                ("rover.toml", ROBOT, "BT071", "radius"), ("broken.toml", "[[places]]\nx = \n", "BT070", "TOML"),
            ):  # fmt: skip
                uri = editor.open(f"file:///nowhere/{name}", text, "toml")
                found = await editor.settled(uri)
                assert {each.code for each in found} == {code}
                assert any(words in each.message for each in found)
                assert await editor.ask(
                    editor.text_document_formatting_async,
                    types.DocumentFormattingParams(types.TextDocumentIdentifier(uri), types.FormattingOptions(4, True)),
                ) in ((), None)
            for name, position, label in (
                ("circus.toml", types.Position(4, 10), "navigation"), ("circus.toml", types.Position(5, 0), "achieves"),
                ("house.toml", types.Position(1, 0), "objects"), ("rover.toml", types.Position(1, 2), "joints"),
            ):  # fmt: skip
                asked = types.CompletionParams(types.TextDocumentIdentifier(f"file:///nowhere/{name}"), position)
                found = await editor.ask(editor.text_document_completion_async, asked)
                assert label in [each.label for each in found.items]
            document = types.TextDocumentIdentifier("file:///nowhere/house.toml")
            symbols = await editor.ask(editor.text_document_document_symbol_async, types.DocumentSymbolParams(document))
            assert [each.name for each in symbols] == ["start", "walls", 'places "pantry"']

    run(check())


def test_trees() -> None:
    async def check() -> None:
        async with client() as editor:
            uri = editor.open("file:///nowhere/tree.xml", XML, "xml")
            document = types.TextDocumentIdentifier(uri)
            found = await editor.settled(uri)
            [misspelt] = [each for each in found if "Drvie" in each.message]
            [action] = await editor.actions(uri, misspelt.range)
            assert editor.apply(XML, action.edit) == XML.replace("Drvie", "Drive")
            symbols = await editor.ask(editor.text_document_document_symbol_async, types.DocumentSymbolParams(document))
            assert [(each.name, each.range.end.line) for each in symbols] == [("Main", 6), ("Round", 9), ("Drive", 11)]
            for line, column, target in ((3, 21, (7, 20)), (4, 8, (11, 16))):
                asked = types.DefinitionParams(document, types.Position(line, column))
                place = await editor.ask(editor.text_document_definition_async, asked)
                assert (place.range.start.line, place.range.start.character) == target
            context = types.ReferenceContext(include_declaration=False)
            asked_all = types.ReferenceParams(context, document, types.Position(7, 22))
            places = await editor.ask(editor.text_document_references_async, asked_all)
            assert [each.range.start.line for each in places] == [3]
            editor.change(uri, 2, XML.replace("Drvie", "Drive"))
            assert [each for each in await editor.settled(uri) if each.severity == 1] == []
            asked_hover = types.HoverParams(document, types.Position(4, 8))
            shown = await editor.ask(editor.text_document_hover_async, asked_hover)
            assert "Drive" in shown.contents.value

    run(check())


def test_files_that_change_are_read_again(tmp_path: Path) -> None:
    included = tmp_path / "kitchen.txt"
    included.write_text("tidy up is nod\n", encoding="utf-8")

    async def check() -> None:
        async with client() as editor:
            uri = editor.open(from_fs_path(str(tmp_path / "main.txt")) or "", 'include "kitchen.txt"\ntidy up\n')
            assert await editor.settled(uri) == []
            included.write_text("clean up is nod\n", encoding="utf-8")
            changes = [types.FileEvent(from_fs_path(str(included)) or "", types.FileChangeType.Changed)]
            editor.workspace_did_change_watched_files(types.DidChangeWatchedFilesParams(changes))
            assert [each.code for each in await editor.messages(uri, 1, 2)] == ["BT010"]
            included.write_text("tidy up is frobnicate\n", encoding="utf-8")
            saved = types.DidSaveTextDocumentParams(types.TextDocumentIdentifier(uri))
            editor.text_document_did_save(saved)
            [elsewhere] = await editor.messages(uri, 1, 3)
            assert elsewhere.message.startswith(f"{included}:1:12:")

    run(check())
