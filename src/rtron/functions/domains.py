"""Which domain a function type belongs to (the paper's table of repos)."""

from collections.abc import Mapping
from types import MappingProxyType

from rtron.vocabulary import Domain, FunctionType

_TYPES_BY_DOMAIN: Mapping[Domain, tuple[FunctionType, ...]] = {
    Domain.PERCEPTION: (
        FunctionType.PREPROCESSING,
        FunctionType.LOCALIZATION,
        FunctionType.MAPPING,
        FunctionType.RECOGNITION,
    ),
    Domain.PLANNING: (FunctionType.PATH_PLANNING, FunctionType.GOAL_PLANNER),
    Domain.CONTROL: (
        FunctionType.PATH_TRACKING,
        FunctionType.TELEOPERATION,
        FunctionType.SPEECH_GENERATION,
        FunctionType.SWITCHER,
    ),
    Domain.DRIVERS: (
        FunctionType.MOBILE,
        FunctionType.MANIPULATOR,
        FunctionType.SPEAKER,
        FunctionType.SENSORS,
    ),
    Domain.OTHERS: (FunctionType.VISUALIZATION, FunctionType.SUPPORT, FunctionType.EXTENSION),
}

DOMAIN_BY_TYPE: Mapping[FunctionType, Domain] = MappingProxyType(
    {type: domain for domain, types in _TYPES_BY_DOMAIN.items() for type in types}
)
