"""R69: an expression of any allowed operations stays small, soon ends and reaches no code."""

from __future__ import annotations

import tracemalloc
import types

from hypothesis import example, given
from hypothesis import strategies as st
from mavwire import mavextra
from mavwire.expression import evaluate_expression
from mavwire.expression.attributes import METHOD_OWNERS
from mavwire.expression.limits import BINARY_OPERATORS
from mavwire.expression.names import known_names
from property.hostile import PROFILE
from watchdog import watched

LARGEST = 64 << 20  # bytes: the budget counts items, and Python's objects differ in size
CLAUSES = 12

SIGNS = {
    "Add": "+",
    "Sub": "-",
    "Mult": "*",
    "Div": "/",
    "FloorDiv": "//",
    "Mod": "%",
    "Pow": "**",
    "LShift": "<<",
    "RShift": ">>",
    "BitOr": "|",
    "BitXor": "^",
    "BitAnd": "&",
    "MatMult": "@",
}
COMPARISONS = "== != < <= > >= in is".split()
LEAVES = st.sampled_from(
    ["1", "0", "-1", "0.5", "7", "500", "2**60", "10**9", "1023", "''", "'a'", "'%s%200d'", "b'a'",
     "'utf-32'", "None", "[]", "[1] * 999", "'a' * 4096", "range(999)", "x", "x", "x", "x", "y", "ATT",
     "ATT.Roll", "ATT.data", "ATT.text"]
)  # fmt: skip
FUNCTIONS = st.sampled_from(sorted(n for n, value in known_names().items() if callable(value)))
GROWING = st.sampled_from(
    ["[*{0}, *{0}]", "[{0}, {1}]", "({0}, {0}, {0})", "{{1: {0}, 2: {0}}}", "{{*{0}, {1}}}", "{0} * 9",
     "{0} + {0}", "str({0})", "repr([{0}] * 9)", "'%s%s' % ({0}, {0})", "list({0})", "sorted({0})",
     "list(zip({0}, {0}))", "slice({0}, {0})", "{0}.items()", "{0}.encode().hex()", "{0}.split('a')",
     "list(enumerate({0}))", "[z for z in {0} for w in {0}]", "{{z: {0} for z in {0}}}", "hex(len({0}))"]
)  # fmt: skip


def deeper(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    """One more operation around others: every kind of syntax that an expression may hold."""
    make = st.builds
    signs = st.sampled_from([SIGNS[name] for name in BINARY_OPERATORS])
    variable = st.sampled_from("xyzw")
    loops = st.sampled_from(["[{0} {1}]", "({0} {1})", "({{{0} {1}}})", "({{{0}: {0} {1}}})"])
    clauses = make(
        "for {} in {} for {} in {} if {}".format, variable, inner, variable, inner, inner
    )
    return st.one_of(
        make("({} {} {})".format, inner, signs, inner),
        make("({} {} {} {} {})".format, inner, st.sampled_from(COMPARISONS), inner, signs, inner),
        make("({}{})".format, st.sampled_from(["-", "~", "not "]), inner),
        make("({} {} {})".format, inner, st.sampled_from(["and", "or"]), inner),
        make("({} if {} else {})".format, inner, inner, inner),
        make("{}[{}]".format, inner, inner),
        make("{}[{}:{}:{}]".format, inner, inner, inner, inner),
        make("{}({})".format, FUNCTIONS, inner),
        make("{}({}, {})".format, FUNCTIONS, inner, inner),
        make("{}(*{}, {}, {})".format, FUNCTIONS, inner, inner, inner),
        make("({}).{}({})".format, inner, st.sampled_from(sorted(METHOD_OWNERS)), inner),
        make("({}).{}()".format, inner, st.sampled_from(sorted(METHOD_OWNERS))),
        make(lambda loop, one, tail: loop.format(one, tail), loops, inner, clauses),
        make(lambda shape, one, two: f"({shape.format(one, two)})", GROWING, inner, inner),
    )


EXPRESSIONS = st.recursive(LEAVES, deeper, max_leaves=10)
STEPS = st.one_of(
    st.builds(lambda shape: shape.format("x", "y"), GROWING),
    st.recursive(LEAVES, deeper, max_leaves=4),
)


@st.composite
def repeated(draw: st.DrawFn) -> str:
    """The same few operations over and over, each on the values that the ones before have made."""
    steps = draw(st.lists(STEPS, min_size=1, max_size=3))
    clauses = (f" for y in [x] for x in [{steps[n % len(steps)]}]" for n in range(CLAUSES))
    return f"[{draw(EXPRESSIONS)} for x in [{draw(LEAVES)}]{''.join(clauses)}]"


class Message:
    """A message with fields of each kind."""

    Roll, text, data = 1.5, "text", list(range(250))

    def get_type(self) -> str:
        return "ATT"


def test_the_grammar_holds_every_operation() -> None:
    assert set(SIGNS) == set(BINARY_OPERATORS)


@PROFILE
@given(text=EXPRESSIONS | repeated())
@example(text="len(('a'*4096).encode()" + ".hex().encode()" * 21 + ")>0")
@example(text="[x for x in [[1]*999]" + " for x in [[*x, *x, *x, *x]]" * 12 + "]")
@example(text="[x for x in [[1]]" + " for x in [{1: x, 2: x}.items()]" * 20 + "] == 1")
def test_nothing_grows(text: str) -> None:
    mavextra.reset_state_data()
    tracemalloc.start()
    try:
        with watched(20):
            value = evaluate_expression(text, {"ATT": Message()})
    except (MemoryError, RecursionError, SystemError, TimeoutError):
        raise
    except Exception:
        value = None
    finally:
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        mavextra.reset_state_data()
    assert peak < LARGEST
    assert not isinstance(value, types.ModuleType | types.FrameType | types.CodeType)
