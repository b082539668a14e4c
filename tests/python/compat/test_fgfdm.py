"""FlightGear packets beside pymavlink's: the same values, units, bytes and errors."""

from __future__ import annotations

from pathlib import Path

from beside import assert_same

PROGRAM = """
import random, struct
m = load("fgFDM")
f = m.fgFDM()
print({k: v for k, v in vars(f).items() if k not in ("mapping", "_packet_size")}, f.mapping._nextidx, f.packet_size())
print([(n, v.index, v.arraylength, v.units) for n, v in f.mapping.vars.items()], f.variables())
units = sorted({u for pair in f.unitmap for u in pair}) + ["foo", None]
for a in units:
    for b in units:
        show("f.convert(2.5, a, b)", globals())
for n in f.variables() + ["nix"]:
    for text in ("f.units(n)", "f.set(n, 1.25)", "f.get(n)", "f.get(n, 3)", "f.get(n, 4)", "f.set(n, 2, idx=2)"):
        show(text, globals())
for v in (float("inf"), float("-inf"), float("nan"), 3.5e38, -3.5e38, 3.4e38, 1e300, True, "x", None):
    show("f.set('phi', v)", globals())
    show("f.get('phi')", globals())
for text in ("f.set('latitude', 45.0, units='degrees')", "f.get('latitude')", "f.get('latitude', units='degrees')",
             "f.set('altitude', 100.0, units='feet')", "f.get('altitude')", "f.set('phi', 1.0, units='foo')",
             "f.set('num_engines', 1.0, units='degrees')", "f.get('phi', 0, 'degrees')"):
    show(text, globals())
g = m.fgFDM()
print(g.pack().hex())
R = random.Random(1)
for size in (0, 407, 409):
    show("g.parse(bytes(size))", globals())
g.parse(struct.pack(">I", 24) + struct.pack(">fd", float("inf"), float("-inf")) * 33 + bytes(8))
print(g.values)
for _ in range(50):
    data = struct.pack(">I", R.choice((24, 23))) + R.randbytes(404)
    g.parse(data)
    print(g.values)
    print(g.pack().hex())
    print(g.values)
for n in g.variables():
    g.set(n, 3)
print(g.pack().hex())
e = m.fgFDMError("abc")
print(repr(e), str(e), e.message)
l = m.fgFDMVariableList()
l.add("a"); l.add("b", 3, "m"); l.add("c"); l.add("a")
print({k: vars(v) for k, v in l.vars.items()}, l._nextidx, vars(m.fgFDMVariable(1, 2, "x")))
"""


def test_same_as_pymavlink(oracle: str, tmp_path: Path) -> None:
    assert_same(PROGRAM, tmp_path, oracle)
