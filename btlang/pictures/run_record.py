"""What pictures of a run show, gathered while the mission runs: its record with a legend, and the last statuses."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import pairwise
from math import dist

from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.pictures import letters
from btlang.pictures.surface import HALTED, LOOKS, SMALL, SOFT, TEXT, TITLE, Look
from btlang.robots.geometry import Point, Pose
from btlang.run.bus import INLINE
from btlang.run.events import (
    Asked,
    Bumped,
    Called,
    DoorMoved,
    Dropped,
    Given,
    Grasped,
    Heard,
    PeriodPassed,
    Printed,
    Released,
    Said,
    StatusChanged,
    StatusesChanged,
    Stuck,
)
from btlang.run.logs import is_asked_wait
from btlang.run.robot_state import Movements, Whereabouts, ask_sensor
from btlang.support.record import Record
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.pictures.surface import Surface
    from btlang.run.events import Event


_LONGEST_PATH = 1000  # characters; no picture shows nodes so deep


class LastStatuses:
    """A sink. `by_path` has the last status of each node that was reached, the latest change last.

    IDLE stands for a node that was halted while it ran; a reset after it completed is no status. `nodes` has those
    whose ports name values, with these values in them: the last ones, or, where they were not reached, their arguments.
    """

    policy = INLINE

    def __init__(self) -> None:
        self.by_path: dict[str, int] = {}
        self.nodes: dict[str, Node] = {}

    def __call__(self, event: Event) -> None:
        if not isinstance(event, StatusesChanged):
            return
        if not self.by_path:
            nodes = event.nodes
            filled = ((index, nodes.filled(index)) for index in range(nodes.size))
            self.nodes = {nodes.path(index): node for index, node in filled if node is not nodes.node(index)}
        for change in event:
            before = self.by_path.get(change.path)
            if len(change.path) <= _LONGEST_PATH and (change.status != IDLE or before == RUNNING):
                self.by_path.pop(change.path, None)
                self.by_path[change.path] = change.status
                if change.index in event.valued:
                    self.nodes[change.path] = event.valued[change.index]


def by_definition(statuses: Mapping[str, int], tree: Tree) -> dict[tuple[str, str], int]:
    """Return the same by name of the subtree ("" is the main tree) and path in it: the latest of all its uses."""
    found: dict[tuple[str, str], int] = {}
    for path, status in statuses.items():
        for key in _keys(path, tree):
            found[key] = status
    return found


def _keys(path: str, tree: Tree) -> Iterator[tuple[str, str]]:
    """Yield where the node is drawn; nothing for a path that the tree does not have."""
    subtrees = dict(tree.subtrees)
    name, node, steps = "", tree.root, ""
    for step in path.strip("/").split("/") if path != "/" else ():
        if node.id == SUBTREE:
            name, steps = node.port("ID"), ""
            if name not in subtrees:
                return
            node = subtrees[name]
        elif int(step) < len(node.children):
            node, steps = node.children[int(step)], f"{steps}/{step}"
        else:
            return
    yield name, steps or "/"


_MOVED, _TURNED, _WAITED = 0.02, 4.0, 1.0  # metres, degrees and seconds: what is less is no new sample
_STEP = 0.2  # metres between two sightings


class PathSample(Record):
    """A sample of a path: where the robot was at a time, with percent of its battery."""

    t: float
    pose: Pose
    battery: float


class RecordedCommand:
    """A command that ran: where and when it began, and how it ended. `status` is RUNNING until then."""

    def __init__(self, number: int, text: str, start: PathSample) -> None:
        self.number = number
        self.text = text
        self.start = start
        self.end = start.t
        self.status = RUNNING
        self.reason = ""


class Sighting(Record):
    """A sighting: where somebody or something was from a time on, None for nowhere, and whether the robot saw it."""

    t: float
    point: Point | None
    seen: bool


class PictureMark(Record):
    """A mark in a picture for what happened to the robot: kind say, print, ask, hear, call, bump, stuck, grasp,
    release, give or drop.

    `who` is the person who was asked or heard, "" for any.
    """

    t: float
    kind: str
    text: str
    pose: Pose
    who: str = ""


class RunRecord:
    """A sink. `label` and `is_action` are those of btlang.api.Mission.

    Commands are numbered from 1 in the order in which they began. `ended` holds status and time of the whole mission.
    `moved` says where each object that was picked up lies; None is in the robot's hand. `sightings` are those of people
    who walk, and of what the robot doesn't know by its world; `doors` say when which door was opened or closed.
    """

    policy = INLINE

    def __init__(self, label: Callable[[Node], str], is_action: Callable[[Node], bool]) -> None:
        self._label = label
        self._is_action = is_action
        self._running: dict[str, RecordedCommand] = {}
        self._put_down: list[str] = []
        self.track: list[PathSample] = []
        self.commands: list[RecordedCommand] = []
        self.marks: list[PictureMark] = []
        self.moved: dict[str, Point | None] = {}
        self.moves: list[tuple[float, str, Point | None]] = []
        self.sightings: dict[str, list[Sighting]] = {}
        self.doors: list[tuple[float, str, bool]] = []
        self._movements = Movements()
        self.ended: tuple[int, float] | None = None
        self.radius = 0.0

    @property
    def begun(self) -> bool:
        """Return whether the robot was seen at all."""
        return bool(self.track)

    def __call__(self, event: Event) -> None:
        if isinstance(event, PeriodPassed):
            if event.robot is not None:
                self._see(event.t, event.robot)
            if event.state is not None and self.track:
                self._sight(event.t, self._movements.changed(event.state.things))
        elif isinstance(event, StatusesChanged) and self.track:
            for change in event:
                self._take_change(change, event.valued.get(change.index, change.node))
        elif self.track:
            self._happened(event)

    def _see(self, t: float, robot: Any) -> None:
        try:
            sample = PathSample(t, robot.pose, robot.battery)
        except ActionFailed:
            return  # a sensor is silent
        self.radius = robot.radius
        if len(self.track) >= 2 and _same(self.track[-2], sample):
            self.track[-1] = sample  # the latest one is always kept
        else:
            self.track.append(sample)
        for name in self._put_down:
            self._move(t, name, ask_sensor(partial(robot.locate, name)) or robot.pose.ahead(robot.radius))
        self._put_down.clear()

    def _sight(self, t: float, things: list[Whereabouts]) -> None:
        for name, x, y, seen in things:
            point = None if x is None or y is None else (x, y)
            known = self.sightings.setdefault(name, [])
            if len(known) >= 2 and _stays(known[-2], Sighting(t, point, seen)):
                known.pop()  # the latest one is always kept
            known.append(Sighting(t, point, seen))

    def _happened(self, event: Event) -> None:
        if isinstance(event, Said | Printed):
            self._mark(event, event.text)
        elif isinstance(event, Asked | Heard):
            self._mark(event, event.text, event.who)
        elif isinstance(event, Called):
            self._mark(event, event.text)
        elif isinstance(event, DoorMoved):
            self.doors.append((event.t, event.name, event.open))
        elif isinstance(event, Bumped):
            self._mark(event, event.into)
        elif isinstance(event, Stuck):
            self._mark(event, "")
        elif isinstance(event, Grasped):
            self._mark(event, event.name)
            self._move(event.t, event.name, None)
        elif isinstance(event, Released | Dropped | Given) and event.name:
            self._mark(event, event.name)
            self._put_down.append(event.name)

    def _mark(self, event: Event, text: str, who: str = "") -> None:
        self.marks.append(PictureMark(event.t, event.tag, text, self.track[-1].pose, who))

    def _move(self, t: float, name: str, place: Point | None) -> None:
        self.moved[name] = place
        self.moves.append((t, name, place))

    def _take_change(self, event: StatusChanged, node: Node) -> None:
        """Record a change; `node` has the values that its ports name."""
        if event.path == "/":  # after a pause it runs again
            self.ended = None if event.status == RUNNING else (event.status, event.t)
        if not (is_asked_wait(event.node) or self._is_action(event.node)):
            return
        command = self._running.pop(event.path, None)
        if command is None:
            if event.status in (IDLE, SKIPPED):
                return
            start = self.track[-1].replace(t=event.t)
            command = RecordedCommand(len(self.commands) + 1, self._label(node), start)
            self.commands.append(command)
        if event.status == RUNNING:
            self._running[event.path] = command
        command.status, command.end, command.reason = event.status, event.t, event.reason


def _stays(before: Sighting, now: Sighting) -> bool:
    """Return whether one in between says nothing more."""
    if before.point is None or now.point is None or before.seen != now.seen:
        return False
    return dist(before.point, now.point) < _STEP


def _same(a: PathSample, b: PathSample) -> bool:
    turned = abs((a.pose.heading - b.pose.heading + 180) % 360 - 180)
    moved = a.pose.distance_to((b.pose.x, b.pose.y))
    return moved < _MOVED and turned < _TURNED and b.t - a.t < _WAITED


WIDTH = 270.0
FIRST, LAST = 20, 6  # of many commands, so many are listed
_ROW, _MORE = 15.0, 10.5  # height of a row, and of each further line in it
_LEFT, _RIGHT = 42.0, 46.0  # room for number and sign, and for the time
_ENDINGS = {SUCCESS: "Succeeded", FAILURE: "Failed", IDLE: "Stopped", RUNNING: "Stopped", SKIPPED: "Nothing to do"}


def select_commands(commands: Sequence[RecordedCommand]) -> list[RecordedCommand]:
    """Select the commands that the legend names: all, or the first and the last of them."""
    return list(commands) if len(commands) <= FIRST + LAST else [*commands[:FIRST], *commands[-LAST:]]


def outcome(record: RunRecord) -> tuple[Look, str]:
    """Return how the run ended, in a few words."""
    status, t = record.ended or (IDLE, record.track[-1].t)
    return LOOKS[status], f"{_ENDINGS[status]} after {t:.1f} s"


class Legend:
    """The list of commands beside the map. `height` is known before it is drawn."""

    def __init__(self, record: RunRecord) -> None:
        self._record = record
        self._rows = [(command, *_lines(command)) for command in select_commands(record.commands)]
        self._hidden = len(record.commands) - len(self._rows)
        self.height = 62.0 + sum(_height(text, why) for _, text, why in self._rows) + (_ROW if self._hidden else 0)

    def draw(self, canvas: Surface, x: float, y: float) -> None:
        """Draw it with its upper left corner there."""
        record = self._record
        look, heading = outcome(record)
        canvas.text(x, y + 8, look.sign, size=TITLE + 2, colour=look.strong, bold=True)
        canvas.text(x + 17, y + 8, heading, size=TITLE, colour=look.strong, bold=True)
        canvas.text(x, y + 25, self._summary(), size=SMALL, colour=SOFT)
        y += 46
        if not self._rows:
            canvas.text(x, y + 4, "The robot got no commands.", colour=SOFT)
        else:
            canvas.text(x + _LEFT, y, "command", size=SMALL, colour=SOFT)
            canvas.text(x + WIDTH, y, "began", size=SMALL, colour=SOFT, align="right")
            canvas.line([(x, y + 7), (x + WIDTH, y + 7)], colour="#d5dade", line=0.8)
            y += 10
        for number, (command, text, why) in enumerate(self._rows):
            if self._hidden and number == FIRST:
                canvas.text(x + _LEFT, y + _ROW / 2, f"… and {self._hidden} more", colour=SOFT)
                y += _ROW
            self._row(canvas, x, y, command, text, why)
            y += _height(text, why)

    def _row(
        self, canvas: Surface, x: float, y: float, command: RecordedCommand, text: list[str], why: list[str]
    ) -> None:
        look, y = LOOKS[command.status], y + _ROW / 2
        canvas.text(x + 22, y, str(command.number), bold=True, align="right")
        canvas.text(x + 32, y, look.sign, bold=True, colour=look.strong, align="center")
        canvas.text(x + WIDTH, y, f"{command.start.t:.1f} s", size=SMALL, colour=SOFT, align="right")
        for line in text:
            canvas.text(x + _LEFT, y, line)
            y += _MORE
        for line in why:
            canvas.text(x + _LEFT, y, line, size=SMALL, colour=look.strong)
            y += _MORE

    def _summary(self) -> str:
        track = self._record.track
        metres = sum(a.pose.distance_to((b.pose.x, b.pose.y)) for a, b in pairwise(track))
        bumps = sum(mark.kind == "bump" for mark in self._record.marks)
        parts = [f"{metres:.1f} m", f"battery {track[0].battery:.0f} % → {track[-1].battery:.0f} %"]
        if bumps:
            parts.append("1 bump" if bumps == 1 else f"{bumps} bumps")
        return "   ·   ".join(parts)


def _lines(command: RecordedCommand) -> tuple[list[str], list[str]]:
    room = WIDTH - _LEFT - _RIGHT
    text = letters.wrap_text(letters.make_printable(command.text), room, 2, TEXT, False)
    reason = command.reason or ("halted before its end" if LOOKS[command.status] is HALTED else "")
    why = letters.wrap_text(letters.make_printable(reason), room, 2, SMALL, False) if reason else []
    return text, why


def _height(text: list[str], why: list[str]) -> float:
    return _ROW + (len(text) + len(why) - 1) * _MORE
