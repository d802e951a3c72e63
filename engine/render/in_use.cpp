#include "engine/render/in_use.h"

#include "engine/base/error.h"

namespace quadgraph {

void InUse::enter() {
  if (getpid() != process_) {
    throw InputError(what_ + ": made before this process was forked, threads and device stay with the parent; make " +
                     "another in the child");
  }
  const std::thread::id me = std::this_thread::get_id();
  std::thread::id nobody{};
  if (user_.load() != me && !user_.compare_exchange_strong(nobody, me)) {
    throw InputError(what_ +
                     ": in use by another thread, one thread at a time is allowed; take turns, or make another");
  }
  ++depth_;
}

void InUse::leave() {
  if (--depth_ == 0) user_.store({});
}

}  // namespace quadgraph
