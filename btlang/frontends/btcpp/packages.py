"""Packages of ROS 2: in which one a file is, and which others it can use, by their package.xml."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from functools import cache

from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source

_NAME = re.compile(r"<name>\s*([\w-]+)\s*</name>")
_DEPENDS = re.compile(r"<\w*depend\b[^>]*>\s*([\w-]+)\s*<")


@cache
def package_root(folder: str) -> str:
    """The folder of the ROS 2 package in which a folder is, "" if it is in none."""
    above = os.path.dirname(folder)
    if os.path.isfile(_manifest(folder)):
        return folder
    return package_root(above) if above != folder else ""


@cache
def package_of(folder: str) -> str:
    """The name of the ROS 2 package in which a folder is, "" if it is in none."""
    name = _NAME.search(_text(package_root(folder)))
    return name[1] if name is not None else ""


def roots_of(files: Iterable[str]) -> dict[str, str]:
    """The folders of the packages in which some files are, by their names."""
    return {package_of(root): root for root in {package_root(os.path.dirname(file)) for file in files} if root}


def are_related(file: str, other: str, roots: Mapping[str, str]) -> bool:
    """Whether a file can mean what another one defines: it is in the same package, in none, or in one on which its
    package depends, perhaps by way of those with other `roots`.
    """
    own, wanted = package_root(os.path.dirname(file)), package_root(os.path.dirname(other))
    if own == wanted or not own or not wanted:
        return True
    waiting, done = [own], {own}
    while waiting:
        for name in _DEPENDS.findall(_text(waiting.pop())):
            root = roots.get(name, "")
            if root and root not in done:
                done.add(root)
                waiting.append(root)
    return wanted in done


def _manifest(folder: str) -> str:
    return os.path.join(folder, "package.xml")


@cache
def _text(root: str) -> str:
    try:
        return read_source(_manifest(root)).text if root else ""
    except MissionError:
        return ""
