"""What the rule says of a frame that no transform has, and when it is silent."""

from dataclasses import replace

from finding_graphs import FIRMWARE, found, small_graph, the_finding
from finding_pairs import SCAN, with_fact

from rtron.vocabulary import Certainty, FindingLevel, Severity

STRAY = with_fact("stray_frame", "pico_1", "pico", "/laser")


def test_it_names_the_frame_and_a_near_one():
    finding = the_finding("stray_frame", STRAY)
    assert finding.summary == (
        "/laser sends messages in the frame pico_1, which is in no transform"
    )
    assert finding.remedy == "did you mean pico? Give the messages and the transform one name"
    assert (finding.certainty, finding.severity) == (Certainty.LIKELY, Severity.MEDIUM)
    assert finding.level is FindingLevel.REGULAR


def test_a_node_that_was_not_read_may_send_the_transform():
    unread = small_graph(SCAN + FIRMWARE, unread=("/firmware",))
    assert not found("stray_frame", replace(unread, wiring=STRAY.wiring))
