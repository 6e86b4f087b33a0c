"""The guard announces itself often, and uses no shared memory, unless the user has profiles."""

import pytest
from defusedxml.ElementTree import fromstring, parse

from rtron.wire.ros2.discovery_tuning import (
    configure_cyclone,
    configure_fast_dds,
    publishes_without_waiting,
)

FAST_DDS = "rmw_fastrtps_cpp"
NAMES = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE")
RANGE, ONLY_LOCALHOST = "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY"
SPACE = "{http://www.eprosima.com}"


def with_release(version, folder, monkeypatch):
    """Let this be the release that has this version of rmw."""
    share = folder / "share" / "rmw"
    share.mkdir(parents=True)
    (share / "package.xml").write_text(f"<package><version>{version}</version></package>")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(folder))


def texts(environ, tag):
    """Return what each element of a name has in it, in the profile of an environment."""
    (path,) = (environ[name] for name in NAMES if name in environ)
    return [[part.text for part in each] or each.text for each in parse(path).iter(f"{SPACE}{tag}")]


@pytest.mark.parametrize("shares_memory", [True, False])
@pytest.mark.parametrize("range", ["SUBNET", "LOCALHOST"])
@pytest.mark.parametrize(
    ("version", "name", "heartbeat"),
    [
        ("?", NAMES[0], "heartbeat_period"),
        ("7.8.2", NAMES[0], "heartbeat_period"),
        ("7.3.2", NAMES[1], "heartbeatPeriod"),
        ("6.1.2", NAMES[1], "heartbeatPeriod"),
    ],
)
def test_fast_dds_is_given_a_profile_with_a_short_period(
    version, name, heartbeat, range, shares_memory, tmp_path, monkeypatch
):
    """The release tells which one, also where nobody has sourced it: wheels set no ROS_DISTRO."""
    with_release(version, tmp_path, monkeypatch)
    environ = {RANGE: range}
    assert configure_fast_dds(FAST_DDS, shares_memory=shares_memory, environ=environ)
    assert [each for each in NAMES if each in environ] == [name]
    assert texts(environ, "leaseAnnouncement") == [["0", "100000000"]]
    assert texts(environ, heartbeat) == [["0", "20000000"]]
    assert texts(environ, "max_blocking_time") == [["0", "0"]]
    root = parse(environ[name]).getroot()
    for kind in ("participant", "data_writer"):
        (profile,) = root.iter(f"{SPACE}{kind}")
        assert profile.get("is_default_profile") == "true"
    assert publishes_without_waiting(FAST_DDS, environ) is (name == NAMES[0])
    assert not publishes_without_waiting("rmw_cyclonedds_cpp", environ)


@pytest.mark.parametrize("users", [{}, {RANGE: "SUBNET"}, {ONLY_LOCALHOST: "0"}, {RANGE: "OFF"}])
def test_without_shared_memory_there_is_udp_alone(users):
    environ = dict(users)
    configure_fast_dds(FAST_DDS, shares_memory=False, environ=environ)
    assert texts(environ, "useBuiltinTransports") == ["false"]
    assert texts(environ, "type") == ["UDPv4"]
    assert texts(environ, "address") == []
    assert environ.items() >= users.items()


@pytest.mark.parametrize("users", [{RANGE: "LOCALHOST"}, {ONLY_LOCALHOST: "1", RANGE: "SUBNET"}])
def test_udp_alone_stays_on_this_machine_where_the_user_says_so(users):
    environ = dict(users)
    configure_fast_dds(FAST_DDS, shares_memory=False, environ=environ)
    assert texts(environ, "type") == ["UDPv4"]
    assert texts(environ, "address") == ["127.0.0.1", "127.0.0.1"]
    assert texts(environ, "TTL") == ["0"]
    assert (environ[RANGE], environ[ONLY_LOCALHOST]) == ("SUBNET", "0")


@pytest.mark.parametrize("users", [{RANGE: "LOCALHOST"}, {ONLY_LOCALHOST: "1"}, {RANGE: "SUBNET"}])
def test_a_child_that_shares_memory_has_the_range_of_the_user(users):
    environ = dict(users)
    for shares_memory in (False, False, True):
        configure_fast_dds(FAST_DDS, shares_memory=shares_memory, environ=environ)
    assert texts(environ, "useBuiltinTransports") == []
    for name in (RANGE, ONLY_LOCALHOST):
        assert environ.get(name, "") == users.get(name, "")


@pytest.mark.parametrize("name", NAMES)
def test_the_users_own_profiles_count(name):
    environ = {name: "/etc/dds.xml"}
    assert not configure_fast_dds(FAST_DDS, shares_memory=False, environ=environ)
    assert environ == {name: "/etc/dds.xml"}
    assert not publishes_without_waiting(FAST_DDS, environ)


def test_the_users_own_transports_count():
    environ = {"FASTDDS_BUILTIN_TRANSPORTS": "LARGE_DATA", RANGE: "LOCALHOST"}
    assert configure_fast_dds(FAST_DDS, shares_memory=False, environ=environ)
    assert texts(environ, "useBuiltinTransports") == []
    assert environ[RANGE] == "LOCALHOST"


@pytest.mark.parametrize("rmw", ["rmw_cyclonedds_cpp", "rmw_zenoh_cpp"])
def test_another_rmw_is_left_alone(rmw):
    environ = {RANGE: "LOCALHOST"}
    assert not configure_fast_dds(rmw, shares_memory=False, environ=environ)
    assert environ == {RANGE: "LOCALHOST"}


def test_a_process_that_the_guard_has_started_has_its_profile_and_no_user_s(caplog):
    environ = {}
    with caplog.at_level("INFO"):
        assert configure_fast_dds(FAST_DDS, shares_memory=False, environ=environ)
        before = dict(environ)
        assert configure_fast_dds(FAST_DDS, environ=environ)
    assert (environ, caplog.text) == (before, "")


@pytest.mark.parametrize("users", ["", "file:///etc/cyclone.xml", "<CycloneDDS/>"])
def test_cyclone_announces_often_and_the_users_own_settings_come_last(users):
    environ = {"CYCLONEDDS_URI": users} if users else {}
    configure_cyclone(environ)
    once = dict(environ)
    configure_cyclone(environ)
    assert environ == once
    settings, _, last = environ["CYCLONEDDS_URI"].partition(",")
    assert last == users
    domain = fromstring(settings).find("Domain")
    assert domain.findtext("Discovery/SPDPInterval") == "100 ms"
    assert domain.findtext("Internal/Watermarks/WhcHigh") == "1 GB"
