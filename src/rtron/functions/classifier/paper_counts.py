"""What the paper counted in the 941 repositories of ROS 1 Kinetic.

Source: "Table: Categorization of repos in the ROS platform" (section 3.1), where the 941 count as
1,135, since some have several functions; "Table: The number of successful identifications in 941
repos" (appendix A.2). Rates and shares are in per cent, as they are printed there.
"""

from collections.abc import Mapping
from types import MappingProxyType

from rtron.functions.classifier.tables import ClassificationCounts
from rtron.vocabulary import FunctionType

REPOSITORIES_BY_TYPE: Mapping[FunctionType, int] = MappingProxyType(
    {
        FunctionType.PREPROCESSING: 84,
        FunctionType.LOCALIZATION: 35,
        FunctionType.MAPPING: 31,
        FunctionType.RECOGNITION: 50,
        FunctionType.PATH_PLANNING: 103,
        FunctionType.GOAL_PLANNER: 11,
        FunctionType.PATH_TRACKING: 68,
        FunctionType.TELEOPERATION: 30,
        FunctionType.SPEECH_GENERATION: 9,
        FunctionType.SWITCHER: 6,
        FunctionType.MOBILE: 38,
        FunctionType.MANIPULATOR: 37,
        FunctionType.SPEAKER: 6,
        FunctionType.SENSORS: 128,
        FunctionType.VISUALIZATION: 169,
        FunctionType.SUPPORT: 111,
        FunctionType.EXTENSION: 219,
    }
)

CLASSIFICATION_COUNTS: Mapping[FunctionType, ClassificationCounts] = MappingProxyType(
    {
        FunctionType.PREPROCESSING: ClassificationCounts(name=18, manifest=41, readme=13, none=12),
        FunctionType.LOCALIZATION: ClassificationCounts(name=17, manifest=13, readme=3, none=2),
        FunctionType.MAPPING: ClassificationCounts(name=15, manifest=11, readme=4, none=1),
        FunctionType.RECOGNITION: ClassificationCounts(name=21, manifest=23, readme=4, none=2),
        FunctionType.PATH_PLANNING: ClassificationCounts(name=44, manifest=49, readme=5, none=5),
        FunctionType.GOAL_PLANNER: ClassificationCounts(name=5, manifest=4, readme=0, none=2),
        FunctionType.PATH_TRACKING: ClassificationCounts(name=8, manifest=37, readme=11, none=12),
        FunctionType.TELEOPERATION: ClassificationCounts(name=7, manifest=21, readme=1, none=1),
        FunctionType.SPEECH_GENERATION: ClassificationCounts(name=2, manifest=1, readme=5, none=1),
        FunctionType.SWITCHER: ClassificationCounts(name=3, manifest=2, readme=1, none=0),
        FunctionType.MOBILE: ClassificationCounts(name=2, manifest=26, readme=4, none=6),
        FunctionType.MANIPULATOR: ClassificationCounts(name=2, manifest=30, readme=2, none=3),
        FunctionType.SPEAKER: ClassificationCounts(name=0, manifest=0, readme=5, none=1),
        FunctionType.SENSORS: ClassificationCounts(name=10, manifest=77, readme=16, none=25),
        FunctionType.VISUALIZATION: ClassificationCounts(name=98, manifest=60, readme=11, none=0),
        FunctionType.SUPPORT: ClassificationCounts(name=14, manifest=45, readme=25, none=27),
        FunctionType.EXTENSION: ClassificationCounts(name=23, manifest=72, readme=18, none=106),
    }
)
FUNCTION_NODE_COUNTS = ClassificationCounts(name=154, manifest=335, readme=74, none=73)
"""The first 14 types together, those that are not of Others."""

AUTOMATION_BY_TYPE: Mapping[FunctionType, float] = MappingProxyType(
    {
        FunctionType.PREPROCESSING: 85.71,
        FunctionType.LOCALIZATION: 94.29,
        FunctionType.MAPPING: 96.77,
        FunctionType.RECOGNITION: 96.00,
        FunctionType.PATH_PLANNING: 95.15,
        FunctionType.GOAL_PLANNER: 81.82,
        FunctionType.PATH_TRACKING: 82.35,
        FunctionType.TELEOPERATION: 96.67,
        FunctionType.SPEECH_GENERATION: 88.89,
        FunctionType.SWITCHER: 100.00,
        FunctionType.MOBILE: 84.21,
        FunctionType.MANIPULATOR: 91.89,
        FunctionType.SPEAKER: 83.33,
        FunctionType.SENSORS: 80.47,
        FunctionType.VISUALIZATION: 100.00,
        FunctionType.SUPPORT: 75.68,
        FunctionType.EXTENSION: 51.60,
    }
)
FUNCTION_NODE_AUTOMATION = 88.52
