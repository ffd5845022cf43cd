"""The phrase trie: longest match of phrases with slots, and the check that no two phrases match the same words.

A node is a dict: word -> node, `END` -> meaning, `SLOTS` -> list of (slot name, type, node).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain

from btlang.text.words import Words
from btlang.vocabulary.entry import MANNER, VIA, Meaning
from btlang.vocabulary.language_tables import LISTED
from btlang.vocabulary.match import Match, SlotValue
from btlang.vocabulary.nouns import Description
from btlang.vocabulary.pattern import Form, Slot
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.references import choice_of, is_related
from btlang.vocabulary.value_type import KINDS, OBJECT, PLACE, TEXT, WORLD, ZONE, ValueType
from btlang.vocabulary.values import Values
from btlang.vocabulary.verbs import fill, is_no_way
from btlang.vocabulary.word_tree import END, NO_WORDS, SLOTS, VERBS, first_with_slots

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MARKS = frozenset((",", ";", ":", "(", ")", "\n"))
TrieNode = dict[str, "Any"]


def add(root: TrieNode, form: Form, types: Mapping[str, str], meaning: Meaning) -> Meaning | None:
    """Adds one form of a phrase; `types` gives the type of each slot. Returns what stood there before, if any."""
    node = root
    for part in form:
        if isinstance(part, Slot):
            edges = node.setdefault(SLOTS, [])
            for name, kind, child in edges:
                if name == part.name and kind == types[part.name]:
                    node = child
                    break
            else:
                child = {}
                at = 0 if types[part.name] == TEXT else len(edges)  # those behind are tried first: names win over texts
                edges.insert(at, (part.name, types[part.name], child))
                node = child
        else:
            node = node.setdefault(part, {})
    before: Meaning | None = node.get(END)
    node[END] = meaning
    return before


def unshare(root: TrieNode, form: Form, types: Mapping[str, str], own: set[int]) -> None:
    """Copies the nodes below the root to which `add` would add a form, but those whose ids are the `own` ones."""
    node = root
    for part in form:
        if isinstance(part, Slot):
            edges = node.get(SLOTS, [])
            at = next((at for at, edge in enumerate(edges) if edge[:2] == (part.name, types[part.name])), None)
            if at is None:
                return
            name, kind, child = edges[at]
            child = _own_copy(child, own)
            edges[at] = name, kind, child
        else:
            if part not in node:
                return
            child = node[part] = _own_copy(node[part], own)
        node = child


def _own_copy(node: TrieNode, own: set[int]) -> TrieNode:
    if id(node) in own:
        return node
    made = copied(node)
    own.add(id(made))
    return made


def copied(node: TrieNode) -> TrieNode:
    """A node with the same children, to which others can be added."""
    return {key: [*below] if key in (SLOTS, VERBS) else below for key, below in node.items()}


def resumed(root: TrieNode, text: Words, at: int, last: int, values: Iterable[SlotValue]) -> TrieNode | None:
    """Where the words `at` to `last` (exclusive) of a phrase lead that has these values."""
    taken = {value.first: value for value in values}
    node: TrieNode | None = root
    while node is not None and at < last:
        value = taken.get(at)
        if value is None:
            node, at = node.get(text.words[at]), at + 1
        else:
            edges = node.get(SLOTS, ())
            node = next((child for name, kind, child in edges if (name, kind) == (value.name, value.type)), None)
            at = value.last
    return node


def longest(
    root: TrieNode,
    text: Words,
    at: int,
    context: ReadingContext,
    names: TrieNode | None = None,
    lists: bool = True,
    found: tuple[SlotValue, ...] = (),
) -> Match | None:
    """The longest phrase at a word; where two are equally long, the closer one, then the one with words in place of
    slots, or with a name in place of a text. A value that can be of any type is one of the type that
    the vocabulary has first.

    `found` are the values that have led to the root. A slot of an entry also takes a list of values, unless `lists`
    is False, but not that of a second object: a thing goes into one other thing. It ends before a phrase, also
    before one in the trie `names`, in which connectives are looked for too.
    """
    words = text.words
    if words[at] not in root and SLOTS not in root:
        return _after_manner(root, text, at, context, names) if words[at] in context.manners else None
    openers = context.openers
    best: Meaning | None = None
    best_last = at
    best_values: tuple[SlotValue, ...] = ()
    paths: list[tuple[TrieNode, int, Any]] = []
    verbs: list[tuple[TrieNode, int]] = []
    node: TrieNode | None = root
    i = at
    while True:
        while node is not None:
            word = words[i]
            if END in node and (i > best_last or best is None or (i == best_last and _is_closer(found, best_values))):
                meaning: Meaning = node[END]
                if meaning.entry is not None or all(_may_be_listed(value, meaning.role) for value in found):
                    best, best_last, best_values = meaning, i, found
            if VERBS in node:
                verbs.append((node, i))
            if has_colon := word == ":" and SLOTS in node and not text.ends_line(i):  # `patrol: the lab, the hall`
                i += 1
                word = words[i]
            if SLOTS in node:
                plain = word.isalpha() or word in _MARKS
                denies = word in context.denials and words[i + 1] not in context.deniable
                edges = node[SLOTS]
                if word == "{" and context.is_untyped(text, i):
                    others = (edge for edge in reversed(edges) if edge[1] != TEXT)
                    edges = [*(edge for edge in edges if edge[1] == TEXT), *others]
                for name, kind, child in edges:
                    if plain and kind in openers and (denies or word not in openers[kind]):
                        continue  # as nearly always, without reading
                    value = context.read(kind, text, i)
                    if name == VIA and is_no_way(context, text, i, value):
                        continue
                    if value is not None and words[value[1]] in context.modifiers:
                        wider = context.wider(kind, text, i, value)
                        paths += [(child, end, (*found, SlotValue(name, kind, said, i, end))) for said, end in wider]
                    is_pronoun = value is not None and word in context.values.pronoun_words  # `at each`, `at each stop`
                    if (value is None or is_pronoun) and kind in WORLD and (not plain or word in context.set_starts):
                        sets = _sets(root, text, i, context, name, kind)
                        paths += [(child, every.last, (*found, every)) for every in reversed(sets)]
                    if value is None:
                        continue
                    one = SlotValue(name, kind, value[0], i, value[1])
                    paths.append((child, value[1], (*found, one)))
                    is_second = kind == OBJECT and any(value.type == OBJECT for value in found)
                    if lists and context.may_list_on(text, value[1]) and not is_second and _may_go_on(child, text):
                        listed = _listed(root, text, one, context, names, is_subject=i == at and not found)
                        if listed is not None:
                            wider_lists = (listed, *context.wider_list(text, listed))
                            paths += [(child, every.last, (*found, every)) for every in wider_lists]
            node = None if has_colon else node.get(word)
            i += 1
        if not paths:
            break
        node, i, found = paths.pop()
    holds_place = any(is_related(value.text) for value in best_values) if verbs else False
    is_about_zone = any(value.type == ZONE for value in best_values) if verbs else False  # a place may be meant
    if verbs and (best is None or holds_place or is_about_zone or _may_be_longer(words, best_last, context)):
        for node, i in verbs:
            match = _filled(root, node, text, i + (words[i] == ":" and not text.ends_line(i)), context, names)
            says_more = match is not None and holds_place and len(match.values) > len(best_values)
            says_more |= match is not None and is_about_zone and all(value.type != ZONE for value in match.values)
            if match is not None and (
                best is None or match.last > best_last or (says_more and match.last == best_last)
            ):
                best, best_last, best_values = match.meaning, match.last, match.values
    if words[at] in context.manners:
        match = _after_manner(root, text, at, context, names)
        if match is not None and match.last > best_last:
            return match
    return Match(best, best_last, best_values) if best is not None else None


def _is_closer(values: Sequence[SlotValue], others: Sequence[SlotValue]) -> bool:
    """Whether values of as many words are meant: a kind of the world, or a text that begins later: in `ask the person
    who is in the lab to leave` the words behind `person` say whom.
    """
    if values and others and values[-1].type == others[-1].type == TEXT and values[-1].first > others[-1].first:
        return True
    return any(value.type == KINDS for value in values) and all(value.type != KINDS for value in others)


def _may_be_listed(value: SlotValue, role: str) -> bool:
    """Whether a word of the language takes a value: only some words take lists, `every day at 8 am and 6 pm`."""
    return not value.more or (role in LISTED and value.joiner in ("", LISTED[role]))


def _may_be_longer(words: Sequence[str], at: int, context: ReadingContext) -> bool:
    """Whether a verb with roles may go on at a word: also behind a comma with an adverb, `go to the lab, slowly`."""
    return not context.values.role_words.ends_at(words, at) or (words[at] == "," and words[at + 1] in context.manners)


def _filled(
    root: TrieNode,
    node: TrieNode,
    text: Words,
    at: int,
    context: ReadingContext,
    names: TrieNode | None,
    before: SlotValue | None = None,
) -> Match | None:
    """The verb that ends at a word, with the roles that stand behind it."""

    def list_of(value: SlotValue) -> SlotValue | None:
        return _listed(root, text, value, context, names, is_subject=False)

    return fill(node[VERBS], text, at, context, context.values.role_words, list_of, before)


def _after_manner(
    root: TrieNode, text: Words, at: int, context: ReadingContext, names: TrieNode | None
) -> Match | None:
    """A verb with an adverb before it: `slowly go to the lab`."""
    manner = context.read(MANNER, text, at)
    if manner is None:
        return None
    before = SlotValue(MANNER, MANNER, manner[0], at, manner[1])
    node: TrieNode | None = root.get(text.words[manner[1]])
    i, best = manner[1], None
    while node is not None:
        i += 1
        if VERBS in node:
            found = _filled(root, node, text, i, context, names, before)
            best = found if found is not None and (best is None or found.last > best.last) else best
        node = node.get(text.words[i])
    return best


def _sets(root: TrieNode, text: Words, at: int, context: ReadingContext, name: str, kind: str) -> list[SlotValue]:
    """The sets of names of a type that begin at a word; the shortest first."""
    ways = list(context.sets(kind, text, at))
    found = [SlotValue(name, kind, group, at, end, group=group) for group, _, end in ways]
    if ways and context.choice(text, at, kind) is not None:
        _, meant, end = ways[0]
        listed = all_names(root, meant, text, at, end, context, name)
        same = [at for at, value in enumerate(found) if value.last == listed.last]
        if same:
            found[same[0]] = listed.replace(group=found[same[0]].group)
        elif listed.last > end:
            found.append(listed)  # with something unknown behind `except`
    return found


def all_names(
    root: TrieNode, meant: Description, text: Words, first: int, at: int, context: ReadingContext, name: str = "value"
) -> SlotValue:
    """All names that are meant, but those behind `except` at a word, as a list; without a text where none is left."""
    left_out: tuple[str, ...] = ()
    kind = meant.type
    last = context.values.exception(text, at)
    other = longest(root, text, at, context, lists=False) if last else None
    if last and (other is None or other.last <= last):  # `except if` is another word
        value = context.read(kind, text, last)
        choice = choice_of(value[0]) if value is not None else None
        if value is None or (choice is not None and context.values.modifiers.is_picked(choice.how, text, last)):
            return SlotValue(name, kind, "", first, _end_of_unknown(root, text, last, context))
        one = SlotValue(name, kind, value[0], last, value[1])
        listed = _listed(root, text, one, context, None, is_subject=False) or one
        left_out, at = tuple(chain(*map(context.values.meant_by, listed.texts))), listed.last
    names = [one for one in context.values.likenesses.described(meant) if one not in left_out]
    return SlotValue(name, kind, names[0] if names else "", first, at, tuple(names[1:]), "and" if names[1:] else "")


def _end_of_unknown(root: TrieNode, text: Words, at: int, context: ReadingContext) -> int:
    while text.words[at] not in _MARKS and longest(root, text, at, context, lists=False) is None:
        at += 1
    return at


def _may_go_on(node: TrieNode, text: Words) -> bool:
    """Whether the text has what may follow a list; long lists of bare values are read once for each value else."""
    return END in node or SLOTS in node or not text.distinct.isdisjoint(node)


def _listed(
    root: TrieNode, text: Words, first: SlotValue, context: ReadingContext, names: TrieNode | None, *, is_subject: bool
) -> SlotValue | None:
    """The list that a value begins. It goes on while a value of the type follows that starts no longer phrase.

    Behind `the cup on the table` each further value has what describes it, too: `and the book from the lab`.
    A list that `is_subject` begins the phrase itself (`Alice or Bob is near`), as its last value alone would.
    """
    if context.types[first.type].kind == "text":
        return None
    more, is_described = list[str](), is_related(first.text)
    last, joiner, ones_elsewhere = first.last, "", context.values.role_words.is_one_elsewhere
    linked, end = 0, first.last  # `the kitchen the lab and the office`: spoken lists have no commas, but a joiner
    while True:
        at = last
        comma = text.words[at] == ","
        at += comma
        joined = _joiner(root, names, text, at, context) if text.words[at] in context.joiners else None
        role = joined.meaning.role if joined is not None and joined.meaning.role in ("and", "or", "nor") else ""
        if (joiner and role != joiner) or not (role or comma or at in text.articles):
            break
        if joined is not None and role:
            at = joined.last
        value = context.read(first.type, text, at)
        if value is None or any(
            _is_longer(trie, text, at, value[1], context, is_subject) for trie in (root, names or {})
        ):
            break
        is_elsewhere = first.type == PLACE and ones_elsewhere(text.words, value[1], context.values.ones)
        if is_elsewhere or _is_command(root, text, at, value[1], context):
            break
        if is_described:
            *_, value = value, *context.wider(first.type, text, at, value)
        more.append(value[0])
        last, joiner = value[1], role
        if role or (comma and linked == len(more) - 1):
            linked, end = len(more), last
    if not linked:
        return None
    made: SlotValue = first.replace(more=tuple(more[:linked]), joiner=joiner, last=end)
    if first.name == VIA and joiner == "and":  # one way through all of them
        made = made.replace(text="; ".join(made.texts), more=(), joiner="")
    return made


def _joiner(root: TrieNode, names: TrieNode | None, text: Words, at: int, context: ReadingContext) -> Match | None:
    joiner = longest(root, text, at, context, lists=False)
    return joiner or (longest(names, text, at, context, lists=False) if names else None)


def _is_command(root: TrieNode, text: Words, at: int, last: int, context: ReadingContext) -> bool:
    """Whether words without an article are a whole command, too: `go to the lab and dock`."""
    match = longest(root, text, at, context, lists=False) if at not in text.articles else None
    return match is not None and match.last == last and match.meaning.role == "command"


def _is_longer(root: TrieNode, text: Words, at: int, last: int, context: ReadingContext, is_subject: bool) -> bool:
    """Whether a phrase begins with a value and goes on behind it; of a subject only one that has no slot for it."""
    match = longest(root, text, at, context, lists=False)
    begins = match is not None and match.values and match.values[0].first == at
    return match is not None and match.last > last and not (is_subject and begins)


def reaches_beyond(root: TrieNode, text: Words, at: int, last: int, context: ReadingContext) -> bool:
    """Whether a phrase starts at a word that goes on behind `last`."""
    match = longest(root, text, at, context, lists=False)  # each list would look at all that follow it
    return match is not None and match.last > last


def collisions(root: TrieNode, values: Values, other: TrieNode | None = None) -> Iterator[tuple[Meaning, Meaning]]:
    """Pairs of different entries that some words match equally, of one trie or two; a slot counts as one value.

    A name of a keyword file and any text are no such words: the name wins.
    """
    pending = [(root, root if other is None else other)]
    seen: set[tuple[int, int]] = set()
    while pending:
        left, right = pending.pop()
        if (id(left), id(right)) in seen:
            continue
        if left is right and SLOTS not in left:  # most are: only words lead on
            seen.add((id(left), id(left)))
            pending += [(node, node) for node in first_with_slots(left)]
            continue
        seen |= {(id(left), id(right)), (id(right), id(left))}
        if left is not right and END in left and END in right:
            yield left[END], right[END]
        words = [w for w in left if w not in NO_WORDS]
        pending += [(left[w], right[w]) for w in words if w in right]
        for one, another in ((left, right), (right, left)):
            for _, kind, child in one.get(SLOTS, ()):
                pending += [(child, n) for w, n in another.items() if w not in NO_WORDS and values.takes_word(kind, w)]
        for _, kind, child in left.get(SLOTS, ()):
            for _, other_kind, other_child in right.get(SLOTS, ()):
                if _overlap(values.types[kind], values.types[other_kind]):
                    pending.append((child, other_child))


def _overlap(one: ValueType, other: ValueType) -> bool:
    if one.name == other.name:
        return True
    if TEXT in (one.kind, other.kind):
        return not any(each.names and each.name not in WORLD for each in (one, other))
    if one.kind == other.kind == "names":
        return not {n.lower() for n in one.names}.isdisjoint(n.lower() for n in other.names)
    return one.kind == other.kind == "number"
