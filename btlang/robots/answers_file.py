"""Files with answers for `btc run --answers`: what is typed to each question."""

from __future__ import annotations

from btlang.robots.data_file import DataFileError, as_mission_error, load_data
from btlang.text.source import Source
from btlang.text.toml_table import Problem, Table


class AnswersError(DataFileError):
    """A file of answers that cannot be used."""

    code = "BT073"


def read_answers(file: str | Source) -> dict[str, list[str]]:
    """The answers by words of the question, "*" by any: `"coffee" = "yes"`, or a list of them one after the other.

    Raises MissionError (BT073).
    """
    try:
        return load_data(file, "answers", _answers, AnswersError)
    except AnswersError as error:
        raise as_mission_error(error) from None


def _answers(top: Table) -> dict[str, list[str]]:
    return {words: _texts(top, words) for words in top.keys()}  # noqa: SIM118 - it is no dict


def _texts(top: Table, words: str) -> list[str]:
    texts = list(top.texts(words)) if top.is_list(words) else [top.text(words)]
    if not texts:
        raise Problem(f'an answer is a text or a list of texts; write "{words}" = "yes"', words)
    return texts
