"""The library of a robot: missions, worlds and robot files, from people who may only write texts."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from btlang.api import parse_tree
from btlang.robots.platforms import ROBOTS
from btlang.robots.registry import Connector, body_of
from btlang.robots.simulation.connection import Simulation
from btlang.task.commands.answers import outdated_error
from btlang.task.commands.store_handlers import MOST_CHARACTERS, latest_text
from btlang.task.execution.missions import MissionReader
from btlang.task.layer import TaskLayer
from btlang.task.messages import Put
from btlang.task.store.records import LibraryKind, Revision
from btlang.text.source import Source
from tests.conftest import matches_golden

from .layers import ask, layer_in, refusal

HERE = Path(__file__).parent
GARDEN = 'start = { x = 1, y = 1 }\nplaces = [{ name = "shed", x = 1, y = 2 }]\n'
CART = 'name = "cart"\nradius = 0.25\n'
TESTS = 'test "it waves":\n  run "first"\n  finally the mission succeeds\n'
TEXTS = {LibraryKind.MISSION: "wave", LibraryKind.WORLD: GARDEN, LibraryKind.ROBOT: CART, LibraryKind.TEST: TESTS}


@pytest.fixture(scope="module")
def layer(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TaskLayer]:
    with layer_in(tmp_path_factory.mktemp("library")) as layer:
        yield layer


@pytest.mark.parametrize("kind", LibraryKind)
def test_a_text_from_its_first_revision_to_its_end(layer: TaskLayer, kind: LibraryKind) -> None:
    of = {"name": "first", "kind": kind}
    put = ask(layer, "put", **of, text=TEXTS[kind], revision=0)
    assert (put[kind]["number"], put[kind]["kind"], put[kind]["person"]) == (1, kind, "ann")
    comment = "# better\n" + TEXTS[kind]
    assert ask(layer, "put", **of, text=comment, revision=1)[kind]["number"] == 2
    stale = layer.handle({"command": "put", **of, "text": TEXTS[kind], "revision": 1}, "bo")
    assert (stale.ok, stale.data["revision"], stale.data["text"]) == (False, 2, comment)
    assert "-# better" in stale.data["diff"].splitlines()
    assert "has changed since revision 1: it has 2." in stale.text
    listed = ask(layer, "library", kind=kind)[f"{kind}s"]
    assert [(each["name"], each["number"], each["text"]) for each in listed] == [("first", 2, comment)]
    assert [each["number"] for each in ask(layer, "library", **of)[f"{kind}s"]] == [1, 2]
    for number, expected in ((0, comment), (1, TEXTS[kind]), (2, comment)):
        [found] = ask(layer, "library", **of, revision=number)[f"{kind}s"]
        assert found["text"] == expected
    for number in (3, -1, 2**70):
        assert "isn't in the library" in refusal(layer, "library", **of, revision=number)
    assert ask(layer, "delete", **of) == {"schedules": []}
    assert "isn't in the library" in refusal(layer, "delete", **of)
    assert ask(layer, "library", kind=kind) == {f"{kind}s": []}
    assert [each["deleted"] for each in ask(layer, "library", **of)[f"{kind}s"]] == [False, False, True]
    assert ask(layer, "put", **of, text=TEXTS[kind], revision=0)[kind]["number"] == 4
    ask(layer, "delete", **of)


REFUSED: dict[str, dict[str, Any]] = {
    "a kind that doesn't exist": {"command": "put", "name": "a", "text": "", "kind": "pack"},
    "another kind that doesn't exist": {"command": "library", "kind": ""},
    "a kind that is no text": {"command": "delete", "name": "a", "kind": 3},
    "no such world": {"command": "delete", "name": "nowhere", "kind": "world"},
    "no such robot file": {"command": "library", "name": "../../etc/passwd", "kind": "robot"},
    "a name that is a path": {"command": "put", "name": "../a", "text": GARDEN, "kind": "world"},
    "a name with a NUL": {"command": "put", "name": "a\0b", "text": GARDEN, "kind": "world"},
    "a name with the end of a line": {"command": "put", "name": "a\nb", "text": CART, "kind": "robot"},
    "a long name": {"command": "put", "name": "a" * 10_000, "text": GARDEN, "kind": "world"},
    "no name": {"command": "put", "name": " ", "text": GARDEN, "kind": "world"},
    "a stale revision": {"command": "put", "name": "new", "text": GARDEN, "kind": "world", "revision": 7},
    "a mission as a world": {"command": "put", "name": "a", "text": "wave", "kind": "world"},
    "a world as a robot": {"command": "put", "name": "a", "text": GARDEN, "kind": "robot"},
    "a world as a mission": {"command": "put", "name": "a", "text": "[dock]"},
    "an empty world": {"command": "put", "name": "a", "text": "", "kind": "world"},
    "a world with a mistake": {"command": "put", "name": "a", "text": GARDEN + "wals = []", "kind": "world"},
    "a world that names a file": {"command": "put", "name": "a", "text": GARDEN + 'include = "../b"', "kind": "world"},
    "a world with NaN": {"command": "put", "name": "a", "text": GARDEN + "dock = { x = nan, y = 1 }", "kind": "world"},
    "half a character": {"command": "put", "name": "a", "text": "\ud800", "kind": "world"},
    "a robot over ROS 2": {"command": "put", "name": "a", "text": CART + 'over = "ros"', "kind": "robot"},
    "a robot with code": {"command": "put", "name": "a", "text": CART + 'call = "os:system"', "kind": "robot"},
    "a world that is too long": {"command": "put", "name": "a", "text": "#" * 4_000_000, "kind": "world"},
    "300,000 objects": {
        "command": "put", "name": "a", "kind": "world",
        "text": GARDEN + "objects = [" + '{name="o",x=9,y=9},' * 300_000 + "]",
    },
}  # fmt: skip


def test_refused_texts(layer: TaskLayer) -> None:
    told, began = [], time.monotonic()
    for what, command in REFUSED.items():
        answer = layer.handle(command, "eve")
        assert not answer.ok, what
        told.append(f"{what}\n{answer.code} {answer.text}")
    assert time.monotonic() - began < 10.0
    assert [ask(layer, "library", kind=kind) for kind in LibraryKind] == [{f"{kind}s": []} for kind in LibraryKind]
    matches_golden("\n\n".join(told) + "\n", HERE / "refused_texts.out")


@pytest.mark.parametrize("name", [".", ".."])
def test_a_name_that_no_address_can_have_is_refused(layer: TaskLayer, name: str) -> None:
    answer = layer.handle({"command": "put", "name": name, "text": "wave"})
    assert (answer.ok, answer.code) == (False, "BT198")


@pytest.mark.parametrize("name", ["...", "🤖", "Ünï cöde", "-c", "library:a", "a" * 200, "'; DROP TABLE revision; --"])
def test_a_name_is_nothing_but_a_name(layer: TaskLayer, name: str) -> None:
    for kind in LibraryKind:
        ask(layer, "put", name=name, kind=kind, text=TEXTS[kind])
        assert latest_text(layer.store, name, kind).text == TEXTS[kind]
        ask(layer, "delete", name=name, kind=kind)


def test_the_longest_text_is_read_in_bounded_time(layer: TaskLayer) -> None:
    row = '{name="%d",x=9,y=9},'
    objects = "".join(row % number for number in range(9_000))
    assert MOST_CHARACTERS - 30_000 < len(GARDEN + objects) < MOST_CHARACTERS
    began = time.monotonic()
    ask(layer, "put", name="full", kind="world", text=f"{GARDEN}objects = [{objects}]")
    assert time.monotonic() - began < 10.0
    ask(layer, "delete", name="full", kind="world")


READS = """
import sys
from btlang.robots.bodies.body_file import read_body
from btlang.robots.worlds.world_file import read_world
from btlang.text.source import Source

world, robot = (Source(text, "text", roots=()) for text in sys.argv[1:])
read_world(world), read_body(robot)  # what is imported once is
seen = []
sys.addaudithook(lambda event, arguments: seen.append(event))
read_world(world), read_body(robot)
done = [event for event in seen if not event.startswith(("object.", "sys."))]
print(done)
"""


def test_reading_a_text_imports_and_runs_nothing() -> None:
    command = [sys.executable, "-c", READS, GARDEN + 'clock = "2026-03-02 08:55"', CART]
    assert subprocess.run(command, check=True, capture_output=True, text=True).stdout == "[]\n"


def test_a_robot_file_may_run_on_what_the_robot_runs_on(tmp_path: Path) -> None:
    """Here a simulation by the name of another one."""
    connect = Connector(body_of("simulated"), "simulated").replace(over="ros")
    assert connect.over in ROBOTS

    class Other(Connector):
        def __call__(self, world: Any) -> Any:
            return Simulation(world, body=self.body)

    with layer_in(tmp_path, robot=Other(connect.body, "ros")) as layer:
        assert ask(layer, "put", name="a", kind="robot", text=CART + 'over = "ros"')["robot"]["number"] == 1
        assert '"over" may only be "simulated" or "ros"' in refusal(
            layer, "put", name="b", kind="robot", text=CART + 'over = "actions"'
        )


def test_a_world_has_to_have_room_for_the_robot(tmp_path: Path) -> None:
    wide = tmp_path / "wide.toml"
    wide.write_text('name = "wide"\nradius = 1.5\n')
    walled = GARDEN + "walls = [[[0, 0], [0, 4]]]"
    with layer_in(tmp_path, robot=str(wide), reader=MissionReader(world=Source(GARDEN))) as layer:
        assert "leave 1.5 m" in refusal(layer, "put", name="a", kind="world", text=walled)
        ask(layer, "put", name="a", kind="world", text=GARDEN)
    with layer_in(tmp_path / "usual") as layer:
        ask(layer, "put", name="a", kind="world", text=walled)


def test_a_robot_in_a_world_that_is_a_text(tmp_path: Path) -> None:
    reader = MissionReader(world=Source(GARDEN, "garden"))
    with layer_in(tmp_path, reader=reader) as layer:
        assert layer.session.world.names.places == ("shed",)
        ask(layer, "submit", text="go to the shed")
        assert "kitchen" in refusal(layer, "submit", text="go to the kitchen")
        assert reader.words == {"keywords": [], "language": "en", "world_text": GARDEN}


def test_the_difference_of_long_texts_is_found_in_bounded_time() -> None:
    before = [str(number % 150) for number in range(50_000)]
    after = [*before[:10], *(str(number * 7 % 150) for number in range(50_000)), *before[10:]]
    began = time.monotonic()
    answer = outdated_error(Put("a", "\n".join(after), 1), "mission", Revision("a", 2, "\n".join(before), "ada", 1.0))
    assert time.monotonic() - began < 5.0
    lines = answer.data["diff"].splitlines()
    assert lines[:2] == ["--- latest", "+++ yours"]
    end = int(lines[2].split("+")[1].split(",")[0]) - 1
    taken = [line[1:] for line in lines[3:] if line[0] == "-"]
    added = [line[1:] for line in lines[3:] if line[0] == "+"]
    assert before[end : end + len(taken)] == taken
    assert [*before[:end], *added, *before[end + len(taken) :]] == after


def test_a_mission_is_read_in_the_newest_world(layer: TaskLayer) -> None:
    ask(layer, "put", name="garden", kind="world", text=GARDEN)
    ask(layer, "put", name="garden", kind="world", text=GARDEN.replace("shed", "pond"))
    assert parse_tree("go to the pond", world=latest_text(layer.store, "garden", LibraryKind.WORLD))
    ask(layer, "delete", name="garden", kind="world")
