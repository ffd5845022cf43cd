"""The surroundings of a simulated robot as far as it knows them, and the people who live there."""

from __future__ import annotations

from collections.abc import Callable

from btlang.robots.bodies.body import Body
from btlang.robots.ears import Ears
from btlang.robots.geometry import Pose, segment_distance
from btlang.robots.robot import RobotError
from btlang.robots.simulation.people import People
from btlang.robots.worlds.knowledge import Knowledge
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.sight import Sight, View
from btlang.robots.worlds.world import World, WorldObject, said
from btlang.run.robot_state import Whereabouts
from btlang.speech.listener import Attention
from btlang.speech.recogniser import Grammar, RecognisedSpeech

_REACH = 1.2  # metres to a door or a switch
_HAND = 1.5  # metres to somebody who takes something
_SAME_SPOT = 0.01  # metres


class Surroundings(Knowledge):
    """The surroundings in a simulated world. The robot knows the part that it has seen.

    `joint` returns the angle of a joint of the robot; `emit` gets the events "come", "leave", "hear" and "see".
    """

    def __init__(
        self,
        world: World,
        obstacles: Obstacles,
        body: Body,
        joint: Callable[[str], float],
        emit: Callable[..., object],
    ) -> None:
        view = View(obstacles, body, joint)
        sight = Sight(world, obstacles, view.point, lambda name: emit("see", name=name), view.covers)
        super().__init__(world, obstacles, sight)
        self._emit = emit
        self._radius = body.radius
        self._switched: dict[str, bool] = {}
        self._hears = body.ears.within if body.ears is not None else 0.0
        self._now, self._pose = 0.0, world.start
        self.ears = Ears()
        self._attention: Attention | None = None
        if body.ears is not None and body.ears.engine:
            self._attention = Attention(body.ears.wake, body.ears.settings.push)
        self.people = People(world, obstacles, body.radius, self._happen)
        self.sight.look(0.0, world.start)

    def begin(self, seed: int) -> None:
        """Begin a run: zones are as in the world, and random events follow from the seed."""
        self.zones.begin()
        self.people.begin(seed)
        self.ears.begin()

    def step(self, now: float, dt: float, pose: Pose, velocity: float) -> None:
        """Let people live on for `dt` seconds until `now`, and the robot look around."""
        self._now, self._pose = now, pose
        self.people.step(now, dt, pose, velocity)
        self.sight.look(now, pose)

    def goal_at(self, pose: Pose) -> tuple[str, Pose | None]:
        """Return the name of a way to a pose, and its end: None on the spot of an object or a person, as its target.

        On the spot of a place the way has the name of the place, so that a blocked way is known.
        """
        for place in self.world.places:
            if pose.distance_to((place.x, place.y)) <= _SAME_SPOT:
                return place.name, pose
        for name in self.obstacles.things:
            point = self.sight.where(name)
            if point is not None and pose.distance_to(point) <= _SAME_SPOT:
                return name, None
        return f"({pose.x:.2f}, {pose.y:.2f})", pose

    def move(self, name: str, x: float, y: float) -> None:
        """Put an object or a person somewhere else."""
        known = self.known(name)
        if known not in self.obstacles.things or self.obstacles.is_carried(known):
            raise RobotError(f"{said(known)} can't be moved")
        if self.people.walks(known):
            self.people.put(known, x, y)
        else:
            self.obstacles.move(known, x, y)

    def check_taker(self, object: str, person: str, pose: Pose) -> None:
        """Raise RobotError if a person is too far away to take an object, or doesn't want it."""
        known = self.known(person)
        point = self.obstacles.point(known)
        if not self.is_person(known) or point is None:
            raise RobotError(f"{said(known)} isn't here")
        if (distance := pose.distance_to(point)) > _HAND:
            raise RobotError(f"{said(known)} is {distance:.1f} m away")
        if object.lower() in map(str.lower, self.people.refused_by(known)):
            raise RobotError(f"{said(known)} doesn't want {said(object)}")

    def move_door(self, name: str, is_open: bool, pose: Pose) -> None:
        """Open or close a door. Raises RobotError if it is out of reach, or something is in it."""
        door = self.door(name)
        if (distance := pose.distance_to(door.middle)) > _REACH:
            raise RobotError(f"{said(door.name)} is {distance:.1f} m away")
        bodies = [(pose.x, pose.y, self._radius), *self.obstacles.discs, *self.obstacles.walking.values()]
        if not is_open and any(segment_distance((x, y), (*door.start, *door.end)) < r for x, y, r in bodies):
            raise RobotError(f"something is in {said(door.name)}")
        if door.open != is_open:
            self.swing(name, is_open)

    def swing(self, name: str, is_open: bool) -> None:
        """Open or close a door in the world. Raises RobotError for an unknown one."""
        door = self.door(name)
        self.obstacles.swing(door.name, is_open)
        self._emit("door", name=door.name, open=is_open)

    def is_open(self, name: str) -> bool:
        """Return whether a door is open. Raises RobotError for an unknown one."""
        return self.door(name).open

    def switch(self, name: str, on: bool | None, pose: Pose) -> None:
        """Switch an object on or off. Raises RobotError if it can't be switched, or is out of reach."""
        known = self.known(name)
        point = self.where(known)
        before = self.is_on(known)
        if point is not None and pose.distance_to(point) > _REACH:
            raise RobotError(f"{said(known)} is {pose.distance_to(point):.1f} m away")
        self._switched[known] = (not before) if on is None else on
        self._emit("switch", name=known, on=self._switched[known])

    def is_on(self, name: str) -> bool:
        """Return whether an object is switched on. Raises RobotError for one that can't be switched."""
        known = self.known(name)
        thing = self.obstacles.things.get(known)
        if not isinstance(thing, WorldObject) or not thing.switch:
            raise RobotError(f"{said(known)} can't be switched on or off")
        return self._switched.get(known, thing.switch == "on")

    def whereabouts(self) -> tuple[Whereabouts, ...]:
        """Return where walking people and unknown things really are, to the centimetre, and whether the robot sees
        them.
        """
        return self._watched(self.obstacles.point, self.sight.is_seen)

    def hear(self, text: str, who: str = "") -> None:
        """Let the robot hear what somebody says or types."""
        self.ears.hear(text, who, self._now)
        self._emit("hear", text=text, who=who)

    def ask(self, question: str, person: str = "") -> None:
        """Ask a person, or anybody; people of the world may answer."""
        self.people.ask(question, person, (self._pose.x, self._pose.y), self._now)

    def _listen(self, text: str, who: str) -> None:
        """Understand only what is listened for, as with a microphone, if the robot has a recogniser."""
        if self._attention is None:
            self.hear(text, who)
            return
        expected = self._attention.expected(self.ears.expected(self._now), bool(self.ears.asking), self._now)
        if expected.anything or Grammar(expected).holds(text):
            meant = self._attention.meant(RecognisedSpeech(text), self._now)
            if meant is not None:
                self.hear(meant.text, who)

    def _happen(self, kind: str, name: str, text: str) -> None:
        if kind == "speak":
            point = self.obstacles.point(name)
            if point is not None and self._pose.distance_to(point) <= self._hears:
                self._listen(text, name)
            return
        if kind in ("come", "walk"):
            self.sight.watch(name, "person")
        if kind != "walk":
            self._emit(kind, name=name)
