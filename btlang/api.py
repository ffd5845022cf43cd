"""The library: text to a tree that runs."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from importlib import import_module

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.frontends.mission.reader import DEFAULT_PARSER, read_mission
from btlang.frontends.mission.tokens.lines_in_use import in_use
from btlang.frontends.table import frontend_of, read_text
from btlang.passes import compile_mission, errors_of, lower_mission, run_passes
from btlang.passes.compilation import Compilation
from btlang.robots.mission_vocabulary import described, mission_vocabulary, world_of, world_vocabulary
from btlang.support.gc_pause import gc_paused
from btlang.support.record import Record
from btlang.text.output import show
from btlang.text.source import Source, Span
from btlang.tree.ast import Fact, Program, all_facts, says_ports
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Node, Tree
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.reading_context import Known
from btlang.vocabulary.references import key_of
from btlang.vocabulary.shipped import DEFAULT_WORLD, ENGLISH, languages

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, overload

    from btlang.backends.targets import BinaryTarget, TextTarget
    from btlang.passes.compilation import Origins
    from btlang.robots.mission_vocabulary import Path
    from btlang.robots.registry import Connect
    from btlang.run.outcome import Outcome
    from btlang.tree.dump import Outline
    from btlang.vocabulary.load import Keywords


def parse_tree(
    text: str | Source,
    *,
    parser: str = DEFAULT_PARSER,
    keywords: Keywords = (),
    world: Path | Source | None = None,
    main: str = "",
    language: str = ENGLISH,
    values: Mapping[str, object] = {},
    origins: Origins | None = None,
    has_robot: bool = False,
) -> Mission:
    """Compile a mission in English, or a tree: a text that begins with `<` is XML of BehaviorTree.CPP, with `{` JSON.

    `parser` is "shunting-yard" or "lark" (both give the same tree). `keywords` are paths of keyword files, paths of XML
    files whose nodes become words, names of installed packs, or functions decorated with `action` or `condition`.
    `world` is the path of a world file, or its text, by default the world that ships. `main` is the ID of the tree to
    run, if XML or JSON has several. `language` is that of the mission: "en", "es" or the folder of another one.
    `values` are values by name, or others of the same kind, that the mission may use without setting them; a run gets
    its values from `Session.prepare`. `origins` is filled with the syntax that each node was made of, by the identity
    of the node. `has_robot` says that a robot has been chosen: the words and the world of a robot that the mission
    names are then ignored. Raises MissionError with all diagnostics.
    """
    source = source_of(text)
    with gc_paused, _hint_at_file(text):
        vocabulary, chosen = mission_vocabulary(source, keywords, world_of(world), language, has_robot=has_robot)
        known = _known(values)
        try:
            read = read_text(source, main, vocabulary=vocabulary, parser=parser, errors_of=errors_of, known=known)
        except MissionError as error:
            if frontend_of(source) != "english":
                raise
            from btlang.passes.lint.beside_errors import find_beside_errors

            warnings_of = partial(_warnings_of, vocabulary=vocabulary, parser=parser, known=known)
            beside = find_beside_errors(source, error.diagnostics, warnings_of)
            raise MissionError([*error.diagnostics, *beside]) from None
        if isinstance(read, Tree):
            return mission_of_tree(read, vocabulary, chosen)
        compilation = run_passes(Compilation(vocabulary, read.mission, warnings=read.warnings, origins=origins))
    program = read.mission
    return Mission(
        compilation.tree, vocabulary, chosen, tuple(compilation.warnings), program, tuple(all_facts(program))
    )


def _warnings_of(source: Source, vocabulary: Lexicon, parser: str, known: Mapping[str, Known]) -> list[Diagnostic]:
    memo, depends = in_use.memo, (source.text, source.name, vocabulary, parser, known)
    if memo is not None and memo.warnings is not None and memo.warnings[0] == depends:
        kept: list[Diagnostic] = memo.warnings[1]
        return kept
    read = read_mission(source, vocabulary, parser, known)
    warnings = run_passes(Compilation(vocabulary, read.mission, warnings=read.warnings)).warnings
    if memo is not None and not read.mission.includes:
        memo.warnings = depends, warnings
    return warnings


@contextmanager
def _hint_at_file(text: str | Source) -> Iterator[None]:
    """Add to errors about a text that looks like the name of a file how to read that file."""
    try:
        yield
    except MissionError as error:
        name = text.strip() if isinstance(text, str) else ""
        if " " in name or not os.path.splitext(name)[1][1:].isalpha():
            raise
        raise error.advising(f"This is read as a mission. To read the file: btlang.parse_file({name!r})") from None


def parse_file(
    path: Path,
    *,
    parser: str = DEFAULT_PARSER,
    keywords: Keywords = (),
    world: Path | Source | None = None,
    main: str = "",
    include_root: str | None = None,
    language: str = ENGLISH,
) -> Mission:
    """Compile the text in a file, as `parse_tree` does. It may include files in its folder and below `include_root`.

    Its first lines can name its world, robot and keyword files there: `world "museum.toml"`, `robot "guide.toml"`,
    `words "referee.toml"`. The latter two run Python. A given `world` wins; `keywords` are added.
    """
    from btlang.diagnostics.files import read_source

    source = read_source(os.fspath(path), include_root)
    return parse_tree(source, parser=parser, keywords=keywords, world=world, main=main, language=language)


def mission_of(given: object, *, keywords: Keywords = (), world: Path | Source | None = None) -> Mission:
    """Return the mission that something stands for: a text, the path of a file (an os.PathLike), a tree, a behavior
    made with the functions of btlang.builders, a function decorated with `action` or `condition`, or a mission itself.

    A str is always the text of a mission, never a path: a program may get it from anybody. `keywords` and `world` are
    those of `parse_tree`. Raises MissionError for mistakes, TypeError for anything else.
    """
    if isinstance(given, Mission):
        return given
    if isinstance(given, str | Source):
        return parse_tree(given, keywords=keywords, world=world)
    if isinstance(given, os.PathLike):
        return parse_file(given, keywords=keywords, world=world)
    if isinstance(given, Node | Tree):
        tree = Tree(given) if isinstance(given, Node) else given
        return mission_of_tree(tree, world_vocabulary(keywords, world), world)
    if hasattr(given, "btlang_entry"):
        given = import_module("btlang.behavior").leaf(given)  # which is above this module
    compile = getattr(given, "mission", None)
    if callable(compile):
        made: Mission = compile(keywords=keywords, world=world)
        return made
    raise TypeError(f"a mission is a text, a path (pathlib.Path), a tree or a btlang.Mission, not {described(given)}")


def mission_of_tree(
    tree: Tree, vocabulary: Lexicon, world: Path | Source | None = None, facts: tuple[Fact, ...] = ()
) -> Mission:
    """Check a tree that no mission was compiled to, and make a mission of it. Raises MissionError."""
    compilation = run_passes(Compilation(vocabulary, tree=tree))
    return Mission(compilation.tree, vocabulary, world_of(world), tuple(compilation.warnings), facts=facts)


def source_of(text: object) -> Source:
    """Return the source of a text. Raises TypeError for anything else."""
    if isinstance(text, Source):
        return text
    if isinstance(text, str):
        return Source(text)
    advice = "; parse_file reads a file" if isinstance(text, os.PathLike) else ""
    raise TypeError(f"the text of a mission is a str, not {described(text)}{advice}")


def format_mission(
    text: str | Source,
    *,
    parser: str = DEFAULT_PARSER,
    keywords: Keywords = (),
    world: Path | Source | None = None,
    language: str = ENGLISH,
) -> str:
    """Return the text in the canonical layout: with the same words, comments, lines and tree.

    The text may contain only definitions. Raises MissionError if the mission has mistakes.
    """
    from btlang.printer.layout import format_layout

    source = source_of(text)
    if frontend_of(source) != "english":
        raise MissionError([diagnostic("BT001", Span(source, 0, 1), file=source.name, reason="it isn't English")])
    with gc_paused:
        vocabulary, _ = mission_vocabulary(source, keywords, world, language)
        mission = read_mission(source, vocabulary, parser, errors_of=errors_of).mission
        compile_mission(mission, vocabulary, needs_command=False)
    return format_layout(source, vocabulary.orthography)


def _known(values: Mapping[str, object]) -> dict[str, Known]:
    known = {}
    for name, value in values.items():
        key, kind = value_key(name), "text" if isinstance(value, str) else "number"
        known[key] = Known(key, tuple(name.lower().split()), (kind,))
    return known


def value_key(name: str) -> str:
    """Return the key on the blackboard of a value that a program gives: `name` as it is written in missions."""
    return key_of(name.lower().split())


_LONGEST = 60  # characters of a mission in its repr
_ROBOT = "needs_robot"


class Mission(Record, uncompared=("vocabulary", "world", "warnings", "syntax", "rules")):
    """A compiled mission, with its words and its world. Immutable: a Session runs it.

    `tree` is the tree itself. `world` is the path of its world file, or its text, None for the one that ships.
    `warnings` are diagnostics that don't keep it from running. `syntax` is the syntax tree that it was compiled from,
    if there is one. `facts` are places of this mission, in addition to those of the world. `rules` are the house rules
    around it (btlang.house_rules), which are also in its tree; None if there are none.
    """

    tree: Tree
    vocabulary: Lexicon
    world: str | Source | None = None
    warnings: tuple[Diagnostic, ...] = ()
    syntax: Program | None = None
    facts: tuple[Fact, ...] = ()
    rules: Mission | None = None

    def __str__(self) -> str:
        return str(self.__rich__())

    def __repr__(self) -> str:
        count, warned = sum(1 for _ in self.tree.walk()), len(self.warnings)
        warnings = f", {warned} warning{'s' * (warned > 1)}" if warned else ""
        root = self.tree.root
        words = self.label(root) if root.span is None else " ".join(root.source_text.split())
        words = words if len(words) <= _LONGEST else f"{words[: _LONGEST - 3]}..."
        return f"<Mission {words!r}, {count} node{'s' * (count > 1)}{warnings}>"

    def __rich__(self) -> Outline:
        from btlang.tree.dump import Outline

        return Outline((("", self.tree.root), *self.tree.subtrees), self._described)

    @property
    def robot(self) -> str:
        """Return the path of the robot file that its first lines name, "" if they name none."""
        program = self.syntax
        if program is None or not program.span.source.may_load:
            return ""
        from btlang.diagnostics.files import included_path

        named = (path for role, path in program.needs if role == _ROBOT)
        return next((included_path(path, program.span.source)[0] for path in named), "")

    def print(self) -> None:
        """Print the tree with its branches drawn."""
        show(self)

    def run(self, *, robot: str | Connect = "simulated", **options: Any) -> Outcome:
        """Run the mission to its end, or Ctrl-C, in a new session, so in a fresh world.

        `robot` is the same as for btlang.Session, by default the one that the mission names. The other options are
        those of `Session.prepare`: `speed`, `rate`, `time_limit`, `sinks`, `seed`. Raises MissionError and ValueError
        as these do.
        """
        from btlang.session import Session

        own = self.robot if robot == "simulated" else ""
        with Session(own or robot, world=self.world or DEFAULT_WORLD) as session:
            return session.prepare(self, **options).execute()

    def explain(self, width: int = 100) -> str:
        """Write each statement as written, in English with brackets that show its structure, and as a tree.

        For a tree that wasn't a mission, the statements are those of its English. Lines have at most `width` columns.
        Raises MissionError (BT142) if English can't express it.
        """
        from btlang.backends.explain import explain_mission

        program, tree = self.syntax, self.tree
        if program is None:
            program = read_mission(Source(self.to("english")), self.vocabulary).mission
            tree = lower_mission(program, self.vocabulary)
        return explain_mission(program, tree, self.vocabulary, self._described, width)

    def check(self, robot: str = "") -> None:
        """Raise MissionError with everything that would keep it from running, as far as known without the robot; with
        the `robot`, a robot file or name, also what its body lacks.

        A tree that was compiled from a mission has no other problems, unless it names nodes by their ids.
        """
        if robot:
            from btlang.robots.preflight import check_mission
            from btlang.robots.registry import body_of
            from btlang.robots.worlds.world_file import read_world

            body = body_of(robot)
            check_mission(read_world(self.world, body), body, self.tree, self.vocabulary)
        if problems := self.problems():
            raise MissionError(problems)

    def problems(self) -> list[Diagnostic]:
        """Return what would keep the tree from running on any robot, as diagnostics; see `check`."""
        if not self.says_ids:
            return []
        from btlang.backends.checking import find_misnamed, tree_problems

        named = self.vocabulary.with_places(tuple(fact.name for fact in self.facts))
        return [*tree_problems(self.tree, self.vocabulary), *find_misnamed(self.tree, named)]

    if TYPE_CHECKING:

        @overload
        def to(self, target: TextTarget, **options: Any) -> str: ...

        @overload
        def to(self, target: BinaryTarget, **options: Any) -> bytes: ...

        @overload
        def to(self, target: str, **options: Any) -> str | bytes: ...

    def to(self, target: str, **options: Any) -> str | bytes:
        """Return the tree as "xml", "english", "json" or another target of btlang.backends.targets.

        Raises ValueError for an unknown target or option, MissionError if the target can't express it.
        """
        from btlang.backends.targets import compile_to

        needs = self.syntax.needs if self.syntax is not None else ()
        given = {"world": self.world, "facts": self.facts, "needs": needs}
        return compile_to(self.tree, self.vocabulary, target, given=given, **options)

    def label(self, node: Node) -> str:
        """Return the English of a leaf, `Id port=value` of any other node."""
        from btlang.printer.phrase import phrase_of

        return node.name or phrase_of(node, self.vocabulary)

    def words(self, node: Node, language: str = "") -> str:
        """Return the words of a node, also of one that only leads others, as the mission says it: `try up to 4
        times`. With a `language` that ships, such as "es", they are in that language where it has words for the node.
        """
        from btlang.printer.node_words import words_in, words_of_node
        from btlang.vocabulary.load import load_vocabulary

        if language in languages() and language != self.vocabulary.language:
            said = words_in(node, load_vocabulary((), None, language))
            if said:
                return said
        return node.name or words_of_node(node, self.vocabulary)

    def is_action(self, node: Node) -> bool:
        """Return whether the node is a command of a keyword file."""
        entry = self.vocabulary.entry(node.id)
        return entry is not None and entry.sort == "action"

    def is_question(self, node: Node) -> bool:
        """Return whether the node is a condition: its failure is an answer."""
        entry, kind = self.vocabulary.entry(node.id), CATALOGUE.get(node.id)
        return kind.kind == "Condition" if kind is not None else entry is not None and entry.sort == "condition"

    @property
    def says_ids(self) -> bool:
        """Return whether it may name unknown nodes: it wasn't a mission, or it names nodes by their ids."""
        return self.syntax is None or says_ports(self.syntax)

    def _described(self, node: Node) -> str:
        from btlang.tree.dump import describe_node

        if node.children or node.id not in self.vocabulary.entries:
            return describe_node(node)
        return f"{node.id}: {self.label(node)}"
