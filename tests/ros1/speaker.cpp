// Says one velocity (linear.x) on /cmd_vel at a rate (Hz): both are arguments.
#include <cstdlib>

#include <geometry_msgs/Twist.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "speaker");
  if (argc != 3) return 2;
  ros::NodeHandle node;
  ros::Publisher publisher = node.advertise<geometry_msgs::Twist>("/cmd_vel", 10);
  geometry_msgs::Twist message;
  message.linear.x = std::atof(argv[1]);
  for (ros::WallRate rate(std::atof(argv[2])); ros::ok(); rate.sleep()) {
    publisher.publish(message);
  }
}
