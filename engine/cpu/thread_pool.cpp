#include "engine/cpu/thread_pool.h"

#include <sched.h>
#include <unistd.h>

#include <algorithm>

#include "engine/cpu/denormals.h"

namespace quadgraph::cpu {
namespace {

// Looks at a variable before a thread goes to sleep until it changes: a short while, as the next dispatch of a solve
// mostly follows at once.
constexpr int looks = 2000;

unsigned usable_cores() {
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof(set), &set) == 0) return static_cast<unsigned>(std::max(CPU_COUNT(&set), 1));
  return std::max(std::thread::hardware_concurrency(), 1u);
}

template <typename T>
void wait_while(const std::atomic<T>& variable, T value) {
  for (int look = 0; look < looks; ++look) {
    if (variable.load(std::memory_order_acquire) != value) return;
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }
  while (variable.load(std::memory_order_acquire) == value) variable.wait(value, std::memory_order_acquire);
}

}  // namespace

ThreadPool::ThreadPool(unsigned threads) : shares_(threads == 0 ? usable_cores() : threads) {
  for (std::size_t k = 1; k < shares_.size(); ++k) others_.emplace_back([this, k] { serve(k); });
}

ThreadPool::~ThreadPool() {
  if (getpid() != process_) {
    // A fork has none of the threads: what stands for them can be neither joined nor destroyed.
    static_cast<void>(new std::vector<std::jthread>(std::move(others_)));
    return;
  }
  ends_ = true;
  ++round_;
  round_.notify_all();
}

// Whole parts, as many to each as to the others, but for the last.
void ThreadPool::hand_out() {
  const std::uint64_t parts = (std::uint64_t{count_} + part_ - 1) / part_, threads = shares_.size();
  std::uint64_t begin = 0;
  for (Share& share : shares_) {
    share.next.store(begin, std::memory_order_relaxed);
    begin = std::min<std::uint64_t>(begin + (parts + threads - 1) / threads * part_, count_);
    share.end = begin;
  }
}

void ThreadPool::take_parts(std::size_t thread) {
  for (std::size_t k = 0; k < shares_.size(); ++k) {
    Share& share = shares_[(thread + k) % shares_.size()];
    while (share.next.load(std::memory_order_relaxed) < share.end) {
      const std::uint64_t begin = share.next.fetch_add(part_, std::memory_order_relaxed);
      if (begin >= share.end) break;
      const std::uint64_t end = std::min<std::uint64_t>(begin + part_, share.end);
      (*work_)(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end));
    }
  }
  if (*last_) (*last_)();
}

void ThreadPool::serve(std::size_t thread) {
  const DenormalsAreZero denormals;
  for (std::uint32_t seen = 0;;) {
    wait_while(round_, seen);
    seen = round_.load(std::memory_order_acquire);
    if (ends_) return;
    take_parts(thread);
    if (busy_.fetch_sub(1, std::memory_order_acq_rel) == 1) busy_.notify_all();
  }
}

void ThreadPool::run(std::uint32_t count, std::uint32_t part,
                     const std::function<void(std::uint32_t, std::uint32_t)>& work, const std::function<void()>& last) {
  const DenormalsAreZero denormals;
  if (others_.empty() || count <= part) {
    for (std::uint64_t begin = 0; begin < count; begin += part) {
      work(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(std::min<std::uint64_t>(begin + part, count)));
    }
    if (last) last();
    return;
  }
  work_ = &work;
  last_ = &last;
  count_ = count;
  part_ = part;
  hand_out();
  busy_.store(static_cast<std::uint32_t>(others_.size()), std::memory_order_relaxed);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  take_parts(0);
  for (std::uint32_t left = busy_.load(std::memory_order_acquire); left != 0;) {
    wait_while(busy_, left);
    left = busy_.load(std::memory_order_acquire);
  }
}

}  // namespace quadgraph::cpu
