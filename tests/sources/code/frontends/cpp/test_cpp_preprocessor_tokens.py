"""What the preprocessor finds by its first letter: directives, comments, and literals."""

import pytest

from rtron.sources.code.frontends.cpp.preprocessor import preprocess


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("#define A 1\nA", "\n1"),
        ("  # define A 1\nA", "\n1"),
        ("x # define A 1\nA", "x # define A 1\nA"),
        ("/* */ #define A 1\nA", "  #define A 1\nA"),
        ("int a; // one \\\ntwo\nb", "int a;  \n\nb"),
        ('s = u8"/* no */ // no";', 's = u8"/* no */ // no";'),
        ('s = LR"x(/*\n#if 0\n)x"; // yes', 's = LR"x(/*\n#if 0\n)x";  '),
        ("c = L'\"'; /* yes */ d", "c = L'\"';   d"),
        ("#if 0\na\n#endif\n#define B 2\nB", "\n\n\n\n2"),
    ],
)
def test_directives_begin_a_line_and_literals_hold_no_comments(text: str, code: str) -> None:
    assert preprocess(text, {}).code == code
