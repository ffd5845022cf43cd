"""The verb `gesture`: plays, checks, draws and records gestures."""

from __future__ import annotations

import os
import tomllib
from functools import partial

from btlang.api import parse_tree
from btlang.components.words import words_of
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import read_source, write_file
from btlang.gestures.checking import check_file
from btlang.gestures.recording import record
from btlang.pictures.files import MOVING, STILL, check_picture, picture_ending
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.gesture import Gesture
from btlang.robots.bodies.gesture_file import TARGET, phrase_forms
from btlang.robots.registry import Connector, body_of, runs_in_real_time, runs_on
from btlang.robots.simulation.rehearsal import rehearse
from btlang.text.output import show
from btlang.text.source import Source, Span
from btlang.text.spelling import nearest
from btlang.vocabulary.pattern import Slot

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

_ROBOT = "robot.toml"
_TAKES = {"play": {"at", "over", "speed"}, "check": set[str](), "picture": {"out"}, "record": {"out", "over"}}
_GIVEN = {"at": None, "over": None, "speed": "real", "out": None}


def run_act(options: argparse.Namespace) -> int:
    """Do what the act says; return the exit code. Raises MissionError."""
    act, items = options.act, options.items
    for name, usual in _GIVEN.items():
        if getattr(options, name) != usual and name not in _TAKES[act]:
            options.refuse(f"{'-o' if name == 'out' else f'--{name}'} isn't for {act}")
    if act == "check":
        return _check(options)
    if len(items) > 1:
        options.refuse(f'{act} takes one gesture; put its name in quotes: btc gesture {act} "{" ".join(items)}"')
    if not options.robot:
        options.refuse(f"{act} needs --robot FILE")
    if act in ("picture", "record") and options.out is None:
        options.refuse(f"{act} needs -o OUT")
    body, over = runs_on(options.robot, options.over)
    if act == "record":
        return record(items[0], options.out, body, over)
    gesture = _find_gesture(items[0], body)
    return _play(options, body, over, gesture) if act == "play" else _draw(options.out, body, gesture)


def _find_gesture(name: str, body: Body) -> Gesture:
    found = body.gestures.get(name)
    if found is None:
        near = nearest(name, body.gestures)
        listed = f"Similar: {', '.join(near)}" if near else f"Its gestures: {', '.join(body.gestures) or 'none'}"
        where = Span(Source(name, "gesture"), 0, len(name))
        missing = f'gesture "{name}"'
        raise MissionError(
            [diagnostic("BT072", where, words="btc gesture", parts=missing, robot=body.name, help=listed)]
        )
    return found


def _play(options: argparse.Namespace, body: Body, over: str, gesture: Gesture) -> int:
    from btlang.run.terminal import run_mission
    from btlang.session import Session

    if options.speed != "real" and runs_in_real_time(body, over):
        options.refuse(f"the robot runs in real time over {over}, so it takes no --speed")
    world = options.world or body.world or None
    words = _mission_text(options, gesture)
    mission = parse_tree(Source(words, "<command line>"), keywords=words_of(body), world=world)
    return run_mission(
        mission, partial(Session, Connector(body, over), world=mission.world), speed=options.speed, rate=20.0,
        time_limit=None, log=None, quiet=False, lines=True,
    )  # fmt: skip


def _mission_text(options: argparse.Namespace, gesture: Gesture) -> str:
    """Return the gesture as a mission."""
    for form in phrase_forms(gesture):
        if (options.at is not None) == (Slot(TARGET) in form):
            return " ".join(part if isinstance(part, str) else str(options.at) for part in form)
    needs = "needs --at TARGET" if options.at is None else "takes no --at"
    return str(options.refuse(f'the gesture "{gesture.name}" {needs}'))


def _check(options: argparse.Namespace) -> int:
    """Check files of gestures, and all gestures of robot files."""
    found = []
    for path in options.items:
        source = read_source(path)
        if _is_gesture(source):
            body = body_of(options.robot or _robot_above(path) or "simulated")
            found += list(check_file(path, body))
        else:
            body = body_of(source)
            for file in dict.fromkeys(gesture.file for gesture in body.gestures.values()):
                found += list(check_file(file, body))
    options.report.add(found)
    if not found:
        show("No problems found.")
    return 2 if any(each.is_error for each in found) else 0


def _is_gesture(source: Source) -> bool:
    try:
        return "radius" not in tomllib.loads(source.text)
    except tomllib.TOMLDecodeError:
        return True


def _robot_above(path: str) -> str | None:
    """Find the robot file in the folder of a gesture, or in the one above it."""
    folder = os.path.dirname(os.path.abspath(path))
    places = (os.path.join(each, _ROBOT) for each in (folder, os.path.dirname(folder)))
    return next((place for place in places if os.path.isfile(place)), None)


def _draw(path: str, body: Body, gesture: Gesture) -> int:
    from btlang.pictures.figure import draw_gesture

    kind = picture_ending(path, STILL + MOVING)
    check_picture(path)
    rehearsal = rehearse(body, gesture)
    if rehearsal.problem:
        where = Span(Source(gesture.name, gesture.file or body.name), 0, 0)
        raise MissionError([diagnostic("BT076", where, reason=f"{gesture.name}: {rehearsal.problem}")])
    write_file(path, draw_gesture(body, gesture, rehearsal, path, kind))
    show(f"Wrote {path}.")
    return 0
