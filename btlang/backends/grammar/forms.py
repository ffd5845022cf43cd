"""Forms of missions: the rules of the grammar that are the same for every vocabulary.

The notation is that of `rules.parsed`. What isn't here is made from the vocabulary by `vocabulary_rules.py`:

- `action` is any command of the robot, `steady` one that takes time and may be stopped half-way; `phrase` is any
  condition, `denied` one that says that it isn't so; `value-number` is a value of the type number, and so on;
- `<role>` is every way to say a role of the language, with a value in its slot;
- `<doing>` is a command with the verb form that follows `while`, `<together ...>` two commands that need different
  parts of the robot, with that word between them; `<say n1>`, `<at-fact w1>` and `<subtree r3>` use these names,
  `<keyed n1>` is a command and `<is-keyed n1>` a condition with this value in any slot, and
  `<each-type ...>` makes such a statement for the names of each type, also with `every place` or `a random place`;
- `further` is a command with the ports that its words leave out, `exact-ports` the id of a node with its ports.

A form is made of a `unit`: a leaf, or anything in brackets. So no sentence has two readings.
"""

from __future__ import annotations

MISSION = {
    "mission": r'beginning | (beginning "\n")? (line "\n")* (line | last) | (rule "\n")+ (form "\n")* form',
    "beginning": "valued | defined",
    "line": "form | going-on | if-doing-fails | question",
    "question": '<ask_value> " " quantity | <mind> " " <doing>',
    "form": "leaf | bracketed | joined | before | behind",
    "leaf": "plain | waiting | checking",
    "plain": "action | named | further | <wait> | <wait_time> | <nothing>",
    "named": 'action " " <called> " `n3`"',
    "unit": 'plain | "(" (waiting | checking | bracketed | joined | before | behind) ")"',
    "able": 'action | "(" (action ", " <then> " " unit | checking) ")"',
    "bracketed": '"(" leaf "; " leaf ")"',
}
"""A mission is lines. Only its last one may be without end, as nothing behind it would run."""

CONDITIONS = {
    "condition": "phrase | denied | negation | all-true | one-true | listed-conditions",
    "part": 'phrase | denied | "(" (negation | all-true | one-true | listed-conditions) ")"',
    "negation": '<not> " (" (phrase | all-true | one-true | listed-conditions) ")"',
    "all-true": '(<both> " ")? part " " <and> " " part',
    "one-true": '(part | <either> " (" part ")") " " <or> " " part',
    "listed-conditions": "neither-condition | not-both-condition | condition-list",
    "neither-condition": '<neither> " " phrase " " <nor> " " phrase',
    "not-both-condition": '<not_both> " " phrase " " <and> " " phrase',
    "condition-list": '(<any_of> | <all_of> | <none_of> | <at_least_of 2>) " " phrase ", " phrase " " <and> " " phrase',
    "waiting": "wait-for-condition | wait-lasting | wait-up-to",
    "wait-for-condition": '(<wait_until> | <wait_for>) " " part',
    "wait-lasting": '<wait_until> " (" part ") " (<for> | <held>)',
    "wait-up-to": '<wait_up_to> " " part',
    "checking": '<check> " " part',
}

JOINING = {
    "joined": "listed | then | after | before-command | or | otherwise | and | meanwhile | either | both | one-of"
    " | while-doing",
    "listed": 'action (", " action)+',
    "then": 'unit (", " (<then> | <followed_by>) " " unit)+',
    "after": 'unit ", " <after> " " unit',
    "before-command": 'unit ", " <before> " " unit',
    "or": 'able ", " (<or> | <if_fails>) " " unit',
    "otherwise": 'able ", " <otherwise> " " unit',
    "and": "<together and>",
    "meanwhile": "<together meanwhile>",
    "either": '<either> " " able " " <or> " " unit',
    "both": '<both> " " <together and>',
    "one-of": '<one_of> " " able ", " able " " <or> " " unit',
    "while-doing": "<together while doing>",
}

BEFORE = {
    "before": "if | unless | while | until | as-soon-as | try | retry | repeat-count | repeat-condition | repeat-time"
    " | delayed | at-time | doing-first | doing-after | keep-doing",
    "if": '<if> " " condition ", " unit (", " <otherwise> " " unit)?',
    "unless": '<unless> " " part ", " unit (", " <otherwise> " " unit)?',
    "while": '<while> " " condition ", " lasting (", " <otherwise> " " lasting)?',
    "until": '<until> " " part ", " lasting',
    "as-soon-as": '(<as_soon_as> | <once>) " " condition ", " unit',
    "try": '<try> " " able (", " <otherwise> " " unit)?',
    "retry": '(<retry> | <try>) " " able " " <count> (" " <every>)?',
    "repeat-count": '<repeat> (" " lasting " " <count> | " " <count> ": " lasting)',
    "repeat-condition": '<repeat> " " (lasting " " condition-kept | condition-kept ": " lasting)',
    "condition-kept": '(<until> | <while>) " " part',
    "repeat-time": '<repeat> " " <for> ": " lasting',
    "delayed": '<delay> ", " unit',
    "at-time": '<at> ", " unit',
    "doing-first": '<before> " " <doing> ", " unit',
    "doing-after": '<after> " " <doing> ", " unit',
    "if-doing-fails": '<if> " " <doing> " " <fails> ", " unit',
    "keep-doing": '<keep> " " <steady doing> " " (<for> | (<until> | <while>) " " part)',
}

BEHIND = {
    "behind": "if-behind | unless-behind | while-behind | provided | stop-when | once-behind | times | if-possible"
    " | within | by-time | for | up-to | until-time | times-every | times-apart | delayed-behind | constrained",
    "if-behind": 'unit " " <if> " " part (", " <otherwise> " " unit)?',
    "unless-behind": 'unit " " <unless> " " part',
    "while-behind": '<repeat> " " lasting " " (<while> | <until>) " " part',
    "provided": 'lasting " " <provided> " " part',
    "stop-when": 'lasting " " <stop_when> " " part',
    "once-behind": 'unit " " (<as_soon_as> | <once>) " " part',
    "times": 'lasting " " <count>',
    "if-possible": 'unit " " <if_possible>',
    "within": 'lasting " " <within>',
    "by-time": 'lasting " " <by_time>',
    "for": 'lasting " " <for>',
    "up-to": 'lasting " " <up_to>',
    "until-time": 'lasting " " <until_time>',
    "times-every": 'lasting " " <every> " " <count>',
    "times-apart": 'lasting " " <count> " " <apart>',
    "delayed-behind": 'unit " " <delay>',
    "constrained": 'lasting " " (<but> " ")? (<without_entering> | <without_leaving>)',
    "lasting": 'steady | "(" steady " " <then> " " steady ")"',
}
"""A command that is repeated takes time, and one that may be stopped half-way doesn't mind."""

STATEMENTS = {
    "rule": '(<whenever> | <first_time>) " " (condition | part " " (<for> | <held>)) ", " unit',
    "going-on": "if-that-fails | if-that-works | in-any-case | do-that | stop-that | meanwhile-next | finally",
    "if-that-fails": 'able ". " (<if_fails> | <otherwise>) ", " unit',
    "if-that-works": 'unit ". " (<if_works> | <if_it_works>) ", " unit (". " <otherwise> ", " unit)?',
    "in-any-case": 'unit ". " <in_any_case> ", " unit',
    "do-that": 'lasting ". " (<do_that> " " (<count> | <again> | <more>) | <repeat_that> " " <count> | <again>)',
    "stop-that": 'lasting ". " <stop_that> " " part',
    "meanwhile-next": "<together . meanwhile>",
    "finally": '<ordinal> ", " unit',
    "last": "<wait_forever> | forever | retry-forever | every-round | every-day | on-days | start-over | failing",
    "forever": '<repeat> " " lasting | lasting " " <forever>',
    "retry-forever": '<retry> " " lasting',
    "every-round": '<every> ", " lasting (" " <count>)? | lasting " " <every>',
    "every-day": '<every_day> ": " unit',
    "on-days": '<on_days> ": " unit',
    "start-over": 'lasting ". " (<start_over> | <everything> " " <count>)',
    "failing": "<fail>",
}

VALUES = {
    "valued": "number-value | name-value | measured | counted | for-each | chosen",
    "number-value": '<set> " n1 " <set_to> " " value-number "; " <if> " n1 " <compare number> ", " unit',
    "counted": '<set> " n1 " <set_to> " " value-number "; " changed "; " <say n1>',
    "changed": "changed-by | added | subtracted",
    "changed-by": '(<increase> | <decrease>) " n1" (" " <by> " " value-number)?',
    "added": '<add> " " value-number " " <add_to> " n1"',
    "subtracted": '<subtract> " " value-number " " <subtract_from> " n1"',
    "name-value": "<each-type set>",
    "measured": '<remember> " " quantity " " <remember_as> " n2; " <say n2>',
    "for-each": "<each-type each>",
    "chosen": "<each-type chosen>",
}
"""Values are set where they are used. A letter and a figure is no word of any language."""

DEFINITIONS = {
    "defined": "definition | quoted-definition | with-parameter | mission-name | condition-definition | fact"
    " | given-values | exact-node",
    "definition": '"r1 " (<define> | <define_strong>) " " unit "\\nr1"',
    "quoted-definition": '"`r3` " <define_strong> " " unit "\\n" <do> " " (<subtree r3> | "`r3`")',
    "with-parameter": "<each-type parameter>",
    "mission-name": '<main_name> " `r4`\\n" unit',
    "given-values": '<given> " {n1}\\n" <keyed n1> | <given> " {n1}, {n2}\\n" (<keyed n2> | keyed-if)',
    "keyed-if": '<if> " " <is-keyed n2> ", " <keyed n1>',
    "condition-definition": '"c1 " <define_strong> " " part "\\n" <if> " c1, " unit',
    "fact": '"w1 " <fact> " (" value-number ", " value-number ")" (" " <facing> " " value-angle)? "\\n" <at-fact w1>',
    "exact-node": "exact-command | named-command | command-with-ports | exact-check",
    "exact-command": '<do> " " (<node> " ")? exact-action',
    "named-command": '<do> " " exact-action " " <called> " `n3`" | "`n3`: " (action | <do> " " exact-action)',
    "command-with-ports": '<do> " " exact-ports',
    "exact-check": '<check> " " <test> " " exact-condition',
}

FORMS = {**MISSION, **CONDITIONS, **JOINING, **BEFORE, **BEHIND, **STATEMENTS, **VALUES, **DEFINITIONS}
