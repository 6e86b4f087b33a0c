"""The calls of the client libraries that make an endpoint, by their plain names."""

import re

ENDPOINT_METHODS = frozenset(
    [
        *("advertise", "advertiseCamera", "advertiseService", "subscribe", "subscribeCamera"),
        *("serviceClient", "waitForMessage", "create_publisher", "create_subscription"),
        *("create_service", "create_client", "create_server", "create_generic_publisher"),
        *("create_generic_subscription", "create_generic_client", "create_generic_service"),
        *("create_camera_publisher", "create_camera_subscription"),
        *("rclc_publisher_init_default", "rclc_publisher_init_best_effort"),
        *("rclc_subscription_init_default", "rclc_subscription_init_best_effort"),
        *("rclc_service_init_default", "rclc_client_init_default"),
    ]
)
"""Those that are methods or functions."""
ENDPOINT_CALLS = ENDPOINT_METHODS | {
    *("Publisher", "Subscriber", "SimpleActionClient", "SimpleActionServer")
}
ENDPOINT_CALL = re.compile(rf"\b(?:{'|'.join(sorted(ENDPOINT_METHODS))})\b(?=\s*[<(])")
"""One of the methods where C++ calls it."""
