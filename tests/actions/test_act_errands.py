"""Bringing, coming back, following, guiding, searching and counting: what happens, and how each of them fails."""

from contextlib import closing
from math import dist

import pytest

from btlang.actions import company, errands, gestures, manipulation, navigation, search, world
from btlang.engine.blackboard import Blackboard
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import Pose
from btlang.robots.robot import RobotError
from btlang.robots.worlds.world import Person, Place, Stop, World, WorldObject
from btlang.robots.worlds.world_file import load_world
from btlang.text.source import Source
from btlang.vocabulary.references import Choice


def hall(*people, objects=(), **changes):
    """A long hall with a place at each end, and the robot in the middle."""
    walls = (((-1.0, -3.0), (13.0, -3.0), (13.0, 3.0), (-1.0, 3.0), (-1.0, -3.0)),)
    places = (Place("west", 0.0, 0.0), Place("east", 12.0, 0.0))
    return World(Pose(4.0, 0.0), walls=walls, places=places, people=people, objects=objects).replace(**changes)


def test_come_back(bench):
    b = bench(load_world())
    b.robot.seed_choices(1)
    start = b.robot.pose
    b.run(navigation.go_to, place="lab")
    b.run(errands.come_back)
    assert b.robot.pose.distance_to((start.x, start.y)) < 0.1
    assert b.robot.pose.heading == pytest.approx(start.heading, abs=2.0)


def test_slowly_takes_longer_and_quickly_less(bench):
    seconds = []
    for manner in ("quickly", None, "slowly"):
        b = bench(load_world())
        seconds.append(b.run(navigation.go_to, place="lab", manner=manner)[1])
        assert b.robot.pace == 1.0
    assert seconds == sorted(seconds)
    assert seconds[2] > 1.5 * seconds[1]


def test_a_halted_journey_leaves_the_usual_pace(bench):
    b = bench(load_world())
    running = b.begin(navigation.go_to, 2.0, place="lab", manner="slowly")
    assert b.robot.pace == 0.5
    running.close()
    assert b.robot.pace == 1.0


def test_bring_something_to_somebody_who_then_has_it(bench):
    b = bench(load_world())
    b.run(errands.bring, object="cup", person="Alice")
    assert b.robot.holding("right") is None
    assert ("give", {"hand": "right", "name": "cup", "who": "Alice"}) in b.events
    assert b.robot.locate("cup") == b.robot.locate("Alice")
    with pytest.raises(ActionFailed, match=r"^Alice has the cup$"):
        b.run(manipulation.pick_up, object="cup")


def test_me_is_who_spoke_last_then_who_is_in_view_then_the_start(bench):
    cup = WorldObject("cup", 2.0, 1.0, 0.04)
    b = bench(hall(Person("Ada", 6.0, 0.0, 0.25), Person("Ben", 8.0, 1.0, 0.25), objects=(cup,)))
    assert company.speaker(b.robot) == "Ada"
    b.robot.hear("Over here!", "Ben")
    b.run(errands.bring, object="cup")
    assert b.events[-1][0] != "stop"
    assert ("give", {"hand": "right", "name": "cup", "who": "Ben"}) in b.events
    alone = bench(hall(objects=(cup,)))
    alone.run(errands.bring, object="cup")
    assert alone.robot.pose.distance_to((4.0, 0.0)) < 0.2
    assert alone.robot.holding("right") is None


def test_who_refuses_is_given_nothing(bench):
    b = bench(hall(Person("Ada", 7.0, 0.0, 0.25, refuses=("Cup",)), objects=(WorldObject("cup", 2.0, 1.0, 0.04),)))
    with pytest.raises(ActionFailed, match=r"^Ada doesn't want the cup$"):
        b.run(errands.bring, object="cup", person="Ada")
    assert b.robot.holding("right") == "cup"
    b.run(navigation.go_to, place="west")
    with pytest.raises(RobotError, match=r"^Ada is \d\.\d m away$"):
        b.robot.hand_over("right", "Ada")
    with pytest.raises(RobotError, match=r"^the left hand is empty$"):
        b.robot.hand_over("left", "Ada")


def test_take_something_somewhere(bench):
    b = bench(load_world())
    b.run(errands.carry, object="cup", place="lab")
    assert b.robot.holding("right") is None
    lab = b.robot.locate("lab")
    x, y = b.robot.locate("cup")
    assert abs(x - lab[0]) + abs(y - lab[1]) < 1.5


def test_fetch_comes_back_with_it(bench):
    b = bench(load_world())
    start = b.robot.pose
    b.run(errands.fetch, object="cup")
    assert b.robot.holding("right") == "cup"
    assert b.robot.pose.distance_to((start.x, start.y)) < 0.1


def test_patrol_and_localize(bench):
    b = bench(hall())
    b.run(errands.patrol, place="east")
    assert b.robot.pose.distance_to((12.0, 0.0)) < 0.2
    b.run(errands.localize)
    b.run(gestures.dance)
    b.run(gestures.bow)
    assert b.robot.bumps == 0


def walker(**changes):
    """Somebody who walks along the hall in a moment."""
    return Person("Ada", 6.0, 0.0, 0.25, walks=(Stop(11.0, 0.0, at=2.0),), speed=0.8).replace(**changes)


def test_follow_until_somebody_stands(bench):
    b = bench(hall(walker()))
    b.run(company.follow_until_still, person="Ada", duration=4.0)
    assert b.robot.pose.distance_to((11.0, 0.0)) < 2.0
    assert b.robot.bumps == 0


def test_follow_to_a_place(bench):
    b = bench(hall(walker()))
    b.run(company.follow, person="Ada", place="east")
    assert b.robot.pose.x > 7.0


def test_follow_goes_to_where_it_meets_somebody_first(bench):
    b = bench(hall(walker(walks=(), x=1.0)))
    following = b.begin(company.follow, 8.0, person="Ada", source="east")
    assert b.robot.pose.x > 6.0
    following.close()


def test_following_goes_on_until_it_is_halted(bench):
    b = bench(hall(walker(walks=(Stop(11.0, 0.0), Stop(6.0, 1.0)), again=True)))
    b.begin(company.follow, 40.0, person="Ada").close()
    b.tick(20)
    assert not b.robot.moving
    assert b.robot.bumps == 0


def test_who_is_lost_is_said(bench):
    b = bench(hall(walker(leaves=6.0, walks=(), x=8.0)))
    with pytest.raises(ActionFailed, match=r"^I've lost Ada$"):
        b.run(company.follow, person="Ada")
    with pytest.raises(ActionFailed, match=r"^I see nobody$"):
        b.run(company.follow)


def test_guide_leads_somebody_there(bench):
    b = bench(hall(walker(walks=())))
    b.run(company.guide, person="Ada", place="east")
    assert b.robot.pose.distance_to((12.0, 0.0)) < 0.2
    assert b.robot.pose.distance_to(b.robot.locate("Ada")) < 3.0
    assert ("say", {"text": "Please follow me, Ada."}) in b.events


def test_guide_goes_back_for_who_dawdles(bench):
    b = bench(hall(walker(walks=(), follows=0.3)))
    b.robot.seed_choices(3)
    b.run(company.guide, seconds=600.0, person="Ada", place="east")
    assert b.robot.pose.distance_to(b.robot.locate("Ada")) < 3.0


def test_guide_gives_up_who_never_comes(bench):
    b = bench(hall(walker(walks=())))
    b.robot.guide = lambda person, follow: None
    with pytest.raises(ActionFailed, match=r"^I've lost Ada$"):
        b.run(company.guide, seconds=600.0, person="Ada", place="east")


def test_greet(bench):
    b = bench(load_world())
    b.run(company.greet, person="Alice")
    assert ("say", {"text": "Hello, Alice!"}) in b.events


def test_tell(bench):
    b = bench(load_world())
    b.run(company.tell, person="Alice", text="dinner is ready")
    assert ("say", {"text": "dinner is ready"}) in b.events
    there = b.robot.locate("Alice")
    assert dist((b.robot.pose.x, b.robot.pose.y), there) < 2.0


def test_wait_for_who_comes(bench):
    b = bench(hall(walker(comes=5.0)))
    assert b.run(company.wait_for_someone)[1] >= 5.0
    b.run(company.wait_for_person, person="Ada")
    late = bench(hall(walker(comes=60.0)))
    with pytest.raises(ActionFailed, match=r"^Ada didn't come$"):
        late.run(company.wait_for_person, person="Ada", duration=3.0)
    with pytest.raises(ActionFailed, match=r"^nobody came$"):
        late.run(company.wait_for_someone, duration=3.0)


def unknown_world():
    """The world that ships, as who has never been there knows it."""
    known = load_world()
    people = tuple(person.replace(known=False) for person in known.people)
    return known.replace(people=people, objects=tuple(thing.replace(known=False) for thing in known.objects))


def test_find_what_nobody_has_seen(bench):
    b = bench(unknown_world())
    with pytest.raises(RobotError, match=r"^I haven't seen Bob$"):
        b.robot.locate("Bob")
    b.run(search.find_person, seconds=600.0, person="Bob")
    assert b.robot.pose.distance_to(b.robot.locate("Bob")) < 1.5
    b.run(search.find_object, seconds=600.0, object="cup")
    b.run(manipulation.grasp, object="cup")
    assert b.run(search.look_for_object, object="cup") == (None, 0.0)


TWO_CUPS = """
start = { x = 1, y = 1 }
walls = [[[0, 0], [20, 0], [20, 10], [0, 10], [0, 0]]]
places = [
  { name = "kitchen", x = 3, y = 8, points = [[0, 6], [6, 6], [6, 10], [0, 10]] },
  { name = "lab", x = 17, y = 8, points = [[14, 6], [20, 6], [20, 10], [14, 10]] },
]
objects = [
  { name = "red cup", kind = "cup", color = "red", x = 2, y = 3 },
  { name = "blue cup", kind = "cup", color = "blue", x = 16, y = 7.3, known = false },
]
"""


def test_what_fits_no_description_is_not_found(bench):
    b = bench(load_world(Source(TWO_CUPS)))
    names: list[str] = []
    sought = Choice("nearest", "object", "object", (("color", "green"), ("kind", "cup"))).text
    with pytest.raises(ActionFailed, match=r"^I haven't found a green cup in the lab$"):
        b.run(search.look_for_object, seconds=600.0, object=sought, place="lab", found=names.append)
    assert names == []


def test_what_fits_a_description_is_found_where_it_is(bench):
    b = bench(load_world(Source(TWO_CUPS)))
    names: list[str] = []
    sought = Choice("nearest", "object", "object", (("kind", "cup"),)).text
    b.run(search.look_for_object, seconds=600.0, object=sought, found=names.append)
    b.run(search.find_object, seconds=600.0, object=sought, place="lab", found=names.append)
    b.run(manipulation.grasp, object="blue cup")
    b.run(search.look_for_object, object=sought, found=names.append)  # in the hand
    assert names == ["red cup", "blue cup", "blue cup"]


def test_what_is_not_there_is_not_found(bench):
    b = bench(unknown_world())
    with pytest.raises(ActionFailed, match=r"^I haven't found Bob in the kitchen$"):
        b.run(search.look_for_person, seconds=600.0, person="Bob", place="kitchen")
    gone = bench(hall(walker(comes=9_000.0)))
    with pytest.raises(ActionFailed, match=r"^I haven't found Ada$"):
        gone.run(search.find_person, seconds=600.0, person="Ada")
    with pytest.raises(ActionFailed, match=r"^I haven't found anybody in the east$"):
        gone.run(search.find_someone, seconds=600.0, place="east")


def test_who_is_seen_elsewhere_is_not_found_in_a_place(bench):
    b = bench(hall(walker(walks=())))
    for look in (search.look_for_person, search.find_person):
        with pytest.raises(ActionFailed, match=r"^I haven't found Ada in the east$"):
            b.run(look, seconds=600.0, person="Ada", place="east")
    with pytest.raises(ActionFailed, match=r"^I haven't found anybody in the east$"):
        b.run(search.look_for_someone, seconds=600.0, place="east")
    b.run(search.look_for_person, seconds=600.0, person="Ada")


def test_a_search_that_is_stopped_ends(bench):
    b = bench(unknown_world())
    with closing(b.begin(search.look_for_person, 8.0, person="Bob")) as running:
        b.robot.stop()
        with pytest.raises(ActionFailed, match=r"^the robot was stopped$"):
            next(running)


def test_count(bench):
    b, board = bench(load_world()), Blackboard()
    with pytest.raises(ActionFailed, match=r"^nothing was counted$"):
        search.count(board)
    b.run(search.count_people, blackboard=board, place="kitchen")
    assert search.count(board) == 1
    b.run(search.count_objects, blackboard=board)
    assert search.count(board) == 1


def test_the_names_of_what_was_counted_are_those_at_the_place(bench):
    b, board = bench(load_world()), Blackboard()
    with pytest.raises(ActionFailed, match=r"^nothing was counted$"):
        search.counted_names(board)
    b.run(search.count_people, blackboard=board, place="kitchen")
    assert search.counted_names(board) == "Alice"
    b.run(search.count_people, blackboard=board, place="lobby")
    assert search.counted_names(board) == "nobody"
    b.run(search.count_kind, blackboard=board, kinds="cup", place="lobby")
    assert search.counted_names(board) == "nothing"


def test_take_a_picture(bench):
    b = bench(load_world())
    b.run(navigation.go_to, place="kitchen")
    b.run(world.take_picture_of_person, person="Alice")
    kind, data = b.events[-1]
    assert kind == "picture"
    assert "Alice" in data["name"]
    with pytest.raises(ActionFailed, match=r"^I don't see Bob$"):
        b.run(world.take_picture_of_person, person="Bob")
