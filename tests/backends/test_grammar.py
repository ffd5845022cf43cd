"""Grammars for language models: what they make is read by both parsers, and they make every phrase and every form."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from btlang.api import parse_file, parse_tree
from btlang.backends.grammar.forms import FORMS
from btlang.backends.grammar.targets import GRAMMARS
from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.mission.reader import PARSERS, read_mission
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.load import vocabulary_with
from tests.backends.gbnf_sampler import Node, Sampler, accepts, read
from tests.made_once import made_once
from tests.profiles import amount

ROOT = Path(__file__).parents[2]
WORDS = world_vocabulary()
UNKNOWABLE = {
    "BT029": "`the robot holds the cup` alone says what it does",
    "BT044": "`ball` alone is a thing, behind `count` a kind of things",
    "BT050": "`look for Bob for 5 minutes` goes on when he is found",
    "BT139": "what is waited for is counted again",
    "BT140": "which half of the day a time is in",
    "BT141": "the zone of a side is said by the name of a place that is one",
    "BT146": "nothing counts before what was counted is asked for",
    "BT149": "nothing brings the robot to who is asked",
    "BT145": "nothing asks before `if she wants tea`",
    "BT144": "whose answer is meant",
    "BT162": "a place that is avoided and gone to",
    "BT052": "what comes before goes on for ever",
    "BT068": "a condition behind `when` is checked once",
    "BT150": "which of three things of a kind is the third",
    "BT151": "`make sure the door is closed` could close it",
    "BT156": "`when you've reached the dock` needs a journey that leads there",
    "BT059": "a rule may be among the commands that `start over` repeats",
    "BT160": "16:45 is in no morning",
    "BT163": "half turns are counted",
    "BT164": "15:27 is in no morning, so `this morning at 15:27` says nothing",
    "BT169": "a time comes on the next day",
    "BT171": "what follows `as soon as` waits, too",
    "BT175": "a round may fail",
    "BT176": "`or stay here` is permitted only",
    "BT172": "of several statements `start over` repeats all",
    "BT253": "a rule ends where nobody speaks",
    "BT254": "where somebody is may be known or not",
    "BT256": "a rule stops the robot only for a moment",
    "BT257": "a mission ends early",
}
"""What no grammar knows; few sentences may have it."""


_MAKERS = dict(GRAMMARS)


@cache
def grammar(to: str, language: str = "en") -> str:
    """Made by one of the processes that run tests: that of English takes three seconds."""
    return made_once(
        f"{language}.{to}", lambda: _MAKERS[to](WORDS if language == "en" else world_vocabulary(language=language))
    )


def gbnf() -> str:
    return grammar("gbnf")


@cache
def rules_of(language: str = "en") -> dict[str, Node]:
    """Those of the grammar in GBNF. Nobody changes them."""
    return read(grammar("gbnf", language))


def phrases() -> list[str]:
    """The rules of phrases: each ends in the number that the phrase has in its entry."""
    return [name for name in rules_of() if re.search(r"-\d+$", name) and not name.startswith(("beside-", "word-"))]


def codes(text: str, parser: str, language: str = "en") -> list[str]:
    try:
        return [problem.code for problem in parse_tree(text, parser=parser, language=language).warnings]
    except MissionError as error:
        return [problem.code for problem in error.diagnostics]


@pytest.mark.long
def test_both_parsers_read_what_the_grammar_makes() -> None:
    count = amount(950, 10_000)  # each sentence uses the rule that was used least: 920 use every phrase
    sampler = Sampler(rules_of(), seed=11)
    found: Counter[str] = Counter()
    for number in range(count):
        text = sampler.sentence()
        parsers = [*PARSERS][: 1 if number % amount(4, 1) else 2]
        first, *others = ([*dict.fromkeys(codes(text, parser))] for parser in parsers)
        assert all(other == first for other in others), text
        assert UNKNOWABLE.keys() >= set(first), text
        found.update(first)
    for of_mission in ("BT175", "BT149", "BT253", "BT254", "BT256", "BT146", "BT139", "BT145"):
        del found[of_mission]  # whether a round may fail, what a rule does, and what was done are no matter of words
    assert sum(found.values()) <= count / 20, found
    wanted = amount(1, 20)
    words = [name for name in sampler.rules if name.startswith("word-")]
    assert not [name for name in (*phrases(), *FORMS, *words) if sampler.used[name] < wanted and name != "mission"]


def test_every_phrase_and_every_form_has_a_rule() -> None:
    entries = [entry for entries in WORDS.entries.values() for entry in entries]
    actions = [phrase for entry in entries if entry.sort == "action" for phrase in entry.phrases]
    only_at_line_start = {phrase for phrase in actions if "is" in phrase.split()}
    said = [phrase for entry in entries for phrase in entry.phrases if phrase not in only_at_line_start]
    assert len(phrases()) == len(said)
    assert rules_of().keys() >= FORMS.keys() - {"mission"}


def test_every_role_that_can_stand_in_one_line_has_a_rule() -> None:
    elsewhere = {  # blocks, files, the words of other forms, what says nothing
        "following", "in_parallel", "in_order", "include", "here", "newline", "character",
        "giving",  # only words of others have outputs
        "may", "or_stay",  # what is permitted is left out
        "needs_world", "needs_words", "needs_robot", "politeness", "times_of_day", "never",
        "on_way", "on_way_to", "start_at", "wait_at", "back_and_forth", "rounds_of", "pictures_of",
        "received",  # behind what somebody is given
        "arrival", "arrival_at",  # about journeys, which no rule tells from others
        "any_time", "tries", "at_most", "up_to_times", "stop_after", "try_again", "if_unanswered",
        "if_one_fails", "instead", "between_times",
        "weekly",  # behind what a rule makes
        "ask_where", "ask_how_many", "ask_who", "there_are",  # their names are those of other commands
        "find_who", "find_where",
        "all_names", "nearest", "random", "largest", "smallest", "except",  # said as values
        "furthest", "leftmost", "rightmost", "speaking",
    }  # fmt: skip
    roles = {role.replace("_", "-") for role in WORDS.roles if role not in elsewhere}
    rules = rules_of().keys()
    assert not [role for role in sorted(roles) if not any(name.startswith(f"word-{role}") for name in rules)]


def test_no_rule_begins_with_itself() -> None:
    """llama.cpp refuses such a grammar."""
    rules = rules_of()
    firsts = {name: set(first_names(node)) for name, node in rules.items()}
    for _ in range(20):  # rules in each other
        firsts = {name: found.union(*(firsts[other] for other in found)) for name, found in firsts.items()}
    assert not [name for name, found in firsts.items() if name in found]


def first_names(node: Node) -> Iterator[str]:
    """The rules with which a right-hand side may begin."""
    if node.kind == "name":
        yield node.text
    for part in node.parts:
        yield from first_names(part)
        if node.kind == "joined" and part.kind not in "?*":
            return


def test_the_rules_of_the_page_are_real() -> None:
    page = (ROOT / "docs" / "language_models.md").read_text(encoding="utf-8")
    (shown,) = re.findall(r"^```gbnf\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    assert set(shown.splitlines()) <= set(gbnf().splitlines())


@pytest.mark.parametrize("to", ["gbnf", "ebnf"])
def test_every_rule_that_is_used_is_there(to: str) -> None:
    text = re.sub(r"\"(?:\\.|[^\"\\])*\"|'[^']*'|\[[^\]]*\]|#xA", " ", grammar(to))
    lines = [line.partition("::=") for line in text.splitlines()]
    defined = {head.strip() for head, _, _ in lines}
    used = {word for _, _, body in lines for word in re.findall("[a-z][a-z0-9-]*", body)}
    assert defined - used == {"root"}
    assert used <= defined


def test_words_of_keyword_files_and_worlds_are_in_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Also beside the words of Spanish, which are a sixth of those of English."""
    (tmp_path / "juggling.toml").write_text(
        '[[action]]\nid = "Juggle"\nphrase = "juggle with {object}"\ncall = "btlang.actions.speech:say"\n'
    )
    (tmp_path / "ring.toml").write_text('start = { x = 1, y = 1 }\nplaces = [{ name = "ring", x = 2, y = 1 }]\n')
    out = tmp_path / "mission.gbnf"
    words = ["--keywords", str(tmp_path / "juggling.toml"), "--language", "es"]
    assert main(["grammar", *words, "--world", str(tmp_path / "ring.toml"), "-o", str(out)]) == 0
    rules = out.read_text().splitlines()
    assert 'value-place ::= "ring"' in rules
    assert not any(line.startswith("juggle") for line in rules)  # there is nothing to juggle with
    assert main(["grammar", *words]) == 0
    assert 'juggle-1 ::= "juggle with " value-object\n' in capsys.readouterr().out


PLANNER = """
[[action]]
id = "ComputePath"
phrase = "compute path [to {goal}] [planned by {planner}] [trying {tries}] [kept as {path}] [worth {cost}]"
slots = {goal = "place", planner = "text", tries = "whole_number", path = "text", cost = "text"}
outputs = ["path", "cost"]
[[action]]
id = "MoveArm"
phrase = "reach for {goal} along {path}"
slots = {goal = "place", path = "text"}
outputs = ["path"]
[[type]]
name = "whole_number"
whole = true
"""


@cache
def planner_words() -> Lexicon:
    return vocabulary_with(Source(PLANNER)).with_names({"place": ("lab", "kitchen")})


@cache
def planner_rules() -> dict[str, Node]:
    return read(GRAMMARS["gbnf"](planner_words()))


def test_ports_behind_a_phrase_are_in_the_grammar_of_its_words() -> None:
    rules = planner_rules()
    assert "word-giving" in rules
    for line in (
        'compute path with "goal" "lab", "planner" "fast", "tries" 3 giving {path} giving {cost}',
        'compute path to lab called "n3"',
        'do "MoveArm" with "goal" "lab" giving {path}',
        'do move arm with "goal" "lab" giving {path}',
        "this mission is given {n1}\ncompute path to {n1}",
        "this mission is given {n1}, {n2}\ncompute path to {n2}",
    ):
        assert accepts(rules, line), line
        for parser in PARSERS:
            read_mission(Source(line), planner_words(), parser)
    for line in ("compute path giving {lab}", "compute path to {n1}", "compute path with lab", ""):
        assert not accepts(rules, line), line


@pytest.mark.parametrize(
    "node",
    [
        '<GoTo name="n3" place="lab"/>',
        '<MoveForward name="n3" distance="2"/>',
        '<GoTo place="{n1}"/>',
        '<PickUp object="{n1}"/>',
        '<MoveForward distance="{n1}"/>',
        '<Sleep msec="2000"/>',
        '<Say text="{n1}"/>',
        '<Wave name="n3"/>',
    ],
)
def test_the_grammar_makes_what_is_printed(node: str) -> None:
    xml = f'<root BTCPP_format="4"><BehaviorTree ID="r4">{node}</BehaviorTree></root>'
    text = str(parse_tree(xml).to("english"))
    said = "\n".join(line for line in text.splitlines() if not line.startswith("#:"))
    said = said.partition('"r4"\n')[2]  # a mission has one of both: a name or values from outside
    assert accepts(rules_of(), said), said


@pytest.mark.long
def test_nodes_with_ports_and_values_from_outside_can_run() -> None:
    sampler = Sampler(rules_of(), seed=5)
    rules = ("named", "further", "exact-ports", "given-values", "keyed-n1", "keyed-n2", "is-keyed-n2")
    for number in range(amount(70, 2000)):
        text = sampler.sentence(rules[number % len(rules)])
        for parser in PARSERS:
            try:
                mission = parse_tree(text, parser=parser)
                mission.check()
                found = mission.warnings
            except MissionError as error:  # `in the morning at 17:56`
                found = error.diagnostics
            assert UNKNOWABLE.keys() >= {problem.code for problem in found}, text


@pytest.mark.long
def test_missions_in_spanish_are_read() -> None:
    sampler = Sampler(rules_of("es"), seed=3)
    for _ in range(amount(100, 1000)):
        text = sampler.sentence()
        assert UNKNOWABLE.keys() >= set(codes(text, "lark", "es")), text


@cache
def schema() -> Any:
    made = json.loads(grammar("json-schema"))
    Draft202012Validator.check_schema(made)
    return Draft202012Validator(made)


def bare(document: dict[str, Any]) -> dict[str, Any]:
    """A tree without what is told about its text."""
    for tree in document["trees"]:
        for node in tree["nodes"]:
            for key in ("phrase", "sentence", "place"):
                node.pop(key, None)
    return document


@pytest.mark.parametrize("name", ["hello", "patrol", "tea_service", "guard_the_door", "opening_hours", "tidy_up"])
def test_trees_of_the_examples_fit_the_schema(name: str) -> None:
    mission = parse_file(str(ROOT / "examples" / f"{name}.txt"))
    document = bare(json.loads(str(mission.to("json"))))
    schema().validate(document)
    assert parse_tree(json.dumps(document)).tree.root == mission.tree.root


def one(node: dict[str, Any]) -> dict[str, Any]:
    return {"format": 1, "trees": [{"name": "", "nodes": [node]}], "models": []}


@pytest.mark.parametrize(
    "node",
    [
        {"id": "Fly"},
        {"id": "GoTo"},
        {"id": "GoTo", "ports": {"place": "moon"}},
        {"id": "GoTo", "ports": {"place": "lab", "speed": "1"}},
        {"id": "MoveForward", "ports": {"distance": "far"}},
        {"id": "Sleep", "ports": {"msec": "-1"}},
        {"id": "Sleep", "ports": {}},
        {"id": "Inverter"},
        {"id": "Inverter", "children": [1, 2]},
    ],
)
def test_what_cannot_run_does_not_fit_the_schema(node: dict[str, Any]) -> None:
    assert not schema().is_valid(one(node))


@pytest.mark.parametrize(
    "node",
    [
        {"id": "GoTo", "ports": {"place": "lab"}},
        {"id": "GoTo", "ports": {"place": "{goal}"}},
        {"id": "MoveForward"},
        {"id": "Say", "ports": {"text": "hello"}, "name": "first"},
        {"id": "Sleep", "ports": {"msec": "100", "_skipIf": "true"}},
    ],
)
def test_what_fits_the_schema_is_read(node: dict[str, Any]) -> None:
    schema().validate(one(node))
    parse_tree(json.dumps(one(node))).check()
