"""What `btc run --record`, `btc replay` and `btc why` do; the verbs of recordings."""

from __future__ import annotations

import math
import os
import platform
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from functools import partial

from btlang.api import Mission
from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.reading import unwritable
from btlang.pictures.command import pictures_of
from btlang.pictures.terminal_map import TerminalMap
from btlang.recording.bundle import ROBOT, files_of
from btlang.recording.compare import first_difference
from btlang.recording.diff import diff
from btlang.recording.drawing import drawn
from btlang.recording.open import opened
from btlang.recording.reader import RecordedNodes, Recording
from btlang.recording.recorder import Recorder
from btlang.recording.replay import Player, Timeline
from btlang.recording.story import Story
from btlang.robots.bodies.body_file import shipped_bodies
from btlang.robots.worlds.world_file import read_world
from btlang.run.command import live_view
from btlang.run.controls import Controls
from btlang.run.events import Event
from btlang.run.lines import Lines
from btlang.run.live.keys import LEFT, RIGHT
from btlang.session import Session
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

    from btlang.run.events import Sink
    from btlang.run.live.view import ViewKey

_MOVE = 10.0  # seconds of the mission that an arrow key goes on or back


@contextmanager
def recorded(mission: Mission, options: argparse.Namespace) -> Iterator[list[Sink]]:
    """The sinks of a run that is recorded, as the options say, with a seed. Raises MissionError (BT009)."""
    import btlang

    if options.seed is None:
        options.seed = int.from_bytes(os.urandom(4), "big")
    about = {
        "btlang": btlang.__version__, "python": platform.python_version(), "wall": f"{time.time():.3f}",
        "mission": os.path.basename(options.file or "") or "a mission", "language": options.language,
        "robot": options.robot, "over": options.over or "",
        "seed": str(options.seed), "rate": f"{options.rate:g}", "speed": str(options.speed),
        "time_limit": "" if options.time_limit is None else f"{options.time_limit:g}",
    }  # fmt: skip
    try:
        files = files_of(mission, options.keywords, options.robot)
        recorder = Recorder(options.record, mission.label, files, about, options.record_size)
    except OSError as error:
        raise MissionError([unwritable(options.record, error)]) from None
    try:
        yield [recorder]
    finally:
        recorder.close()
        if not options.quiet and not recorder.is_broken:
            show(f"Wrote {options.record}.")


def serve(options: argparse.Namespace) -> int:
    """Does the verb `replay`, `why` or `diff`; returns the exit code."""
    return {"replay": _replay, "why": _why, "diff": diff}[options.verb](options)


def _replay(options: argparse.Namespace) -> int:
    """Shows a recorded run as it was, or runs its mission again."""
    with opened(options.file, options.keywords if options.as_mission else None) as (recording, mission, nodes):
        if options.as_mission:
            return _run_again(recording, mission, nodes)
        if options.to is not None:
            return _write_log(options.to, recording, mission, nodes)
        controls = Controls()
        sinks: list[Sink] = []
        timeline = Timeline(list(recording.events(nodes)), nodes)
        player = Player(timeline, sinks, controls)
        lines = Lines(mission.label, mission.is_action, show)
        view = None if options.lines else live_view(mission, controls, keys=partial(_keys, player, controls))
        if view is not None and "simulated" in (recording.about.get("robot"), recording.about.get("over")):
            view.show_map(TerminalMap(read_world(mission.world), view.unicode))
        start = -math.inf if options.start is None else options.start
        if options.failure:
            start = next(iter(timeline.failures), -math.inf)
            controls.paused = view is not None and start > -math.inf
        speed = {"real": 1.0, "max": math.inf}.get(options.speed, options.speed)
        sinks.append(lines if view is None else view)
        with nullcontext() if view is None else view, _shown(options.groot, controls, mission, nodes) as monitors:
            sinks += monitors
            try:
                player.play(speed, start)
            except KeyboardInterrupt:
                return 130
        with pictures_of(mission, options.picture, options.tree_picture, quiet=False) as pictures:
            for event in timeline.events:
                for picture in pictures:
                    drawn(picture)(event)
        if options.why:
            show("\n".join(Story(mission, nodes, recording.about).take(timeline.events).lines()))
    return 0


def _keys(player: Player, controls: Controls) -> list[ViewKey]:
    from btlang.run.live.view import ViewKey, usual_keys

    pause, step, stop, _ = usual_keys(controls)
    moves = {LEFT: partial(player.move, -_MOVE), RIGHT: partial(player.move, _MOVE)}
    across = ViewKey(f"{LEFT}/{RIGHT}", f"{_MOVE:g} s", moves)
    return [pause, step, across, ViewKey("f", "next failure", {"f": player.next_failure}), stop]


@contextmanager
def _shown(port: int | None, controls: Controls, mission: Mission, nodes: RecordedNodes) -> Iterator[list[Sink]]:
    """The sinks that show a replay to Groot2. Raises MissionError (BT085, BT086)."""
    if port is None:
        yield []
        return
    from btlang.monitor.command import ReplayMonitor, groot_monitor

    with groot_monitor(port, controls) as monitor:
        yield [ReplayMonitor(monitor.server, nodes, mission)]


def _write_log(path: str, recording: Recording, mission: Mission, nodes: RecordedNodes) -> int:
    """As a log of BehaviorTree.CPP."""
    from btlang.backends.files import write_file
    from btlang.monitor.btlog import to_btlog
    from btlang.monitor.command import groot_tree

    write_file(path, to_btlog(groot_tree(nodes, mission), recording.events(nodes)))
    show(f"Wrote {path}.")
    return 0


def _why(options: argparse.Namespace) -> int:
    """Prints what happened in a recorded run."""
    with opened(options.file, options.keywords if options.as_mission else None) as (recording, mission, nodes):
        story = Story(mission, nodes, recording.about).take(recording.events(nodes))
        show("\n".join(story.lines()))
    return 0


@contextmanager
def _robot_of(recording: Recording) -> Iterator[tuple[str, str | None]]:
    """The robot of a recording and what it runs on, for as long as it is used: always a simulated one."""
    if ROBOT not in recording.files:
        name = recording.about.get("robot", "")
        yield (name, "simulated") if name in shipped_bodies() else ("simulated", None)
        return
    with tempfile.TemporaryDirectory(prefix="btlang-") as folder:
        path = os.path.join(folder, ROBOT)
        with open(path, "wb") as file:
            file.write(recording.files[ROBOT])
        yield path, "simulated"


def _run_again(recording: Recording, mission: Mission, nodes: RecordedNodes) -> int:
    """Runs the mission of a recording on the simulated robot, and shows where it goes otherwise."""
    about, events = recording.about, list[Event]()
    with _robot_of(recording) as (robot, over), Session(robot, world=mission.world, over=over) as session:
        session.run(
            mission, speed="max", rate=float(about.get("rate", 20)), seed=int(about.get("seed", 0)),
            time_limit=float(about["time_limit"]) if about.get("time_limit") else None, sinks=[events.append],
        )  # fmt: skip
    difference = first_difference(recording.events(nodes), events, nodes.node, mission.label)
    show(difference or "The run was the same.", sys.stderr if difference else None)
    return 1 if difference else 0
