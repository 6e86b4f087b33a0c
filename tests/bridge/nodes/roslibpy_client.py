"""A client of the bridge with roslibpy: `PORT TOKEN WHAT…`; it says what it hears.

WHAT: `drive SPEED`, `chat TEXT`, `listen TOPIC TYPE`, `publish TOPIC TYPE JSON`,
`call SERVICE JSON`, `get_param NAME`, `set_param NAME JSON`, `topics`,
`goal ACTION ORDER`, `cancelled_goal ACTION ORDER`. It waits to be ended.
"""

import json
import sys
import threading

import roslibpy

TIMEOUT_S = 30


def say(*words):
    """Say it in one piece: two threads do, and `print` writes each word by itself."""
    sys.stdout.write(" ".join(map(str, words)) + "\n")
    sys.stdout.flush()


def connect(port, token):
    ros = roslibpy.Ros("127.0.0.1", int(port), headers={"Authorization": f"Bearer {token}"})
    ros.factory.on_ready(hear_status)
    ros.run(TIMEOUT_S)
    say("connected")
    return ros


def hear_status(protocol):
    protocol._message_handlers["status"] = lambda told: say("status:", told["level"], told["msg"])


def drive(ros, speed):
    topic = roslibpy.Topic(ros, "/cmd_vel", "geometry_msgs/Twist")
    vector = {"x": float(speed), "y": 0.0, "z": 0.0}
    rest = threading.Event()
    while not rest.wait(0.1):
        topic.publish({"linear": vector, "angular": {"x": 0.0, "y": 0.0, "z": 0.0}})


def chat(ros, text):
    topic = roslibpy.Topic(ros, "/chat", "std_msgs/String")
    rest = threading.Event()
    while not rest.wait(0.2):
        topic.publish({"data": text})


def listen(ros, topic, type):
    roslibpy.Topic(ros, topic, type).subscribe(lambda told: say("heard:", json.dumps(told)))


def publish(ros, topic, type, message):
    roslibpy.Topic(ros, topic, type).publish(json.loads(message))


def call(ros, service, args):
    request = roslibpy.ServiceRequest(json.loads(args))
    try:
        answer = roslibpy.Service(ros, service, "").call(request, timeout=TIMEOUT_S)
    except roslibpy.core.ServiceException as error:
        say("refused:", error)
    else:
        say("answer:", json.dumps(dict(answer)))


def get_param(ros, name):
    try:
        say("value:", json.dumps(ros.get_param(name)))
    except roslibpy.core.ServiceException as error:
        say("refused:", error)


def set_param(ros, name, value):
    try:
        ros.set_param(name, json.loads(value))
        say("set")
    except roslibpy.core.ServiceException as error:
        say("refused:", error)


def topics(ros):
    say("topics:", json.dumps(ros.get_topics()))


def goal(ros, action, order):
    """Send a goal of test_msgs/Fibonacci; return its client and its id."""
    client = roslibpy.ActionClient(ros, action, "test_msgs/action/Fibonacci")

    def shown(told):
        return json.dumps({"status": told["status"].value, "values": told["values"]})

    sent = client.send_goal(
        roslibpy.Goal({"order": int(order)}),
        lambda told: say("result:", shown(told)),
        lambda told: say("feedback:", json.dumps(dict(told))),
        lambda told: say("refused:", shown(told)),
    )
    return client, sent


def cancelled_goal(ros, action, order):
    client, sent = goal(ros, action, order)
    while not client.wait_results[sent].wait(0.1):
        client.cancel_goal(sent)


def main():
    port, token, what, *rest = sys.argv[1:]
    ros = connect(port, token)
    globals()[what](ros, *rest)
    threading.Event().wait()


if __name__ == "__main__":
    main()
