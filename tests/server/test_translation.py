"""A page in another language gets the words of nodes in it, live as in a film; what has none there stays as it is."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from btlang.api import parse_tree
from btlang.recording.film import Film
from btlang.server.live.client_queue import ClientQueue, RobotNews
from btlang.server.live.translation import translate
from tests.task.layers import layer_in, submit
from tests.task.test_feed import Watcher

MISSION = (
    "hello is wave then nod\nset n to 2\ntry up to 4 times: go to the lab\nhello\n"
    "visit {place} is go to {place}\nfor each room in the lab and the hall: visit {room}\nwait 100 s"
)
SPANISH = {
    "then": "luego", "try up to 4 times": "reintenta 4 veces", "go to lab": "ve a lab", "go to hall": "ve a hall",
    "wave": "saluda", "nod": "asiente", "wait 100 s": "espera 100 s",
}  # fmt: skip


def read(client: ClientQueue) -> list[dict[str, Any]]:
    return [json.loads(text) for text in client.take()]


def test_a_client_reads_nodes_in_its_language(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        watcher = Watcher(layer)
        submit(layer, MISSION)
        watcher.wait(lambda message: any(each[1] == "go to hall" for each in message.get("words", ())))
        news = [RobotNews("robot", message) for message in watcher.messages if message["type"] in ("run", "statuses")]
    words: dict[str, list[str]] = {}
    for language in ("", "es", "de"):
        client = ClientQueue()
        client.language = language
        for each in news:
            client.put(each)
        messages = read(client)
        [run] = [message for message in messages if message["type"] == "run" and message["task"]]
        words[language] = [node[2] for node in run["nodes"]]
        words[language] += [each[1] for message in messages for each in message.get("words", ())]
    assert words["de"] == words[""]  # it has no vocabulary
    for own, translated in zip(words[""], words["es"], strict=True):
        assert translated == SPANISH.get(own, translated)
    assert SPANISH.keys() - {*words[""]} == set()
    for kept in ("set n to 2", "hello"):  # what the mission computes and calls itself
        assert kept in words["es"]


@pytest.mark.parametrize("message", [
    {"type": "run", "nodes": [["/", "Wave", "wave", {}]]},
    {"type": "run", "nodes": [["/", "Repeat", "twice", {"num_cycles": 2}], 5], "named": []},
    {"type": "statuses", "run": "a", "changes": [], "words": [[0, "go to lab"]]},
    {"type": "statuses", "run": "a", "changes": [], "words": [[0, "go to lab", "GoTo", None]]},
    {"type": "run", "nodes": [["/", "Wave", "saluda", {}]], "named": [], "language": "es"},
])  # fmt: skip
def test_what_cannot_be_translated_stays(message: dict[str, Any]) -> None:
    assert translate(message, "es") is message


def test_a_name_that_somebody_gave_stays() -> None:
    nodes = [["/", "Sequence", "Fetch it", {}], ["/0", "GoTo", "go to lab", {"place": "lab"}]]
    message = {"type": "run", "nodes": nodes, "named": [0], "language": "en"}
    assert [node[2] for node in translate(message, "es")["nodes"]] == ["Fetch it", "ve a lab"]


def test_a_film_is_in_the_language_too() -> None:
    mission = parse_tree("try up to 4 times: go to the lab\nset n to 2")
    labels = [node["label"] for node in Film(mission, {}, "es").data()["nodes"]]
    assert labels == ["luego", "reintenta 4 veces", "ve a lab", "set n to 2"]
    spanish = parse_tree("intenta hasta 4 veces: ve a lab", language="es")
    assert Film(spanish, {}, "es").data() == Film(spanish, {}).data()
    assert [node["label"] for node in Film(spanish, {}, "en").data()["nodes"]] == ["retry 4 times", "go to lab"]
