"""Bringing a database to the schema of this version (Alembic)."""

from sqlalchemy import Engine

from rtron.service.store.tables import Table


def migrate(engine: Engine) -> None:
    """Bring the schema up to date."""
    Table.metadata.create_all(engine)
