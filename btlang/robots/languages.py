"""The check that a robot's voice speaks the languages of a mission."""

from __future__ import annotations

from btlang.diagnostics.errors import MissionError
from btlang.robots.body import Body
from btlang.robots.needs import lack
from btlang.robots.voice_file import engine_of
from btlang.speech.engine import SpeechError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.tree.node import Node, Tree
    from btlang.vocabulary.lexicon import Lexicon

_TYPE = "spoken_language"
"""The type of slots for a language, such as "es"."""


def check_languages(body: Body, tree: Tree, vocabulary: Lexicon) -> None:
    """Raises MissionError with each language that the robot can't speak, at its first leaf (BT072).

    Those that only the run knows fail when it comes to them.
    """
    leaves: dict[str, Node] = {}
    for node in tree.walk():
        entry = vocabulary.entry(node.id)
        for slot in entry.slots if entry is not None else ():
            if slot.type == _TYPE and (language := node.port(slot.name)) and "{" not in language:
                leaves.setdefault(language, node)
    problems = []
    for language, node in leaves.items():
        try:
            engine_of(body, language)
        except SpeechError:
            problems.append(lack(body, [f'voice for the language "{language}"'], node))
    if problems:
        raise MissionError(problems)
