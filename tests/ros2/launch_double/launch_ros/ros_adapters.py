class ROSAdapter:
    """Would join the ROS domain."""

    def __init__(self, **_):
        raise AssertionError("a ROS node was asked for")


def get_ros_node(context):
    return ROSAdapter().ros_node
