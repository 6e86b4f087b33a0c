"""Comments that ignore a finding, beside what was read."""

import os

import pytest

from rtron.sources.ignores import comment_ignores
from rtron.vocabulary import Evidence


def comments(tmp_path, text, line, name="a.py"):
    (tmp_path / "a.py").write_text(text)
    return list(comment_ignores([Evidence(file=name, line=line)], tmp_path))


@pytest.mark.parametrize(
    "text",
    [
        "pub = Publisher()  # rtron: ignore[no_server] a test rig",
        "advertise(); // rtron: ignore[no_server] a test rig",
        "<!-- rtron: ignore[no_server] a test rig --><node/>",
        "/* rtron:ignore[no_server]  a test rig */",
    ],
)
def test_a_comment_of_any_language_has_a_rule_and_a_reason(tmp_path, text):
    (ignore,) = comments(tmp_path, text, 1)
    assert (ignore.rule, ignore.reason, ignore.is_comment) == ("no_server", "a test rig", True)
    assert ignore.place == Evidence(file="a.py", line=1)


def test_only_the_line_and_the_one_before_count(tmp_path):
    text = "\n".join(f"# rtron: ignore[r{n}] x" for n in range(1, 6))
    assert [each.rule for each in comments(tmp_path, text, 3)] == ["r2", "r3"]


@pytest.mark.parametrize("text", ["# rtron: ignore[no_server]", "# rtron: ignore[] x", "ignore"])
def test_without_a_rule_and_a_reason_nothing_is_ignored(tmp_path, text):
    assert comments(tmp_path, text, 1) == []


def test_files_outside_the_app_that_are_gone_or_no_files_have_no_comments(tmp_path):
    app = tmp_path / "app"
    app.mkdir()
    text = "# rtron: ignore[no_server] x"
    (tmp_path / "secret.py").write_text(text)
    os.mkfifo(app / "pipe")
    for name in ("../secret.py", str(tmp_path / "secret.py"), "gone.py", "pipe"):
        assert comments(app, text, 1, name) == [], name


def test_an_absolute_path_below_the_app_is_read(tmp_path):
    (ignore,) = comments(tmp_path, "# rtron: ignore[x] y", 1, str(tmp_path / "a.py"))
    assert ignore.rule == "x"
