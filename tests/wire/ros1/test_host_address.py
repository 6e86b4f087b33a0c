"""Under which name a node of ours is known."""

import pytest

from rtron.wire.ros1 import network


def test_the_master_is_the_one_of_the_environment_or_the_default():
    assert network.master_uri({"ROS_MASTER_URI": "http://robot:1"}) == "http://robot:1"
    assert network.master_uri({"ROS_MASTER_URI": ""}) == network.DEFAULT_MASTER
    assert network.master_uri({}) == "http://localhost:11311"


def test_the_hostname_goes_before_the_ip():
    assert network.advertised_host({"ROS_HOSTNAME": "robot", "ROS_IP": "10.0.0.1"}) == "robot"
    assert network.advertised_host({"ROS_HOSTNAME": "", "ROS_IP": "10.0.0.1"}) == "10.0.0.1"


def test_without_either_it_is_this_machine_if_others_can_find_it(monkeypatch):
    monkeypatch.setattr(network.socket, "gethostname", lambda: "localhost")
    assert network.advertised_host({}) == "localhost"


@pytest.mark.parametrize("name", ["nobody.invalid", "a" * 64, "a..b"])
def test_a_machine_whose_name_cannot_be_resolved_is_known_by_loopback(monkeypatch, name):
    monkeypatch.setattr(network.socket, "gethostname", lambda: name)
    assert network.advertised_host({}) == "127.0.0.1"


@pytest.mark.parametrize(
    ("host", "bound"),
    [
        ("localhost", "127.0.0.1"),
        ("127.0.0.1", "127.0.0.1"),
        ("127.1.2.3", "127.0.0.1"),
        ("robot", ""),
        ("10.0.0.1", ""),
    ],
)
def test_loopback_is_bound_only_to_loopback(host, bound):
    assert network.bind_address(host) == bound
