"""Reads the command line by the table of verbs, and prints its help."""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from collections.abc import Iterator, Sequence
from importlib import import_module
from itertools import takewhile

from btlang.cli.options import OneOf, Option, Verb
from btlang.cli.verbs import VERBS
from btlang.frontends.mission.reader import DEFAULT_PARSER
from btlang.text.formatting import joined
from btlang.text.output import WIDEST, columns, show
from btlang.vocabulary.shipped import ENGLISH

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, NoReturn

_ALIASES = {"-h": "help", "--help": "help", "--version": "version"}
_DEFAULTS: dict[str, Any] = {
    "as_mission": False,
    "keywords": [], "world": None, "parser": DEFAULT_PARSER, "include_root": None, "speed": "real", "format": "text",
    "main": "", "robot": "simulated", "over": None, "language": ENGLISH,
}  # fmt: skip
_NOT_GIVEN = object()


class _Help(argparse.HelpFormatter):
    """A formatter that asks for the width of the terminal only to print: argparse makes one for each option."""

    def __init__(self, prog: str) -> None:
        super().__init__(prog, width=WIDEST)

    def format_help(self) -> str:
        self._width = columns(80) - 2
        return super().format_help()


class OptionParser(argparse.ArgumentParser):
    """A parser whose errors are a line and a hint, and whose help ends with acts and examples."""

    def __init__(self, prog: str, verb: Verb | None = None, **options: Any) -> None:
        super().__init__(prog, formatter_class=_Help, **options)
        self._verb = verb
        self.set_defaults(refuse=self.refuse)  # ends with a usage error what only the handler can see to be wrong

    def format_help(self) -> str:
        """Return argparse's help, followed by acts and examples."""
        parts = [super().format_help()]
        if self._verb is not None and self._verb.acts:
            parts += ["\nacts:\n", *_act_lines(self._verb, columns(80) - 2)]
        if self._verb is not None and self._verb.examples:
            parts += ["\nexamples:\n", *(f"  {command}\n      {about}\n" for command, about in self._verb.examples)]
        return "".join(parts)

    def check_option(self, name: str) -> None:
        """Refuse an option that doesn't exist, before its value is taken for a file."""
        known = [option for action in self._actions for option in action.option_strings]
        if not any(option.startswith(name) for option in known):
            from btlang.text.spelling import misspelt

            near = misspelt(name, known)
            self.refuse(f"there's no option '{name}'", f"Did you mean: {near[0]}" if near else "")

    def error(self, message: str) -> NoReturn:
        if (
            self._verb is not None
            and self._verb.acts
            and message.startswith("the following arguments are required: ACT")
        ):
            message = f"say what to do: {', '.join(self._verb.acts)}"
        self.refuse(message)

    def refuse(self, message: str, hint: str = "") -> NoReturn:
        """End the command with exit code 2, after a line that says what is wrong and one that says what to do."""
        hint = hint or f"Run 'btc help{self.prog.removeprefix('btc')}' for help."
        self.exit(2, f"{self.prog}: {message}\n{hint}\n")

    def _print_message(self, message: str, file: Any = None) -> None:
        show(message, sys.stderr if file is None else file, end="")


def _act_lines(verb: Verb, width: int) -> Iterator[str]:
    import textwrap

    column = max(map(len, verb.acts)) + 4
    for name, act in verb.acts.items():
        yield (
            textwrap.fill(
                ": ".join(act.explain(verb.name, name)),
                width,
                initial_indent=f"  {name:{column - 2}}",
                subsequent_indent=" " * column,
            )
            + "\n"
        )


def parse_arguments(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Read the command line. Only the options of its verb are made: making all takes a tenth of `btc check`.

    Without a verb, `btc` is the prompt, `btc FILE` and `btc "MISSION"` run a mission. A usage error is a line and a
    hint on standard error, and the exit code 2.
    """
    verb, *words = _with_verb(sys.argv[1:] if arguments is None else list(arguments))
    parser = verb_parser(VERBS[verb])
    for word in takewhile(lambda word: word != "--", words):
        if word.startswith("--") and " " not in word:
            parser.check_option(word.partition("=")[0])
    read = parser.parse_known_intermixed_args if VERBS[verb].mixed else parser.parse_known_args
    options, unknown = read(words)
    if unknown:
        parser.refuse(f"unexpected argument '{unknown[0]}'")
    return options


def print_help(options: argparse.Namespace) -> int:
    """Print the help of a verb, or that of `btc`. Ends with a usage error if there's no such verb."""
    verb = options.subject
    if verb is None:
        _main_parser().print_help()
    elif verb in VERBS:
        verb_parser(VERBS[verb]).print_help()
    else:
        near, said = _near_verbs(verb), f"Words of missions: btc words {shlex.quote(verb)}"
        hint = f"Did you mean: btc help {near[0]}" if near else ""
        _main_parser().refuse(f"there's no verb '{verb}'", "\n".join(filter(None, (hint, said))))
    return 0


def verb_parser(verb: Verb) -> OptionParser:
    """Make the parser of one verb."""
    parser = OptionParser(f"btc {verb.name}", verb, usage=verb.usage)
    parser.set_defaults(**_DEFAULTS, verb=verb.name)
    needs_act = bool(verb.acts)
    for each in verb.options:
        group: Any = parser.add_mutually_exclusive_group(required=each.required) if isinstance(each, OneOf) else parser
        for option in each.options if isinstance(each, OneOf) else (each,):
            if needs_act and not option.names[0].startswith("-"):
                _add_act(parser, verb)
                needs_act = False
            group.add_argument(*option.names, **_settings(option))
    if any(act.options is not None for act in verb.acts.values()):
        _note_given(parser)
    return parser


def _add_act(parser: OptionParser, verb: Verb) -> None:
    usual: dict[str, Any] = {"nargs": "?", "default": verb.usual_act} if verb.usual_act else {}

    def act(text: str) -> str:
        if text not in verb.acts:
            near = _near_acts(verb, text)
            parser.refuse(f"there's no act '{text}'", f"Did you mean: btc {near[0]}" if near else "")
        return text

    parser.add_argument("act", type=act, metavar="ACT", help="what to do: see below", **usual)


def _near_acts(verb: Verb, text: str) -> list[str]:
    """List acts that somebody may mean, the likeliest first, each with its verb."""
    from btlang.text.spelling import respellings

    word = text.lower()
    found = [verb.name + " " + name for name, each in verb.acts.items() if word == name or word in each.also]
    found += [f"{verb.name} {name}" for name in respellings(word, verb.acts) if name in verb.acts]
    found += [f"{other.name} {word}" for other in VERBS.values() if word in other.acts and other is not verb]
    return found + [word] * (word in VERBS)  # `btc task watch 1`


def _settings(option: Option) -> dict[str, Any]:
    """Import the choices of an option that are named, and list them in its help."""
    choices = option.settings.get("choices")
    if not isinstance(choices, str):
        return option.settings
    module, _, name = choices.partition(":")
    found = list(getattr(import_module(module), name))
    return option.settings | {"choices": found, "help": option.settings["help"].replace("{choices}", ", ".join(found))}


def _main_parser() -> OptionParser:
    usage = 'btc [VERB] [OPTION ...]\n       btc FILE|"MISSION" [OPTION ...]   as with the verb run'
    about = "Compiles and runs robot missions in plain English. 'btc help VERB' lists the options of a verb."
    parser = OptionParser("btc", usage=usage, description=about, add_help=False)
    groups = {title: parser.add_argument_group(title) for title in dict.fromkeys(verb.group for verb in VERBS.values())}
    for verb in VERBS.values():
        groups[verb.group].add_argument(verb.name, help=verb.about)
    return parser


def _with_verb(words: list[str]) -> list[str]:
    """Add the verb that was left out. Ends with a usage error if it's rather a mistyped one."""
    if not words:
        return ["repl"]
    first = _ALIASES.get(words[0], words[0])
    if first in VERBS:
        return [first, *words[1:]]
    if first in ("-", "-c") or os.path.exists(first):
        return ["run", *words]
    near = _near_verbs(first) or _acts_called(first)
    if first.isidentifier() and import_module("btlang.cli.examples").path_of(first):
        near = [f"run {first}"]
    is_alone = len(words) == 1 or words[1].startswith("-")
    mission = " ".join(words)
    _refuse_stop(" ".join(takewhile(lambda word: not word.startswith("-"), words)))
    if first.startswith("-"):
        _main_parser().refuse(f"unexpected option '{first}'", f"A verb comes first: btc VERB {shlex.join(words)}")
    if is_alone and (looks_like_path(first) or not near or reads_as_mission(first)):
        return ["run", *([] if looks_like_path(first) else ["-c"]), *words]
    meant = near[0].split() if near else []
    rest = [word for word in words[1:] if word not in meant]  # `btc start robot`
    others = [f"btc {each}" for each in near[1:] if each.split()[1:] == [first]] if len(words) == 1 else []
    hint = f"Did you mean: {joined([f'btc {shlex.join((*meant, *rest))}', *others], 'or')}" if near else ""
    if not is_alone and reads_as_mission(mission):
        hint = f"Put a mission in quotes: btc {quote_mission(mission)}"
    return _main_parser().refuse(f"there's no verb or file '{first}'", hint)


def _refuse_stop(text: str) -> None:
    """End with a usage error if somebody wants to stop a robot, or to let it go on after a stop: a simulated mission
    that does would look the same.
    """
    word = "-".join(text.lower().rstrip("!. ").split())
    parser, hint = _main_parser(), "To stop the robot that is up: btc robot stop"
    if word in VERBS["robot"].acts["stop"].also and not reads_as_mission(text):
        parser.refuse(f"there's no verb or file '{text}'", hint)
    if word != "release" and "stop" not in word and "halt" not in word:
        return
    from btlang.task.commands.client import names_up

    if not names_up():
        return
    if word == "release":
        hint = "To let the robot that is up move again: btc robot release"
        parser.refuse(f"'{text}' as a mission opens the gripper in a simulation", hint)
    if _only_stops(text):
        parser.refuse(f"'{text}' as a mission stops a simulation, not the robot that is up", hint)


def _only_stops(text: str) -> bool:
    from btlang.api import parse_tree
    from btlang.diagnostics.diagnostic import MissionError

    try:
        return parse_tree(text).tree.root.id == "Stop"
    except MissionError:
        return False


def _near_verbs(word: str) -> list[str]:
    """List verbs that somebody may mean, the likeliest first: another word for it, a plural, a misspelling."""
    from btlang.text.spelling import respellings

    found = [name for name, verb in VERBS.items() if word in verb.also or word == f"{name}s"]
    return found + [verb for verb in respellings(word, VERBS) if verb in VERBS]


def _acts_called(word: str) -> list[str]:
    """List the acts of this name, then those for which it is another word, each with its verb."""
    acts = [(verb.name, name, act) for verb in VERBS.values() for name, act in verb.acts.items()]
    found = [f"{verb} {name}" for verb, name, _ in acts if name == word]
    return found + [f"{verb} {name}" for verb, name, act in acts if word in act.also]


def looks_like_path(text: str) -> bool:
    """Return whether a text is meant as the path of a file, which may be missing."""
    return os.path.splitext(text)[1][1:].isalpha() or (os.sep in text and len(text.split()) == 1)


def reads_as_mission(text: str) -> bool:
    """Return whether a text is a mission in the words that ship."""
    from btlang.api import parse_tree
    from btlang.diagnostics.diagnostic import MissionError

    try:
        parse_tree(text)
    except MissionError:
        return False
    return True


def quote_mission(mission: str) -> str:
    """Quote a mission for a shell, with double quotes where these suffice."""
    return shlex.quote(mission) if set(mission) & set('"$`\\!') else f'"{mission}"'


def _note_given(parser: argparse.ArgumentParser) -> None:
    """Give options a default by which `check_act` sees which of them were given."""
    options = [action for action in parser._actions if action.option_strings and action.dest != "help"]
    flags = {action.dest: action.option_strings[-1] for action in options}
    for action in options:
        action.help = (action.help or "").replace("%(default)s", str(action.default))
    usual = {action.dest: action.default for action in options if not isinstance(action.default, list)}
    parser.set_defaults(**dict.fromkeys(usual, _NOT_GIVEN), usual=usual, flags=flags)


def check_act(options: argparse.Namespace) -> set[str]:
    """Refuse options and words that the act doesn't take (MissionError, BT198), and give the others their defaults.

    Returns the destinations of the options that were given. Only for verbs whose acts say what they take.
    """
    acts, found = VERBS[options.verb].acts, _take_given(options)
    act = acts[options.act]
    if act.options is not None and options.act != "stop":  # whatever else is typed: it stops
        for each, flag in options.flags.items():
            if each in found and each not in act.options and each != "name":
                from btlang.task.messages import wrong

                theirs = ", ".join(f"'{name}'" for name, other in acts.items() if each in (other.options or ()))
                raise wrong(options.act, f"{flag} doesn't apply to it{theirs and f', but to {theirs}'}")
    return found


def check_count(options: argparse.Namespace, given: int = 0) -> None:
    """Refuse more arguments than the act takes (MissionError, BT198). `given` of them were given as options."""
    most = VERBS[options.verb].acts[options.act].words - given
    if len(options.item) > most:
        from btlang.task.messages import wrong

        raise wrong(options.act, f"'{options.item[int(most)]}' is more than it takes")


def _take_given(options: argparse.Namespace) -> set[str]:
    found = {each for each in options.flags if each not in options.usual and getattr(options, each)}
    for each, default in options.usual.items():
        if getattr(options, each) is _NOT_GIVEN:
            setattr(options, each, default)
        else:
            found.add(each)
    return found
