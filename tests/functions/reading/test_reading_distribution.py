from dataclasses import replace

import pytest
import yaml

from rtron.errors import InputError
from rtron.functions.reading import distribution, read_repositories
from rtron.functions.reading.distribution import YAML_RULES
from rtron.functions.repository import SourcePackage, SourceRepository

DISTRIBUTION = """%YAML 1.1
---
release_platforms: {ubuntu: [xenial]}
repositories:
  navigation:
    doc: {type: git, url: https://doc}
    release:
      packages: [amcl, map_server]
      url: https://release
      version: 1.14.9-1
    source: {type: git, url: https://source}
  lone:
    release: {url: https://lone}
  unreleased:
    source: {type: git, url: https://unreleased}
  empty: {}
type: distribution
version: 2
"""


@pytest.fixture
def skipped_entries():
    return []


@pytest.fixture
def read(tmp_path, skipped_entries):
    def read_text(text):
        path = tmp_path / "distribution.yaml"
        path.write_text(text)
        return read_repositories(
            path, None, lambda each: skipped_entries.append(str(each).replace(f"{path}", "file"))
        )

    return read_text


def test_names_are_read(read, skipped_entries):
    amcl, server, lone = (
        SourcePackage(name="amcl"),
        SourcePackage(name="map_server"),
        SourcePackage(name="lone"),
    )
    assert read(DISTRIBUTION) == [
        SourceRepository(name="navigation", packages=(amcl, server), url="https://source"),
        SourceRepository(name="lone", packages=(lone,), url="https://lone"),
        SourceRepository(name="unreleased", url="https://unreleased"),
        SourceRepository(name="empty"),
    ]
    assert skipped_entries == []


@pytest.mark.parametrize(
    ("entry", "why"),
    [
        ("7: {}", "7: repo is no name"),
        ("'': {}", ": repo is no name"),
        ("a: []", "a: the entry is no object"),
        ("a: {release: [x]}", "a: release is no object"),
        ("a: {release: {packages: b}}", "a: packages is no list"),
        ("a: {release: {packages: [3]}}", "a: a package is no name"),
        ("a: {source: {url: 3}}", "a: url is no text"),
        ("[a, b]: {}", None),
    ],
)
def test_a_wrong_entry_costs_itself_only(read, skipped_entries, entry, why):
    text = f"repositories:\n  {entry}\n  good: {{}}\n"
    if why is None:
        with pytest.raises(InputError, match="not YAML"):
            read(text)
        return
    assert [each.name for each in read(text)] == ["good"]
    assert skipped_entries == [f"file: {why}"]


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("", "lists no repositories"),
        ("[a]", "lists no repositories"),
        ("repositories: [a]", "lists no repositories"),
        ("repositories: {}", "no repository could be read"),
        ("repositories: {a: []}", "no repository could be read"),
        ("a: b: c", r"yaml:1: not YAML: mapping values are not allowed"),
        ("repositories:\n  a: &x {}\n  b: *x", r"yaml:2: has anchors and aliases"),
        ("a: !!python/object/apply:os.system ['true']", r"yaml:1: has tags"),
        ("[" * (YAML_RULES.max_depth + 1), "more than 20 levels"),
        ("[" * 1_000_000, "more than 20 levels"),
        ("a: 2020-99-99", "not YAML"),
        ("\0", "not YAML"),
    ],
)
def test_what_is_no_distribution(read, text, match):
    with pytest.raises(InputError, match=match):
        read(text)


def test_levels_up_to_the_bound_are_read(read):
    levels = YAML_RULES.max_depth - 1
    (found,) = read(f"repositories: {{good: {{}}}}\nmore: {'[' * levels}{']' * levels}")
    assert found.name == "good"


def test_the_packages_of_a_release_are_bounded(read, skipped_entries, monkeypatch):
    monkeypatch.setattr("rtron.functions.reading.json_lines.MAX_PACKAGES", 2)
    (found,) = read("repositories: {r: {release: {packages: [a, b, c]}}}")
    assert [each.name for each in found.packages] == ["a", "b"]
    assert skipped_entries == ["file: r: has more than 2 packages; the others are left out"]


def test_a_file_has_a_number_of_values(read, monkeypatch):
    text = "repositories: {good: {}}"
    events = sum(1 for _ in yaml.parse(text))
    monkeypatch.setattr(distribution, "YAML_RULES", replace(YAML_RULES, max_values=events))
    assert [each.name for each in read(text)] == ["good"]
    fewer = replace(YAML_RULES, max_values=events - 1)
    monkeypatch.setattr(distribution, "YAML_RULES", fewer)
    with pytest.raises(InputError, match=f"has more than {events - 1} values$"):
        read(text)


def test_a_file_of_empty_lists_is_not_made_into_objects(read, monkeypatch):
    monkeypatch.setattr(yaml, "load", None)
    with pytest.raises(InputError, match=r"has more than 250000 values$"):
        read(f"repositories: [{'[],' * 1_300_000}]")


@pytest.mark.parametrize(("extra", "match"), [(0, "not YAML"), (1, "larger than 4 MiB")])
def test_a_file_of_any_size_is_not_read(tmp_path, extra, match):
    path = tmp_path / "large.yml"
    with path.open("wb") as stream:
        stream.truncate(4 * 2**20 + extra)
    with pytest.raises(InputError, match=match):
        read_repositories(path, None, print)
