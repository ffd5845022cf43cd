"""Makes the generated part of docs/cli.md from the parsers that `btc help` prints."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from btlang.cli.options import Verb
from btlang.cli.parser import verb_parser
from btlang.cli.verbs import VERBS

PAGE = Path(__file__).parent.parent / "docs" / "cli.md"
MARK = "<!-- Made by `python -m tests.generate` from here on. -->\n"
SHARED = 3
"""Verbs that have an option with the same help, at least, for it to be described once for all of them."""
_UNTESTED = (
    "repl",
    "diff",
    "edit",
    "lsp",
    "watch",
    "serve",
    "mcp",
    "sim-ros",
    "ros-node",
    "ros-devices",
    "serve-actions",
)
"""Verbs whose examples wait for somebody, need ROS 2 or exit with 1: tests/test_readme.py runs all others."""
_PAGES = {
    "run": ("page.md", "worlds.md", "recording.md", "robots.md", "ros.md"),
    "replay": ("recording.md", "groot.md"),
    "watch": ("page.md", "recording.md"),
    "why": ("recording.md",),
    "check": ("messages.md", "xml.md"),
    "explain": ("formatting.md",),
    "words": ("keywords.md", "team_trees.md"),
    "format": ("formatting.md",),
    "test": ("testing.md",),
    "diff": ("diff.md",),
    "edit": ("page.md",),
    "lsp": ("editors.md",),
    "robot": ("tasks.md", "robots.md"),
    "task": ("tasks.md", "schedules.md"),
    "components": ("components.md",),
    "serve": ("server.md",),
    "user": ("server.md",),
    "world": ("worlds.md",),
    "gesture": ("gestures.md",),
    "new": ("robots.md", "components.md", "devices.md"),
    "compile": ("targets.md", "xml.md"),
    "grammar": ("language_models.md",),
    "mcp": ("language_models.md",),
    "sim-ros": ("ros.md",),
    "ros-node": ("ros.md",),
    "ros-devices": ("ros_devices.md",),
    "serve-actions": ("ros.md",),
}
"""By verbs: where to read more."""

Option = argparse.Action


def cli_page() -> str:
    """The page: its part that was written by hand, and then the verbs and their options."""
    written, _, _ = PAGE.read_text(encoding="utf-8").partition(MARK)
    return f"{written}{MARK}" + "".join(f"{line}\n" for line in _made())


def _made() -> Iterator[str]:
    parsers = {name: verb_parser(verb) for name, verb in VERBS.items()}
    shared = _shared(parsers)
    group = ""
    for name, verb in VERBS.items():
        if verb.group != group:
            group = verb.group
            yield f"\n## {group[0].upper()}{group[1:]}"
        yield from _verb(verb, parsers[name], shared)
    yield "\n## Options of several verbs\n"
    yield "| option | verbs | what it does |"
    yield "|---|---|---|"
    for (names, about), its_verbs in shared.items():
        yield f"| {names} | {', '.join(its_verbs)} | {about} |"


def _verb(verb: Verb, parser: argparse.ArgumentParser, shared: Mapping[tuple[str, str], object]) -> Iterator[str]:
    about = verb.about
    yield f"\n### btc {verb.name}\n"
    yield f"{about[0].upper()}{about[1:]}{'' if about.endswith('...') else '.'}{_read_more(verb.name)}"
    yield f"\n```text\n{_usage(verb.name, parser)}\n```"
    if verb.examples:
        width = max(len(command) for command, _ in verb.examples)
        yield f"\n```{'bash' if verb.name in _UNTESTED else 'sh'}"
        yield from (f"{command:{width}}  # {what}" for command, what in verb.examples)
        yield "```"
    rows = [(_names(option), _about(option, parser)) for option in _options(parser)]
    own = [row for row in rows if row not in shared]
    if verb.acts:
        yield from _acts(verb, parser)
    if own:
        yield "\n| argument or option | what it does |"
        yield "|---|---|"
        yield from (f"| {names} | {what} |" for names, what in own)
    others = ", ".join(names.partition(" ")[0].strip("`") for names, _ in rows if (names, _) in shared)
    if others:
        listed = ", ".join(f"`{name}`" for name in others.split(", "))
        yield f"\nAlso [options of several verbs](#options-of-several-verbs): {listed}."


def _acts(verb: Verb, parser: argparse.ArgumentParser) -> Iterator[str]:
    has_options = any(act.options is not None for act in verb.acts.values())
    flags = {option.dest: option.option_strings[-1] for option in _options(parser) if option.option_strings}
    yield f"\n| act | what it does | example |{' options |' if has_options else ''}"
    yield f"|---|---|---|{'---|' if has_options else ''}"
    for name, act in verb.acts.items():
        about, examples = act.explain(verb.name, name)
        shown = ", ".join(f"`{each}`" for each in examples.split(", "))
        cells = [f"`{name}`", about, shown, *([] if act.options is None else [_taken(act.options, flags)])]
        yield f"| {' | '.join(map(_cell, cells))} |"
    if has_options:
        but = ", but `stop` ignores them" * ("stop" in verb.acts)
        yield f"\n`--name` goes with every act. Options that don't apply to an act are refused{but}."


def _taken(taken: Sequence[str], flags: Mapping[str, str]) -> str:
    """The options that an act takes, or of many those that it doesn't take."""
    missing = [flag for name, flag in flags.items() if name not in taken and name != "name"]
    if len(missing) < len(taken):
        return f"all but {', '.join(f'`{flag}`' for flag in missing)}"
    return ", ".join(f"`{flag}`" for name, flag in flags.items() if name in taken)


def _read_more(verb: str) -> str:
    pages = ", ".join(f"[{page.removesuffix('.md').replace('_', ' ')}]({page})" for page in _PAGES.get(verb, ()))
    return f" More: {pages}." if pages else ""


def _options(parser: argparse.ArgumentParser) -> list[Option]:
    """What may follow the verb, the positional arguments first."""
    found = [action for action in parser._actions if action.dest not in ("help", "act")]
    return sorted(found, key=lambda action: bool(action.option_strings))


def _shared(parsers: Mapping[str, argparse.ArgumentParser]) -> dict[tuple[str, str], list[str]]:
    """The options that several verbs have with the same help, each with these verbs."""
    verbs: dict[tuple[str, str], list[str]] = {}
    for verb, parser in parsers.items():
        for option in _options(parser):
            if option.option_strings:
                verbs.setdefault((_names(option), _about(option, parser)), []).append(verb)
    return {row: found for row, found in verbs.items() if len(found) >= SHARED}


def _names(option: Option) -> str:
    """As one types it: `-o OUT`."""
    value = _value(option)
    return ", ".join(f"`{name}{value and ' '}{value}`" for name in option.option_strings) or f"`{_cell(value)}`"


def _value(option: Option) -> str:
    name = option.metavar or "|".join(map(str, option.choices or ())) or option.dest.upper()
    forms = {0: "", "?": "[{0}]", "*": "[{0} ...]", "+": "{0} [{0} ...]", argparse.REMAINDER: "..."}
    if not option.option_strings:
        return str(name)
    return _cell(forms.get(option.nargs, "{0}").format(name))


def _about(option: Option, parser: argparse.ArgumentParser) -> str:
    return _cell((option.help or "") % {"default": option.default, "prog": parser.prog})


def _cell(text: str) -> str:
    return text.replace("\\|", "|").replace("|", "\\|")


def _usage(verb: str, parser: argparse.ArgumentParser) -> str:
    """That of the parser where it has one, else a short one: how argparse writes it depends on its version."""
    if parser.usage:
        return "\n".join(line.strip() for line in parser.usage.splitlines())
    parts = [f"btc {verb}"]
    parts += [
        f"{option.option_strings[0]} {_value(option)}"
        for option in parser._actions
        if option.required and option.option_strings
    ]
    if len(_options(parser)) > sum(not option.option_strings for option in _options(parser)):
        parts.append("[OPTION ...]")
    forms = {"?": "[{0}]", "*": "[{0} ...]", "+": "{0} ..."}
    positional = [action for action in parser._actions if not action.option_strings]
    for action in positional:
        name = str(action.metavar or "|".join(map(str, action.choices or ())) or action.dest.upper())
        form = forms.get(str(action.nargs), "{0}")
        if any(group.required and action in group._group_actions for group in parser._mutually_exclusive_groups):
            form, name = "{0}", f"{name}{' ...' * (action.nargs == '*')}|-c TEXT"
        parts.append(form.format(name))
    return " ".join(parts)
