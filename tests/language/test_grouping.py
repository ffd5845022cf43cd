"""Every grouping rule of the language, as one line of English and its tree, by both parsers."""

from __future__ import annotations

import pytest

from tests.language.letters import read, shown

RULES = [
    # and, or, then, after
    ("u then v and w", "S(U, P(V, W))"),
    ("u and v or w", "F(P(U, V), W)"),
    ("u or v and w", "F(U, P(V, W))"),
    ("u or v then w", "S(F(U, V), W)"),
    ("u after v", "S(V, U)"),
    ("u after v after w", "S(W, V, U)"),
    ("u after v then w", "S(V, U, W)"),
    ("u before v", "S(U, V)"),
    ("u; v. W!", "S(U, V, W)"),
    ("u at the same time as v", "P(U, V)"),
    ("u together with v", "P(U, V)"),
    ("u, meanwhile v", "P(U, V)"),
    ("u or else v", "F(U, V)"),
    ("u, if that fails v", "F(U, V)"),
    ("u, after that v, and then w", "S(U, V, W)"),
    ("u followed by v afterwards w", "S(U, V, W)"),
    ("u. After that, v. Then w", "S(U, V, W)"),
    # commas
    ("u, v and w", "P(U, V, W)"),
    ("u, v or w", "F(U, V, W)"),
    ("u, v, then w", "S(U, V, W)"),
    ("u, v, w", "S(U, V, W)"),
    ("u, v, and w", "P(U, V, W)"),
    ("u then v, and w", "P(S(U, V), W)"),
    ("u then v, or w", "F(S(U, V), W)"),
    ("u then v, otherwise w", "F(S(U, V), W)"),
    ("u and v, and w", "P(U, V, W)"),
    # brackets
    ("(u then v) and w", "P(S~(U, V), W)"),
    ("(u and v) and w", "P(P~(U, V), W)"),
    ("((u))", "U"),
    ("u and (v; w)", "P(U, S~(V, W))"),
    # postfix
    ("u then v twice", "S(U, Repeat(2, V))"),
    ("u thrice", "Repeat(3, U)"),
    ("u forever", "Repeat(-1, U)"),
    ("u 3 times within 10 s", "Within(10, Repeat(3, U))"),
    ("u for 5 s", "For(5, U)"),
    ("u every 5 s", "Every(5, U)"),
    ("u if possible then v", "S(Try(U), V)"),
    ("u and v if p", "P(U, If(P, V))"),
    ("u unless p", "Unless(P, U)"),
    ("u until p then v", "S(Until(P, U), V)"),
    ("u as long as p", "While(P, U)"),
    ("u provided that p", "Provided(P, U)"),
    ("u then v, unless p", "Unless(P, S(U, V))"),
    ("(u then v, until p and q) or w", "F(Until(All(P, Q), S(U, V)), W)"),
    ("u if p otherwise v", "If(P, U, V)"),
    ("u repeat until p", "Until(P, U)"),
    # conditions
    ("if p and q, u", "If(All(P, Q), U)"),
    ("if p, q or r then u", "If(Any(P, Q, R), U)"),
    ("if p, q then u", "If(All(P, Q), U)"),
    ("if not p and q, u", "If(All(Not(P), Q), U)"),
    ("if not (p or q), u", "If(Not(Any~(P, Q)), U)"),
    ("if p or q, and r, u", "If(All(Any(P, Q), R), U)"),
    ("if p u", "If(P, U)"),
    ("u until p and q", "Until(All(P, Q), U)"),
    ("check p and q then u", "S(Check(All(P, Q)), U)"),
    ("wait until p within 5 s", "Within(5, WaitUntil(P))"),
    # prefix forms
    ("if p then u otherwise v", "If(P, U, V)"),
    ("if p, u then v and w", "If(P, S(U, P(V, W)))"),
    ("if p, u; v", "S(If(P, U), V)"),
    ("unless p, u else v", "Unless(P, U, V)"),
    ("when p, u", "If(P, U)"),
    ("while p, u otherwise v", "While(P, U, V)"),
    ("until p: u", "Until(P, U)"),
    ("if p, if q, u otherwise v", "If(P, If(Q, U, V))"),
    ("if p, if q, u otherwise v otherwise w", "If(P, If(Q, U, V), W)"),
    ("if p, u otherwise if q, v otherwise w", "If(P, U, If(Q, V, W))"),
    ("repeat u then v", "Repeat(-1, S(U, V))"),
    ("repeat u then v 3 times then w", "S(Repeat(3, S(U, V)), W)"),
    ("repeat u then v until p then w", "S(Until(P, S(U, V)), W)"),
    ("repeat u for 5 s", "For(5, U)"),
    ("repeat 3 times: u then v", "Repeat(3, S(U, V))"),
    ("repeat 3 times u", "Repeat(3, U)"),
    ("repeat while p, u", "While(P, U)"),
    ("repeat until p: u", "Until(P, U)"),
    ("repeat u or v", "Repeat(-1, F(U, V))"),
    ("repeat u otherwise v", "Repeat(-1, F(U, V))"),
    ("repeat repeat u 2 times 3 times", "Repeat(3, Repeat(2, U))"),
    ("repeat if p, u 3 times", "Repeat(3, If(P, U))"),
    ("try u", "Try(U)"),
    ("try u otherwise v", "Try(U, V)"),
    ("try u then v up to 3 times", "Retry(3, S(U, V))"),
    ("retry u 3 times otherwise v", "Try(Retry(3, U), V)"),
    ("retry u", "Retry(-1, U)"),
    ("every 5 s, u then v", "Every(5, S(U, V))"),
    ("after 5 s, u", "Delay(5, U)"),
    ("wait 5 s", "Wait(5)"),
    ("do nothing or fail", "F(Nothing(), Fail())"),
    # blocks
    ("if p:\n  u\n  v then w\nx", "S(If(P, S~(U, V, W)), X)"),
    ("if p:\n  u\notherwise:\n  v\n  w\n", "If(P, U, S~(V, W))"),
    ("if p, u\notherwise v", "If(P, U, V)"),
    ("repeat 2 times:\n\tu\n\n\t# a comment\n\tif p:\n\t\tv", "Repeat(2, S~(U, If(P, V)))"),
    ("try:\n  u\n  v\notherwise:\n  w", "Try(S~(U, V), W)"),
    ("repeat:\n  u\notherwise v", "F(Repeat(-1, U), V)"),
    ("  u\n  v", "S(U, V)"),
    # definitions
    ("go home is u then v\ngo home twice", "go home = S(U, V); Repeat(2, <go home>)"),
    ("the dance means u\ndo you know is v\ndance", "dance = U; do you know = V; <dance>"),
    ("later\nlater is:\n  u\n  v", "later = S~(U, V); <later>"),
    ("big b is u; big b; v", "big b = U; S(<big b>, V)"),
    ("careful is p and not q\nu if careful", "careful = All(P, Not(Q)); If(<careful>, U)"),
    ("one is two\ntwo is p\ncheck one", "one = <two>; two = P; Check(<one>)"),
    # what does not matter
    ("  PLEASE   u ,\tthen the V .  # comment\r\n\r\n", "S(U, V)"),
    ("\ufeffu\r\ncould you v please\r\n", "S(U, V)"),
    ("I want you to u and then the robot should v", "S(U, V)"),
    ("Robot, u, please, and v, please.", "P(U, V)"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "tree"), RULES, ids=[text for text, _ in RULES])
def test_rule(text: str, tree: str) -> None:
    assert shown(read(text)) == tree
    assert read(text, "lark") == read(text)
