// The processor gives the same bits with any number of threads, in every pass. Run under ThreadSanitizer too, so
// without Vulkan.
#include <doctest/doctest.h>

#include <cstring>

#include "interface/all_shaders.h"
#include "tests/cpp/fixtures/all_work.h"
#include "tests/cpp/fixtures/listening_processor.h"

using namespace quadgraph;

namespace {

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), sizeof(float) * a.size()) == 0);
}

std::set<std::string> all_codes() {
  std::set<std::string> names;
  for (const device::Shader* shader : all_shaders) {
    names.insert(shader->name);
    if (!shader->sp3.empty()) names.insert(std::string(shader->name) + " sp3");
  }
  return names;
}

}  // namespace

TEST_CASE("every pass has the same bits on 1, 2 and 7 threads, and no shader is without work that compares it") {
  std::set<std::string> missing = all_codes();
  for (const DeviceWork& work : all_work()) {
    CAPTURE(work.name);
    const auto alone = std::make_shared<ListeningProcessor>(cpu::ProcessorOptions{.threads = 1});
    const std::vector<Found> expected = work.run(alone);
    for (const std::string& name : alone->ran()) missing.erase(name);
    for (const unsigned threads : {2u, 7u}) {
      CAPTURE(threads);
      const std::vector<Found> found =
          work.run(std::make_shared<cpu::Processor>(cpu::ProcessorOptions{.threads = threads}));
      REQUIRE(found.size() == expected.size());
      for (std::size_t k = 0; k < found.size(); ++k) {
        CAPTURE(found[k].name);
        CHECK(same_bits(found[k].values, expected[k].values));
      }
    }
  }
  for (const std::string& name : missing) FAIL_CHECK(name << " is run by none of tests/cpp/fixtures/all_work.h");
}
