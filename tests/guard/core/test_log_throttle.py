"""A key is logged once a second; many keys hide no other key, and do not fill the log."""

from hypothesis import given
from hypothesis import strategies as st

from rtron.guard.core.log_throttle import MAX_KEYS, PERIOD, LogThrottle


def test_a_key_is_logged_again_after_a_second():
    throttle = LogThrottle()
    allowed = [throttle.allows("eve", now) for now in (5, 5, 4 + PERIOD, 5 + PERIOD, 6 + PERIOD)]
    assert allowed == [True, False, False, True, False]


def test_one_key_hides_no_other():
    throttle = LogThrottle()
    assert all(throttle.allows(number, 0) for number in range(MAX_KEYS))
    assert not throttle.allows("one more", PERIOD - 1)
    assert throttle.allows("one more", PERIOD)


@given(st.lists(st.tuples(st.integers(0, 300), st.integers(0, PERIOD // 20)), max_size=600))
def test_the_limits_hold_in_every_second(steps):
    throttle, now, logged = LogThrottle(), 0, []
    for key, pause in steps:
        now += pause
        if throttle.allows(key, now):
            recent = [each for at, each in logged if now - at < PERIOD]
            assert key not in recent
            assert len(recent) < MAX_KEYS
            logged.append((now, key))
