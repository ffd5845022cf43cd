"""Where the links of a body are, for many configurations at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from btlang.robots.body import Body, Joint, Vector
from btlang.support.record import Record

Array = npt.NDArray[np.float64]


class Frames(Record):
    """Of one link in n configurations, in the frame of the base: `turned[:, :, k]` are rotation matrices, and
    `origin[:, k]` its origins.
    """

    turned: Array
    origin: Array

    def place(self, point: Vector) -> Array:
        """A point of the link, three rows of n."""
        placed: Array = np.matmul(np.array(point, dtype=np.float64), self.turned) + self.origin
        return placed


class Kinematics:
    """Of a body; a configuration has the positions of its joints in their order, in their units."""

    def __init__(self, body: Body) -> None:
        self._joints: list[tuple[int, Joint, Array, Array]] = []
        by_link = {joint.link: (index, joint) for index, joint in enumerate(body.joints) if joint.link}
        for index, joint in _parents_first(by_link):
            x, y, z = joint.axis
            cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            self._joints.append((index, joint, cross.T, (cross @ cross).T))

    def frames(self, configurations: Array) -> Mapping[str, Frames]:
        """The links by name, the base as "", for an array of n times all joints."""
        n = len(configurations)
        found = {"": Frames(np.repeat(np.eye(3)[:, :, None], n, axis=2), np.zeros((3, n)))}
        for index, joint, cross, squared in self._joints:
            parent, moved = found[joint.parent], configurations[:, index] * joint.si
            turned, origin = parent.turned, parent.place(joint.at)
            if joint.slides:
                origin = origin + np.matmul(np.array(joint.axis), turned) * moved
            else:
                turned = turned + np.sin(moved) * np.matmul(cross, turned)
                turned += (1.0 - np.cos(moved)) * np.matmul(squared, parent.turned)
            found[joint.link] = Frames(turned, origin)
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
