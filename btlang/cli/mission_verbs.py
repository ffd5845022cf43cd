"""The verbs that read missions and run nothing, those about words, and those that start an editor or the prompt."""

from __future__ import annotations

import argparse
import os
import sys
from functools import partial

from btlang.api import Mission, format_mission
from btlang.cli.missions import hint_at_text, mission_of, parse_mission, read_typed
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.support.test_files import is_test_file
from btlang.text.formatting import one_line
from btlang.text.output import listing_width, pass_on, show
from btlang.text.source import Source

_SUCCESS, _UNFORMATTED, _BAD_INPUT = 0, 1, 2
_PAGES = "markdown"


def show_tree(options: argparse.Namespace) -> int:
    """Print or draw the tree of a mission."""
    from btlang.tree.dump import plain

    mission = mission_of(options)
    if options.picture is not None:
        _draw_tree(mission, options.picture, options.apart)
        return _SUCCESS
    show(plain(mission.tree) if options.plain else mission)
    return _SUCCESS


def _draw_tree(mission: Mission, path: str, apart: bool) -> None:
    from btlang.pictures.files import check_picture
    from btlang.pictures.tree_picture import draw_tree

    check_picture(path)
    draw_tree(mission.tree, mission.label, mission.is_action, path, apart=apart)
    show(f"Wrote {path}.")


def explain(options: argparse.Namespace) -> int:
    """Explain a mission or a code, or list the codes."""
    from btlang.diagnostics.explain import all_codes, explain_code, is_code

    subject = options.file
    if options.text is not None or (subject is not None and not is_code(subject) and _is_file(subject)):
        show(mission_of(options).explain(listing_width(100)))
    elif subject is not None:
        with hint_at_text(subject, "explain"):
            show(explain_code(subject))
    else:
        show(all_codes())
        show("\nTo read one: btc explain CODE")
    return _SUCCESS


def _is_file(subject: str) -> bool:
    """Return whether it names a file, which may be missing: a word alone that names none is meant as a code."""
    return subject == "-" or os.path.exists(subject) or (subject != "" and not subject.isalnum())


def format_files(options: argparse.Namespace) -> int:
    """Format files in place; standard input and a text of the command line go to standard output."""
    sources = [partial(read_source, path, options.include_root) for path in options.file]
    if options.text is not None:
        sources = [partial(read_typed, options)]
    code = _SUCCESS
    for read in sources:
        try:
            if _format_one(read(), options):
                code = code or _UNFORMATTED
        except MissionError as error:
            options.report.add(error.diagnostics)
            code = _BAD_INPUT
    return code


def _format_one(source: Source, options: argparse.Namespace) -> bool:
    """Format one text; return whether `--check` found that it would change."""
    if is_test_file(source.name):
        from btlang.testing.test_file import format_tests

        text = format_tests(source)
    else:
        text = format_mission(
            source, parser=options.parser, keywords=options.keywords, world=options.world, language=options.language
        )
    changes = text != source.text
    if options.check:
        if changes:
            show(f"{source.name} would change.")
        return changes
    if options.text is not None or source.name == "-":
        pass_on(text)
    elif changes:
        from btlang.diagnostics.files import replace_text

        replace_text(source.name, text)
        show(f"Formatted {source.name}.")
    return False


def compile_mission(options: argparse.Namespace) -> int:
    """Write what the options ask for; return the exit code. Raises MissionError."""
    from btlang.backends.targets import TARGETS, target_of

    name = options.to or ("xml" if options.onto is not None else target_of(options.out or ""))
    if not name:
        options.refuse(f"choose a target with --to: {', '.join(TARGETS)}")
    if options.out is None and TARGETS[name].binary and sys.stdout.isatty():
        options.refuse(f"{name} isn't text; write it to a file with -o FILE")
    for option in ("dialect", "onto"):
        if getattr(options, option) is not None and option not in TARGETS[name].options:
            options.refuse(f"--{option} is for xml, not for {name}")
    if name == _PAGES and options.text is None:
        _write_pages(options)
        return _SUCCESS
    if len(options.file) > 1:
        options.refuse(f"{name} takes one file; several are for --to {_PAGES}")
    options.file = options.file[0] if options.file else None
    if options.onto is not None:
        if options.dialect is not None:
            options.refuse("the dialect is that of the file with --onto")
        from btlang.editing.english_of_xml import write_onto

        write_onto(mission_of(options, tells_undeclared=False), options.onto, options.out, force=options.force)
        return _SUCCESS
    from btlang.backends.checking import missing_trees
    from btlang.diagnostics.files import write_output

    mission = mission_of(options, tells_undeclared=False)
    if TARGETS[name].runs and (problems := missing_trees(mission.tree, mission.vocabulary)):
        raise MissionError(problems)
    write_output(mission.to(name, dialect=options.dialect), options.out)
    return _SUCCESS


def _write_pages(options: argparse.Namespace) -> None:
    from btlang.documents.pages import write_pages
    from btlang.documents.project import read_documents

    vocabulary = world_vocabulary(options.keywords, options.world, options.language)
    project = read_documents(options.file, vocabulary, partial(parse_mission, options=options))
    if not write_pages(project, options.file, options.out):
        options.refuse("several files become several pages; name a folder for them with -o FOLDER")


def write_grammar(options: argparse.Namespace) -> int:
    """Write a grammar of missions."""
    from btlang.backends.grammar.targets import GRAMMARS
    from btlang.diagnostics.files import write_output

    write_output(GRAMMARS[options.to](world_vocabulary(options.keywords, options.world, options.language)), options.out)
    return _SUCCESS


def list_words(options: argparse.Namespace) -> int:
    """List words, or with `--from` write a keyword pack; return the exit code. Raises MissionError."""
    search = " ".join(options.search)
    if options.sources:
        if search or options.all:
            options.refuse("--from makes words and lists none; leave out --all and what to search for")
        _make_words(options)
        return _SUCCESS
    if options.out is not None:
        options.refuse("-o is for the words that --from makes")
    from btlang.robots.worlds.name_listing import list_words as lines_for
    from btlang.vocabulary.listing import overview

    vocabulary = world_vocabulary(options.keywords, options.world, options.language)
    if search or options.all:
        show("\n".join(lines_for(vocabulary, search, listing_width())))
    else:
        show("\n".join(overview(vocabulary, listing_width())))
    return _SUCCESS


def _make_words(options: argparse.Namespace) -> None:
    """Write the pack; the nodes that it has no words for go to the report."""
    from btlang.backends.keyword_pack import pack_of_files
    from btlang.diagnostics.files import write_output
    from btlang.passes.lint.allow import not_allowed
    from btlang.vocabulary.load import vocabulary_with

    vocabulary = world_vocabulary(options.keywords, options.world, options.language)
    load = partial(vocabulary_with, keywords=options.keywords, language=options.language)
    pack, _ = pack_of_files([read_source(path) for path in options.sources], vocabulary, load)
    options.report.add(not_allowed(pack.warnings))
    write_output(pack.text, options.out)


def show_examples(options: argparse.Namespace) -> int:
    """List, print or copy the example missions."""
    from btlang.cli import examples

    chosen = examples.find_examples(options.name) if options.name else examples.all_examples()
    if options.copy is not None:
        written = examples.copy_examples(options.copy, chosen)
        show("\n".join((*written, *examples.describe_start(options.copy, chosen))))
    elif options.name:
        show("\n\n".join(example.text.rstrip("\n") for example in chosen))
    else:
        show("\n".join(examples.list_examples(listing_width())))
    return _SUCCESS


def make_project(options: argparse.Namespace) -> int:
    """Make the folder of a new project; return the exit code. Raises MissionError (BT009)."""
    from btlang.templates import project

    worlds = [path for path in (options.map, options.waypoints) if path is not None]
    if options.urdf is None and not worlds:
        show("\n".join(project.make_project(options.kind, options.name)))
    elif options.kind != "robot":
        options.refuse("--from, --map and --waypoints are for a robot")
    else:
        from btlang.templates.own_robot import own_robot

        template = project.template_text(options.kind, options.name, "robot.toml")
        own = own_robot(options.name, options.urdf, worlds, template, options.start, options.origin)
        show("\n".join(map(one_line, own.found)))
        show("\n".join(project.make_project(options.kind, options.name, own.files, own.checks)))
        show("\n".join(one_line(f"Check: {check}") for check in own.checks), sys.stderr)
    show(f"\nGo on in the folder {options.name}: its README.md says how to try it.")
    return _SUCCESS


def edit(options: argparse.Namespace) -> int:
    """Show a page for one file until Ctrl-C, or open an XML file in English in an editor. Raises MissionError."""
    if options.editor:
        from btlang.editing.english_of_xml import edit_xml

        return edit_xml(options)
    from btlang.server.page import editor

    return editor.edit(options)


def start_prompt(options: argparse.Namespace) -> int:
    """Start the prompt."""
    from btlang.cli.robots import platform_of
    from btlang.repl.loop import run_repl

    platform_of(options)
    return run_repl(
        keywords=options.keywords,
        world=options.world,
        parser=options.parser,
        include_root=options.include_root,
        speed=options.speed,
        robot=options.robot,
        language=options.language,
        over=options.over,
    )
