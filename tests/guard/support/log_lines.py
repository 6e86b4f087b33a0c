"""The lines of the log of a guard's processes."""

import re

_TIME = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z [A-Z]+ ")


def assert_each_has_a_time(log, *texts):
    """Assert that every line begins with its time and level, and that some continue so."""
    lines = [(_TIME.match(line), line) for line in log.splitlines()]
    assert [line for time, line in lines if not time] == []
    said = [line[time.end() :] for time, line in lines]
    for text in texts:
        assert any(each.startswith(text) for each in said), text
