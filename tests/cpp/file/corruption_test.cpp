// Damage at large: whatever happens to a file, the reader refuses it or what it accepts is safe to use.
#include <doctest/doctest.h>

#include <random>

#include "engine/base/error.h"
#include "engine/reference/reference.h"
#include "tests/cpp/fixtures/qgraph_bytes.h"
#include "tests/cpp/fixtures/test_data.h"

using namespace quadgraph;

namespace {

using Bytes = std::vector<std::byte>;

// Walks every index of an accepted file. Degenerate geometry may defeat the solver, but must be said.
void use(const QuadGraph& graph) {
  for (const Level& level : graph.levels()) {
    const std::vector<gpu::Optical> optical(level.node_count(), {glm::vec3(0.1f), glm::vec3(0.01f)});
    const std::vector<glm::vec3> q(level.face_count(), glm::vec3(1));
    const EnteringLight light{{gpu::BEAM_LAMBERTIAN, glm::vec3(0), {}, {}}, q};
    for (const Method method : {Method::fem, Method::quadgraph_fdm}) {
      SolveOptions options;
      options.method = method;
      options.model = Model::sp3;
      options.max_iterations = 2;
      try {
        const ReferenceSolution solution = solve_reference(level, optical, 1.3, light, options);
        REQUIRE(std::isfinite(solution.report.residual));
      } catch (const SolverError&) {
      }
    }
  }
}

bool accepted(std::span<const std::byte> bytes) {
  try {
    use(QuadGraph::parse(bytes, "damaged.qgraph"));
    return true;
  } catch (const FormatError&) {
    return false;
  }
}

std::size_t below(std::mt19937& random, std::size_t limit) {
  return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
}

// One to eight changes: a flipped bit, or a byte or a word replaced by a random or an extreme value.
void damage(Bytes& bytes, std::size_t begin, std::size_t end, std::mt19937& random) {
  constexpr std::array<std::uint32_t, 6> extremes = {0, 1, 0x7f7fffff, 0x7fc00000, 0x80000000, 0xffffffff};
  for (std::size_t changes = 1 + below(random, 8); changes > 0; --changes) {
    const std::size_t at = begin + below(random, end - begin);
    switch (below(random, 3)) {
      case 0:
        bytes[at] ^= std::byte{1} << below(random, 8);
        break;
      case 1:
        bytes[at] = static_cast<std::byte>(below(random, 256));
        break;
      default:
        if (at / 4 * 4 + 4 <= end) write_at(bytes, at / 4 * 4, extremes[below(random, extremes.size())]);
    }
  }
}

}  // namespace

TEST_CASE("every truncated prefix is refused, also with its size and checksums put right") {
  const Bytes whole = tiny_bytes();
  REQUIRE(accepted(whole));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    Bytes prefix(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    REQUIRE_MESSAGE(!accepted(prefix), "prefix of " << size << " bytes");
    seal(prefix);
    REQUIRE_MESSAGE(!accepted(prefix), "sealed prefix of " << size << " bytes");
  }
}

TEST_CASE("every flipped bit is refused") {
  Bytes bytes = tiny_bytes();
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      bytes[at] ^= std::byte{1} << bit;
      REQUIRE_MESSAGE(!accepted(bytes), "bit " << bit << " of byte " << at);
      bytes[at] ^= std::byte{1} << bit;
    }
  }
}

TEST_CASE("10,000 random corruptions are refused") {
  const Bytes whole = tiny_bytes();
  std::mt19937 random(2010);
  for (int i = 0; i < 10000; ++i) {
    Bytes bytes = whole;
    damage(bytes, 0, bytes.size(), random);
    if (bytes == whole) continue;
    REQUIRE_MESSAGE(!accepted(bytes), "corruption " << i);
  }
}

TEST_CASE("10,000 corruptions behind valid checksums are refused or harmless") {
  const char* file = nullptr;
  SUBCASE("of one body") {
    file = "tiny.qgraph";
  }
  SUBCASE("of two bodies") {
    file = "two_cubes.qgraph";
  }
  SUBCASE("of a body within another") {
    file = "nested_cubes.qgraph";
  }
  const Bytes whole = data_bytes(file);
  REQUIRE(accepted(whole));
  const std::size_t table_end = entry_offset(entries_present(whole));
  std::mt19937 random(2011);
  int taken = 0;
  for (int i = 0; i < 10000; ++i) {
    Bytes bytes = whole;
    // One of four in the header or the table, the rest in the sections.
    if (i % 4 == 0) {
      damage(bytes, 0, table_end, random);
    } else {
      damage(bytes, table_end, bytes.size(), random);
    }
    seal(bytes);
    taken += accepted(bytes) ? 1 : 0;
  }
  MESSAGE(taken << " of 10000 accepted: changed coordinates, weights within the tolerance, text");
  CHECK(taken > 0);
  CHECK(taken < 5000);
}
