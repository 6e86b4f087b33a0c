from rtron.functions.reading.repositories import read_repositories
from rtron.functions.reading.skipped_entries import Note, Skipped

__all__ = ["Note", "Skipped", "read_repositories"]
