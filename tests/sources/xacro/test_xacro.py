"""Every feature against the real xacro."""

import pytest
from file_tree import write

pytest.importorskip("xacro", reason="the real xacro is not installed")

from xacro_cases import CASES, FILES
from xml_differences import run_real_xacro, xml_differences

from rtron.sources.xacro import evaluate_xacro

ROBOT = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">{}</robot>'
ENVIRON = {"RTRON_TEST": "set"}
ARGS = {"given": "yes"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("xacro")
    write(folder, FILES)
    for name, body in CASES.items():
        (folder / f"{name}.urdf.xacro").write_text(ROBOT.replace("{}", body))
    return folder


@pytest.fixture(scope="module")
def answers(folder):
    jobs = [[str(folder / f"{name}.urdf.xacro"), ARGS] for name in CASES]
    return dict(zip(CASES, run_real_xacro(jobs, {"pkg": folder}, ENVIRON), strict=True))


@pytest.mark.parametrize("name", CASES)
def test_it_is_what_the_real_xacro_says(name, folder, answers):
    result = evaluate_xacro(folder / f"{name}.urdf.xacro", ARGS, {"pkg": folder}, ENVIRON)
    assert "xml" in answers[name], answers[name]
    assert xml_differences(result.text, answers[name]["xml"]) == []
    assert result.unresolved == ()


def test_the_comparison_sees_every_kind_of_difference():
    one = '<a x="1.0"><b/>t 2</a>'
    assert xml_differences(one, '<a x="1"><b/>t 2.0</a>') == []
    for other in ("<c/>", '<a x="2"><b/>t 2</a>', '<a x="1"><b/>t 3</a>', '<a x="1">t 2</a>'):
        assert xml_differences(one, other)
    assert xml_differences(one, '<a x="1" y=""><b/>t 2</a>')
