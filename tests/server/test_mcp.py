"""`btc mcp`: a scripted client writes a mission with a mistake, mends it as offered, and simulates it."""

from __future__ import annotations

import asyncio
import json
import os
import re
import subprocess
import sys
import threading
from collections.abc import Awaitable, Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from btlang.diagnostics.files import MOST_BYTES
from btlang.server.mcp import Tools
from btlang.vocabulary.decorators import action

if find_spec("mcp") is None:  # importing it takes half a second, in each process that reads these tests
    pytest.skip("mcp is not installed", allow_module_level=True)

ROOT = Path(__file__).parent.parent.parent
Ask = Callable[..., Awaitable[dict[str, Any]]]


def served(script: Callable[[Ask, Any], Awaitable[None]], *options: str) -> None:
    """Runs a script with a client of a real `btc mcp`."""

    import mcp

    async def run() -> None:
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        server = mcp.StdioServerParameters(
            command=sys.executable, args=["-m", "btlang", "mcp", *options], env=environment, cwd=ROOT
        )
        async with mcp.Client(server, read_timeout_seconds=60) as client:

            async def ask(tool: str, **arguments: object) -> dict[str, Any]:
                answer = await client.call_tool(tool, arguments)
                assert not answer.is_error, answer.content
                found: dict[str, Any] = json.loads(answer.content[0].text)
                return found

            await script(ask, client)

    asyncio.run(run())


def mended(text: str, fix: dict[str, Any]) -> str:
    """The text with a correction of one line."""
    lines = text.split("\n")
    line = lines[fix["line"] - 1]
    lines[fix["line"] - 1] = line[: fix["column"] - 1] + fix["text"] + line[fix["end_column"] - 1 :]
    return "\n".join(lines)


def test_a_model_writes_checks_mends_and_simulates_a_mission() -> None:
    async def script(ask: Ask, client: Any) -> None:
        tools = {tool.name for tool in (await client.list_tools()).tools}
        assert tools == {"words", "check", "explain", "understand", "simulate", "grammar"}
        assert any("wave [at {person}]" in line for line in (await ask("words", search="wave"))["lines"])
        text = 'go to the ktichen, then say "tea is ready"\nprint done'
        checked = await ask("check", text=text)
        assert not checked["ok"]
        (message,) = checked["messages"]
        assert message["code"] == "BT013"
        text = mended(text, message["fix"])
        assert await ask("check", text=text) == {"ok": True, "messages": []}
        assert "GoTo: go to kitchen" in (await ask("explain", text=text))["explanation"]
        run = await ask("simulate", text=text)
        assert (run["ok"], run["status"], run["stopped"]) == (True, "SUCCESS", "")
        assert any('says   "tea is ready"' in line for line in run["lines"])
        assert (await ask("grammar"))["grammar"].startswith("root ::= ")

    served(script)


def test_the_configuration_of_the_page_starts_a_server() -> None:
    page = (ROOT / "docs" / "language_models.md").read_text(encoding="utf-8")
    (shown,) = re.findall(r"^```json\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    (server,) = json.loads(shown)["mcpServers"].values()
    assert (server["command"], server["args"][0]) == ("btc", "mcp")

    async def script(ask: Ask, client: Any) -> None:
        assert "middle" in str(await ask("words", search="place"))

    served(script, *server["args"][1:])


def test_it_serves_the_words_of_the_command_line() -> None:
    async def script(ask: Ask, client: Any) -> None:
        assert not (await ask("check", text="wave"))["ok"]
        assert (await ask("check", text="saluda"))["ok"]

    served(script, "--language", "es")


def test_a_mission_without_end_is_bounded() -> None:
    tools = Tools()
    by_time = tools.simulate("repeat wave", seconds=30)
    assert (by_time["ok"], by_time["status"], by_time["stopped"]) == (False, "IDLE", "time limit")
    by_ticks = tools.simulate("repeat wave", ticks=100)
    assert by_ticks["stopped"] == "time limit"
    assert by_ticks["ticks"] <= 101


def test_a_simulation_that_takes_too_long_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.server.mcp._PATIENCE", 0.05)
    answer = Tools().simulate("repeat wave", seconds=1e9, ticks=10**9)
    assert (answer["ok"], answer["stopped"]) == (False, "it took too long to simulate")


def test_a_command_that_never_returns_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    released = threading.Event()

    @action("meditate")
    def meditate() -> None:
        released.wait(30)

    monkeypatch.setattr("btlang.server.mcp._PATIENCE", 0.2)
    answer = Tools([meditate]).simulate("meditate")
    released.set()
    assert (answer["ok"], answer["stopped"]) == (False, "a command never returns")


def test_why_a_mission_failed_is_told() -> None:
    answer = Tools().simulate("check bumped")
    assert (answer["status"], answer["ok"]) == ("FAILURE", False)
    assert "bumped" in answer["why"]


@pytest.mark.parametrize("tool", ["check", "explain", "simulate"])
@pytest.mark.parametrize(
    ("text", "code"),
    [
        ('include "README.md"\nwave', "BT001"),
        ('words "examples/words.toml"\nwave', "BT049"),
        ('world "/etc/passwd"\nwave', "BT049"),
        (
            '<root BTCPP_format="4"><include path="/etc/passwd"/><BehaviorTree ID="A"><Wave/></BehaviorTree></root>',
            "BT128",
        ),
        ("", "BT005"),
        ("wave \0", "BT003"),
        ("wave " * (MOST_BYTES // 5 + 1), "BT001"),
        ("r is " + "(" * 2000 + "wave", "BT023"),
    ],
)
def test_texts_reach_no_file_and_mistakes_are_data(tool: str, text: str, code: str) -> None:
    answer = getattr(Tools(), tool)(text)
    assert not answer["ok"]
    assert code in {message["code"] for message in answer["messages"]}
    assert "root:" not in json.dumps(answer)


def test_other_verbs_import_nothing_of_it() -> None:
    code = (
        "import sys; from btlang.cli import main; main(['check', '-c', 'wave']);"
        "print([name for name in sys.modules if name.partition('.')[0] == 'mcp' or 'grammar' in name or 'mcp' in name])"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout == "No problems found.\n[]\n"


def test_an_unknown_grammar_is_told() -> None:
    assert "gbnf" in Tools().grammar("bnf")["reason"]


SAID = "Go to the lab. Dust the book. Put it on the red ball. If someone is near, wave."


def test_a_model_rewrites_what_is_not_understood_and_shows_how_the_rest_is_read() -> None:
    async def script(ask: Ask, client: Any) -> None:
        answer = await ask("understand", text=SAID)
        assert not answer["ok"]
        assert [each["understood"] for each in answer["sentences"]] == [True, False, False, True]
        assert [each.get("reading") for each in answer["sentences"]] == [
            "go to lab", None, None, "if someone is near, wave",
        ]  # fmt: skip
        [unknown] = answer["sentences"][1]["not_understood"]
        assert unknown["words"] == "Dust the book"
        assert "depends on the sentence before" in answer["sentences"][2]["not_understood"][0]["message"]
        assert "book" in answer["names"]["object"]
        again = await ask("understand", text=SAID.replace("Dust", "Pick up"))
        assert again["ok"]
        assert again["sentences"][2]["reading"] == "put book in red ball"

    served(script)


@pytest.mark.parametrize(
    "text", ["", "((", "wave", "a\n  b", "\0", "wave. nod", "greet is fly\ngreet", "if", "{", ";;"]
)
def test_any_text_is_understood_in_part(text: str) -> None:
    answer = Tools().understand(text)
    assert answer["ok"] in (True, False)
