"""What is known of a description besides its text: places, Kinetic's order, what is remembered."""

import pytest

from rtron.sources.xacro import RobotDescriptions, evaluate_xacro, parse_element
from rtron.vocabulary import Evidence, UnknownValue

ROBOT = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro">\n{}</robot>'


@pytest.fixture
def write(tmp_path):
    def written(body, name="robot.xacro"):
        path = tmp_path / name
        path.write_text(ROBOT.replace("{}", body))
        return path

    return written


def test_every_element_keeps_the_file_and_line_it_was_written_at(write):
    parts = write(
        '<xacro:macro name="m" params="*b">\n<x>\n<xacro:insert_block name="b"/></x></xacro:macro>',
        "parts.xacro",
    )
    path = write('<xacro:include filename="parts.xacro"/>\n\n<xacro:m>\n<block/>\n</xacro:m>')
    x = evaluate_xacro(path, {}, {}, {}).root.find("x")
    assert x.evidence == Evidence(file=str(parts), line=3)
    assert x.find("block").evidence == Evidence(file=str(path), line=5)


def test_a_result_names_the_files_it_was_read_from(write, tmp_path):
    (tmp_path / "c.yaml").write_text("a: 1")
    write("", "parts.xacro")
    path = write('<xacro:include filename="parts.xacro"/><x y="${load_yaml(\'c.yaml\')}"/>')
    files = evaluate_xacro(path, {}, {}, {}).files
    assert files == tuple(str(tmp_path / n) for n in ("c.yaml", "parts.xacro", "robot.xacro"))


def test_kinetics_order_is_taken_where_the_order_of_lines_leaves_something_undefined(write):
    path = write(
        '<m a="${p}"/><macro name="m" params="a"><x a="${a}"/></macro>'
        '<xacro:m a="1"/><property name="p" value="5"/>'
    )
    result = evaluate_xacro(path, {}, {}, {})
    assert [x.attributes["a"] for x in result.root.elements("x")] == ["5", "1"]
    assert result.unresolved == ()


def test_dirname_is_the_folder_of_the_file(write, tmp_path):
    (x,) = evaluate_xacro(write('<x y="$(dirname)/a"/>'), {}, {}, {}).root.elements()
    assert x.attributes["y"] == f"{tmp_path}/a"


def test_a_namespace_used_in_an_included_file_is_declared_in_the_text(write, tmp_path):
    (tmp_path / "s.xacro").write_text('<robot xmlns:s="urn:s"><s:ray s:n="1"/></robot>')
    text = evaluate_xacro(write('<xacro:include filename="s.xacro"/>'), {}, {}, {}).text
    (ray,) = parse_element(text, "s").elements()
    assert (ray.tag, ray.attributes) == ("s:ray", {"s:n": "1"})


def test_a_description_is_evaluated_once_for_the_same_arguments(write):
    path = write('<xacro:arg name="a" default="0"/><x y="$(arg a)"/>')
    descriptions = RobotDescriptions(packages={}, environ={})
    text = descriptions.describe(path, {"a": "1"})
    result = descriptions.result_of_text(text)
    assert descriptions.evaluate_file(path, {"a": "1"}) is result
    assert result.root.find("x").attributes == {"y": "1"}
    assert descriptions.describe(path, {"a": "2"}) != text
    assert len(descriptions.results()) == 2


def test_a_description_that_cannot_be_read_is_unknown(tmp_path):
    descriptions = RobotDescriptions(packages={}, environ={})
    value = descriptions.describe(tmp_path / "absent", {})
    assert isinstance(value, UnknownValue)
    assert "absent" in value.why
    assert descriptions.results() == ()
    assert descriptions.result_of_text("<robot/>") is None
