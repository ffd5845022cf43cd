"""The parser of command-line options that every verb of `btc` has."""

from __future__ import annotations

import argparse
import sys
import textwrap

from btlang.text.output import WIDEST, columns, show
from btlang.text.spelling import nearest

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any, NoReturn


_ACTS = "acts:\n"
"""Begins an epilog that lists acts, each with a line about it."""


class _Help(argparse.HelpFormatter):
    """Asks for the width of the terminal only to print: argparse makes one for each option that is added."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, width=WIDEST)

    def format_help(self) -> str:
        self._width = columns(80) - 2
        return super().format_help()

    def _format_text(self, text: str) -> str:
        if not text.startswith(_ACTS):
            return super()._format_text(text)
        rows = text.removeprefix(_ACTS).split("\n")
        column = max(map(len, rows[::2])) + 4
        lines = [
            textwrap.fill(about, self._width, initial_indent=f"  {act:{column - 2}}", subsequent_indent=" " * column)
            for act, about in zip(rows[::2], rows[1::2], strict=True)
        ]
        return "\n".join(("acts:", *lines, ""))


class OptionParser(argparse.ArgumentParser):
    """As argparse has it, but that errors are a line and a hint."""

    def __init__(self, prog: str | None = None, **options: Any) -> None:
        super().__init__(prog, formatter_class=_Help, **options)
        self.set_defaults(refuse=self.refuse)  # ends with a usage error what only the verb can see to be wrong

    def format_help(self) -> str:
        """What argparse says, and then examples."""
        from btlang.command_examples import EXAMPLES

        found = EXAMPLES.get(self.prog.removeprefix("btc "), ())
        lines = [f"  {command}\n      {about}\n" for command, about in found]
        return "".join((super().format_help(), "\nexamples:\n" * bool(lines), *lines))

    def check_option(self, name: str) -> None:
        """Refuses an option that doesn't exist, before its value is taken for a file."""
        known = [option for action in self._actions for option in action.option_strings]
        if not any(option.startswith(name) for option in known):
            near = nearest(name, known, 1)
            self.refuse(f"there's no option '{name}'", f"Did you mean: {near[0]}" if near else "")

    def error(self, message: str) -> NoReturn:
        self.refuse(message)

    def refuse(self, message: str, hint: str = "") -> NoReturn:
        """Ends the command with exit code 2, after a line that says what is wrong and one that says what to do."""
        hint = hint or f"Run 'btc help{self.prog.removeprefix('btc')}' for help."
        self.exit(2, f"{self.prog}: {message}\n{hint}\n")

    def _print_message(self, message: str, file: Any = None) -> None:
        show(message, sys.stderr if file is None else file, end="")


def add_acts(parser: argparse.ArgumentParser, acts: Mapping[str, str], **options: Any) -> None:
    """Adds the argument that says what a verb does, and a list of what each of these acts is."""
    parser.add_argument("act", choices=acts, metavar="ACT", help="what to do: see below", **options)
    lines = "\n".join(f"{act}\n{about}" for act, about in acts.items())
    parser.epilog = f"{_ACTS}{lines}"
