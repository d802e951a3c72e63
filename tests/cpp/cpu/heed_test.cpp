// How a device asks whether to go on, amid work that can be given up and amid what cannot.
#include <doctest/doctest.h>

#include "engine/cpu/processor.h"

using namespace quadgraph;

namespace {

struct GivenUp {};

// A device that counts its questions, and answers one of them by giving up.
struct Asking {
  cpu::Processor processor{};
  int asked = 0, last = 3;

  Asking() {
    processor.set_check(
        [this] {
          if (++asked == last) throw GivenUp();
        },
        std::chrono::milliseconds(0));
  }

  // Waits for what ends at the look `looks` + 1.
  void wait(int looks) {
    processor.heed_until([&] { return looks-- == 0; });
  }
};

}  // namespace

TEST_CASE("what is done in one piece goes on being asked about, and is given up behind it") {
  Asking tried;
  const device::Interruptible scope(tried.processor);
  tried.wait(10);
  CHECK(tried.asked == 10);  // after the third, too
  CHECK(!scope.given_up());
  CHECK_THROWS_AS(tried.processor.heed(), GivenUp);
  CHECK(scope.given_up());
  tried.processor.heed();  // by what is still to be tidied up
  tried.wait(10);
  CHECK(tried.asked == 10);
}

TEST_CASE("nothing is asked where work cannot be given up, and nothing of it is left for later work") {
  Asking tried;
  tried.wait(10);
  tried.processor.heed();
  CHECK(tried.asked == 0);
  {
    const device::Interruptible scope(tried.processor);
    tried.wait(3);
  }
  const device::Interruptible scope(tried.processor);
  tried.processor.heed();
  CHECK(tried.asked == 4);
  CHECK(!scope.given_up());
}
