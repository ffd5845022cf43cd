"""The tables of a connective file: which there are, what each may hold, and what those of several files add up to."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping

from btlang.vocabulary.entry import COMPARISONS, About
from btlang.vocabulary.pattern import PatternError, Slot, forms, ways

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

CONNECTIVES = {
    "then": "sequence", "and": "and", "or": "fallback", "after": "sequence",
    "before": "sequence", "meanwhile": "parallel",
}  # fmt: skip
"""The roles that join commands, each with the operator of the chain that it makes; see `conjunctions.py` for "and"."""

GOES_ON = frozenset((
    "otherwise", "or", "if_fails", "if_one_fails", "if_unanswered", "meanwhile", "in_parallel", "if_works",
    "if_it_works", "in_any_case", "do_that", "repeat_that", "again", "stop_that",
))  # fmt: skip
"""The roles that don't begin a new statement: what they begin continues the statement before it."""

NO_PHRASES = frozenset((
    "define_strong", "define", "fact", "facing", "set_to", "by", "add_to", "subtract_from", "remember_as", "each_in",
    "called", "with", "giving", "node", "newline", "character", "main_name", "given", "here",
    "needs_world", "needs_words", "needs_robot", "all_names", "except", "nearest", "random", "largest",
    "smallest", "furthest", "speaking",
    "leftmost", "rightmost",
    "without_entering", "without_leaving", "may", "or_stay",
))  # fmt: skip
"""Roles whose words are looked for where definitions, facts and nodes are, and nowhere else."""

CHANGING = ("increase", "decrease")
"""Roles whose words change the value that is named behind them, wherever they are found."""

ASKING = (
    "journey", "search", "whereabouts", "whether", "any_place", "searching", "making_sure", "counting", "asking_be",
    "asking_do", "answers", "silence", "any_answer", "feeling", "there", "very", "states", "subject", "been", "towards",
    "going", "coming", "letting", "hours", "by_then", "time_is", "finding_out", "inspecting", "telling", "lasting",
    "whole", "located", "wishing", "wished", "fetching", "picturing", "begging", "contents", "yet", "finding",
    "getting", "bringing", "home", "pleading", "saying_that", "plea", "reminding", "hearing", "of_me", "politely",
    "doing_it", "doing_theirs", "one_doing", "doing_ours", "several_doing",
    "told_about", "what_is", "measuring", "selecting", "vacant", "surfaces",
    "reminder", "addressed", "informing", "informed", "staying", "resuming", "interrupting", "and_back",
    "if_yes", "if_no", "told_of", "standing", "able", "unable", "reaching", "finishing", "waiting", "apiece",
    "between_joint", "standing_verbs", "kept_up", "events", "duties", "reasons", "performing", "naming", "named_as",
    "in_turn", "any_day", "said_before", "any_of_them", "of_them", "indefinite", "no_thing", "those", "whichever",
    "pausing", "working", "stops", "at_least", "pairs", "telling_to", "says",
    "reporting", "told_pronouns", "replying", "missed", "outside", "at_once", "some_time", "judged",
    "until_none", "rounds", "obliging", "failing", "found", "counted", "replied",
    "so", "being", "counting_people", "counting_things", "what",
    "causing", "asking_for", "plea_for", "helping", "plea_for_help",
    "speaking", "spoken_of", "still", "motionless", "who", "somebody", "answering", "likewise",
    "foremost", "numbers", "in_all", "throughout", "postures", "opinions", "supposing", "rooms",
    "left_there", "inverted_if", "sorts_of_people", "remaining", "entering", "turning_to", "ended", "fewer", "having",
    "putting", "denied", "of_voice", "ending_well", "unsaid",
)  # fmt: skip
"""What the table `asking` of a language may have; without it there are no questions, and no remarks."""

QUESTIONS = ("ask_value", "ask_where", "ask_how_many", "ask_who", "find_who", "find_where")
"""The roles of words that begin questions; "there_are" are words that may end one."""

ORDER = (
    "arrival", "arrival_at", "on_way", "on_way_to", "start_at", "wait_at", "back_and_forth", "rounds_of", "pictures_of",
    "any_time", "tries", "received",
    "at_most", "up_to_times", "stop_after", "try_again", "weekly", "on_days", "instead", "between_times",
)  # fmt: skip
"""The roles of words about the order of commands."""

NOT_ALONE = frozenset(("ordinal", "keep", "fails", "there_are", "mind", *ORDER, *QUESTIONS))
"""The roles whose words are ordinary words everywhere but in one place."""

_NO_SLOT = (
    *CONNECTIVES, "if_fails", "if_one_fails", "if_unanswered", "otherwise", "if_works", "if_it_works", "in_any_case",
    "if", "unless", "while", "until", "whenever", "first_time", "as_soon_as", "once", "provided", "stop_when", "not",
    "but", "may", "or_stay",
    "either", "both", "neither", "nor", "not_both", "any_of", "all_of", "none_of", "one_of",
    "do_that", "repeat_that", "stop_that", "again", "start_over", "everything", "here", "ordinal", "following", "keep",
    "fails", "followed_by", "arrival", "received", "on_way", "on_way_to", "start_at", "wait_at", "back_and_forth",
    "any_time", "instead", "try_again",
    "there_are", "mind", *QUESTIONS,
    "repeat", "try", "retry", "if_possible", "wait_until", "wait_for", "wait_forever", "check", "nothing",
    "never", "fail",
    "in_parallel", "in_order",
    "define_strong", "define", "fact", "facing",
    "set", "set_to", "increase", "decrease", "by", "add", "add_to", "subtract", "subtract_from",
    "remember", "remember_as", "each", "each_in", "include",
    "do", "test", "called", "with", "giving", "node", "newline", "character", "main_name", "given",
    "needs_world", "needs_words", "needs_robot", "all_names", "except", "nearest", "random", "largest",
    "smallest", "furthest", "speaking",
    "leftmost", "rightmost",
)  # fmt: skip
ROLES = {
    **dict.fromkeys(_NO_SLOT, ""),
    **dict.fromkeys(("every", "delay", "for", "held", "up_to", "apart", "within", "wait", "wait_up_to"), "duration"),
    **dict.fromkeys(("without_entering", "without_leaving"), "zone"),
    **dict.fromkeys(("count", "tries", "at_most", "up_to_times", "stop_after", "rounds_of", "pictures_of"), "count"),
    **dict.fromkeys(("more", "at_least_of"), "count"),
    **dict.fromkeys(("arrival_at",), "place"),
    **dict.fromkeys(("weekly", "on_days"), "days time_of_day"),
    **dict.fromkeys(("at", "every_day", "until_time", "by_time", "wait_time", "between_times"), "time_of_day"),
}
"""The roles that words can have, each with the slot that its phrases hold."""
LISTED = {**dict.fromkeys(("at", "every_day", "weekly", "on_days"), "and"), "wait_time": "or"}
"""The roles whose slots take a list of values too, each with the role of the word that joins these."""

COMPARING = {**dict.fromkeys(COMPARISONS, "value"), "between": "low high"}
"""The ways to compare a quantity, each with the slots that its phrases hold."""

_UNEXPLAINED = ("never", "there_are", "may", "or_stay", "without_entering", "without_leaving")
EXPLAINED = (*(role for role in ROLES if role not in _UNEXPLAINED), "compare", "politeness")
"""The roles that the table `about` describes: all that can be said."""

SWITCHES = frozenset(("decimal_comma",))

WORD_LISTS = frozenset((
    "articles", "titles", "like_contractions", "plural_pronouns", "further", "politeness",
    "unit_joiner", "one_each", "every_second", "quantifiers",
    "halting", "asked_once", "relatives",
    "relative_denials", "particles", "fillers", "speaker", "subjects", "purpose", "determiners", "others",
    "denials",
    "possessive_endings", "ones", "directions", "clause_openers", "clause_words", "question_words", "inverting",
    "matters", "completed", "modals", "participles", "participle_endings", "sayings", "of_persons", "colored", "shapes",
    "belonging",
))  # fmt: skip


_NODE_DETAIL = re.compile(r"[^\W\d][^{}]*(\{=[^{}]+\})?")
_NODE_FORM = re.compile(r"[^\W\d][^{}]*(\{\w+(=[^{}]*)?\}[^{}]*)*")


def _words(value: object) -> bool:
    return isinstance(value, list) and all(isinstance(item, str) and item for item in value)


def _patterns(value: object) -> bool:
    return _words(value) and all(any(ways([pattern])) for pattern in value)  # type: ignore[attr-defined]


def _role(value: object) -> bool:
    """Its phrases, or a table of those that are added to it and taken from it."""
    if isinstance(value, dict):
        return bool(value) and value.keys() <= {"add", "remove"} and all(map(_words, value.values()))
    return _words(value)


def _endings(value: object) -> bool:
    return isinstance(value, list) and all(isinstance(item, str) for item in value)


def _between(value: object) -> bool:
    return value in CONNECTIVES


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= 1e6


def _rounds(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and (value >= 1 or value == -1)


def _time(value: object) -> bool:
    if isinstance(value, str):
        return re.fullmatch(r"([01]\d|2[0-3]):[0-5]\d", value) is not None
    return not isinstance(value, bool) and value in (0, 12)


def _ordinal(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value != 0


def _hour(value: object) -> bool:
    return not isinstance(value, bool) and value in range(24)


def _about(value: object) -> bool:
    return isinstance(value, dict) and value.keys() == set(About.fields) and all(map(_is_text, value.values()))


def _is_text(value: object) -> bool:
    return isinstance(value, str) and bool(value)


def _node_forms(value: object) -> bool:
    return _words(value) and all(_NODE_FORM.fullmatch(each) for each in value)  # type: ignore[attr-defined]


def _is_node_detail(value: object) -> bool:
    return isinstance(value, str) and _NODE_DETAIL.fullmatch(value) is not None


def _is_contracted(value: object) -> bool:
    return isinstance(value, str) and 1 <= len(value.split()) <= 2


TABLES: dict[str, tuple[Callable[[object], bool], str]] = {
    "roles": (_role, "a list of phrases, or a table with the lists add and remove"),
    "about": (_about, "a table with the texts topic, help and example"),
    "comparisons": (_words, "a list of phrases"),
    "negations": (_words, "a list of words"),
    "doing": (_endings, "a list of endings"),
    "third_person": (_endings, "a list of endings"),
    "negative_subjects": (_words, "a list of words"),
    "plurals": (_words, "a list of words"),
    "asking": (_patterns, "a list of patterns"),
    "nouns": (_words, "a list of words"),
    "plural_endings": (_is_text, "an ending"),
    "relations": (_words, "a list of phrases"),
    "qualities": (_words, "a list of phrases"),
    "relations_to_self": (_patterns, "a list of patterns"),
    "possessives": (_words, "a list of words"),
    "prepositions": (_words, "a list of phrases"),
    "synonyms": (_words, "a list of verbs"),
    "everyone": (_words, "a list of words"),
    "other_names": (_words, "a list of names"),
    "pronouns": (_words, "a list of types"),
    "meanings": (_between, "one of " + ", ".join(CONNECTIVES)),
    "nodes": (_is_text, "the words of a node"),
    "node_details": (_is_node_detail, "words, perhaps with a text that isn't said: {=text}"),
    "node_forms": (_node_forms, "a list of words, each perhaps with {port} or {port=text} behind a word"),
    "contractions": (_is_contracted, "a word, or two"),
    "direct": (_patterns, "a list of patterns"),
    "perfect": (_is_text, "another verb"),
    "of_robot": (_is_text, "other words"),
    "affirmed": (_is_text, "other words"),
    "happened": (_is_text, "other words"),
    "idioms": (_is_text, "other words"),
    "of_hearer": (_is_text, "another verb"),
    "persons": (_words, "a list of words"),
    "ordinals": (_ordinal, "a whole number, below 0 from the last one on"),
    "counts": (_rounds, "a whole number from 1 on, or -1 for endless"),
    "numbers": (_number, "a number"),
    "multipliers": (_number, "a number"),
    "fractions": (_number, "a number"),
    "clock": (_words, "a list of words"),
    "parts_of_day": (_hour, "an hour from 0 to 23"),
    "times": (_time, 'a time such as "12:00", or the hours to add: 0 or 12'),
}
"""Each table, whether a value fits it, and what does."""


def problems(table: str, value: Any) -> Iterator[tuple[str, str]]:
    """What is wrong with a table or word list of a file: (reason, text near it)."""
    if table == "language":
        if not isinstance(value, str):
            yield "language is a name", table
        return
    if table in SWITCHES:
        if not isinstance(value, bool):
            yield f"{table} is true or false", table
        return
    if table in WORD_LISTS:
        if not _words(value):
            yield f"{table} must be a list of words", table
        return
    fits, wanted = TABLES[table]
    if not isinstance(value, dict):
        yield f"{table} must be a table: [{table}]", table
        return
    for key, item in value.items():
        if not fits(item):
            yield f"{key} in [{table}] must be {wanted}", key
        elif table == "roles":
            yield from _phrase_problems("role", key, item.get("add", []) if isinstance(item, dict) else item, ROLES)
        elif table == "comparisons":
            yield from _phrase_problems("comparison", key, item, COMPARING)
        elif table == "about" and key not in EXPLAINED:
            yield f"there is no role '{key}'; there are {', '.join(EXPLAINED)}", key


def _phrase_problems(kind: str, name: str, phrases: list[str], known: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    if name not in known:
        yield f"there is no {kind} '{name}'; there are {', '.join(known)}", name
        return
    wanted = set(known[name].split())
    for phrase in phrases:
        try:
            slots = [{part.name for part in form if isinstance(part, Slot)} for form in forms(phrase)]
        except PatternError as error:
            yield str(error), phrase
            continue
        if any(found != wanted for found in slots):
            need = (
                f"must contain {' and '.join(f'{{{slot}}}' for slot in sorted(wanted, reverse=True))}, not in brackets"
            )
            yield f"a phrase of the {kind} {name} {need if wanted else 'must not contain a slot'}: '{phrase}'", phrase


_LANGUAGE: dict[str, Any] = {
    "language": "", "decimal_comma": False,
    "articles": [], "titles": [], "like_contractions": [], "plural_pronouns": [], "further": [],
    "politeness": [], "unit_joiner": [], "one_each": [],
    "every_second": [],
    "quantifiers": [], "halting": [], "asked_once": [], "relatives": [], "relative_denials": [], "relations": {},
    "qualities": {},
    "relations_to_self": {},
    "determiners": [], "others": [], "denials": [], "possessive_endings": [], "ones": [], "directions": [],
    "clause_openers": [], "clause_words": [], "question_words": [], "inverting": [], "matters": [], "belonging": [],
    "completed": [],
    "modals": [], "participles": [], "participle_endings": [], "sayings": [], "of_persons": [],
    "colored": [], "shapes": [],
    "possessives": {"speaker": [], "others": []},
    "prepositions": {}, "synonyms": {}, "particles": [], "fillers": [], "speaker": [], "subjects": [], "purpose": [],
    "roles": {}, "contractions": {}, "about": {}, "comparisons": {}, "ordinals": {}, "counts": {}, "negations": {},
    "doing": {}, "affirmed": {},
    "third_person": {}, "direct": {}, "perfect": {}, "of_robot": {}, "happened": {}, "of_hearer": {}, "persons": {},
    "idioms": {},
    "negative_subjects": {}, "plurals": {}, "asking": {}, "plural_endings": {}, "nouns": {}, "everyone": {},
    "other_names": {},
    "pronouns": {}, "nodes": {}, "node_details": {}, "node_forms": {}, "meanings": {}, "numbers": {},
    "multipliers": {}, "fractions": {},
    "times": {},
    "parts_of_day": {}, "clock": {},
}  # fmt: skip


def merged(tables: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """The language tables of all files; a later file replaces, or changes, single roles and words of an earlier one."""
    found = {key: type(value)(value) for key, value in _LANGUAGE.items()}
    for table in tables:
        for key, value in table.items():
            if key == "roles":
                found[key] |= {role: _changed(found[key].get(role, []), words) for role, words in value.items()}
            elif isinstance(value, dict):
                found[key] |= value
            else:
                found[key] = value
    return found


def _changed(phrases: list[str], words: list[str] | dict[str, list[str]]) -> list[str]:
    if isinstance(words, list):
        return words
    kept = [phrase for phrase in phrases if phrase not in words.get("remove", ())]
    return [*kept, *(phrase for phrase in words.get("add", ()) if phrase not in kept)]


def about_roles(tables: Iterable[Mapping[str, Any]], known: Mapping[str, About]) -> dict[str, About]:
    """What the tables say of the roles, the latest of each; a role with new words loses its example in old ones."""
    about: dict[str, About] = {role: each.replace(example="") for role, each in known.items()}
    for table in tables:
        described = table.get("about", {})
        others = (
            role for role, words in table.get("roles", {}).items() if isinstance(words, list) or "remove" in words
        )
        replaced = [role for role in others if role in about and role not in described]
        about |= {role: about[role].replace(example="") for role in replaced}
        about |= {role: About(**keys) for role, keys in described.items()}
    return about | {role: About() for role in EXPLAINED if role not in about}


def comparing_phrases(name: str, patterns: Iterable[str]) -> list[str]:
    """The words of a comparison with the names of ports in their slots."""
    ports = {"value": name, "low": "at_least", "high": "at_most"}
    return [re.sub(r"\{(\w+)\}", lambda slot: f"{{{ports[slot[1]]}}}", pattern) for pattern in patterns]
