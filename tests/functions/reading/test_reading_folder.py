import os
from pathlib import Path

import pytest

from rtron.errors import InputError
from rtron.functions.reading import folder as folder_module
from rtron.functions.reading import read_repositories
from rtron.functions.reading.json_lines import MAX_TEXT
from rtron.functions.repository import SourcePackage

BOMB = """<?xml version="1.0"?>
<!DOCTYPE package [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>
<package><name>&b;</name></package>"""


@pytest.fixture
def skipped_entries():
    return []


@pytest.fixture
def read(tmp_path, skipped_entries):
    def read_folder(folder="r"):
        note = lambda each: skipped_entries.append(str(each).replace(f"{tmp_path}/", ""))  # noqa: E731
        return read_repositories(tmp_path / folder, None, note)

    return read_folder


@pytest.fixture
def write(tmp_path):
    def write_file(name, content=""):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write_file


def manifest(name, more=""):
    return f"<package format='2'><name>{name}</name>{more}</package>"


def names(fake_study):
    return {each.name: [package.name for package in each.packages] for each in fake_study}


def test_a_package_is_a_repository(read, write, skipped_entries):
    text = (
        "<description>Drives <b>two</b>\n  wheels.<!-- no --></description><depend>roscpp</depend>"
    )
    write("r/package.xml", manifest(" base ", text))
    write("r/README.md", "# Base")
    (found,) = read()
    assert found.name == "r"
    assert found.readme == "# Base"
    description = "Drives two wheels."
    assert found.packages == (
        SourcePackage(name="base", description=description, depends=("roscpp",)),
    )
    assert skipped_entries == []


def test_every_package_that_a_build_would_find(read, write):
    write("r/.git/HEAD")
    for place in ("b", "stack/a", "b/test/inner", ".hidden/c", "d"):
        write(f"r/{place}/package.xml", manifest(place.rpartition("/")[2]))
    write("r/d/COLCON_IGNORE")
    assert names(read()) == {"r": ["b", "a"]}


def test_a_folder_of_repositories(read, write, skipped_entries):
    write("r/one/package.xml", manifest("one"))
    write("r/two/src/x/package.xml", manifest("x"))
    write("r/docs/index.md")
    write("r/file")
    assert names(read()) == {"one": ["one"], "two": ["x"]}
    assert skipped_entries == ["r/docs: has no package.xml"]


@pytest.mark.parametrize(
    ("files", "repositories"),
    [
        (["README.md"], {"r": ["a", "b"]}),
        (["README.md", "a/.git/HEAD"], {"a": ["a"], "b": ["b"]}),
        (["README.md", "a/.git/HEAD", ".git/HEAD"], {"r": ["a", "b"]}),
        (["README.md", "a/.git"], {"a": ["a"], "b": ["b"]}),
        ([], {"a": ["a"], "b": ["b"]}),
    ],
)
def test_one_repository_or_several(read, write, files, repositories):
    write("r/a/package.xml", manifest("a"))
    write("r/b/package.xml", manifest("b"))
    for name in files:
        write(f"r/{name}")
    assert names(read()) == repositories


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", ":1: not XML: Document is empty"),
        ("<package>", ":1: not XML: "),
        (b"\0\xff", ":1: not XML: "),
        (BOMB, ":1: has a document type"),
        (manifest("x" * 2**20), ": larger than 1 MiB"),
        ("<a>" * 100_000, ":1: not XML: "),
    ],
)
def test_a_manifest_that_cannot_be_read_costs_itself_only(read, write, skipped_entries, text, why):
    write("r/.git/HEAD")
    write("r/bad/package.xml", text)
    write("r/good/package.xml", manifest("good"))
    assert names(read()) == {"r": ["good"]}
    (told,) = skipped_entries
    assert told.startswith(f"r/bad/package.xml{why}")


def test_a_manifest_that_is_a_pipe_is_not_waited_for(read, write, skipped_entries, tmp_path):
    write("r/good/package.xml", manifest("good"))
    write("r/.git/HEAD")
    (tmp_path / "r/bad").mkdir()
    os.mkfifo(tmp_path / "r/bad/package.xml")
    write("r/bad/manifest.xml", manifest("bad"))
    assert names(read()) == {"r": ["good"]}
    assert skipped_entries == ["r/bad/package.xml: is no file"]


def test_a_package_without_a_name_has_its_folders(read, write):
    write("r/package.xml", "<package/>")
    assert names(read()) == {"r": ["r"]}
    write("r/package.xml", manifest("n" * 300))
    assert names(read()) == {"r": ["n" * 256]}


@pytest.mark.parametrize(
    ("files", "readme"),
    [
        ({"README": "plain"}, "plain"),
        ({"readme.rst": "rst", "README.txt": "txt"}, "rst"),
        ({"README.md": "md", "README.rst": "rst", "README": "plain"}, "md"),
        ({"README.pdf": "pdf", "README.md.orig": "orig"}, ""),
        ({"README.md": b"caf\xe9"}, "caf\ufffd"),
        ({"README.md": "x" * (MAX_TEXT + 1)}, "x" * MAX_TEXT),
    ],
)
def test_readmes(read, write, files, readme):
    write("r/package.xml", manifest("a"))
    for name, content in files.items():
        write(f"r/{name}", content)
    (found,) = read()
    assert found.readme == readme


def test_a_binary_readme_is_left_out(read, write, skipped_entries):
    write("r/package.xml", manifest("a"))
    write("r/README.md", b"PK\0\0")
    (found,) = read()
    assert (found.readme, skipped_entries) == ("", ["r/README.md: is binary"])


def test_a_readme_outside_of_the_folder_is_not_read(read, write, tmp_path):
    write("r/package.xml", manifest("a"))
    (tmp_path / "r/README.md").symlink_to(write("secret", "s"))
    (tmp_path / "r/README.txt").symlink_to("/dev/zero")
    (found,) = read()
    assert found.readme == ""


def test_the_readme_of_the_only_package(read, write):
    write("r/.git/HEAD")
    write("r/a/package.xml", manifest("a"))
    write("r/a/README.md", "of a")
    assert read()[0].readme == "of a"
    write("r/b/package.xml", manifest("b"))
    assert read()[0].readme == ""


def test_a_readme_elsewhere_in_the_repository_is_read(read, write, tmp_path):
    write("r/.git/HEAD")
    write("r/a/package.xml", manifest("a"))
    write("r/docs/about.md", "about")
    (tmp_path / "r/a/README.md").symlink_to("../docs/about.md")
    (found,) = read()
    assert found.readme == "about"


@pytest.mark.parametrize("target", ["../../elsewhere.xml", "absent.xml", "package.xml"])
def test_a_manifest_that_leads_elsewhere_is_not_read(
    read, write, skipped_entries, tmp_path, target
):
    write("elsewhere.xml", manifest("secret"))
    write("r/.git/HEAD")
    write("r/a/package.xml", manifest("a"))
    write("r/inner.xml", manifest("inner"))
    for name, link in (("bad", target), ("inner", "../inner.xml")):
        (tmp_path / "r" / name).mkdir()
        (tmp_path / "r" / name / "package.xml").symlink_to(link)
    assert names(read()) == {"r": ["a", "inner"]}
    assert skipped_entries == [
        "r/bad/package.xml: is a link that leads out of the repository, or nowhere"
    ]


def test_a_linked_repository_counts_by_its_own_name(
    read, write, skipped_entries, tmp_path, monkeypatch
):
    write("elsewhere/target/package.xml", manifest("a"))
    write("elsewhere/target/README.md", "of a")
    write("r/b/package.xml", manifest("b"))
    (tmp_path / "r/linked").symlink_to(tmp_path / "elsewhere/target")
    found = read()
    assert names(found) == {"b": ["b"], "linked": ["a"]}
    assert found[1].readme == "of a"
    assert names(read("r/linked")) == {"linked": ["a"]}
    monkeypatch.chdir(tmp_path / "r/b")
    assert names(read_repositories(Path(), None, print)) == {"b": ["b"]}
    assert skipped_entries == []


def test_a_package_that_cannot_be_read_is_told_once(read, write, skipped_entries):
    write("r/xxe/package.xml", BOMB)
    write("r/good/package.xml", manifest("good"))
    assert names(read()) == {"good": ["good"]}
    assert skipped_entries == ["r/xxe/package.xml:1: has a document type"]


def test_links_to_folders_are_not_followed(read, write, tmp_path):
    write("r/.git/HEAD")
    write("r/a/package.xml", manifest("a"))
    (tmp_path / "r/again").symlink_to(tmp_path / "r")
    assert names(read()) == {"r": ["a"]}


def test_a_folder_without_packages(read, tmp_path):
    (tmp_path / "r").mkdir()
    with pytest.raises(InputError, match="no repository could be read") as raised:
        read()
    assert raised.value.help == "a repository has a package.xml in it or below"
    (tmp_path / "r/.git").mkdir()
    with pytest.raises(InputError) as raised:
        read()
    assert raised.value.help == f"{tmp_path}/r: has no package.xml"


def test_folders_and_packages_are_bounded(read, write, skipped_entries, monkeypatch):
    write("r/.git/HEAD")
    for name in "abc":
        write(f"r/{name}/package.xml", manifest(name))
    monkeypatch.setattr("rtron.functions.reading.json_lines.MAX_PACKAGES", 2)
    assert names(read()) == {"r": ["a", "b"]}
    assert skipped_entries == ["r: has more than 2 packages; the others are left out"]
    monkeypatch.setattr("rtron.functions.reading.json_lines.MAX_PACKAGES", 3)
    assert names(read()) == {"r": ["a", "b", "c"]}
    monkeypatch.setattr(folder_module, "MAX_FOLDERS", 4)
    assert names(read()) == {"r": ["a", "b", "c"]}
    skipped_entries.clear()
    monkeypatch.setattr(folder_module, "MAX_FOLDERS", 3)
    assert names(read()) == {"r": ["a", "b"]}
    assert skipped_entries == ["r: has more than 3 folders; the others are left out"]


def test_a_deep_folder_costs_what_lies_in_it_only(
    read, write, skipped_entries, deep_folder, tmp_path
):
    for name in "ab":
        write(f"r/{name}/package.xml", manifest(name))
    write("r/b/README.md", "of b")
    write("r/deep/p/package.xml", manifest("p"))
    deep_folder(tmp_path / "r/deep")
    found = read()
    assert names(found) == {"a": ["a"], "b": ["b"], "deep": ["p"]}
    assert found[1].readme == "of b"
    assert skipped_entries == [f"r/deep{'/d' * 101}: lies more than 100 folders deep"]
