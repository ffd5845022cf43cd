"""People who live in a world: they come, walk, keep clear of each other and of the robot, answer, and leave.

How they keep clear follows what pedestrians do (Helbing and Molnar, Social force model for pedestrian dynamics, 1995),
cut down to a few directions: who can't go on evades to the right first, then waits, then steps back to let others pass.
Waiting times are by chance, so that two who meet don't mirror each other for ever.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, dist, hypot, inf, radians, sin
from random import Random

from btlang.robots.geometry import Point, Pose
from btlang.robots.robot import RobotError
from btlang.robots.simulation.walker import PERIOD, OtherBody, Walker
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.world import NEVER, Person, World
from btlang.text.time_of_day import DAY

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.worlds.planning import Walkways

_ARRIVES = 0.3  # metres that a guest needs
_HEARD = 8.0  # metres from which a question is understood
_WIDEST = 0.3  # metres of radius that ways leave room for
_ASKS_WITHIN, _ASKS_EVERY = 2.5, 90.0  # metres from the robot, and seconds there on average
_GUEST = "visitor"
_DOORS = ("entrance", "door")


class People:
    """The people of a world. The same seed gives the same people.

    `report(kind, name, text)` gets who comes ("come"), begins to walk ("walk") and leaves ("leave"), and what somebody
    says ("speak").
    """

    def __init__(
        self, world: World, obstacles: Obstacles, radius: float, report: Callable[[str, str, str], object]
    ) -> None:
        self._world, self._obstacles, self._radius, self._report = world, obstacles, radius, report
        self._ways: Walkways | None = None
        self._people = {person.name: person for person in world.people}
        self._places = [(place.x, place.y) for place in world.places]
        self._walkers = {person.name: Walker(person, self._places) for person in world.people if person.moves}
        self._speeches = sorted(
            ((said.at, person.name, said.text) for person in world.people for said in person.says), reverse=True
        )
        self._bodies: dict[str, OtherBody] = {}
        self._answers: list[tuple[float, str, str]] = []
        self._said: dict[str, str] = {}
        self._invited = 0
        self._visits: dict[str, tuple[float, float]] = {}
        self._been: dict[str, int] = {}  # the day of the last visit
        self._robot: Point = (world.start.x, world.start.y)
        self.begin(world.seed or 0)
        if self._walkers:
            self._arrive(0.0, OtherBody(world.start.x, world.start.y, 0.0, 0.0, radius))
            self._show()

    def begin(self, seed: int) -> None:
        """Begin a run: random events follow from its seed. Planned visits stay as they are."""
        self._seed = seed
        self._random = Random(f"{seed} people")
        self._next = 0.0

    def step(self, now: float, dt: float, pose: Pose, velocity: float) -> None:
        """Let `dt` seconds pass until `now`, while the robot drives at `velocity` metres a second."""
        if self._speeches or self._answers:
            self._speak(now)
        self._robot = pose.x, pose.y
        if not self._walkers:
            return
        heading = radians(pose.heading)
        robot = OtherBody(pose.x, pose.y, velocity * cos(heading), velocity * sin(heading), self._radius)
        if now + 1e-9 >= self._next:
            self._next = now + PERIOD
            self._arrive(now, robot)
            self._look(now, robot)
        moving = [walker for walker in self._walkers.values() if walker.vx or walker.vy]
        for walker in moving:
            others = (body for name, body in self._bodies.items() if name != walker.person.name)
            walker.move(dt, (robot, *others) if walker.near_someone else ())
        if moving:
            self._show()

    def walks(self, name: str) -> bool:
        """Return whether somebody walks, or ever did."""
        return name in self._walkers

    def put(self, name: str, x: float, y: float) -> None:
        """Put somebody who walks somewhere else; somebody who isn't there comes. Raises KeyError."""
        walker = self._walkers[name]
        walker.put(x, y)
        self._enter(walker)
        self._show()

    def come(self, name: str) -> None:
        """Let somebody come now. Raises RobotError if they are there, or aren't of this world."""
        walker = self._known(name)
        if walker.present:
            raise RobotError(f"{name} is there already")
        self._enter(walker)
        self._show()

    def leave(self, name: str) -> None:
        """Let somebody walk back to where they came from, and leave. Raises RobotError."""
        self._known(name).leave()

    def walk(self, name: str, goal: Point) -> None:
        """Let somebody walk to a point, and stay there. Raises RobotError."""
        walker = self._known(name)
        self._enter(walker)
        walker.go(goal)

    def follow(self, name: str, follows: bool) -> None:
        """Let somebody follow the robot from now on, or stay where they are. Raises RobotError."""
        walker = self._known(name)
        walker.follows = follows

    def refused_by(self, name: str) -> tuple[str, ...]:
        """Return what somebody doesn't take."""
        return self._people[name].refuses if name in self._people else ()

    def invite(self) -> str:
        """Let the next expected person come at once, or else a guest whom the world doesn't name; return the name."""
        for name, walker in self._walkers.items():
            if not walker.present and not walker.gone:
                self._enter(walker)
                self._show()
                return name
        self._invited += 1
        name = f"{_GUEST} {self._invited}"
        doors = [place for place in self._world.places if place.name.lower() in _DOORS]
        spots = [(place.x, place.y) for place in (*doors, *self._world.places)]
        room = (spot for spot in spots if self._obstacles.nearest(*spot)[0] > _ARRIVES)
        free = (spot for spot in room if dist(spot, self._robot) > 1.0)
        point = next(free, (self._world.start.x, self._world.start.y))
        self._people[name] = guest = Person(name, *point, 0.25, wanders=True)
        self._obstacles.add(guest)
        self._walkers[name] = walker = Walker(guest, self._places)
        self._enter(walker)
        self._show()
        return name

    def ask(self, question: str, person: str, point: Point, now: float) -> None:
        """Ask a person, or anybody for "", from the robot's point; they answer later, or not at all."""
        words = question.lower()
        if not words:
            return
        for name in [person] if person else sorted(self._people, key=lambda name: self._distance(name, point)):
            answers = self._people[name].answers if name in self._people else {}
            answer = next((answers[word] for word in answers if word in words), answers.get("*", ""))
            if name in self._said:
                answer = self._said.pop(name)
            if answer and self._understands(name, point):
                self._answers.append((now + self._people[name].answers_after, name, answer))
                return

    def answer(self, name: str, text: str) -> None:
        """Set what somebody answers to the next question, in place of the world's answer. Raises RobotError."""
        self._known_person(name)
        self._said[name] = text

    def say(self, name: str, text: str) -> None:
        """Let somebody say something now. Raises RobotError."""
        self._known_person(name)
        self._report("speak", name, text)

    def _distance(self, name: str, point: Point) -> float:
        at = self._obstacles.point(name)
        return inf if at is None else hypot(at[0] - point[0], at[1] - point[1])

    def _understands(self, name: str, point: Point) -> bool:
        """Return whether somebody understands what is said there: near enough, and in the same room."""
        at = self._obstacles.point(name)
        return at is not None and self._distance(name, point) <= _HEARD and not self._obstacles.wall_between(point, at)

    def _speak(self, now: float) -> None:
        while self._speeches and self._speeches[-1][0] <= now:
            _, name, text = self._speeches.pop()
            if self._obstacles.point(name) is not None:
                self._report("speak", name, text)
        due = [each for each in self._answers if each[0] <= now]
        self._answers = [each for each in self._answers if each[0] > now]
        for _, name, text in due:
            self._report("speak", name, text)

    def _arrive(self, now: float, robot: OtherBody) -> None:
        """Let people come at their time, as soon as there is room, and remove those who have left."""
        for name, walker in self._walkers.items():
            if not walker.present and not walker.gone and self._comes(walker, now) <= now:
                others = (robot, *(other.body for other in self._walkers.values() if other.present))
                x, y = walker.point
                if all(hypot(o.x - x, o.y - y) > o.radius + walker.radius for o in others):
                    self._enter(walker)
                    self._show()
            elif walker.present and self._leaves(walker) <= now and not walker.leaving:
                walker.leave()
            elif walker.present and walker.has_left:
                walker.present, walker.gone = False, True
                self._report("leave", name, "")
                if walker.person.visits is not None:
                    self._visits.pop(name, None)
                    self._been[name] = int((now + self._world.clock) // DAY)
                    self._walkers[name] = Walker(walker.person, self._places)
                self._show()
            elif walker.present and walker.person.asks and not walker.leaving:
                self._wonder(walker, robot)

    def _comes(self, walker: Walker, now: float) -> float:
        """Return when somebody comes, in seconds of the run."""
        person = walker.person
        if person.visits is None:
            return person.comes
        if person.name not in self._visits:
            clock = self._world.clock
            after = now + clock
            if person.name in self._been:
                after = max(after, (self._been[person.name] + 1) * DAY)
            comes, leaves = person.visits.next(after, self._world.weekday, f"{self._seed} {person.name}")
            self._visits[person.name] = comes - clock, leaves - clock
        return self._visits[person.name][0]

    def _leaves(self, walker: Walker) -> float:
        """Return when somebody leaves, in seconds of the run; an invited guest stays as long as the planned visit
        lasts.
        """
        visits = walker.person.visits
        return walker.person.leaves if visits is None else self._visits.get(walker.person.name, (0.0, NEVER))[1]

    def _wonder(self, walker: Walker, robot: OtherBody) -> None:
        """Ask the robot something now and then."""
        name = walker.person.name
        near = hypot(robot.x - walker.x, robot.y - walker.y) < _ASKS_WITHIN
        if near and self._random.random() < PERIOD / _ASKS_EVERY and self._understands(name, (robot.x, robot.y)):
            self._report("speak", name, self._random.choice(walker.person.asks))

    def _enter(self, walker: Walker) -> None:
        if not walker.present:
            walker.present, walker.gone = True, False
            if walker.person.comes_later or walker.person.name not in self._world.names.people:
                self._report("come", walker.person.name, "")

    def _look(self, now: float, robot: OtherBody) -> None:
        if self._ways is None:
            from btlang.robots.worlds.planning import Walkways  # numpy, which takes longer to import than many missions

            self._ways = Walkways(self._world, self._obstacles, _WIDEST)
        self._bodies = {name: walker.body for name, walker in self._walkers.items() if walker.present}
        standing = [OtherBody(x, y, 0.0, 0.0, radius) for x, y, radius in self._obstacles.discs if radius > 0.1]
        for name in self._bodies:
            others = [body for other, body in self._bodies.items() if other != name]
            self._walkers[name].look(now, self._ways, robot, (*others, *standing), self._random)

    def _show(self) -> None:
        self._obstacles.walk({name: (w.x, w.y, w.radius) for name, w in self._walkers.items() if w.present})

    def _known_person(self, name: str) -> Person:
        if name not in self._people:
            raise RobotError(f"there's no person called '{name}'")
        return self._people[name]

    def _known(self, name: str) -> Walker:
        """Return the walker of a person: somebody who has only stood so far can walk from now on. Raises RobotError."""
        person = self._known_person(name)
        if name not in self._walkers:
            self._report("walk", name, "")
            point = self._obstacles.point(name)
            walker = self._walkers[name] = Walker(person, self._places)
            walker.present = True
            if point is not None:
                walker.put(*point)
            self._obstacles.start_walking(name)
            self._show()
        return self._walkers[name]
