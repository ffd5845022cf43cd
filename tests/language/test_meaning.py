"""What verbs with roles, described things, sets and constraints mean: each row of meaning.txt, and back again."""

from __future__ import annotations

from pathlib import Path

import pytest

import btlang
from btlang.tree.dump import plain

HERE = Path(__file__).parent
WORLD = str(HERE / "meaning.toml")
PARSERS = ("shunting-yard", "lark")


def rows(file: str) -> list[tuple[str, str]]:
    """Two lines a row, a sentence (lines of it end in `\\n`) and its tree, with comments and empty lines between."""
    text = (HERE / file).read_text(encoding="utf-8").splitlines()
    lines = [line for line in text if line and not line.startswith("#")]
    return [(said.replace("\\n", "\n"), tree) for said, tree in zip(lines[::2], lines[1::2], strict=True)]


def in_one_line(mission: btlang.Mission) -> str:
    """The tree with a mark for each level."""
    return " | ".join(plain(mission.tree).replace("  ", ">").splitlines())


@pytest.mark.parametrize(
    ("sentence", "tree"),
    [
        *rows("meaning.txt"),
        *rows("said.txt"),
        *rows("users.txt"),
        *rows("chosen.txt"),
        *rows("outcomes.txt"),
        *rows("attempts.txt"),
        *rows("replies.txt"),
        *rows("times.txt"),
        *rows("waits.txt"),
    ],
    ids=lambda text: text,
)
def test_meaning(sentence: str, tree: str) -> None:
    missions = [btlang.parse_tree(sentence, world=WORLD, parser=parser) for parser in PARSERS]
    assert [in_one_line(mission) for mission in missions] == [tree.strip()] * 2
    for form in ("xml", "json", "english"):
        text = str(missions[0].to(form))
        assert btlang.parse_tree(text, world=WORLD).tree == missions[0].tree, text


@pytest.mark.parametrize(("sentence", "tree"), rows("spoken.txt"), ids=lambda text: text)
def test_numbers_that_are_said(sentence: str, tree: str) -> None:
    missions = [btlang.parse_tree(sentence, world=WORLD, parser=parser) for parser in PARSERS]
    assert [in_one_line(mission) for mission in missions] == [tree.strip()] * 2
    for form in ("json", "english"):
        assert btlang.parse_tree(str(missions[0].to(form)), world=WORLD).tree == missions[0].tree
    typed = btlang.parse_tree(str(missions[0].to("xml")), world=WORLD)
    assert btlang.parse_tree(str(typed.to("english")), world=WORLD).tree == typed.tree


@pytest.mark.parametrize(
    ("sentence", "code"),
    [
        ("go to the lab or avoid the hall", "BT155"),
        ("if nobody is near for 5 min, wave", "BT150"),
        ("tell Bob too", "BT159"),
        ("tell Bob about the book", "BT159"),
        ("tell Bob right away", "BT012"),
        ('ask the patient in the lab "Ok?"', "BT013"),
        ("go to every room three times and take a picture in every room", "BT151"),
        ("bring me the book from the lab. If it isn't there, look in the kitchen", "BT152"),
        ("ask Bob if he wants the cup or the book and bring it to him", "BT038"),
        ("pick up the book and put it down next to the cup", "BT010"),
        ("wave for more than 10 s", "BT150"),
        ("wait in the hall, then go to the lab", "BT012"),
        ("wait in the hall. If nobody comes, go to the lab", "BT012"),
        ("wait. Then wave", "BT012"),
        ("wait 5 s). If nobody comes, wave", "BT024"),
        ("go to the lab, charge first", "BT151"),
        ("careful is avoid the kitchen while Bob is there\ncareful", "BT152"),
        ("go to the lab, but stay out of the kitchen if Bob is in the kitchen", "BT151"),
        ("go to the lab and avoid the kitchen while Bob is in the kitchen", "BT151"),
        ("pick up the book. If you can't reach it, try again, max 3 times. Then wave", "BT151"),
        ("if bumped, pick up the book. If that fails, wave. Otherwise nod", "BT168"),
        ("dock. If that works, wave. If that fails, nod", "BT168"),
        ("ask Alice and Bob if they want tea. If not, wave", "BT144"),
        ('ask Bob "Tea?". If he says no, ask him again. If there is no answer, go to the lab', "BT144"),
        ('ask Bob "Tea?"; if the answer is no, wave and ask him "Why?"; if he doesn\'t answer, dock', "BT144"),
        ('ask everyone "Tea?". If so, wave', "BT144"),
        ('ask Alice "Tea?". Ask Bob "Tea?". If so, wave', "BT144"),
        ('go to every person and ask "Tea?". If so, wave', "BT144"),
        ('ask Alice "Tea?". If she says no, wave. Dock. If she doesn\'t answer, nod', "BT145"),
        ("ask Bob if he wants the cup or wave", "BT159"),
        ("ask Bob if he wants the book or the lab", "BT159"),
        ("set x to 1; add the cup to x", "BT039"),
        ("add 2 to x", "BT043"),
        ("whenever bumped, dock. Try it 3 times", "BT010"),
        ("try it twice", "BT010"),
        ("go to both rooms", "BT152"),
        ("charge until the morning", "BT160"),
        ("if bumped, look for the book. Pick it up. If you can't find it, wave", "BT168"),
        ("look for the book. If bumped, wave. If you can't find it, nod", "BT168"),
        ("go to the hall. Go to the lab and back", "BT012"),
        ("whenever bumped, go to the lab and back", "BT012"),
        ('pick up the book. Wave and say "Got it" if that worked', "BT168"),
        ("if bumped, stop. Then go to the lab", "BT151"),
        ("find the book and the red cup and bring them to Bob. If you can't find them, wave", "BT168"),
        ("look for Bob and Alice in the kitchen, then in the lab", "BT028"),
        ("seek is go to the lab and find the book, then bring it to Bob. If you can't find it, wave\nseek", "BT168"),
        ("report that lunch is ready to Bob", "BT159"),
        ("go to Bob and give him the book. If you can't reach Bob, go to Alice instead", "BT151"),
        ("go to the lab; on failure, go to the hall. In parallel, say hi every 10 s", "BT168"),
        ("whenever bumped, wave\nOtherwise go to the lab", "BT151"),
        ("go to the lab. If that fails, try again twice, and then wave", "BT151"),
        ("repeat: wave until bumped, at most 4 times", "BT151"),
        ("turn left up to 8 times until you see the book", "BT151"),
        ("wave or, if he doesn't answer, nod", "BT145"),
        ("go to the lab and the hall twice, and say hi in each room", "BT021"),
        ("pick up the book. If it is below 50%, wave", "BT010"),
        ("stay in the kitchen or the hall", "BT152"),
        ("don't enter the attic", "BT013"),
        ("Grab the mug and bring it to Bob", "BT013"),
        ("go to Bob and give him the trumpet", "BT013"),
        ("ask Bob if he can come and wave", "BT159"),
        ("ask Bob if he wants to sit and wave", "BT159"),
        ("go to the kitchen and the lab twice. In each room, look around and wave", "BT028"),
        ('ask Bob "Tea?". If he says no, ask again, at most 3 times. Otherwise wave', "BT151"),
        ('ask Bob "Tea?". If he says yes, nod. If he says no, ask again, at most 3 times', "BT151"),
        ('ask Bob "Tea?". If he says no, ask him again, up to 3 times. If he doesn\'t answer, wave', "BT144"),
        ("wave during the night", "BT160"),
        ("put the red cup in the box until it is full", "BT154"),
        ("keep asking Alice if she is ok until she says yes", "BT159"),
        ("wave at 8 am or 6 pm", "BT160"),
        ("wait until 8 am and 6 pm", "BT160"),
        ("go to the lab, then it", "BT010"),
        ("whenever the battery is low, dock. Then wave", "BT151"),
        ("whenever the battery is low, dock. Otherwise wave", "BT151"),
        ("wave. Whenever bumped, nod. Then dock", "BT151"),
        ("ask Alice if she is ok twice", "BT159"),
        ("tell Alice that lunch is ready twice", "BT159"),
        ("ask Alice when she comes if she wants tea", "BT159"),
        ("say it again", "BT159"),
        ("say again", "BT159"),
        ("ask maximum 3 times", "BT159"),
        ("go to all four rooms", "BT013"),
        ("go to the lab. Drive slowly. Go to the hall", "BT012"),
        ("wave between 9 am and noon", "BT010"),
        ("every day at 9 and 5 pm, wave", "BT160"),
        ("ask Bob again", "BT159"),
        ("go to the lab. If nobody is near, wave instead", "BT166"),
        ("wave no more than 2 times", "BT167"),
        ("go to the lab and wave at most 3 times", "BT167"),
        ("go to the lab because nobody is there", "BT165"),
        ("go to the lab because it is warm there and wave", "BT165"),
        ("I have lost my way", "BT164"),
        ("Bob is coming for tea", "BT164"),
        ("go to the lab. If you can't lift it, wave", "BT010"),
        ("in every room, pick up the red cup", "BT151"),
        ("go to every room. In every room, pick up the red cup", "BT151"),
        ("wait for Bob to pick up the book", "BT010"),
        ("get Bob to open the front door", "BT013"),
        ("go to the lab. If one is missing, skip it", "BT067"),
        ("ask me if she wants tea", "BT159"),
        ("ask me if she likes my book", "BT159"),
        ("at half past seven, wave", "BT160"),
        ("at quarter to five, wave", "BT160"),
        ('ask Alice and Bob "Tea?". If they say nothing, wave', "BT144"),
        ("go to the lab and the hall twice and wave in each", "BT151"),
        ('ask Bob and Alice "Tea?". If they do not answer, wave', "BT144"),
        ('ask Bob "Tea?". If he says yes, nod. If he doesn\'t answer, wait 5 min and ask again', "BT152"),
        ("look for the book and in the lab and the hall", "BT028"),
        ('ask Bob "Tea?". If he says no, ask him again, up to 3 times, otherwise wave', "BT151"),
        ("do frobnicate the gizmo", "BT010"),
        ("say so", "BT159"),
        ('ask Alice and Bob "Tea?", then say the answer', "BT144"),
        ('go to Alice and Bob and ask each of them "Tea?". Then tell me what they said', "BT144"),
        ("do the round", "BT010"),
        ("ask Bob if the man who is tall is ready", "BT159"),
        ("wave through the door", "BT179"),
        ("put the book on the table and the red cup", "BT019"),
        ("put the book in the box and the red cup", "BT019"),
        ("pick up the book on the table and the red cup and put them in the box", "BT038"),
        ("pick up all plates except the nearest plate", "BT152"),
        ("pick up the shiny cup", "BT013"),
        ("pick up the big and red cup", "BT013"),
        ("go to the dirty room", "BT178"),
        ("pick up one", "BT011"),
        ("pick up not the red plate", "BT012"),
        ("close the open door", "BT013"),
        ("bring me some plates", "BT013"),
        ("pick up and bring the cup and the book to Alice", "BT012"),
        ("pick up and look at it", "BT012"),
        ("pick up the big one", "BT013"),
        ("move forward for 10 s or 2 m", "BT019"),
        ("wave when you arrive", "BT156"),
        ("go to the lab. Once you get to the hall, wave", "BT156"),
        ("If bumped, go to the lab. When you arrive, wave", "BT156"),
        ("whenever you see someone, go to the lab. Wave when you arrive", "BT156"),
        ("find Alice or find Bob. Follow them", "BT038"),
        ("say the picture", "BT157"),
        ("ask Alice if bumped", "BT159"),
        ("tell Alice that she is late", "BT159"),
        ("tell Alice that tea can wait and wave", "BT159"),
        ("there are two books near the lab", "BT164"),
        ("I am not hungry, wave", "BT010"),
        ("whenever you see someone, wave at them. Follow them", "BT038"),
        ("tell me if the kitchen door is open", "BT151"),
        ("tell Bob if Alice is in the lab", "BT151"),
        ("don't go into the kitchen while anybody is in there. Otherwise wave", "BT151"),
        ("go to the lab from nine to ten", "BT160"),
        ("go from", "BT012"),
        ("pick up the book. If the lamp is off, put it in the kitchen", "BT151"),
        ("pick up the book unless the battery is low; if so, charge", "BT151"),
        ("look for the book. If you can't find it after looking in every room, wave", "BT152"),
        ("ask Bob if he wants water three times", "BT159"),
        ("tell Bob that dinner is ready within one minute", "BT159"),
        ("go to Alice, then to Bob, and wave at each", "BT038"),
        ("go to the lab. Go to the hall. Wave in each", "BT038"),
        ("wait in the hall until the lab is empty", "BT010"),
        ("go to the lab, wave and say hello on the way", "BT179"),
        ("wave. Say hello on the way", "BT179"),
        ("go to the lab. If bumped, wave and start over", "BT067"),
        ("repeat 3 times: wave and start over", "BT067"),
        ("every 5 s, wave, 3 times every minute", "BT057"),
        ("make sure the kitchen door is closed", "BT151"),
        ("make sure that you are holding the book, then wave", "BT151"),
        ("if nobody is in the lab and the kitchen, wave", "BT151"),
        ("if Alice isn't in the lab and the kitchen, wave", "BT151"),
        ("go to the lab through a room", "BT013"),
        ("count the cups in the kitchen. If there are more than 3 people, wave", "BT150"),
        ("count the people in the kitchen. If there are more than 3 objects, wave", "BT150"),
        ('ask Bob "Tea?". If he says to wave, wave', "BT010"),
        ("wave. Do the same in the kitchen", "BT150"),
        ('every ten minutes ask Bob "Ready?", and as soon as he says no, wave', "BT151"),
        ("wait for Alice. When she comes, wave, and if she doesn't come, nod", "BT152"),
        ("take the red cups from the lab to the hall and the blue ones to the kitchen", "BT150"),
        ("whenever somebody is near, wave, up to five times", "BT150"),
        ("on Mondays, go to the lab", "BT160"),
        ("every Monday, go to the lab", "BT160"),
        ("if Bob is near, give him the cup. When he has it, wave", "BT010"),
        ("go to the lab, but not while Bob is in the kitchen", "BT151"),
        ("at noon: (wave except while the kitchen door is open)", "BT151"),
        ("count the cups in the lab every hour until 5 pm and tell Alice the count", "BT151"),
        ("find the first person who says yes and give her the cup", "BT010"),
        ("at 10 pm avoid the hall for 5 minutes", "BT161"),
        ("pick up the cup. If that fails, try again every minute until bumped", "BT152"),
        ("go to the lab. If that fails, try again for 10 minutes", "BT152"),
        ("go to the lab. If that fails, open the kitchen door and try again until bumped", "BT152"),
        ("pick up the cup. If that fails, wait 5 seconds and try again every minute, up to 4 times", "BT010"),
        ("wave whenever Bob is near, and nod", "BT037"),
        ("go to the lab and the hall and wave. Do the same in the kitchen", "BT150"),
        ("at half past nine go to the lab", "BT160"),
        ("go to the lab through that room", "BT013"),
    ],
)
def test_what_is_refused(sentence: str, code: str) -> None:
    for parser in PARSERS:
        with pytest.raises(btlang.MissionError) as refused:
            btlang.parse_tree(sentence, world=WORLD, parser=parser)
        assert refused.value.diagnostics[0].code == code


def test_what_only_permits_is_noted() -> None:
    mission = btlang.parse_tree("go to the lab. Then you may go to the hall.", world=WORLD)
    assert [warning.code for warning in mission.warnings] == ["BT176"]


@pytest.mark.parametrize(
    ("sentence", "owners"),
    [
        ("bring me my plate", []),
        ("look at her plate", ["her"]),
        ("go to Alice and Bob, then take her plate", ["her"]),
        ("go to my room, then to Bob's room", []),
        ("take my book to his room", ["his"]),
    ],
)
def test_an_owner_whom_nobody_knows_is_noted(sentence: str, owners: list[str]) -> None:
    mission = btlang.parse_tree(sentence, world=WORLD)
    assert [warning.span.text for warning in mission.warnings if warning.code == "BT177"] == owners


def test_nobody_owns_anything_where_the_world_does_not_say_so() -> None:
    mission = btlang.parse_tree("bring me my cup, then go to Alice's cup")
    assert [warning.span.text for warning in mission.warnings] == ["my", "Alice's"]
    assert "owner" not in plain(mission.tree)


@pytest.mark.parametrize(
    ("sentence", "readings"),
    [
        (
            "put the book on the table in the box",
            ["put the book that is on the table in the box", "put the book on the table that is in the box"],
        ),
        ("put the book that is on the table in the box", []),
        ("put the book on the table that is in the box", []),
        ("put the book on the table near the sink", []),
        ("take the book on the table to the box", []),
        ("bring the book on the table to Alice", []),
    ],
)
def test_two_goals_in_a_row_show_both_readings(sentence: str, readings: list[str]) -> None:
    mission = btlang.parse_tree(sentence, world=WORLD)
    twice = [warning for warning in mission.warnings if warning.code == "BT050"]
    assert [text for warning in twice for _, text in warning.readings] == readings
    trees = [plain(btlang.parse_tree(text, world=WORLD).tree) for text in readings]
    assert trees == [] or (trees[0] == plain(mission.tree) != trees[1])


@pytest.mark.parametrize(
    ("sentence", "kept"),
    [
        (
            "if bumped, wave. If someone is near, nod. Otherwise dock",
            "if bumped, wave. If someone is near, nod, otherwise dock",
        ),
        (
            "if the lamp is on, switch it off. If it's off, switch it on",
            "if the lamp is on, switch it off. Then if it's off, switch it on",
        ),
        ("look for Alice for 5 minutes", "repeat (look for Alice) for 5 minutes"),
        ("if Alice is near wave, and if Bob is near nod", "if Alice is near, (wave, and if Bob is near nod)"),
        ("wave, or nod if Alice is near", "wave, or (nod if Alice is near)"),
        ("wave, or nod unless Alice is near", "wave, or (nod unless Alice is near)"),
        ("try to wave, then dock", "try to (wave, then dock)"),
    ],
)
def test_sentences_that_exclude_one_another_and_searches_show_both_readings(sentence: str, kept: str) -> None:
    mission = btlang.parse_tree(sentence, world=WORLD)
    (warning,) = (warning for warning in mission.warnings if warning.code == "BT050")
    taken, other = (btlang.parse_tree(dict(warning.arguments)[key], world=WORLD) for key in ("taken", "other"))
    assert plain(taken.tree) == plain(mission.tree) != plain(other.tree)
    mended = btlang.parse_tree(kept, world=WORLD)
    assert (plain(mended.tree), list(mended.warnings)) == (plain(mission.tree), [])


def run(sentence: str) -> btlang.Outcome:
    """The outcome of a mission on the simulated robot."""
    return btlang.parse_tree(sentence, world=WORLD).run(speed="max")


def test_a_closed_zone_is_driven_round() -> None:
    through, around = run("go to the lab"), run("go to the lab without entering the hall")
    assert through.succeeded
    assert around.succeeded
    assert around.seconds > through.seconds


@pytest.mark.parametrize(
    ("sentence", "reason"),
    [
        ("go to the kitchen, then (go to the hall without leaving the kitchen)", "outside the kitchen"),
        ("go to (10, 5) without entering the hall", "where the robot may not go"),
        ("pick up the red cup in the hall", "I know no red cup in the hall"),
        ("pick up three cups", "3 are needed"),
        ("look at every book near Alice", "book near Alice"),
        ("bring Alice my book", "a book that belongs to you"),
        ("pick up Bob's plate", "plate that belongs to Bob"),
        ("pick up the dirty blue plate", "dirty blue plate"),
        ("look at the plate on the small plate", "plate on the small plate"),
    ],
)
def test_what_cannot_be_done_says_why(sentence: str, reason: str) -> None:
    outcome = run(sentence)
    assert not outcome.succeeded
    assert reason in outcome.why()


def test_zones_open_again_however_their_statement_ends() -> None:
    assert run("try (go to (10, 5) without entering the hall). Go to the hall.").succeeded
    assert run("(go to the lab without entering the hall) within 1 s if possible. Go to the hall.").succeeded


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("nod; wave until you can see Alice", "SeesPerson"),
        ("nod then stay with Bob", "Follow"),
        ("avoid the reading corner; wait 1 s; you may enter the reading corner", "OpenZone"),
        ("nod then wave or stay with Bob", "Wave"),
    ],
)
def test_what_sounds_like_a_permission_is_kept(text: str, tree: str) -> None:
    mission = btlang.parse_tree(text)
    assert tree in plain(mission.tree)
    assert "BT176" not in {warning.code for warning in mission.warnings}


@pytest.mark.parametrize("text", ["nod; if you are in the kitchen you may wave", "nod; if bumped, now you can wave"])
def test_what_is_permitted_after_a_condition_is_left_out(text: str) -> None:
    mission = btlang.parse_tree(text)
    assert plain(mission.tree).strip() == "Nod"
    assert [warning.code for warning in mission.warnings] == ["BT176"]


def test_what_describes_a_thing_is_no_definition() -> None:
    english = str(btlang.parse_tree("bring me a cup that isn't red; nod").to("english"))
    assert english.splitlines()[0] == "bring me cup that is not red"
