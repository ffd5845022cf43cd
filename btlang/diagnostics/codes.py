"""Every code that a message can have, with its texts. Codes are a contract: they are never given a new meaning.

BT00x reading, BT01x words, BT02x and BT03x how a sentence is put together, BT04x what it means,
BT05x what is allowed but probably not meant, BT06x keyword files,
BT07x worlds, BT08x the Python behind the words and what else has to be installed, BT09x the codes themselves,
BT10x ROS 2, BT11x missions as ROS 2 nodes, BT12x trees in XML, BT13x trees that were not written as missions,
BT14x nodes said by their ids.

BT05x and others that are warnings have a `name`, by which a mission silences them: `# allow: two readings`.
Each code has a page in `pages/`, which `btc explain` prints.
"""

from __future__ import annotations

from btlang.record import Record


class Code(Record):
    """The texts of a code; words in braces are filled by the arguments of the diagnostic."""

    code: str
    message: str
    hint: str = ""
    severity: str = "error"
    name: str = ""


_ALL = (
    Code("BT001", "I cannot read {file}: {reason}."),
    Code("BT002", "This is not a text: the byte here is not UTF-8.", "Save the mission as plain UTF-8 text."),
    Code("BT003", "I cannot read '{characters}' in a mission.", "Put it in double quotes if it is a text to say."),
    Code("BT004", "This quote is not closed.", "Close it with a double quote on the same line."),
    Code("BT005", "There is no command in this mission.", "Write at least one, such as: {example}"),
    Code("BT006", "This line is indented, but the line above it opens no block.",
         "Start it where the line above starts, or end the line above with ':'."),
    Code("BT007", "This line is indented less than its block, but it fits no line above.",
         "Start it where one of the lines above starts."),
    Code("BT008", "There is no example '{name}'.", "All of them: btc examples"),
    Code("BT009", "I cannot write {file}: {reason}."),
    Code("BT010", "I do not know how to '{words}'."),
    Code("BT011", "'{words}' does not fit here: {wanted}.", "Write for example: {example}"),
    Code("BT012", "Something is missing after '{words}': {wanted}.", "Write for example: {example}"),
    Code("BT013", "I know no {type} '{words}'."),
    Code("BT014", "'{words}' is out of range: {wanted}."),
    Code("BT015", "A name cannot hold the word '{word}': it joins commands.", "Choose a name without it."),
    Code("BT016", "There is no name before '{word}'.", "A definition reads: patrol {word} go to the lobby"),
    Code("BT017", "'{name}' is defined again; this definition replaces the one above.", severity="warning", name="redefined name"),
    Code("BT018", "'{name}' hides words that I know already: they now mean this definition.", severity="warning", name="hiding name"),
    Code("BT019", "This is a value, but I do not know what to do with it.", "A command starts with what to do, such as: {example}"),
    Code("BT020", "A {wanted} must follow '{word}', but {found}."),
    Code("BT021", "Two commands stand side by side; a word between them must say how they go together.",
         "Put 'then', 'and' or 'or' before '{word}'."),
    Code("BT022", "Nothing stands before '{word}', so it has nothing to join or change.",
         "Put a command before it, such as: {example} {word}"),
    Code("BT023", "This bracket is not closed.", "Add ')' where the group ends; a bracket ends on its own line."),
    Code("BT024", "This bracket closes nothing.", "Take it away, or add '(' where the group begins."),
    Code("BT025", "These brackets hold nothing."),
    Code("BT026", "A ':' has no place here.", "It stands after a form such as 'if ...:', 'repeat:', 'otherwise:' or 'patrol is:'."),
    Code("BT027", "This line opens a block, but no indented line follows.", "Indent the lines that belong to it."),
    Code("BT028", "'{words}' is a condition, not a command.", "To make it a step that fails when it does not hold: check {words}"),
    Code("BT029", "'{words}' is a command, but a condition is needed {place}."),
    Code("BT032", "A comma cannot stand {place}.", "{advice}"),
    Code("BT033", "A definition stands at the left margin, not inside a block or brackets.", "Move it out."),
    Code("BT034", "'{words}' holds two lists, and I do not know how they go together.",
         "Use one list in a command, and another command for the rest."),
    Code("BT035", "'{words}' opens a block, so a ':' and indented lines must follow.", "Write:\n  {words}:\n    first command\n    second command"),
    Code("BT036", "I cannot read this place.", "A place is given in metres, with a direction or without: {example}"),
    Code("BT037", "'{words}' is a rule over other lines, so it stands at the start of a line of its own.", "For one command say: if ..., or: ... until ..."),
    Code("BT038", "'{words}' stands for nothing here: no {type} comes before it in this sentence.", "Name it, such as: {example}"),
    Code("BT039", "I cannot read '{words}': a name and a value are needed.", "Write for example: {example}"),
    Code("BT040", "'{name}' is defined by itself: {circle}.", "Repeat with 'repeat' or 'while' instead."),
    Code("BT041", "Both of these need the {resource} at the same time: '{first}' and '{second}'.",
         "Do one after the other: {fixed}"),
    Code("BT042", "This mission grows to more than {limit} nodes when its names are filled in."),
    Code("BT043", "No value has the name '{name}' here."),
    Code("BT044", "'{name}' is of the type {kind}, and {wanted} is needed."),
    Code("BT045", "'{name}' is the name of a value of the whole mission already.", "Choose another name here."),
    Code("BT046", "'{file}' includes itself: {circle}.", "Put what both need into a third file."),
    Code("BT047", "I cannot read '{words}': it stands alone on its line, with the name of a file in quotes.", "Write for example: {example}"),
    Code("BT048", "'{name}' is of the type {kind} here, and of the type {other} elsewhere in this mission.", "Give each of them a name of its own."),
    Code("BT050", "This can be read in two ways.",
         "I read: {taken}\nIt could also be read: {other}\nA comma or brackets decide, for example: {fixed}",
         "warning", "two readings"),
    Code("BT051", "No command uses '{name}'.", "Use it, or take it away.", "warning", "unused name"),
    Code("BT052", "This never runs, because what comes before it {reason}.", "", "warning", "never runs"),
    Code("BT053", "This loop does not wait: a round of it takes no time, so it goes round at every tick.", "{advice}",
         "warning", "busy loop"),
    Code("BT054", "'{words}' should not be stopped half-way, but it is stopped {when}.",
         "{advice}", "warning", "cut off"),
    Code("BT055", "This is no part of '{name}': its definition ends where the sentence ends.",
         "Join the commands with '{then}', or write them as indented lines below '{head}'.",
         "warning", "line end in a definition"),
    Code("BT056", "There is no warning '{name}'.", "The nearest: {near}", "warning", "unknown warning"),
    Code("BT060", "This keyword file cannot be used: {reason}."),
    Code("BT061", "This phrase cannot be used: {reason}."),
    Code("BT062", "'{first}' ({first_id}, {first_file}) and '{second}' ({second_id}, {second_file}) can match the same words.",
         "Change one of them, or give both the same id."),
    Code("BT063", "There is no keyword file or pack '{name}'.", "Give the path of a TOML file, or the name of an installed pack."),
    Code("BT064", "'{id}' has a function already, from {file}, and only one can run.",
         "To run yours in its place, write {fixed}; else give it another id."),
    Code("BT070", "This world file cannot be used: {reason}."),
    Code("BT071", "This robot file cannot be used: {reason}."),
    Code("BT072", "The robot '{robot}' has no {parts}, which '{words}' needs.", "Leave it out, or choose another robot with --robot."),
    Code("BT080", "The command '{id}' cannot run: {reason}."),
    Code("BT081", "Pictures are drawn by matplotlib, which is not installed.", "Install it: pip install 'btlang[pictures]'"),
    Code("BT090", "There is no code '{name}'.", "All of them: btc explain"),
    Code("BT099", "btlang has a bug: {error}.", "{advice}"),
    Code("BT100", "ROS 2 cannot be used: {reason}.", "{advice}"),
    Code("BT101", "'{words}' needs the {sort} {name}, but {reason}.", "All that the mission needs of the robot: the same command with --preflight"),
    Code("BT102", "The ros table of '{phrase}' cannot be used: {reason}.", "All its keys are in docs/ros_words.md."),
    Code("BT103", "The ros table of '{phrase}' uses a slot {{{slot}}}, and the phrase has none of that name."),
    Code("BT104", "'{phrase}' needs the ROS 2 interface {type}, which is not installed here.", "{advice}"),
    Code("BT105", "{type} has no field '{field}', which the ros table of '{phrase}' names.", "{advice}"),
    Code("BT106", "The ros table of '{phrase}' does not fit {type}: {reason}."),
    Code("BT110", "The ROS 2 interfaces of btlang are not compiled: {reason}.", "Compile them, once: python -m btlang.ros.interfaces --own"),
    Code("BT120", "This is no XML that can be read: {reason}."),
    Code("BT121", "XML with {what} is refused.", "{advice}"),
    Code("BT122", "{what} {problem}.", "{advice}"),
    Code("BT123", "<{tag}> needs the attribute {attribute}.", "{advice}"),
    Code("BT124", "The tree '{name}' contains itself: {circle}.", "To do it again, put it below a node Repeat."),
    Code("BT125", "There are several trees, and I cannot tell which is the main one: {names}.",
         "Write into <root>: main_tree_to_execute=\"{first}\"\nOr choose one: btc run --main \"{first}\" FILE"),
    Code("BT126", "There is no tree '{name}'."),
    Code("BT127", "There are two trees '{name}'.", "Give each of them an ID of its own."),
    Code("BT128", "'{path}' cannot be included: {reason}."),
    Code("BT129", "'{words}' cannot stand in XML: {reason}."),
    Code("BT130", "No keyword entry has the id '{id}'."),
    Code("BT131", "There is no node '{id}' that has children."),
    Code("BT132", "The node '{id}' cannot be used so: {reason}."),
    Code("BT133", "This is no tree in JSON: {reason}.", "Its form is in docs/targets.md."),
    Code("BT134", "The node '{id}' cannot be told to {target}: {reason}."),
    Code("BT141", "I cannot read '{words}' any further: {wanted} is needed.", "Write for example: do \"OpenGripper\" with width 0.05"),
    Code("BT142", "This tree cannot be said in English: {reason}."),
)  # fmt: skip

CODES = {entry.code: entry for entry in _ALL}
NAMES = {entry.name: entry.code for entry in _ALL if entry.name}
"""The code of each warning by its name."""
