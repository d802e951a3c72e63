#include "engine/render/overlap.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <vector>

namespace quadgraph {
namespace {

constexpr std::size_t most_vertices = 4096;  // of a body that are looked at

// The surface of a body where it has been put.
struct PlacedBody {
  std::vector<glm::dvec3> vertices;  // mm
  RestBox box{glm::dvec3(HUGE_VAL), glm::dvec3(-HUGE_VAL)};
};

std::vector<PlacedBody> bodies_where_they_are(const QuadGraph& graph, const Deformer& placed) {
  std::vector<PlacedBody> found(graph.bodies().size());
  const Level& level = graph.levels()[0];
  for (std::uint32_t v = 0; v < level.surface_vertex_count; ++v) {
    const std::uint32_t body = placed.bodies->levels[0][v];
    const RigidMove& move = placed.moves[body];
    const glm::dvec3 p = move.turn * glm::dvec3(level.vertices[v]) + move.shift;
    found[body].vertices.push_back(p);
    found[body].box.low = glm::min(found[body].box.low, p);
    found[body].box.high = glm::max(found[body].box.high, p);
  }
  return found;
}

// Whether some of these places lie in a body, which has been moved by `move`.
bool reaches_into(const PlacedBody& one, const PlacedBody& other, std::uint32_t number, const RigidMove& move,
                  const QuadGraph& graph, const TetLocator& locator) {
  const std::size_t step = std::max<std::size_t>(one.vertices.size() / most_vertices, 1);
  const glm::dmat3 back = glm::transpose(move.turn);
  for (std::size_t v = 0; v < one.vertices.size(); v += step) {
    const glm::dvec3& p = one.vertices[v];
    const bool near =
        glm::all(glm::greaterThanEqual(p, other.box.low)) && glm::all(glm::lessThanEqual(p, other.box.high));
    if (!near) continue;
    const auto place = locator.find(back * (p - move.shift));
    if (place && graph.outermost()[graph.levels()[0].body_of_tet(place->tet)] == number) return true;
  }
  return false;
}

}  // namespace

std::string overlap_text(const QuadGraph& graph, const Deformer& placed, const TetLocator& locator) {
  const std::vector<PlacedBody> bodies = bodies_where_they_are(graph, placed);
  std::string text;
  for (std::uint32_t a = 0; a < bodies.size(); ++a) {
    for (std::uint32_t b = a + 1; b < bodies.size(); ++b) {
      if (placed.moves[a] == placed.moves[b]) continue;  // as they lay in the file
      if (!reaches_into(bodies[a], bodies[b], b, placed.moves[b], graph, locator) &&
          !reaches_into(bodies[b], bodies[a], a, placed.moves[a], graph, locator)) {
        continue;
      }
      text += (text.empty() ? "" : "; ") + graph.bodies()[a] + " and " + graph.bodies()[b] + " overlap";
    }
  }
  if (!text.empty()) text += ": light there is undefined; move them apart by their placements";
  return text;
}

}  // namespace quadgraph
