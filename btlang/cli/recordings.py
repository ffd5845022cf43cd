"""The verbs `replay`, `watch` and `why`."""

from __future__ import annotations

import math
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from functools import partial

from btlang.api import Mission
from btlang.cli.run import pictures_of
from btlang.pictures.terminal_map import TerminalMap
from btlang.recording.bundle import ROBOT
from btlang.recording.diff import first_difference
from btlang.recording.latest import latest_recording
from btlang.recording.reader import RecordedNodes, Recording, no_recording, open_recording
from btlang.recording.replay import Player, ReplayTimeline, adapt_picture
from btlang.recording.story import Story, explain_recording
from btlang.robots.bodies.body_file import shipped_bodies
from btlang.robots.worlds.world_file import read_world
from btlang.run.controls import Controls
from btlang.run.events import Event
from btlang.run.live.keys import LEFT, RIGHT
from btlang.run.logs import PlainLines
from btlang.run.terminal import live_view
from btlang.session import Session
from btlang.text.output import show
from btlang.vocabulary.shipped import DEFAULT_WORLD

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

    from btlang.run.events import Sink
    from btlang.run.live.view import ViewKey

_MOVE = 10.0  # seconds of the mission that an arrow key goes on or back


def replay(options: argparse.Namespace) -> int:
    """Show a recorded run as it was, or run its mission again; return the exit code."""
    with open_recording(_chosen(options), options.keywords if options.as_mission else None) as (
        recording,
        mission,
        nodes,
    ):
        if options.as_mission:
            return _run_again(recording, mission, nodes)
        if options.to is not None:
            return _write_log(options.to, recording, mission, nodes)
        controls = Controls()
        sinks: list[Sink] = []
        timeline = ReplayTimeline(list(recording.events(nodes)), nodes)
        player = Player(timeline, sinks, controls)
        lines = PlainLines(mission.label, mission.is_action, show)
        view = None if options.lines else live_view(mission, controls, keys=partial(_keys, player, controls))
        if view is not None and "simulated" in (recording.about.get("robot"), recording.about.get("over")):
            view.show_map(TerminalMap(read_world(mission.world), view.unicode))
        start = -math.inf if options.start is None else options.start
        if options.failure:
            start = next(iter(timeline.failures), -math.inf)
            controls.paused = view is not None and start > -math.inf
        chosen = options.speed
        if not chosen:  # nobody watches a pipe or a file
            chosen = "real" if options.groot is not None or (sys.stdout is not None and sys.stdout.isatty()) else "max"
        speed = {"real": 1.0, "max": math.inf}.get(chosen, chosen)
        sinks.append(lines if view is None else view)
        with (
            nullcontext() if view is None else view,
            _show_in_groot(options.groot, controls, mission, nodes) as monitors,
        ):
            sinks += monitors
            try:
                player.play(speed, start)
            except KeyboardInterrupt:
                return 130
        with pictures_of(mission, options.picture, options.tree_picture, quiet=False) as pictures:
            for event in timeline.events:
                for picture in pictures:
                    adapt_picture(picture)(event)
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
def _show_in_groot(
    port: int | None, controls: Controls, mission: Mission, nodes: RecordedNodes
) -> Iterator[list[Sink]]:
    """Give the sinks that show a replay to Groot2. Raises MissionError (BT085, BT086)."""
    if port is None:
        yield []
        return
    from btlang.monitor.groot import ReplayMonitor, groot_monitor

    with groot_monitor(port, controls) as monitor:
        yield [ReplayMonitor(monitor.server, nodes, mission)]


def _write_log(path: str, recording: Recording, mission: Mission, nodes: RecordedNodes) -> int:
    """Write a recording as a log of BehaviorTree.CPP."""
    from btlang.diagnostics.files import write_file
    from btlang.monitor.groot import groot_tree
    from btlang.monitor.groot_protocol import to_btlog

    write_file(path, to_btlog(groot_tree(nodes, mission), recording.events(nodes)))
    show(f"Wrote {path}.")
    return 0


def watch(options: argparse.Namespace) -> int:
    """Show a recorded run in the browser; return the exit code."""
    from btlang.server.page.watching import serve

    return serve(_chosen(options), options.browser)


def explain_run(options: argparse.Namespace) -> int:
    """Print what happened in a recorded run, or in a task by its number; return the exit code."""
    if _is_number(options.file):
        from btlang.cli.task import explain_task, number_of

        return explain_task(options.name, number_of("why", options.file))
    show(explain_recording(_chosen(options)))
    return 0


def _is_number(file: str | None) -> bool:
    return file is not None and file.isdecimal() and not os.path.exists(file)


def _chosen(options: argparse.Namespace) -> str:
    """Return the recording that the options name: a file, that of a task, or that of the latest run.

    Raises MissionError (BT088) if there's no such recording.
    """
    if _is_number(options.file):
        from btlang.cli.task import number_of, recording_of

        return recording_of(options.name, number_of(options.verb, options.file))
    path = options.file or latest_recording()
    if not path:
        raise no_recording("the latest run", "Run a mission first, or name a recording.")
    return path


@contextmanager
def _robot_of(recording: Recording) -> Iterator[tuple[str, str | None]]:
    """Give the robot of a recording and what it runs on, which is always a simulation."""
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
    """Run the mission of a recording on the simulated robot, and show where it goes otherwise."""
    about, events = recording.about, list[Event]()
    world = mission.world or DEFAULT_WORLD
    with _robot_of(recording) as (robot, over), Session(robot, world=world, over=over) as session:
        session.run(
            mission, speed="max", rate=float(about.get("rate", 20)), seed=int(about.get("seed", 0)),
            time_limit=float(about["time_limit"]) if about.get("time_limit") else None, sinks=[events.append],
        )  # fmt: skip
    difference = first_difference(recording.events(nodes), events, nodes.node, mission.label)
    show(difference or "The run was the same.", sys.stderr if difference else None)
    return 1 if difference else 0
