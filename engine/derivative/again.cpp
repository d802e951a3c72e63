#include "engine/derivative/again.h"

#include <array>

#include "engine/derivative/media.h"
#include "engine/reference/beam.h"

namespace quadgraph {
namespace {

using Entries = std::vector<AgainMatrix::Entry>;

// 1 W/mm^2.
struct UnitLight {
  std::array<double, 3> at(std::uint32_t, std::uint32_t) const { return {1, 1, 1}; }
};

// Entries of one face after the other.
class Columns {
 public:
  Columns(Entries& scattered, Entries& unscattered) : scattered_(scattered), unscattered_(unscattered) {}

  void begin(std::uint32_t face) {
    face_ = face;
    first_scattered_ = scattered_.size();
    first_unscattered_ = unscattered_.size();
  }

  void scattered(std::uint32_t vertex, int c, double watt) { add(scattered_, first_scattered_, vertex, c, watt); }
  void unscattered(std::uint32_t f, int c, double watt) { add(unscattered_, first_unscattered_, f, c, watt); }
  void begins(const std::array<double, 3>&) {}
  void steps(std::uint32_t, const std::array<double, 3>&) {}
  void entered(int, double) {}
  void absorbed(int, double) {}
  void trapped(int, double) {}

 private:
  void add(Entries& entries, std::size_t first, std::uint32_t to, int c, double watt) const {
    std::size_t i = entries.size();
    while (i > first && entries[i - 1].to != to) --i;
    if (i == first) {
      entries.push_back({face_, to, glm::dvec3(0)});
      i = entries.size();
    }
    entries[i - 1].share[c] += watt;
  }

  Entries& scattered_;
  Entries& unscattered_;
  std::uint32_t face_ = 0;
  std::size_t first_scattered_ = 0, first_unscattered_ = 0;
};

}  // namespace

AgainMatrix::AgainMatrix(const Level& level, const Problem& problem, const Parameters& at)
    : face_count_(level.faces.size()) {
  const gpu::BeamRecord mean{gpu::BEAM_MEAN, {}, {}, {}};
  const PlainNumbers numbers(at);
  const UnitLight light;
  Columns columns(scattered_, unscattered_);
  Beam beam(level, problem, numbers, mean, light, columns, differentiable_end);
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    if (level.reflecting(f)) continue;
    columns.begin(f);
    beam.enter(f, Quarters{});
  }
}

void AgainMatrix::add(std::span<const glm::dvec3> q, Walked& walked) const {
  for (const Entry& entry : scattered_) walked.scattered[entry.to] += entry.share * q[entry.face];
  for (const Entry& entry : unscattered_) walked.unscattered[entry.to] += entry.share * q[entry.face];
}

std::vector<glm::dvec3> AgainMatrix::transposed(const Walked& weights) const {
  std::vector<glm::dvec3> q(face_count_, glm::dvec3(0));
  for (const Entry& entry : scattered_) q[entry.face] += entry.share * weights.scattered[entry.to];
  for (const Entry& entry : unscattered_) q[entry.face] += entry.share * weights.unscattered[entry.to];
  return q;
}

}  // namespace quadgraph
