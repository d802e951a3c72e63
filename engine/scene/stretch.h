// By how much a map makes lengths longer.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <vector>

namespace quadgraph {

// Percentiles of the lengths that a millimetre of the source has in the body, along the three principal directions of
// the map at every place: 5, 50 and 95% of them are shorter. 1 where nothing is stretched.
struct Stretch {
  double low = 1, median = 1, high = 1;
};

// Those of a matrix, largest first.
std::array<double, 3> singular_values(const glm::dmat3& matrix);

class StretchCount {
 public:
  // `axes`: along how many the source differs at all, 1 to 3.
  explicit StretchCount(int axes) : axes_(axes) {}

  // `back`: mm of the source per mm of the body, at a place that counts `weight`.
  void add(const glm::dmat3& back, double weight);

  // 1 of none.
  Stretch percentiles() const;

 private:
  int axes_;
  std::vector<std::array<double, 2>> found_;  // stretch, weight
};

}  // namespace quadgraph
