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


@cache
def shipped(*parts: str) -> str:
    """The path of a shipped file: inside an installed package, else beside the package in a checkout."""
    installed = os.path.join(PACKAGE, "_resources", *parts)
    return installed if os.path.exists(installed) else os.path.join(os.path.dirname(PACKAGE), *parts)


def shown_name(path: str) -> str:
    """What messages call a keyword file: `keywords/en/motion.toml` one that ships, any other by its path."""
    folder = shipped("keywords") + os.sep
    return "keywords/" + path[len(folder) :].replace(os.sep, "/") if path.startswith(folder) else path


ENGLISH = "en"
"""The language of missions where none is named. Its entries say what each word does, in any language."""
_JOINING = "language.toml"  # what makes a folder a language


@cache
def languages() -> tuple[str, ...]:
    """The names of the languages that ship."""
    names = sorted(os.listdir(shipped("keywords")))
    return tuple(name for name in names if os.path.isfile(shipped("keywords", name, _JOINING)))


def language_folder(language: str) -> str | None:
    """The folder of a language that ships, or the path of another one; None where it is no language."""
    folder = shipped("keywords", language) if language in languages() else language
    return folder if folder and os.path.isfile(os.path.join(folder, _JOINING)) else None


def keyword_files(folder: str) -> tuple[str, ...]:
    """The keyword files in the folder of a language: the joining words, then the phrases by name."""
    names = sorted(os.listdir(folder), key=lambda name: (name != _JOINING, name))
    beginning = os.path.join(folder, "")
    return tuple(beginning + name for name in names if name.endswith(".toml"))
