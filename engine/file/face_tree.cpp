#include "engine/file/face_tree.h"

#include <algorithm>
#include <glm/common.hpp>
#include <limits>
#include <numeric>

namespace quadgraph {
namespace {

constexpr std::uint32_t faces_per_leaf = 4;

// Leaves that are sorted between two calls of the listener: a millisecond or so.
constexpr std::uint32_t leaves_of_piece = 4096;

class Builder {
 public:
  Builder(const Level& level, FaceTree& tree, const Listener& listener) : tree_(tree), listener_(listener) {
    for (const glm::uvec3& f : level.faces) {
      heed(listener_, centres_.size());
      centres_.push_back((level.vertices[f.x] + level.vertices[f.y] + level.vertices[f.z]) / 3.0f);
    }
  }

  // Sorts the faces of leaves `first` to `last` - 1.
  void split(std::uint32_t first, std::uint32_t last) {
    if (last - first == 1) return;
    if (listener_ && last - first >= leaves_of_piece) listener_();
    const std::uint32_t middle = (first + last) / 2;
    const auto begin = tree_.order.begin() + tree_.leaf_begin[first],
               end = tree_.order.begin() + tree_.leaf_begin[last];
    const int axis = longest_axis(begin, end);
    std::nth_element(begin, tree_.order.begin() + tree_.leaf_begin[middle], end,
                     [&](std::uint32_t a, std::uint32_t b) { return centres_[a][axis] < centres_[b][axis]; });
    split(first, middle);
    split(middle, last);
  }

 private:
  template <typename Iterator>
  int longest_axis(Iterator begin, Iterator end) const {
    glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
    for (; begin != end; ++begin) {
      low = glm::min(low, centres_[*begin]);
      high = glm::max(high, centres_[*begin]);
    }
    const glm::vec3 size = high - low;
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  }

  FaceTree& tree_;
  const Listener& listener_;
  std::vector<glm::vec3> centres_;
};

}  // namespace

FaceTree face_tree(const Level& level, const Listener& listener) {
  FaceTree tree;
  const std::uint64_t faces = level.faces.size();
  std::uint64_t leaves = 1;
  while (leaves * faces_per_leaf < faces) leaves *= 2;
  tree.order.resize(faces);
  std::iota(tree.order.begin(), tree.order.end(), 0u);
  for (std::uint64_t j = 0; j <= leaves; ++j) tree.leaf_begin.push_back(static_cast<std::uint32_t>(j * faces / leaves));
  Builder(level, tree, listener).split(0, static_cast<std::uint32_t>(leaves));
  return tree;
}

}  // namespace quadgraph
