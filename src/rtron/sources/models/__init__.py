"""Well-known nodes and plugins whose source is often absent, as models in YAML."""

from rtron.sources.models.common.evaluation import node_interface, plugin_interface
from rtron.sources.models.common.plugin_element import PluginElement
from rtron.sources.models.common.schema import Model
from rtron.sources.models.common.yaml_model import ROS2_LIBRARY, ModelCatalog, load_models
from rtron.sources.models.ros1.controllers import controller_interface

__all__ = [
    "ROS2_LIBRARY",
    "Model",
    "ModelCatalog",
    "PluginElement",
    "controller_interface",
    "load_models",
    "node_interface",
    "plugin_interface",
]
