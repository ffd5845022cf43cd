"""Makes the generated part of docs/cli.md from the parsers that `btc help` prints."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from btlang.cli_options import GROUPS, verb_parsers
from btlang.command_examples import EXAMPLES
from btlang.gestures.options import ACTS as GESTURE_ACTS
from btlang.server.options import USER_ACTS
from btlang.task.applicable import COMPONENT_ACTS, ROBOT_ACTS, ROBOT_OPTIONS, TASK_ACTS, TASK_OPTIONS

PAGE = Path(__file__).parent.parent / "docs" / "cli.md"
MARK = "<!-- Made by `python -m tests.generate` from here on. -->\n"
SHARED = 3
"""Verbs that have an option with the same help, at least, for it to be described once for all of them."""
ACTS: Mapping[str, tuple[Mapping[str, str], Mapping[str, Sequence[str]]]] = {
    "robot": (ROBOT_ACTS, ROBOT_OPTIONS),
    "task": (TASK_ACTS, TASK_OPTIONS),
    "components": (COMPONENT_ACTS, {}),
    "user": (USER_ACTS, {}),
    "gesture": (GESTURE_ACTS, {}),
}
"""By verbs: what each act does, and which options it takes where that is checked."""
_UNTESTED = ("repl", "diff", "edit", "watch", "serve", "mcp", "sim-ros", "ros-node", "ros-devices", "serve-actions")
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
    parsers = verb_parsers()
    shared = _shared(parsers)
    for title, verbs in GROUPS.items():
        yield f"\n## {title[0].upper()}{title[1:]}"
        for verb in verbs:
            yield from _verb(verb, *parsers[verb], shared)
    yield "\n## Options of several verbs\n"
    yield "| option | verbs | what it does |"
    yield "|---|---|---|"
    for (names, about), its_verbs in shared.items():
        yield f"| {names} | {', '.join(its_verbs)} | {about} |"


def _verb(
    verb: str, about: str, parser: argparse.ArgumentParser, shared: Mapping[tuple[str, str], object]
) -> Iterator[str]:
    yield f"\n### btc {verb}\n"
    yield f"{about[0].upper()}{about[1:]}{'' if about.endswith('...') else '.'}{_read_more(verb)}"
    yield f"\n```text\n{_usage(verb, parser)}\n```"
    if verb in EXAMPLES:
        width = max(len(command) for command, _ in EXAMPLES[verb])
        yield f"\n```{'bash' if verb in _UNTESTED else 'sh'}"
        yield from (f"{command:{width}}  # {what}" for command, what in EXAMPLES[verb])
        yield "```"
    rows = [(_names(option), _about(option, parser)) for option in _options(parser)]
    own = [row for row in rows if row not in shared]
    if verb in ACTS:
        yield from _acts(verb, parser)
    if own:
        yield "\n| argument or option | what it does |"
        yield "|---|---|"
        yield from (f"| {names} | {what} |" for names, what in own)
    others = ", ".join(names.partition(" ")[0].strip("`") for names, _ in rows if (names, _) in shared)
    if others:
        listed = ", ".join(f"`{name}`" for name in others.split(", "))
        yield f"\nAlso [options of several verbs](#options-of-several-verbs): {listed}."


def _acts(verb: str, parser: argparse.ArgumentParser) -> Iterator[str]:
    acts, options = ACTS[verb]
    flags = {option.dest: option.option_strings[-1] for option in _options(parser) if option.option_strings}
    yield f"\n| act | what it does | example |{' options |' if options else ''}"
    yield f"|---|---|---|{'---|' if options else ''}"
    for act, text in acts.items():
        about, _, example = text.partition(": btc ")
        shown = ", ".join(f"`btc {each.removeprefix('btc ')}`" for each in (example or f"{verb} {act}").split(", "))
        cells = [f"`{act}`", about, shown, *([_taken(options[act], flags)] if options else [])]
        yield f"| {' | '.join(map(_cell, cells))} |"
    if options:
        but = ", but `stop` ignores them" * ("stop" in acts)
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


def _shared(parsers: Mapping[str, tuple[str, argparse.ArgumentParser]]) -> dict[tuple[str, str], list[str]]:
    """The options that several verbs have with the same help, each with these verbs."""
    verbs: dict[tuple[str, str], list[str]] = {}
    for verb, (_, parser) in parsers.items():
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
