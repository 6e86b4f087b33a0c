"""Calls, counted by their place."""

import pytest

from evaluation.ros1.call_sites import NEAR, call_sites, count_calls, is_explained, unreached
from rtron.sources.declaration import Declaration, DeclarationKind, NodeInterface
from rtron.vocabulary import Evidence

PUBLISH, SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE


def declared(name, line, kind=PUBLISH, **more):
    return Declaration(kind=kind, name=name, evidence=(Evidence(file="a.cpp", line=line),), **more)


def counted(*declarations):
    found = count_calls(NodeInterface(declarations=declarations))
    return len(found.calls), len(found.unresolved)


@pytest.mark.parametrize(
    ("name", "explained"),
    [
        ("/scan", True),
        ("/{~prefix}/scan", True),
        ("/{/robot/name}/{~prefix}", True),
        ("/{{~name}}", True),
        ("/{?}", False),
        ("/{}", False),
        ("/{~prefix}/{i}", False),
        ("/{/robot/{?}/name}", False),
    ],
)
def test_a_parameter_explains_a_name_and_nothing_else_does(name, explained):
    assert is_explained(name) is explained


def test_a_place_is_one_call_however_many_names_it_declares():
    assert counted(declared("/a", 1), declared("/b", 1)) == (1, 0)
    assert counted(declared("/a", 1), declared("/a", 2)) == (2, 0)
    assert counted(declared("/a", 1), declared("/a", 1, SUBSCRIBE)) == (2, 0)


def test_one_unknown_name_makes_its_call_unresolved():
    assert counted(declared("/a", 1), declared("/{?}", 1), declared("/b", 2)) == (2, 1)


def test_what_a_library_declares_is_no_call():
    assert counted(declared("/tf", 1, implicit=True), declared("/{?}", 2, implicit=True)) == (0, 0)


@pytest.mark.parametrize(
    ("line", "fake_study"),
    [
        ('nh.advertise<std_msgs::Bool>("x", 1);', True),
        ('nh->subscribe("x", 1, callback);', True),
        ('nh . advertiseService ("x", callback);', True),
        ('nh.serviceClient<a::B>("x");', True),
        ('// nh.subscribe("x", 1, callback);', False),
        ('/*\nnh.subscribe("x", 1, callback);\n*/', False),
        ("subscribe(topic);", False),
        ("nh.advertised(x);", False),
    ],
)
def test_cpp(tmp_path, line, fake_study):
    path = tmp_path / "a.cpp"
    path.write_text(f"/* one\ntwo */\n{line}\n")
    assert call_sites([path]) == ({(str(path), 3)} if fake_study else set())


@pytest.mark.parametrize(
    ("line", "fake_study"),
    [
        ("p = rospy.Publisher('x', Bool)", True),
        ("rospy.ServiceProxy(name, Empty)", True),
        ("# rospy.Subscriber('x', Bool)", False),
        ("rospy.spin()", False),
    ],
)
def test_python(tmp_path, line, fake_study):
    path = tmp_path / "node"
    path.write_text(f"\n{line}\n")
    assert call_sites([path]) == ({(str(path), 2)} if fake_study else set())


@pytest.mark.parametrize(
    ("line", "reached"), [(10, True), (10 - NEAR, True), (10 + NEAR, True), (11 + NEAR, False)]
)
def test_a_call_nearby_reaches_a_site(line, reached):
    assert unreached([("a", 10)], [("publish", "a", line)]) == ([] if reached else [("a", 10)])
    assert unreached([("a", 10)], [("publish", "b", line)]) == [("a", 10)]
