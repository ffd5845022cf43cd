"""What is wrong with a project of trees: by its models where they describe a node, by the words of btlang elsewhere."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

from btlang.backends.checking import accept_anything, bind_placeholder, find_misnamed, tree_problems
from btlang.diagnostics.diagnostic import Diagnostic, diagnostic, sort_diagnostics
from btlang.engine.instance import blackboard_key
from btlang.engine.leaves.leaf import LeafBinding
from btlang.frontends.btcpp.files import NOT_INCLUDED, XmlFiles
from btlang.frontends.btcpp.models import nav2_models
from btlang.frontends.btcpp.project import XmlProject, read_project
from btlang.passes import PASSES
from btlang.passes.compilation import Compilation
from btlang.passes.lint.allow import not_allowed
from btlang.projects.cpp_ports import CppSources
from btlang.projects.entries import (
    EntryFlow,
    entries_of,
    unmade_entries,
    unset_entries,
    unset_enums,
    wrong_constants,
)
from btlang.projects.entry_types import conflicting_types
from btlang.projects.ports import (
    DescribedUses,
    broken_references,
    constant_outputs,
    enum_names,
    is_no_port,
    misspelt_ports,
    port_problems,
    several_alone,
    subtree_problems,
    wrong_children,
)
from btlang.projects.restarts import (
    INSTANT,
    conditions_of_others,
    double_quotes,
    may_be_repeated,
    names_of_version_3,
    restarted_actions,
)
from btlang.projects.unused import (
    count_times,
    keys_read,
    unknown_nodes,
    unread_subtree_ports,
    unread_values,
    unused_trees,
)
from btlang.text.source import NOWHERE, Source, Span
from btlang.text.spelling import misspelt
from btlang.tree.catalogue import BEHAVIOR_TREE_CPP, CATALOGUE, SEQUENCE, SUBTREE
from btlang.tree.node import Node, NodeModel, PortModel, Tree
from btlang.tree.visit import fold
from btlang.vocabulary.lexicon import Lexicon

_OF_A_VALUE = re.compile(r"\w+ must be ")


NEWEST = (4, 10)
_REFUSED_SINCE = {"BT238": (4, 8, 4), "BT242": (4, 9)}
_ONE_ALONE_SINCE = (4, 7)


def project_problems(
    project: XmlProject, vocabulary: Lexicon, sources: CppSources, version: tuple[int, ...] = NEWEST
) -> list[Diagnostic]:
    """Find errors and warnings of all files, in order, without those that comments allow, and without what this version
    of BehaviorTree.CPP doesn't refuse yet.

    The C++ sources are asked about nodes that models describe badly, or not at all.
    """
    found = list(project.problems)
    if project.trees:
        found += _Check(project, vocabulary, sources, version).problems()
    found = [problem for problem in found if version >= _REFUSED_SINCE.get(problem.code, version)]
    wrong: dict[tuple[str, int], set[str]] = {}
    for problem in found:
        if problem.is_error and problem.code != "BT132":
            also = problem.notes if problem.code == "BT127" else ()
            for place in (problem.span, *(span for span, _ in also)):
                wrong.setdefault(_place(place), set()).add(problem.code)
    return sort_diagnostics(
        not_allowed(each for each in found if not _follows(each, wrong.get(_place(each.span), set())))
    )


def _follows(problem: Diagnostic, wrong: set[str]) -> bool:
    """Return whether a problem is only there because of what other errors at its place say."""
    if problem.code == "BT236":
        return "BT127" in wrong  # which of two trees is used, isn't known
    if problem.code != "BT132" or not wrong:
        return False
    return wrong != {"BT014"} or _OF_A_VALUE.match(dict(problem.arguments)["reason"]) is not None


def _place(span: Span) -> tuple[str, int]:
    return span.source.name, span.start


def check_trees(
    sources: Sequence[Source], vocabulary: Lexicon, *, models: Iterable[Source] = (), main: str = "",
    folders: Sequence[str] = (), btcpp: tuple[int, ...] | None = None,
) -> list[Diagnostic]:  # fmt: skip
    """Find what is wrong with files that are one project, as `project_problems` does.

    `models` are files whose models count as well, `folders` those with C++ sources, and `btcpp` the version of
    BehaviorTree.CPP, by default the newest.
    """
    palettes, files = XmlFiles(), XmlFiles(sources, dialect=btcpp[0] if btcpp else 3)
    for source in models:
        palettes.add(source)
    for source in sources:
        files.add(source)
    return project_problems(read_project(files, palettes, main), vocabulary, CppSources(folders), btcpp or NEWEST)


class _Check:
    def __init__(self, project: XmlProject, vocabulary: Lexicon, sources: CppSources, version: tuple[int, ...]) -> None:
        self._project = project
        self._version = version
        self._sources = sources
        self._read: frozenset[str] = frozenset()
        self._outputs_of_models: dict[int, frozenset[str]] = {}
        self._ports_of_models: dict[int, dict[str, PortModel]] = {}
        self._places_of_models: dict[int, set[str]] = {}
        for described in project.described.values():
            for model, place in described:
                self._places_of_models.setdefault(id(model), set()).add(place.source.name)
        self._trees = project.certain_trees()
        self._nodes = [node for root in self._trees.values() for node in Tree(root).walk()]
        elsewhere = self._ids_from_elsewhere(vocabulary)
        own = {id: known for id, known in vocabulary.entries.items() if id not in elsewhere}
        self._vocabulary = vocabulary.replaced(entries=own)
        self._words = vocabulary.entries.keys()
        ids = {node.id for node in self._nodes} - project.models.keys() - CATALOGUE.keys()
        self._nav2 = nav2_models(ids)
        self._described = {*CATALOGUE, *project.models, *self._nav2, *project.unread}
        if ids - self._described - self._words:
            self._described.update(sources.models)

    def problems(self) -> Iterator[Diagnostic]:
        """Find the problems of the trees; of those that contain themselves only what can be said of each alone."""
        yield from unknown_nodes(self._nodes, self._described, self._words, self._project.dialects)
        yield from self._wrong_ports()
        yield from unused_trees(self._project)
        yield from conditions_of_others(self._nodes)
        newer = [node for node in self._nodes if self._dialect(node) == 4]
        yield from double_quotes(newer)
        yield from names_of_version_3(newer, self._project.models)
        yield from broken_references(self._nodes, {*CATALOGUE, *self._vocabulary.entries, *self._nav2})
        self._read = keys_read(self._nodes, self._outputs)
        yield from restarted_actions(self._nodes, self._sort, self._trees)
        yield from unread_values(self._nodes, self._outputs, self._read)
        yield from unread_subtree_ports(self._nodes, self._trees)
        yield from self._wrong_entries()
        if not self._finite:
            return
        yield from self._faults()
        compilation = Compilation(self._vocabulary, tree=self._whole(self._finite))
        for one in PASSES:
            if not one.needs_text:
                yield from one.run(compilation)

    @property
    def _finite(self) -> dict[str, Node]:
        """The trees that don't contain themselves."""
        return {name: root for name, root in self._project.trees.items() if name not in self._project.circular}

    def _sort(self, node: Node) -> str:
        """Return whether a leaf is an "Action" that isn't meant to be done at each tick, or an INSTANT one, a
        "Condition", or "" if that isn't known: actions of others may compute anew what they set and something reads.
        """
        kind, entry = CATALOGUE.get(node.id), self._vocabulary.entries.get(node.id, (None,))[0]
        if kind is not None:  # scripts and the like are meant to run at each tick
            return "Condition" if not (kind.takes_time or kind.least or kind.waits) else ""
        if entry is not None:
            return "Action" if entry.sort == "action" and not entry.instant else "Condition"
        model = self._model(node)
        if model is None or node.children:
            return ""
        if model.kind == "Condition":
            return "Condition"
        is_instant = self._sources.is_instant(node.id)
        may_set = {port.name for port in model.ports if port.direction != "input"}
        sets = (blackboard_key(name, text) or text for name, text in node.ports if name in may_set)
        if model.kind != "Action" or may_be_repeated(node.id, is_instant) or not self._read.isdisjoint(sets):
            return ""
        return INSTANT if is_instant else "Action"

    def _ids_from_elsewhere(self, vocabulary: Lexicon) -> set[str]:
        """Return the ids of leaves that aren't the vocabulary's: their models differ, or their files have others,
        too.
        """
        own = {id for id in vocabulary.entries if self._fits(id, vocabulary)}
        by_file: dict[str, set[str]] = {}
        for node in self._nodes:
            if node.id not in CATALOGUE and node.span is not None:
                by_file.setdefault(node.span.source.name, set()).add(node.id)
        return {id for ids in by_file.values() if not ids <= own for id in ids}

    def _fits(self, node_id: str, vocabulary: Lexicon) -> bool:
        """Return whether a model, if there is one, describes the entry of this id."""
        model = self._project.models.get(node_id)
        own = {name for entry in vocabulary.entries[node_id] for name in entry.ports}
        return model is None or all(port.name in own for port in model.ports)

    def _wrong_ports(self) -> Iterator[Diagnostic]:
        described: dict[int, tuple[NodeModel, list[Node]]] = {}
        for node in self._nodes:
            if node.id == SUBTREE:
                model = self._project.model(node)
                if model is not None and self._dialect(node) == 4:
                    yield from subtree_problems(node, model)
            elif node.id in CATALOGUE:
                if len(node.children) > 1 and self._dialect(node) == 4 and self._version >= _ONE_ALONE_SINCE:
                    yield from several_alone(node)
            elif node.id not in self._vocabulary.entries:
                model = self._model(node)
                for problem in wrong_children(node, model):
                    if not self._is_other_kind(node, model):
                        yield problem
                if model is not None:
                    yield from constant_outputs(node, self._ports(node).values(), self._dialect(node) == 3)
                    described.setdefault(id(model), (model, []))[1].append(node)
        for model, nodes in described.values():
            uses = DescribedUses(model, NOWHERE, tuple(nodes))
            if id(model) not in self._places_of_models:
                yield from misspelt_ports(uses)
            elif any(port_problems(uses)) and any(port_problems(uses := self._with_others(uses))):
                yield from port_problems(self._with_sources(uses))

    def _wrong_entries(self) -> Iterator[Diagnostic]:
        entries = {name: entries_of(root, self._ports, self._dialect(root) == 3)
                   for name, root in self._trees.items()}  # fmt: skip
        flow = EntryFlow(entries)
        yield from unset_entries(entries, flow)
        yield from unmade_entries(entries, flow)
        yield from wrong_constants(entries, flow)
        if any(use.may_be_enum for each in entries.values() for use in each.uses):
            types = {port.type for model in self._project.models.values() for port in model.ports}
            registered, are_all = self._sources.enums
            described = {name for type in types for name in enum_names(type)}
            yield from unset_enums(entries, registered | described, are_all)
        yield from conflicting_types(entries)

    def _ports(self, node: Node) -> Mapping[str, PortModel]:
        """Return the ports of a node by name, as far as they are known."""
        model = self._model(node)
        if model is None:
            return {}
        ports = self._ports_of_models.get(id(model))
        if ports is None:
            ports = self._ports_of_models[id(model)] = {port.name: port for port in model.ports}
        if all(name in ports or is_no_port(name) for name, _ in node.ports):
            return ports
        others = [other for other, _ in self._project.described.get(node.id, ())]
        if node.id in self._sources.models:
            others.append(self._sources.models[node.id][0])
        return {**{port.name: port for other in others for port in other.ports}, **ports}

    def _is_other_kind(self, node: Node, model: NodeModel | None) -> bool:
        """Return whether C++ says that a node is of another kind than its model, which is out of date."""
        known, _ = self._sources.models.get(node.id, (None, None))
        return model is not None and known is not None and known.kind not in ("", model.kind)

    def _outputs(self, node: Node) -> frozenset[str]:
        """Return the outputs of a node that a model of the project describes."""
        model = self._project.model(node) if node.id not in CATALOGUE else None
        if model is None:
            return frozenset()
        outputs = self._outputs_of_models.get(id(model))
        if outputs is None:
            outputs = frozenset(port.name for port in model.ports if port.direction == "output")
            self._outputs_of_models[id(model)] = outputs
        return outputs

    def _model(self, node: Node) -> NodeModel | None:
        model = self._project.model(node)
        if model is not None and node.span is not None and self._is_of_another_program(model, node.span):
            known, _ = self._sources.models.get(node.id, (model, None))
            return known
        return model or self._known(node.id)

    def _is_of_another_program(self, model: NodeModel, place: Span) -> bool:
        """Return whether a model is only in a file with trees that belongs to a program without this file."""
        places = self._places_of_models.get(id(model))
        if places is None or place.source.name in places:
            return False
        return not any(self._project.may_share(place.source.name, each) for each in places)

    def _known(self, node_id: str) -> NodeModel | None:
        """Return what is known of a node that no model of the project describes."""
        known = self._nav2.get(node_id)
        if known is None and node_id in self._described:
            known, _ = self._sources.models.get(node_id, (None, None))
        return known

    def _with_others(self, uses: DescribedUses) -> DescribedUses:
        """Return a problem with the place of the model, and the other models of the same nodes."""
        models = self._project.described[uses.model.id]
        place = next(place for each, place in models if each is uses.model)
        others = [other for other in models if other[0] is not uses.model]
        others += ((model, NOWHERE) for model in nav2_models([uses.model.id], left_out="").values())
        return uses.replace(place=place, others=tuple(others))  # type: ignore[no-any-return]

    def _with_sources(self, uses: DescribedUses) -> DescribedUses:
        """Return the models with what C++ says of the nodes, too."""
        found = self._sources.models.get(uses.model.id)
        return uses if found is None else uses.replace(others=(*uses.others, found))

    def _dialect(self, node: Node) -> int:
        return self._project.dialects.get(node.span.source.name, 4) if node.span is not None else 4

    def _faults(self) -> Iterator[Diagnostic]:
        """Yield what the engine would refuse, but for trees that are elsewhere, and nodes that aren't ours."""
        project = self._project
        elsewhere = {id for id, model in project.models.items() if model.kind == SUBTREE}
        elsewhere |= project.unread | project.circular
        replaced: dict[tuple[str, int], Node] = {}
        missing: dict[str, list[Diagnostic]] = {}
        own = {name: fold(root, _children, lambda node, inner: self._stand_in(node, inner, replaced))
               for name, root in self._finite.items()}  # fmt: skip
        for problem in tree_problems(self._whole(own), self._vocabulary, self._bind):
            arguments = dict(problem.arguments)
            if problem.code == "BT126":
                if arguments["name"] in elsewhere or self._may_be_included(arguments["name"], problem.span):
                    continue
                if self._may_be_elsewhere(arguments["name"], problem.span):
                    missing.setdefault(arguments["name"], []).append(problem)
                    continue
                listed = ((name, self._as_written(text)) for name, text in problem.arguments)
                problem = problem.replace(arguments=tuple(listed))
            elif self._is_older(problem.span, arguments.get("id", "")):
                continue
            node = replaced.get(_place(problem.span))
            if node is not None and problem.code == "BT132" and arguments["id"] == SEQUENCE:
                reason = arguments["reason"].replace(SEQUENCE, node.id, 1)
                problem = problem.replace(arguments=(("id", node.id), ("reason", reason)))
            yield problem
        for name, found in missing.items():
            yield diagnostic("BT244", found[0].span, name=name, times=count_times(len(found)))
        if self._vocabulary.entries:
            yield from find_misnamed(self._whole(self._project.trees), self._vocabulary)

    def _as_written(self, listed: str) -> str:
        """Return a list of trees without those of an ID that is in it already, which have a number."""
        for name, head in self._project.heads.items():
            listed = listed.replace(f", {name}", "") if name != head.id else listed
        return listed

    def _may_be_included(self, name: str, span: Span) -> bool:
        """Return whether a tree may be in a file that this one, or another one of its program, includes in vain."""
        vain = {problem.span.source.name for problem in self._project.problems if problem.code == NOT_INCLUDED}
        file, project = span.source.name, self._project
        is_one = file in vain or (project.is_joined(file) and any(project.may_share(file, place) for place in vain))
        return is_one and not misspelt(name, project.trees)

    def _may_be_elsewhere(self, name: str, span: Span) -> bool:
        """Return whether a tree may be in a file that isn't checked: nothing is called like it, and this file includes
        no others, so that whoever loads it decides which trees there are.
        """
        project = self._project
        return len(project.dialects) > 1 and not (project.is_joined(span.source.name) or misspelt(name, project.trees))

    def _is_older(self, span: Span, node_id: str) -> bool:
        """Return whether a node of version 3 only has the name of one that format 4 brought."""
        kind = CATALOGUE.get(node_id)
        is_new = kind is not None and kind.origin == BEHAVIOR_TREE_CPP and not kind.tags_3
        return is_new and self._project.dialects.get(span.source.name) == 3

    def _stand_in(self, node: Node, inner: list[Node], replaced: dict[tuple[str, int], Node]) -> Node:
        """Return a node of the engine for one that isn't, around the same children."""
        if not inner:
            return node
        own: Node = node.replace(children=tuple(inner))
        if node.id in CATALOGUE or node.id in self._vocabulary.entries:
            return own
        if node.span is not None:
            replaced[_place(node.span)] = node
        ports = tuple((name, text) for name, text in node.ports if name[:1] == "_")
        return own.replace(id=SEQUENCE, ports=ports)  # type: ignore[no-any-return]

    def _bind(self, node_id: str) -> LeafBinding:
        return bind_placeholder(self._vocabulary, node_id) or LeafBinding(accept_anything)

    def _whole(self, trees: Mapping[str, Node]) -> Tree:
        """Return one tree that uses them all."""
        uses = tuple(Node(SUBTREE, ports=(("ID", name),)) for name in trees)
        return Tree(Node(SEQUENCE, uses, span=next(iter(trees.values())).span), tuple(trees.items()))


def _children(node: Node) -> tuple[Node, ...]:
    return node.children
