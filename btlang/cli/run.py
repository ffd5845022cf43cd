"""The verb `run`: a mission with its pictures, its recording, and what shows it elsewhere."""

from __future__ import annotations

import argparse
import os
import platform
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

from btlang.api import Mission
from btlang.cli.missions import mission_of
from btlang.cli.robots import choose_robot, note_silent_voice, print_preflight
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import unwritable
from btlang.pictures.files import check_picture
from btlang.robots.ears import read_answers
from btlang.robots.platforms import ROBOTS
from btlang.robots.voice import voice_track
from btlang.robots.worlds.world_file import read_world
from btlang.run.terminal import run_mission
from btlang.session import Session
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.bodies.body import Body
    from btlang.robots.registry import Connector
    from btlang.run.events import Sink
    from btlang.text.source import Source

_SUCCESS, _FAILED = 0, 1


def run(options: argparse.Namespace) -> int:
    """Run a mission as the options say; return the exit code."""
    robot, mission = choose_robot(options), mission_of(options, tells_undeclared=False)
    if mission.robot and options.robot in ROBOTS:
        if options.robot != "simulated":
            options.over = options.robot
        options.robot = mission.robot
        robot = choose_robot(options)
    if options.preflight:
        ready = print_preflight(mission.tree, mission.vocabulary, read_world(mission.world, robot.body), robot)
        return _SUCCESS if ready else _FAILED
    if options.text is not None and robot.over == "simulated":
        _note_robots_up()
    if not options.quiet:
        note_silent_voice(robot)
        if robot.body.rules:
            show("note: the house rules of this robot hold with btc robot up, and not in btc run", sys.stderr)
    if not options.watch:
        return _run_shown(options, mission, robot)
    from btlang.server.page.watching import open_monitor

    name = "mission" if options.text is not None or options.file == "-" else os.path.basename(options.file)
    with open_monitor(mission, name, robot.body, robot.over == "simulated", options.browser) as monitor:
        return monitor.stay(_run_shown(options, mission, robot, monitor.opened))


def _run_shown(options: argparse.Namespace, mission: Mission, robot: Connector, *monitors: Callable[..., Any]) -> int:
    """Run a mission with its pictures and its recording; `monitors` show it elsewhere."""
    with (
        pictures_of(mission, options.picture, options.tree_picture, options.quiet) as sinks,
        record_run(mission, options, robot.body) as recorders,
        voice_track(options.voice, robot.body) as voices,
    ):
        return run_mission(
            mission,
            partial(_open_session, robot, mission.world),
            speed=options.speed,
            rate=options.rate,
            time_limit=options.time_limit,
            seed=options.seed,
            answers=options.answers and read_answers(options.answers),
            log=options.log,
            quiet=options.quiet,
            lines=options.lines,
            sinks=[*sinks, *recorders, *voices],
            scans=None if not recorders else 0.0 if options.record is None else options.record_scans,
            open_monitors=[*_groot(options.groot), *monitors],
            limit_option="--for 60s",
        )


def _open_session(robot: Connector, world: str | Source | None) -> Session:
    """Open a session. Raises MissionError, also if a component can't be loaded: its rules would never act."""
    session = Session(robot, world=world)
    check = getattr(session.connection, "check_loaded", None)
    try:
        if check is not None:
            check()
    except BaseException:
        session.close()
        raise
    return session


def _note_robots_up() -> None:
    """Say that what is typed moves none of the robots that are up: somebody may want to stop one."""
    from btlang.task.commands.client import names_up

    if names := names_up():
        who = f"robot '{names[0]}', which is up" if len(names) == 1 else "robots that are up"
        show(
            f"note: this runs in a simulation of its own, not on the {who}. To stop that: btc robot stop. "
            'To give it work: btc task add "..."',
            sys.stderr,
        )


def _groot(port: int | None) -> list[Callable[..., Any]]:
    """Make what shows a run to Groot2, if the options ask for that."""
    if port is None:
        return []
    from btlang.monitor.groot import groot_monitor

    return [partial(groot_monitor, port)]


@contextmanager
def pictures_of(mission: Mission, run: str | None, tree: str | None, quiet: bool) -> Iterator[list[Sink]]:
    """Give the sinks that a run needs, and draw it to the files (None: no picture) at the end, however it ends.

    Says so unless it is `quiet`.

    Raises MissionError (BT009, BT081), as far as it can before the run.
    """
    for path in (run, tree):
        if path is not None:
            check_picture(path)
    sinks: list[Sink] = []
    written: list[str] = []
    if tree is not None:
        from btlang.pictures.run_record import LastStatuses

        statuses = LastStatuses()
        sinks.append(statuses)
    if run is not None:
        from btlang.pictures.run_picture import RunPicture
        from btlang.pictures.tree_layout import title_of
        from btlang.robots.worlds.world_file import load_world

        picture = RunPicture(load_world(mission.world), mission.label, mission.is_action, title_of(mission.tree))
        sinks.append(picture)
    try:
        yield sinks
    finally:
        if run is not None:
            picture.save(run)
            written.append(run)
        if tree is not None and statuses.by_path:
            from btlang.pictures.tree_picture import draw_tree

            draw_tree(mission.tree, mission.label, mission.is_action, tree, run=statuses)
            written.append(tree)
        if written and not quiet:
            show(f"Wrote {' and '.join(written)}.")


@contextmanager
def record_run(mission: Mission, options: argparse.Namespace, body: Body) -> Iterator[list[Sink]]:
    """Give the sinks that record a run, which then has a seed: into the file of the options, or else as the latest run.

    A quiet run is only recorded if the options ask for it. Raises MissionError (BT009).
    """
    if options.record is None and options.quiet:
        yield []
        return
    import btlang
    from btlang.recording.bundle import files_of
    from btlang.recording.latest import PART_BYTES, UnaskedRecording, note_latest, unasked_path
    from btlang.recording.recorder import Recorder

    if options.seed is None:
        options.seed = read_world(mission.world, body).seed
    if options.seed is None:
        options.seed = int.from_bytes(os.urandom(4), "big")
    about = {
        "btlang": btlang.__version__, "python": platform.python_version(), "wall": f"{time.time():.3f}",
        "mission": os.path.basename(options.file or ""), "language": options.language,
        "robot": options.robot, "over": options.over or "",
        "seed": str(options.seed), "rate": f"{options.rate:g}", "speed": str(options.speed),
        "time_limit": "" if options.time_limit is None else f"{options.time_limit:g}",
    }  # fmt: skip
    is_asked = options.record is not None
    try:
        path, size = (options.record, options.record_size) if is_asked else (unasked_path(), PART_BYTES)
        files = files_of(mission, options.keywords, options.robot)
        recorder = Recorder(path, mission.label, files, about, size, note_latest)
    except (OSError, MissionError) as error:
        if is_asked:
            raise MissionError([unwritable(path, error)]) if isinstance(error, OSError) else error from None
        recorder = None
    if recorder is None:
        yield []
        return
    try:
        yield [recorder if is_asked else UnaskedRecording(recorder)]
    finally:
        recorder.close()
        if is_asked and not options.quiet and not recorder.is_broken:
            show(f"Wrote {options.record}.")
