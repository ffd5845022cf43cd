"""The summary of a world in a few lines."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.robots.worlds.world import SLOW, Person, World, WorldObject, Zone
from btlang.text.formatting import one_line


def summarize(world: World) -> Iterator[str]:
    """Yield a line for the size and the start of a world, and one for each kind of things with their names."""
    points = [point for wall in world.walls for point in wall]
    points += [edge[:2] for box in world.boxes for edge in box.edges()]
    if points:
        xs, ys = zip(*points, strict=True)
        yield f"size: {max(xs) - min(xs):g} m x {max(ys) - min(ys):g} m"
    yield f"start: ({world.start.x:g}, {world.start.y:g}), facing {world.start.heading:g}"
    groups = {
        "places": [place.name for place in world.places],
        "objects": [_object(thing) for thing in world.objects],
        "people": [_person(person) for person in world.people],
        "zones": [_zone(zone) for zone in world.zones],
        "doors": [f"{door.name} ({'open' if door.open else 'closed'})" for door in world.doors],
        "lanes": [f"{len(world.lanes):,}"] if world.lanes else [],
        "faults": [fault.kind for fault in world.faults],
    }
    yield from (f"{kind}: {one_line(', '.join(listed))}" for kind, listed in groups.items() if listed)
    if world.seed is not None:
        yield f"seed: {world.seed}"


def _with(name: str, *more: str) -> str:
    details = ", ".join(each for each in more if each)
    return f"{name} ({details})" if details else name


def _object(thing: WorldObject) -> str:
    switch, owner = thing.switch and f"is {thing.switch}", thing.owner and f"owner {thing.owner}"
    like = (thing.sized, *thing.state, thing.color, thing.kind)
    holds, has = thing.content and f"of {thing.content}", (f"with {each}" for each in thing.having)
    return _with(thing.name, *like, holds, *has, owner, switch, _unknown(thing.known))


def _person(person: Person) -> str:
    comes = f"comes at {person.comes:g} s" if person.comes else ""
    walks = "walks anywhere" if person.wanders else f"walks to {len(person.walks)} stops" if person.walks else ""
    return _with(person.name, comes, walks, _unknown(person.known))


def _unknown(known: bool) -> str:
    return "" if known else "not known"


def _zone(zone: Zone) -> str:
    limit = f", {zone.speed:g} m/s" if zone.kind == SLOW else ""
    return _with(zone.name, f"{zone.kind}{limit}")
