"""Calls to shut one of the guard's nodes down."""

from contextlib import closing

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.node_shutdown import ShutdownRefusal

NODE = "/rtron/grcn_cmd_vel"


def test_a_refusal_is_logged_once_a_second_and_cut_short(caplog):
    with closing(EventLoop()) as loop:
        refusal = ShutdownRefusal(loop)
        for _ in range(100):
            refusal.handle(NODE, "one\nline " + "x" * 10_000)
    (record,) = caplog.records
    text = record.getMessage()
    assert text.startswith(f"{NODE} is not shut down, end rtron guard itself: one\\n")
    assert len(text) < 300
