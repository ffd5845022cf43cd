"""Completion for shells: scripts made from the table of verbs, for bash, zsh and fish.

A script knows the verbs, their options and the choices of these, and completes files elsewhere. It doesn't start
btlang: a key would take too long.
"""

from __future__ import annotations

import shlex
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterable, Iterator, Mapping

from btlang.support.record import Record

_TAKES_FILES = frozenset(("FILE", "FILE|CODE", "OUT", "DIR", "FOLDER", "NAME|DIR", "ROBOT", "LANG"))
"""The names of values that are, or may be, paths."""


class CompletedValue(Record):
    """An option, or the positional arguments of a verb where it has no `names`."""

    names: tuple[str, ...]
    help: str
    placeholder: str
    is_flag: bool = False
    choices: tuple[str, ...] = ()

    @property
    def takes_files(self) -> bool:
        """Return whether it may be a path."""
        return self.placeholder in _TAKES_FILES


class CompletedVerb(Record):
    """A verb with what may follow it."""

    name: str
    help: str
    values: tuple[CompletedValue, ...]


def completion_script(
    shell: str, parsers: Mapping[str, tuple[str, ArgumentParser]], known: Mapping[str, Iterable[str]]
) -> str:
    """Write the script for a shell of SHELLS, from the help and parser of each verb.

    `known` are the values that have names, by what the help calls them: {"LANG": ["en", "es"]}.
    """
    verbs = [CompletedVerb(name, about, tuple(_values(parser, known))) for name, (about, parser) in parsers.items()]
    return "\n".join(SHELLS[shell](verbs)) + "\n"


def _values(parser: ArgumentParser, known: Mapping[str, Iterable[str]]) -> Iterator[CompletedValue]:
    for action in parser._actions:
        placeholder = str(action.metavar or action.dest.upper())
        choices = tuple(map(str, action.choices or known.get(placeholder, ())))
        about = (action.help or "") % {"default": action.default, "prog": parser.prog}
        yield CompletedValue(tuple(action.option_strings), about, placeholder, action.nargs == 0, choices)


def _bash(verbs: list[CompletedVerb]) -> Iterator[str]:
    yield f"""\
# Completion of btc in bash. To use it, add to ~/.bashrc: eval "$(btc completion bash)"
_btc() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} options= choices= files= line
    if [[ $word == = ]]; then word=; fi
    if [[ $before == = ]]; then before=${{COMP_WORDS[COMP_CWORD - 2]}}; fi
    if ((COMP_CWORD == 1)); then
        choices={shlex.quote(" ".join(verb.name for verb in verbs))} files=yes
    else
        case ${{COMP_WORDS[1]}} in"""
    *others, run = sorted(verbs, key=lambda verb: verb.name == "run")
    for verb in (*others, run.replace(name="*")):  # a file or a mission in place of a verb is run
        yield from _bash_case(verb)
    yield """\
        esac
    fi
    if [[ $word == -* ]]; then choices=$options files=; fi
    COMPREPLY=()
    while IFS= read -r line; do
        COMPREPLY+=("$line")
    done < <(compgen -W "$choices" -- "$word"; if [[ $files ]]; then compgen -f -- "$word"; fi)
}
complete -o filenames -F _btc btc"""


def _bash_case(verb: CompletedVerb) -> Iterator[str]:
    options = [value for value in verb.values if value.names]
    yield f"            {verb.name})"
    yield f"                options={shlex.quote(' '.join(name for value in options for name in value.names))}"
    yield "                case $before in"
    for value in options:
        if not value.is_flag:
            yield f"                    {'|'.join(value.names)}) {_bash_offers([value])} ;;"
    yield f"                    *) {_bash_offers([value for value in verb.values if not value.names])} ;;"
    yield "                esac ;;"


def _bash_offers(values: list[CompletedValue]) -> str:
    choices = " ".join(choice for value in values for choice in value.choices)
    return f"choices={shlex.quote(choices)} files={'yes' * any(value.takes_files for value in values)}"


def _zsh(verbs: list[CompletedVerb]) -> Iterator[str]:
    yield """\
#compdef btc
# Completion of btc in zsh. To use it, add to ~/.zshrc, after compinit: source <(btc completion zsh)
_btc() {
    local -a verbs
    verbs=("""
    for verb in verbs:
        yield f"        {shlex.quote(f'{verb.name}:{verb.help}')}"
    yield """\
    )
    if ((CURRENT == 2)); then
        _describe verb verbs
        _files
        return
    fi
    local verb=$words[2]
    shift words
    ((CURRENT--))
    case $verb in"""
    *others, run = sorted(verbs, key=lambda verb: verb.name == "run")
    for verb in (*others, run.replace(name="*")):
        yield f"        {verb.name}) _arguments " + " ".join(map(shlex.quote, _zsh_specs(verb))) + " ;;"
    yield """\
    esac
}
if [[ ${funcstack[1]} == _btc ]]; then _btc "$@"; else compdef _btc btc; fi"""


def _zsh_specs(verb: CompletedVerb) -> Iterator[str]:
    for value in verb.values:
        about = value.help.replace("[", r"\[").replace("]", r"\]")
        action = f"({' '.join(value.choices)})" if value.choices else "_files" if value.takes_files else " "
        if value.choices and value.takes_files:
            action = f"{{compadd -- {' '.join(value.choices)}; _files}}"
        end = "" if value.is_flag else f":{value.placeholder}:{action}"
        yield from (f"{name}[{about}]{end}" for name in value.names)
        if not value.names:
            yield f"*{end}"


def _fish(verbs: list[CompletedVerb]) -> Iterator[str]:
    yield f"""\
# Completion of btc in fish. To use it: btc completion fish > ~/.config/fish/completions/btc.fish
function __btc_runs  # a file or a mission in place of a verb is run
    __fish_seen_subcommand_from run; or not __fish_seen_subcommand_from {" ".join(verb.name for verb in verbs)}
end"""
    for verb in verbs:
        yield f"complete -c btc -n __fish_use_subcommand -a {verb.name} -d {_fish_text(verb.help)}"
        here = "__btc_runs" if verb.name == "run" else f"'__fish_seen_subcommand_from {verb.name}'"
        for value in verb.values:
            flags = [f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}" for name in value.names]
            flags += [f"-a {_fish_text(' '.join(value.choices))}"] if value.choices else []
            if value.names and not value.is_flag:
                flags.append("-r -F" if value.takes_files else "-x")
            if value.names or value.choices:
                yield f"complete -c btc -n {here} {' '.join(flags)} -d {_fish_text(value.help)}"
        if not any(value.takes_files for value in verb.values if not value.names):
            yield f"complete -c btc -n {here} -f"


def _fish_text(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace("'", "\\'")
    return f"'{escaped}'"


SHELLS: dict[str, Callable[[list[CompletedVerb]], Iterator[str]]] = {"bash": _bash, "zsh": _zsh, "fish": _fish}


def print_script(options: Namespace) -> int:
    """Print the completion script of a shell."""
    from btlang.cli.examples import all_examples
    from btlang.cli.parser import verb_parser
    from btlang.cli.verbs import VERBS
    from btlang.robots.bodies.body_file import shipped_bodies
    from btlang.robots.mission_vocabulary import world_vocabulary
    from btlang.robots.platforms import ROBOTS
    from btlang.text.output import pass_on
    from btlang.vocabulary.items import items
    from btlang.vocabulary.shipped import languages

    known = {
        "VERB": VERBS,
        "LANG": languages(),
        "ROBOT": (*ROBOTS, *shipped_bodies()),
        "SPEED": ("real", "max"),
        "SEARCH": dict.fromkeys(item.topic for item in items(world_vocabulary()) if " " not in item.topic),
        "NAME": [example.name for example in all_examples()],
    }
    parsers = {name: (verb.about, verb_parser(verb)) for name, verb in VERBS.items()}
    pass_on(completion_script(options.shell, parsers, known))
    return 0
