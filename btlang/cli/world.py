"""The verb `world`: checks, draws, imports and exports worlds."""

from __future__ import annotations

import os
import sys
from shutil import get_terminal_size

from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source, unwritable, write_file
from btlang.maps.summary import summarize
from btlang.robots.registry import body_of
from btlang.robots.worlds.world_file import read_world
from btlang.robots.worlds.world_writing import to_toml
from btlang.run.robot_state import RobotState
from btlang.text.formatting import one_line
from btlang.text.output import WIDEST, can_draw, is_unicode, show
from btlang.text.source import Source
from btlang.vocabulary.shipped import DEFAULT_WORLD

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse
    from collections.abc import Mapping

    from btlang.diagnostics.diagnostic import Diagnostic
    from btlang.robots.bodies.body import Body
    from btlang.robots.worlds.world import World

_BAD_INPUT = 2
_ACTS, _TARGETS = ("check", "import", "export"), ("nav2", "json", "yaml")
_RESOLUTION = 0.05  # metres that a cell of an exported map is wide
_ROWS = 10  # that the map leaves for the names
_GIVEN = {
    "picture": "--picture", "out": "-o", "to": "--to", "start": "--start", "origin": "--origin", "level": "--level",
    "resolution": "--resolution",
}  # fmt: skip
_TAKES = {
    "": {"picture"}, "check": set[str](), "import": {"out", "start", "origin", "level"},
    "export": {"out", "to", "resolution"},
}  # fmt: skip


def run_act(options: argparse.Namespace) -> int:
    """Do what the act says; return the exit code. Raises MissionError."""
    words = options.words or [DEFAULT_WORLD]
    act, files = ("", words) if words[0] not in _ACTS else (words[0], words[1:])
    _check_words(options, act, files)
    body = body_of(options.robot)
    if act == "check":
        return _check(options, files, body)
    if act == "import":
        return _import(options, files, body)
    if options.format == "json":
        options.refuse("--format json is for check and import")
    world = read_world(read_source(files[0]), body)
    if act == "export":
        return _export(options, world, body)
    if options.picture is None:
        if can_draw(sys.stdout):
            show(_on_terminal(world))
        show("\n".join(summarize(world)))
    else:
        _draw(world, options.picture, files[0])
    return 0


def _on_terminal(world: World) -> object:
    from btlang.pictures.terminal_map import TerminalMap

    size = get_terminal_size()
    map = TerminalMap(world, is_unicode(sys.stdout))
    return map.text(RobotState(world.start), min(size.columns, WIDEST), size.lines - _ROWS) or ""


def _check_words(options: argparse.Namespace, act: str, files: list[str]) -> None:
    """End with a usage error where options and files don't fit the act."""
    for name, option in _GIVEN.items():
        if getattr(options, name) is not None and name not in _TAKES[act]:
            options.refuse(f"{option} isn't for {act or 'a world alone'}")
    if not files:
        options.refuse(f"{act} needs a file")
    if act in ("", "export") and len(files) > 1:
        options.refuse(f"unexpected argument '{files[1]}'")
    if act == "export" and options.to is None:
        options.refuse(f"choose what to export to with --to: {', '.join(_TARGETS)}")
    if act in ("import", "export") and options.out is None:
        options.refuse(f"{act} needs -o OUT")


def _check(options: argparse.Namespace, files: list[str], body: Body) -> int:
    problems: list[Diagnostic] = []
    for file in files:
        try:
            read_world(read_source(file), body, bounded=True)
        except MissionError as error:
            problems += error.diagnostics
    options.report.add(problems)
    if not problems and not options.report.is_for_programs:
        show("No problems found.")
    return _BAD_INPUT if problems else 0


def _import(options: argparse.Namespace, files: list[str], body: Body) -> int:
    from btlang.maps.importing import import_world

    imported = import_world(files, body.radius, options.start, options.origin, options.level)
    if not options.report.is_for_programs:
        show("\n".join(map(one_line, imported.found)))
    text = to_toml(imported.world).encode(errors="replace").decode()
    read_world(Source(text, options.out), body)  # what the files say together may not fit
    for warning in imported.warnings:
        show(one_line(f"Warning: {warning}"), sys.stderr)
    write_file(options.out, text)
    if not options.report.is_for_programs:
        show(f"Wrote {options.out}.")
    return 0


def _export(options: argparse.Namespace, world: World, body: Body) -> int:
    if options.to == "nav2":
        from btlang.maps.nav2 import GridTooLarge, nav2_files

        try:
            files = nav2_files(world, options.resolution or _RESOLUTION, body.driving.speed or 1.0)
        except GridTooLarge as problem:
            options.refuse(str(problem))
        _write_folder(options.out, files)
    else:
        from btlang.maps.data_text import notation

        write_file(options.out, notation(world, options.to))
        show(f"Wrote {options.out}.")
    return 0


def _write_folder(folder: str, files: Mapping[str, bytes]) -> None:
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as error:
        raise MissionError([unwritable(folder, error)]) from None
    for name, content in files.items():
        write_file(os.path.join(folder, name), content)
    show(f"Wrote {', '.join(files)} into {folder}.")


def _draw(world: World, path: str, name: str) -> None:
    from btlang.pictures.files import check_picture
    from btlang.pictures.world_picture import draw_world

    check_picture(path)
    draw_world(world, path, os.path.splitext(os.path.basename(name))[0])
    show(f"Wrote {path}.")
