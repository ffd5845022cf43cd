"""The library: text to a tree that runs."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.frontends.mission.reader import DEFAULT_PARSER, read_mission
from btlang.frontends.table import XML_ENDINGS, frontend_of, read_text
from btlang.gc_pause import gc_paused
from btlang.passes import compile_mission, errors_of, lower_mission, run_passes
from btlang.passes.compilation import Compilation
from btlang.record import Record
from btlang.text.output import show
from btlang.text.source import Source, Span
from btlang.text.words import split
from btlang.tree.ast import Fact, Program, all_facts, says_ports
from btlang.tree.node import Node, Tree
from btlang.vocabulary.cache import cached, recent, stamp
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.load import load_vocabulary, vocabulary_with
from btlang.vocabulary.nouns import Features
from btlang.vocabulary.reading_context import Known
from btlang.vocabulary.shipped import DEFAULT_WORLD, ENGLISH
from btlang.vocabulary.values import key_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeVar

    from btlang.passes.compilation import Origins
    from btlang.robots.registry import Connect
    from btlang.run.runner import Outcome
    from btlang.tree.dump import Outline

    World = TypeVar("World", bound=str | Source | None)


def parse_tree(
    text: str | Source,
    *,
    parser: str = DEFAULT_PARSER,
    keywords: Sequence[str | Entry | Callable[..., Any]] = (),
    world: str | Source | None = None,
    main: str = "",
    language: str = ENGLISH,
    values: Mapping[str, object] = {},
    origins: Origins | None = None,
) -> Mission:
    """Compiles a mission in English, or a tree: a text that begins with `<` is XML of BehaviorTree.CPP, with `{` JSON.

    `parser` is "shunting-yard" or "lark" (both give the same tree). `keywords` are paths of keyword files, paths of
    XML files whose nodes become words, names of installed packs, or functions decorated with `action` or `condition`.
    `world` is the path of a world file, or its text, by default the world that ships. `main` is the ID of the tree to
    run, if XML or JSON has several. `language` is that of the mission: "en", "es" or the folder of another one.
    `values` are what the mission may use by these names though it doesn't set them, or others of the same kind: a run
    gets them (`Session.prepare`). `origins` gets the nodes by their identities, each with the syntax that it was made
    of. Raises MissionError with all diagnostics.
    """
    source = Source(text) if isinstance(text, str) else text
    with gc_paused:
        vocabulary, world = mission_vocabulary(source, keywords, world, language)
        read = read_text(source, main, vocabulary=vocabulary, parser=parser, errors_of=errors_of, known=_known(values))
        if isinstance(read, Tree):
            compilation = run_passes(Compilation(vocabulary, tree=read))
            return Mission(compilation.tree, vocabulary, world, tuple(compilation.warnings))
        compilation = run_passes(Compilation(vocabulary, read.mission, warnings=read.warnings, origins=origins))
    program = read.mission
    return Mission(compilation.tree, vocabulary, world, tuple(compilation.warnings), program, tuple(all_facts(program)))


def parse_file(
    path: str,
    *,
    parser: str = DEFAULT_PARSER,
    keywords: Sequence[str | Entry | Callable[..., Any]] = (),
    world: str | Source | None = None,
    main: str = "",
    include_root: str | None = None,
    language: str = ENGLISH,
) -> Mission:
    """Like `parse_tree`, for the text in a file. It may include files in its folder and below `include_root`.

    Its first lines can name its world and keyword files there: `world "museum.toml"`, `words "referee.toml"`. These run
    Python. A given `world` wins; `keywords` are added.
    """
    from btlang.diagnostics.reading import read_source

    source = read_source(path, include_root)
    return parse_tree(source, parser=parser, keywords=keywords, world=world, main=main, language=language)


def format_mission(
    text: str | Source,
    *,
    parser: str = DEFAULT_PARSER,
    keywords: Sequence[str | Entry | Callable[..., Any]] = (),
    world: str | Source | None = None,
    language: str = ENGLISH,
) -> str:
    """The text in the canonical layout: with the same words, comments, lines and tree.

    The text may contain only definitions. Raises MissionError if the mission has mistakes.
    """
    from btlang.printer.layout import laid_out

    source = Source(text) if isinstance(text, str) else text
    if frontend_of(source) != "english":
        raise MissionError([diagnostic("BT001", Span(source, 0, 1), file=source.name, reason="it isn't English")])
    with gc_paused:
        vocabulary, _ = mission_vocabulary(source, keywords, world, language)
        mission = read_mission(source, vocabulary, parser, errors_of=errors_of).mission
        compile_mission(mission, vocabulary, needs_command=False)
    return laid_out(source, vocabulary.orthography)


def _known(values: Mapping[str, object]) -> dict[str, Known]:
    known = {}
    for name, value in values.items():
        key, kind = value_key(name), "text" if isinstance(value, str) else "number"
        known[key] = Known(key, tuple(name.lower().split()), (kind,))
    return known


def value_key(name: str) -> str:
    """The key on the blackboard of a value that a program gives: `name` as it is written in missions."""
    return key_of(name.lower().split())


def mission_vocabulary(
    source: Source,
    keywords: Sequence[str | Entry | Callable[..., Any]],
    world: World,
    language: str = ENGLISH,
) -> tuple[Lexicon, World | str]:
    """The words of a text and its world, with the files that it needs as its first lines say.

    A given `world` wins over the text's own; `keywords` are added to its own. Raises MissionError.
    """
    first = _FIRST_LINE.match(source.text)
    if first is None or _QUOTES.isdisjoint(first[1]):
        return world_vocabulary(keywords, world, language), world
    from btlang.diagnostics.reading import OUTSIDE, included_path, is_below
    from btlang.frontends.mission.symbols.needs import WORDS, find_needs, unusable

    vocabulary = load_vocabulary([word for word in keywords if not _is_xml(word)], None, language)
    files: dict[str, str] = {}
    lines: dict[str, Span] = {}
    problems: list[Diagnostic] = []
    for need in find_needs(split(source, vocabulary.orthography), vocabulary).found:
        if need.role != WORDS and world is not None:
            continue
        path, real = included_path(need.path, source)
        if not source.may_load:
            problems.append(unusable(need, "only a mission that you name yourself can load files"))
        elif not any(is_below(real, root) for root in source.roots):
            problems.append(unusable(need, OUTSIDE))
        elif os.path.exists(real) and not os.path.isfile(real):
            problems.append(unusable(need, "it isn't a regular file"))
        files[path], lines[path] = need.role, need.span
    if problems:
        raise MissionError(problems)
    own = [path for path, role in files.items() if role == WORDS and path not in keywords]
    chosen = next((path for path, role in files.items() if role != WORDS), world)
    try:
        return world_vocabulary([*own, *keywords], chosen, language), chosen
    except MissionError as error:
        raise MissionError([_at_line(problem, lines) for problem in error.diagnostics]) from None


_QUOTES = frozenset("\"'“”„«»’‘")  # noqa: RUF001
_FIRST_LINE = re.compile(r"(?:#[^\n]*\n|[\s\ufeff])*([^\n]*)")


def _at_line(problem: Diagnostic, lines: Mapping[str, Span]) -> Diagnostic:
    """A problem with a file that a mission needs, with the line that names it."""
    line = lines.get(problem.span.source.name)
    if line is None:
        return problem
    if not problem.span.source.text:
        return problem.replace(span=line)  # type: ignore[no-any-return]
    return problem.replace(notes=(*problem.notes, (line, "The mission needs this file.")))  # type: ignore[no-any-return]


def world_vocabulary(
    keywords: Sequence[str | Entry | Callable[..., Any]] = (),
    world: str | Source | None = None,
    language: str = ENGLISH,
) -> Lexicon:
    """The words of a language and of the keyword files, and the names of a world; `keywords` as for `parse_tree`.

    Nodes of XML files get words that all others leave free, as `btc words --from` makes them. Raises MissionError.
    """
    find = partial(_names_by_type, world)
    if isinstance(world, Source):
        by_type, features = recent(_names, world.text, find)
    else:
        by_type, features = cached("world", [DEFAULT_WORLD if world is None else world], find)
    others = [word for word in keywords if not _is_xml(word)]
    vocabulary = load_vocabulary(others, by_type, language, features)
    models = [str(word) for word in keywords if _is_xml(word)]
    if not models:
        return vocabulary

    def make() -> Lexicon:
        from btlang.backends.keyword_pack import vocabulary_of_models  # most missions have only other words

        return vocabulary_of_models(models, vocabulary, partial(vocabulary_with, keywords=others, language=language))

    try:
        key = (id(vocabulary), *map(stamp, models))
    except OSError:
        return make().with_names(by_type, features)
    return recent(_with_models, key, lambda: (vocabulary, make()))[1].with_names(by_type, features)


_with_models: dict[tuple[object, ...], tuple[Lexicon, Lexicon]] = {}  # the first stays, so that no id is used again


def _is_xml(word: object) -> bool:
    return isinstance(word, str) and word.endswith(XML_ENDINGS)


_names: dict[str, tuple[dict[str, tuple[str, ...]], Features]] = {}  # by the text of the world


def _names_by_type(world: str | Source | None) -> tuple[dict[str, tuple[str, ...]], Features]:
    from btlang.robots.world_file import WorldError, world_names

    try:
        names = world_names(world)
    except WorldError as error:
        from btlang.robots.data_file import as_mission_error

        raise as_mission_error(error) from None
    return names.by_type, names.features


class Mission(Record, uncompared=("vocabulary", "world", "warnings", "syntax")):
    """A compiled mission, with its words and its world. Immutable: a Session runs it.

    `tree` is the tree itself. `world` is the path of its world file, or its text, None for the one that ships.
    `warnings` are diagnostics that don't keep it from running. `syntax` is the syntax tree that it was compiled from,
    if there is one. `facts` are places of this mission, in addition to those of the world.
    """

    tree: Tree
    vocabulary: Lexicon
    world: str | Source | None = None
    warnings: tuple[Diagnostic, ...] = ()
    syntax: Program | None = None
    facts: tuple[Fact, ...] = ()

    def __str__(self) -> str:
        return str(self.__rich__())

    def __rich__(self) -> Outline:
        from btlang.tree.dump import Outline

        return Outline((("", self.tree.root), *self.tree.subtrees), self._described)

    def print(self) -> None:
        """Prints the tree with its branches drawn."""
        show(self)

    def run(self, *, robot: str | Connect = "simulated", **options: Any) -> Outcome:
        """Runs the mission to its end, or Ctrl-C, in a new session, so in a fresh world.

        `robot` is the same as for btlang.Session. The other options are those of `Session.prepare`: `speed`, `rate`,
        `time_limit`, `sinks`, `seed`. Raises MissionError and ValueError as these do.
        """
        from btlang.session import Session

        with Session(robot, world=self.world) as session:
            return session.prepare(self, **options).execute()

    def explain(self, width: int = 100) -> str:
        """Each statement as written, in English with brackets that show its structure, and as a tree.

        For a tree that wasn't a mission, the statements are those of its English. Lines have at most `width` columns.
        Raises MissionError (BT142) if English can't express it.
        """
        from btlang.backends.explain import explain_mission

        program, tree = self.syntax, self.tree
        if program is None:
            program = read_mission(Source(str(self.to("english"))), self.vocabulary).mission
            tree = lower_mission(program, self.vocabulary)
        return explain_mission(program, tree, self.vocabulary, self._described, width)

    def check(self, robot: str = "") -> None:
        """Raises MissionError with everything that would keep it from running, as far as known without the robot; with
        the `robot`, a robot file or name, also what its body lacks.

        A tree that was compiled from a mission has no other problems, unless it names nodes by their ids.
        """
        if robot:
            from btlang.robots.preflight import check_mission
            from btlang.robots.registry import body_of
            from btlang.robots.world_problem import read_world

            body = body_of(robot)
            check_mission(read_world(self.world, body), body, self.tree, self.vocabulary)
        if not self.says_ids:
            return
        from btlang.backends.checking import misnamed, tree_problems

        named = self.vocabulary.with_places(tuple(fact.name for fact in self.facts))
        problems = [*tree_problems(self.tree, self.vocabulary), *misnamed(self.tree, named)]
        if problems:
            raise MissionError(problems)

    def to(self, target: str, **options: Any) -> str | bytes:
        """The tree as "xml", "english", "json" or another target of btlang.backends.targets.

        Raises ValueError for an unknown target or option, MissionError if the target can't express it.
        """
        from btlang.backends.targets import compiled

        needs = self.syntax.needs if self.syntax is not None else ()
        given = {"world": self.world, "facts": self.facts, "needs": needs}
        return compiled(self.tree, self.vocabulary, target, given=given, **options)

    def label(self, node: Node) -> str:
        """The English of a leaf, `Id port=value` of any other node."""
        from btlang.printer.phrase import phrase_of

        return node.name or phrase_of(node, self.vocabulary)

    def is_action(self, node: Node) -> bool:
        """Whether the node is a command of a keyword file."""
        entry = self.vocabulary.entry(node.id)
        return entry is not None and entry.sort == "action"

    @property
    def says_ids(self) -> bool:
        """Whether it may name unknown nodes: it wasn't a mission, or it names nodes by their ids."""
        return self.syntax is None or says_ports(self.syntax)

    def _described(self, node: Node) -> str:
        from btlang.tree.dump import described

        if node.children or node.id not in self.vocabulary.entries:
            return described(node)
        return f"{node.id}: {self.label(node)}"
