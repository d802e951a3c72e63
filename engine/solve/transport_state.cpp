// What is kept of samples for the next frame, and read back of them.
#include <algorithm>

#include "engine/solve/transport_samples.h"

namespace quadgraph {
namespace {

// Sum number `which` of TRANSPORT_WALK_SUMS, of all that were read back.
glm::dvec3 sum_of(const std::vector<glm::dvec3>& sums, std::size_t which) {
  glm::dvec3 sum{0};
  for (std::size_t i = which; i < sums.size(); i += gpu::TRANSPORT_WALK_SUMS) sum += sums[i];
  return sum;
}

}  // namespace

void TransportSamples::record_segments(const TransportParts& parts) {
  parts.work.recorder.copy(segments_, segments_on_host_, segments_.size());
}

void TransportSamples::record_state(const TransportParts& parts) {
  parts.work.recorder.copy(parts.work.scale, unit_, unit_.size());
  record_optical(parts);
  record_segments(parts);
  parts.work.recorder.copy(walk_sums_, walk_sums_on_host_, walk_sums_.size());
  parts.work.recorder.copy(books_, books_on_host_, books_.size());
}

// The coefficients, for a field that is to be seen when they have changed.
void TransportSamples::record_optical(const TransportParts& parts) {
  Recorder& recorder = parts.work.recorder;
  even_before_ = parts.level.even;
  const std::uint64_t bytes = (even_before_ ? 1 : parts.level.tet_count) * sizeof(gpu::Optical);
  if (optical_before_.size() != bytes) {
    recorder.submit();
    optical_before_ = {recorder.device(), bytes, device::Place::device, "transport/coefficients, before"};
  }
  recorder.copy(parts.level.optical, optical_before_, bytes);
}

double TransportSamples::segments() const {
  return segments_on_host_.mapped_as<std::uint32_t>()[0];
}

TransportPower TransportSamples::power(const glm::dvec3& scale) const {
  const std::vector<glm::dvec3> walked = powers(walk_sums_on_host_.mapped_as<std::uint32_t>(), scale);
  TransportPower power{sum_of(walked, 3), sum_of(walked, 0), sum_of(walked, 1), sum_of(walked, 2)};
  power.share_again = share_again();
  return power;
}

glm::dvec3 TransportSamples::share_again() const {
  const auto& book = books_on_host_.mapped_as<gpu::TransportBook>()[0];
  glm::dvec3 share{0};
  for (int c = 0; c < 3; ++c) share[c] = book.left[c] > 0 ? static_cast<double>(book.again[c] / book.left[c]) : 0;
  return share;
}

double TransportSamples::returns() const {
  const glm::dvec3 share = share_again();
  return std::max({share.x, share.y, share.z});
}

}  // namespace quadgraph
