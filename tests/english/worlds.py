"""Worlds for the sentences of users: from the nouns of a domain to a world file, on a grid."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent
_STEP = 4.0


@cache
def _domains() -> dict[str, Any]:
    domains: dict[str, Any] = tomllib.loads((FOLDER / "worlds.toml").read_text(encoding="utf-8"))["domain"]
    return domains


def _like(things: dict[str, Any], name: str) -> str:
    """The lines of a thing that say what it is like."""
    thing = things.get(name, {})
    said = {key: f'"{thing[key]}"' for key in ("color", "size", "owner") if key in thing}
    said |= {"state": f'["{thing["state"]}"]'} if "state" in thing else {}
    return "".join(f"\n{key} = {text}" for key, text in said.items())


@cache
def world_of(domain: str) -> str:
    """The text of a world file with all nouns of a domain."""
    nouns = _domains()[domain]
    kinds = {name: kind for kind, names in nouns.get("kinds", {}).items() for name in names}
    things = {thing["name"]: thing for thing in nouns.get("things", ())}
    places, people, doors = ([*dict.fromkeys(nouns.get(sort, ()))] for sort in ("places", "people", "doors"))
    taken = {*places, *people, *doors}
    named = [*nouns.get("objects", ()), *nouns.get("switches", ()), *(name for name in things if name not in taken)]
    objects = [name for name in dict.fromkeys(named) if name not in taken]
    at = {name: (2 + _STEP * (number % 8), 2 + _STEP * (number // 8)) for number, name in enumerate(places)}
    lines = ["start = { x = 1, y = 1 }"]
    for name in places:
        kind = f'\nkind = "{kinds[name]}"' if name in kinds else ""
        lines.append(f'[[places]]\nname = "{name}"\nx = {at[name][0]}\ny = {at[name][1]}{kind}{_like(things, name)}')
    for number, name in enumerate(objects):
        thing = things.get(name, {})
        x, y = at.get(thing.get("in", thing.get("on", "")), (2 + number % 30, 40 + number // 30))
        kind = thing.get("kind", kinds.get(name, ""))
        more = (f'\nkind = "{kind}"' if kind else "") + _like(things, name)
        switch = '\nswitch = "off"' if name in nouns.get("switches", ()) else ""
        spot = f"x = {x + 0.6 + 0.01 * (number % 20):.2f}\ny = {y + 0.6:.2f}"
        lines.append(f'[[objects]]\nname = "{name}"\n{spot}{more}{switch}')
    for number, name in enumerate(people):
        kind = f'\nkind = "{kinds[name]}"' if name in kinds else ""
        lines.append(f'[[people]]\nname = "{name}"\nx = {1 + number}\ny = 60{kind}')
    for number, name in enumerate(doors):
        lines.append(f'[[doors]]\nname = "{name}"\nfrom = [{number}, 70]\nto = [{number}, 71]')
    for name in dict.fromkeys([*nouns.get("zones", ()), *places]):
        x, y = at.get(name, (40, 40))
        corners = f"[[{x - 1}, {y - 1}], [{x + 1}, {y - 1}], [{x + 1}, {y + 1}], [{x - 1}, {y + 1}]]"
        if name not in {*people, *doors, *objects}:
            lines.append(f'[[zones]]\nname = "{name}"\nkind = "area"\npoints = {corners}')
    return "\n".join(lines)
