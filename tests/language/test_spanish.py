"""Missions in Spanish: the same trees as their English twins, with either parser; the other languages of a user."""

from __future__ import annotations

import shutil
import unicodedata
from pathlib import Path

import pytest

import btlang
from btlang.api import format_mission
from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.mission.completion.completer import completions
from btlang.frontends.mission.reader import PARSERS
from btlang.printer.mission import english
from btlang.repl.draft import MissionDraft
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.ros.mission.setup import Setup
from btlang.task.store.records import MissionText
from btlang.text.words import without_accents
from btlang.vocabulary.load import load_vocabulary
from btlang.vocabulary.shipped import ENGLISH, language_folder, languages

NAMES = """
[[type]]
name = "place"
open = true
values = [
    { name = "kitchen", words = ["cocina"] },
    { name = "lobby", words = ["vestíbulo"] },
    { name = "lab", words = ["laboratorio"] },
]

[[type]]
name = "object"
open = true
values = [{ name = "cup", words = ["taza"] }]
"""

TWINS = {
    "one command": ("Avanza 1,5 metros", "move forward 1.5 m"),
    "joined": (
        "¡Hola robot! Por favor, ve a la cocina, luego gira a la derecha media vuelta y saluda a Alice.",
        "Please go to the kitchen, then turn right half a full turn and wave at Alice.",
    ),
    "conditions": (
        "si la batería no está baja y hay alguien cerca, di hola_a_todos, si no, niega con la cabeza\n"
        "a menos que el camino esté libre, retrocede 20 cm a 0,2 m/s",
        "if the battery is not low and someone is near, say hola_a_todos, otherwise shake your head\n"
        "unless the path is clear, move backward 20 cm at 0.2 m/s",
    ),
    "names, forms and ports of nodes": (
        '"reparar", recuperando hasta 2 veces:\n  ve a la cocina\n  "pausa": espera 2 s\n'
        'siempre y cuando la batería no esté baja:\n  saluda\n'
        'haz plan route con {goal}, speed 2 a menos que "x > 1"',
        '"reparar", recovering up to 2 times:\n  go to the kitchen\n  "pausa": wait 2 s\n'
        'provided that the battery is not low:\n  wave\n'
        'do plan route with {goal}, speed 2 unless "x > 1"',
    ),
    "comparisons": (
        "espera hasta que la batería esté por encima del 30 %\n"
        "mientras la distancia por delante sea al menos 50 cm o la distancia a la cocina no sea menor que 2 m, "
        "avanza 30 cm",
        "wait until the battery is above 30%\n"
        "while the distance ahead is at least 50 cm or the distance to the kitchen is not below 2 m, "
        "move forward 30 cm",
    ),
    "verbs with roles in any order": (
        "lleva a Alice la taza\ntrae la taza a la cocina despacio\nve por el vestíbulo a la cocina\n"
        "regresa despacio al laboratorio por el vestíbulo\nbusca en la cocina la taza\n"
        "acompaña a Bob hasta el laboratorio\nconduce al laboratorio a Alice\ncolocar en la cocina la taza",
        "bring the cup to Alice\ntake the cup to the kitchen slowly\ngo to the kitchen through the lobby\n"
        "go to the lab through the lobby slowly\nlook for the cup in the kitchen\nfollow Bob to the lab\n"
        "guide Alice to the lab\nput the cup in the kitchen",
    ),
    "repeating": (
        "repite avanza 30 cm hasta que haya una pared delante\n"
        "asiente dos veces\nsaluda cada 2 s durante un minuto y medio\n"
        "intenta coger la taza hasta 3 veces, de lo contrario di \"no puedo\" y luego falla",
        "repeat move forward 30 cm until there is a wall in front\n"
        "nod twice\nwave every 2 s for one and a half minutes\n"
        "try to pick up the cup up to 3 times, otherwise say \"no puedo\" then fail",
    ),
    "blocks": (
        "en paralelo:\n  saluda\n  di hola durante 5 s\nprueba en orden:\n  recoge la taza en menos de 20 s\n  asiente",
        "in parallel:\n  wave\n  say hola for 5 s\ntry in order:\n  pick up the cup within 20 s\n  nod",
    ),
    "values": (
        "fija nivel a treinta; aumenta nivel en 2\nrecuerda la batería como energía\n"
        'di "{energía} por ciento" 3 veces\ncomprueba que la energía es más de 10 %',
        "set nivel to thirty; increase nivel by 2\nremember the battery as energía\n"
        'say "{energía} por ciento" 3 times\ncheck that the energía is over 10%',
    ),
    "sentences as people write them": (
        "La primera vez que la batería caiga por debajo del 20 %, di cansado\n"
        "Primero ve a la cocina, y mientras tanto di hola. Si eso falla, falla.\n"
        "En cuanto haya alguien cerca, saluda. Hazlo 2 veces más.\n"
        "Ve al laboratorio, pero detente cuando hayas chocado\n"
        "asiente 3 veces con 2 s de pausa\n"
        "A las 6 pm, saluda y luego espera hasta las 18:30\n"
        "haz lo siguiente:\n  asiente. Otra vez.",
        "The first time the battery falls below 20%, say cansado\n"
        "First go to the kitchen, and meanwhile say hola. If that fails, fail.\n"
        "As soon as someone is near, wave. Do it 2 more times.\n"
        "Go to the lab, but stop when bumped\n"
        "nod 3 times with 2 s in between\n"
        "At 6 pm, wave then wait until 18:30\n"
        "do the following:\n  nod. Again.",
    ),
    "everything": (
        "# Ronda de la casa\n"
        "saludo de {alguien} significa saluda a {alguien} y di \"Buenos días\"\n"
        "taller está en (1,5, 2) mirando a 90 grados\n"
        "siempre que la batería caiga por debajo del 20 %, conéctate a la base y luego carga\n"
        "para cada lugar en la cocina, el vestíbulo:\n"
        "  ve a {lugar} en menos de 1 min\n"
        "  saludo de Alice\n"
        "repite 2 veces:\n"
        "  ve al taller\n"
        "  en paralelo:\n"
        "    mira a la izquierda\n"
        "    di hola\n"
        "  vuelve al laboratorio, o si no di \"no llego\"\n"
        "si has chocado, retrocede, si no, espera 2 s",
        "# A round of the house\n"
        "saludo de {alguien} means wave at {alguien} and say \"Buenos días\"\n"
        "taller is at (1.5, 2) facing 90 degrees\n"
        "whenever the battery falls below 20%, dock then charge\n"
        "for each lugar in the kitchen, the lobby:\n"
        "  go to {lugar} within 1 min\n"
        "  saludo de Alice\n"
        "repeat 2 times:\n"
        "  go to the taller\n"
        "  in parallel:\n"
        "    look left\n"
        "    say hola\n"
        "  go to the lab, or else say \"no llego\"\n"
        "if bumped, move backward, otherwise wait 2 s",
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def names(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """A keyword file with Spanish words for names of the world."""
    path = tmp_path_factory.mktemp("names") / "nombres.toml"
    path.write_text(NAMES, encoding="utf-8")
    return [str(path)]


@pytest.mark.parametrize("parser", PARSERS)
@pytest.mark.parametrize(("spanish", "twin"), TWINS.values(), ids=TWINS)
def test_a_mission_and_its_english_twin_have_equal_trees(
    spanish: str, twin: str, parser: str, names: list[str]
) -> None:
    assert btlang.parse_tree(spanish, language="es", parser=parser, keywords=names).tree == btlang.parse_tree(twin).tree


@pytest.mark.parametrize("mission", [spanish for spanish, _ in TWINS.values()], ids=TWINS)
def test_accents_case_and_layout_do_not_matter(mission: str, names: list[str]) -> None:
    def tree(text: str) -> str:
        xml = btlang.parse_tree(text, language="es", keywords=names).to("xml")
        assert isinstance(xml, str)
        return without_accents(xml.lower())

    expected = tree(mission)
    bare = unicodedata.normalize("NFD", mission).replace("\u0301", "")
    for written in (bare, unicodedata.normalize("NFD", mission)):
        assert tree(written) == expected
    assert tree(format_mission(mission, language="es", keywords=names)) == expected


@pytest.mark.parametrize("mission", [spanish for spanish, _ in TWINS.values()], ids=TWINS)
def test_it_is_printed_in_spanish_and_read_back(mission: str, names: list[str]) -> None:
    vocabulary = world_vocabulary(names, language="es")
    parsed = btlang.parse_tree(mission, language="es", keywords=names)
    assert parsed.syntax is not None
    printed = english(parsed.syntax, vocabulary)
    again = btlang.parse_tree(printed, language="es", keywords=names)
    assert again.tree == parsed.tree
    assert english(again.syntax, vocabulary) == printed  # type: ignore[arg-type]
    assert parsed.to("english") == again.to("english")


def test_nearly_all_that_ships_can_be_said_in_spanish() -> None:
    """A new command may come without Spanish phrases: it is then said by its id."""
    spanish = load_vocabulary(language="es")
    assert spanish.entries.keys() == load_vocabulary().entries.keys()
    silent = {id for id, known in spanish.entries.items() if not any(entry.phrases for entry in known)}
    assert len(silent) < 10


def test_what_a_word_does_comes_from_the_english_entry() -> None:
    spanish, known = load_vocabulary(language="es"), load_vocabulary()
    for node_id, entries in known.entries.items():
        entry = spanish.entries[node_id][0]
        assert entry == entries[0].replace(phrases=(), quantity=(), verbs=(), example="")
        assert all(more.call == "" for more in spanish.entries[node_id][1:])
    assert spanish.types["speed"].least == known.types["speed"].least == 0.01
    assert btlang.parse_tree("avanza", language="es").tree == btlang.parse_tree("move forward").tree


def test_a_number_with_a_comma() -> None:
    lists = "para cada número en 1,2,3: di {número}"
    assert (
        btlang.parse_tree(lists, language="es").tree == btlang.parse_tree(lists.replace(",", ", "), language="es").tree
    )
    assert format_mission("avanza 1,5 m , luego saluda", language="es") == "avanza 1,5 m, luego saluda\n"
    with pytest.raises(MissionError):
        btlang.parse_tree("move forward 1,5 m")


def test_english_words_are_no_spanish(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "-c", "move forward 1 m", "--language", "es"]) == 2
    assert main(["check", "-c", "avanza 1 m"]) == 2
    capsys.readouterr()
    assert main(["check", "-c", "avanza 1 metro", "--language", "es"]) == 0


@pytest.mark.parametrize("verb", ["check", "tree", "run", "compile", "explain", "format"])
def test_verbs(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    options = {"run": ["--speed", "max", "--lines"], "compile": ["--to", "xml"]}.get(verb, [])
    assert main([verb, "-c", "saluda y luego asiente", "--language", "es", *options]) == 0
    out = capsys.readouterr().out
    said = {"check": "No problems found.", "compile": "<Wave/>", "run": "done   saluda", "explain": "read as: saluda"}
    assert said.get(verb, "saluda") in out


def test_the_words_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["words", "avanza", "--language", "es"]) == 0
    listed = capsys.readouterr().out
    assert "avanza [{distance}] [a {speed}]" in listed
    assert "0.5 m if left out" in listed
    assert "move forward" not in listed
    assert main(["words", "--language", "es"]) == 0
    assert "hasta que" in capsys.readouterr().out


def test_completion_offers_spanish_words() -> None:
    vocabulary = world_vocabulary(language="es")
    assert "avanza" in {option.text for option in completions("ava", vocabulary)}
    assert "kitchen" in {option.text for option in completions("ve a la ", vocabulary)}
    assert {"metros", "m"} & {option.text for option in completions("avanza 2 ", vocabulary)}
    assert not any(option.text.startswith("move ") for option in completions("mo", vocabulary))


def test_the_prompt_and_the_ros_node_read_it() -> None:
    draft = MissionDraft(language="es")
    draft.use_world(None)
    assert draft.compile("¡saluda!").mission.tree == btlang.parse_tree("wave").tree
    assert Setup(language="es").reader().read(MissionText("saluda")).tree == btlang.parse_tree("wave").tree


def test_a_slip_is_corrected_in_spanish(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "-c", "avansa 1 m, luego saluda", "--language", "es"]) == 2
    assert "Did you mean: avanza 1 m, luego saluda" in capsys.readouterr().err
    with pytest.raises(MissionError) as caught:
        btlang.parse_tree("nunca saluda", language="es")
    assert [problem.fix for problem in caught.value.diagnostics] == [None]


def test_an_unknown_language(capsys: pytest.CaptureFixture[str]) -> None:
    assert {"en", "es"} <= set(languages())
    for name in ("klingon", "", "../keywords"):
        assert main(["tree", "-c", "wave", "--language", name]) == 2
        told = capsys.readouterr().err
        assert f"BT065: There's no language called '{name}'." in told
        assert "en, es" in told


def test_a_folder_of_a_user(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "gallego"
    shutil.copytree(language_folder("es") or "", folder)
    phrases = folder / "phrases.toml"
    phrases.write_text('[phrases]\nWave = ["abanea", "abanea [a {person}]"]\nBattery = "enerxía"\n', encoding="utf-8")
    mission = btlang.parse_tree("abanea a Alice si la enerxía está por debajo del 20 %", language=str(folder))
    assert mission.tree == btlang.parse_tree("wave at Alice if the battery is below 20%").tree
    by_id = btlang.parse_tree('haz "Dock"', language=str(folder))  # what has no words there is said by its id
    assert by_id.tree == btlang.parse_tree("dock").tree
    assert str(by_id) == "Dock: Dock"
    assert "haz dock" in by_id.to("english")  # type: ignore[operator]
    assert main(["words", "--language", str(folder)]) == 0
    assert "node: Dock" not in capsys.readouterr().out
    (folder / "language.toml").write_text('language = "galego"\n[roles]\nthen = ["despois"]\n', encoding="utf-8")
    mixed = btlang.parse_tree("abanea despois abanea 3 times", language=str(folder))  # other roles keep English words
    assert mixed.tree == btlang.parse_tree("wave then wave 3 times").tree


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        ('[phrases]\nWavee = "abanea"', "no entry has the id 'Wavee'; similar: Wave"),
        ('[phrases]\nWave = "abanea {place}"', r"Wave has no slot \{place\}"),
        ('[phrases]\nWave = "abanea ["', r"'\[' without '\]'"),
        ("[phrases]\nWave = 3", "Wave in .phrases. is a phrase, a list of them, or a table with verb and roles"),
        ("[phrases]\nWave = []", "Wave in .phrases. is a phrase, a list of them, or a table with verb and roles"),
        ('[phrases]\nTake = { verb = "porta", role = {} }', "a table with verb and roles"),
        ('[phrases]\nTake = { verb = "porta", roles = { theme = "person" } }', r"Take has no slot \{person\}"),
        ('[phrases]\nTake = { verb = "porta", roles = { what = "object" } }', "has no role 'what'"),
        ("phrases = 3", "phrases is a table"),
        ("decimal_comma = 1", "decimal_comma is true or false"),
        ("[contractions]\nal = 3", "al in .contractions. must be a word"),
        ('[phrases]\nNod = "wave"', "can match the same words"),
    ],
)
def test_what_can_be_wrong_with_phrases(table: str, reason: str, tmp_path: Path) -> None:
    path = tmp_path / "more.toml"
    path.write_text(table, encoding="utf-8")
    with pytest.raises(MissionError, match=reason):
        load_vocabulary([str(path)])


def test_further_phrases_in_english(tmp_path: Path) -> None:
    path = tmp_path / "more.toml"
    path.write_text('[phrases]\nGoTo = "head over to {place}"\nBattery = "juice"\n', encoding="utf-8")
    said = btlang.parse_tree("head over to the lab if the juice is above 50%", keywords=[str(path)])
    assert said.tree == btlang.parse_tree("go to the lab if the battery is above 50%").tree
    path.write_text(
        '[phrases.Take]\nverb = "ferry"\nroles = { theme = "object", goal = { type = "place", words = ["to"] } }\n',
        encoding="utf-8",
    )
    for text in ("ferry the cup to the lab", "ferry to the lab the cup"):
        assert btlang.parse_tree(text, keywords=[str(path)]).tree == btlang.parse_tree("take the cup to the lab").tree
    assert ENGLISH == "en"
    said.run(speed="max")
