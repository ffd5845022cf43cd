"""Where the data files of the product lie: keyword files, grammars, worlds."""

from __future__ import annotations

import os

_PACKAGE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def shipped(*parts: str) -> str:
    """The path of a shipped file: inside an installed package, else beside the package in a checkout."""
    installed = os.path.join(_PACKAGE, "_resources", *parts)
    return installed if os.path.exists(installed) else os.path.join(os.path.dirname(_PACKAGE), *parts)


def keyword_files() -> list[str]:
    """The shipped keyword files, by name, without the connective file."""
    folder = shipped("keywords")
    return [os.path.join(folder, n) for n in sorted(os.listdir(folder)) if n.endswith(".toml") and n != "english.toml"]
