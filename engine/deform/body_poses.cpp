#include "engine/deform/body_poses.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <numbers>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace quadgraph {
namespace {

constexpr double farthest_mm = 1e5, most_turned = 3600;

void check_triple(const char* field, const glm::dvec3& values, double most, const char* unit) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(values[k]) <= most) continue;
    throw InputError(std::string(field) + ": found " + number_text(values[k]) + ", allowed are -" + number_text(most) +
                     " to " + number_text(most) + " " + unit);
  }
}

// Turned by `degrees` about axis number `axis`.
glm::dmat3 turn_about(int axis, double degrees) {
  const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  glm::dmat3 turn(1);
  turn[u][u] = turn[v][v] = c;
  turn[u][v] = s;
  turn[v][u] = -s;
  return turn;
}

std::uint32_t body_number(const std::string& name, const std::vector<std::string>& bodies) {
  const auto found = std::ranges::find(bodies, name);
  if (found != bodies.end()) return static_cast<std::uint32_t>(found - bodies.begin());
  std::string allowed;
  for (const std::string& body : bodies) allowed += (allowed.empty() ? "" : ", ") + body;
  throw InputError("placements: a body '" + name + "' found, " +
                   (bodies.empty() ? "the file has one body without a name; a deformation moves it"
                                   : "the bodies of the file are " + allowed));
}

// The middle of the box around each body at rest, mm.
std::vector<glm::dvec3> middles_of(const QuadGraph& graph, const VertexBodies& bodies) {
  std::vector<RestBox> boxes(graph.bodies().size(), {glm::dvec3(HUGE_VAL), glm::dvec3(-HUGE_VAL)});
  const auto& vertices = graph.display().vertices;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    RestBox& box = boxes[bodies.display[v]];
    box.low = glm::min(box.low, glm::dvec3(vertices[v]));
    box.high = glm::max(box.high, glm::dvec3(vertices[v]));
  }
  std::vector<glm::dvec3> middles;
  for (const RestBox& box : boxes) middles.push_back(box.low.x <= box.high.x ? 0.5 * (box.low + box.high) : box.low);
  return middles;
}

}  // namespace

void check_pose(const BodyPose& pose) {
  check_triple("position", pose.position, farthest_mm, "mm");
  check_triple("rotation", pose.rotation, most_turned, "degrees");
}

VertexBodies vertex_bodies(const QuadGraph& graph) {
  VertexBodies bodies;
  for (const Level& level : graph.levels()) {
    std::vector<std::uint32_t> of(level.vertices.size(), 0);
    for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
      for (int k = 0; k < 4; ++k) of[level.tets[t][k]] = level.body_of_tet(t);
    }
    bodies.levels.push_back(std::move(of));
  }
  const DisplayMesh& mesh = graph.display();
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    bodies.display.push_back(graph.levels().empty() ? 0 : graph.levels()[0].body_of_face(mesh.face[v]));
  }
  return bodies;
}

std::vector<RigidMove> rigid_moves(const QuadGraph& graph, const VertexBodies& bodies, const BodyPoses& poses) {
  for (const auto& [name, pose] : poses) {
    const std::uint32_t body = body_number(name, graph.bodies());
    if (const std::uint32_t outer = graph.outermost()[body]; outer != body && pose != BodyPose()) {
      throw InputError("placements: " + name + " found, which lies within " + graph.bodies()[outer] +
                       " and shares its surface with it: place " + graph.bodies()[outer] + ", which takes " + name +
                       " along, or bake it where it is to lie");
    }
    try {
      check_pose(pose);
    } catch (const InputError& error) {
      throw InputError("placements: " + name + ": " + error.what());
    }
  }
  std::vector<RigidMove> moves(graph.bodies().size());
  if (moves.empty()) return moves;
  const std::vector<glm::dvec3> middles = middles_of(graph, bodies);
  for (const auto& [name, pose] : poses) {
    const std::uint32_t body = body_number(name, graph.bodies());
    const glm::dvec3& degrees = pose.rotation;
    const glm::dmat3 turn = turn_about(2, degrees.z) * turn_about(1, degrees.y) * turn_about(0, degrees.x);
    if (pose != BodyPose()) moves[body] = {turn, middles[body] - turn * middles[body] + pose.position};
  }
  for (std::size_t body = 0; body < moves.size(); ++body) moves[body] = moves[graph.outermost()[body]];
  return moves;
}

Deformer placed(std::vector<RigidMove> moves, std::shared_ptr<const VertexBodies> bodies) {
  Deformer deformer{.kind = DeformerKind::placed};
  deformer.moves = std::move(moves);
  deformer.bodies = std::move(bodies);
  return deformer;
}

}  // namespace quadgraph
