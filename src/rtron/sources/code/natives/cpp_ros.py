"""roscpp and the C++ libraries of ROS around it, as far as they join nodes."""

from rtron.sources.code.interpreter.values import Native, NativeClass
from rtron.sources.code.natives.cpp_filters import FILTER_CLASSES
from rtron.sources.code.natives.cpp_images import IMAGE_CLASSES
from rtron.sources.code.natives.cpp_options import OPTIONS_CLASSES
from rtron.sources.code.natives.cpp_plugins import PLUGIN_CLASSES
from rtron.sources.code.natives.cpp_ros_functions import FUNCTIONS
from rtron.sources.code.natives.cpp_servers import SERVER_CLASSES
from rtron.sources.code.natives.node_handle import HANDLE_CLASSES

CPP_ROS_CLASSES: dict[str, NativeClass] = {
    **HANDLE_CLASSES,
    **OPTIONS_CLASSES,
    **IMAGE_CLASSES,
    **FILTER_CLASSES,
    **PLUGIN_CLASSES,
    **SERVER_CLASSES,
}
CPP_ROS_FUNCTIONS = {name: Native(name, call) for name, call in FUNCTIONS.items()}
