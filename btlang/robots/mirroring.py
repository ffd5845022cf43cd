"""Gestures with left and right swapped."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from btlang.robots.body import Joint
from btlang.robots.gesture import BEARING, BEARINGS, OPPOSITE, Gesture, Step

_SIDES = {"left": "right", "right": "left"}


def swapped(words: str) -> str:
    """A text with "right" for "left", and the other way round."""
    return re.sub(r"\b(left|right)\b", lambda match: _SIDES[match[1]], words)


def mirrored(gesture: Gesture, joints: Sequence[Joint]) -> Gesture:
    """As a mirror shows it. Raises ValueError for a joint without another side."""
    known = {joint.name: joint for joint in joints}
    frames = tuple(frame.replace(joints=_step(frame.joints, known)) for frame in gesture.frames)
    made: Gesture = gesture.replace(
        name=swapped(gesture.name), frames=frames, phrases=tuple(map(swapped, gesture.phrases)),
        help=swapped(gesture.help), aim=swapped(gesture.aim),
    )  # fmt: skip
    return made


def _step(step: Step, known: Mapping[str, Joint]) -> Step:
    found: dict[str, float | str] = {}
    for name, value in step.items():
        sense, other = _sense(known[name], known), known[swapped(name)]
        if value in BEARINGS:  # what it is turned to stays where it is
            found[other.name] = value if sense < 0 else BEARING if value == OPPOSITE else OPPOSITE
        else:
            angle = sense * float(value)
            if not other.low <= angle <= other.high:
                raise ValueError(
                    f'the other side can\'t do this: "{other.name}" goes from {other.low:g} to {other.high:g}'
                )
            found[other.name] = angle
    return found


def _sense(joint: Joint, known: Mapping[str, Joint]) -> float:
    """1 where the mirror image of a movement has the same sign, else -1."""
    other = known.get(swapped(joint.name))
    if other is None:
        raise ValueError(f'there is no joint "{swapped(joint.name)}" to mirror "{joint.name}"')
    if not (joint.link and other.link):
        if other is joint:
            raise ValueError(f'"{joint.name}" can\'t be mirrored, because it has no axis')
        return 1.0
    (x, y, z), axis = joint.axis, other.axis
    image = (x, -y, z) if joint.slides else (-x, y, -z)
    return 1.0 if sum(one * another for one, another in zip(image, axis, strict=True)) > 0.0 else -1.0
