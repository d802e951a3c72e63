#include "engine/reference/source_walk.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "engine/reference/beam.h"

namespace quadgraph {
namespace {

class Collect {
 public:
  explicit Collect(WalkResult& result) : result_(result) {}

  void begins(const std::array<double, 3>&) {}
  void steps(std::uint32_t, const std::array<double, 3>&) {}
  void entered(int c, double watt) { result_.entered[c] += watt; }
  void scattered(std::uint32_t carrier, int c, double watt) { result_.scattered[carrier][c] += watt; }
  void absorbed(int c, double watt) { result_.absorbed[c] += watt; }
  void unscattered(std::uint32_t f, int c, double watt) {
    result_.unscattered[f][c] += watt;
    result_.unscattered_out[c] += watt;
  }
  void trapped(int c, double watt) { result_.unscattered_out[c] += watt; }

 private:
  WalkResult& result_;
};

}  // namespace

bool enters_evenly(const FaceFrame& frame, const Quarters& quarters) {
  const glm::vec3 low = glm::min(glm::min(quarters[0], quarters[1]), glm::min(quarters[2], quarters[3]));
  const glm::vec3 high = glm::max(glm::max(quarters[0], quarters[1]), glm::max(quarters[2], quarters[3]));
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 edge = frame.corners[(k + 1) % 3] - frame.corners[k];
    longest = std::max(longest, glm::dot(edge, edge));
  }
  return glm::all(glm::lessThanEqual(high - low, high / 16.0f)) && longest <= 8 * frame.area;
}

WalkResult walk_source(const Level& level, const Problem& problem, const gpu::BeamRecord& beam,
                       std::span<const Quarters> quarters) {
  WalkResult result;
  result.scattered.assign(carrier_count(level, problem.method), glm::dvec3(0));
  result.unscattered.assign(level.faces.size(), glm::dvec3(0));
  const Medium medium(problem.optical);
  QuarterLight light(quarters);
  Collect collect(result);
  Beam source(level, problem, medium, beam, light, collect);
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (!level.reflecting(f)) source.enter(f, quarters[f]);
  }
  return result;
}

}  // namespace quadgraph
