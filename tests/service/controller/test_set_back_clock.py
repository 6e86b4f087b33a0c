"""A clock that is set back keeps no override alive, in the service and after its restart."""

from contextlib import closing, contextmanager

import pytest
from controller_setup import DEVELOPER, ControllerSetup, FixedClock, hello, plan

from rtron.service.controller.node_parameters import get_node_parameters
from rtron.service.domain.schemas import OverrideRequest, SettingsChange
from rtron.service.store.database import Database
from rtron.vocabulary import SECOND

HOUR = 3600 * SECOND
BEGIN = 100 * HOUR


class SetClocks(ControllerSetup):
    """A service whose wall clock is set, and whose other clock is not."""

    def pass_time(self, seconds):
        self.clock.now += seconds * SECOND
        self.monotonic.now += seconds * SECOND


@pytest.fixture
def met(tmp_path):
    clock, monotonic = FixedClock(), FixedClock()
    clock.now, monotonic.now = BEGIN, 5 * SECOND
    world = SetClocks(Database(tmp_path / "rtron.db"), clock=clock, monotonic=monotonic)
    world.controller.handle_hello("r2", hello(plan()))
    yield world
    world.database.close()


def override(world, seconds=20):
    request = OverrideRequest(duration=seconds, reason="docking")
    return world.controller.start_override(DEVELOPER, "r2", "speed", request)


def given_to_a_guard(world):
    """Return the overrides that a guard gets which says hello now."""
    return world.controller.handle_hello("r2", hello(plan())).overrides.keys()


def test_an_override_ends_in_time_although_the_clock_was_set_back(met):
    override(met)
    met.clock.now -= 2 * HOUR
    met.pass_time(19)
    assert given_to_a_guard(met) == {"speed"}
    met.pass_time(1)
    assert given_to_a_guard(met) == set()


def test_an_override_of_a_clock_that_was_set_back_lasts_as_long_as_was_said(met):
    met.clock.now -= 2 * HOUR
    override(met)
    met.pass_time(19)
    assert given_to_a_guard(met) == {"speed"}
    met.pass_time(1)
    assert given_to_a_guard(met) == set()


def test_the_console_shows_no_override_that_is_over(met):
    override(met)
    met.clock.now -= 2 * HOUR
    met.pass_time(20)
    now = met.controller._steady_clock()
    with met.database.session() as session:
        node = get_node_parameters(session, "r2", "speed", DEVELOPER.roles, now)
    assert node.override is None


@contextmanager
def restarted(world):
    """Give the service after a restart, whose other clock begins anew."""
    url = world.database.url.render_as_string(hide_password=False)
    with closing(Database(url)) as database:
        yield SetClocks(database, clock=world.clock, monotonic=FixedClock())


def test_after_a_restart_with_a_clock_that_was_set_back_overrides_are_over(met):
    override(met)
    met.clock.now -= 2 * HOUR
    with restarted(met) as again:
        assert given_to_a_guard(again) == set()


def test_so_are_those_that_a_later_change_has_kept(met):
    override(met)
    met.clock.now -= 2 * HOUR
    met.pass_time(5)
    nodes = {"drive": {"flows": {"flow1": {"block": True}}}}
    change = SettingsChange(revision=1, nodes=nodes, reason="broken")
    assert met.controller.change(DEVELOPER, "r2", change).settings.overrides.keys() == {"speed"}
    met.pass_time(1)
    with restarted(met) as again:
        assert given_to_a_guard(again) == set()


def test_after_a_restart_without_that_they_go_on(met):
    override(met)
    met.pass_time(5)
    with restarted(met) as again:
        assert given_to_a_guard(again) == {"speed"}
        again.pass_time(15)
        assert given_to_a_guard(again) == set()
