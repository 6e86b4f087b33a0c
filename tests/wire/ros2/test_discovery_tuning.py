"""The guard announces itself often, unless the user has profiles of Fast DDS."""

import pytest
from defusedxml.ElementTree import fromstring, parse

from rtron.wire.ros2.discovery_tuning import (
    configure_cyclone,
    enable_fast_announcements,
    publishes_without_waiting,
)

NAMES = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE")
SPACE = "{http://www.eprosima.com}"


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
    version, name, heartbeat, tmp_path, monkeypatch
):
    """The release tells which one, also where nobody has sourced it: wheels set no ROS_DISTRO."""
    folder = tmp_path / "share" / "rmw"
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(f"<package><version>{version}</version></package>")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    environ = {}
    assert enable_fast_announcements(environ)
    assert set(environ) == {name}
    found = parse(environ[name]).getroot()
    (period,) = found.iter(f"{SPACE}leaseAnnouncement")
    assert [each.text for each in period] == ["0", "100000000"]
    (period,) = found.iter(f"{SPACE}{heartbeat}")
    assert [each.text for each in period] == ["0", "20000000"]
    for kind in ("participant", "data_writer"):
        (profile,) = found.iter(f"{SPACE}{kind}")
        assert profile.get("is_default_profile") == "true"
    (longest_wait,) = found.iter(f"{SPACE}max_blocking_time")
    assert [each.text for each in longest_wait] == ["0", "0"]
    assert publishes_without_waiting("rmw_fastrtps_cpp", environ) is (name == NAMES[0])
    assert not publishes_without_waiting("rmw_cyclonedds_cpp", environ)


@pytest.mark.parametrize("name", NAMES)
def test_the_users_own_profiles_count(name):
    environ = {name: "/etc/dds.xml"}
    assert not enable_fast_announcements(environ)
    assert environ == {name: "/etc/dds.xml"}
    assert not publishes_without_waiting("rmw_fastrtps_cpp", environ)


def test_a_process_that_the_guard_has_started_has_its_profile_and_no_user_s(caplog):
    environ = {}
    with caplog.at_level("INFO"):
        assert enable_fast_announcements(environ)
        before = dict(environ)
        assert enable_fast_announcements(environ)
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
