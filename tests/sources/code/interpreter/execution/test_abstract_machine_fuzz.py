"""Broken programs: whatever is done to a source's text, an interface comes out, and in time."""

from functools import cache

import pytest
from hard_cases import APP
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from ros1_runs import run_text

from cpu_time import work_units
from example_budget import examples
from rtron.sources.declaration import NodeInterface

UNITS = 200
PIECES = [
    *"(){}[]<>;:,.*&=+-%!~'\"\\#@\n\t \0é",
    *("(" * 50, "\n    ", "//", "/*", '"""', "<<", "::", "->", "*x", "**x", "&&", "==", "9" * 40),
    *("if ", "else ", "for x in x:\n", "while True:\n", "return ", "raise ", "yield ", "del x\n"),
    *("class A(A): pass\n", "lambda: ", "self", "None", "global x\n", "try:\n", "x += x\n"),
    *("template <class T> ", "struct A { A a; };", "#define A A\n", "#if 1\n", "#endif\n"),
    *(
        "for (;;) ",
        "while (true) ",
        "new ",
        "this->",
        "auto& ",
        "nh = nh;",
        "operator",
        "namespace a {",
    ),
]
SETTINGS = settings(
    max_examples=examples(40),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
    derandomize=True,
)


@cache
def sources(suffix):
    return [path.read_text("latin-1") for path in sorted(APP.rglob(f"*.{suffix}"))]


def mutated(suffix):
    """A source with some stretches taken out, doubled, moved or replaced."""
    change = st.tuples(st.floats(0, 1), st.integers(0, 60), st.sampled_from(["", *PIECES]))
    return st.tuples(
        st.sampled_from(sources(suffix)), st.lists(change, min_size=1, max_size=6)
    ).map(lambda made: apply(*made))


def apply(text, changes):
    for place, length, piece in changes:
        start = int(place * len(text))
        text = text[:start] + piece + text[start + length :]
    return text


def faults(text, suffix):
    """Return what is wrong with what a program gives: no interface, too late, without a place."""
    interface, late = work_units(lambda: run_text(text, suffix, args=("a", "--b=c")))
    if not isinstance(interface, NodeInterface):
        return [interface]
    entries = (*interface.declarations, *interface.unresolved)
    placeless = [entry for entry in entries if not entry.evidence[0].file]
    return [*placeless, *([late] if late >= UNITS else [])]


@pytest.mark.parametrize("suffix", ["py", "cpp"])
@given(data=st.data())
@SETTINGS
def test_a_changed_source_never_fails(suffix, data):
    assert faults(data.draw(mutated(suffix)), suffix) == []


@pytest.mark.parametrize("suffix", ["py", "cpp"])
@given(data=st.data())
@SETTINGS
def test_lines_of_several_sources_in_any_order_never_fail(suffix, data):
    lines = [line for text in sources(suffix) for line in text.splitlines()]
    chosen = data.draw(st.lists(st.sampled_from(lines), max_size=40))
    assert faults("\n".join(chosen), suffix) == []


@pytest.mark.parametrize("suffix", ["py", "cpp"])
@given(data=st.data())
@SETTINGS
def test_statements_of_python_and_pieces_never_fail(suffix, data):
    assert faults("".join(data.draw(st.lists(st.sampled_from(PIECES), max_size=30))), suffix) == []


@pytest.mark.parametrize("suffix", ["py", "cpp"])
@given(data=st.binary(max_size=200))
@SETTINGS
def test_bytes_never_fail(suffix, data):
    assert faults(data, suffix) == []
