"""The configuration files of Zenoh, without a router."""

import json
from pathlib import PurePosixPath

import pytest
from plans import grcn, plan_of

from rtron.security.access.app_access import app_access
from rtron.security.zenoh.access_control import DomainKeys
from rtron.security.zenoh.configuration import TlsFiles, ZenohRouter, router_config, session_config
from rtron.vocabulary import InteractionGraph

FOLDER = PurePosixPath("/etc/rtron/keystore")
FILES = TlsFiles(authority=FOLDER / "ca.pem", certificate=FOLDER / "c.pem", key=FOLDER / "k.pem")
GRAPH = InteractionGraph(app="robot", ros=2)
PLAN = plan_of(grcn("/cmd_vel", ["/nav", "/arm_*"], ["/base"]), app="robot", ros=2)


@pytest.fixture
def router():
    return router_config(app_access(GRAPH, PLAN), ZenohRouter(), FILES, 0)


def rules_of(config, process):
    control = config["access_control"]
    (subject,) = (each for each in control["subjects"] if each["cert_common_names"] == [process])
    ids = {
        rule
        for policy in control["policies"]
        if subject["id"] in policy["subjects"]
        for rule in policy["rules"]
    }
    return [rule for rule in control["rules"] if rule["id"] in ids]


def may(config, process, flow, message):
    return {
        key
        for rule in rules_of(config, process)
        if flow in rule["flows"] and message in rule["messages"]
        for key in rule["key_exprs"]
    }


def test_everything_that_no_rule_allows_is_denied(router):
    control = router["access_control"]
    assert (control["enabled"], control["default_permission"]) == (True, "deny")
    assert {rule["permission"] for rule in control["rules"]} == {"allow"}
    assert not any("delete" in rule["messages"] for rule in control["rules"])
    assert all(len(subject["cert_common_names"]) == 1 for subject in control["subjects"])
    used = [rule for policy in control["policies"] for rule in policy["rules"]]
    assert sorted(used) == sorted(rule["id"] for rule in control["rules"])


def test_the_guard_alone_may_put_what_the_base_reads(router):
    output = "0/rtron/cmd_vel/out/$*::$*/**"
    assert output in may(router, "/base", "egress", "put")
    assert output in may(router, "/base", "ingress", "declare_subscriber")
    assert "0/rtron/*/**/$*::$*/**" in may(router, "/rtron_guard", "ingress", "put")
    for process in ("/nav", "/base", "/arm_any"):
        own = may(router, process, "ingress", "put")
        assert not {
            key for key in own if key.startswith(("0/rtron/cmd_vel/out", "0/*", "0/rtron/*"))
        }


def test_only_the_router_listens_and_only_by_tls(router):
    session = session_config(ZenohRouter(), FILES)
    assert router["listen"] == {"endpoints": ["tls/localhost:7447"]}
    assert "listen" not in session
    assert session["mode"] == "client"
    assert session["connect"]["endpoints"] == ["tls/localhost:7447"]
    for config in (router, session):
        link = config["transport"]["link"]
        assert link["protocols"] == ["tls"]
        assert link["tls"]["enable_mtls"]
        assert link["tls"]["verify_name_on_connect"]
        assert not config["scouting"]["multicast"]["enabled"]
        assert not config["scouting"]["gossip"]["enabled"]
        assert not config["transport"]["shared_memory"]["enabled"]
        assert not config["adminspace"]["enabled"]
        assert json.loads(json.dumps(config)) == config


@pytest.mark.parametrize(
    ("host", "endpoint"), [("robot.local", "tls/robot.local:7447"), ("::1", "tls/[::1]:7447")]
)
def test_an_address_is_written_as_zenoh_reads_it(host, endpoint):
    assert ZenohRouter(host=host).endpoint == endpoint


def test_the_same_app_gives_the_same_file(router):
    again = router_config(app_access(GRAPH, PLAN), ZenohRouter(), FILES, 0)
    assert json.dumps(again) == json.dumps(router)


@pytest.mark.parametrize(
    ("process", "nodes"),
    [
        ("/rtron_guard", ["/rtron_guard", "/rtron_bulk", "/rtron_supervisor", "/rtron/*"]),
        ("/rtron_verify", ["/rtron_verify", "/_rtron_scan_*"]),
        ("/rtron_operator", ["/_ros2cli_*", "/rosbag2_recorder"]),
        ("/nav", ["/nav"]),
        ("/arm_any", ["/arm_*"]),
    ],
)
def test_each_process_shows_itself_under_the_names_of_its_nodes(process, nodes):
    access = app_access(GRAPH, PLAN, operator=True)
    config = router_config(access, ZenohRouter(), FILES, 0)
    tokens = may(config, process, "ingress", "liveliness_token")
    shown = {key for key in tokens if "/NN/" in key}
    assert shown == {DomainKeys(0).node_token(node) for node in nodes}
