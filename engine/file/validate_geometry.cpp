// The rules that hold sections against each other by where things lie.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "engine/base/text.h"
#include "engine/file/geometry.h"
#include "engine/file/section_table.h"
#include "engine/file/validate.h"

namespace quadgraph {
namespace {

constexpr double least_size = 1e-4, largest_size = 1e7;  // mm, of the longest side and of coordinates
constexpr double node_tolerance = 1e-5;                  // of the body's size: single precision, and its sums
constexpr double largest_gap = 0.5;                      // the same, from a display vertex to its place in a face
constexpr double gap_tolerance = 1e-4;                   // the same
constexpr std::size_t most_samples = 32;                 // display vertices that are held against all faces
constexpr double least_agreement = 0.1;                  // mean cosine of normals that belong together

std::string of_mm(double value) {
  return number_text(static_cast<float>(value)) + " mm";
}

// Of the box around points, and how far it reaches from 0: what single precision is relative to.
double size_of(std::span<const glm::vec3> points) {
  glm::dvec3 low(std::numeric_limits<double>::max()), high(-low), far(0);
  for (const glm::vec3& point : points) {
    low = glm::min(low, glm::dvec3(point));
    high = glm::max(high, glm::dvec3(point));
    far = glm::max(far, glm::abs(glm::dvec3(point)));
  }
  return std::max(glm::length(high - low), glm::length(far));
}

glm::dvec3 centroid(const Level& level, const glm::uvec3& face) {
  return (glm::dvec3(level.vertices[face.x]) + glm::dvec3(level.vertices[face.y]) +
          glm::dvec3(level.vertices[face.z])) /
         3.0;
}

// Where vertex i of the display mesh lies in its face.
glm::dvec3 place_of(const DisplayMesh& display, const Level& finest, std::size_t i) {
  const glm::uvec3& face = finest.faces[display.face[i]];
  const glm::dvec3 weight(display.barycentric[i]);
  return weight.x * glm::dvec3(finest.vertices[face.x]) + weight.y * glm::dvec3(finest.vertices[face.y]) +
         weight.z * glm::dvec3(finest.vertices[face.z]);
}

glm::dvec3 direction(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 ? v / length : glm::dvec3(0);
}

void check_gaps(const DisplayMesh& display, const Level& finest, double size, const std::string& file) {
  const std::size_t count = display.vertices.size(), step = std::max<std::size_t>(count / most_samples, 1);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 vertex(display.vertices[i]);
    const double gap = glm::length(vertex - place_of(display, finest, i));
    if (!(gap <= largest_gap * size)) {
      fail_format(file, "display/vertices",
                  "row " + std::to_string(i) + ": " + of_mm(gap) + " from its place in its face, allowed are " +
                      of_mm(largest_gap * size));
    }
    if (i % step != 0) continue;
    double nearest = std::numeric_limits<double>::max();
    for (const glm::uvec3& face : finest.faces)
      nearest = std::min(nearest, glm::length(vertex - centroid(finest, face)));
    if (gap <= nearest + gap_tolerance * size) continue;
    fail_format(
        file, "display/face",
        "row " + std::to_string(i) + ": " + of_mm(gap) + " from the vertex, a face lies within " + of_mm(nearest));
  }
}

void check_agreement(const DisplayMesh& display, const Level& finest, const std::string& file) {
  double normals = 0, triangles = 0, area = 0;
  const auto outward = [&](std::size_t i) { return direction(face_vector(finest, finest.faces[display.face[i]])); };
  for (std::size_t i = 0; i < display.vertices.size(); ++i)
    normals += glm::dot(glm::dvec3(display.normals[i]), outward(i));
  for (const glm::uvec3& t : display.triangles) {
    const glm::dvec3 a(display.vertices[t.x]);
    const glm::dvec3 twice = glm::cross(glm::dvec3(display.vertices[t.y]) - a, glm::dvec3(display.vertices[t.z]) - a);
    triangles += glm::dot(twice, outward(t.x));
    area += glm::length(twice);
  }
  const auto require = [&](const char* section, double agreement) {
    if (agreement >= least_agreement) return;
    fail_format(file, section,
                "on average at a cosine of " + number_text(static_cast<float>(agreement)) +
                    " to the outward normals of the faces, allowed are 0.1 or more");
  };
  require("display/normals", normals / static_cast<double>(display.vertices.size()));
  require("display/triangles", area > 0 ? triangles / area : 0);
}

}  // namespace

void validate_size(std::span<const glm::vec3> vertices, const std::string& file, const std::string& section) {
  glm::dvec3 low(std::numeric_limits<double>::max()), high(-low);
  double far = 0;
  for (const glm::vec3& vertex : vertices) {
    for (int c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], static_cast<double>(vertex[c]));
      high[c] = std::max(high[c], static_cast<double>(vertex[c]));
      far = std::max(far, std::abs(static_cast<double>(vertex[c])));
    }
  }
  const double longest = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  if (longest >= least_size && longest <= largest_size && far <= largest_size) return;
  fail_format(
      file, section,
      "longest side " + of_mm(longest) + ", at most " + of_mm(far) + " from 0 found, allowed are 0.0001 to 1e7 mm");
}

void validate_nodes(const Level& level, const std::string& file, std::uint32_t index) {
  const std::string section = "level" + std::to_string(index) + "/nodes";
  const double allowed = node_tolerance * size_of(level.vertices);
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    const glm::dvec3 node(level.nodes[t]);
    for (int k = 0; k < 4; ++k) {
      const glm::uvec3 face = outward_face(level.tets[t], k);
      const glm::dvec3 vector = face_vector(level, face);
      const double outside = glm::dot(vector, node - glm::dvec3(level.vertices[face.x]));
      if (outside <= allowed * glm::length(vector)) continue;
      fail_format(file, section, "row " + std::to_string(t) + ": lies outside of its tet");
    }
  }
  for (std::size_t f = 0; f < level.faces.size(); ++f) {
    const double off = glm::length(glm::dvec3(level.nodes[level.tets.size() + f]) - centroid(level, level.faces[f]));
    if (off <= allowed) continue;
    fail_format(file, section,
                "row " + std::to_string(level.tets.size() + f) + ": " + of_mm(off) + " from the centroid of its face");
  }
}

void validate_display_place(const DisplayMesh& display, const Level& finest, const std::string& file) {
  check_gaps(display, finest, size_of(finest.vertices), file);
  check_agreement(display, finest, file);
}

}  // namespace quadgraph
