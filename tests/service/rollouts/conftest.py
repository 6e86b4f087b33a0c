"""Cars that have met the service: what a database has of them is made once, and copied."""

import shutil
from pathlib import Path

import pytest
from rollout_setup import RolloutSetup

from rtron.service.store.database import Database


def _meet(place):
    """Let the cars meet the service of a database; return its place."""
    database = Database(place)
    RolloutSetup(database).meet()
    database.close()
    return place


@pytest.fixture(scope="session")
def met_file(migrated_file, tmp_path_factory):
    return _meet(Path(shutil.copy(migrated_file, tmp_path_factory.mktemp("met"))))


@pytest.fixture(scope="session")
def met_url(postgresql):
    return _meet(postgresql.new_database())


def _open(place):
    database = Database(place)
    made = RolloutSetup(database)
    yield made
    made.close()
    database.close()


@pytest.fixture
def sqlite_cars(met_file, tmp_path):
    yield from _open(Path(shutil.copy(met_file, tmp_path)))


@pytest.fixture
def postgresql_cars(postgresql, met_url):
    yield from _open(postgresql.copy_database(met_url))


@pytest.fixture(params=["sqlite", "postgresql"])
def cars(request):
    return request.getfixturevalue(f"{request.param}_cars")
