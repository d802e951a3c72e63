// QuadGraph::parse on arbitrary bytes: only FormatError may escape it. The mutator repairs checksums after most
// mutations, because random bytes would never get past them.
#include <cstddef>
#include <cstdint>

#include "engine/graph/error.h"
#include "engine/graph/graph.h"
#include "tests/cpp/qgraph_checksums.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  const std::size_t mutated = LLVMFuzzerMutate(data, size, max_size);
  if (seed % 8 != 0) quadgraph::fix_checksums({reinterpret_cast<std::byte*>(data), mutated});
  return mutated;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    quadgraph::QuadGraph::parse({reinterpret_cast<const std::byte*>(data), size}, "fuzz");
  } catch (const quadgraph::FormatError&) {
  }
  return 0;
}
