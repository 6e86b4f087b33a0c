"""The key expressions of ROS names, against Zenoh itself and the layout of rmw_zenoh."""

import pytest
from rmw_zenoh_keys import CACHE, data_key, endpoint_token, node_token

from rtron.errors import InputError
from rtron.security.zenoh.access_control import DomainKeys

zenoh = pytest.importorskip("zenoh", reason="needs eclipse-zenoh (extra `dev`)")

KEYS = DomainKeys(7)
OUTPUT = "/rtron/cmd_vel/out"


def includes(rule, key):
    return zenoh.KeyExpr(rule).includes(zenoh.KeyExpr(key))


def test_data_has_a_key_of_domain_name_type_and_hash():
    for name in ("/cmd_vel", OUTPUT, "/nav/_action/send_goal"):
        assert includes(KEYS.data(name), data_key(7, name))
        assert includes(KEYS.data(name), data_key(7, name, hash="TypeHashNotSupported"))


def test_a_subscriber_of_its_own_key_is_below_the_topics():
    assert includes(KEYS.data("/image"), data_key(7, "/image") + "/2f1b6c/00ff12")


@pytest.mark.parametrize(
    ("name", "key"),
    [
        ("/cmd_vel", data_key(7, "/cmd_vel/out")),
        ("/cmd_vel", data_key(7, "/cmd_vel_raw")),
        ("/cmd_vel", data_key(7, "/rtron/cmd_vel")),
        ("/cmd_vel", data_key(8, "/cmd_vel")),
        ("/cmd", data_key(7, "/cmd/a/b")),
        ("/rtron/cmd_vel/nav", "7/rtron/cmd_vel/**"),
        ("/rtron/cmd_vel/nav", "7/**"),
        ("/rtron/cmd_vel/nav", "7/rtron/cmd_vel/*/*/*"),
        ("/cmd_vel", data_key(7, "/cmd_vel") + "/@adv/pub/a1/2/_"),
    ],
)
def test_no_name_reaches_anothers_keys(name, key):
    assert not includes(KEYS.data(name), key)


def test_what_is_stored_is_the_publishers_and_asked_for_by_subscribers():
    key = data_key(7, OUTPUT)
    assert includes(KEYS.stored(OUTPUT), f"{key}/{CACHE}")
    for asked in ("@adv/**", "@adv/*/a1/2/**", "@adv/pub/**", CACHE):
        assert includes(KEYS.recovery(OUTPUT), f"{key}/{asked}")
    assert not includes(KEYS.stored(OUTPUT), f"{key}/@adv/sub/a1/2/_")
    assert not includes(KEYS.recovery(OUTPUT), key)


@pytest.mark.parametrize(
    ("pattern", "names", "others"),
    [
        ("/rtron/*", ["/rtron/a", OUTPUT], ["/rtronic/a", "/a/rtron/b"]),
        ("/rtron/self_*", ["/rtron/self_12ab"], [OUTPUT, "/rtron/self_1/a"]),
        ("/*/get_parameters", ["/nav/get_parameters", "/a/b/get_parameters"], ["/nav/set"]),
        ("/arm_*/get_parameters", ["/arm_2/get_parameters"], ["/arm_2/b/get_parameters"]),
        ("/*", ["/cmd_vel", OUTPUT], []),
    ],
)
def test_patterns_of_our_own(pattern, names, others):
    assert all(includes(KEYS.data(pattern), data_key(7, name)) for name in names)
    assert not any(includes(KEYS.data(pattern), data_key(7, name)) for name in others)


def test_a_node_has_tokens_of_its_name_alone():
    assert includes(KEYS.node_token("/nav"), node_token(7, "/nav"))
    assert includes(KEYS.node_token("/a/b/nav"), node_token(7, "/a/b/nav", enclave="/x/y"))
    assert includes(KEYS.node_token("/rtron/*"), node_token(7, "/rtron/grcn_cmd_vel"))
    assert includes(KEYS.node_token("/arm_*"), node_token(7, "/arm_2"))
    for other in ("/base", "/a/nav", "/nav2"):
        assert not includes(KEYS.node_token("/nav"), node_token(7, other))
    assert not includes(KEYS.node_token("/nav"), node_token(7, "/nav").replace("/0/", "/**/", 1))


def test_an_entity_has_a_token_of_its_node_kind_and_name():
    rule = KEYS.entity_token("MP", "/nav", "/cmd_vel")
    assert includes(rule, endpoint_token(7, "MP", "/nav", "/cmd_vel"))
    assert includes(rule, endpoint_token(7, "MP", "/nav", "/cmd_vel") + "/backends")
    assert not includes(rule, endpoint_token(7, "MS", "/nav", "/cmd_vel"))
    assert not includes(rule, endpoint_token(7, "MP", "/base", "/cmd_vel"))
    assert not includes(rule, endpoint_token(7, "MP", "/nav", OUTPUT))
    assert includes(
        KEYS.entity_token("MP", "/nav", "/rtron/*"), endpoint_token(7, "MP", "/nav", OUTPUT)
    )


def test_every_expression_is_canonical():
    keys = DomainKeys(0)
    for name in ("/a", "/*", "/a/*", "/a_*", "/*/b"):
        for expression in (
            keys.data(name),
            keys.stored(name),
            keys.recovery(name),
            keys.entity_token("SS", "/a_*", name),
            keys.node_token("/a/*"),
            keys.graph(),
        ):
            assert str(zenoh.KeyExpr.autocanonize(expression)) == expression


@pytest.mark.parametrize(
    "name",
    [
        "",
        "/",
        "cmd_vel",
        "/cmd_vel/",
        "//cmd_vel",
        "/**",
        "/a/**/b",
        "/$*",
        "/a$*b",
        "/a?x=1",
        "/a#b",
        "/@ros2_lv/0/x",
        "/a/@adv/pub",
        "/a/~",
        "/a%b",
        "/a b",
        "/a\n/b",
        "/a\x00",
        "/ünï",
        "/1a",
        "/a::b",
        "/{robot}/cmd_vel",
        "/a*b*c",
    ],
)
def test_names_of_strangers_are_refused(name):
    for use in (KEYS.data, KEYS.stored, KEYS.recovery, KEYS.node_token):
        with pytest.raises(InputError, match="no full name of ROS 2"):
            use(name)
    with pytest.raises(InputError, match="no full name of ROS 2"):
        KEYS.entity_token("MP", "/nav", name)


@pytest.mark.parametrize("domain", [-1, 233])
def test_a_domain_that_ros_does_not_have_is_refused(domain):
    with pytest.raises(InputError, match="no ROS domain"):
        DomainKeys(domain)
