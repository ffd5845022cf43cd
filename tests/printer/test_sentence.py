"""Canonical English: it reads back to the same tree by both parsers, and is then said in the same words."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.mission.reader import read_mission
from btlang.passes import compile_mission
from btlang.printer.mission import english, lines_of
from btlang.printer.printer import Printer
from btlang.printer.sentence import PRINTERS, statements
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from btlang.tree import ast
from btlang.tree.dump import plain
from btlang.tree.node import Tree
from btlang.vocabulary.entry import Entry, SlotSpec
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.load import load_vocabulary
from tests.examples.cases import world_of
from tests.language import sentences
from tests.language.letters import letters, read
from tests.printer import trees
from tests.profiles import amount, cases, searches

PARSERS = ("shunting-yard", "lark")
BRACKETS = ("needed", "clear", "all")
ROOT = Path(__file__).parent.parent.parent
MISSIONS = sorted([*(ROOT / "examples").glob("*.txt"), *(ROOT / "tests" / "samples" / "good").glob("*.txt")])


def compiled(text: str, vocabulary: Lexicon, parser: str, name: str = "<text>") -> tuple[ast.Program, Tree]:
    """`name` is the file beside which included ones lie."""
    mission = read_mission(Source(text, name), vocabulary, parser).mission
    return mission, compile_mission(mission, vocabulary)


def keeps_its_tree(mission: ast.Program, vocabulary: Lexicon) -> None:
    """The property that everything hangs on."""
    tree = compile_mission(mission, vocabulary)
    for brackets in BRACKETS:
        text = english(mission, vocabulary, brackets=brackets)
        for parser in PARSERS:
            again, same = compiled(text, vocabulary, parser, mission.span.source.name)
            assert same == tree, f"{text}\n\n{plain(tree)}\n\n{plain(same)}"
            assert english(again, vocabulary, brackets=brackets) == text
            assert list(map(_placed, again.facts)) == list(map(_placed, mission.facts))


def _placed(fact: ast.Fact) -> tuple[object, ...]:
    return fact.name, fact.x, fact.y, fact.facing


@searches(20, 3000)
@given(st.one_of(sentences.missions, sentences.broken_missions()), st.booleans())
@example("repeat a until p 3t NL", False)
@example("try try a 3t otherwise b NL", True)
@example("( a and d ) or b NL", True)
@example("c and e NL", True)
@example("a and ( repeat b ) NL", True)
@example(
    "a then repeat : NL IN a NL DE NL otherwise : NL IN a then repeat : NL IN a NL DE NL otherwise a NL DE NL", False
)
def test_sentences_keep_their_tree(words: str, is_mixed: bool) -> None:
    try:
        mission = read(sentences.english(words), is_mixed=is_mixed)
    except MissionError:
        return
    keeps_its_tree(mission, letters(is_mixed))


@searches(8, 3000)
@given(trees.missions(), st.booleans())
@example(
    ast.Program(ast.Every("5", ast.Repeat("1", trees.phrase("u"), trees.SPAN), "", trees.SPAN), (), trees.SPAN), False
)
@example(ast.Program(ast.Try(trees.phrase("u"), trees.either("v", "w"), trees.SPAN), (), trees.SPAN), False)
@example(ast.Program(trees.and_remember("u"), (), trees.SPAN), False)
def test_syntax_trees_keep_their_tree(mission: ast.Program, is_mixed: bool) -> None:
    vocabulary = letters(is_mixed)
    try:
        compile_mission(mission, vocabulary)
    except MissionError:  # two that need the same part at the same time
        assert is_mixed
        return
    keeps_its_tree(mission, vocabulary)


@searches(10, 2000)
@given(trees.missions(), st.sampled_from([1, 20, 50]), st.sampled_from(BRACKETS))
def test_blocks_keep_the_tree(mission: ast.Program, width: int, brackets: str) -> None:
    tree = compile_mission(mission, letters())
    speaker = Printer(PRINTERS, letters(), mission.definitions, brackets)
    lines = [line for one in mission.definitions for line in lines_of(one, speaker, width, least=0)]
    for item, joined in statements(mission.body):
        lines += lines_of(item, speaker, width, joined, least=0)
    for parser in PARSERS:
        assert compiled("\n".join(lines), letters(), parser)[1] == tree, "\n".join(lines)


@cases("path", MISSIONS, usual=34, ids=lambda path: path.stem)
def test_missions_that_ship_keep_their_tree(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(path.parent)  # where it includes from
    text = path.read_text(encoding="utf-8-sig")
    vocabulary = world_vocabulary(world=world_of(path, text))
    keeps_its_tree(read_mission(Source(text, str(path)), vocabulary).mission, vocabulary)


def test_every_class_of_node_can_be_said() -> None:
    """A new class needs a function in PRINTERS."""
    assert set(PRINTERS) == {kind for kind in _subclasses(ast.Ast) if not kind.__name__.startswith("_")} - {ast.Program}


def _subclasses(kind: type[ast.Ast]) -> Iterator[type[ast.Ast]]:
    for inner in kind.__subclasses__():
        yield inner
        yield from _subclasses(inner)


def test_no_connective_stands_in_the_code() -> None:
    """The words come from the vocabulary: with other words other sentences."""
    words = load_vocabulary([Entry("action", "U", ("u",)), Entry("condition", "P", ("p",))])
    mission = read_mission(Source("if p, (u then u) 3 times otherwise u"), words).mission
    said = {"if": ["falls"], "then": ["danach"], "otherwise": ["sonst"], "count": ["{count} mal"]}
    loud = words.replaced(roles={**words.roles, **said})
    assert english(mission, loud) == "falls p, (u danach u) 3 mal sonst u"


SAID = [
    ("u, v and w", "u and v and w", "u and v and w"),
    ("u then v, and w", "(u then v) and w", "(u then v) and w"),
    ("u and v or w", "u and v or w", "(u and v) or w"),
    ("u or v, and w", "(u or v) and w", "(u or v) and w"),
    ("(u and v) and w", "(u and v) and w", "(u and v) and w"),
    ("(u and v) or w", "u and v or w", "(u and v) or w"),
    ("((u))", "u", "u"),
    ("w or u after v", "v\nw or u", "v\nw or u"),
    ("u thrice within half a minute", "u 3 times within 30 s", "(u 3 times) within 30 s"),
    ("u and v twice", "u and v 2 times", "u and (v 2 times)"),
    ("(u and v) once", "(u and v) once", "(u and v) once"),
    ("repeat u then v", "(u then v) forever", "(u then v) forever"),
    ("repeat u until p", "until p, u", "until p, u"),
    ("if p, u otherwise if q, v otherwise w", "if p, u otherwise if q, v otherwise w",
     "if p, u otherwise (if q, v otherwise w)"),
    ("if p, (if q, u) otherwise v", "if p, (if q, u) otherwise v", "if p, (if q, u) otherwise v"),
    ("u if p otherwise v", "if p, u otherwise v", "if p, u otherwise v"),
    ("u and v if p", "u and if p, v", "u and (if p, v)"),
    ("u if p, and v", "(if p, u) and v", "(if p, u) and v"),
    ("unless p or q, u then v", "unless p or q, u then v", "unless (p or q), (u then v)"),
    ("u until not p", "until not p, u", "until not p, u"),
    ("check p and not q", "check p and not q", "check (p and (not q))"),
    ("check not (p or q), and r", "check not (p or q) and r", "check ((not (p or q)) and r)"),
    ("try u then v up to 3 times", "retry u then v 3 times", "retry (u then v) 3 times"),
    ("try (u twice) 3 times", "retry (u 2 times) 3 times", "retry (u 2 times) 3 times"),
    ("retry u", "retry u forever", "retry u forever"),
    ("try u 3 times otherwise v", "retry u 3 times otherwise v", "try (retry u 3 times) otherwise v"),
    ("try u otherwise v or w", "try u otherwise v or w", "try u otherwise v or w"),
    ("try u otherwise (v or w)", "try u otherwise (v or w)", "try u otherwise (v or w)"),
    ("try (u twice) otherwise v", "try (u 2 times) otherwise v", "try (u 2 times) otherwise v"),
    ("try u then v", "(u then v) if possible", "(u then v) if possible"),
    ("u provided that p, q and r", "u provided that p and q and r", "u provided that (p and q and r)"),
    ("every 5 s, u", "u every 5 s", "u every 5 s"),
    ("after 5 s, u and v", "(u and v) after 5 s", "(u and v) after 5 s"),
    ("u for 5 s", "u for 5 s", "u for 5 s"),
    ("wait until p within 9 s", "wait until p within 9 s", "(wait until p) within 9 s"),
    ("do nothing; fail; pause for a second", "do nothing\nfail\nwait 1 s", "do nothing\nfail\nwait 1 s"),
    ("the big dance is u\nthe big dance", "big dance means u\nbig dance", "big dance means u\nbig dance"),
    ("(u then v)\nw", "(u then v)\nw", "(u then v)\nw"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "needed", "everywhere"), SAID, ids=[text for text, _, _ in SAID])
def test_said(text: str, needed: str, everywhere: str) -> None:
    mission = read(text)
    assert english(mission, letters()) == needed
    assert english(mission, letters(), brackets="all") == everywhere
    keeps_its_tree(mission, letters())


TRAPS = [
    "u 3 times is v\n(u) 3 times then u 3 times",  # a name that goes on where the command ends
    "what is this means u\nv then what is this",  # a name that would define
    "smile for 5 s is v\nsmile for 5 s then ((smile) for 5 s)",
    """say '"' then say "it's" then say '2m' then say 'is' then say then then wave then print a""",
    "wave then say is",
    'say "means" then wave',
    "wave and (next slide)",  # `and next` is a connective
    "wave then (wave and smile) then (wave) and smile",
    "check (that is red)",
    "give a hand then give two hands",
]


@pytest.mark.parametrize("text", TRAPS)
def test_phrases_that_run_into_each_other(text: str) -> None:
    """Where words would be read otherwise, brackets or quotes or `then` keep them apart."""
    own = [
        Entry("action", "NextSlide", ("next slide",)),
        Entry("action", "WaveSmile", ("wave and smile",)),
        Entry("action", "Smile", ("smile",)),
        Entry("condition", "Red", ("that is red",)),
        Entry("action", "Give", ("give {number} hand(s)", "give hand"), slots=(SlotSpec("number", "number", "1"),)),
        *(Entry("action", letter.upper(), (letter,)) for letter in "uv"),
    ]
    vocabulary = load_vocabulary(own)
    keeps_its_tree(read_mission(Source(text), vocabulary).mission, vocabulary)


def test_facts_come_first() -> None:
    text = "go to the big door then wave\nthe big door is at (3 m, -0.5) facing a full turn; hut is located at (1,2)"
    vocabulary = load_vocabulary()
    mission = read_mission(Source(text), vocabulary).mission
    said = "big door is at (3, -0.5) facing 360 degrees\nhut is at (1, 2)\ngo to big door\nwave"
    assert english(mission, vocabulary) == said
    keeps_its_tree(mission, vocabulary)


@pytest.mark.long
def test_depth_does_not_matter() -> None:
    node: ast.Ast = trees.phrase("u")
    for i in range(amount(2_000, 10_000)):
        node = ast.Chain(("sequence", "parallel")[i % 2], (node, trees.phrase("v")), True, trees.SPAN)
    mission = ast.Program(node, (), trees.SPAN)
    text = english(mission, letters())
    assert compiled(text, letters(), "shunting-yard")[1] == compile_mission(mission, letters())
    assert len(lines_of(node, Printer(PRINTERS, letters()), 100)) == 63  # as deep as blocks have room


def test_wrong_brackets_are_refused() -> None:
    with pytest.raises(ValueError, match="brackets"):
        english(trees.phrase("u"), letters(), brackets="some")


def test_a_part_of_a_mission() -> None:
    mission = read("u 3 times is v; if p, u 3 times")
    assert mission.body is not None
    assert english(mission.body, letters(), names=["u 3 times"]) == "if p, u 3 times"


def test_a_condition_is_never_a_block() -> None:
    """Also in the narrowest window: the lines of a block are commands."""
    text = "big dance means at least 1 of p and q\nif big dance, u"
    mission, _ = compiled(text, letters(), PARSERS[0])
    [definition] = mission.definitions
    printer = Printer(PRINTERS, letters(), mission.definitions)
    assert len(lines_of(definition, printer, 1, least=0)) == 1
