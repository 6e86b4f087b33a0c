// A wheel driver: appends linear.x and angular.z of every /cmd_vel to the file of its argument.
#include <fstream>

#include <geometry_msgs/Twist.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "driver");
  if (argc != 2) return 2;
  std::ofstream file(argv[1], std::ios::app);
  boost::function<void(const geometry_msgs::Twist&)> drive = [&file](const geometry_msgs::Twist& m) {
    file << m.linear.x << ' ' << m.angular.z << std::endl;
  };
  ros::NodeHandle node;
  ros::Subscriber subscriber = node.subscribe<geometry_msgs::Twist>(
      "/cmd_vel", 1000, drive, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  ros::spin();
}
