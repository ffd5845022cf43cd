"""Which definition of an ID a file means if several files define it: its own, an included one, then the nearest one.

A repository holds many programs. The files that are joined by includes are one program, and a project of Groot2
(.btproj) is a file that includes others. Where no include says what belongs together, the install lists of CMake and
then the folders do.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cache

from btlang.frontends.btcpp.installed import install_list_of


class Scopes:
    """Made from the files that each file includes. All files are real paths."""

    def __init__(self, includes: Mapping[str, Sequence[str]]) -> None:
        self._includes = includes
        self._reached: dict[str, dict[str, int]] = {}
        self._programs: dict[str, set[str]] = {}

    def nearest(self, user: str, defining: Iterable[str]) -> list[str]:
        """The files that are nearest to one, in their order: several where nothing decides between them."""
        distances = {file: self._distance(user, file) for file in defining}
        least = min(distances.values(), default=(0, 0))
        return [file for file, distance in distances.items() if distance == least]

    @property
    def programs(self) -> list[Collection[str]]:
        """The files of each program, a file with all that it includes, if these are several."""
        return [self._reached_from(file) for file, included in self._includes.items() if included]

    def is_start(self, file: str) -> bool:
        """Return whether a file includes others, and isn't included."""
        return bool(self._includes.get(file)) and len(self._programs_with(file)) == 1

    def is_joined(self, file: str) -> bool:
        """Whether a file includes another one, or is included."""
        return bool(self._includes.get(file)) or len(self._programs_with(file)) > 1

    def are_apart(self, file: str, other: str) -> bool:
        """Whether no program has both files."""
        return self._programs_with(file).isdisjoint(self._programs_with(other))

    def _distance(self, user: str, file: str) -> tuple[int, int]:
        hops = self._reached_from(user).get(file)
        if hops is not None:
            return 0, hops
        if not self.are_apart(user, file):
            return 1, 0
        steps = _steps(os.path.dirname(user), os.path.dirname(file))
        installs = install_list_of(user)
        return (1, 1 + steps) if installs and install_list_of(file) == installs else (2, steps)

    def _reached_from(self, user: str) -> dict[str, int]:
        """The file itself and all that it includes, with the number of includes on the way."""
        if user not in self._reached:
            found = {user: 0}
            for file in (waiting := [user]):
                for included in self._includes.get(file, ()):
                    if included not in found:
                        found[included] = found[file] + 1
                        waiting.append(included)
            self._reached[user] = found
        return self._reached[user]

    def _programs_with(self, file: str) -> set[str]:
        """The files whose programs contain one: all that include it, and itself."""
        if not self._programs:
            for each in self._includes:
                for reached in self._reached_from(each):
                    self._programs.setdefault(reached, set()).add(each)
        return self._programs.get(file, {file})


@cache
def _steps(start: str, end: str) -> int:
    """How many folders one goes up and down between two folders."""
    parts, others = start.split(os.sep), end.split(os.sep)
    apart = (at for at, (part, other) in enumerate(zip(parts, others, strict=False)) if part != other)
    shared = next(apart, min(len(parts), len(others)))
    return len(parts) + len(others) - 2 * shared
