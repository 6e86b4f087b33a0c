"""roscpp and the C++ libraries of ROS around it, as far as they join nodes."""

from rtron.sources.code.interpreter.abstract_values.value_types import LibraryClass, LibraryFunction
from rtron.sources.code.library_models.roscpp.filters import FILTER_CLASSES
from rtron.sources.code.library_models.roscpp.image_transport import IMAGE_CLASSES
from rtron.sources.code.library_models.roscpp.libraries import SERVER_CLASSES
from rtron.sources.code.library_models.roscpp.node_handle import HANDLE_CLASSES
from rtron.sources.code.library_models.roscpp.options import OPTIONS_CLASSES
from rtron.sources.code.library_models.roscpp.pluginlib import PLUGIN_CLASSES
from rtron.sources.code.library_models.roscpp.registry import ROSCPP_FUNCTIONS

ROSCPP_CLASSES: dict[str, LibraryClass] = {
    **HANDLE_CLASSES,
    **OPTIONS_CLASSES,
    **IMAGE_CLASSES,
    **FILTER_CLASSES,
    **PLUGIN_CLASSES,
    **SERVER_CLASSES,
}
ROSCPP_FUNCTION_VALUES = {
    name: LibraryFunction(name, call) for name, call in ROSCPP_FUNCTIONS.items()
}
