"""Runs as data that a page plays: trials, and recordings."""

from __future__ import annotations

import json
from itertools import pairwise
from math import dist
from pathlib import Path

import pytest

from btlang.api import parse_tree
from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.compile import outline
from btlang.engine.status import IDLE
from btlang.recording.film import Film, try_mission
from btlang.recording.reader import RecordedNodes, open_recording
from btlang.run.events import Event
from btlang.run.follower import RunFollower
from btlang.text.source import Source
from tests.world.worlds import LIVELY

TEXT = """\
greet is say "hello" then wave
go to the lab
greet
check that the battery is low  # which it isn't
"""


def final(data: dict[str, object]) -> dict[int, str]:
    """The last status of each node."""
    statuses: dict[int, str] = {}
    names, changes = data["names"], data["statuses"]
    assert isinstance(names, list)
    assert isinstance(changes, list)
    for _, *pairs in changes:
        statuses.update((index, names[status]) for index, status in zip(pairs[::2], pairs[1::2], strict=True))
    return statuses


def test_nodes_have_the_words_of_their_round() -> None:
    rounds = 'set n to 1\nrepeat 2 times: (say "round {n}" then increase n by 1)'
    data = try_mission(parse_tree(f"visit {{place}} is go to {{place}}\nvisit the lab\n{rounds}"))
    goes, says = (next(i for i, node in enumerate(data["nodes"]) if node["id"] == id) for id in ("GoTo", "Say"))
    assert data["nodes"][data["nodes"][says]["parent"]]["prepared"]
    assert not data["nodes"][goes]["prepared"]
    assert [words for _, node, words in data["words"] if node == goes] == ["go to lab"]
    assert [words for _, node, words in data["words"] if node == says] == ['say "round 1"', 'say "round 2"']
    times = [seconds for seconds, *_ in data["words"]]
    assert times == sorted(times)


def test_a_film_shows_what_a_live_view_has_shown() -> None:
    """What a new round hasn't reached yet is IDLE again, as for those who watched."""
    mission = parse_tree(
        "repeat 3 times: (wave then (retry 2 times: (nod then check that the battery is low)) or wait 1 s)"
    )
    live: dict[float, list[int]] = {}
    film, nodes = Film(mission), RecordedNodes(*outline(mission.tree))
    follower = RunFollower(nodes)

    def watch(event: Event) -> None:
        follower(event)
        film(event)
        live[round(event.t, 3)] = [min(code, IDLE) for code in follower.codes()]

    mission.run(speed="max", sinks=[watch])
    data, shown = film.data(), [IDLE] * nodes.size
    again = 0
    for t, statuses in live.items():
        for seconds, *pairs in data["statuses"]:
            if seconds == t:
                for index, status in zip(pairs[::2], pairs[1::2], strict=True):
                    again += status == IDLE
                    shown[index] = status
        assert shown == statuses, t
    assert again > 3


def test_a_film_has_what_the_robot_does() -> None:
    data = try_mission(parse_tree('say "hello"\ngo to the lab'))
    assert [row[1:] for row in data["doing"]] == [[0, "", "hello", ""], [0, "lab", "hello", ""], [0, "", "hello", ""]]


def test_a_trial() -> None:
    data = json.loads(json.dumps(try_mission(parse_tree(TEXT))))
    said = ["" if node["start"] is None else TEXT[node["start"] : node["end"]] for node in data["nodes"]]
    assert said[0] == TEXT[TEXT.index("go") :].split("  #")[0]
    assert said[1] == "go to the lab"
    shown = [(node["parent"], node["id"], node["label"]) for node in data["nodes"]]
    assert shown[:2] == [(-1, "Sequence", "then"), (0, "GoTo", "go to lab")]
    failed = data["failed"]
    assert said[failed] == "battery is low"
    assert data["ending"]["words"] == "battery is low"
    assert [words for _, _, words, *_ in data["story"]][:3] == ["go to lab", "say hello", "wave"]
    assert final(data)[1] == "SUCCESS"
    assert final(data)[failed] == "FAILURE"
    times = [row[0] for row in data["robot"]]
    assert times == sorted(times)
    assert times[-1] <= data["seconds"]
    assert data["map"]["places"]
    assert data["stopped"] == ""
    assert any(event.get("event") == "say" for event in data["events"])


def test_people_in_a_film() -> None:
    data = try_mission(parse_tree("wait 28 s", world=Source(LIVELY, "lively.toml")), seed=3)
    places = [row for row in data["things"] if row[1] == "Vera"]
    assert places[0] == [0.0, "Vera", None, None, False]
    assert places[1][2:4] == pytest.approx([9, 3.2], abs=0.3)
    assert any(seen for *_, seen in places)
    assert min(after[0] - before[0] for before, after in pairwise(places[:-1])) > 0.09
    ways = [dist(a[2:4], b[2:4]) for a, b in pairwise(places) if None not in (*a[2:4], *b[2:4])]
    assert max(ways) < 0.3
    assert {event["event"] for event in data["events"]} >= {"come", "see"}


def test_a_trial_without_an_end() -> None:
    data = try_mission(parse_tree("repeat: wave"), seconds=20.0)
    assert data["stopped"] == "time limit"
    assert data["seconds"] == pytest.approx(20.0, abs=0.2)
    busy = try_mission(parse_tree("repeat: print hello"), patience=0.5)
    assert busy["stopped"]


def test_a_trial_is_the_same_again_with_a_seed() -> None:
    mission = parse_tree("go to a random place\ngo to a random place\ngo to a random place")
    one, two = (try_mission(mission, seed=7) for _ in range(2))
    assert one["robot"] == two["robot"]
    assert any(try_mission(mission, seed=seed)["robot"] != one["robot"] for seed in range(8, 12))


def test_what_no_trial_may_do(tmp_path: Path) -> None:
    (tmp_path / "words.toml").write_text(
        '[[action]]\nid = "Jump"\nphrase = "jump"\ncall = "nowhere_at_all:jump"\nhelp = "x"\nexample = "jump"\n'
    )
    with pytest.raises(MissionError, match="BT221"):
        try_mission(parse_tree("if battery is low, jump", keywords=[str(tmp_path / "words.toml")]))


def test_a_film_of_a_recording_is_that_of_its_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mission.txt").write_text(TEXT)
    path = tmp_path / "run.mcap"
    assert main(["run", str(tmp_path / "mission.txt"), "--speed", "max", "--quiet", "--record", str(path)]) == 1
    capsys.readouterr()
    with open_recording(str(path), ()) as (recording, mission, nodes):
        film = Film(mission, dict(recording.about)).take(recording.events(nodes)).data()
    ran = try_mission(parse_tree(TEXT))
    for same in ("text", "nodes", "story", "failed"):
        assert film[same] == ran[same]
    assert final(film) == final(ran)
    assert len(film["robot"]) == len(ran["robot"])


def test_a_film_has_a_greatest_length(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.recording.film.MOST_CHANGES", 100)
    data = try_mission(parse_tree("repeat 200 times: wave"))
    assert data["is_cut"]
    assert sum(len(row) // 2 for row in data["statuses"]) < 120
