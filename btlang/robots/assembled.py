"""A robot made of parts, wherever it runs: what the simulated robot and a ROS 2 robot have in common."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from btlang.robots.bodies.body import Body
from btlang.robots.command_gate import Latch
from btlang.robots.geometry import Point, Pose
from btlang.robots.motion.gesturing import Gestures, TurnableJoints
from btlang.robots.motion.guard.guard import Guarded
from btlang.robots.robot import CompletedOperation, OnEvent, Operation, RobotError
from btlang.robots.worlds.descriptions import Choices
from btlang.robots.worlds.knowledge import Knowledge

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.parts import BatteryPart, VoicePart
    from btlang.robots.worlds.world import World
    from btlang.robots.zones import Zones
    from btlang.run.robot_state import Whereabouts
    from btlang.speech.engine import Utterance

STOPPED = "the robot was stopped"


class AssembledRobot(Guarded):
    """A robot made of parts. A subclass sets them, and implements the rest of `btlang.robots.robot.Robot`."""

    power: BatteryPart
    _gestures: Gestures
    _joints: TurnableJoints
    _voice: VoicePart
    _known: Knowledge

    def __init__(self, body: Body, on_event: OnEvent | None) -> None:
        self.body = body
        self.radius = body.radius
        self.normal_speed, self.max_speed = body.driving.speed, body.driving.top_speed
        self.normal_turn = body.turning.speed
        self.on_event = on_event
        self.on_step: Callable[[float], object] | None = None
        """Called at the end of each step with its seconds."""
        self.time = 0.0
        self.stops = 0
        self._choices = Choices()
        self._latch = Latch()
        self._last_said = ""

    def stop(self) -> None:
        """Stop everything at once; from any thread."""
        raise NotImplementedError

    def disable(self) -> None:
        """Stop, and take no command until `enable`; from any thread."""
        self._latch.shut()
        self.stop()

    @property
    def refuses(self) -> bool:
        """Whether it takes no commands, because it was stopped."""
        return self._latch.refuses

    @property
    def pose(self) -> Pose:
        """The pose on the map. Raises RobotError if it isn't known."""
        raise NotImplementedError

    @property
    def set_out_from(self) -> Pose:
        """The pose at the start of the run. Raises RobotError if it isn't known."""
        raise NotImplementedError

    @property
    def world(self) -> World:
        """The world as far as the robot knows it."""
        return self._known.world

    @property
    def zones(self) -> Zones:
        """The zones of the world, as the mission has closed and opened them."""
        return self._known.zones

    @property
    def things(self) -> tuple[Whereabouts, ...]:
        """Where walking people and unknown things are, for observers."""
        return self._known.whereabouts()

    def place_names(self) -> list[str]:
        """Return the names of all places, including those of the mission."""
        return list(self._known.names.places)

    def seen(self, kind: str) -> list[str]:
        """Return the objects or people in view, nearest first. Raises RobotError if nothing reports them."""
        raise NotImplementedError

    def take_picture(self) -> Operation:
        """Take a picture; its event names what is in view. Raises RobotError if nothing reports it."""
        self._emit("picture", name=", ".join((*self.seen("person"), *self.seen("object"))))
        return CompletedOperation()

    def locate(self, name: str) -> Point:
        """Return where a place, object or person is. Raises RobotError for an unknown or unseen one."""
        return self._known.locate(name, self.pose)

    def choose(self, kind: str, how: str, parts: Mapping[str, str] = {}) -> str:
        """Return a name that is the "nearest", "random" and so on. Raises RobotError if there is none."""
        return self._known.choose(
            kind, how, parts, lambda: self.pose, lambda: self.set_out_from, self._choices, self.on_event
        )

    def described(self, kind: str, parts: Mapping[str, str]) -> list[str]:
        """Return the known objects or people with these parts, nearest first."""
        return self._known.described(kind, parts, self.pose)

    def nearby_people(self, within: float) -> list[str]:
        """Return the names of people within so many metres, nearest first: of those who walk, the ones in view."""
        return self._known.nearby_people(within, self.pose)

    def beside_door(self, name: str) -> list[Pose]:
        """Return where it can stand to move a door, nearest first. Raises RobotError for an unknown door."""
        return self._known.beside_door(name, self.pose)

    @property
    def battery(self) -> float:
        """The percentage that is left. Raises RobotError if it isn't known."""
        return self.power.level

    @property
    def battery_empty(self) -> bool:
        """Whether the wheels have no power any more; False also if nothing reports it."""
        return self.power.empty

    @property
    def docked(self) -> bool:
        """Whether it is connected to the dock. Raises RobotError if it isn't known."""
        return self.power.docked

    @property
    def charging(self) -> bool:
        """Whether the battery is being charged. Raises RobotError if it isn't known."""
        return self.power.charging

    def joint(self, name: str) -> float:
        """Return the degrees of a joint. Raises RobotError for an unknown joint, and if its angle isn't known."""
        return self._joints.angle(name)

    def move_joints(self, targets: Mapping[str, float]) -> None:
        """Move joints towards angles, clipped to their limits. Raises RobotError as `joint` does."""
        if not self._latch.refuses:
            self._joints.move(targets)
            if self._latch.refuses:
                self._joints.freeze()  # `stop` came in between from another thread
            self._emit("joint", targets=dict(targets))

    def joints_at_target(self, *names: str) -> bool:
        """Return whether none of these joints is on its way. Raises RobotError if one is stuck or silent."""
        return self._joints.at_target(names)

    def freeze_joints(self, *names: str) -> None:
        """Hold these joints where they are."""
        self._joints.freeze(names)

    def gesture(self, name: str, *, aim: Point | None = None, stroke_at: float | None = None) -> Operation:
        """Implement Gesturing. Raises RobotError."""
        self._check_stop()
        room = None if stroke_at is None else stroke_at - self.time
        started, slower = self._gestures.start(name, lambda: self.pose, aim, room)
        if self._latch.refuses:
            self._joints.freeze()  # `stop` came in between from another thread
        self._emit("gesture", name=name, slower=round(slower, 2))
        return started

    def lead(self, name: str, aim: Point | None = None) -> float:
        """Implement Gesturing. Raises RobotError."""
        return self._gestures.lead(name, lambda: self.pose, aim)

    def call(self, text: str) -> None:
        """Call people for help, by an event."""
        self._emit("call", text=text)

    def say(self, text: str, after: float = 0.0) -> None:
        """Start to speak after so many seconds. Raises RobotError if it can't."""
        if not self._latch.refuses:
            self._voice.say(text, after)
            self._last_said = text
            self._emit("say", text=text)

    def speak_in(self, language: str) -> None:
        """Speak in a language until the end of the run. Raises RobotError if it can't."""
        if language != self._voice.language:
            self._voice.speak_in(language)
            self._emit("language", name=language)

    def utterance(self, text: str) -> Utterance:
        """Return the sound and the times of a text. Raises RobotError."""
        return self._voice.utterance(text)

    def print(self, text: str) -> None:
        """Show a text at once. Raises RobotError if it can't."""
        self._voice.print(text)
        self._emit("print", text=text)

    @property
    def language(self) -> str:
        """The language in which it speaks; "" without a voice."""
        return self._voice.language

    @property
    def said(self) -> Utterance | None:
        """The current or the last utterance."""
        return self._voice.said

    @property
    def said_at(self) -> float:
        """The second of `time` at which that utterance begins, as far as it's known."""
        return self.time - self._voice.position

    @property
    def speaking(self) -> bool:
        """Whether it speaks. Raises RobotError if that doesn't come to an end."""
        return self._voice.speaking

    def silence(self) -> None:
        """End speech at once."""
        self._voice.silence()

    def _check_stop(self) -> None:
        if self._latch.refuses:
            raise RobotError(STOPPED)

    def _emit(self, event: str, **data: Any) -> None:
        if self.on_event is not None:
            self.on_event(event, data)
