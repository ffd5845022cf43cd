"""In which order components come up."""

from __future__ import annotations

from collections.abc import Collection, Mapping


def circle(needs: Mapping[str, Collection[str]]) -> list[str]:
    """Names that need each other in a circle, the first one again at the end; none where there is no circle."""
    done: set[str] = set()
    for start in needs:
        path: dict[str, None] = {}
        stack = [iter([start])]
        while stack:
            name = next(stack[-1], None)
            if name is None:
                stack.pop()
                if path:
                    done.add(path.popitem()[0])
            elif name in path:
                names = list(path)
                return [*names[names.index(name) :], name]
            elif name not in done:
                path[name] = None
                stack.append(iter(sorted(needs.get(name, ()))))
    return []


def levels(needs: Mapping[str, Collection[str]]) -> list[list[str]]:
    """Names in groups that come up one after the other: each needs only those of groups before it."""
    left, found = dict(needs), list[list[str]]()
    while left:
        ready = [name for name, wanted in left.items() if not any(each in left for each in wanted if each != name)]
        group = ready or list(left)  # a circle, which was reported before
        found.append(group)
        for name in group:
            del left[name]
    return found
