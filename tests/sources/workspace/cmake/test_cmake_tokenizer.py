"""Tokens and blocks of the CMake language."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cpu_time import growth
from rtron.sources.workspace.cmake.tokenizer import (
    MAX_ARGUMENTS,
    MAX_PROBLEMS,
    nest_blocks,
    read_commands,
)


def arguments(text):
    commands, faults = read_commands(f"c({text})")
    assert not faults
    return [argument.text for argument in commands[0].arguments]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", []),
        ("a  b\n\tc", ["a", "b", "c"]),
        ('"a b" c', ["a b", "c"]),
        ('"a\\\nb"', ["ab"]),
        ('"a\\"b"', ['a\\"b']),
        ("[[a ) b]] c", ["a ) b", "c"]),
        ("[==[a ]] b]==]", ["a ]] b"]),
        ("[[\na]]", ["a"]),
        ("a # x ) y\n b", ["a", "b"]),
        ("a #[[ x )\n ]] b", ["a", "b"]),
        ("a (b OR (c))", ["a", "(", "b", "OR", "(", "c", ")", ")"]),
        ('-Da="b c" d', ['-Da="b c"', "d"]),
        ("a\\ b", ["a\\ b"]),
        ("a;b", ["a;b"]),
        ("a[b]", ["a[b]"]),
    ],
)
def test_arguments(text, expected):
    assert arguments(text) == expected


def test_commands_have_lower_case_names_and_lines():
    commands, faults = read_commands("# x\nSet (a)\n\n#[[\n\n]]\nlist(\n b)")
    assert [(command.name, command.line) for command in commands] == [("set", 2), ("list", 7)]
    assert not faults


@pytest.mark.parametrize(
    ("text", "line"), [("a(\nb(c)", 1), ('a("\nb(c)', 1), ("a()\n)\nb(c)", 2), ("a([[\nb(c)", 1)]
)
def test_after_a_fault_reading_goes_on_in_the_next_line(text, line):
    commands, faults = read_commands(text)
    assert [fault.line for fault in faults] == [line]
    assert commands[-1].name == "b"


def test_faults_are_bounded_and_quick():
    def read(count):
        _, faults = read_commands("a([[\n" * count)
        assert len(faults) == MAX_PROBLEMS

    assert growth(read, 20_000, 200_000) < 30


@pytest.mark.parametrize(("count", "faults"), [(MAX_ARGUMENTS, 0), (MAX_ARGUMENTS + 1, 1)])
def test_arguments_are_bounded(count, faults):
    assert len(read_commands(f"c({'a ' * count})")[1]) == faults


@pytest.mark.parametrize("text", ["endif()", "else()", "if(a)", "if(a)\nendforeach()\nendif()"])
def test_blocks_that_do_not_fit_are_faults(text):
    assert len(nest_blocks(read_commands(text)[0])[1]) == 1


SIGNS = st.sampled_from([*list('a(){}[]=#"\\$; \n\r\tA_1'), "if(", "endif()", "[[", "]]", "${"])


@given(st.lists(SIGNS, max_size=60).map("".join))
def test_any_text_is_read(text):
    commands, faults = read_commands(text)
    nest_blocks(commands)
    lines = text.count("\n") + 1
    assert all(1 <= command.line <= lines for command in commands)
    assert all(1 <= fault.line <= lines for fault in faults)


@given(st.lists(st.text(), max_size=5))
def test_bracket_arguments_are_read_as_they_are(texts):
    texts = [text.replace("]", "").replace("\r", "") for text in texts]
    written = " ".join(f"[=[\n{text}]=]" for text in texts)
    assert arguments(written) == texts
