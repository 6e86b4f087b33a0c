from rtron.functions.reading.read import read_repositories
from rtron.functions.reading.skipped import Note, Skipped

__all__ = ["Note", "Skipped", "read_repositories"]
