"""What a repository's functions are found to be, and what told so."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from rtron.vocabulary import FunctionType, StringEnum


class InformationSource(StringEnum):
    """A piece of key information (paper A.1), in the order in which they are asked."""

    NAME = "name"
    MANIFEST = "manifest"
    CODE = "code"
    README = "readme"


class DecisionSource(StringEnum):
    """The piece that decided, or none: no rule told enough."""

    NAME = "name"
    MANIFEST = "manifest"
    CODE = "code"
    README = "readme"
    NONE = "none"


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleEvidence:
    """A rule that matched: in which piece, on which words, for which type.

    `package` is the package whose name or description it is, "" where it is the repository's own.
    """

    source: InformationSource
    text: str
    rule: str
    type: FunctionType
    package: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Classification:
    """A repository's functions, the first one first: where nothing decided, the likeliest one.

    `probabilities`, 0 to 1 and calibrated on labels by hand, tell how sure each function is; those
    of further candidates, too unlikely to be among `functions`, follow.
    `packages` are the functions of each package whose own name or description tells.
    """

    repo: str
    functions: tuple[FunctionType, ...] = ()
    primary: FunctionType | None = None
    probabilities: Mapping[FunctionType, float] = field(default_factory=dict)
    decided_by: DecisionSource = DecisionSource.NONE
    evidence: tuple[RuleEvidence, ...] = ()
    packages: Mapping[str, tuple[FunctionType, ...]] = field(default_factory=dict)

    @property
    def confidence(self) -> float | None:
        """How sure the first function is, None without one."""
        return None if self.primary is None else self.probabilities.get(self.primary)
