"""Who comes in to the router, in which guise, and what happens when it restarts."""

import pytest

zenoh = pytest.importorskip("zenoh", reason="needs eclipse-zenoh (extra `dev`)")

from zenoh_robot import BASE, GUARD, MAPPER, NAV, OPERATOR, OUTPUT, ZenohRobot, until, without  # noqa: E402

END = b"end"


def hasty(config):
    """Return a configuration that gives up if the router does not take it at once."""
    return config | {"connect": config["connect"] | {"timeout_ms": 300, "exit_on_failure": True}}


def with_tls(config, **changes):
    """Return a configuration with other TLS settings; None takes one away."""
    transport = config["transport"]
    link = transport["link"]
    changed = {key: value for key, value in (link["tls"] | changes).items() if value is not None}
    return config | {"transport": transport | {"link": link | {"tls": changed}}}


def assert_refused(robot, config):
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        robot.open(hasty(config))


def test_nobody_comes_in_without_a_certificate_of_the_authority(driven, tmp_path):
    robot, other = driven.robot, ZenohRobot(tmp_path / "other")
    other.write()
    config = robot.session_config(GUARD)
    theirs = other.session_config(GUARD)["transport"]["link"]["tls"]
    ours = config["transport"]["link"]["tls"]["root_ca_certificate"]
    assert_refused(robot, with_tls(config, **theirs | {"root_ca_certificate": ours}))
    nameless = {"connect_certificate": None, "connect_private_key": None, "enable_mtls": False}
    assert_refused(robot, with_tls(config, **nameless))
    plain = {"endpoints": [robot.router.endpoint.replace("tls", "tcp")]}
    assert_refused(robot, config | {"connect": plain, "transport": {}})
    driven.drive()
    assert driven.heard.payloads == [END]


def test_no_other_process_can_play_the_router(robot):
    """A process has a certificate without a host: nobody takes it for the router's."""
    robot.stop_router()
    folder = robot.keystore.folder(NAV)
    taken = {
        "listen_certificate": str(folder / "cert.pem"),
        "listen_private_key": str(folder / "key.pem"),
    }
    false = robot.open(with_tls(robot.router_config(), **taken) | {"access_control": {}})
    assert_refused(robot, robot.session_config(GUARD))
    false.close()
    robot.start_router()


@pytest.mark.parametrize("mode", ["client", "peer", "router"])
@pytest.mark.parametrize("process", [NAV, MAPPER, OPERATOR, BASE])
def test_no_process_commands_the_base_whatever_it_says_it_is(driven, process, mode):
    config = driven.robot.session_config(process)
    intruder = driven.robot.open(config | {"mode": mode, "listen": {"endpoints": []}})
    driven.robot.wait_for(intruder)
    for _ in range(20):
        intruder.put(OUTPUT, b"bad")
        intruder.put("**", b"bad")
    driven.robot.finish(intruder)
    for number in range(5):
        driven.drive(b"%d" % number)
    assert driven.heard.payloads == [b"0", b"1", b"2", b"3", b"4"]


def test_what_a_process_hears_of_others_it_cannot_use_to_be_them(driven):
    """A session's id is in all its tokens, so it is no secret."""
    stolen = str(driven.guard.zid())
    assert_refused(driven.robot, driven.robot.session_config(NAV) | {"id": stolen})
    driven.drive()
    assert driven.heard.payloads == [END]


def test_a_process_that_the_plan_no_longer_has_is_shut_out_at_the_next_start(driven):
    robot = driven.robot
    robot.write(without(robot.access, NAV))
    robot.restart_router()
    robot.wait_for(driven.nav)
    driven.commands.put(b"late")
    robot.finish(driven.nav)
    until(lambda: driven.output.matching_status.matching, "the base is back")
    driven.output.put(END)
    until(lambda: driven.heard.payloads, "the guard's message")
    assert driven.heard.payloads == [END]


def test_the_app_goes_on_when_the_router_has_restarted(driven):
    driven.drive(b"before")
    driven.robot.restart_router()
    driven.robot.wait_for(driven.guard, driven.nav, driven.base)
    driven.wait_for_route()
    driven.drive(b"after")
    assert driven.heard.payloads == [b"before", b"after"]


def test_a_certificate_counts_only_where_it_comes_in_by_a_named_interface(driven):
    robot = driven.robot
    robot.write(interfaces=("rtron0",))
    robot.restart_router()
    robot.wait_for(driven.guard, driven.base)
    driven.output.put(b"from elsewhere")
    robot.finish(driven.guard)
    robot.write(interfaces=("rtron0", "lo"))
    robot.restart_router()
    guard = robot.session(GUARD)
    output = guard.declare_publisher(OUTPUT)
    until(lambda: output.matching_status.matching, "the base's subscription")
    output.put(END)
    until(lambda: driven.heard.payloads, "the guard's message")
    assert driven.heard.payloads == [END]
