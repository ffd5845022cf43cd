"""Pinocchio with Coal, loaded with the URDF that is written of a body: another opinion on where its links are."""

from __future__ import annotations

from math import radians

import numpy as np
import pinocchio as pin

from btlang.robots.bodies.body import Body
from btlang.robots.bodies.urdf import ROOT_LINK, urdf
from btlang.robots.motion.kinematics import Array


class Pinocchio:
    """Of a body whose joints all turn."""

    def __init__(self, body: Body) -> None:
        text = urdf(body)
        self._model = pin.buildModelFromXML(text)
        self._data = self._model.createData()
        self._geometry = pin.buildGeomFromUrdfString(self._model, text, pin.GeometryType.COLLISION)
        self._order = [
            (index, self._model.joints[self._model.getJointId(joint.name.replace(" ", "_"))].idx_q)
            for index, joint in enumerate(body.joints)
        ]
        self.pairs: list[tuple[str, str]] = []
        shapes: dict[str, list[int]] = {}
        for index, shape in enumerate(self._geometry.geometryObjects):
            shapes.setdefault(self._model.frames[shape.parentFrame].name, []).append(index)
        for pair in body.forbidden:
            first, second = (shapes[link.replace(" ", "_") or ROOT_LINK] for link in pair)
            for one in first:
                for other in second:
                    self._geometry.addCollisionPair(pin.CollisionPair(one, other))
                    self.pairs.append(pair)
        self._shapes = self._geometry.createData()

    def origin(self, link: str, configuration: Array) -> tuple[Array, Array]:
        """How a link is turned, and where it is."""
        pin.framesForwardKinematics(self._model, self._data, self._turned(configuration))
        found = self._data.oMf[self._model.getFrameId(link.replace(" ", "_") or ROOT_LINK)]
        return found.rotation, found.translation

    def distances(self, configuration: Array) -> dict[tuple[str, str], float]:
        """Metres between the links of each forbidden pair."""
        pin.computeDistances(self._model, self._data, self._geometry, self._shapes, self._turned(configuration))
        found: dict[tuple[str, str], float] = {}
        for pair, result in zip(self.pairs, self._shapes.distanceResults, strict=True):
            found[pair] = min(found.get(pair, np.inf), result.min_distance)
        return found

    def collides(self, configuration: Array) -> bool:
        """Whether two links of a forbidden pair touch."""
        turned = self._turned(configuration)
        return bool(pin.computeCollisions(self._model, self._data, self._geometry, self._shapes, turned, True))

    def _turned(self, configuration: Array) -> Array:
        found = pin.neutral(self._model)
        for index, at in self._order:
            found[at] = radians(configuration[index])
        return np.asarray(found)
