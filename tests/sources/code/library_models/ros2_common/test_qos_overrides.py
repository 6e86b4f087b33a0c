"""Quality of service that parameters of the node override (rclcpp, rclpy: QoS overriding)."""

import pytest
from ros2_runs import UNLAUNCHED, cpp, only_declaration, python

from rtron.sources.declaration import ParameterSetting
from rtron.vocabulary import Durability, Liveliness, QoS, Reliability

BEST, TRANSIENT = Reliability.BEST_EFFORT, Durability.TRANSIENT_LOCAL
DEFAULT = "rclcpp::QosOverridingOptions::with_default_policies()"
IMPORT = """from rclpy.qos import QoSPolicyKind
from rclpy.qos_overriding_options import QoSOverridingOptions"""


def cpp_publisher(options, **given):
    body = f"""rclcpp::PublisherOptions options;
    options.qos_overriding_options = {options};
    create_publisher<std_msgs::msg::Bool>("t", 7, options);"""
    return cpp(body, **given)


def python_publisher(options, **given):
    line = f"self.create_publisher(Bool, 't', 7, qos_overriding_options={options})"
    return python(line, IMPORT, **given)


def overriding(prefix="/ns/t.publisher", **values):
    return tuple(
        ParameterSetting(node="/**", name=f"qos_overrides.{prefix}.{name}", value=value)
        for name, value in values.items()
    )


BOTH = pytest.mark.parametrize(
    ("run", "default", "listed", "named"),
    [
        (
            cpp_publisher,
            DEFAULT,
            "{rclcpp::QosPolicyKind::Durability, rclcpp::QosPolicyKind::Depth}",
            DEFAULT.replace("()", '(nullptr, "x")'),
        ),
        (
            python_publisher,
            "QoSOverridingOptions.with_default_policies()",
            "QoSOverridingOptions([QoSPolicyKind.DURABILITY, QoSPolicyKind.DEPTH])",
            "QoSOverridingOptions.with_default_policies(entity_id='x')",
        ),
    ],
)


@BOTH
def test_default_policies(run, default, listed, named):
    del listed, named
    given = overriding(reliability="best_effort", depth=77, durability="transient_local")
    assert only_declaration(run(default, settings=given)).qos == QoS(depth=77, reliability=BEST)
    assert only_declaration(run(default)).qos == QoS(depth=7)
    assert only_declaration(run(default, **UNLAUNCHED)).qos == QoS(depth=7)
    assert only_declaration(run(default, settings=overriding(history="keep_all"))).qos == QoS()


@BOTH
def test_listed_policies(run, default, listed, named):
    del default, named
    given = overriding(reliability="best_effort", depth=77, durability="transient_local")
    assert only_declaration(run(listed, settings=given)).qos == QoS(depth=77, durability=TRANSIENT)


@BOTH
def test_an_endpoint_with_an_id_has_parameters_of_its_own(run, default, listed, named):
    del default, listed
    assert only_declaration(run(named, settings=overriding(depth=77))).qos == QoS(depth=7)
    given = overriding("/ns/t.publisher_x", depth=77)
    assert only_declaration(run(named, settings=given)).qos == QoS(depth=77)


@BOTH
def test_the_parameters_are_declared(run, default, listed, named):
    del listed, named
    names = {found.name: found.value for found in run(default).parameters}
    assert names["qos_overrides./ns/t.publisher.depth"] == 7
    assert names["qos_overrides./ns/t.publisher.reliability"] == "reliable"


@BOTH
def test_the_topic_is_the_remapped_one(run, default, listed, named):
    del listed, named
    given = overriding("/far.publisher", depth=77)
    found = only_declaration(run(default, settings=given, remap_rules=(("t", "/far"),)))
    assert (found.name, found.qos) == ("/ns/t", QoS(depth=77))


@BOTH
def test_what_is_open_is_noted(run, default, listed, named):
    del listed, named
    for found in (
        run(default, settings=overriding(reliability="whatever")),
        run("who_knows()", settings=overriding(depth=3)),
    ):
        assert only_declaration(found).qos is None
        assert any("parameters override it" in note.why for note in found.unresolved)
    assert only_declaration(run("who_knows()")).qos == QoS(depth=7)


@pytest.mark.parametrize("run", [cpp, python])
def test_without_options_nothing_is_overridden(run):
    given = overriding(depth=77)
    line = {
        cpp: 'create_publisher<std_msgs::msg::Bool>("t", 7);',
        python: "self.create_publisher(Bool, 't', 7)",
    }
    assert only_declaration(run(line[run], settings=given)).qos == QoS(depth=7)


def test_subscriptions():
    body = f"""rclcpp::SubscriptionOptions options;
    options.qos_overriding_options = {DEFAULT};
    create_subscription<std_msgs::msg::Bool>("t", 7, [](auto m) {{}}, options);"""
    given = overriding("/ns/t.subscription", depth=77)
    assert only_declaration(cpp(body, settings=given)).qos == QoS(depth=77)


POLICIES = "rclcpp::QosPolicyKind::Depth, rclcpp::QosPolicyKind::History"


@pytest.mark.parametrize(
    ("options", "prefix"),
    [
        (f"rclcpp::QosOverridingOptions{{{POLICIES}}}", "/ns/t.publisher"),
        (f"rclcpp::QosOverridingOptions({{{POLICIES}}})", "/ns/t.publisher"),
        (f'rclcpp::QosOverridingOptions({{{POLICIES}}}, nullptr, "x")', "/ns/t.publisher_x"),
    ],
)
def test_spellings_of_cpp(options, prefix):
    found = only_declaration(cpp_publisher(options, settings=overriding(prefix, depth=77)))
    assert found.qos == QoS(depth=77)


def test_times_and_liveliness():
    given = overriding(deadline=5, lifespan=2**63 - 1, liveliness="manual_by_topic")
    kinds = ("Deadline", "Lifespan", "Liveliness", "LivelinessLeaseDuration")
    options = "{" + ", ".join(f"rclcpp::QosPolicyKind::{kind}" for kind in kinds) + "}"
    expected = QoS(depth=7, deadline=5, liveliness=Liveliness.MANUAL_BY_TOPIC)
    assert only_declaration(cpp_publisher(options, settings=given)).qos == expected
