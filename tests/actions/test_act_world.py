"""Journeys, hands, gestures, speech and power."""

from math import inf

import pytest

from btlang.actions import gestures, manipulation, motion, navigation, power, sensing, speech
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import Pose, wrap
from btlang.robots.robot import RobotError
from btlang.robots.worlds.world import Person, Place, World, WorldFault, WorldObject
from btlang.robots.worlds.world_file import load_world


def test_go_to_the_kitchen_then_pick_up_the_cup_and_bring_it(bench):
    b = bench(load_world())
    b.run(navigation.go_to, place="kitchen")
    assert sensing.at_place(b.robot, "kitchen")
    b.run(manipulation.pick_up, object="cup")
    assert sensing.holding(b.robot, "cup")
    b.run(navigation.go_to_person, person="Bob")
    assert sensing.person_near(b.robot, "Bob")
    b.run(manipulation.put_down, object="cup")
    assert sensing.hand_empty(b.robot)
    assert b.robot.pose.distance_to(b.robot.locate("cup")) < 0.5
    b.run(manipulation.pick_up, object="cup")
    b.run(power.dock)
    assert b.robot.bumps == 0


@pytest.mark.parametrize("name", [each.name for each in load_world().objects if not each.fixed])
def test_every_object_of_the_default_world_can_be_picked_up(bench, name):
    b = bench(load_world())
    b.run(manipulation.pick_up, object=name)
    assert b.robot.holding("right") == name


def test_no_way_fails_with_the_reason(bench):
    b = bench(load_world(), faults=(WorldFault("blocked", place="lab"),))
    with pytest.raises(ActionFailed, match=r"^there is no free way to the lab$"):
        b.run(navigation.go_to, place="lab")
    with pytest.raises(ActionFailed, match=r"^I don't know where 'moon' is$"):
        b.run(navigation.go_to, place="moon")


def test_go_to_a_point_and_face_another_one(bench):
    b = bench(load_world())
    b.run(navigation.go_to, x=5.0, y=2.5, facing=90.0)
    assert b.robot.pose.distance_to((5.0, 2.5)) < 0.1
    assert b.robot.pose.heading == pytest.approx(90.0, abs=2.0)
    assert sensing.at_place(b.robot, x=5.0, y=2.5)
    assert sensing.distance_to_place(b.robot, x=5.0, y=4.5) == pytest.approx(2.0, abs=0.1)
    b.run(motion.face_place, x=1.0, y=2.5)
    assert abs(b.robot.pose.bearing_to((1.0, 2.5))) < 3.0
    with pytest.raises(RobotError, match=r"^neither a place nor a point is given$"):
        b.run(navigation.go_to, x=1.0)
    with pytest.raises(ActionFailed, match=r"^there is no free way to \(50.00, 1.00\)$"):
        b.run(navigation.go_to, x=50.0, y=1.0)


def test_the_nearest_is_chosen_and_not_what_the_hand_holds(bench):
    b = bench(load_world())
    found = []
    b.run(navigation.choose, type="person", how="nearest", output=found.append)
    b.run(navigation.choose, type="object", how="nearest", output=found.append)
    nearest = min(load_world().names.people, key=lambda name: b.robot.pose.distance_to(b.robot.locate(name)))
    assert found[0] == nearest
    b.run(manipulation.pick_up, object=found[1])
    b.run(navigation.choose, type="object", how="nearest", output=found.append)
    assert found[2] != found[1]
    assert ("choose", {"type": "object", "how": "nearest", "name": found[1]}) in b.events


@pytest.mark.parametrize(("heading", "sides"), [
    (0.0, {"in_front_of": "east", "left_of": "north", "behind": "west", "right_of": "south"}),
    (90.0, {"in_front_of": "north", "left_of": "west", "behind": "south", "right_of": "east"}),
])  # fmt: skip
def test_sides_are_those_of_the_robot(bench, heading, sides):
    objects = {"east": (8.0, 5.0), "north": (5.0, 8.0), "west": (2.0, 5.0), "south": (5.0, 2.0)}
    things = tuple(WorldObject(name, *point, 0.1) for name, point in objects.items())
    b = bench(load_world().replace(objects=things, start=Pose(5.0, 5.0, heading), people=(), walls=()))
    for relation, name in sides.items():
        assert tuple(b.robot.described("object", {relation: "robot"})) == (name,)
    assert not b.robot.described("object", {"near": "robot"})


def test_random_choices_follow_from_the_seed(bench):
    def chosen(seed):
        b = bench(load_world())
        b.robot.seed_choices(seed)
        return [b.robot.choose("place", "random") for _ in range(20)]

    assert chosen(1) == chosen(1)
    assert chosen(1) != chosen(2)
    assert set(chosen(1)) <= set(load_world().names.places)


@pytest.mark.parametrize(("kind", "how", "reason"), [
    ("person", "nearest", "there's no person to choose"),
    ("ship", "random", "there's no ship to choose"),
    ("place", "dearest", "it can choose the nearest or a random place, not by 'dearest'"),
])  # fmt: skip
def test_what_cannot_be_chosen(bench, kind, how, reason):
    b = bench(load_world().replace(people=()))
    with pytest.raises(RobotError, match=f"^{reason}$"):
        b.robot.choose(kind, how)


def test_a_halted_journey_brakes(bench):
    b = bench(load_world())
    running = b.begin(navigation.go_to, 3.0, place="office")
    assert b.robot.moving
    running.close()
    b.tick(4)
    assert not b.robot.moving


def test_an_emergency_stop_ends_a_journey(bench):
    b = bench(load_world())
    running = b.begin(navigation.go_to, 3.0, place="office")
    b.robot.stop()
    with pytest.raises(ActionFailed, match=r"^the robot was stopped$"):
        next(running)


def test_approach(bench, table):
    b = bench(table)
    b.run(navigation.approach, object="ball")
    b.robot.grasp("right", "ball")
    assert b.robot.holding("right") == "ball"


def test_hands(bench, table):
    b = bench(table)
    b.run(manipulation.close_right_hand)
    assert sensing.holding_something(b.robot)
    with pytest.raises(ActionFailed, match=r"^the right hand already holds the cup$"):
        b.run(manipulation.grasp)
    with pytest.raises(ActionFailed, match=r"^the right hand already holds the cup$"):
        b.run(manipulation.pick_up, object="ball")
    with pytest.raises(ActionFailed, match=r"^nothing is within reach of the left hand$"):
        b.run(manipulation.close_left_hand)
    with pytest.raises(ActionFailed, match=r"^the robot isn't holding the ball$"):
        b.run(manipulation.put_down, object="ball")
    b.run(manipulation.open_right_hand)
    b.run(manipulation.open_left_hand)
    with pytest.raises(ActionFailed, match=r"^the robot isn't holding anything$"):
        b.run(manipulation.release)
    b.run(manipulation.grasp, object="cup")
    b.run(manipulation.release, object="cup")
    with pytest.raises(ActionFailed, match=r"^the ball is not within reach of the right hand$"):
        b.run(manipulation.grasp, object="ball")


def test_what_is_held_is_lifted_when_it_is_picked_up_again(bench, table):
    b = bench(table)
    b.robot.grasp("right", "cup")
    b.run(manipulation.pick_up, object="cup")
    assert b.robot.holding("right") == "cup"


def test_a_weak_hand_loses_what_it_picked_up(bench, table):
    b = bench(table, faults=(WorldFault("weak hand", seconds=4.0),))
    b.run(manipulation.pick_up, object="cup")
    b.tick(80)
    with pytest.raises(ActionFailed, match=r"^the robot isn't holding anything$"):
        b.run(manipulation.put_down)


def test_arms(bench):
    b = bench()
    for leaf, joint, angle in (
        (manipulation.raise_right_arm, "right arm lift", 150),
        (manipulation.stretch_right_arm, "right arm lift", 90),
        (manipulation.lower_right_arm, "right arm lift", 0),
        (manipulation.raise_left_arm, "left arm lift", 150),
        (manipulation.retract_left_arm, "left arm bend", 150),
        (manipulation.stretch_left_arm, "left arm bend", 0),
        (manipulation.retract_right_arm, "right arm bend", 150),
        (manipulation.lower_left_arm, "left arm lift", 0),
        (manipulation.raise_both_arms, "left arm lift", 150),
        (manipulation.lower_both_arms, "left arm lift", 0),
    ):
        b.run(leaf)
        assert b.robot.joint(joint) == angle


@pytest.mark.parametrize(
    ("leaf", "ports"),
    [
        (gestures.wave, {}),
        (gestures.wave, {"person": "Alice"}),
        (gestures.nod, {}),
        (gestures.shake_head, {}),
        (gestures.look_around, {}),
        (gestures.look_left, {}),
        (gestures.look_right, {}),
        (gestures.look_up, {}),
        (gestures.look_down, {}),
        (gestures.look_at_person, {"person": "Alice"}),
        (gestures.look_at_object, {"object": "ball"}),
        (gestures.point_at_person, {"person": "Alice"}),
        (gestures.point_at_object, {"object": "cup"}),
        (gestures.point_left, {}),
        (gestures.point_right, {}),
    ],
)
def test_gestures_take_time_and_leave_the_base_alone(bench, table, leaf, ports):
    b = bench(table)
    b.robot.drive(-0.2, 0.0)
    _, seconds = b.run(leaf, **ports)
    assert 0.2 <= seconds < 10
    assert not b.robot._joints.moving
    assert b.robot.velocity[0] == pytest.approx(-0.2)
    halted = bench(table)
    halted.robot.drive(-0.2, 0.0)
    running = halted.begin(leaf, 0.1, **ports)
    assert halted.robot._joints.moving
    running.close()
    assert not halted.robot._joints.moving
    halted.tick(10)
    assert halted.robot.velocity[0] == pytest.approx(-0.2)


def test_pointing_and_looking_go_the_right_way(bench, table):
    b = bench(table)
    b.run(gestures.point_at_person, person="Alice")
    assert b.robot.joint("right arm swing") == pytest.approx(90)
    b.run(gestures.look_at_object, object="ball")
    assert b.robot.joint("head turn") == pytest.approx(18.43, abs=0.01)
    b.run(gestures.look_ahead)
    b.run(gestures.point_ahead)
    assert b.robot.joint("head turn") == b.robot.joint("right arm swing") == 0.0


def test_the_head_does_not_turn_to_the_back(bench, table):
    b = bench(table, start=Pose(0.0, 0.0, 180.0))
    with pytest.raises(ActionFailed, match=r"^the ball is behind the robot; the head can't turn that far$"):
        b.run(gestures.look_at_object, object="ball")


def test_an_emergency_stop_ends_gestures_and_speech(bench):
    for leaf, ports in ((gestures.wave, {}), (speech.say, {"text": "a long sentence"})):
        b = bench()
        running = b.begin(leaf, 0.3, **ports)
        b.robot.stop()
        with pytest.raises(ActionFailed, match=r"^the robot was stopped$"):
            next(running)


def test_speech(bench):
    b = bench()
    assert b.run(speech.say, text="hello")[1] == pytest.approx(0.65)
    b.run(speech.print_text, text="hi")
    b.begin(speech.say, 0.2, text="never said to the end").close()
    assert not b.robot.speaking
    assert [kind for kind, _ in b.events] == ["say", "print", "say"]


def test_power(bench):
    b = bench(load_world(), battery=15.0)
    assert sensing.battery_low(b.robot)
    b.run(power.charge, percent=40.0)
    assert 40 <= b.robot.battery < 41
    assert sensing.docked(b.robot)
    assert sensing.charging(b.robot)
    assert b.run(power.dock) == (None, 0.0)
    b.run(power.charge, percent=100.0)
    assert sensing.battery_full(b.robot)
    b.run(power.undock)
    assert not sensing.docked(b.robot)
    assert not sensing.charging(b.robot)
    assert b.run(power.undock) == (None, 0.0)


def test_charging_fails_away_from_the_dock(bench):
    b = bench(load_world(), battery=15.0)
    running = b.begin(power.charge, 20.0, percent=100.0)
    b.robot.undock()
    with pytest.raises(ActionFailed, match=r"^the robot left the dock at \d+%$"):
        next(running)


HALL = World(
    start=Pose(1.5, 1.5),
    walls=(((0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0), (0.0, 0.0)),),
    places=(Place("dock", 0.4, 0.6, 180.0),),
    dock=Place("dock", 0.4, 0.6, 180.0),
)


def test_it_drives_straight_into_the_dock_and_faces_as_the_dock_says(bench):
    b = bench(HALL)
    way = []
    b.robot.on_step = lambda dt: way.append(b.robot.pose)
    b.run(power.dock)
    assert b.robot.pose.distance_to((0.4, 0.6)) < 0.04
    assert abs(wrap(b.robot.pose.heading - 180.0)) < 1.5
    assert all(abs(pose.y - 0.6) < 0.05 and abs(wrap(pose.heading - 180.0)) < 2 for pose in way if pose.x < 0.75)
    names = ["navigate", "arrive", "dock"]
    assert [kind for kind, _ in b.events] == names
    b.run(power.undock)
    assert b.robot.pose.x == pytest.approx(0.8, abs=0.02)


def test_where_it_stands_in_its_dock_it_only_connects(bench):
    b = bench(HALL, start=Pose(0.45, 0.6, 178.0))
    assert b.run(power.dock)[1] < 1.0
    assert [kind for kind, _ in b.events] == ["dock"]


@pytest.mark.parametrize(("times", "docks"), [(1, True), (2, True), (3, False), (inf, False)])
def test_a_dock_that_does_not_connect_is_tried_again(bench, times, docks):
    b = bench(HALL, faults=(WorldFault("dock", times=times),))
    if docks:
        b.run(power.dock)
    else:
        with pytest.raises(ActionFailed, match=r"^the dock doesn't connect$"):
            b.run(power.dock)
    assert b.robot.docked is docks
    if times == 3:
        b.run(power.dock)  # the fault is over, and it stands there
        assert b.robot.docked


def test_a_blocked_dock_is_not_run_into_and_tried_again(bench):
    b = bench(HALL, people=(Person("Bob", 0.3, 0.6, 0.25),))
    with pytest.raises(ActionFailed, match=r"^something is in the way into the dock$"):
        b.run(power.dock)
    assert b.robot.bumps == 0
    b = bench(HALL, people=(Person("Bob", 0.3, 0.6, 0.25),))
    running = b.begin(power.dock, 6.5)
    b.robot.move_thing("Bob", 5.0, 3.0)
    b.run(lambda robot: running)
    assert b.robot.docked


def test_no_way_to_the_dock_is_not_tried_again(bench):
    b = bench(HALL, faults=(WorldFault("blocked", place="dock"),))
    with pytest.raises(ActionFailed, match=r"^there is no free way to the dock$"):
        b.run(power.dock, seconds=1.0)


def test_a_stop_ends_docking_and_halting_brakes(bench):
    b = bench(HALL, start=Pose(1.0, 0.6, 180.0))
    running = b.begin(power.dock, 2.5)
    assert b.robot.pose.x < 0.75
    b.robot.stop()
    with pytest.raises(ActionFailed, match=r"^the robot was stopped$"):
        next(running)
    b = bench(HALL, start=Pose(1.0, 0.6, 180.0))
    b.begin(power.dock, 2.5).close()
    b.tick(20)
    assert b.robot.velocity == (0.0, 0.0)


def test_it_takes_the_nearest_dock_and_the_next_where_that_fails(bench):
    near, far = Place("dock", 0.4, 0.6, 180.0), Place("night dock", 5.6, 0.6, 0.0)
    for faults, x in (
        ((), 0.4),
        ((WorldFault("dock", place="dock"),), 5.6),
        ((WorldFault("dock", place="night dock"),), 0.4),
    ):
        b = bench(HALL, start=Pose(2.5, 0.6, 0.0), places=(near, far), dock=near, docks=(far,), faults=faults)
        assert [station.name for station in b.robot.stations] == ["dock", "night dock"]
        b.run(power.dock)
        assert b.robot.docked
        assert b.robot.pose.x == pytest.approx(x, abs=0.1)
        b.run(power.undock)
        assert not b.robot.docked
    b = bench(
        HALL, start=Pose(2.5, 0.6, 0.0), places=(near, far), dock=near, docks=(far,), faults=(WorldFault("dock"),)
    )
    with pytest.raises(ActionFailed, match=r"^the dock doesn't connect$"):
        b.run(power.dock)


@pytest.mark.parametrize(("facing", "x"), [(180.0, 0.8), (0.0, 0.2)])
def test_the_staging_pose_is_where_walls_leave_room(bench, facing, x):
    dock = Place("dock", 0.4, 0.6, facing)
    b = bench(HALL, places=(dock,), dock=dock)
    [station] = b.robot.stations
    assert station.staging == Pose(pytest.approx(x), pytest.approx(0.6), facing)
    b.run(power.dock)
    assert b.robot.docked


def test_there_may_be_no_dock(bench):
    with pytest.raises(ActionFailed, match="dock"):
        bench().run(power.dock)


def test_docking_needs_the_dock(bench):
    with pytest.raises(ActionFailed, match=r"^the dock is \d\.\d m away$"):
        bench(load_world()).robot.dock()
