import pytest
from service_app import SECOND

from rtron.service.domain import login_throttle as module
from rtron.service.domain.client_address import network_prefix
from rtron.service.domain.login_throttle import ADDRESS_BACKOFF, NAME_BACKOFF, LoginThrottle

MINUTE = 60 * SECOND


def fail(throttle, name, address, now, times):
    """Try until it has failed so many times, waiting as told; return the time."""
    for _ in range(times):
        while wait := throttle.begin_attempt(name, address, now):
            now += wait
    return now


def test_the_wait_of_an_address_doubles_up_to_a_bound():
    throttle = LoginThrottle()
    assert fail(throttle, "mary", "10.0.0.1", 0, ADDRESS_BACKOFF.free_failures) == 0
    waits = []
    now = 0
    for _ in range(14):
        waits.append(throttle.begin_attempt("other", "10.0.0.1", now) // SECOND)
        now += waits[-1] * SECOND
        assert throttle.begin_attempt("other", "10.0.0.1", now) == 0
    assert waits == [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 900, 900, 900, 900]


def test_it_is_free_once_the_wait_is_over_and_not_before():
    throttle = LoginThrottle()
    fail(throttle, "mary", "10.0.0.1", 0, ADDRESS_BACKOFF.free_failures)
    assert throttle.begin_attempt("mary", "10.0.0.1", SECOND - 1) == 1
    assert throttle.begin_attempt("mary", "10.0.0.1", SECOND) == 0


def test_another_address_waits_for_nothing():
    throttle = LoginThrottle()
    now = 0
    for host in range(200):
        now = fail(throttle, "mary", f"10.0.0.{host}", now, ADDRESS_BACKOFF.free_failures)
    assert throttle.begin_attempt("mary", "192.168.7.7", now) == 0


def test_a_name_that_fails_everywhere_makes_those_wait_who_have_failed():
    throttle = LoginThrottle()
    for host in range(NAME_BACKOFF.free_failures):
        assert throttle.begin_attempt("mary", f"10.0.0.{host}", 0) == 0
    assert throttle.begin_attempt("mary", "10.0.0.3", 0) == SECOND
    assert throttle.begin_attempt("john", "10.0.0.3", 0) == 0


def test_who_mistyped_once_while_the_name_is_attacked_waits_a_minute_at_most():
    throttle = LoginThrottle()
    now = 0
    for host in range(100):
        throttle.begin_attempt("mary", f"10.0.1.{host}", now)
    throttle.begin_attempt("mary", "192.168.7.7", now)
    for second in range(61):
        for host in range(20):
            throttle.begin_attempt("mary", f"10.1.{second}.{host}", now + second * SECOND)
    assert throttle.begin_attempt("mary", "192.168.7.7", now + 61 * SECOND) == 0


def test_a_success_takes_back_its_own_attempt_only():
    throttle = LoginThrottle()
    fail(throttle, "mary", "10.0.0.1", 0, ADDRESS_BACKOFF.free_failures)
    assert throttle.begin_attempt("own", "10.0.0.1", SECOND) == 0
    throttle.record_success("own", "10.0.0.1")
    assert throttle.begin_attempt("mary", "10.0.0.1", SECOND) == SECOND
    assert throttle.failed_count == ADDRESS_BACKOFF.free_failures


def test_an_hour_later_all_is_forgotten():
    throttle = LoginThrottle()
    now = fail(throttle, "mary", "10.0.0.1", 0, 12)
    assert throttle.begin_attempt("mary", "10.0.0.1", now + 59 * SECOND) > 0
    for _ in range(ADDRESS_BACKOFF.free_failures):
        assert throttle.begin_attempt("mary", "10.0.0.1", now + 60 * MINUTE + 1) == 0
    assert throttle.begin_attempt("mary", "10.0.0.1", now + 60 * MINUTE + 1) > 0


def test_many_at_once_are_not_one():
    throttle = LoginThrottle()
    waits = [throttle.begin_attempt("mary", "10.0.0.1", 0) for _ in range(50)]
    assert waits.count(0) == ADDRESS_BACKOFF.free_failures


def test_it_is_bounded(monkeypatch):
    monkeypatch.setattr(module, "_MAX_KEYS", 10)
    throttle = LoginThrottle()
    for host in range(100):
        throttle.begin_attempt(f"name{host}", f"10.0.0.{host}", 0)
    assert len(throttle._addresses) == len(throttle._names) == 10


@pytest.mark.parametrize(
    ("address", "same"),
    [
        ("2001:db8::1", "2001:db8::ffff:1:2:3"),
        ("::ffff:10.0.0.1", "10.0.0.1"),
        ("fe80::1%eth0", "fe80::2"),
        ("", ""),
    ],
)
def test_one_network_is_one_address(address, same):
    assert network_prefix(address) == network_prefix(same)


@pytest.mark.parametrize(
    ("address", "other"), [("2001:db8::1", "2001:db8:0:1::1"), ("10.0.0.1", "10.0.0.2")]
)
def test_two_networks_are_two(address, other):
    assert network_prefix(address) != network_prefix(other)


def test_what_others_guess_behind_the_same_address_delays_no_known_browser():
    throttle = LoginThrottle()
    throttle.add_known("mary", "10.0.0.1")
    fail(throttle, "mary", "10.0.0.1", 0, 20)
    assert throttle.begin_attempt("mary", "10.0.0.1", 0) > 0
    assert throttle.begin_attempt("mary", "10.0.0.1", 0, browser="b") == 0
    assert throttle.rank("mary", "10.0.0.1", browser="b") == 0


def test_a_known_browser_has_as_many_guesses_as_an_address():
    throttle = LoginThrottle()
    waits = [throttle.begin_attempt("mary", f"10.0.0.{n}", 0, browser="b") for n in range(50)]
    assert waits.count(0) == ADDRESS_BACKOFF.free_failures


def test_guesses_of_other_names_delay_nobody_at_a_known_address():
    throttle = LoginThrottle()
    throttle.add_known("mary", "10.0.0.1")
    fail(throttle, "john", "10.0.0.1", 0, 20)
    assert throttle.begin_attempt("john", "10.0.0.1", 0) > 0
    assert throttle.begin_attempt("mary", "10.0.0.1", 0) == 0


@pytest.mark.parametrize(
    ("guesser", "elsewhere"), [("2001:db8:1:{:x}::1", "2001:db8:2::1"), ("10.0.0.{}", "10.0.1.1")]
)
def test_who_has_a_whole_network_comes_after_the_others(guesser, elsewhere):
    """Each of its addresses is new, and so many that none is remembered."""
    throttle = LoginThrottle()
    for number in range(1, 200):
        throttle.begin_attempt("mary", guesser.format(number), 0)
    assert throttle.rank("mary", guesser.format(201)) > 100
    assert throttle.rank("mary", elsewhere) == 1


def test_what_nobody_judged_is_taken_back():
    throttle = LoginThrottle()
    fail(throttle, "mary", "10.0.0.1", 0, ADDRESS_BACKOFF.free_failures - 1)
    for _ in range(100):
        assert throttle.begin_attempt("mary", "10.0.0.1", 0) == 0
        throttle.cancel_attempt("mary", "10.0.0.1")
    assert throttle.failed_count == ADDRESS_BACKOFF.free_failures - 1
    fail(throttle, "mary", "10.0.0.1", 0, 1)
    assert throttle.begin_attempt("mary", "10.0.0.1", 0) == SECOND
