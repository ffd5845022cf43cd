"""Where the data files of the product lie: keyword files, grammars, worlds."""

from __future__ import annotations

import os
from functools import cache

PACKAGE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))

DEFAULT_WORLD = os.path.join(PACKAGE, "robots", "worlds", "default.toml")
"""The world that a mission runs in where none is named."""
BODIES = os.path.join(PACKAGE, "robots", "bodies")
"""The folder of the robot files that ship."""
STANDARD_BODY = os.path.join(BODIES, "standard.toml")
"""The robot that a mission runs on where none is named."""


def shipped(*parts: str) -> str:
    """The path of a shipped file: inside an installed package, else beside the package in a checkout."""
    installed = os.path.join(PACKAGE, "_resources", *parts)
    return installed if os.path.exists(installed) else os.path.join(os.path.dirname(PACKAGE), *parts)


@cache
def keyword_files() -> tuple[str, ...]:
    """The shipped keyword files: the connective file, then the phrases by name."""
    folder = shipped("keywords")
    names = sorted(os.listdir(folder), key=lambda name: (name != "english.toml", name))
    return tuple(os.path.join(folder, name) for name in names if name.endswith(".toml"))
