from rtron.service.domain.code_throttle import CodeThrottle

SECOND = 1_000_000_000
DAY_S = 24 * 3600


def test_codes_cannot_be_guessed_from_many_addresses():
    """Whoever has the password still waits, wherever the guesses come from."""
    throttle, now = CodeThrottle(), 1_800_000_000 * SECOND
    waits = [throttle.begin_attempt("mary", "", now) for _ in range(2000)]
    assert waits.count(0) == 5
    attempts = (throttle.begin_attempt("mary", "", now + each * SECOND) for each in range(DAY_S))
    assert (
        sum(delay == 0 for delay in attempts) < 40
    )  # of a million codes, three of which are right
    now += DAY_S * SECOND
    assert throttle.begin_attempt("mary", "", now) > 0
    assert throttle.begin_attempt("mary", "10.0.0.1", now) == 0  # where she has logged in before
    assert throttle.begin_attempt("anna", "", now) == 0


def test_a_right_code_ends_the_waiting_there():
    throttle = CodeThrottle()
    for _ in range(6):
        throttle.begin_attempt("mary", "10.0.0.1", 0)
        throttle.begin_attempt("mary", "", 0)
    throttle.record_success("mary", "10.0.0.1")
    assert throttle.begin_attempt("mary", "10.0.0.1", 0) == 0
    assert throttle.begin_attempt("mary", "", 0) > 0
