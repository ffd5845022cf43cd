"""Missions that are written elsewhere, and what the server tells of itself."""

from __future__ import annotations

import asyncio
import json
import re
from contextlib import closing
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from starlette.applications import Starlette
from starlette.routing import Route

from btlang.editing.edits import Edit
from btlang.editing.words import RobotWords
from btlang.server.accounts.accounts import Accounts
from btlang.server.http.access import AccessError
from btlang.server.http.app import Api
from btlang.server.http.openapi import ROUTES, document
from btlang.server.page import processes as checking
from btlang.server.page.processes import Checker, answer
from tests.server.doors import Door

ARGUMENTS: dict[str, dict[str, Any]] = {
    "hover": {"at": 0},
    "rename": {"at": 0},
    "edit": {"edit": Edit("insert", 0, words="wave")},
}
"""What kinds need beside the text."""


def test_a_mission_is_checked_and_explained(door: Door) -> None:
    vic = door.log_in("vic")
    wrong = door.ask("POST", "/api/check", {"text": "move forwarrd 1 m"}, **vic).data
    assert (wrong["ok"], wrong["messages"][0]["code"]) == (False, "BT010")
    assert wrong["messages"][0]["fix"]["text"] == "move forward"
    right = door.ask("POST", "/api/check", {"text": "wave then nod"}, **vic).data
    assert (right["ok"], right["messages"]) == (True, [])
    assert "Wave" in right["outline"]
    explained = door.ask("POST", "/api/explain", {"text": "wave then nod"}, **vic).data
    assert "Sequence" in explained["explanation"]
    laid_out = door.ask("POST", "/api/format", {"text": "repeat 2 times:\n  wave\n"}, **vic).data
    assert laid_out["text"] == "repeat 2 times:\n  wave\n"
    offered = door.ask("POST", "/api/complete", {"text": "go to the k"}, **vic).data
    assert "kitchen" in [each["text"] for each in offered["completions"]]


@pytest.mark.parametrize("kind", checking.DOES)
@pytest.mark.parametrize(
    "text", ["", "\0", "\ud800", 'words "evil.toml"\nhop', 'include "/etc/passwd"', "( " * 3000, "<root/>"]
)
def test_any_text_has_an_answer(kind: str, text: str) -> None:
    found = answer(kind, text, RobotWords(), ARGUMENTS.get(kind, {}))
    assert isinstance(found["ok"], bool)
    assert "root:" not in str(found)


def test_checking_runs_no_python(tmp_path: Path) -> None:
    (tmp_path / "hop.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w').close()\ndef hop(): return True\n")
    (tmp_path / "hop.toml").write_text('[[action]]\nphrase = "hop"\nid = "Hop"\ncall = "hop:hop"\n')
    words = RobotWords((str(tmp_path / "hop.toml"),))
    text = "round is hop then wave; round"
    assert all(answer(kind, text, words, ARGUMENTS.get(kind, {}))["ok"] for kind in checking.DOES)
    assert not (tmp_path / "ran").exists()


def test_a_text_that_takes_too_long_ends_with_its_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checking, "_PATIENCE", 0.001)

    async def asked() -> None:
        with closing(Checker()) as checker:
            with pytest.raises(AccessError, match="too long to read"):
                await checker.answer("check", "wave", RobotWords())
            with pytest.raises(AccessError, match="may have"):
                await checker.answer("check", "wave " * 100_000, RobotWords())
            monkeypatch.setattr(checking, "_PATIENCE", 20.0)
            assert json.loads(await checker.answer("check", "wave", RobotWords()))["ok"]

    asyncio.run(asked())


def test_the_document_describes_every_route(tmp_path: Path) -> None:
    with closing(Accounts(str(tmp_path))) as accounts:
        app: Any = Api(accounts, "key").app()
        inner: Starlette = app._app
        routes = {
            (method, re.sub(r":\w+}", "}", route.path))
            for route in inner.routes
            if isinstance(route, Route)
            for method in route.methods or ()
            if method != "HEAD"
        }
    assert routes == {*ROUTES, ("GET", "/"), ("GET", "/login")}  # which are for people
    described = document()
    assert {(method.upper(), path) for path, each in described["paths"].items() for method in each} == set(ROUTES)
    command = described["components"]["schemas"]["Command"]
    jsonschema.Draft202012Validator.check_schema(command)
    jsonschema.validate({"command": "submit", "text": "wave", "robot": "q"}, command)


def test_the_urdf_is_for_those_who_are_logged_in_and_of_bodies_with_links(door: Door) -> None:
    assert door.ask("GET", "/api/urdf").status == 401
    reply = door.ask("GET", "/api/urdf?robot=robot", **door.log_in("vic"))
    assert (reply.status, "no links" in reply.data["text"]) == (409, True)


def test_figures_and_the_document_over_the_net(door: Door) -> None:
    assert door.ask("GET", "/metrics").status == 401
    text = door.ask("GET", "/metrics", authorization=f"Bearer {door.user('token', 'vic', 'prometheus')}").body.decode()
    assert 'btlang_robot_up{robot="robot"} 1' in text.splitlines()
    assert door.ask("GET", "/openapi.json").data["openapi"] == "3.1.0"
