"""Places that look like calls."""

import pytest

from evaluation.ros1.call_sites import NEAR, call_sites, unreached


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
