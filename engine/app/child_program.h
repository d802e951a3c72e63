// A program that runs beside this one, at a lower priority, and ends with it.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace quadgraph {

class ChildProgram {
 public:
  // Starts the first word of a command, which is looked for on the PATH. What it says goes into the file `said`. Throws
  // InputError that says why it cannot be started.
  ChildProgram(const std::vector<std::string>& command, const std::filesystem::path& said);

  // Ends it, and waits for that.
  ~ChildProgram();
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;

  // Its exit status once it has ended, negative the signal that ended it.
  std::optional<int> status();

  // Tells it to end (TERM), so that it cleans up; where it does not, it is killed some seconds later, by `status`.
  void end();

 private:
  using Clock = std::chrono::steady_clock;

  pid_t pid_ = 0;
  std::optional<int> status_;
  std::optional<Clock::time_point> told_;  // to end
};

}  // namespace quadgraph
