"""What a file of rules looks like, checked: whatever is wrong is told with the file's name."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from rtron.functions.classifier.result import InformationSource
from rtron.vocabulary import FunctionType  # noqa: TC001 - pydantic reads it

RuleText = Annotated[str, Field(min_length=1, max_length=2000)]
RuleTexts = Annotated[tuple[RuleText, ...], Field(max_length=200)]


class RuleSchema(BaseModel):
    """A rule as it is written."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    id: Annotated[str, Field(pattern=r"^[a-z][a-z0-9-]*$")]
    weight: Annotated[float, Field(ge=1, le=9)]
    patterns: Annotated[RuleTexts, Field(min_length=1)]
    pieces: Annotated[tuple[InformationSource, ...], Field(min_length=1)] = tuple(InformationSource)
    vetoes: RuleTexts = ()
    matches: Annotated[RuleTexts, Field(min_length=1)]
    excludes: Annotated[RuleTexts, Field(alias="not", min_length=1)]


class RuleFileSchema(BaseModel):
    """A file of rules."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    type: FunctionType
    rules: Annotated[tuple[RuleSchema, ...], Field(min_length=1)]
