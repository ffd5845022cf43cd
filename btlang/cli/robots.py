"""Robots as options name them, and what a mission needs of one."""

from __future__ import annotations

import sys
from contextlib import closing

from btlang.diagnostics.diagnostic import render
from btlang.passes.lint.allow import not_allowed, not_silenced
from btlang.robots.bodies.speech_tables import engine_of
from btlang.robots.registry import connector, runs_in_real_time, runs_on
from btlang.speech.engine import MissingEngine, SpeechError
from btlang.text.formatting import TextTable
from btlang.text.output import has_colour, show

TYPE_CHECKING = False
if TYPE_CHECKING:
    from argparse import Namespace
    from typing import Any

    from btlang.robots.registry import Connector
    from btlang.robots.worlds.world import World
    from btlang.tree.node import Tree
    from btlang.vocabulary.lexicon import Lexicon


def choose_robot(options: Namespace) -> Connector:
    """Make the connector that `btlang.Session` takes. Ends with a usage error if options don't go together.

    Raises MissionError.
    """
    if options.simulate:
        if options.over not in (None, "devices"):
            options.refuse("--simulate is for robots that run over devices")
        options.over = "devices"
    over = platform_of(options)
    if options.servers is not None and over != "actions":
        options.refuse("--servers is for --robot actions")
    if over in ("simulated", "devices") and (options.sim_time or options.preflight or options.namespace):
        options.refuse("--sim-time, --namespace and --preflight are for --robot ros and --robot actions")
    servers = {} if options.servers is None else {"servers": f"/{options.servers.strip('/')}"}
    if over == "devices":
        return connector(options.robot, options.over, simulate=options.simulate)
    named = {"sim_time": options.sim_time, "namespace": options.namespace, **servers}
    return connector(options.robot, options.over, **named)


def platform_of(options: Namespace) -> str:
    """Return what the chosen robot runs on. Ends with a usage error if that takes no --speed. Raises MissionError."""
    body, over = runs_on(options.robot, options.over)
    if options.speed != "real" and runs_in_real_time(body, over, getattr(options, "simulate", ())):
        how = f"--robot {over}" if options.robot == over else f"--robot {options.robot} over {over}"
        options.refuse(f"{how} runs in real time, so it takes no --speed")
    return over


def note_silent_voice(robot: Connector) -> None:
    """Say that a simulated robot has to do without the engine of its voice, if that isn't installed."""
    if robot.over != "simulated":
        return
    try:
        engine_of(robot.body)
    except MissingEngine as missing:
        show(f"note: The voice is silent and its times are estimated, because {missing}", sys.stderr)
    except SpeechError:
        pass  # the run says so


def print_preflight(tree: Tree, vocabulary: Lexicon, world: World, robot: Any) -> bool:
    """Print what a tree needs of the robot, a line each; return whether all of it is there. Raises MissionError.

    `robot` is what `choose_robot` gives for a ROS 2 robot.
    """
    with closing(robot(world)) as connection:
        found = connection.survey(tree, vocabulary)
        lacks = connection.lacking_parts(tree, vocabulary)
        warnings = connection.warnings(found)
        blind = not_allowed(connection.blind(found))
    rows = [
        (needed.sort, needed.name, needed.type, f"missing: {reason}" if reason else "found")
        for needed, (_, reason) in found.items()
    ]
    rows += [("part", part, "", "missing: it is not in the robot file") for part in lacks]
    if rows:
        show(TextTable(tuple(rows), widths=(7, 20, 36), gap=1))
    for warning in warnings:
        show(f"warning: {warning}")
    for problem in blind:
        if not_silenced([problem], problem.span.source, vocabulary):
            show(render(problem, has_colour(sys.stderr)), sys.stderr)
    missing = sum(bool(reason) for _, reason in found.values()) + len(lacks)
    show(
        f"Missing: {missing} of {len(found) + len(lacks)}."
        if missing
        else "The robot has everything that the mission needs."
    )
    return not missing
