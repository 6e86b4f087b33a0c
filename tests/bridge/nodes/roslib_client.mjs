// A client of the bridge with roslibjs: `LIBRARY ADDRESS TOKEN`; a line of JSON for what it hears.
// It reads /chat plainly, as a picture and in fragments, publishes, calls, and does what it may not.

const [library, address, token] = process.argv.slice(2);
const { Ros, Topic, Service } = await import(library);
const say = (what, value) => console.log(JSON.stringify([what, value]));

const ros = new Ros();
ros.on("error", (error) => say("error", String(error.message ?? error)));
ros.on("close", () => say("close", null));
ros.on("connection", () => say("connection", null));
const emit = ros.emit.bind(ros); // a status message of an operation has its id in the event's name
ros.emit = (event, ...values) => {
  if (String(event).startsWith("status")) say("status", values[0].msg);
  return emit(event, ...values);
};
if (token) ros.authenticate(token);

const options = { png: { compression: "png" }, cbor: { compression: "cbor" } };
const [, kind] = new URL(address).hash.split("#");
const topic = new Topic({ ros, name: "/chat", messageType: "std_msgs/String", ...options[kind] });
topic.subscribe((message) => say("heard", message));
topic.publish({ data: "from a page" });
new Topic({ ros, name: "/scan", messageType: "sensor_msgs/LaserScan" }).subscribe(() => say("leak"));
const lamp = new Service({ ros, name: "/lamp", serviceType: "std_srvs/SetBool" });
lamp.callService({ data: true }, (answer) => say("answer", answer), (why) => say("refused", why));
const shutdown = new Service({ ros, name: "/shutdown", serviceType: "std_srvs/Empty" });
shutdown.callService({}, () => say("leak"), (why) => say("refused", why));
ros.getTopics((found) => say("topics", found.topics), (why) => say("refused", why));
ros.connect(address.split("#")[0]);
