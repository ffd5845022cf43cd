"""Wrong keyword files: each gets a coded error at load, whatever is wrong with it."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.api import parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.tree.dump import plain
from btlang.vocabulary.load import load_vocabulary

ACTION = '[[action]]\nphrase = "hop"\nid = "Hop"\n'


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[roles]\nthen = 5", "then in [roles] must be a list of phrases"),
        ('[roles]\nthen = "then"', "then in [roles] must be a list of phrases"),
        ('[roles]\nthen = ["then [x"]', "'[' without ']'"),
        (
            "[roles]\nthen.put = []",
            "then in [roles] must be a list of phrases, or a table with the lists add and remove",
        ),
        ('[roles]\nthen.add = "x"', "then in [roles] must be a list of phrases, or a table"),
        ('[roles]\nwait.add = ["linger"]', "must contain {duration}"),
        ('[roles]\nnode.remove = ["node"]', "no word is left of the role 'node'"),
        ("shipped = 1", "shipped is true or false"),
        ("yields = 1", "yields is true or false"),
        ('[roles]\nfoo = ["zork"]', "there is no role 'foo'"),
        ('[roles]\nwait = ["linger"]', "must contain {duration}"),
        ('[roles]\nwait = ["linger [{duration}]"]', "must contain {duration}"),
        ('[roles]\nthen = ["then {duration}"]', "must not contain a slot"),
        ('[counts]\nmany = "x"', "many in [counts] must be a whole number"),
        ("[counts]\nnone = 0", "none in [counts] must be a whole number"),
        ('[numbers]\neleventy = "x"', "eleventy in [numbers] must be a number"),
        ("[negations]\nis = 5", "is in [negations] must be a list"),
        ("[about]\nthen = 5", "then in [about] must be a table with the texts topic, help and example"),
        ('[about]\nthen = { topic = "x", help = "y" }', "then in [about] must be a table with the texts topic"),
        ('[about]\nthen = { topic = "x", help = "", example = "z" }', "then in [about] must be a table with the texts"),
        ('[about]\nfoo = { topic = "x", help = "y", example = "z" }', "there is no role 'foo'"),
        ("about = 5", "about must be a table: [about]"),
        ("numbers = 5", "numbers must be a table"),
        ("articles = 5", "articles must be a list of words"),
        ('[[type]]\nname = "t"\nunits = 5', "units and values of t must be lists"),
        ('[[type]]\nname = "t"\nvalues = 5', "units and values of t must be lists"),
        ('[[type]]\nname = "t"\nvalues = [{ name = "a", words = 5 }]', "the values of t"),
        ('[[type]]\nname = "t"\nleast = "x"', "least of t must be a number"),
        ('[[type]]\nname = "t"\nunits = [{ words = ["x"], factor = "1/0" }]', "a unit of t"),
        ('[[type]]\nname = "place"\nunits = [{ words = ["x"], factor = "1" }]', "with another kind"),
        ('[[action]]\nphrase = "hop"\nid = "AlwaysSuccess"', "is a node of the tree itself"),
        ('[[condition]]\nphrase = "hopped"\nid = "Wave"', "the id Wave is already that of the action"),
        ('[[quantity]]\nphrase = "load on {value}"\nid = "Load"\ntype = "length"', "every quantity has a port value"),
        ('[[quantity]]\nphrase = "load on {below}"\nid = "Load"\ntype = "length"', "every quantity has a port below"),
        (ACTION + "foo = 1\nbar = 2", "'foo' is not a key"),
        (ACTION + "thread = 1", "thread of 'hop' must be true or false"),
        (ACTION + 'thread = "yes"', "thread of 'hop' must be true or false"),
        (ACTION + "thread = true\ninstant = true", "'hop' can't be instant"),
        ('[[condition]]\nphrase = "hopped"\nid = "Hopped"\nthread = true', "'thread' is not a key of [[condition]]"),
        ('[[noun]]\ntype = "person"', '[[noun]] needs type = "person" and phrase'),
        ('[[noun]]\ntype = "person"\nphrase = "thing"', "the noun 'thing' needs slots such as {color}"),
        ('[[noun]]\ntype = "person"\nphrase = "{place} man"\nslots = { size = "text" }', "the noun '{place} man'"),
        ('[[noun]]\ntype = "person"\nphrase = "{place} man"\nfoo = 1', '[[noun]] needs type = "person" and phrase'),
        ("noun = 5", "noun must be written [[noun]]"),
        ("action = 5", "action must be written [[action]]"),
    ],
)
def test_wrong_file(text: str, reason: str, tmp_path: Path) -> None:
    file = tmp_path / "wrong.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(MissionError) as caught:
        parse_tree("wave", keywords=[str(file)])
    assert reason in str(caught.value)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (
            'units = [{ words = ["pct"], factor = "1" }]',
            "the type percent exists already, and here '100%', which Charge",
        ),
        (
            'units = [{ words = ["%"], factor = "1/100" }]\nleast = 50',
            "the type percent exists already, and here '100%'",
        ),
        ('values = ["5%"]', "the type percent already exists with another kind"),
    ],
)
def test_a_type_that_breaks_the_words_that_ship_is_to_blame(text: str, reason: str, tmp_path: Path) -> None:
    file = tmp_path / "own.toml"
    file.write_text(f'[[type]]\nname = "other"\n[[type]]\nname = "percent"\n{text}\n', encoding="utf-8")
    with pytest.raises(MissionError) as caught:
        parse_tree("wave", keywords=[str(file)])
    [problem] = caught.value.diagnostics
    assert (problem.code, problem.span.place) == ("BT060", f"{file}:4:9")
    assert reason in problem.message


@pytest.fixture(scope="module")
def of_units(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A keyword file with types that share units."""
    file = tmp_path_factory.mktemp("words") / "own.toml"
    file.write_text(
        '[[type]]\nname = "humidity"\nunits = [{ words = ["%", "percent"], factor = "1" }]\n'
        '[[type]]\nname = "ratio"\nunits = [{ words = ["%"], factor = "1/100" }]\n'
        '[[type]]\nname = "depth"\nunits = [{ words = ["mm"], factor = "1" }, { words = ["m"], factor = "1000" }]\n'
        '[[quantity]]\nphrase = "humidity"\ntype = "humidity"\nid = "Humidity"\n'
        '[[action]]\nphrase = "open valve to {ratio}"\nid = "OpenValve"\n'
        '[[action]]\nphrase = "dig {depth}"\nid = "Dig"\n',
        encoding="utf-8",
    )
    return str(file)


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("charge to 50%", "Charge percent=50"),
        ("check the humidity is above 50%", "Humidity above=50"),
        ("check the battery is above 50 percent", "Battery above=50"),
        ("open the valve to 50%", "OpenValve ratio=0.5"),
        ("dig 2 m", "Dig depth=2000"),
        ("move forward 2 m", "MoveForward distance=2"),
    ],
)
def test_types_share_units(text: str, tree: str, of_units: str) -> None:
    """The slot says which type is meant, so that a type with `%` leaves the battery alone."""
    for parser in ("shunting-yard", "lark"):
        assert plain(parse_tree(text, keywords=[of_units], parser=parser).tree) == tree
    used = parse_tree("set level to 50%. check humidity is above level. charge to level", keywords=[of_units])
    assert "Charge percent={level}" in plain(used.tree)


@pytest.mark.parametrize(
    "text",
    [
        '[[type]]\nname = "side"\nvalues = [{ name = "left", words = ["left", "port"] }]\n'
        '[[action]]\nphrase = "lean {side}"\nid = "Lean"\n[[action]]\nphrase = "lean port"\nid = "LeanPort"',
        ACTION.replace('"hop"', '"hop {count}"') + '[[action]]\nphrase = "hop two"\nid = "HopTwo"',
        ACTION.replace('"hop"', '"hop {text}"') + '[[action]]\nphrase = "hop high"\nid = "HopHigh"',
        ACTION.replace('"hop"', '"hop [high]"') + '[[action]]\nphrase = "hop/jump (high)"\nid = "Jump"',
    ],
)
def test_phrases_that_match_the_same_words(text: str, tmp_path: Path) -> None:
    file = tmp_path / "words.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(MissionError) as caught:
        parse_tree("wave", keywords=[str(file)])
    assert {problem.code for problem in caught.value.diagnostics} == {"BT062"}


def test_a_name_of_a_list_wins_over_a_text(tmp_path: Path) -> None:
    color = '[[action]]\nphrase = "hop {color}"\nid = "HopColor"\n'
    text = ACTION.replace("hop", "hop {text}")
    for at, words in enumerate((color + text, text + color)):
        file = tmp_path / f"words{at}.toml"
        file.write_text(words, encoding="utf-8")
        read = [parse_tree(f"hop {word}", keywords=[str(file)]).tree.root.id for word in ("blue", "high")]
        assert read[0] == "HopColor"
        assert read[1] != "HopColor"


def test_words_that_yield_leave_their_phrases_to_others(tmp_path: Path) -> None:
    mild, strict = tmp_path / "mild.toml", tmp_path / "strict.toml"
    mild.write_text(f"yields = true\n{ACTION.replace('hop', 'hop {text}')}", encoding="utf-8")
    strict.write_text('[[action]]\nphrase = ["hop high", "hop {text} today"]\nid = "Jump"\n', encoding="utf-8")
    for files in ([str(mild), str(strict)], [str(strict), str(mild)]):
        read = [parse_tree(text, keywords=files).tree.root.id for text in ("hop high", "hop low", "hop low today")]
        assert read == ["Jump", "Hop", "Jump"]
    own = parse_tree("hop high is wave; hop high", keywords=[str(mild)])
    assert own.warnings == ()


def test_words_that_yield_leave_their_ids_to_others(tmp_path: Path) -> None:
    pack = '[[action]]\nphrase = "ask {text}"\nid = "Ask"\ncall = "my_words:ask"\n'
    (tmp_path / "pack.toml").write_text(pack, encoding="utf-8")
    read = load_vocabulary([str(tmp_path / "pack.toml")]).entries["Ask"]
    assert [entry.call for entry in read] == ["my_words:ask"]


def test_one_phrase_may_deny_a_condition(tmp_path: Path) -> None:
    file = tmp_path / "words.toml"
    file.write_text(
        '[[condition]]\nphrase = "air is bad"\ndenied = "air is clean"\nid = "Bad"\ncall = "a:b"\n', encoding="utf-8"
    )
    root = parse_tree("check the air is clean", keywords=[str(file)]).tree.root
    assert [root.id, *(child.id for child in root.children)] == ["Inverter", "Bad"]


def test_a_byte_order_mark_is_fine(tmp_path: Path) -> None:
    file = tmp_path / "words.toml"
    file.write_text(ACTION, encoding="utf-8-sig")
    assert parse_tree("hop", keywords=[str(file)]).tree.root.id == "Hop"


def test_what_is_no_word_is_told() -> None:
    with pytest.raises(TypeError, match=r"btlang\.action"):
        parse_tree("wave", keywords=[print])


def codes(text: str, pack: str, folder: Path) -> list[str]:
    """What is wrong with a mission in the words of a pack."""
    file = folder / "pack.toml"
    file.write_text(pack, encoding="utf-8")
    try:
        parse_tree(text, keywords=[str(file)])
    except MissionError as error:
        return [problem.code for problem in error.diagnostics]
    return []


def test_words_are_added_to_a_role_and_taken_from_it(tmp_path: Path) -> None:
    pack = '[roles]\nthen.add = ["whereupon"]\nmeanwhile.remove = ["in meantime"]\n'
    assert codes("wave whereupon nod then say hi; wave meanwhile nod", pack, tmp_path) == []
    assert codes("wave. In the meantime, nod", pack, tmp_path) == ["BT013"]


def test_a_pack_without_the_shipped_words(tmp_path: Path) -> None:
    pack = "shipped = false\n" + ACTION
    assert codes("hop then wait 2 s, then hop 3 times", pack, tmp_path) == []
    assert codes("wave", pack, tmp_path) == ["BT010"]
    assert codes("check the battery is below 20%", pack, tmp_path) == ["BT010"]


def test_an_action_phrase_that_holds_the_word_is(tmp_path: Path) -> None:
    pack = '[[action]]\nphrase = "tell me what is on {text}"\nid = "Tell"\n'
    assert codes("tell me what is on desk then wave", pack, tmp_path) == []
    assert codes("tell me is wave; tell me", pack, tmp_path) == []
    assert codes("tell me what means wave; tell me what", pack, tmp_path) == []
