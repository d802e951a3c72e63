// libFuzzer on the reader of volumes, which are .npz files. What it accepts must also be usable at any place.
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

#include "engine/base/error.h"
#include "engine/scene/volume.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

constexpr std::size_t longest_message = 480;

// A file in memory, and its name.
struct MemoryFile {
  int descriptor = memfd_create("fuzz.npz", 0);
  std::string name = "/proc/self/fd/" + std::to_string(descriptor);

  void hold(const std::uint8_t* data, std::size_t size) const {
    const auto length = static_cast<ssize_t>(size);
    if (ftruncate(descriptor, 0) != 0 || pwrite(descriptor, data, size, 0) != length) std::abort();
  }
};

void use(const quadgraph::Volume& volume) {
  const glm::dvec3 centre(1, 2, 3);
  const std::vector<glm::vec3> points = {glm::vec3(0), glm::vec3(-1e7f), glm::vec3(1e7f),
                                         glm::vec3(volume.first(centre))};
  for (const quadgraph::gpu::Optical& optical : volume.at(points, centre)) {
    for (int c = 0; c < 3; ++c) {
      if (!(optical.sigma_s_prime[c] >= 0 && optical.sigma_a[c] >= 0)) std::abort();
    }
  }
}

template <typename T>
T number(const std::uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return value;
}

// Puts the checksums of members that are not compressed right in both of their headers (APPNOTE.TXT, 4.3.7 and 4.3.12).
void seal(std::uint8_t* data, std::size_t size) {
  constexpr std::size_t central_bytes = 46, local_bytes = 30;
  for (std::size_t i = 0; i + central_bytes <= size; ++i) {
    if (std::memcmp(data + i, "PK\1\2", 4) != 0) continue;
    const std::size_t packed = number<std::uint32_t>(data + i + 20), local = number<std::uint32_t>(data + i + 42);
    if (number<std::uint16_t>(data + i + 10) != 0 || local + local_bytes > size) continue;
    const std::size_t names =
        std::size_t{number<std::uint16_t>(data + local + 26)} + number<std::uint16_t>(data + local + 28);
    const std::size_t begin = local + local_bytes + names;
    if (begin > size || packed > size - begin) continue;
    const auto sum = static_cast<std::uint32_t>(crc32(0, data + begin, static_cast<uInt>(packed)));
    std::memcpy(data + local + 14, &sum, sizeof(sum));
    std::memcpy(data + i + 16, &sum, sizeof(sum));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const MemoryFile file;
  file.hold(data, size);
  try {
    use(quadgraph::read_volume(file.name));
  } catch (const quadgraph::InputError& error) {
    const std::string text = error.what();
    if (!text.starts_with(file.name) || text.size() >= longest_message) std::abort();
  }
  return 0;
}

// Three of four mutants get their checksums recomputed: otherwise nearly all would end there.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  const std::size_t mutated = LLVMFuzzerMutate(data, size, max_size);
  if (seed % 4 != 0) seal(data, mutated);
  return mutated;
}
