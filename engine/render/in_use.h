// Whose turn it is with an object that serves one thread at a time.
#pragma once

#include <unistd.h>

#include <atomic>
#include <string>
#include <thread>
#include <utility>

namespace quadgraph {

class InUse {
 public:
  // `what` begins messages.
  explicit InUse(std::string what) : what_(std::move(what)) {}

  // Of the thread that took it, until it ends.
  class Turn {
   public:
    explicit Turn(InUse& of) : of_(of) {}
    ~Turn() { of_.leave(); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    InUse& of_;
  };

  // Throws InputError where another thread has its turn, or in a process that was forked after this was made: threads
  // and device stay with the parent. A thread may take several turns in each other.
  [[nodiscard]] Turn take() {
    enter();
    return Turn(*this);
  }

 private:
  void enter();
  void leave();

  std::string what_;
  std::atomic<std::thread::id> user_{};
  int depth_ = 0;  // turns of that thread
  pid_t process_ = getpid();
};

}  // namespace quadgraph
