// A client of /act with libactionlib: nodes/action_client.py in C++, with the same arguments.
#include <actionlib/TestAction.h>
#include <actionlib/client/action_client.h>
#include <actionlib/client/simple_action_client.h>
#include <ros/ros.h>

#include <chrono>
#include <condition_variable>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <sstream>
#include <string>
#include <thread>

namespace {

using actionlib::TestAction;
using Feedback = actionlib::TestFeedbackConstPtr;
using Result = actionlib::TestResultConstPtr;

// Writes what happens, a line each, behind the steady clock's ns, and counts the open goals.
class Log {
 public:
  explicit Log(const char* path) : file_(path, std::ios::app) {}

  template <class... Words>
  void say(const Words&... words) {
    std::lock_guard<std::mutex> lock(mutex_);
    file_ << std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
    (void)std::initializer_list<int>{((file_ << ' ' << words), 0)...};
    file_ << std::endl;
  }

  void sent(int number, int value) {
    say("sent", number, value);
    std::lock_guard<std::mutex> lock(mutex_);
    ++open_;
  }

  void done(int number, const std::string& status, const Result& result, const std::string& text) {
    say("done", number, status, result ? std::to_string(result->result) : "-", text);
    std::lock_guard<std::mutex> lock(mutex_);
    ended_.insert(number);
    --open_;
    changed_.notify_all();
  }

  void wait(int open) {
    std::unique_lock<std::mutex> lock(mutex_);
    while (open_ > open && ros::ok()) changed_.wait_for(lock, std::chrono::milliseconds(100));
  }

  std::set<int> take_ended() {
    std::lock_guard<std::mutex> lock(mutex_);
    return std::move(ended_);
  }

 private:
  std::ofstream file_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<int> ended_;
  int open_ = 0;
};

class Client {
 public:
  virtual ~Client() = default;
  virtual void wait_for_server() = 0;
  virtual void send(int number, const actionlib::TestGoal& goal) = 0;
  virtual void cancel(int number) = 0;
  virtual void cancel_all() = 0;
};

class Simple : public Client {
 public:
  explicit Simple(Log& log) : log_(log), client_("act", false) {}
  void wait_for_server() override { client_.waitForServer(); }
  void send(int number, const actionlib::TestGoal& goal) override {
    client_.sendGoal(
        goal,
        [this, number](const actionlib::SimpleClientGoalState& state, const Result& result) {
          log_.done(number, state.toString(), result, state.text_);
        },
        [this, number] { log_.say("state", number, "ACTIVE"); },
        [this, number](const Feedback& f) { log_.say("feedback", number, f->feedback); });
  }
  void cancel(int) override { client_.cancelGoal(); }
  void cancel_all() override { client_.cancelAllGoals(); }

 private:
  Log& log_;
  actionlib::SimpleActionClient<TestAction> client_;
};

class Many : public Client {
 public:
  using Handle = actionlib::ActionClient<TestAction>::GoalHandle;
  explicit Many(Log& log) : log_(log), client_("act") {}
  void wait_for_server() override { client_.waitForActionServerToStart(); }
  void send(int number, const actionlib::TestGoal& goal) override {
    for (int ended : log_.take_ended()) handles_.erase(ended);
    handles_[number] = client_.sendGoal(
        goal, [this, number](Handle handle) { moved(number, handle); },
        [this, number](Handle, const Feedback& f) { log_.say("feedback", number, f->feedback); });
  }
  void cancel(int number) override { handles_.at(number).cancel(); }
  void cancel_all() override { client_.cancelAllGoals(); }

 private:
  void moved(int number, Handle handle) {
    const auto state = handle.getCommState();
    log_.say("state", number, state.toString());
    if (state != actionlib::CommState::DONE) return;
    const auto end = handle.getTerminalState();
    log_.done(number, end.toString(), handle.getResult(), end.getText());
  }

  Log& log_;
  std::map<int, Handle> handles_;
  actionlib::ActionClient<TestAction> client_;
};

// Follows a file of commands, as `tail -f` does.
void follow(const char* path, Client& client, Log& log) {
  std::ifstream file(path);
  std::string line;
  for (int sent = 0; ros::ok();) {
    char c = 0;
    if (!file.get(c)) {
      file.clear();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      continue;
    }
    if (c != '\n') {
      line += c;
      continue;
    }
    std::istringstream words(line);
    std::string what;
    int number = 0;
    words >> what >> number;
    line.clear();
    if (what == "goal") {
      actionlib::TestGoal goal;
      goal.goal = number;
      log.sent(++sent, number);
      client.send(sent, goal);
    }
    if (what == "cancel") client.cancel(number);
    if (what == "cancel_all") client.cancel_all();
    if (what == "wait") log.wait(number);
  }
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "action_client");
  if (argc != 4) return 2;
  ros::NodeHandle node;
  Log log(argv[1]);
  std::unique_ptr<Client> client;
  if (std::string(argv[3]) == "simple") {
    client = std::make_unique<Simple>(log);
  } else {
    client = std::make_unique<Many>(log);
  }
  const auto own = ros::this_node::getName() + "-";
  const ros::Subscriber results = node.subscribe<actionlib::TestActionResult>(
      "act/result", 0, [&](const actionlib::TestActionResult::ConstPtr& m) {
        const auto& id = m->status.goal_id.id;
        if (id.rfind(own, 0) != 0) return;
        log.say("result", id, int(m->status.status), m->result.result, m->status.text);
      });
  ros::AsyncSpinner spinner(1);
  spinner.start();
  client->wait_for_server();
  log.say("connected");
  follow(argv[2], *client, log);
}
