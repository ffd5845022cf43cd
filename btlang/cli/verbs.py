"""The table of verbs: help, shell completion and docs/cli.md are made from it.

A new verb is an entry here and its handler. Handlers are imported when they run.
"""

from __future__ import annotations

from argparse import BooleanOptionalAction
from math import inf

from btlang.cli.options import (
    ADDRESS,
    ANSWERS,
    BROWSER,
    COMPANIONS,
    FILES,
    GROOT,
    JSON,
    LINES,
    MAIN,
    MISSION,
    MISSIONS,
    NAME,
    ORIGIN,
    PICTURES,
    PLATFORMS,
    RATE,
    READING,
    REAL_SPEED,
    REASON,
    RECORDING,
    REPLAY_SPEED,
    ROBOT_SPEED,
    ROBOT_WORDS,
    ROS_ARGS,
    SIM_TIME,
    SIMULATE,
    SPEED,
    START,
    TASK_LAYER,
    TEXT,
    WORDS,
    WORLD,
    OneOf,
    Option,
    Verb,
    VerbAct,
    body_options,
    namespace_option,
)
from btlang.cli.values import (
    at_least,
    between,
    duration,
    library_version,
    network,
    node_name,
    picture,
    port,
    project_name,
    robot_on,
    robot_or_library,
    ros_name,
    size,
)

RUN, WRITE, KEEP_UP = "run and see", "write and check", "keep a robot up"
BUILD, SHARE, ROS, OWN = "build", "share", "ROS 2", "this command"

_UP = (
    "robot", "over", "simulate", "world", "keywords", "rules", "schedules", "store", "durable", "keep", "record",
    "no_recordings", "allow_keywords", "include_root", "speed", "serve", "host", "port", "join", "code", "answers",
)  # fmt: skip
_ADD = ("code", "priority", "label", "restart", "set", "keywords", "json")

_TABLE = (
    Verb(
        "repl", RUN, "start the prompt, as `btc` alone does", "btlang.cli.mission_verbs:start_prompt",
        (*READING, SPEED, *body_options(*PLATFORMS)),
        examples=(("btc repl --language es", "missions in Spanish"),),
        also=("prompt", "shell", "console"),
    ),
    Verb(
        "run", RUN, "run a mission on the simulated robot, or a ROS 2 robot", "btlang.cli.run:run",
        (
            *MISSION, SPEED, RATE,
            Option(
                "--for", type=duration, dest="time_limit", metavar="DURATION",
                help="stop after this time, such as 60s or 2min",
            ),
            Option("--seed", type=int, metavar="N", help="seed of random choices; the log of a run has its seed"),
            ANSWERS,
            Option("--log", metavar="FILE", help="write every event as a line of JSON"),
            *PICTURES,
            Option("--voice", metavar="FILE", help="write what the robot says to a WAV file"),
            Option("--watch", action="store_true", help="show map, text, tree and speech in the browser"),
            BROWSER, LINES,
            Option("--quiet", action="store_true", help="print only errors, and keep no recording for btc why"),
            Option("--record", metavar="FILE", help="record the run as MCAP, for replay, watch, why and Foxglove"),
            Option(
                "--record-scans", type=between(0, 100), default=2.0, metavar="HZ",
                help="with --record: scans per second (default: 2)",
            ),
            GROOT,
            Option(
                "--record-size", type=size, metavar="SIZE",
                help="with --record: begin another file at this size, such as 100MB",
            ),
            *body_options(*PLATFORMS), SIMULATE, SIM_TIME,
            namespace_option("with --robot ros or actions: namespace of the robot (default: none)"),
            Option(
                "--servers", metavar="NS",
                help="with --robot actions: where the servers are (default: /actions in the namespace)",
            ),
            Option(
                "--preflight", action="store_true",
                help="with --robot ros or actions: only list what the mission needs",
            ),
        ),
        examples=(
            ("btc run examples/hello.txt", "in real time"),
            ('btc "go to the lab then wave"', "the same verb, for a mission in quotes"),
            ("btc run examples/patrol.txt --speed max", "as fast as the computer can"),
            (
                "btc run examples/roaming.txt --for 60s --speed 100 --log run.jsonl",
                "a minute of mission time, with a log",
            ),
            ("btc run examples/patrol.txt --speed max --picture patrol.svg", "with a picture of the run"),
            ("btc run examples/tea_service.txt --speed max --record tea.mcap", "recorded, for btc replay and btc why"),
        ),
        also=("simulate", "play", "execute", "launch"),
    ),
    Verb(
        "examples", RUN, "list, print or copy the example missions", "btlang.cli.mission_verbs:show_examples",
        (
            Option("--copy", metavar="FOLDER", help="copy them to a folder, with their worlds"),
            Option("name", nargs="*", metavar="NAME", help="only these examples"),
        ),
        examples=(
            ("btc examples", "all of them; btc run greeter runs one"),
            ("btc examples --copy missions", "copies them to the folder missions, with their worlds"),
        ),
        also=("missions", "samples", "demo", "demos"),
    ),
    Verb(
        "replay", RUN, "replay a run", "btlang.cli.recordings:replay",
        (
            REPLAY_SPEED, LINES,
            Option("--from", type=duration, dest="start", metavar="DURATION", help="begin at this time, such as 5min"),
            Option("--failure", action="store_true", help="begin at the first failure"),
            GROOT, *PICTURES,
            Option("--why", action="store_true", help="at the end, explain what happened, as btc why does"),
            Option("--to", metavar="FILE", help="write the recording as a log file of Groot2 (.btlog)"),
            Option(
                "--as-mission", action="store_true",
                help="run the recorded mission again, and report where the run differs",
            ),
            Option(
                "--keywords", action="append", default=[], metavar="FILE",
                help="with --as-mission: keyword file; may be repeated",
            ),
            *RECORDING,
        ),
        examples=(
            ("btc replay", "the latest run, as it was"),
            ("btc replay tea.mcap --speed 20", "twenty times as fast as it was"),
            ("btc replay tea.mcap --speed max --from 30s --why", "from the 30th second on"),
        ),
    ),
    Verb(
        "watch", RUN, "show a run in the browser, as it was", "btlang.cli.recordings:watch", (BROWSER, *RECORDING),
        examples=(("btc watch", "the latest run"), ("btc watch 3", "task 3 of the robot that is up")),
        also=("view", "browser", "page", "gui"),
    ),
    Verb(
        "why", RUN, "explain what happened in a run or a task, and why it failed",
        "btlang.cli.recordings:explain_run",
        RECORDING,
        examples=(
            ("btc why", "what happened in the latest run, command by command"),
            ("btc why tea.mcap", "what happened in a recorded run"),
        ),
        also=("debug",),
    ),
    Verb(
        "check", WRITE, "report mistakes in missions and trees", "btlang.cli.check:check_files",
        (
            *READING,
            Option(
                "--format", choices="btlang.diagnostics.report:CHECK_FORMATS", default="text",
                help="format of messages: text; json, sarif or github for programs (default: text)",
            ),
            MAIN,
            Option(
                "--models", action="append", default=[], metavar="FILE",
                help="XML file with models of nodes (TreeNodesModel); may be repeated",
            ),
            Option(
                "--btcpp", type=library_version, metavar="VERSION",
                help="version of BehaviorTree.CPP that trees in XML are for (default: 4.10)",
            ),
            Option("--fix", action="store_true", help="write the corrections that are certain into the files"),
            OneOf(
                Option(
                    "file", nargs="*", default=[], metavar="FILE",
                    help="mission, tree or folder of trees, or - for standard input; all XML files are one project",
                ),
                TEXT,
                required=False,
            ),
            ROBOT_WORDS,
        ),
        examples=(
            ("btc check examples/hello.txt", "a file"),
            ('btc check -c "move forward 1 m then say done"', "text instead of a file; - is standard input"),
        ),
        also=("lint", "validate", "verify"),
    ),
    Verb(
        "tree", WRITE, "print the behavior tree of a mission", "btlang.cli.mission_verbs:show_tree",
        (
            *MISSION,
            Option("--plain", action="store_true", help="one line per node: Id port=value"),
            Option(
                "--picture", type=picture(".svg", ".png"), metavar="FILE", help="draw the tree: .svg or .png"
            ),
            Option("--apart", action="store_true", help="draw each named subtree once, below the tree"),
            ROBOT_WORDS,
        ),
        examples=(
            ("btc tree examples/hello.txt", "the tree, drawn with lines"),
            ("btc tree examples/hello.txt --plain", "one line per node, for programs and diffs"),
        ),
        also=("draw", "plan", "graph"),
    ),
    Verb(
        "explain", WRITE, "show how a mission is understood, or explain a message code",
        "btlang.cli.mission_verbs:explain",
        (
            *READING, MAIN,
            OneOf(
                Option(
                    "file", nargs="?", metavar="FILE|CODE",
                    help="mission, - for standard input, or a code such as BT013",
                ),
                TEXT, required=False,
            ),
            ROBOT_WORDS,
        ),
        examples=(
            ("btc explain examples/patrol.txt", "each sentence with brackets, and its tree"),
            ("btc explain BT013", "a message; without a code, all codes"),
        ),
    ),
    Verb(
        "words", WRITE, "list what missions can say", "btlang.cli.mission_verbs:list_words",
        (
            *WORDS,
            Option("--all", action="store_true", help="list everything, with what it does and an example"),
            Option(
                "--from", dest="sources", action="append", default=[], metavar="XML",
                help="make a keyword file for the nodes of this XML file; may be repeated",
            ),
            Option("-o", dest="out", metavar="FILE", help="with --from: file to write (default: standard output)"),
            Option("search", nargs="*", metavar="SEARCH", help="a topic, or words to search for"),
            ROBOT_WORDS,
        ),
        examples=(
            ("btc words", "the topics"),
            ("btc words wave", "what has to do with waving"),
            ("btc words --all", "everything, with examples"),
        ),
        also=("vocabulary", "commands", "phrases"),
    ),
    Verb(
        "format", WRITE, "format missions: indentation, spaces, empty lines", "btlang.cli.mission_verbs:format_files",
        (
            *READING,
            Option("--check", action="store_true", help="change nothing; exit with 1 if a file would change"),
            FILES,
            ROBOT_WORDS,
        ),
        examples=(("btc format --check examples/hello.txt", "without --check, it changes the file"),),
    ),
    Verb(
        "test", WRITE, "run tests of missions, written in English", "btlang.cli.tests:run_tests",
        (
            Option("--name", metavar="TEXT", help="run only tests with this text in their names"),
            Option("--seed", type=int, default=0, metavar="N", help="seed of random choices (default: 0)"),
            Option(
                "--repeat", type=at_least(1), default=1, metavar="N",
                help="run each test with N seeds, from --seed on",
            ),
            Option("--chaos", action="store_true", help="inject faults at random, and check only the safety rules"),
            Option(
                "--jobs", type=at_least(1), metavar="N",
                help="run N tests at the same time (default: one for each core)",
            ),
            Option(
                "--coverage", action="store_true",
                help="mark in the trees which nodes never ran and which outcomes never happened",
            ),
            Option("--junit", metavar="FILE", help="write the results as JUnit XML"),
            Option(
                "--keep", default="test-recordings", metavar="FOLDER",
                help="folder for recordings of failed tests (default: %(default)s)",
            ),
            Option("--include-root", metavar="DIR", help="tests may also run missions below DIR"),
            Option("--quiet", action="store_true", help="print only failures"),
            Option("path", nargs="*", metavar="PATH", help="files or folders of tests (default: this folder)"),
        ),
        examples=(
            ("btc test examples/tests/hello.test.txt", "without a path, all tests below this folder"),
        ),
    ),
    Verb(
        "diff", WRITE, "show what differs between two missions, trees or recorded runs", "btlang.recording.diff:diff",
        (
            *WORDS,
            Option(
                "--markdown", action="store_true", help="print a list in Markdown, for example for a pull request"
            ),
            Option("old", metavar="OLD", help="mission, tree in XML or JSON, or recording"),
            Option("new", metavar="NEW", help="what to compare with it"),
            ROBOT_WORDS,
        ),
        examples=(("btc diff examples/hello.txt examples/patrol.txt", "two missions"),),
        also=("compare",),
    ),
    Verb(
        "edit", WRITE, "write a mission in the browser", "btlang.cli.mission_verbs:edit",
        (
            *WORDS,
            Option("--port", type=int, default=0, metavar="PORT", help="port to listen on (default: a free one)"),
            BROWSER,
            Option("--main", default="", metavar="ID", help="which tree to edit if the file holds several"),
            Option(
                "--editor", action="store_true",
                help="open the editor that the variable EDITOR names, not the browser",
            ),
            Option(
                "file", metavar="FILE",
                help="mission, which may be new, or a tree in XML or JSON; of JSON, a copy is saved",
            ),
        ),
        examples=(("btc edit mission.txt", "opens the browser"),),
    ),
    Verb(
        "lsp", WRITE, "let your editor help with missions, tests, worlds and trees, as a language server",
        "btlang.lsp.server:serve",
        WORDS, examples=(("btc lsp", "the command for your editor"),),
        also=("language-server", "languageserver"),
    ),
    Verb(
        "robot", KEEP_UP, "bring a robot up for many tasks, and control it", "btlang.cli.robot:run_act",
        (
            NAME,
            Option(
                "--robot", type=robot_or_library, default="simulated", metavar="ROBOT",
                help="robot file, installed robot, or library:NAME (default: simulated)",
            ),
            Option(
                "--over", choices=PLATFORMS, help="what the robot in a file runs on (default: as the file says)"
            ),
            SIMULATE,
            Option("--world", metavar="FILE", help="world file, or library:NAME"),
            Option(
                "--keywords", action="append", default=[], metavar="FILE", help="keyword file; may be repeated"
            ),
            *TASK_LAYER, *COMPANIONS,
            Option("--include-root", metavar="DIR", help="let missions include files below this folder"),
            ROBOT_SPEED, REASON,
            Option("--since", metavar="TIME", help="start of the report (default: seven days ago)"),
            JSON,
            Option(
                "item", nargs="*", default=[], metavar="FILE", help="file, text or robot that the act needs"
            ),
        ),
        acts={
            "up": VerbAct("brings a robot up: btc robot up --robot museum.toml", _UP, 0, also=("start", "boot")),
            "down": VerbAct("ends the process of the robot", ("json",), 0, also=("shutdown", "quit", "exit")),
            "status": VerbAct(
                "shows what the robot is doing, or why it can't work", ("json",), 0,
                also=("state", "info", "rules", "rule", "battery"),
            ),
            "list": VerbAct("lists the robots of this computer, up or down", ("json",), 0, also=("ls", "names")),
            "report": VerbAct(
                'reports what was done, and why something wasn\'t: btc robot report --since "2 hours ago"',
                ("since", "json"), 0, also=("log", "logs", "history"),
            ),
            "stop": VerbAct(
                "emergency stop: stops the robot at once", ("reason", "json"), inf,
                also=("estop", "e-stop", "emergency", "emergency-stop", "halt", "kill"),
            ),
            "release": VerbAct(
                "lets the robot move again after a stop", ("json",), 0,
                also=("unlock", "reset", "enable"),
            ),
            "pause": VerbAct("brings the robot to rest in the middle of a task", ("json",), 0),
            "resume": VerbAct("continues after a pause", ("json",), 0, also=("continue",)),
            "step": VerbAct("advances a paused robot by one tick", ("json",), 0),
            "say": VerbAct(
                "says a text, whatever else the robot is doing: btc robot say we close in ten minutes", ("json",), inf
            ),
            "visitor": VerbAct("lets a visitor come, in a simulated world", ("json",), 0),
            "unit": VerbAct("prints a systemd unit that brings the robot up", _UP, 0),
            "check": VerbAct("checks a robot file: btc robot check museum.toml", ()),
            "show": VerbAct("shows the body of a robot: btc robot show museum.toml", ()),
            "urdf": VerbAct("prints the body of a robot as URDF: btc robot urdf museum.toml", ()),
            "import": VerbAct("converts a URDF or MJCF file to a robot file: btc robot import museum.urdf", ()),
            "backup": VerbAct("copies the store into a file: btc robot backup monday.db", ("store",)),
            "restore": VerbAct("fills an empty store from a backup: btc robot restore monday.db", ("store",)),
            "invite": VerbAct("lets a robot on another computer join a server here: btc robot invite lobby", ()),
            "revoke": VerbAct("revokes an invitation, and disconnects the robot: btc robot revoke lobby", ()),
            "invited": VerbAct("lists the invitations", ("json",), 0),
        },
        mixed=True,
    ),
    Verb(
        "task", KEEP_UP, "give work to a robot that is up", "btlang.cli.task:run_act",
        (
            NAME,
            Option("-c", dest="code", metavar="TEXT", help="mission as text"),
            Option(
                "--kind", default="mission", metavar="KIND",
                help="kind of item in the library: mission (default), world, robot or test",
            ),
            Option("--priority", type=int, metavar="N", help="from -100 to 100, higher first (default: 0)"),
            Option(
                "--at", metavar="TIME", help='begin at this time at the earliest: "14:30", "in 10 minutes"'
            ),
            Option("--by", metavar="TIME", help="skip the task if it hasn't begun by this time"),
            Option(
                "--label", action="append", default=[], metavar="TEXT",
                help="label to find the task by; may be repeated",
            ),
            Option(
                "--restart", default="give up", metavar="WHAT",
                help="after a crash: 'give up' (default), 'again' or 'resume'",
            ),
            Option(
                "--set", action="append", default=[], metavar="NAME=VALUE",
                help="initial value of a variable of the mission; may be repeated",
            ),
            Option(
                "--keywords", action="append", default=[], metavar="FILE",
                help="keyword file of the mission; may be repeated",
            ),
            Option("--every", default="", metavar="RULE", help='when a schedule is due: "every day at 9:00"'),
            Option("--zone", default="", metavar="ZONE", help="time zone of the schedule, such as Europe/Berlin"),
            Option(
                "--overlap", default="skip", metavar="WHAT",
                help="if the previous task isn't over: skip (default), queue or replace",
            ),
            Option(
                "--missed", default="skip", metavar="WHAT",
                help="what to do about times when the robot couldn't work: skip (default), once or all",
            ),
            Option(
                "--within", type=duration, metavar="DURATION",
                help="skip a task that hasn't begun this long after its time",
            ),
            Option("--before", type=int, default=0, metavar="TASK", help="move the task before this one"),
            Option("--token", default="", metavar="TOKEN", help="token of the interruption to end"),
            REASON,
            Option("--all", action="store_true", help="list all tasks, including those that are over"),
            Option("--limit", type=at_least(1), metavar="N", help="list at most N entries"),
            Option("--live", action="store_true", help="keep the list on screen, and update it"),
            JSON,
            Option(
                "item", nargs="*", default=[], metavar="FILE",
                help="mission in quotes, mission file, name in the library, or number of a task",
            ),
        ),
        acts={
            "add": VerbAct(
                'gives the robot a task: btc task add "go to the lab", btc task add patrol.txt',
                (*_ADD, "at", "by"), also=("run", "start", "submit", "new"),
            ),
            "list": VerbAct(
                "lists the tasks that aren't over, the next one first: btc task list --live",
                ("all", "live", "limit", "label", "json"), 0, also=("status", "ls", "queue"),
            ),
            "show": VerbAct("shows everything about a task: btc task show 3", ("json",)),
            "why": VerbAct("explains what happened in a task, and why it failed: btc task why 3", ("json",)),
            "cancel": VerbAct(
                "ends a task, and halts its commands: btc task cancel 3", ("reason", "json"),
                also=("stop", "remove", "rm", "abort", "halt"),
            ),
            "kill": VerbAct("ends a task at once, like an emergency stop: btc task kill 3", ("reason", "json")),
            "interrupt": VerbAct(
                "halts a task, which can continue later: btc task interrupt 3 --reason lunch", ("reason", "json"),
                also=("pause", "suspend"),
            ),
            "resume": VerbAct(
                "ends an interruption: btc task resume 3 --token 1f2e", ("token", "json"),
                also=("continue",),
            ),
            "skip": VerbAct("skips a task that hasn't begun: btc task skip 3", ("reason", "json")),
            "move": VerbAct(
                "gives a task another place in the queue: btc task move 3 --before 1", ("priority", "before", "json"),
                also=("priority", "prioritise", "reorder"),
            ),
            "again": VerbAct(
                "adds a copy of an earlier task: btc task again 3", ("json",),
                also=("retry", "repeat", "rerun"),
            ),
            "schedule": VerbAct(
                'adds a schedule: btc task schedule patrol.txt --every "every day at 9:00"',
                (*_ADD, "every", "zone", "overlap", "missed", "within"),
            ),
            "schedules": VerbAct("lists the schedules", ("json",), 0),
            "unschedule": VerbAct(
                "removes a schedule, but not the tasks that it added: btc task unschedule 2", ("json",)
            ),
            "put": VerbAct(
                "saves a file in the library under a name: btc task put tour tour.txt",
                ("code", "kind", "json"), 2,
            ),
            "delete": VerbAct("removes an item from the library: btc task delete tour", ("kind", "json")),
            "library": VerbAct(
                "lists the library, or the revisions of one item: btc task library tour", ("kind", "json")
            ),
            "trail": VerbAct(
                "lists the latest commands, and who gave them: btc task trail --limit 10", ("limit", "json"), 0,
                also=("log", "logs", "history"),
            ),
            "answer": VerbAct("answers a question of the robot: btc task answer yes", ("json",), inf),
        },
        mixed=True,
    ),
    Verb(
        "components", KEEP_UP, "list the components and devices of a robot that is up",
        "btlang.cli.task:change_components",
        (NAME, JSON, Option("item", nargs="?", default="", metavar="NAME", help="name of a component")),
        acts={
            "list": VerbAct("lists the components and devices with their states"),
            "restart": VerbAct("restarts a component: btc components restart camera"),
            "load": VerbAct("loads a component: btc components load camera"),
            "unload": VerbAct("unloads a component: btc components unload camera"),
        },
        usual_act="list",
    ),
    Verb(
        "serve", KEEP_UP, "serve the robots that are up to browsers and programs", "btlang.cli.server:serve",
        (
            *ADDRESS,
            Option(
                "--cert", metavar="FILE", help="certificate (PEM) to use instead of a generated one; needs --key"
            ),
            Option("--key", metavar="FILE", help="key of the certificate (PEM)"),
            Option("--no-tls", action="store_true", help="use plain HTTP, on this computer only"),
            Option(
                "--stop-port", type=port, default=0, metavar="PORT",
                help="port of the emergency stop (default: the next one after --port)",
            ),
            Option(
                "--proxy", action="append", default=[], type=network, metavar="ADDRESS",
                help="address or network of a proxy whose X-Forwarded-For is believed; may be repeated",
            ),
            Option("--until-eof", action="store_true", help="end when standard input ends"),
            Option(
                "--ros", action="append", default=[], type=ros_name, metavar="NAME",
                help="ROS 2 name that rosbridge clients may use, such as '/btlang/*'; may be repeated",
            ),
        ),
        examples=(("btc serve --port 9443", "port 8443 without the option"),),
        also=("web", "dashboard"),
    ),
    Verb(
        "user", KEEP_UP, "manage the users of btc serve", "btlang.cli.users:run_act",
        (
            Option(
                "--role", default="viewer", metavar="ROLE",
                help="with add: viewer (default), operator, editor or administrator",
            ),
            Option(
                "name", nargs="?", default="", metavar="NAME", help="name of a user; for backup and restore: a file"
            ),
            Option("item", nargs="?", default="", metavar="WHAT", help="name of a token; for role: a role"),
        ),
        acts={
            "list": VerbAct("lists the users"),
            "add": VerbAct("adds a user, and asks for a password: btc user add ana --role operator"),
            "passwd": VerbAct("changes a password: btc user passwd ana"),
            "role": VerbAct("changes the role of a user: btc user role ana editor"),
            "remove": VerbAct("removes a user: btc user remove ana"),
            "token": VerbAct("creates a token for a program: btc user token ana dashboard"),
            "tokens": VerbAct("lists the tokens of a user: btc user tokens ana"),
            "revoke": VerbAct("revokes a token: btc user revoke ana dashboard"),
            "logout": VerbAct("ends all sessions of a user: btc user logout ana"),
            "trail": VerbAct("lists the latest log-ins, and refused requests"),
            "backup": VerbAct("copies the accounts into a file: btc user backup users.json"),
            "restore": VerbAct("restores the accounts on a server without users: btc user restore users.json"),
        },
        also=("login", "account"),
    ),
    Verb(
        "world", BUILD, "check, draw, import and export world files", "btlang.cli.world:run_act",
        (
            Option(
                "words", nargs="*", default=[], metavar="FILE",
                help="world file; check, import or export may come first (default: the world that ships)",
            ),
            Option(
                "--picture", type=picture(".svg", ".png"), metavar="OUT", help="draw the world: .svg or .png"
            ),
            Option("-o", dest="out", metavar="OUT", help="file to write, or a folder for nav2"),
            Option("--to", choices=("nav2", "json", "yaml"), help="what to export to"),
            START, ORIGIN,
            Option("--level", metavar="NAME", help="the level to import of a building of Open-RMF"),
            Option(
                "--resolution", type=between(0.005, 10.0), metavar="M",
                help="size of a cell of an exported map, in metres (default: 0.05)",
            ),
            Option(
                "--robot", type=robot_on(PLATFORMS), default="simulated", metavar="ROBOT",
                help="robot file, for the robot's size and speed (default: simulated)",
            ),
            Option(
                "--format", choices="btlang.diagnostics.report:FORMATS", default="text",
                help="format of messages: text, or json (default: text)",
            ),
        ),
        examples=(
            ("btc world", "the world that ships"),
            ("btc world examples/worlds/museum.toml --picture museum.svg", "draws a world"),
            ("btc world check examples/worlds/museum.toml", "reports mistakes in it"),
        ),
        mixed=True,
        usage=(
            "btc world [FILE] [--picture OUT]\n       btc world check FILE ...\n"
            "       btc world import FILE ... -o OUT [--start X,Y[,FACING]]\n"
            "       btc world export FILE --to nav2|json|yaml -o OUT"
        ),
        also=("map", "places"),
    ),
    Verb(
        "gesture", BUILD, "play, check, draw and record gestures of a robot", "btlang.cli.gesture:run_act",
        (
            Option("items", nargs="+", metavar="NAME", help="gesture of the robot; for check: files"),
            Option("--robot", default="", metavar="FILE", help="robot file, or the name of a robot"),
            Option("--at", metavar="TARGET", help="place, object or person to aim the gesture at"),
            Option(
                "-o", dest="out", metavar="OUT",
                help="file to write: .svg, .png or .gif, or for record a gesture file",
            ),
            Option("--over", choices=PLATFORMS, help="what the robot runs on (default: as its file says)"),
            ROBOT_SPEED,
            Option("--world", metavar="FILE", help="world file (default: that of the robot)"),
        ),
        acts={
            "play": VerbAct("plays a gesture: btc gesture play wave --robot museum.toml"),
            "check": VerbAct("checks gesture files: btc gesture check wave.toml"),
            "picture": VerbAct("draws a gesture: btc gesture picture wave -o wave.gif --robot museum.toml"),
            "record": VerbAct(
                "records a gesture, pose by pose, moved by hand or typed: "
                "btc gesture record wave -o wave.toml --robot museum.toml"
            ),
        },
        mixed=True,
        usage=(
            "btc gesture play NAME --robot FILE [--at TARGET] [--over PLATFORM] [--speed SPEED]\n"
            "       btc gesture check FILE ... [--robot FILE]\n"
            "       btc gesture picture NAME -o OUT --robot FILE\n"
            "       btc gesture record NAME -o OUT --robot FILE"
        ),
    ),
    Verb(
        "new", BUILD, "create a project: a component, a device or a robot", "btlang.cli.mission_verbs:make_project",
        (
            Option(
                "kind", choices=("component", "device", "robot"), metavar="KIND", help="component, device or robot"
            ),
            Option("name", type=project_name, metavar="NAME", help="name of the project and of its folder"),
            Option("--from", dest="urdf", metavar="URDF", help="for a robot: the URDF or MJCF file that describes it"),
            Option("--map", metavar="YAML", help="for a robot: the map of ROS where it works"),
            Option("--waypoints", metavar="FILE", help="for a robot: way points in JSON or YAML, which become places"),
            START, ORIGIN,
        ),
        examples=(
            ("btc new robot rover", "the folder rover, whose README.md says how to go on"),
            ("btc new robot cart --from cart.urdf --waypoints points.json", "of what you have; --map takes a map"),
        ),
        also=("create", "init"),
    ),
    Verb(
        "compile", SHARE, "write the tree of a mission as XML, English, JSON, a picture ...",
        "btlang.cli.mission_verbs:compile_mission",
        (
            *MISSIONS,
            Option(
                "--to", choices="btlang.backends.targets:TARGETS", metavar="TARGET", help="target: {choices}"
            ),
            Option(
                "-o", dest="out", metavar="OUT",
                help="file to write, or with markdown a folder; without --to, its ending selects the target",
            ),
            Option(
                "--dialect", type=int, choices=(3, 4), help="BehaviorTree.CPP version of the XML (default: 4)"
            ),
            Option(
                "--onto", metavar="XML", help="the file that the mission was made from: change only what was edited"
            ),
            Option(
                "--force", action="store_true",
                help="with --onto: even if the file has changed since, or is a different one",
            ),
            ROBOT_WORDS,
        ),
        examples=(
            ("btc compile examples/patrol.txt -o patrol.xml", "XML of BehaviorTree.CPP"),
            ("btc compile examples/patrol.txt --to dot", "to standard output"),
        ),
        also=("convert", "build", "translate", "export"),
    ),
    Verb(
        "grammar", SHARE, "write a grammar of missions, for language models", "btlang.cli.mission_verbs:write_grammar",
        (
            *WORDS,
            Option(
                "--to", choices="btlang.backends.grammar.targets:GRAMMARS", default="gbnf",
                help="form of the grammar (default: gbnf)",
            ),
            Option("-o", dest="out", metavar="FILE", help="file to write (default: standard output)"),
            ROBOT_WORDS,
        ),
        examples=(("btc grammar --to gbnf -o mission.gbnf", "for llama.cpp"),),
    ),
    Verb(
        "mcp", SHARE, "let language models write and simulate missions, as an MCP server", "btlang.server.mcp:serve",
        WORDS, examples=(("btc mcp", "the command for your MCP client"),),
    ),
    Verb(
        "sim-ros", ROS, "run the simulated robot as a ROS 2 node", "btlang.cli.ros:simulate_robot",
        (
            WORLD, *body_options("simulated"),
            REAL_SPEED,
            Option(
                "--rate", type=RATE.settings["type"], metavar="HZ",
                help="steps per simulated second (default: 20, or 50 for a body whose joints have accelerations)",
            ),
            Option("--clock", action=BooleanOptionalAction, default=True, help="publish simulated time on /clock"),
            Option(
                "--seed", type=int, metavar="N",
                help="what people do by chance (default: the seed of the world, or 0)",
            ),
            namespace_option("namespace of all topics (default: none)"),
        ),
        examples=(("btc sim-ros --speed 2", "twice as fast as real time"),),
    ),
    Verb(
        "ros-node", ROS, "run missions as a ROS 2 node, for other programs", "btlang.cli.ros_nodes:run_mission_node",
        (
            *READING, SPEED,
            Option("--mission", default="", metavar="FILE", help="mission to run when the node is activated"),
            *body_options(*PLATFORMS), SIM_TIME,
            namespace_option(
                "namespace of the node, and with --robot ros or actions of the robot (default: none)"
            ),
            Option("--name", default="btlang", type=node_name, help="name of the node (default: %(default)s)"),
            Option(
                "--autostart", action=BooleanOptionalAction, default=True,
                help="configure and activate the node at once (default), or leave that to a lifecycle manager",
            ),
            *TASK_LAYER, *COMPANIONS, ROS_ARGS,
        ),
        examples=(
            ("btc ros-node --robot ros --mission patrol.txt", "runs the mission when the node is activated"),
        ),
    ),
    Verb(
        "ros-devices", ROS, "show the devices of a robot as ROS 2 topics", "btlang.cli.ros:show_devices",
        (
            WORLD,
            Option(
                "--robot", type=robot_on(()), required=True, metavar="ROBOT",
                help="a robot file or the name of one that ships",
            ),
            SIMULATE,
            namespace_option("namespace of all topics (default: none)"),
        ),
        examples=(("btc ros-devices --robot rover.toml --simulate", "with simulated devices"),),
    ),
    Verb(
        "serve-actions", ROS, "serve btlang's actions as ROS 2 actions", "btlang.cli.ros_nodes:serve_actions",
        (
            *WORDS, *body_options("simulated", "ros"),
            Option(
                "--sim-time", action="store_true", help="with --robot ros: use the time of the topic /clock"
            ),
            REAL_SPEED,
            RATE,
            Option(
                "--only", nargs="+", action="extend", default=[], metavar="ID",
                help="serve only these actions, or topics of `btc words`",
            ),
            Option(
                "--name", default="btlang_actions", type=node_name, help="name of the node (default: %(default)s)"
            ),
            namespace_option("namespace of the actions, and with --robot ros of the robot (default: none)"),
            ROS_ARGS,
        ),
        examples=(("btc serve-actions --only motion speech", "those of two topics"),),
    ),
    Verb(
        "help", OWN, "show this help, or that of a verb", "btlang.cli.parser:print_help",
        (Option("subject", nargs="?", metavar="VERB", help="verb whose options to list"),),
        examples=(("btc help run", "the options of btc run"),),
        also=("man",),
    ),
    Verb(
        "completion", OWN, "print a script that completes btc in a shell", "btlang.cli.completion:print_script",
        (
            Option(
                "shell", choices=("bash", "zsh", "fish"), help="bash, zsh or fish; the script says how to use it"
            ),
        ),
        examples=(("btc completion bash", "the script; its first line says where to put it"),),
    ),
    Verb("version", OWN, "print the version", "btlang.cli:print_version"),
)  # fmt: skip

VERBS = {verb.name: verb for verb in _TABLE}
"""The verbs by name, in the order of `btc help`."""
