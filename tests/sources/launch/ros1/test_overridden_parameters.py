"""Parameters that a launch file sets and that one within it sets again."""

import pytest

from rtron.sources.launch.ros1.reader import read_launch

OUTER = """<launch><arg name="sim" default="true"/>
{}<include file="{}/inner.launch"/>{}
</launch>"""
SET = '<param name="/use_sim_time" value="{}"/>'
ON, OFF = SET.format("true"), SET.format("false")


@pytest.fixture
def overridden(tmp_path):
    """Return the parameters that a launch file sets in vain, with both values and the lines."""

    def read(before="", inner=OFF, behind=""):
        (tmp_path / "inner.launch").write_text(f"<launch>{inner}</launch>")
        launch = tmp_path / "outer.launch"
        launch.write_text(OUTER.format(before, tmp_path, behind))
        wiring = read_launch(launch, {}, {}, {}).wiring
        return [(f.subject, *f.others, f.value, *[e.line for e in f.evidence]) for f in wiring]

    return read


def test_an_included_file_sets_it_back(overridden):
    expected = [("/use_sim_time", "True", "False", 2, 1)]
    assert overridden(SET.format("$(arg sim)")) == expected
    assert overridden(f'<group ns="a">{SET.format(1.5)}</group>')[0][1] == "1.5"


def test_a_file_of_parameters_sets_it_back(overridden, tmp_path):
    (tmp_path / "a.yaml").write_text("speed: 2\n")
    load = f'<rosparam command="load" file="{tmp_path}/a.yaml"/>'
    assert overridden('<param name="speed" value="1"/>', load) == [("/speed", "1", "2", 2, 1)]
    assert overridden(load, '<param name="speed" value="3"/>') == [("/speed", "2", "3", 1, 1)]


@pytest.mark.parametrize(
    "parts",
    [
        {},
        {"before": OFF},
        {"behind": ON},
        {"before": ON, "behind": ON},
        {"before": ON, "inner": f'<group ns="a">{OFF.replace("/use", "use")}</group>'},
        {"before": ON, "inner": OFF.replace("/>", ' if="$(env X)"/>')},
        {"before": SET.format("$(env X)")},
        {"before": ON, "inner": OFF.replace("/use", "/other")},
    ],
)
def test_what_is_set_to_one_value_or_may_be_is_not_found(overridden, parts):
    assert overridden(**parts) == []


ARGUMENT = '<arg name="slow" default="false"/><param name="slow" value="$(arg slow)"/>'


def test_the_default_of_an_argument_that_is_not_given(overridden):
    before = '<param name="slow" value="true"/>'
    assert overridden(before, ARGUMENT) == [("/slow", "True", "$(arg slow)", "False", 2, 1)]
    assert overridden(before, ARGUMENT.replace("default", "value"))[0][1:3] == ("True", "False")


@pytest.mark.parametrize("default", ["$(arg given)", "$(eval not arg('given'))", "$(eval given)"])
def test_a_default_that_is_made_of_what_is_given_is_meant(tmp_path, overridden, default):
    used = ARGUMENT.replace("false", default)
    middle = f'<launch><arg name="given" default="true"/>{used}</launch>'
    (tmp_path / "middle.launch").write_text(middle)
    include = f'<include file="{tmp_path}/middle.launch">{{}}</include>'
    before = '<param name="slow" value="2"/>'
    [(_, one, other, *lines)] = overridden(
        before, include.format('<arg name="given" value="false"/>')
    )
    assert (one, other in {"True", "False"}, len(lines)) == ("2", True, 2)
    assert overridden(before, include.format(""))[0][2] == "$(arg slow)"


def test_a_default_that_an_inclusion_gives_is_given(tmp_path, overridden):
    (tmp_path / "middle.launch").write_text(f"<launch>{ARGUMENT}</launch>")
    given = f'<include file="{tmp_path}/middle.launch"><arg name="slow" default="0"/></include>'
    assert overridden('<param name="slow" value="1"/>', given)[0][1:3] == ("1", "0")


def test_an_argument_that_is_given_is_meant(tmp_path, overridden):
    (tmp_path / "middle.launch").write_text(f"<launch>{ARGUMENT}</launch>")
    given = f'<include file="{tmp_path}/middle.launch"><arg name="slow" value="false"/></include>'
    assert overridden('<param name="slow" value="true"/>', given)[0][1:3] == ("True", "False")
