"""What a verb of the command line consists of. The table of all verbs is verbs.py."""

from __future__ import annotations

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any


class Option:
    """An option or an argument: what argparse's `add_argument` takes.

    `choices` may be a string "module:NAME", which is imported when the verb is parsed; in the help, {choices} lists
    them. An option costs next to nothing before that: most commands need those of one verb.
    """

    __slots__ = ("names", "settings")

    def __init__(self, *names: str, **settings: Any) -> None:
        self.names = names
        self.settings = settings


class OneOf:
    """A group of options of which a command line may have one, or must have one."""

    __slots__ = ("options", "required")

    def __init__(self, *options: Option, required: bool = True) -> None:
        self.options = options
        self.required = required


class Act(Record):
    """One of the things that a verb does: `add` of `btc task`.

    `options` are the destinations of the options that it takes, beside `name`, and `words` the most arguments. Where
    `options` is None, the handler checks both.
    """

    about: str
    options: tuple[str, ...] | None = None
    words: float = 1


class Verb(Record):
    """A verb of the command line: its line in `btc help`, its options, and the handler "module:function".

    A handler gets the options that argparse read, and returns the exit code. `usual_act` is the act of a command line
    that names none. With `mixed`, options may stand between the arguments. `examples` are commands, each with what it
    does.
    """

    name: str
    group: str
    about: str
    handler: str
    options: tuple[Option | OneOf, ...] = ()
    examples: tuple[tuple[str, str], ...] = ()
    acts: Mapping[str, Act] = {}  # never changed
    usual_act: str = ""
    mixed: bool = False
    usage: str | None = None
