"""How many repositories each piece of information decided, and how many none did."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class ClassificationCounts:
    """Numbers of repositories by what decided their type; `none`: a person must."""

    name: int = 0
    manifest: int = 0
    readme: int = 0
    none: int = 0

    @property
    def decided(self) -> int:
        """How many a rule decided."""
        return self.name + self.manifest + self.readme

    @property
    def total(self) -> int:
        """How many there are."""
        return self.decided + self.none

    @property
    def automation(self) -> float | None:
        """The share that a rule decided, from 0 to 1; None of none at all."""
        return self.decided / self.total if self.total else None

    def __add__(self, other: ClassificationCounts) -> ClassificationCounts:
        return ClassificationCounts(
            name=self.name + other.name,
            manifest=self.manifest + other.manifest,
            readme=self.readme + other.readme,
            none=self.none + other.none,
        )
