#include "engine/app/child_program.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

constexpr int lower_priority = 10;
constexpr std::chrono::seconds patience{5};  // between being told to end and being killed
constexpr std::chrono::milliseconds pause{10};
constexpr int not_started = 127;

// A file descriptor that closes with its owner, and when another program is executed.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }
  void close() {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }

 private:
  int number_;
};

// In the child: becomes the program, or tells its parent why not. Calls only what may be called after a fork.
[[noreturn]] void become(char* const* words, pid_t parent, int input, int output, int trouble) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(not_started);
  setpriority(PRIO_PROCESS, 0, lower_priority);
  dup2(input, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  execvp(words[0], words);
  const int why = errno;
  [[maybe_unused]] const auto written = write(trouble, &why, sizeof why);
  _exit(not_started);
}

}  // namespace

ChildProgram::ChildProgram(const std::vector<std::string>& command, const std::filesystem::path& said) {
  std::vector<std::string> words = command;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::array<int, 2> ends{-1, -1};
  const bool piped = pipe2(ends.data(), O_CLOEXEC) == 0;
  Descriptor trouble(ends[0]), tells(ends[1]);
  const Descriptor input(open("/dev/null", O_RDONLY | O_CLOEXEC));
  const Descriptor output(open(said.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  const pid_t parent = getpid();
  const bool open_all = piped && input.number() >= 0 && output.number() >= 0;
  pid_ = open_all ? fork() : -1;
  if (pid_ == 0) become(arguments.data(), parent, input.number(), output.number(), tells.number());
  int why = pid_ < 0 ? errno : 0;
  tells.close();
  if (pid_ > 0 && read(trouble.number(), &why, sizeof why) > 0) waitpid(pid_, nullptr, 0);
  if (why != 0) throw InputError(command.front() + ": cannot be started (" + std::strerror(why) + ")");
}

ChildProgram::~ChildProgram() {
  end();
  while (!status()) std::this_thread::sleep_for(pause);
}

std::optional<int> ChildProgram::status() {
  if (status_) return status_;
  if (told_ && Clock::now() - *told_ > patience) kill(pid_, SIGKILL);
  int found = 0;
  const pid_t ended = waitpid(pid_, &found, WNOHANG);
  if (ended == 0) return std::nullopt;
  status_ = ended < 0 ? not_started : WIFSIGNALED(found) ? -WTERMSIG(found) : WEXITSTATUS(found);
  return status_;
}

void ChildProgram::end() {
  if (status_ || told_) return;
  kill(pid_, SIGTERM);
  told_ = Clock::now();
}

}  // namespace quadgraph
