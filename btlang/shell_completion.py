"""Completion for shells: scripts made from the argument parsers, for bash, zsh and fish.

A script knows the verbs, their options and the choices of these, and completes files elsewhere. It doesn't start
btlang: a key would take too long.
"""

from __future__ import annotations

import shlex
from argparse import ArgumentParser
from collections.abc import Callable, Iterable, Iterator, Mapping

from btlang.record import Record

_TAKES_FILES = frozenset(("FILE", "FILE|CODE", "OUT", "DIR", "FOLDER", "NAME|DIR", "ROBOT", "LANG"))
"""Names of values that are, or may be, paths."""


class Value(Record):
    """An option, or the positional arguments of a verb where it has no `names`."""

    names: tuple[str, ...]
    help: str
    placeholder: str
    is_flag: bool = False
    choices: tuple[str, ...] = ()

    @property
    def takes_files(self) -> bool:
        """Whether it may be a path."""
        return self.placeholder in _TAKES_FILES


class Verb(Record):
    """A verb with what may follow it."""

    name: str
    help: str
    values: tuple[Value, ...]


def completion_script(
    shell: str, parsers: Mapping[str, tuple[str, ArgumentParser]], known: Mapping[str, Iterable[str]]
) -> str:
    """The script for a shell of SHELLS, from the help and parser of each verb.

    `known` are the values that have names, by what the help calls them: {"LANG": ["en", "es"]}.
    """
    verbs = [Verb(name, about, tuple(_values(parser, known))) for name, (about, parser) in parsers.items()]
    return "\n".join(SHELLS[shell](verbs)) + "\n"


def _values(parser: ArgumentParser, known: Mapping[str, Iterable[str]]) -> Iterator[Value]:
    for action in parser._actions:
        placeholder = str(action.metavar or action.dest.upper())
        choices = tuple(map(str, action.choices or known.get(placeholder, ())))
        about = (action.help or "") % {"default": action.default, "prog": parser.prog}
        yield Value(tuple(action.option_strings), about, placeholder, action.nargs == 0, choices)


def _bash(verbs: list[Verb]) -> Iterator[str]:
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


def _bash_case(verb: Verb) -> Iterator[str]:
    options = [value for value in verb.values if value.names]
    yield f"            {verb.name})"
    yield f"                options={shlex.quote(' '.join(name for value in options for name in value.names))}"
    yield "                case $before in"
    for value in options:
        if not value.is_flag:
            yield f"                    {'|'.join(value.names)}) {_bash_offers([value])} ;;"
    yield f"                    *) {_bash_offers([value for value in verb.values if not value.names])} ;;"
    yield "                esac ;;"


def _bash_offers(values: list[Value]) -> str:
    choices = " ".join(choice for value in values for choice in value.choices)
    return f"choices={shlex.quote(choices)} files={'yes' * any(value.takes_files for value in values)}"


def _zsh(verbs: list[Verb]) -> Iterator[str]:
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


def _zsh_specs(verb: Verb) -> Iterator[str]:
    for value in verb.values:
        about = value.help.replace("[", r"\[").replace("]", r"\]")
        action = f"({' '.join(value.choices)})" if value.choices else "_files" if value.takes_files else " "
        if value.choices and value.takes_files:
            action = f"{{compadd -- {' '.join(value.choices)}; _files}}"
        end = "" if value.is_flag else f":{value.placeholder}:{action}"
        yield from (f"{name}[{about}]{end}" for name in value.names)
        if not value.names:
            yield f"*{end}"


def _fish(verbs: list[Verb]) -> Iterator[str]:
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


SHELLS: dict[str, Callable[[list[Verb]], Iterator[str]]] = {"bash": _bash, "zsh": _zsh, "fish": _fish}


def add_completion_options(parser: ArgumentParser) -> None:
    """Those of `btc completion`."""
    parser.add_argument("shell", choices=list(SHELLS), help="bash, zsh or fish; the script says how to use it")
