"""What texts can be read. A front end is a line in `FRONTENDS`, and a function that is imported when it is used."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.support.record import Record
from btlang.text.source import Source, Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.frontends.mission.reader import Reading
    from btlang.tree.node import Tree


class Frontend(Record):
    """`read` names the function that reads it, "module:function" of (source, **options) to a Tree or a Reading.

    `begins` looks at a text without the blanks in front of it. `options` are the options that the function takes.
    """

    read: str
    begins: Callable[[str], bool]
    options: tuple[str, ...]


def _is_json(text: str) -> bool:
    return text[:1] == "{" and text[1:].lstrip()[:1] in ('"', "}")  # `{counter} is 3` is English


FRONTENDS = {
    "xml": Frontend("btlang.frontends.btcpp.reader:read_xml", lambda text: text[:1] == "<", ("main",)),
    "json": Frontend("btlang.frontends.json.reader:read_json", _is_json, ("main",)),
    "english": Frontend(
        "btlang.frontends.mission.reader:read_mission", lambda _: True, ("vocabulary", "parser", "errors_of", "known")
    ),
}
"""The first that a text begins as reads it."""
XML_ENDINGS = (".xml", ".btproj")
"""Of the names of files with trees or models of BehaviorTree.CPP and Groot."""


def frontend_of(source: Source) -> str:
    """The name of the front end that reads a text."""
    text = source.text.lstrip("\ufeff \t\r\n")
    return next(name for name, frontend in FRONTENDS.items() if frontend.begins(text))


def read_text(source: Source, main: str = "", **options: Any) -> Tree | Reading:
    """The tree of XML or JSON, the syntax tree of English; of the options those count that its front end takes.

    `main` is the ID of one of several trees. Raises MissionError.
    """
    frontend = FRONTENDS[frontend_of(source)]
    if main and "main" not in frontend.options:
        raise MissionError(
            [diagnostic("BT126", Span(source, 0, 0), name=main, help="A mission in English is one tree.")]
        )
    module, _, function = frontend.read.partition(":")
    chosen = {name: value for name, value in {**options, "main": main}.items() if name in frontend.options}
    read: Tree | Reading = getattr(import_module(module), function)(source, **chosen)
    return read
