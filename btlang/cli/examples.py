"""The missions that ship: what they are, their text, and copies of them with the files that they need."""

from __future__ import annotations

import os
import re
import textwrap
from collections.abc import Iterable, Sequence
from functools import partial

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.diagnostics.files import unwritable
from btlang.support.record import Record
from btlang.support.test_files import ENDING
from btlang.text.source import Source, Span
from btlang.vocabulary.shipped import shipped

_README, _CACHE = "README.md", "__pycache__"
_COMMAND = re.compile(r"^#   btc .*$", re.MULTILINE)
_WORLD = re.compile(r'^world "(.+)"$', re.MULTILINE)
_INCLUDE = re.compile(r'^include "(.+)"$', re.MULTILINE)


class Example(Record):
    """A shipped mission, or a folder of them with its robot, whose text is its README.

    `about` is the comment at its top, `world` its world file ("" for the one that ships).

    `parts` are the files that it includes; these include no others. `test` is its file of tests, "" where it has none.
    The comment ends with the command that runs it in the folder of the mission, with worlds in `worlds`.
    """

    name: str
    about: str
    world: str
    text: str
    parts: tuple[str, ...] = ()
    test: str = ""
    file: str = ""


def examples() -> list[Example]:
    """Return all shipped missions, by name."""
    names = sorted(name[: -len(".txt")] for name in os.listdir(shipped("examples")) if name.endswith(".txt"))
    return [_example(name) for name in names]


def all_examples() -> list[Example]:
    """Return the missions, then the folders."""
    return [*examples(), *_folders()]


def find_examples(names: Iterable[str]) -> list[Example]:
    """Return the missions of these names, with or without `.txt`. Raises MissionError (BT008)."""
    known = {example.name: example for example in all_examples()}
    wanted = [name.removesuffix(".txt") for name in names]
    problems = [_unknown(name, known) for name in wanted if name not in known]
    if problems:
        raise MissionError(problems)
    return [known[name] for name in dict.fromkeys(wanted)]


def path_of(name: str, test: bool = False) -> str:
    """Return the file of a shipped mission, or that of its tests; "" where none has this name."""
    path = shipped("examples", *(("tests", f"{name}{ENDING}") if test else (f"{name}.txt",)))
    return path if os.path.isfile(path) else ""


def describe_near(name: str) -> str:
    """Say what there is in place of a mission of this name: a folder of missions, or a name like it; "" for nothing."""
    if os.path.isfile(shipped("examples", name, _README)):
        return f"It is a robot with several missions. To copy it: btc examples --copy FOLDER {name}"
    near = _nearest(name, [example.name for example in examples()])
    return f"Examples with a similar name: {near}" if near else ""


def list_examples(width: int = 80) -> list[str]:
    """Return a line for each mission with what it does; then the folders."""
    missions, folders = examples(), _folders()
    listed = [*missions, *folders]
    column = max(len(example.name) for example in listed) + 4
    shorten = partial(textwrap.shorten, width=width - column, placeholder=" ...")
    lines = [f"  {each.name:{column - 2}}{shorten(each.about.removesuffix(':'))}" for each in listed]
    return [
        "Missions that ship:", *lines[: len(missions)], "",
        "Folders with a robot, its missions and its rules:", *lines[len(missions) :], "",
        "To run a mission:  btc run NAME", "To test it:        btc test NAME", "To read it:        btc examples NAME",
        "To copy any:       btc examples --copy FOLDER [NAME ...]",
    ]  # fmt: skip


def describe_start(folder: str, chosen: Sequence[Example]) -> list[str]:
    """Return how to begin with what was copied to a folder, in lines."""
    readmes = [os.path.join(folder, example.file) for example in chosen if example.file.endswith(_README)]
    lines = [f"To begin, read {readme}" for readme in readmes]
    if len(readmes) < len(chosen):
        lines.append(f"To run a mission, use the command at its top, in this folder: {folder}")
    return lines


def copy_examples(folder: str, chosen: Sequence[Example]) -> list[str]:
    """Copy missions to a folder, with their worlds, parts and tests in its `worlds`, `parts` and `tests`.

    Returns the paths written.

    Nothing is overwritten: raises MissionError (BT009) with every file that is there already, before any is written. A
    file that is there with the same text stays.
    """
    files = {os.path.join(folder, example.file): example.text.encode() for example in chosen}
    needed = [name for example in chosen for name in (example.world, *example.parts, example.test) if name]
    files |= {os.path.join(folder, name): _data(name) for name in needed}
    there = [path for path in files if os.path.lexists(path)]
    kept = [path for path in there if _same(path, files[path])]
    problems = [
        unwritable(path, "it is there already, and nothing is overwritten") for path in there if path not in kept
    ]
    if problems:
        raise MissionError(problems)
    written = [path for path in files if path not in kept]
    for path in written:
        try:
            os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
            with open(path, "xb") as file:
                file.write(files[path])
        except OSError as error:
            raise MissionError([unwritable(path, error)]) from None
    return written


def _example(name: str) -> Example:
    text = _COMMAND.sub(lambda line: line[0].replace(" examples/", " "), _data(f"{name}.txt").decode("utf-8"), count=1)
    command = _COMMAND.search(text)
    assert command is not None, name
    world = _WORLD.search(text)
    about = " ".join(line.removeprefix("#").strip() for line in text[: command.start()].splitlines())
    test = f"tests/{name}.test.txt"
    tested = os.path.exists(shipped("examples", *test.split("/")))
    parts = tuple(_INCLUDE.findall(text))
    return Example(name, about, world[1] if world else "", text, parts, test if tested else "", f"{name}.txt")


def _folders() -> list[Example]:
    names = sorted(os.listdir(shipped("examples")))
    return [_folder(name) for name in names if os.path.isfile(shipped("examples", name, _README))]


def _folder(name: str) -> Example:
    file, root = f"{name}/{_README}", shipped("examples")
    text = _data(file).decode("utf-8")
    about = " ".join(text.split("\n\n")[1].split())
    found = (os.path.join(place, each) for place, _, names in os.walk(shipped("examples", name)) for each in names)
    paths = sorted(os.path.relpath(path, root).replace(os.sep, "/") for path in found if _CACHE not in path)
    return Example(name, about, "", text, tuple(path for path in paths if path != file), "", file)


def _data(name: str) -> bytes:
    with open(shipped("examples", *name.split("/")), "rb") as file:
        return file.read()


def _same(path: str, data: bytes) -> bool:
    try:
        with open(path, "rb") as file:
            return file.read() == data
    except OSError:
        return False


def _unknown(name: str, known: Iterable[str]) -> Diagnostic:
    near = _nearest(name, known)
    return diagnostic("BT008", Span(Source("", name), 0, 0), name=name, help=f"Similar: {near}" if near else "")


def _nearest(name: str, known: Iterable[str]) -> str:
    from btlang.text.spelling import nearest

    return ", ".join(nearest(name.lower(), known))
