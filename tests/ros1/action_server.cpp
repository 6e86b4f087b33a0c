// Serves /act with libactionlib's SimpleActionServer: nodes/action_server.py `simple` in C++.
#include <actionlib/TestAction.h>
#include <actionlib/server/simple_action_server.h>
#include <ros/ros.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::milliseconds;
using Heard = actionlib::TestActionGoal::ConstPtr;
using Goal = actionlib::TestGoalConstPtr;
constexpr int kNever = 1000000000;
constexpr std::size_t kShown = 100;
constexpr Milliseconds kTick(10);

class Server {
 public:
  explicit Server(const char* path)
      : file_(path, std::ios::app),
        server_(node_, "act", [this](const Goal& goal) { execute(goal); }, false) {
    goals_ = node_.subscribe<actionlib::TestActionGoal>(
        "act/goal", 50, [this](const Heard& goal) { keep(goal); });
    file_ << now() << " starting" << std::endl;
    server_.start();
  }

 private:
  static long long now() { return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count(); }

  void keep(const Heard& goal) {
    std::lock_guard<std::mutex> lock(mutex_);
    heard_.push_back(goal);
  }

  // SimpleActionServer hides the id; it shares the message with every subscriber of this process.
  std::string id_of(const Goal& goal) {
    std::lock_guard<std::mutex> lock(mutex_);
    for (const Heard& heard : heard_) {
      if (&heard->goal == goal.get()) return heard->goal_id.id;
    }
    return "?";
  }

  void execute(const Goal& goal) {
    const std::string id = id_of(goal);
    say("started", id, goal->goal);
    const std::string end = work(goal->goal);
    say(end, id, goal->goal);
    actionlib::TestResult result;
    result.result = goal->goal;
    if (end == "done") server_.setSucceeded(result, end);
    if (end == "aborted") server_.setAborted(result, end);
    if (end == "cancelled") server_.setPreempted(result, end);
  }

  std::string work(int value) {
    const auto end = Clock::now() + Milliseconds(std::abs(value));
    for (int step = 0; ros::ok(); ++step) {
      actionlib::TestFeedback feedback;
      feedback.feedback = step;
      server_.publishFeedback(feedback);
      std::this_thread::sleep_until(std::min(end, Clock::now() + Clock::duration(kTick)));
      if (Clock::now() >= end) break;
      if (value != kNever && server_.isPreemptRequested()) return "cancelled";
    }
    return value < 0 ? "aborted" : "done";
  }

  void say(const std::string& what, const std::string& id, int value) {
    file_ << now() << ' ' << what << ' ' << quoted(id) << ' ' << value << std::endl;
  }

  static std::string quoted(const std::string& id) {
    std::ostringstream out;
    for (const unsigned char c : id.substr(0, kShown)) {
      if (std::isgraph(c)) out << c;
      else out << '%' << std::hex << std::uppercase << std::setw(2) << std::setfill('0') << int(c);
    }
    return out.str();
  }

  std::ofstream file_;
  std::mutex mutex_;
  std::vector<Heard> heard_;
  ros::NodeHandle node_;
  ros::Subscriber goals_;
  actionlib::SimpleActionServer<actionlib::TestAction> server_;
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "action_server");
  if (argc != 2) return 2;
  Server server(argv[1]);
  ros::spin();
}
