"""Which message types a node publishes for each frame that it looks at."""

from rtron.vocabulary import normalise_type

_IMAGES = ("sensor_msgs/Image", "sensor_msgs/CompressedImage")
_PER_FRAME = (
    *_IMAGES,
    "sensor_msgs/CameraInfo",
    "sensor_msgs/PointCloud2",
    "stereo_msgs/DisparityImage",
    "theora_image_transport/Packet",
)


def is_image(message_type: str) -> bool:
    """Tell whether a message is an image, compressed or not."""
    return normalise_type(message_type) in _IMAGES


def is_sent_per_frame(message_type: str) -> bool:
    """Tell whether such a message comes for every frame, whatever is to be seen in it."""
    return normalise_type(message_type) in _PER_FRAME
