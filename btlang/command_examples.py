"""Examples of the verbs of `btc`, for `btc help VERB` and docs/cli.md. Verbs with acts have theirs beside the acts."""

from __future__ import annotations

EXAMPLES = {
    "repl": (("btc repl --language es", "missions in Spanish"),),
    "run": (
        ("btc run examples/hello.txt", "in real time"),
        ('btc "go to the lab then wave"', "the same verb, for a mission in quotes"),
        ("btc run examples/patrol.txt --speed max", "as fast as the computer can"),
        ("btc run examples/roaming.txt --for 60s --speed 100 --log run.jsonl", "a minute of mission time, with a log"),
        ("btc run examples/patrol.txt --speed max --picture patrol.svg", "with a picture of the run"),
        ("btc run examples/tea_service.txt --speed max --record tea.mcap", "recorded, for btc replay and btc why"),
    ),
    "examples": (
        ("btc examples", "all of them; btc run greeter runs one"),
        ("btc examples --copy missions", "copies them to the folder missions, with their worlds"),
    ),
    "replay": (
        ("btc replay tea.mcap --speed 20", "twenty times as fast as it was"),
        ("btc replay tea.mcap --speed max --from 30s --why", "from the 30th second on"),
    ),
    "watch": (("btc watch tea.mcap", "opens the browser"),),
    "why": (("btc why tea.mcap", "what happened, command by command"),),
    "check": (
        ("btc check examples/hello.txt", "a file"),
        ('btc check -c "move forward 1 m then say done"', "text instead of a file; - is standard input"),
    ),
    "tree": (
        ("btc tree examples/hello.txt", "the tree, drawn with lines"),
        ("btc tree examples/hello.txt --plain", "one line per node, for programs and diffs"),
    ),
    "explain": (
        ("btc explain examples/patrol.txt", "each sentence with brackets, and its tree"),
        ("btc explain BT013", "a message; without a code, all codes"),
    ),
    "words": (
        ("btc words", "the topics"),
        ("btc words wave", "what has to do with waving"),
        ("btc words --all", "everything, with examples"),
    ),
    "format": (("btc format --check examples/hello.txt", "without --check, it changes the file"),),
    "test": (("btc test examples/tests/hello.test.txt", "without a path, all tests below this folder"),),
    "diff": (("btc diff examples/hello.txt examples/patrol.txt", "two missions"),),
    "edit": (("btc edit mission.txt", "opens the browser"),),
    "serve": (("btc serve --port 9443", "port 8443 without the option"),),
    "world": (
        ("btc world", "the world that ships"),
        ("btc world examples/worlds/museum.toml --picture museum.svg", "draws a world"),
        ("btc world check examples/worlds/museum.toml", "reports mistakes in it"),
    ),
    "new": (("btc new robot rover", "the folder rover, whose README.md says how to go on"),),
    "compile": (
        ("btc compile examples/patrol.txt -o patrol.xml", "XML of BehaviorTree.CPP"),
        ("btc compile examples/patrol.txt --to dot", "to standard output"),
    ),
    "grammar": (("btc grammar --to gbnf -o mission.gbnf", "for llama.cpp"),),
    "mcp": (("btc mcp", "the command for your MCP client"),),
    "sim-ros": (("btc sim-ros --speed 2", "twice as fast as real time"),),
    "ros-node": (("btc ros-node --robot ros --mission patrol.txt", "runs the mission when the node is activated"),),
    "ros-devices": (("btc ros-devices --robot rover.toml --simulate", "with simulated devices"),),
    "serve-actions": (("btc serve-actions --only motion speech", "those of two topics"),),
    "help": (("btc help run", "the options of btc run"),),
    "completion": (("btc completion bash", "the script; its first line says where to put it"),),
}  # fmt: skip
"""By verbs: commands, each with what it does."""
