"""Every row of the DDS tables at its bound."""

from dataclasses import replace

import pytest
from finding_graphs import BASE, TWIST, found, small_graph, the_finding, with_qos
from finding_pairs import BEST_EFFORT, RELIABLE, SCAN

from rtron.vocabulary import Certainty, Durability, Liveliness, QoS, Severity

LATCHED = QoS(durability=Durability.TRANSIENT_LOCAL)
MANUAL = QoS(liveliness=Liveliness.MANUAL_BY_TOPIC)
DEADLINE = "the requested deadline is shorter"
LEASE = "the requested lease duration is shorter"


class TestQosMismatch:
    @pytest.mark.parametrize(
        ("offered", "requested", "why"),
        [
            (BEST_EFFORT, RELIABLE, "best effort is offered, reliable is requested"),
            (QoS(), LATCHED, "volatile is offered, transient local is requested"),
            (QoS(deadline=101), QoS(deadline=100), DEADLINE),
            (QoS(deadline=0), QoS(deadline=100), DEADLINE),
            (QoS(), MANUAL, "automatic liveliness is offered, manual by topic is requested"),
            (QoS(lease=101), QoS(lease=100), LEASE),
            (QoS(lease=0), QoS(lease=100), LEASE),
            (QoS(lease=0), QoS(lease=1, deadline=1), f"{DEADLINE}; {LEASE}"),
        ],
    )
    def test_an_offer_below_the_request(self, offered, requested, why):
        finding = the_finding("qos_mismatch", with_qos(small_graph(SCAN), offered, requested))
        assert finding.summary == "/slam gets nothing from /laser on /scan"
        assert finding.cause == f"their QoS do not fit: {why}"
        assert (finding.certainty, finding.severity) == (Certainty.CERTAIN, Severity.MEDIUM)

    @pytest.mark.parametrize(
        ("offered", "requested"),
        [
            (RELIABLE, RELIABLE),
            (BEST_EFFORT, BEST_EFFORT),
            (RELIABLE, BEST_EFFORT),
            (LATCHED, LATCHED),
            (LATCHED, QoS()),
            (QoS(deadline=100), QoS(deadline=100)),
            (QoS(deadline=99), QoS(deadline=100)),
            (QoS(deadline=100), QoS(deadline=0)),
            (MANUAL, MANUAL),
            (MANUAL, QoS()),
            (QoS(lease=100), QoS(lease=100)),
            (QoS(lease=99), QoS(lease=100)),
            (QoS(lease=100), QoS(lease=0)),
            (QoS(depth=1, lifespan=1), QoS(depth=100)),
        ],
    )
    def test_an_offer_that_satisfies_the_request(self, offered, requested):
        assert not found("qos_mismatch", with_qos(small_graph(SCAN), offered, requested))

    @pytest.mark.parametrize("ends", [(None, RELIABLE), (BEST_EFFORT, None), (None, None)])
    def test_qos_that_is_not_known_fits(self, ends):
        assert not found("qos_mismatch", with_qos(small_graph(SCAN), *ends))

    def test_ros_1_has_none(self):
        assert not found("qos_mismatch", with_qos(small_graph(SCAN, ros=1), BEST_EFFORT, RELIABLE))

    def test_a_command_that_does_not_arrive_is_about_motion(self):
        text = BASE + f"/nav nav own\n pub /cmd_vel {TWIST}"
        for package, severity in (("driver", Severity.HIGH), ("rviz2", Severity.MEDIUM)):
            graph = small_graph(text.replace(" driver ", f" {package} "))
            finding = the_finding("qos_mismatch", with_qos(graph, BEST_EFFORT, RELIABLE))
            assert finding.severity is severity

    def test_several_requests_on_a_topic_are_one_finding(self):
        text = SCAN + "/map map own\n sub /scan sensor_msgs/msg/LaserScan\n"
        graph = with_qos(small_graph(text), BEST_EFFORT, RELIABLE)
        first, *others = graph.endpoints[::-1]
        graph = replace(graph, endpoints=(*others, replace(first, qos=LATCHED)))
        finding = the_finding("qos_mismatch", graph)
        assert finding.summary == "/map gets nothing from /laser on /scan"
        assert finding.cause.endswith("transient local is requested; the same for /slam")
        assert finding.nodes == ("/laser", "/map", "/slam")
