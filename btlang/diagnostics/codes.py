"""Every code that a message can have, with its texts. Codes are a contract: they are never given a new meaning.

BT00x reading, BT01x words, BT02x and BT03x how a sentence is put together, BT04x what it means,
BT05x what is allowed but probably not meant, BT06x keyword files,
BT07x worlds, BT08x the Python behind the words and what else has to be installed, BT09x the codes themselves,
BT10x ROS 2, BT11x missions as ROS 2 nodes, BT12x trees in XML, BT13x trees that were not written as missions,
BT14x nodes said by their ids, BT15x lists, words that stand for names, and what is forbidden,
BT16x times of day, BT17x sentences that people mean in two ways, BT18x tests.

BT05x and others that are warnings have a `name`, by which a mission silences them: `# allow: two readings`.
Each code has a page in `pages/`, which `btc explain` prints.
"""

from __future__ import annotations

from btlang.record import Record


class Code(Record):
    """The texts of a code; words in braces are filled by the arguments of the diagnostic.

    `since` is the version that has it first; `status` is stable, preview or deprecated.
    """

    code: str
    message: str
    hint: str = ""
    severity: str = "error"
    name: str = ""
    since: str = "0.1.0"
    status: str = "stable"


_ALL = (
    Code("BT001", "I can't read {file}: {reason}."),
    Code("BT002", "This isn't text: the byte here isn't UTF-8.", "Save the mission as plain UTF-8 text."),
    Code("BT003", "I can't read '{characters}' in a mission.", "If the robot is to say it, put it in double quotes."),
    Code("BT004", "This quote isn't closed.", "Close it with a double quote on the same line."),
    Code("BT005", "There is no command in this mission.", "Write at least one, for example: {example}"),
    Code("BT006", "This line is indented, but the line above it doesn't open a block.",
         "Align it with the line above, or end the line above with ':'."),
    Code("BT007", "This line's indentation matches no line above it.",
         "Align it with one of the lines above."),
    Code("BT008", "There is no example '{name}'.", "Run 'btc examples' to list them."),
    Code("BT009", "I can't write {file}: {reason}."),
    Code("BT010", "I don't know the {kind} '{words}'."),
    Code("BT011", "'{words}' doesn't fit here: {wanted}.", "Write for example: {example}"),
    Code("BT012", "After '{words}' I expected {wanted}.", "Write for example: {example}"),
    Code("BT013", "There's no {type} called '{words}'."),
    Code("BT014", "'{words}' is out of range: {wanted}."),
    Code("BT015", "A name can't contain the word '{word}', which joins commands.", "Choose another name."),
    Code("BT016", "There is no name before '{word}'.", "Write for example: patrol {word} go to the lobby"),
    Code("BT017", "'{name}' is defined again; this definition replaces the one above.", severity="warning", name="redefined name"),
    Code("BT018", "'{name}' is a known phrase; from now on it means this definition.", severity="warning", name="hiding name"),
    Code("BT019", "This is a value, but there's no command that uses it.", "Start with what to do, for example: {example}"),
    Code("BT020", "A {wanted} must follow '{word}', but {found}."),
    Code("BT021", "There's no word between these two commands.",
         "Put 'then', 'and' or 'or' before '{word}'."),
    Code("BT022", "'{word}' has nothing before it to join.",
         "Put a command before it, for example: {example} {word}"),
    Code("BT023", "This bracket isn't closed.", "Add ')' where the group ends, on the same line."),
    Code("BT024", "This bracket doesn't close anything.", "Remove it, or add '(' where the group begins."),
    Code("BT025", "These brackets are empty."),
    Code("BT026", "Unexpected ':'.", "A ':' follows for example 'if ...', 'repeat', 'otherwise' or 'patrol is'."),
    Code("BT027", "This line opens a block, but no indented line follows it.", "Indent the lines that belong to it."),
    Code("BT028", "'{words}' is a condition, not a command.", "To make it a step that fails when it isn't true, write: check {words}"),
    Code("BT029", "'{words}' is a command, but a condition is needed {place}."),
    Code("BT030", "'{words}' doesn't say how often or how long.", "Write for example: {words} 3 times"),
    Code("BT031", "'{words}' must stand behind 'A and B', or before a command.", "Write for example: wave and nod {words}"),
    Code("BT032", "Unexpected comma {place}.", "{advice}"),
    Code("BT033", "A definition can't be inside a block or brackets.", "Move it to the left margin."),
    Code("BT034", "'{words}' has two lists, and I don't know how to combine them.",
         "Use one list for each command."),
    Code("BT035", "'{words}' opens a block: a ':' and indented lines must follow.", "Write:\n  {words}:\n    first command\n    second command"),
    Code("BT036", "I can't read this place.", "Give it in metres, with or without a direction, for example: {example}"),
    Code("BT037", "'{words}' is a rule for the other lines, so it must start a line.", "For a single command, write 'if ...' or '... until ...'."),
    Code("BT038", "'{words}' doesn't refer to anything: there's no {type} before it in this sentence.", "Name it, for example: {example}"),
    Code("BT039", "I can't read '{words}': a name and a value are needed.", "Write for example: {example}"),
    Code("BT040", "'{name}' is defined in terms of itself: {circle}.", "To do it again, use 'repeat' or 'while'."),
    Code("BT041", "'{first}' and '{second}' both need the {resource} at the same time.",
         "Do one after the other: {fixed}"),
    Code("BT042", "With its names filled in, this mission has more than {limit} nodes."),
    Code("BT043", "There's no value called '{name}' here."),
    Code("BT044", "'{name}' is of type {kind}, but {wanted} is needed."),
    Code("BT045", "'{name}' is already a value of the whole mission.", "Choose another name."),
    Code("BT046", "'{file}' includes itself: {circle}.", "Move what both need into a third file."),
    Code("BT047", "I can't read '{words}': it needs a line to itself and the name of a file in quotes.", "Write for example: {example}"),
    Code("BT048", "'{name}' is of type {kind} here but of type {other} elsewhere in this mission.", "Give each a different name."),
    Code("BT049", "'{words}' can't be used: {reason}."),
    Code("BT050", "This can be read in two ways.",
         "I read: {taken}\nIt could also mean: {other}\nDecide with a comma or brackets, for example: {fixed}",
         "warning", "two readings"),
    Code("BT051", "No command uses '{name}'.", "Use it or remove it.", "warning", "unused name"),
    Code("BT052", "This never runs, because what comes before it {reason}.", "", "warning", "never runs"),
    Code("BT053", "This loop never waits: a round takes no time, so it runs again at every tick.", "{advice}",
         "warning", "busy loop"),
    Code("BT054", "'{words}' shouldn't be stopped half-way, but it will be {when}.",
         "{advice}", "warning", "cut off"),
    Code("BT055", "This isn't part of '{name}': its definition ends with the sentence.",
         "Join the commands with '{then}', or write them as indented lines below '{head}'.",
         "warning", "line end in a definition"),
    Code("BT056", "There's no warning called '{name}'.", "Similar: {near}", "warning", "unknown warning"),
    Code("BT057", "'{words}' needs a number of rounds before it.", "Write for example: wave 3 times {words}"),
    Code("BT058", "'{words}' can be read in two ways.",
         "If it must be true all that time, write: {until} {amount}\nIf that is how long to wait at most, write: {until} {at_most}"),
    Code("BT059", "'{words}' repeats the commands before it, but a rule stands among them.",
         "Put the lines with 'whenever' above all commands of the block."),
    Code("BT060", "This keyword file can't be used: {reason}."),
    Code("BT061", "This phrase can't be used: {reason}."),
    Code("BT062", "'{first}' ({first_id}, {first_file}) and '{second}' ({second_id}, {second_file}) can match the same words.",
         "Change one of them, or give both the same id."),
    Code("BT063", "There's no keyword file or pack called '{name}'.", "Give the path of a TOML file or the name of an installed pack."),
    Code("BT064", "'{id}' already has a function, from {file}, and only one can run.",
         "To run yours instead, write {fixed}; otherwise give it another id."),
    Code("BT065", "There's no language called '{name}'.",
         "The languages that ship: {known}. For another one, give the folder that holds its language.toml."),
    Code("BT066", "'{word}' has got another meaning in this mission already.", "Keep one of the two lines."),
    Code("BT067", "There's no command before '{words}' that it could go on with.",
         "Put a command before it, or start with what to do."),
    Code("BT068", "'{words}' is checked only once, when the mission gets here.", "{advice}", "warning", "asked once"),
    Code("BT069", "'{joint}' means at the same time here, on the way or while waiting.",
         "To keep that, write: {both}\nTo do one after the other, write: {after}", "warning", "and"),
    Code("BT070", "This world file can't be used: {reason}."),
    Code("BT071", "This robot file can't be used: {reason}."),
    Code("BT072", "The robot '{robot}' has no {parts}, which '{words}' needs.", "Leave it out, or choose another robot with --robot."),
    Code("BT080", "The command '{id}' can't run: {reason}."),
    Code("BT081", "Pictures need matplotlib, which isn't installed.", "Install it: pip install 'btlang[pictures]'"),
    Code("BT082", "btc mcp needs the Python package mcp, which isn't installed.", "Install it: pip install 'btlang[mcp]'"),
    Code("BT083", "Recordings need the Python package mcap, which isn't installed.", "Install it: pip install 'btlang[record]'"),
    Code("BT084", "{file} isn't a recording of btlang.", "Record a run with: btc run FILE --record {file}"),
    Code("BT090", "There's no message code '{name}'.", "Run 'btc explain' to list them."),
    Code("BT099", "btlang has a bug: {error}.", "{advice}"),
    Code("BT100", "ROS 2 can't be used: {reason}.", "{advice}"),
    Code("BT101", "'{words}' needs the {sort} {name}, but {reason}.", "To list all that the mission needs of the robot, add --preflight."),
    Code("BT102", "The ros table of '{phrase}' can't be used: {reason}.", "See docs/ros_words.md for its keys."),
    Code("BT103", "The ros table of '{phrase}' uses a slot {{{slot}}} that the phrase doesn't have."),
    Code("BT104", "'{phrase}' needs the ROS 2 interface {type}, which isn't installed here.", "{advice}"),
    Code("BT105", "{type} has no field '{field}', which the ros table of '{phrase}' uses.", "{advice}"),
    Code("BT106", "The ros table of '{phrase}' doesn't fit {type}: {reason}."),
    Code("BT110", "The ROS 2 interfaces of btlang aren't compiled: {reason}.", "Compile them once: python -m btlang.ros.interfaces --own"),
    Code("BT120", "This isn't valid XML: {reason}."),
    Code("BT121", "XML with {what} is refused.", "{advice}"),
    Code("BT122", "{what} {problem}.", "{advice}"),
    Code("BT123", "<{tag}> needs the attribute {attribute}.", "{advice}"),
    Code("BT124", "The tree '{name}' contains itself: {circle}.", "To do it again, put it below a Repeat node."),
    Code("BT125", "There are several trees, and it isn't clear which is the main one: {names}.",
         "Write into <root>: main_tree_to_execute=\"{first}\"\nOr choose one: btc run --main \"{first}\" FILE"),
    Code("BT126", "There's no tree called '{name}'."),
    Code("BT127", "There are two trees called '{name}'.", "Give each a different ID."),
    Code("BT128", "'{path}' can't be included: {reason}."),
    Code("BT129", "'{words}' isn't possible in XML: {reason}."),
    Code("BT130", "No keyword entry has the id '{id}'."),
    Code("BT131", "There's no node '{id}' that takes children."),
    Code("BT132", "The node '{id}' can't be used like this: {reason}."),
    Code("BT133", "This isn't a tree in JSON: {reason}.", "See docs/targets.md for the format."),
    Code("BT134", "{target} can't express the node '{id}': {reason}."),
    Code("BT141", "I can't read on at '{words}': {wanted} is needed.", "Write for example: do \"OpenGripper\" with width 0.05"),
    Code("BT142", "English can't express this tree: {reason}."),
    Code("BT150", "'{words}' doesn't fit here: {reason}.", "Write for example: {example}"),
    Code("BT151", "'{words}' can be read in two ways.", "Write what you mean: {one}\nOr: {other}"),
    Code("BT152", "'{words}' doesn't fit here: {reason}.", "{advice}"),
    Code("BT153", "A point such as '{words}' doesn't fit here: a place with a name is needed.", "Name it in a line of its own: {fact}"),
    Code("BT154", "'{words}' is only a part of a command or condition.", "Write for example: {example}"),
    Code("BT155", "'{words}' forbids something, but a mission only says what the robot does.",
         "Write for example: {example}"),
    Code("BT160", "'{words}' {problem}.", "Write for example: {example}"),
    Code("BT170", "'{words}' starts again each time it has ended.",
         "To keep that, write: {again}\nTo do it once, write: {once}", "warning", "starts again"),
    Code("BT171", "All that follows waits for '{condition}', too.",
         "To keep that, write: {wait}\nTo do the rest meanwhile, write: {first}", "warning", "waits first"),
    Code("BT172", "'{words}' repeats {what}.",
         "To keep that, write: {taken}\nIf not, write: {other}", "warning", "repeated"),
    Code("BT173", "'{words}' has only rules, so it goes on for ever here, and other commands don't run meanwhile.",
         "To let it watch beside them, write: {fixed}", "warning", "only rules"),
    Code("BT180", "'{words}' isn't a line of a test.", "Write for example: {wanted}"),
    Code("BT181", "This test can't run: {reason}.", "Write for example: {example}"),
    Code("BT182", "'{words}' {reason}."),
    Code("BT183", "{file} has tests, not a mission.", "To run them: btc test {file}"),
    Code("BT184", "There are no tests in {path}.", "The name of a file of tests ends with .test.txt."),
)  # fmt: skip

CODES = {entry.code: entry for entry in _ALL}
NAMES = {entry.name: entry.code for entry in _ALL if entry.name}
"""The code of each warning by its name."""
PLAIN = frozenset(f"BT{number:03}" for number in (
    *(1, 4, 5, 6, 7, 8, 9, 14, 15, 16, 19, 22, 23, 24, 25, 27, 33, 39, 46, 47, 56),
    *(63, 65, 81, 90, 99, 103, 105, 120, 126, 127),
))  # fmt: skip
"""Codes whose messages say all that their pages do."""
