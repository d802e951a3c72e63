// libFuzzer on the reader. What it accepts must also be safe to use: the operators walk every index of it.
#include <cstdint>
#include <span>

#include "engine/base/error.h"
#include "engine/file/graph.h"
#include "engine/reference/exchange.h"
#include "engine/reference/reference.h"
#include "tests/cpp/fixtures/qgraph_bytes.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

void use(const quadgraph::QuadGraph& graph) {
  for (const quadgraph::Level& level : graph.levels()) {
    const std::vector<quadgraph::gpu::Optical> optical(level.node_count(), {glm::vec3(0.1f), glm::vec3(0.01f)});
    const std::vector<glm::vec3> q(level.face_count(), glm::vec3(1));
    if (!level.seen.empty()) {
      quadgraph::received_irradiance(level, std::vector<glm::dvec3>(level.face_count(), glm::dvec3(1)));
    }
    const quadgraph::EnteringLight light{{quadgraph::gpu::BEAM_LAMBERTIAN, glm::vec3(0), {}, {}}, q};
    for (const auto method : {quadgraph::Method::fem, quadgraph::Method::quadgraph_fdm}) {
      quadgraph::SolveOptions options;
      options.method = method;
      options.model = quadgraph::Model::sp3;
      options.max_iterations = 3;
      try {
        quadgraph::solve_reference(level, optical, 1.3, light, options);
      } catch (const quadgraph::SolverError&) {  // legal but degenerate geometry
      }
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    use(quadgraph::QuadGraph::parse(std::as_bytes(std::span(data, size)), "fuzz.qgraph"));
  } catch (const quadgraph::FormatError&) {  // the allowed answer to damage
  }
  return 0;
}

// Three of four mutants get their checksums recomputed: otherwise nearly all would end there.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  const std::size_t mutated = LLVMFuzzerMutate(data, size, max_size);
  if (seed % 4 != 0) quadgraph::seal(std::as_writable_bytes(std::span(data, mutated)));
  return mutated;
}
