from rtron.functions.reading.repositories import read_repositories
from rtron.functions.reading.skipped_entries import SkippedEntry, SkippedHandler

__all__ = ["SkippedEntry", "SkippedHandler", "read_repositories"]
