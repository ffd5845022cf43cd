"""What is sent of a document to a page that has an earlier one."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.editing.words import RobotWords
from btlang.server.page.processes import answer
from btlang.server.page.shown_documents import find_change
from tests.benchmarks.missions import mission


def patched(before: list[dict[str, Any]], difference: dict[str, Any], change: list[int]) -> list[dict[str, Any]]:
    """As the page does it: `patched` in btlang/web/src/write/understood.ts."""
    start, end, longer = change
    head, tail, items = difference["head"], difference["tail"], difference["items"]
    after: list[dict[str, Any]] = []

    def moved(place: Any) -> Any:
        if isinstance(place, list | tuple):
            return [moved(each) for each in place]
        return place if place is None or place <= start or place < end else place + longer

    def level(nodes: list[dict[str, Any]], at: int) -> int:
        parent = nodes[at].get("parent", -1)
        return 0 if parent < 0 else level(nodes, parent) + 1

    def keep(indices: range) -> None:
        for at in indices:
            item = {
                name: moved(value) if name in ("start", "end", "of") else value for name, value in before[at].items()
            }
            if (wanted := level(before, at)) > 0:
                item["parent"] = max(i for i in range(len(after)) if level(after, i) == wanted - 1)
            after.append(item)

    keep(range(head))
    after += items
    keep(range(len(before) - tail, len(before)))
    return after


def asked(text: str, shown: str) -> Any:
    """The answer as a page takes it: with what is said once for all nodes of a kind at each of them."""
    found = json.loads(json.dumps(answer("document", text, RobotWords(), {"shown": shown})))
    for node in found["nodes"] if isinstance(found["nodes"], list) else found["nodes"]["items"]:
        if "kind" in node:
            node["kind"] = found["kinds"][node["kind"]]
    return found


TEXTS = [
    'say "hello"\nif the battery is low:\n    wave\n    nod\ngo to the lab\n',
    'say "hello"\nif the battery is low:\n    wave\n    nod\n    nod twice\ngo to the lab\n',
    'say "hällo \N{GRINNING FACE}"\nif the battery is low:\n    wave\n    nod\n    nod twice\ngo to the lab\n',
    "if the battery is low:\n    nod\ngo to the lab then wave\n",
    "nod",
    "repeat 3 times: nod",
    'say "hello"\nif the battery is low:\n    wave\n    nod\ngo to the lab\n',
]


def test_a_page_that_has_the_text_before_gets_what_differs() -> None:
    known = asked(TEXTS[0], "")
    nodes, outline = known["nodes"], known["outline"]
    for text in TEXTS[1:]:
        found, whole = asked(text, known["shown"]), asked(text, "")
        nodes = patched(nodes, found["nodes"], found["change"])
        outline = patched(outline, found["outline"], found["change"])
        assert nodes == whole["nodes"]
        assert outline == whole["outline"]
        known = found


def test_of_a_long_text_little_is_sent_behind_a_key() -> None:
    text = mission(2000)
    whole = asked(text, "")
    for changed in (f"# {text}", text.replace("nod", "wave", 1)):
        found = asked(changed, whole["shown"])
        parts = {name: found[name] for name in ("nodes", "outline", "kinds", "change")}
        assert len(json.dumps(parts)) < 3000 < len(json.dumps(whole["nodes"]))
        whole = asked(text, "")


def test_who_has_another_text_gets_the_whole() -> None:
    assert isinstance(asked("nod", "no such")["nodes"], list)
    assert "shown" not in answer("document", "nod", RobotWords())


@pytest.mark.parametrize(("before", "after"), [("", ""), ("abc", "abc"), ("aa", "aaa"), ("aaa", "aa"), ("ab", "xaby")])
def test_small_changes(before: str, after: str) -> None:
    check_change(before, after)


@given(st.text("ab\N{GRINNING FACE}", max_size=8), st.text("ab\N{GRINNING FACE}", max_size=8))
def test_all_changes(before: str, after: str) -> None:
    check_change(before, after)


def check_change(before: str, after: str) -> None:
    one, other = before.encode("utf-16-le"), after.encode("utf-16-le")
    change = find_change(one, other)
    middle = other[2 * change.start : 2 * (change.end + change.longer)]
    assert one[: 2 * change.start] + middle + one[2 * change.end :] == other
