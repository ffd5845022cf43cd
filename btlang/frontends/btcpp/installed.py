"""Install lists of CMake: which `CMakeLists.txt` installs a file, as far as its lists are simple.

`install(FILES ...)` and `install(DIRECTORY ...)` are read; an entry with a variable or a generator expression installs
nothing that is known.
"""

from __future__ import annotations

import os
import re
from functools import cache

from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source

_COMMENT = re.compile(r"#[^\n]*")
_INSTALL = re.compile(r"\binstall\s*\(\s*(FILES|DIRECTORY)\s+([^()]*)\)", re.IGNORECASE)
_ENDS = frozenset((
    "TYPE", "DESTINATION", "PERMISSIONS", "FILE_PERMISSIONS", "DIRECTORY_PERMISSIONS", "USE_SOURCE_PERMISSIONS",
    "CONFIGURATIONS", "COMPONENT", "RENAME", "OPTIONAL", "MESSAGE_NEVER", "EXCLUDE_FROM_ALL", "FILES_MATCHING",
    "PATTERN", "REGEX",
))  # fmt: skip
"""Behind these words are no files."""
_HERE = re.compile(r"\$\{(?:CMAKE_CURRENT_SOURCE_DIR|CMAKE_CURRENT_LIST_DIR|PROJECT_SOURCE_DIR|CMAKE_SOURCE_DIR)\}/")


def install_list_of(file: str) -> str:
    """Return the path of the nearest CMakeLists.txt, in the folder of a file or above, that installs it, or ""."""
    folder = os.path.dirname(file)
    while True:
        if any(file == entry or file.startswith(entry + os.sep) for entry in _installed(folder)):
            return os.path.join(folder, "CMakeLists.txt")
        above = os.path.dirname(folder)
        if above == folder:
            return ""
        folder = above


@cache
def _installed(folder: str) -> tuple[str, ...]:
    """Return the paths of files and folders that the CMakeLists.txt of a folder installs."""
    path = os.path.join(folder, "CMakeLists.txt")
    if not os.path.isfile(path):
        return ()
    try:
        text = _COMMENT.sub("", read_source(path).text)
    except MissionError:
        return ()
    found: list[str] = []
    for entries in _INSTALL.findall(text):
        for entry in entries[1].split():
            if entry in _ENDS:
                break
            entry = _HERE.sub("", entry.strip('"'), count=1)
            if "$" not in entry and "*" not in entry:
                found.append(os.path.normpath(os.path.join(folder, entry)))
    return tuple(found)
