import io
import json
import sys
from types import SimpleNamespace

import pytest

from rtron.errors import InputError
from rtron.functions.reading import json_lines as lines_module
from rtron.functions.reading import read_repositories
from rtron.functions.reading import repositories as read_module
from rtron.functions.reading.json_lines import MAX_LINE, MAX_NAME, MAX_TEXT
from rtron.functions.reading.skipped_entries import MAX_SKIPPED
from rtron.functions.repository import SourcePackage, SourceRepository
from rtron.sources.bounded_file import STDIN

GOOD = {"repo": "good", "packages": [{"name": "a"}]}


@pytest.fixture
def skipped_entries():
    return []


@pytest.fixture
def read(tmp_path, skipped_entries):
    """Read lines, and keep what is left out in `skipped_entries`, without the file's name."""

    def read_lines(*written, readmes=None):
        path = tmp_path / "corpus.jsonl"
        path.write_bytes(b"\n".join(as_line(each) for each in written))
        more = None
        if readmes is not None:
            more = tmp_path / "readmes.jsonl"
            more.write_bytes(b"\n".join(as_line(each) for each in readmes))
        return read_repositories(
            path, more, lambda each: skipped_entries.append(skipped_text(each, tmp_path))
        )

    return read_lines


def as_line(written):
    return written if isinstance(written, bytes) else json.dumps(written).encode()


def skipped_text(skipped, folder):
    return str(skipped).replace(f"{folder}/", "")


def test_all_that_counts_is_read(read, skipped_entries):
    package = {"name": "b", "description": "Drives it.", "depends": ["std_msgs"], "license": "BSD"}
    line = {"repo": "r", "url": "https://x", "readme": "# R", "packages": [package], "more": 1}
    found = read(line)
    depends = ("std_msgs",)
    packages = (SourcePackage(name="b", description="Drives it.", depends=depends),)
    assert found == [SourceRepository(name="r", url="https://x", readme="# R", packages=packages)]
    assert skipped_entries == []


def test_a_name_is_enough(read):
    assert read({"repo": " r "}) == [SourceRepository(name="r")]
    assert read({"repo": "r", "packages": None, "readme": None}) == [SourceRepository(name="r")]


def test_a_name_has_up_to_256_characters(read, skipped_entries):
    (found,) = read({"repo": "r" * MAX_NAME})
    assert (len(found.name), skipped_entries) == (256, [])


def test_a_placeholder_says_nothing(read):
    package = {"name": "a", "description": "The a package", "placeholder": True}
    (found,) = read({"repo": "r", "packages": [package, {**package, "placeholder": 0}]})
    assert [each.description for each in found.packages] == ["", "The a package"]


@pytest.mark.parametrize(
    ("line", "why"),
    [
        (b"{", "not JSON: Expecting property name enclosed in double quotes"),
        (b"\xff{}", "not JSON: 'utf-8' codec can't decode byte 0xff in position 0"),
        (b'{"repo": ' + b"9" * 5000 + b"}", "not JSON: "),
        (b"[" * 100_000, "nested too deep"),
        ([], "no JSON object"),
        (None, "no JSON object"),
        ({}, "repo is no name"),
        ({"repo": 7}, "repo is no name"),
        ({"repo": "  "}, "repo is no name"),
        ({"repo": "r" * (MAX_NAME + 1)}, "repo is longer than 256 characters"),
        ({"repo": "r", "packages": {}}, "packages is no list"),
        ({"repo": "r", "packages": ["a"]}, "a package is no object"),
        ({"repo": "r", "packages": [{"name": None}]}, "name is no name"),
        ({"repo": "r", "packages": [{"name": "a", "description": 1}]}, "description is no text"),
        ({"repo": "r", "packages": [{"name": "a", "depends": "b"}]}, "depends is no list"),
        ({"repo": "r", "packages": [{"name": "a", "depends": [1]}]}, "depends holds what is no"),
        ({"repo": "r", "readme": ["x"]}, "readme is no text"),
        ({"repo": "r", "url": 1}, "url is no text"),
    ],
)
def test_a_wrong_line_costs_itself_only(read, skipped_entries, line, why):
    assert [each.name for each in read(GOOD, line, {"repo": "last"})] == ["good", "last"]
    (told,) = skipped_entries
    assert told.startswith(f"corpus.jsonl:2: {why}")


@pytest.mark.parametrize(("extra", "kept"), [(0, True), (1, False)])
def test_lines_are_read_up_to_a_mebibyte(read, skipped_entries, extra, kept):
    start = b'{"repo": "long", "readme": "'
    line = start + b"x" * (MAX_LINE - len(start) - 3 + extra) + b'"}'
    names = [each.name for each in read(GOOD, line, {"repo": "last"})]
    assert names == (["good", "long", "last"] if kept else ["good", "last"])
    assert skipped_entries == ([] if kept else ["corpus.jsonl:2: longer than 1 MiB"])


def test_a_line_of_100_megabytes_is_left_out(read, skipped_entries):
    names = [each.name for each in read(b"x" * 100_000_000, GOOD)]
    assert (names, skipped_entries) == (["good"], ["corpus.jsonl:1: longer than 1 MiB"])


def test_a_last_line_without_an_end_and_empty_lines(read, skipped_entries):
    assert [each.name for each in read(b"", b"  ", GOOD, b"\r", {"repo": "b"})] == ["good", "b"]
    assert skipped_entries == []


def test_texts_are_cut(read):
    (found,) = read({"repo": "r", "readme": "x" * (MAX_TEXT + 1)})
    assert found.readme == "x" * MAX_TEXT


def test_a_name_that_no_terminal_takes_is_kept_as_it_is(read):
    assert [each.name for each in read(rb'{"repo": "\ud800\u001b[2J"}')] == ["\ud800\x1b[2J"]


def test_of_two_of_a_name_the_first_counts(read, skipped_entries):
    found = read(GOOD, {"repo": "good", "url": "second"})
    assert [each.url for each in found] == [""]
    assert skipped_entries == ["corpus.jsonl: good is there twice; the first counts"]


def test_readmes_are_for_those_that_have_none(read, skipped_entries):
    readmes = [
        {"repo": "good", "readme": "first"},
        {"repo": "good", "readme": "second"},
        {"repo": "own", "readme": "not this"},
        {"repo": "nobody", "readme": "x"},
        {"repo": "b", "readme": 1},
        {"readme": "x"},
    ]
    found = read(GOOD, {"repo": "own", "readme": "own"}, {"repo": "b"}, readmes=readmes)
    assert [each.readme for each in found] == ["first", "own", ""]
    assert skipped_entries == [
        "readmes.jsonl:5: readme is no text",
        "readmes.jsonl:6: repo is no name",
    ]


def test_nothing_that_can_be_read_is_an_error(read):
    with pytest.raises(InputError, match="no repository could be read") as raised:
        read(b"\x7fELF\0\0", b"{")
    assert "corpus.jsonl:1: not JSON" in raised.value.help
    with pytest.raises(InputError) as raised:
        read()
    assert raised.value.help == "a line is an object with `repo` and `packages`"


def test_a_file_full_of_something_else_is_given_up(read, skipped_entries):
    with pytest.raises(InputError, match="more than 1000 entries cannot be read") as raised:
        read(*[b"x"] * (MAX_SKIPPED + 1))
    assert len(skipped_entries) == MAX_SKIPPED
    assert "is it the right file? " in raised.value.help
    assert len(read(GOOD, *[b"x"] * MAX_SKIPPED)) == 1


def test_a_file_has_a_size_and_a_number_of_repositories(read, monkeypatch):
    monkeypatch.setattr(lines_module, "MAX_BYTES", 100)
    monkeypatch.setattr(read_module, "MAX_REPOSITORIES", 2)
    assert len(read(b'{"repo":"a"}', b'{"repo":"b"}')) == 2
    with pytest.raises(InputError, match="more than 2 repositories"):
        read(b'{"repo":"a"}', b'{"repo":"b"}', b'{"repo":"c"}')
    assert len(read(b'{"repo":"a"}'.ljust(100))) == 1
    with pytest.raises(InputError, match="larger than 0 MiB"):
        read(b'{"repo":"a"}'.ljust(101))


def test_the_packages_of_a_line_are_bounded(read, skipped_entries, monkeypatch):
    monkeypatch.setattr(lines_module, "MAX_PACKAGES", 2)
    packages = [{"name": name} for name in "ab"]
    assert len(read({"repo": "r", "packages": packages})[0].packages) == 2
    assert skipped_entries == []
    found = read({"repo": "r", "packages": [*packages, "not looked at"]}, {"repo": "s"})
    assert [len(each.packages) for each in found] == [2, 0]
    assert skipped_entries == ["corpus.jsonl:1: has more than 2 packages; the others are left out"]


def test_the_packages_of_all_lines_are_bounded(read, monkeypatch):
    monkeypatch.setattr(read_module, "MAX_PACKAGES", 3)
    two = {"repo": "r", "packages": [{"name": "a"}, {"name": "b"}]}
    assert len(read(two, {"repo": "s", "packages": [{"name": "c"}]})) == 2
    with pytest.raises(InputError, match="more than 3 packages"):
        read(two, {**two, "repo": "s"})


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(InputError, match="No such file") as raised:
        read_repositories(tmp_path / "x.jsonl", None, print)
    assert raised.value.help == "check the path"
    (tmp_path / "c.jsonl").write_text('{"repo": "a"}')
    with pytest.raises(InputError, match="Is a directory"):
        read_repositories(tmp_path / "c.jsonl", tmp_path, print)


def test_standard_input(monkeypatch):
    notes = []
    stdin = SimpleNamespace(buffer=io.BytesIO(b'{"repo": "a"}\n{'))
    monkeypatch.setattr(sys, "stdin", stdin)
    assert [each.name for each in read_repositories(STDIN, None, notes.append)] == ["a"]
    assert [each.location for each in notes] == ["standard input:2"]
