"""Makes the folder of a new project from that of its template, a project named "my_gadget"."""

from __future__ import annotations

import os
import re
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from importlib.util import find_spec

from btlang.api import parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import unwritable
from btlang.robots.bodies.body_file import shipped_bodies
from btlang.robots.platforms import ROBOTS

KINDS = ("component", "device", "robot")
"""Of projects, each with a template of its name beside this module."""
_TEMPLATES = os.path.dirname(os.path.abspath(__file__))
_NAMES = re.compile("my_gadget|Gadget|gadget")


def template_text(kind: str, name: str, file: str) -> str:
    """Return the text of a file of a new project."""
    return _files(kind, name)[os.path.join(name, file)]


def make_project(kind: str, name: str, own: Mapping[str, str] = {}, notes: Sequence[str] = ()) -> list[str]:
    """Make the folder `name`, which is one of a Python module, in the current folder; return the paths of its files.

    `own` has texts in place of those of the template; its README lists the `notes`, for the user to check.
    Raises MissionError (BT009) where there is one that isn't empty, or it can't be made, or the name has a meaning.
    """
    files = {**_files(kind, name), **{os.path.join(name, file): text for file, text in own.items()}}
    if notes:
        lines = "".join(f"- [ ] {' '.join(note.split())}\n" for note in notes)
        files[os.path.join(name, "README.md")] += f"\n## To check\n\nThis was guessed or left out:\n\n{lines}"
    refused = _meaning(kind, name, files)
    if refused:
        raise MissionError([unwritable(name, refused)])
    try:
        os.makedirs(name, exist_ok=True)
        if os.listdir(name):
            raise MissionError([unwritable(name, "the folder is there already, and it isn't empty")])
        for path, text in files.items():
            with open(path, "x", encoding="utf-8") as file:
                file.write(text)
    except OSError as error:
        raise MissionError([unwritable(error.filename or name, error)]) from None
    return list(files)


def _files(kind: str, name: str) -> dict[str, str]:
    """Return the text of each file by its path; fewer where two have one path."""
    names = {"my_gadget": name, "gadget": _said(name), "Gadget": _class(name)}
    return {
        os.path.join(name, file.replace("my_gadget", name)): _NAMES.sub(lambda match: names[match[0]], text)
        for file, text in _template(kind)
    }


def _template(kind: str) -> Iterator[tuple[str, str]]:
    with os.scandir(os.path.join(_TEMPLATES, kind)) as entries:
        for entry in sorted((each for each in entries if each.is_file()), key=lambda each: each.name):
            with open(entry.path, encoding="utf-8") as file:
                yield entry.name, file.read()


def _said(name: str) -> str:
    return name.replace("_", " ")


def _class(name: str) -> str:
    return name.title().replace("_", "")


def _meaning(kind: str, name: str, files: Mapping[str, str]) -> str:
    """Return what a name means already, so that this can't have it; "" where it is free."""
    spec = find_spec(name)
    if name in sys.stdlib_module_names or (spec is not None and spec.origin is not None):
        return "there is a Python module of this name; choose another one"
    if any(re.search(rf"\b{_class(name)}\b", text) for _, text in _template(kind)):
        return f"the project has another {_class(name)}; choose another name"
    if len(files) < len(list(_template(kind))):
        return "another file of the project has this name; choose another one"
    if kind == "robot" and name in (*ROBOTS, *shipped_bodies()):
        return "there is a robot of this name; choose another one"
    if kind == "component" and not _can_be_said(name, files):
        return "missions can't say this name, since it has another meaning there; choose another one"
    return ""


def _can_be_said(name: str, files: Mapping[str, str]) -> bool:
    with tempfile.TemporaryDirectory() as folder:
        words, mission = os.path.join(folder, "words.toml"), files[os.path.join(name, "mission.txt")]
        with open(words, "x", encoding="utf-8") as file:
            file.write(files[os.path.join(name, f"{name}.toml")])
        try:
            return not parse_tree(mission, keywords=[words]).warnings
        except MissionError:
            return False
