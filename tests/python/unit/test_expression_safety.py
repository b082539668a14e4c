"""What expressions cannot do: reach code, files or the interpreter, or run for long."""

from __future__ import annotations

import math
import re
import subprocess
import sys
import tracemalloc
import types
from collections.abc import Iterator
from contextlib import contextmanager
from random import Random
from typing import Any

import pytest
from mavwire import mavextra
from mavwire.expression import ExpressionError, evaluate_expression
from mavwire.expression.names import known_names
from watchdog import watched


class Message:
    """A message that can be asked for more than its fields."""

    Roll = 1.5

    def execute(self, *arguments: Any) -> None:
        raise AssertionError("a method that is not listed was called")

    def get_type(self) -> str:
        return "ATT"


MESSAGES = {"ATT": Message(), "f": lambda *_: 1 / 0, "s": "text", "n": 9, "nan": float("nan")}


@contextmanager
def bounded_memory(limit: int = 64 << 20) -> Iterator[None]:
    """Some bytes more than the budget counts, because Python's objects differ in size."""
    tracemalloc.start()
    try:
        yield
        assert tracemalloc.get_traced_memory()[1] < limit
    finally:
        tracemalloc.stop()


OUT_OF_REACH = [
    "__import__('os')",
    "__builtins__",
    "__name__",
    "().__class__.__bases__[0].__subclasses__()",
    "ATT.__class__",
    "ATT.get_type.__globals__",
    "ATT.__init__.__globals__['__builtins__']",
    "ATT._private",
    "getattr(ATT, '__class__')",
    "getattr(ATT, '__cla' + 'ss__')",
    "hasattr(ATT, '__class__')",
    "ATT.execute()",
    "ATT.get_type.__call__()",
    "mag_field.__globals__",
    "sqrt.__self__",
    "ATT.gi_frame",
    "ATT.f_globals",
    "eval('1')",
    "exec('1')",
    "compile('1', '', 'eval')",
    "open('/etc/passwd')",
    "globals()",
    "locals()",
    "vars(ATT)",
    "dir(ATT)",
    "type(ATT)",
    "input()",
    "print(1)",
    "exit()",
    "breakpoint()",
    "iter([1])",
    "map(sqrt, [1])",
    "filter(None, [1])",
    "setattr(ATT, 'Roll', 3)",
    "max([1, 2], key=ATT.execute)",
    "sorted(['a'], key=ATT.execute)",
    "f(1)",
    "(lambda: 1)()",
    "lambda: 1",
    "(x := 3)",
    "f'{ATT.__class__}'",
    "f'{1}'",
    "'{0.__class__}'.format(ATT)",
    "'{a.__class__}'.format_map({})",
    "str.format('{}', ATT)",
    "'a'.join(['b'])",
    "'a'.ljust(10**9)",
    "[1].append(2)",
    "[1].sort()",
    "{}.update({})",
    "(1).__add__(2)",
    "[1][0](2)",
    "sqrt(4)(5)",
    "dict(**{'a': 1})",
    "({**{}})",
    "[x for x.y in [1]]",
    "[x for [*x] in [[1]]]",
    "[_x for _x in [1]]",
    "(yield 1)",
    "(yield from [1])",
    "Vector3(1, 2, 3).__dict__",
    "Vector3(1, 2, 3).normalize()",
    "ATT.get_type.__func__.__code__",
    "reset_state_data.__globals__",
    "bytes(10**9)",
    "bytearray(10**9)",
    "memoryview(s)",
    "id(ATT)",
    "super()",
    "object()",
]


@pytest.mark.parametrize("text", OUT_OF_REACH)
def test_refused(text: str) -> None:
    """R69."""
    with pytest.raises(ExpressionError, match=r"^expression refused") as raised:
        evaluate_expression(text, MESSAGES)
    assert raised.value.reason
    with pytest.raises(ExpressionError):
        evaluate_expression(
            f"1{{{text}}}" if "{" not in text and "}" not in text else text, MESSAGES
        )


def test_error_says_what_and_where() -> None:
    with pytest.raises(ExpressionError) as raised:
        evaluate_expression("ATT.Roll + ATT.__class__", MESSAGES)
    assert (raised.value.column, raised.value.reason) == (
        11,
        "the name '__class__' is out of reach",
    )
    assert str(raised.value) == (
        "expression refused at column 11: the name '__class__' is out of reach"
    )
    assert isinstance(raised.value, ValueError)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[lambda: 1]", "lambda is not allowed"),
        ("(x := 1)", "an assignment is not allowed"),
        ("[a for a, *b in [[1]]]", "unpacking with * is not allowed as a variable"),
        ("[1 for ATT.Roll in [1]]", "an attribute is not allowed as a variable"),
    ],
)
def test_error_says_it_in_words(text: str, words: str) -> None:
    with pytest.raises(ExpressionError, match=re.escape(words)):
        evaluate_expression(text, MESSAGES)


def test_nothing_that_an_expression_knows_is_a_module() -> None:
    """R69."""
    for name, value in known_names().items():
        assert not isinstance(value, types.ModuleType), name
        assert not name.startswith("_"), name


def grown(step: str) -> str:
    """A comprehension with 24 clauses, each of which makes more of the value before it."""
    clauses = (f" for x{n + 1} in [{step.format(f'x{n}')}]" for n in range(24))
    return f"[0 for x0 in [[1]]{''.join(clauses)}]"


GROWTH = [
    "[*{0}, *{0}]", "[{0}, {0}]", "({0}, {0})", "{{1: {0}, 2: {0}}}", "dict(a={0}, b={0})",
    "{{1: {0}, 2: {0}}}.items()", "{{1: {0}, 2: {0}}}.values()", "slice({0}, {0})",
    "list(zip({0}, {0}))", "[x for x in [{0}, {0}]]", "{0} + {0}", "{0} * 2", "[{0}] * 2",
    "[{0}[:]] + [{0}[:]]", "str({0}) * 2", "'%s%s' % ({0}, {0})", "repr([{0}, {0}])",
    "sorted([{0}, {0}])", "list(enumerate([{0}, {0}]))", "list(reversed([{0}, {0}]))",
    "str({0}).encode().hex()", "list({{1: {0}, 2: {0}}}.items())", "str({0}).encode('utf-32')",
    "({0} if 1 else 0, {0} or 0)",
]  # fmt: skip


@pytest.mark.parametrize("step", GROWTH)
def test_nothing_grows_step_by_step(step: str) -> None:
    """R69."""
    with watched(), bounded_memory(), pytest.raises(ExpressionError) as raised:
        evaluate_expression(grown(step), MESSAGES)
    assert raised.value.column is not None
    assert re.search("takes more than 16 MB of values|has a text of", raised.value.reason)


@pytest.mark.parametrize(
    "text",
    [
        f"len('a'.encode(){'.hex().encode()' * 21}) > 0",
        f"len(('a' * 4096).encode(){'.hex().encode()' * 21}) > 0",
        "[str(x) + ''.lower() for x in [['a' * 4096] * 60] for y in range(9)]",
    ],
)
def test_a_chain_of_methods_does_not_grow(text: str) -> None:
    """R69."""
    with bounded_memory(), pytest.raises(ExpressionError, match="takes more than|has a text of"):
        evaluate_expression(text, MESSAGES)


def test_the_error_names_the_part_of_the_expression() -> None:
    text = "ATT.Roll > 1 and len([1] * 200000 + [ATT.Roll] * 200000) > 0"
    with pytest.raises(ExpressionError) as raised:
        evaluate_expression(text, MESSAGES)
    assert str(raised.value) == (
        "expression refused at column 21: with '[1] * 200000' the evaluation takes more than "
        "16 MB of values"
    )
    with pytest.raises(ExpressionError) as raised:
        evaluate_expression("ATT.Roll > 1 and 'ab' * 9000", MESSAGES)
    assert str(raised.value) == (
        "expression refused at column 17: \"'ab' * 9000\" has a text of more than 16384 characters"
    )


def test_one_budget_is_for_the_whole_evaluation() -> None:
    half = "len([0] * 100_000) > 0"
    for whole in (f"{half} and {half}", f"{half}{{{half}}}"):
        assert evaluate_expression(half, {}) is True
        with pytest.raises(ExpressionError, match="the evaluation takes more than 16 MB of values"):
            evaluate_expression(whole, {})


TOO_MUCH = [
    "9**9**9**9",
    "2**5000",
    "1 << 10**9",
    "[x * x * x * x for x in [2**2000]]",
    "'x' * 10**9",
    "10**9 * [1]",
    "[0] * 100_000 + [0] * 100_000",
    "[[0] * 200] * 1000",
    "factorial(10**8)",
    "comb(10**8, 10**7)",
    "prod([2**4000, 2**4000])",
    "prod([[1] * 1000, 1000])",
    "prod(['a' * 4000, 1000])",
    "prod([1000], start=[1] * 1000)",
    "builtin_sum([[1] * 1000], [1] * 1000)",
    "builtin_sum(([1] * 1000 for i in range(1000)), [])",
    "list(zip(*[range(1000)] * 1000))",
    "({*range(0, 2**69, 2**61 - 1)})",
    "int('f' * 4096, 16)",
    "('%(a)s%(a)s' % {'a': 1})",
    "lcm(2**4000 - 1, 2**4000 - 3)",
    "round(5, -10**9)",
    "range(10**12)",
    "'%1000000000d' % n",
    "'%*d' % (10**9, n)",
    "'%.999999d' % n",
    "'%-+1000d' % n",
    "'%%%1000d' % n",
    "('%((a))1000d' % {'(a)': n})",
    "b'%1000d' % n",
    "str(['a' * 4096] * 1024)",
    "repr([str(['a' * 2048] * 2)] * 64)",
    "ascii((['a' * 4096] * 4, {'b': 'c' * 4096}))",
    "str([2**4000] * 1024)",
    "'%s' % (['a' * 4096] * 8,)",
    "'%s%s' % ('a' * 16384, 'b')",
    "str(slice('a' * 4096, 'b' * 4096, 'c' * 4096)) * 2",
    "[x for x in range(1000) for y in range(1000)]",
    "[[x for x in range(1000)] == [y for y in range(1000)] for z in range(1000)]",
    "[1 for x in range(1000) if [0, ATT.Roll] * 1000]",
    "[a == b for a in [[1] * 9000] for b in [[1] * 9000] for c in range(999)]",
    "[a < b <= 'c' for a in ['b' * 9000] for b in ['b' * 9000] for c in range(999)]",
    "[a[:-1] for a in ['b' * 9000] for c in range(999)]",
    "[a.find('c') for a in ['b' * 9000] for c in range(999)]",
    "[{a: 1}[a] for a in [(1,) * 9000] for c in range(999)]",
    "[0 for x in range(999) if (" + " or ".join(["0"] * 99) + ")]",
    "[0 for x in range(999) for y in (" + " or ".join(["0"] * 99) + " or [1])]",
    "(" * 150 + "1" + ")" * 150 + "+" + "-" * 150 + "1",
    "-" * 2000 + "1",
    "a" + ".b" * 1500,
    "not " * 1000 + "1",
    "1" + "+1" * 1500,
    "[" * 90 + "1" + "]" * 90 + "[0]" * 90,
    "1" * 5000,
    "x" * 100_000,
]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("builtin_sum([1, 2.5])", 3.5), ("[y for y in [((1,),)]]", [((1,),)]),
        ("builtin_sum((1, 2), 3)", 6), ("list(zip('ab', [1, 2]))", [("a", 1), ("b", 2)]),
    ],
)  # fmt: skip
def test_what_is_bounded_gives_what_python_does(text: str, value: object) -> None:
    assert evaluate_expression(text, {}) == value


@pytest.mark.parametrize("text", TOO_MUCH, ids=lambda text: text[:30])
def test_cost_is_bounded(text: str) -> None:
    with watched(), pytest.raises((ExpressionError, SyntaxError)) as raised:
        evaluate_expression(text, MESSAGES)
    assert len(str(raised.value)) < 300


def test_worst_allowed_loop_ends_soon() -> None:
    text = "[x.rfind('b' + x[:8000]) for x in ['a' * 16000] for y in range(3)]"
    with watched(), bounded_memory():
        assert len(evaluate_expression(text, MESSAGES)) == 3


@pytest.mark.parametrize(
    "text",
    ["isinstance(s, str)", "str([1, 'a', {2: 'b'}]) > ''", "repr(s) + ascii(n)", "'%s' % [1]"],
)
def test_ordinary_texts_are_allowed(text: str) -> None:
    assert evaluate_expression(text, MESSAGES)


@pytest.mark.parametrize("text", ["[1, 2] * 512", "'ab' * 1000", "2**4000 > 1", "'1000 %5.1f' % n"])
def test_ordinary_sizes_are_allowed(text: str) -> None:
    assert evaluate_expression(text, MESSAGES)


def test_hostile_texts_leave_the_interpreter_alive() -> None:
    """In a process of its own, with all kinds of nesting that has overflowed parsers."""
    program = """
from mavwire.expression import evaluate_expression
for opening, closing in (("(", ")"), ("[", "]"), ("{", "}"), ("-", ""), ("~", ""), ("not ", ""),
                         ("a.", "b"), ("a[", "]"), ("f(", ")"), ("1 if 1 else ", "1"), ("1+", "1"),
                         ("1<", "1"), ("1,", ""), ("*", ""), ("[x for x in ", "]"), ("'", ""), ("\\\\", "")):
    for depth in (50, 99, 101, 200, 1000, 4000):
        text = (opening * depth + "1" + closing * depth)[:4096]
        try:
            evaluate_expression(text, {})
        except (ValueError, SyntaxError, NameError, TypeError, AttributeError):
            pass
print("alive")
"""
    ran = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", program], capture_output=True, text=True, check=False
    )
    assert ran.stdout.strip() == "alive", ran.stderr[-500:]


@pytest.fixture
def forgetful() -> Iterator[None]:
    mavextra.reset_state_data()
    yield
    mavextra.reset_state_data()


@pytest.mark.usefixtures("forgetful")
def test_averages_keep_a_bounded_number_of_values() -> None:
    with pytest.raises(ExpressionError, match="average"):
        evaluate_expression("[average(1, i, 10**6) for i in range(40)]", {})
    with pytest.raises(ExpressionError, match="average"):
        evaluate_expression("average(1, 'more', 10**7)", {})
    mavextra.reset_state_data()
    assert evaluate_expression("average(1, 0, 10**6)", {}) == 1


@pytest.mark.usefixtures("forgetful")
def test_what_is_no_number_of_values_is_not_counted() -> None:
    for size in ("nan", "1.5"):
        with pytest.raises(TypeError):
            evaluate_expression(f"average(1, 'other', {size})", {})
    with pytest.raises(ExpressionError, match="average"):
        evaluate_expression("average(1, 'more', 10**7)", {})


@pytest.mark.usefixtures("forgetful")
@pytest.mark.parametrize(
    "call", ["average(1, n, 2)", "lowpass(1, n, 0.5)", "diff(1, n)", "delta(1, n, 5)", "sum(1, n)"]
)
def test_keys_that_change_for_ever_are_refused(call: str) -> None:
    with pytest.raises(ExpressionError, match="keys"):
        for number in range(10_000):
            evaluate_expression(call, {"n": number})


@pytest.mark.usefixtures("forgetful")
@pytest.mark.parametrize(
    "call",
    [
        "diff([1] * 9000, 'a')", "diff(1, 'a' * 300)", "lowpassHz('a' * 9000, 'a', 9, 1)",
        "average([1] * 9000, 'a', 2)", "delta_angle(['a' * 9000], 'a', 1)", "sum(1, (1,) * 300)",
    ],
)  # fmt: skip
def test_filters_keep_numbers_under_short_keys(call: str) -> None:
    with pytest.raises(ExpressionError, match="not a number, or its key has more"):
        evaluate_expression(call, {})


@pytest.mark.usefixtures("forgetful")
@pytest.mark.parametrize("call", ["average({}, 'a', 9)", "average({}, 'a', 2000)"])
def test_filters_refuse_other_values_before_they_keep_them(call: str) -> None:
    assert evaluate_expression(call.format(1.5), {}) == 1.5
    before = evaluate_expression(call.format(1.5), {})
    with pytest.raises(TypeError):
        evaluate_expression(call.format("[1]"), {})
    assert evaluate_expression(call.format(1.5), {}) == before


@pytest.mark.usefixtures("forgetful")
@pytest.mark.parametrize("size", [3, 3000])
def test_long_averages_are_means(size: int) -> None:
    random = Random(size)
    values = [random.uniform(-1e6, 1e6) for _ in range(2 * size + 80)]
    values[60], values[70] = math.inf, math.nan
    window = [values[0]] * size
    for value in values:
        window = [*window[1:], value]
        found = mavextra.average(value, "mean", size)
        assert found == pytest.approx(sum(window) / size, rel=1e-9, abs=1e-6, nan_ok=True)
