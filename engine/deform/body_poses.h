// Bodies of a file that move on their own, each as a rigid whole, from where they lie in the file.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/deform/deformer.h"
#include "engine/file/graph.h"

namespace quadgraph {

// Where a body is put: turned about the middle of its box in the file, then moved.
struct BodyPose {
  glm::dvec3 position{0};  // mm, from where it lies in the file
  glm::dvec3 rotation{0};  // degrees about the axes x, y, z, in this order

  bool operator==(const BodyPose&) const = default;
};

// By the names of bodies; those that are not named stay where they lie.
using BodyPoses = std::map<std::string, BodyPose>;

// Throws InputError naming the field, what was found and what is allowed.
void check_pose(const BodyPose& pose);

// Of which body each vertex of the meshes is, by QuadGraph::bodies.
struct VertexBodies {
  std::vector<std::uint32_t> display;
  std::vector<std::vector<std::uint32_t>> levels;
};
VertexBodies vertex_bodies(const QuadGraph& graph);

// The motion of every body of the file; those within another move with the outermost. Throws InputError for poses as
// check_pose, for a body that the file does not have, and for one within another that is to move by itself.
std::vector<RigidMove> rigid_moves(const QuadGraph& graph, const VertexBodies& bodies, const BodyPoses& poses);

// The step that makes these motions, which is the first of a list.
Deformer placed(std::vector<RigidMove> moves, std::shared_ptr<const VertexBodies> bodies);

}  // namespace quadgraph
