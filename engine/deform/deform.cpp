#include "engine/deform/deform.h"

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <string>

#include "engine/base/all_cores.h"
#include "engine/base/error.h"
#include "engine/deform/body_poses.h"
#include "engine/deform/mean_value.h"
#include "shaders/deform/deform.h"

namespace quadgraph {
namespace {

constexpr double radians = std::numbers::pi / 180;

static_assert(static_cast<std::uint32_t>(DeformerKind::displaced) == gpu::DEFORM_DISPLACED);
static_assert(static_cast<std::uint32_t>(DeformerKind::placed) == gpu::DEFORM_PLACED);
static_assert(static_cast<std::uint32_t>(DeformerKind::lattice) == gpu::DEFORM_LATTICE);
static_assert(static_cast<std::uint32_t>(LatticeBasis::linear) == gpu::LATTICE_LINEAR);

glm::dvec3 middle(const RestBox& box) {
  return 0.5 * (box.low + box.high);
}

// Where the range begins along the unit axis from the centre, and its length, mm.
void set_range(const Deformer& deformer, const RestBox& rest, const glm::dvec3& axis, const glm::dvec3& centre,
               gpu::DeformRecord& record) {
  double begin = deformer.begin, length = deformer.end - deformer.begin;
  if (!deformer.range_in_mm) {
    const double half = glm::dot(glm::abs(axis), 0.5 * (rest.high - rest.low));
    begin = glm::dot(axis, middle(rest)) - half + 2 * half * deformer.begin;
    length *= 2 * half;
  }
  record.begin = static_cast<float>(begin - glm::dot(axis, centre));
  record.extent = static_cast<float>(std::max(length, 1e-6));
}

// Rodrigues' rotation.
glm::dmat3 rotation(const glm::dvec3& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const glm::dmat3 cross(0, axis.z, -axis.y, -axis.z, 0, axis.x, axis.y, -axis.x, 0);
  return c * glm::dmat3(1) + s * cross + (1 - c) * glm::outerProduct(axis, axis);
}

void set_transform(const Deformer& deformer, const glm::dvec3& axis, const glm::dvec3& centre,
                   gpu::DeformRecord& record) {
  const glm::dmat3 scale(deformer.scale.x, 0, 0, 0, deformer.scale.y, 0, 0, 0, deformer.scale.z);
  const glm::dmat3 rows = glm::transpose(rotation(axis, deformer.degrees * radians) * scale);
  record.a = glm::vec3(rows[0]);
  record.b = glm::vec3(rows[1]);
  record.c = glm::vec3(rows[2]);
  record.d = glm::vec3(centre + deformer.translate - glm::transpose(rows) * centre);
}

std::uint32_t lattice_count(const Deformer& deformer) {
  return deformer.size.x | deformer.size.y << 8u | deformer.size.z << 16u |
         static_cast<std::uint32_t>(deformer.basis) << 24u;
}

void set_bent_about_axis(const Deformer& deformer, const RestBox& rest, const glm::dvec3& axis,
                         const glm::dvec3& centre, gpu::DeformRecord& record) {
  record.a = glm::vec3(axis);
  const glm::dvec3 across = deformer.towards - glm::dot(deformer.towards, axis) * axis;
  if (deformer.kind == DeformerKind::bend) record.b = glm::vec3(glm::normalize(across));
  record.c = glm::vec3(centre);
  const bool turns = deformer.kind == DeformerKind::twist || deformer.kind == DeformerKind::bend;
  record.amount = static_cast<float>(turns ? deformer.degrees * radians : deformer.factor - 1);
  set_range(deformer, rest, axis, centre, record);
}

const ShapesOfMesh& shapes_of(const Shapes& shapes, MeshNumber mesh) {
  if (!mesh) return shapes.display;
  if (*mesh >= shapes.levels.size()) {
    throw InputError("displaced, shapes: found " + std::to_string(shapes.levels.size()) + " levels, there is level " +
                     std::to_string(*mesh));
  }
  return shapes.levels[*mesh];
}

void check_sizes(const ShapesOfMesh& shapes, std::size_t count) {
  for (const std::vector<glm::vec3>& shape : shapes) {
    if (shape.size() == count) continue;
    throw InputError("displaced, shapes: found " + std::to_string(shape.size()) + " displacements, " +
                     std::to_string(count) + " are wanted: the shapes are those of another body");
  }
}

glm::dvec3 caged(const Deformer& cage, const glm::dvec3& at_rest, glm::dvec3 p) {
  const std::vector<double> weight = mean_value_weights(cage.cage, cage.triangles, at_rest);
  for (std::size_t k = 0; k < weight.size(); ++k) p += weight[k] * (cage.moved[k] - cage.cage[k]);
  return p;
}

}  // namespace

gpu::DeformRecord deform_record(const Deformer& deformer, const RestBox& rest) {
  gpu::DeformRecord record{};
  record.kind = static_cast<std::uint32_t>(deformer.kind);
  record.extent = 1;
  const glm::dvec3 axis = glm::normalize(deformer.axis), centre = deformer.centre.value_or(middle(rest));
  switch (deformer.kind) {
    case DeformerKind::transform:
      set_transform(deformer, axis, centre, record);
      break;
    case DeformerKind::lattice: {
      const RestBox box = deformer.box.value_or(rest);
      record.a = glm::vec3(box.low);
      record.b = glm::vec3(glm::max(box.high - box.low, glm::dvec3(1e-6)));
      record.count = lattice_count(deformer);
      break;
    }
    case DeformerKind::cage:
      record.count = static_cast<std::uint32_t>(deformer.cage.size());
      break;
    case DeformerKind::displaced:
    case DeformerKind::placed:
      break;
    default:
      set_bent_about_axis(deformer, rest, axis, centre, record);
  }
  return record;
}

std::vector<glm::dvec3> control_displacements(const Deformer& deformer) {
  if (deformer.kind == DeformerKind::lattice) return deformer.displacements;
  std::vector<glm::dvec3> control;
  for (const RigidMove& move : deformer.moves) {
    const glm::dmat3 rows = glm::transpose(move.turn);
    control.insert(control.end(), {rows[0], rows[1], rows[2], move.shift});
  }
  if (deformer.kind != DeformerKind::cage) return control;
  for (std::size_t k = 0; k < deformer.cage.size(); ++k) control.push_back(deformer.moved[k] - deformer.cage[k]);
  return control;
}

std::vector<glm::vec3> shape_displacements(const Deformer& deformer, MeshNumber mesh, std::size_t count) {
  const ShapesOfMesh& shapes = shapes_of(*deformer.shapes, mesh);
  std::vector<glm::vec3> sum(count, glm::vec3(0));
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    const auto weight = static_cast<float>(deformer.weights[s]);
    for (std::size_t v = 0; v < count && weight != 0; ++v) sum[v] += weight * shapes[s][v];
  }
  return sum;
}

std::span<const std::uint32_t> bodies_of(const Deformer& deformer, MeshNumber mesh) {
  return mesh ? deformer.bodies->levels.at(*mesh) : deformer.bodies->display;
}

void check_shapes(std::span<const Deformer> list, const QuadGraph& graph) {
  for (const Deformer& deformer : list) {
    if (deformer.kind != DeformerKind::displaced) continue;
    check_sizes(shapes_of(*deformer.shapes, {}), graph.display().vertices.size());
    for (std::uint32_t i = 0; i < graph.levels().size(); ++i) {
      const ShapesOfMesh& shapes = shapes_of(*deformer.shapes, i);
      if (shapes.size() != deformer.shapes->count()) {
        throw InputError("displaced, shapes: found " + std::to_string(shapes.size()) + " on level " +
                         std::to_string(i) + ", " + std::to_string(deformer.shapes->count()) + " are wanted");
      }
      check_sizes(shapes, graph.levels()[i].vertices.size());
    }
  }
}

std::vector<float> cage_weights(const Deformer& cage, std::span<const glm::vec3> vertices) {
  std::vector<float> weights(cage.cage.size() * vertices.size());
  on_all_cores(vertices.size(), [&](std::size_t v) {
    const std::vector<double> weight = mean_value_weights(cage.cage, cage.triangles, glm::dvec3(vertices[v]));
    for (std::size_t k = 0; k < weight.size(); ++k) weights[k * vertices.size() + v] = static_cast<float>(weight[k]);
  });
  return weights;
}

std::vector<glm::dvec3> deformed(std::span<const Deformer> list, const RestBox& rest, MeshNumber mesh,
                                 std::span<const glm::vec3> vertices) {
  std::vector<glm::dvec3> points(vertices.begin(), vertices.end());
  for (const Deformer& deformer : list) {
    gpu::DeformRecord record = deform_record(deformer, rest);
    std::vector<glm::dvec3> control = control_displacements(deformer);
    if (deformer.kind == DeformerKind::displaced) {
      const std::vector<glm::vec3> moved = shape_displacements(deformer, mesh, vertices.size());
      control.assign(moved.begin(), moved.end());
    }
    record.control = reinterpret_cast<std::uintptr_t>(control.data());
    if (deformer.kind == DeformerKind::placed) {
      const auto body = bodies_of(deformer, mesh);
      for (std::size_t v = 0; v < points.size(); ++v) {
        const RigidMove& move = deformer.moves[body[v]];
        points[v] = move.turn * points[v] + move.shift;
      }
      continue;
    }
    for (std::uint32_t v = 0; v < points.size(); ++v) {
      points[v] = deformer.kind == DeformerKind::cage ? caged(deformer, glm::dvec3(vertices[v]), points[v])
                                                      : gpu::deformed_point(record, points[v], v);
    }
  }
  return points;
}

}  // namespace quadgraph
