"""What each example must do: the world, the exit code, and the facts that matter of its run."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Case:
    """An example and its run. `parts` are the missions that it includes.

    `done` holds the commands that succeeded in their order, as `Id` and values; where it ends in `...` more follow.
    `failed` the commands that failed, `said` and `printed` all texts in their order, `met` the kinds of the robot's
    other events that must occur. `at` is the place or person where the robot ends, `put` gives the place or person near
    which an object ends, `error` a part of what is written to standard error.
    """

    world: str | None = None
    parts: tuple[str, ...] = ()
    options: tuple[str, ...] = ()
    code: int = 0
    done: tuple[str, ...] = ()
    failed: tuple[str, ...] = ()
    said: tuple[str, ...] = ()
    printed: tuple[str, ...] = ()
    met: tuple[str, ...] = ()
    at: str | None = None
    put: dict[str, str] = field(default_factory=dict)
    seconds: tuple[float, float] = (0.0, 600.0)
    cells: int = 1
    error: str = ""


_ROUND = ("GoTo kitchen", "LookAround", "GoTo lab", "LookAround", "GoTo office", "LookAround", "GoTo lobby")
_SHELVES = ("GoTo first shelf", "LookAround", "GoTo second shelf", "LookAround", "GoTo third shelf", "LookAround")
_QUESTION = "You have a question? The staff in the cafe know everything."
_WATCH = (*_SHELVES, "GoTo gate", "Print nobody at the gate", "Charge")
_SWING = ("RaiseBothArms", "TurnLeft 45", "LowerBothArms", "TurnRight 45", "TurnLeft 45", "TurnRight 45")

CASES = {
    "careful_walk": Case(
        world="walled_room",
        done=(*["MoveForward 0.3"] * 14, "Say That was close!", "MoveBackward 0.2", "TurnAround"),
        said=("That was close!",),
        seconds=(20, 60),
        cells=4,
    ),
    "coffee_round": Case(
        done=("GoTo lab", "GoTo kitchen", "Say No coffee today.", "GoTo lobby"),
        said=("No coffee today.",),
        at="lobby",
        seconds=(40, 50),
    ),
    "dance": Case(
        done=("Say Music, please!", *_SWING, "..."),
        said=("Music, please!", "Thank you, thank you!"),
        seconds=(20, 40),
    ),
    "evening_rounds": Case(
        done=(*["GoTo kitchen", "GoTo lab"] * 3, "GoTo kitchen", "GoTo lobby", "TurnAround", "Say Good night.", "Nod"),
        said=("Good night.",),
        at="lobby",
        seconds=(120, 145),
    ),
    "fetch_and_carry": Case(
        done=(*["Say Excuse me, please."] * 2, "..."),
        said=(*["Excuse me, please."] * 3, "Coming!"),
        at="Alice",
        put={"bottle": "Alice"},
        seconds=(40, 50),
    ),
    "find_someone": Case(
        done=("GoTo kitchen", "GoTo lab", "GoTo office", "Say Hello! Nice to see you.", "Wave", "..."),
        said=("Hello! Nice to see you.", "I like your desk, Bob."),
        at="office",
    ),
    "first_steps": Case(
        done=("MoveForward 1", "TurnLeft", "Say Hello! I am ready to work.", "LookAround", "Wave"),
        said=("Hello! I am ready to work.",),
        seconds=(10, 15),
    ),
    "guard_the_door": Case(
        done=("GoTo door", "TurnAround", *["LookAround", "Print nobody"] * 3, "RaiseArm", "Say The watch is over."),
        said=("The watch is over.",),
        printed=("nobody",) * 3,
        at="door",
        seconds=(40, 50),
    ),
    "hello": Case(done=("Say hello", "Wave"), said=("hello",), seconds=(1, 10)),
    "hide_and_seek": Case(
        done=(
            "Say Three, two, one. I am coming!", "LookAround", "GoTo lobby", "GoTo office", "Say I see you, Bob!",
            *["Nod"] * 3,
        ),
        said=("Three, two, one. I am coming!", "I see you, Bob!"),
        at="office",
        seconds=(30, 36),
    ),
    "inspection_tour": Case(
        done=("GoTo lab", "LookLeft", "LookRight", "GoTo hall", "LookLeft", "LookRight", "Say All is well.") * 2,
        said=("All is well.",) * 2,
        at="hall",
        seconds=(40, 50),
    ),
    "locked_lab": Case(
        world="locked_lab",
        done=(
            *["Say Knock, knock!"] * 4, "GoTo lab", "Say Thank you! Now for the cup.",
            "PickUp cup", "GoTo lab", "Say Oops! I take the other hand.", "Approach cup", "CloseLeftHand", "GoTo lab",
            "Say Here I come.", "GoToPerson Alice", "Release cup",
        ),
        failed=("GoTo lab",) * 4,
        said=(*["Knock, knock!"] * 4, "Thank you! Now for the cup.", "Oops! I take the other hand.", "Here I come."),
        met=("fault blocked", "fault weak hand", "drop cup"),
        at="Alice",
        put={"cup": "Alice"},
    ),
    "look_before_you_go": Case(
        world="walled_room",
        done=(*["MoveForward 0.75"] * 6, "TurnRight", "MoveForward 0.75", "TurnRight", "..."),
        said=("I can go no further.",),
        cells=6,
    ),
    "lost_property": Case(
        done=("GoTo office", "PickUp book", "GoToPerson Bob", "PutDown book", "Say Is this your book, Bob?", "..."),
        said=("Is this your book, Bob?",),
        at="lobby",
        put={"book": "Bob"},
        seconds=(50, 62),
    ),
    "morning_exercises": Case(
        done=(
            "GoTo hall", "Say And up!", "RaiseBothArms", "LowerBothArms", *["TurnLeft", "TurnRight"] * 2, *["Nod"] * 2,
            "Say Well done!",
        ),
        said=("And up!", "Well done!"),
        at="hall",
        seconds=(22, 32),
    ),
    "morning_round": Case(
        parts=("greetings",),
        done=("GoToPerson {person}", "..."),
        said=(
            "Good morning, Alice!", "Good morning, Bob!", "Good morning, Carol!", "I have greeted 3 people.",
            "That was a long way.",
        ),
        at="lobby",
        seconds=(70, 120),
    ),
    "museum_guide": Case(
        world="museum",
        done=("TurnAround", "..."),
        said=(
            "Good afternoon! I am your guide. Please follow me.", _QUESTION, "This statue is two thousand years old.",
            "Hush! Do not wake the mummy.", _QUESTION, "And this was a very big lizard.",
            "Excuse me, I need a little energy. I will be back.", "Where were we?", _QUESTION,
            "There is time for two more.", _QUESTION, "Here is the fountain again.",
            _QUESTION, "Here is the statue again.",
            "The tour is over. Enjoy your coffee!", "I had 5 questions today.",
        ),
        met=("dock", "undock"),
        at="cafe",
        seconds=(240, 330),
    ),
    "museum_tour": Case(
        world="museum",
        done=(
            "TurnAround", "Say Welcome to the museum! Please follow me.", "Wave",
            "GoTo statue", "PointAtPlace statue", "Say This statue is two thousand years old.",
            "GoTo mummy", "Say Hush! Do not wake the mummy.",
            "GoTo skeleton", "LookUp", "Say And this was a very big lizard.",
            "Say Now I will show you the best place of all.", "GoTo cafe",
            "Nod", "Say The tour is over. Enjoy your coffee!", "Wave",
        ),
        said=(
            "Welcome to the museum! Please follow me.", "This statue is two thousand years old.",
            "Hush! Do not wake the mummy.", "And this was a very big lizard.",
            "Now I will show you the best place of all.", "The tour is over. Enjoy your coffee!",
        ),
        at="cafe",
    ),
    "night_watch": Case(
        world="warehouse",
        done=(*_WATCH, *_WATCH, "Undock", "Say Good morning!"),
        said=("Good morning!",),
        printed=("nobody at the gate",) * 2,
        met=("dock", "undock"),
        at="dock",
    ),
    "obedience": Case(
        done=(
            "Stop", "LookAhead", "LowerBothArms", "MoveForward 0.3", "TurnAround", "MoveForward 0.6",
            "TurnLeft 30", "TurnRight 30", "RaiseArm", "LowerArm", "LookAround", "LookAround", "Nod", "Nod",
            "Say At ease!",
        ),
        said=("At ease!",),
        seconds=(32, 34),
    ),
    "oily_floor": Case(
        world="oily_floor",
        done=("GoTo far end", "Say I cannot see the way.", "Say Help! My wheels turn, but I do not move."),
        failed=("Dock", "GoTo far end"),
        said=("I cannot see the way.", "Help! My wheels turn, but I do not move."),
        met=("fault slip", "fault silent scanner", "stuck"),
    ),
    "opening_hours": Case(
        done=("GoTo door", "Say Good morning!", *["Say We open at three past nine."] * 4, "..."),
        said=("Good morning!", *["We open at three past nine."] * 4, "Coffee break!"),
        at="kitchen",
        seconds=(250, 265),
    ),
    "parcels": Case(
        world="warehouse",
        done=(
            "PickUp small parcel", "Print parcel under way", "GoTo packing table", "Release",
            "PickUp big parcel", "Print parcel under way", "GoTo packing table", "Release",
            "GoToPerson Gus", "Say Two parcels are on the table, Gus.",
        ),
        said=("Two parcels are on the table, Gus.",),
        printed=("parcel under way",) * 2,
        at="Gus",
        put={"small parcel": "packing table", "big parcel": "packing table"},
    ),
    "patrol": Case(done=(*_ROUND, *_ROUND, "Say All is quiet."), said=("All is quiet.",), at="lobby", cells=20),
    "quiet_patrol": Case(
        done=("GoTo hall", "GoTo lab", "Say It is a long night.", "..."),
        said=("It is a long night.",),
        at="lobby",
        seconds=(45, 55),
    ),
    "roaming": Case(
        world="walled_room",
        options=("--for", "60s"),
        done=("TurnRight", "TurnLeft", "MoveForward", "..."),
        seconds=(60, 63),
        cells=6,
    ),
    "tea_service": Case(
        done=(
            "GoTo kitchen", "PickUp cup", "GoToPerson Alice", "PutDown cup",
            "Nod", "Say Your tea, Alice.", "GoTo lobby",
        ),
        said=("Your tea, Alice.",),
        met=("grasp cup", "release cup"),
        at="lobby",
        put={"cup": "Alice"},
    ),
    "tidy_up": Case(
        done=(
            "PickUp red ball", "GoTo hall", "OpenHand", "PickUp book", "GoTo hall", "OpenHand",
            "PickUp bottle", "GoTo hall", "OpenHand", "GoTo lobby", "Say All tidy!",
        ),
        said=("All tidy!",),
        at="lobby",
        put={"red ball": "hall", "book": "hall", "bottle": "hall"},
    ),
    "wait_for_visitors": Case(
        done=("GoTo door", "Say Nobody came today.", "ShakeHead", "GoTo lobby"),
        said=("Nobody came today.",),
        at="lobby",
        seconds=(33, 40),
    ),
    "waiting": Case(
        code=1,
        done=("GoTo door", "Say Nobody came."),
        said=("Nobody came.",),
        at="door",
        error='otherwise say "Nobody came." then fail',
    ),
    "wake_up_call": Case(
        done=("GoToPerson Carol", *["Say Good morning, Carol!"] * 3, "Wave Carol"),
        said=("Good morning, Carol!",) * 3,
        at="Carol",
        seconds=(225, 240),
    ),
}  # fmt: skip

_COFFEE, _MEDICINE = "Would you like some coffee?", "Have you taken your medicine?"

CASES |= {
    "waiter": Case(
        world="hotel",
        done=(
            "GoToPerson {guest}", f"Ask {{guest}} {_COFFEE}", "Bring coffee {guest}", "Say Enjoy it!",
            "GoToPerson {guest}", f"Ask {{guest}} {_COFFEE}", "Say Maybe later.", "GoTo reception",
        ),
        said=(_COFFEE, "Enjoy it!", _COFFEE, "Maybe later."),
        met=("ask", "hear", "grasp coffee", "give coffee"),
        at="reception",
        seconds=(120, 160),
    ),
    "errands": Case(
        world="hotel",
        done=("PickUp newspaper", "Bring newspaper Omar", "Take parcel store", "ComeBack"),
        met=("give newspaper", "release parcel", "come Vera"),
        put={"parcel": "store"},
        seconds=(160, 210),
    ),
    "greeter": Case(
        world="hotel",
        done=("GoTo reception", "WaitForPerson Vera", "GreetPerson Vera", "Ask Vera May I show you your room?",
              "Guide Vera room 1", "Say Here we are."),
        said=("Hello, Vera!", "May I show you your room?", "Please follow me, Vera.", "Here we are."),
        met=("come Vera", "see Vera", "hear"),
        at="room 1",
        seconds=(45, 90),
    ),
    "guided_tour": Case(
        world="hotel",
        done=("FindPerson Omar", "Say Follow me, please.", "Guide Omar corridor", "Say This is the corridor.",
              "Guide Omar dining room", "Say Breakfast is from seven to ten."),
        said=("Follow me, please.", "Please follow me, Omar.", "This is the corridor.", "Please follow me, Omar.",
              "Breakfast is from seven to ten."),
        at="dining room",
        seconds=(80, 240),
    ),
    "night_patrol": Case(
        world="night",
        done=("Ask What is the word?", "RaiseAlarm There is an intruder.", "Patrol store", "Patrol dining room",
              "Patrol kitchen", "Patrol reception", "Dock"),
        said=("What is the word?",),
        met=("see stranger", "hear", "call", "dock"),
        at="dock",
        seconds=(100, 160),
    ),
    "room_search": Case(
        world="hotel",
        done=("LookForObject key", "Take key reception", "Say Here is the key."),
        said=("Here is the key.",),
        met=("see key", "grasp key", "release key"),
        put={"key": "reception"},
        cells=20,
        seconds=(120, 250),
    ),
    "counting": Case(
        world="hotel",
        done=("GoTo store", "CountKind box", "Say {_1}", "TakePicture"),
        said=("There are 2 boxes in the store.",),
        met=("picture",),
        at="store",
        seconds=(30, 45),
    ),
    "medicine_round": Case(
        world="hotel",
        done=(
            "GoToPerson {patient}", f"Ask {{patient}} {_MEDICINE}", "Say Please take it now.", "Say Thank you.",
            "GoToPerson {patient}", f"Ask {{patient}} {_MEDICINE}", "Say Thank you.", "GoTo reception",
        ),
        said=(_MEDICINE, "Please take it now.", "Thank you.", _MEDICINE, "Thank you."),
        met=("ask", "hear"),
        at="reception",
        seconds=(390, 430),
    ),
    "delivery": Case(
        world="hotel",
        done=("WaitForWay 10", "AvoidZone wet floor", "PickUp parcel", "GoTo store", "PutDown parcel",
              "Say Delivered."),
        said=("Delivered.",),
        put={"parcel": "store"},
        seconds=(40, 60),
    ),
    "seek": Case(
        world="hide",
        done=("Say Three, two, one. I am coming!", "LookForPerson {player}", "GoToPerson {player}", "Say I see you!",
              "LookForPerson {player}", "GoToPerson {player}", "Say I see you!", "ComeBack"),
        said=("Three, two, one. I am coming!", "I see you!", "I see you!"),
        met=("see Nina", "see Omar"),
        cells=20,
        seconds=(200, 500),
    ),
}  # fmt: skip
"""Those with people in their worlds."""


def world_of(path: Path, text: str) -> str | None:
    """The world file that a mission names at its top, None for the one that ships."""
    named = re.search(r'^world "(.+)"$', text, re.MULTILINE)
    return str(path.parent / named[1]) if named is not None else None
