"""What a page asks of a text while somebody types: places in UTF-16, the newest request, and what attackers send."""

from __future__ import annotations

import asyncio
import json
import time
from contextlib import closing
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.api import parse_tree
from btlang.editing.words import RobotWords
from btlang.server.http.access import AccessError
from btlang.server.page import processes as checking
from btlang.server.page.processes import DOES, Checker, answer, arguments_of, in_units
from btlang.text.source import Utf16Units
from tests.profiles import amount, searches
from tests.server.doors import Door

ROBOT_FACE = "\N{ROBOT FACE}"
TEXT = f'patrol is say "{ROBOT_FACE}{ROBOT_FACE}" then wave\npatrol then nod twice\n'


def in_utf16(text: str, start: int, end: int) -> str:
    """What a page sees between two places."""
    return text.encode("utf-16-le", "surrogatepass")[2 * start : 2 * end].decode("utf-16-le", "surrogatepass")


def unit_of(words: str) -> int:
    return Utf16Units(TEXT).unit(TEXT.index(words))


@searches(200, 5000)
@given(st.text(alphabet=st.sampled_from(f"a\n{ROBOT_FACE}\u00e9\uffff\U00010000\ud800")))
def test_places_are_counted_as_pages_do(text: str) -> None:
    units = Utf16Units(text)
    assert units.length == len(text.encode("utf-16-le", "surrogatepass")) // 2
    for at in range(len(text) + 1):
        assert units.unit(at) == len(text[:at].encode("utf-16-le", "surrogatepass")) // 2
        assert units.character(units.unit(at)) == at
    for at in units.wide:
        assert units.character(units.unit(at) + 1) == at


def test_answers_have_places_as_pages_count_them() -> None:
    shown = answer("document", TEXT, RobotWords())
    nod = next(each for each in shown["nodes"] if each["id"] == "Nod")
    assert in_utf16(TEXT, nod["start"], nod["end"]) == "nod"
    patrol, used = shown["outline"][:2]
    assert in_utf16(TEXT, patrol["start"], patrol["end"]) == "patrol"
    assert in_utf16(TEXT, *used["of"]) == "patrol"
    slip = TEXT + "wavee then wave"
    [wrong] = answer("check", slip, RobotWords())["messages"]
    assert in_utf16(slip, wrong["start"], wrong["end"]) == "wavee"
    assert in_utf16(slip, wrong["fix"]["start"], wrong["fix"]["end"]) == "wavee"
    at = arguments_of("hover", {"at": unit_of("nod")}, TEXT)
    assert answer("hover", TEXT, RobotWords(), at)["found"]["id"] == "Nod"
    at = arguments_of("rename", {"at": unit_of("patrol then"), "name": "round"}, TEXT)
    changes = answer("rename", TEXT, RobotWords(), at)["changes"]
    assert [in_utf16(TEXT, each["start"], each["end"]) for each in changes] == ["patrol", "patrol"]
    at = arguments_of("tokens", {"at": unit_of("nod"), "to": unit_of("nod") + 3}, TEXT)
    [token] = answer("tokens", TEXT, RobotWords(), at)["tokens"]
    assert (in_utf16(TEXT, token["start"], token["end"]), token["kind"]) == ("nod", "command")
    offered = answer("complete", TEXT + "go to the kit", RobotWords())["completions"]
    assert [each["text"] for each in offered] == ["kitchen", "kitchen door"]
    assert {each["start"] for each in offered} == {Utf16Units(TEXT).length + len("go to the ")}


def test_words_have_the_kinds_that_they_are_read_as() -> None:
    text = '# Tea\ngreet is say "hi"\nif the battery is low, wait 5 s otherwise greet\nblurp then fail\n'
    found = answer("tokens", text, RobotWords())["tokens"]
    assert [(text[each["start"] : each["end"]].strip(), each["kind"]) for each in found] == [
        ("# Tea", "comment"), ("greet", "name"), ("is", "word"), ("say", "command"), ('"hi"', "text"), ("if", "word"),
        ("battery is low", "condition"), ("wait", "command"), ("5", "number"), ("s", "command"), ("otherwise", "word"),
        ("greet", "name"), ("then", "word"), ("fail", "command"),
    ]  # fmt: skip
    assert answer("tokens", "<root/>", RobotWords())["tokens"] == []


@pytest.mark.parametrize(
    ("text", "first"),
    [
        ("go to", "to dock"),  # where a word is written out, what follows it is offered, too
        ("go to the ", "dock"),  # before `collect` and `charging dock`
        ("go to the lab\ngo to the ", "lab"),  # what was used
        ("nod\nwave then nod\n", "nod"),
        ("go to the lab then go to the lab. wave th", "then"),
    ],
)
def test_what_fits_and_was_used_is_offered_first(text: str, first: str) -> None:
    offered = [each["text"] for each in answer("complete", text, RobotWords())["completions"]]
    assert offered[0] == first
    assert len(set(offered)) == len(offered)


def test_a_selection_behind_changes_is_counted_in_the_new_text() -> None:
    face = {"start": 0, "end": 1, "text": ROBOT_FACE * 2}
    made = in_units({"changes": [face], "start": 2, "end": 3}, "abc")
    assert (made["start"], made["end"], made["changes"]) == (4, 5, [face])


def test_the_newest_request_of_a_page_wins() -> None:
    async def asked() -> None:
        with closing(Checker()) as checker:

            def ask(text: str, kind: str = "check", user: str = "ann", page: str | None = "1") -> Any:
                return checker.answer(kind, text, RobotWords(), {}, user, page)

            others = [ask("nod", "format"), ask("nod", page="2"), ask("nod", page=None), ask("nod", user="bob")]
            done = await asyncio.gather(*map(ask, ("wave", "nod", "dock", "nod")), *others, return_exceptions=True)
            first, *replaced = done[:3]
            assert json.loads(first)["ok"]
            assert [(type(each), getattr(each, "status", 0)) for each in replaced] == [(AccessError, 409)] * 2
            assert all(json.loads(each)["ok"] for each in done[3:])
            assert not checker._newest

    asyncio.run(asked())


def test_slow_texts_of_one_user_delay_others_once() -> None:
    async def asked() -> None:
        with closing(Checker()) as checker:
            await checker.answer("check", "wave", RobotWords())  # its process is up
            ended: list[str] = []

            async def ask(user: str, text: str) -> None:
                await checker.answer("check", text, RobotWords(), {}, user)
                ended.append(user)

            await asyncio.gather(*(ask("slow", "wave\n" * 2000) for _ in range(5)), ask("quick", "wave"))
            assert ended.index("quick") == 1

    asyncio.run(asked())


BAD: list[dict[str, Any]] = [
    {}, {"at": None}, {"at": -1}, {"at": len(TEXT) + 3}, {"at": 10**40}, {"at": 1.5}, {"at": 1e400}, {"at": "1"},
    {"at": True}, {"at": [1]}, {"at": {"at": 1}}, {"at": float("nan")},
]  # fmt: skip


@pytest.mark.parametrize("given", BAD, ids=str)
def test_places_that_are_none_are_refused(door: Door, given: dict[str, Any]) -> None:
    vic = door.log_in("vic")
    for kind in ("hover", "rename"):
        reply = door.ask("POST", f"/api/{kind}", {"text": TEXT, **given}, **vic)
        assert (reply.status, "'at' must be a place" in reply.data["text"]) == (400, True)


def test_bad_names_and_texts_are_refused(door: Door) -> None:
    vic = door.log_in("vic")
    for name in (1, ["x"], {"x": 1}, True):
        assert door.ask("POST", "/api/rename", {"text": TEXT, "at": 0, "name": name}, **vic).status == 400
    for name in ("a\nb", "\0", "\ud800", "", "x" * 100_000, "wave and nod", "<script>"):
        reply = door.ask("POST", "/api/rename", {"text": TEXT, "at": 0, "name": name}, **vic)
        assert (reply.status, [each["code"] for each in reply.data["messages"]]) == (200, ["BT210"]), name
    for text in (None, 1, ["wave"]):
        assert door.ask("POST", "/api/document", {"text": text}, **vic).status == 400
    odd = {"text": "wave", "robot": "\ud800", "page": ["\ud800"]}
    assert door.ask("POST", "/api/document", odd, **vic).status == 404
    assert door.ask("POST", "/api/edits", {"text": "wave"}, **vic).status == 404


def test_an_edit(door: Door) -> None:
    vic = door.log_in("vic")
    reply = door.ask(
        "POST",
        "/api/edit",
        {"text": f'say "{ROBOT_FACE}"\nnod', "edit": {"do": "insert", "node": 2, "words": "wave"}},
        **vic,
    )
    assert reply.data["changes"] == [{"start": 12, "end": 12, "text": "\nwave"}]
    assert (reply.data["start"], reply.data["end"]) == (13, 17)
    for edit in (
        None,
        "x",
        {"do": "delete"},
        {"do": "delete", "node": -1},
        {"do": "delete", "node": 10**30},
        {"do": "\ud800", "node": 0},
    ):
        reply = door.ask("POST", "/api/edit", {"text": "wave", "edit": edit}, **vic)
        assert reply.status == 400 or [each["code"] for each in reply.data["messages"]] == ["BT220"], edit


@pytest.mark.long
@pytest.mark.parametrize("kind", DOES)
def test_any_text_has_an_answer_in_time(door: Door, kind: str) -> None:
    vic = door.log_in("vic")
    further = {"at": 3, "edit": {"do": "insert", "node": 0, "words": "wave"}}
    texts = ["(" * 100_000, "\ud800" * 1000, "<a>" * 50_000, "wave\n" * 40_000, "not " * 50_000, "a" * 200_000]
    texts += [
        "\0" * 1000,
        "{" * 5000,
        "[" * 100_000,
        '{"a":' * 30_000,
        "if p, " * 20_000,
        ROBOT_FACE * 10_000,
        "\ud83d" * 10,
    ]
    for text in texts[: amount(2, len(texts))]:
        began = time.monotonic()
        reply = door.ask("POST", f"/api/{kind}", {"text": text[:200_000], **further}, **vic)
        assert time.monotonic() - began < checking._PATIENCE + 2
        assert reply.status in (200, 422), (text[:10], reply.body)
    assert door.ask("POST", f"/api/{kind}", {"text": "x" * 200_001, **further}, **vic).status == 413
    assert door.ask("POST", f"/api/{kind}", {"text": TEXT, **further}, **vic).data["ok"]


def test_a_mission_as_xml() -> None:
    made = answer("xml", TEXT, RobotWords())
    assert made["ok"]
    assert made["xml"] == parse_tree(TEXT).to("xml")
    assert answer("xml", "wavee", RobotWords())["messages"][0]["code"] == "BT010"
