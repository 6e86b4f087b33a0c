import pytest
from controller_setup import ControllerSetup, hello, plan

from rtron.service.store.database import Database


@pytest.fixture
def world(database_file):
    """A controller that has met no robot yet."""
    made = ControllerSetup(Database(database_file))
    yield made
    made.database.close()


@pytest.fixture
def met(world):
    """A controller to which the guard of `r2` has said hello."""
    world.controller.handle_hello("r2", hello(plan()))
    return world


@pytest.fixture
def controller_on_each_database(database):
    """The same on a database of each kind."""
    world = ControllerSetup(database)
    world.controller.handle_hello("r2", hello(plan()))
    return world
