// Threads that share out the parts of a piece of work.
#pragma once

#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

namespace quadgraph::cpu {

class ThreadPool {
 public:
  // With the caller `threads` work; 0: one for each core that this process may use.
  explicit ThreadPool(unsigned threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  unsigned threads() const { return static_cast<unsigned>(others_.size()) + 1; }

  // Calls work(begin, end) for parts of [0, count), of at most `part` and each once, on all threads; waits for them. A
  // thread works on the same stretch in every call with the same numbers, which its cache holds then, and after it on
  // what others have left of theirs. Behind its last part each thread calls `last`, where there is one.
  // One call at a time, and not from within `work`. What throws ends the program. Denormals are zero in `work`.
  void run(std::uint32_t count, std::uint32_t part, const std::function<void(std::uint32_t, std::uint32_t)>& work,
           const std::function<void()>& last = {});

 private:
  struct alignas(64) Share {  // of a thread: its own cache line
    std::atomic<std::uint64_t> next{0};
    std::uint64_t end = 0;
  };

  void hand_out();
  void take_parts(std::size_t thread);
  void serve(std::size_t thread);

  pid_t process_ = getpid();
  std::vector<Share> shares_;  // the caller's first
  std::vector<std::jthread> others_;
  const std::function<void(std::uint32_t, std::uint32_t)>* work_ = nullptr;
  const std::function<void()>* last_ = nullptr;
  std::uint32_t count_ = 0, part_ = 1;
  std::atomic<std::uint32_t> round_{0};  // grows by one with every run
  std::atomic<std::uint32_t> busy_{0};   // others that have not finished it
  std::atomic<bool> ends_{false};
};

}  // namespace quadgraph::cpu
