"""The options of `btc new`."""

from __future__ import annotations

import argparse
import re
from keyword import iskeyword

from btlang.templates.project import KINDS

_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
_LONGEST = 40


def add_new_options(parser: argparse.ArgumentParser) -> None:
    """All of them."""
    parser.add_argument("kind", choices=KINDS, metavar="KIND", help="component, device or robot")
    parser.add_argument("name", type=project_name, metavar="NAME", help="name of the project and of its folder")


def project_name(text: str) -> str:
    """A name that is one of a Python module."""
    if not _NAME.fullmatch(text) or iskeyword(text) or len(text) > _LONGEST:
        raise argparse.ArgumentTypeError(
            f"expected a name of small letters, digits and _, such as coffee_machine, not '{text}'"
        )
    return text
