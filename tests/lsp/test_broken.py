"""What a client may get wrong: each request has an answer, nothing shows a traceback, and the server goes on."""

from __future__ import annotations

import pytest

pytest.importorskip("pygls", reason="the extra lsp isn't installed")

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from lsprotocol import types

from tests.lsp.client import ROOT, client, run
from tests.profiles import amount

INITIALIZE = {
    "capabilities": {"general": {"positionEncodings": ["utf-8", "utf-16"]}},
    "processId": None,
    "rootUri": None,
}


def session(*messages: dict[str, Any] | bytes, debug: str = "") -> tuple[list[dict[str, Any]], str, int]:
    """The messages of a server, what it wrote to standard error, and its exit code, for these and a clean end."""
    ended: list[dict[str, Any]] = [{"id": 900, "method": "shutdown"}, {"method": "exit"}]
    sent = b"".join(
        each if isinstance(each, bytes) else framed({"jsonrpc": "2.0", **each})
        for each in ({"id": 0, "method": "initialize", "params": INITIALIZE}, *messages, *ended)
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "BTC_DEBUG": debug}
    done = subprocess.run(
        [sys.executable, "-m", "btlang", "lsp"], input=sent, env=environment, capture_output=True, check=False,
        timeout=120,
    )  # fmt: skip
    return list(unframed(done.stdout)), done.stderr.decode(), done.returncode


def framed(message: object) -> bytes:
    """A message as it is sent."""
    body = json.dumps(message).encode()
    return b"Content-Length: %d\r\n\r\n" % len(body) + body


def unframed(data: bytes) -> Any:
    """The messages in what was written, which is nothing else."""
    while data:
        head, _, data = data.partition(b"\r\n\r\n")
        fields = dict(line.split(": ") for line in head.decode().split("\r\n"))
        length = int(fields["Content-Length"])
        yield json.loads(data[:length])
        data = data[length:]


def test_each_broken_request_has_an_error() -> None:
    document = {"uri": "file:///nowhere/a.txt"}
    place, versioned = {"line": 0, "character": 0}, {**document, "version": 1}
    answers, errors, code = session(
        {"id": 1, "method": "textDocument/hover", "params": {"textDocument": document, "position": place}},
        {"id": 2, "method": "textDocument/hover", "params": {"textDocument": 5, "position": "here"}},
        {"id": 3, "method": "textDocument/hover"},
        {"id": 4, "method": "textDocument/teleport", "params": {}},
        {
            "method": "textDocument/didChange",
            "params": {"textDocument": versioned, "contentChanges": []},
        },
        {"method": "textDocument/didChange", "params": 7},
        {"method": "$/unheardOf", "params": {}},
        {"id": 5, "method": "workspace/executeCommand", "params": {"command": "rm -rf"}},
        {"jsonrpc": "1.0", "id": 6, "method": "shutdown"},
        framed([1, 2]),
        b"Content-Length: 3\r\n\r\n{a}",
        {"id": 7, "method": "textDocument/documentSymbol", "params": {"textDocument": document}},
    )
    by_id = {each["id"]: each for each in answers if "id" in each}
    assert by_id[0]["result"]["capabilities"]["positionEncoding"] == "utf-16"
    assert {number: by_id[number]["error"]["code"] for number in (1, 2, 3, 4, 7)} == {
        1: types.LSPErrorCodes.RequestFailed.value, 2: types.ErrorCodes.InvalidParams.value,
        3: types.ErrorCodes.InvalidParams.value, 4: types.ErrorCodes.MethodNotFound.value,
        7: types.LSPErrorCodes.RequestFailed.value,
    }  # fmt: skip
    assert "error" in by_id[5]
    assert by_id[900]["result"] is None
    assert code == 0
    assert "Traceback" not in errors + json.dumps(answers)


def test_any_text_and_any_place_has_an_answer() -> None:
    """Texts that no mission is, and places that no text has."""
    texts = ["", "\n", "\ufeff", "\x00\x1b[2J", "😀" * 50, "(" * 3_000, '"', "<root>", "{", "wave " * 4_000, "a\rb\rc"]
    texts += ["if if if then then", "\u2028wave\u2028", "wave\n" * 200 + "  wave"]

    async def check() -> None:
        async with client() as editor:
            for number, text in enumerate(texts[: amount(9, len(texts))]):
                for ending in ("txt", "test.txt", "toml", "xml"):
                    uri = editor.open(f"file:///nowhere/{number}.{ending}", text, "")
                    document = types.TextDocumentIdentifier(uri)
                    for position in (types.Position(0, 0), types.Position(0, 3), types.Position(2**31 - 1, 2**31 - 1)):
                        for ask, params in (
                            (editor.text_document_completion_async, types.CompletionParams),
                            (editor.text_document_hover_async, types.HoverParams),
                            (editor.text_document_definition_async, types.DefinitionParams),
                        ):
                            await editor.ask(ask, params(document, position))
                        try:
                            asked = types.RenameParams(document, position, "\x00 new")
                            await editor.ask(editor.text_document_rename_async, asked)
                        except Exception as error:
                            assert "Traceback" not in str(error)  # noqa: PT017 - it may have an answer, too
                    for ask, params in (
                        (editor.text_document_semantic_tokens_full_async, types.SemanticTokensParams),
                        (editor.text_document_folding_range_async, types.FoldingRangeParams),
                        (editor.text_document_code_lens_async, types.CodeLensParams),
                    ):
                        await editor.ask(ask, params(document))

    run(check())


def test_reading_runs_no_python(tmp_path: Path) -> None:
    """That of a keyword file and of a component, which a mission, its tests and the robot file name."""
    (tmp_path / "loud.py").write_text("print('loud')\nopen('ran', 'w')\n", encoding="utf-8")
    files = {
        "loud.toml": '[[action]]\nphrase = "juggle"\nid = "Juggle"\ncall = "loud:act"\n',
        "robot.toml": 'name = "r"\nradius = 0.2\n[[component]]\nname = "box"\nclass = "loud:Box"\n',
        "a.txt": 'robot "robot.toml"\nwords "loud.toml"\njuggle\n',
        "a.test.txt": 'test "it juggles":\n  run "a.txt"\n  finally the mission succeeds\n',
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")

    async def check() -> None:
        async with client() as editor:
            for name, text in files.items():
                assert await editor.settled(editor.open(f"file://{tmp_path}/{name}", text, "")) == []

    run(check())
    assert not list(tmp_path.rglob("ran"))
    assert not Path("ran").exists()


def test_words_that_cannot_be_used_end_the_start() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "btlang", "lsp", "--keywords", "nowhere.toml"],
        env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False, timeout=60,
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stdout == ""
    assert "BT001" in done.stderr
