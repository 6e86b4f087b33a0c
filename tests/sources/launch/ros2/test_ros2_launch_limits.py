"""Launch files of strangers: what is larger than any app's ends, with a note."""

import os

import pytest
from app_launch_values import names, whys

from rtron.sources.launch.ros2 import limits

NODE = "Node(executable='e', name='n')"


def doubled(first, last, body="x = [x, x]"):
    """Return a program whose list doubles itself."""
    lines = "\n    ".join([f"x = {first}", *[body] * 40, last])
    return f"def generate_launch_description():\n    {lines}\n"


@pytest.mark.parametrize(
    "text",
    [
        doubled(NODE, "return LaunchDescription(x)"),
        doubled(
            "LaunchConfiguration('a')", "return LaunchDescription([Node(executable='e', name=x)])"
        ),
        doubled(
            "{'a': 1}",
            "return LaunchDescription([Node(executable='e', parameters=[x])])",
            "x = {'a': x, 'b': x}",
        ),
        doubled("[]", "return x", "x.append(x)"),
        doubled("LaunchDescription()", "return x", "x.add_action(x)"),
    ],
)
def test_lists_that_double_each_other_end(program, monkeypatch, text):
    monkeypatch.setattr(limits, "MAX_TEXT_PARTS", 5_000)
    app = program(text)
    assert any("more than 5000 parts" in why for why in whys(app))


def test_what_was_read_before_a_bound_stays(python, monkeypatch):
    monkeypatch.setattr(limits, "MAX_NODES", 3)
    app = python(f"*[{NODE}] * 9")
    assert names(app) == ["/n"] * 3
    assert any("more than 3 nodes" in why for why in whys(app))


def test_the_steps_of_all_python_files_are_bounded(python, package, monkeypatch):
    busy = (
        "def generate_launch_description():\n    for a in range(100):\n        b = a\n    return []"
    )
    (package / "launch" / "busy.launch.py").write_text(busy)
    include = "IncludeLaunchDescription([ThisLaunchFileDir(), '/busy.launch.py'])"
    assert whys(python(f"*[{include}] * 9")) == []
    monkeypatch.setattr(limits, "MAX_STEPS", 1_000)
    assert any("steps of Python" in why for why in whys(python(f"*[{include}] * 9")))


def test_the_values_of_parameters_are_bounded(python, package, monkeypatch):
    values = ", ".join(f"p{number}: $(var x)" for number in range(100))
    (package / "p.yaml").write_text(f"/**: {{ros__parameters: {{{values}}}}}")
    path = f"{package}/p.yaml"
    plain = f"Node(executable='e', name='n', parameters=['{path}'])"
    rewritten = f"Node(executable='e', name='n', parameters=[RewrittenYaml('{path}', {{}})])"
    replaced = (
        f"Node(executable='e', name='n', parameters=[ParameterFile('{path}', allow_substs=True)])"
    )
    monkeypatch.setattr(limits, "MAX_VALUES", 1_000)
    assert whys(python(f"*[{plain}] * 99")) == []
    for text in (rewritten, replaced):
        assert any("values of parameters" in why for why in whys(python(f"*[{text}] * 99")))


def test_python_files_that_include_each_other_in_a_circle_end(python):
    app = python(f"{NODE}, IncludeLaunchDescription(ThisLaunchFile())")
    assert 1 < len(app.starts) <= 33
    assert any("include each other" in why for why in whys(app))


def test_xml_files_that_include_each_other_in_a_circle_end(xml):
    app = xml('<node pkg="p" exec="e" name="n"/><include file="$(filename)"/>')
    assert 1 < len(app.starts) <= 33
    assert any("include each other" in why for why in whys(app))


@pytest.mark.parametrize(
    "text", ["<launch>", "<robot/>", "", "<!DOCTYPE x [<!ENTITY a 'b'>]><launch/>"]
)
def test_xml_that_is_no_launch_file(read, text):
    app = read(text, "xml")
    assert app.starts == ()
    assert len(app.unresolved) == 1


@pytest.mark.parametrize("text", ["launch: [", "a: 1", "- b", "launch: &a [*a]", "\x00"])
def test_yaml_that_is_no_launch_file(read, text):
    app = read(text, "yaml")
    assert app.starts == ()
    assert len(app.unresolved) == 1


def test_marks_of_what_is_not_known_in_the_text_itself_lead_nowhere(python):
    app = python("Node(executable='\ue000a\ue001\ue000', name='n\ue001')")
    assert app.starts[0].program == "{a}"
    assert names(app) == ["/n"]


def test_texts_that_double_each_other_end(xml):
    doubling = '<let name="a" value="$(var a)$(var a)"/>' * 60
    app = xml(f'<let name="a" value="ha"/>{doubling}<node pkg="$(var a)" exec="e"/>')
    assert len(app.starts[0].package) < 100_000
    assert any("longer than" in why for why in whys(app))


@pytest.mark.parametrize("kind", ["fifo", "folder", "large"])
def test_a_python_file_that_is_none_is_not_opened(python, package, kind):
    path = package / "launch" / "in.launch.py"
    if kind == "large":
        with path.open("wb") as file:
            file.truncate(2**31)
    else:
        os.mkfifo(path) if kind == "fifo" else path.mkdir()
    app = python(f"IncludeLaunchDescription('{path}'), {NODE}")
    assert names(app) == ["/n"]
    assert any("is no file" in why or "larger than" in why for why in whys(app))


@pytest.mark.parametrize("kind", ["fifo", "folder", "large"])
def test_a_parameter_file_that_is_none_is_not_opened(python, package, kind):
    path = package / "p.yaml"
    if kind == "large":
        with path.open("wb") as file:
            file.truncate(2**31)
    else:
        os.mkfifo(path) if kind == "fifo" else path.mkdir()
    app = python(f"Node(executable='e', name='n', parameters=['{path}'])")
    assert names(app) == ["/n"]
    assert any("is no file" in why or "larger than" in why for why in whys(app))
