"""Where the links of a body are, for many configurations at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from btlang.record import Record
from btlang.robots.body import Body, Joint, Vector

Array = npt.NDArray[np.float64]


class Frames(Record):
    """Of one link in n configurations: n rotation matrices, and its origin n times, in the frame of the base."""

    turned: Array
    origin: Array

    def place(self, point: Vector | Array) -> Array:
        """A point of the link, n times."""
        placed: Array = self.turned @ np.asarray(point, dtype=np.float64) + self.origin
        return placed


class Kinematics:
    """Of a body; a configuration has the positions of its joints in their order, in their units."""

    def __init__(self, body: Body) -> None:
        self._joints: list[tuple[int, Joint, Array, Array]] = []
        by_link = {joint.link: (index, joint) for index, joint in enumerate(body.joints) if joint.link}
        for index, joint in _parents_first(by_link):
            x, y, z = joint.axis
            cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            self._joints.append((index, joint, cross, cross @ cross))

    def frames(self, configurations: Array) -> Mapping[str, Frames]:
        """The links by name, the base as "", for an array of n times all joints."""
        n = len(configurations)
        found = {"": Frames(np.broadcast_to(np.eye(3), (n, 3, 3)), np.zeros((n, 3)))}
        for index, joint, cross, squared in self._joints:
            parent, moved = found[joint.parent], configurations[:, index] * joint.si
            origin = parent.place(joint.at)
            if joint.slides:
                origin = origin + (parent.turned @ np.array(joint.axis)) * moved[:, None]
                found[joint.link] = Frames(parent.turned, origin)
                continue
            sine, rest = np.sin(moved)[:, None, None], (1.0 - np.cos(moved))[:, None, None]
            found[joint.link] = Frames(parent.turned @ (np.eye(3) + sine * cross + rest * squared), origin)
        return found


def _parents_first(by_link: Mapping[str, tuple[int, Joint]]) -> Sequence[tuple[int, Joint]]:
    ordered: dict[str, tuple[int, Joint]] = {}
    for link in by_link:
        chain = []
        while link and link not in ordered and link not in chain:
            chain.append(link)
            link = by_link[link][1].parent
        ordered.update((each, by_link[each]) for each in reversed(chain))
    return list(ordered.values())
