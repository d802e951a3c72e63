// The rules that hold sections against each other by where things lie.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <optional>
#include <vector>

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
constexpr std::size_t most_held = 16;                    // display vertices that are held against all faces
constexpr std::size_t most_averaged = 1024;              // vertices and triangles whose normals are averaged
constexpr double largest_open = 1e-6;                    // of the area: a hole in a surface that bakes close
constexpr double least_agreement = 0.1;                  // mean cosine of normals that belong together

std::string of_mm(double value) {
  return number_text(static_cast<float>(value)) + " mm";
}

struct Box {
  glm::vec3 low, high;  // mm

  // Of the box, and how far it reaches from 0: what single precision is relative to.
  double size() const {
    const glm::dvec3 reach(glm::max(glm::abs(low), glm::abs(high)));
    return std::max(glm::length(glm::dvec3(high) - glm::dvec3(low)), glm::length(reach));
  }
};

Box box_of(std::span<const glm::vec3> points) {
  Box box{points[0], points[0]};
  for (const glm::vec3& point : points) {
    box.low = glm::min(box.low, point);
    box.high = glm::max(box.high, point);
  }
  return box;
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

// Some rows of many, spread evenly: every `step`-th.
std::size_t step_for(std::size_t count, std::size_t samples) {
  return std::max<std::size_t>(count / samples, 1);
}

// Squared distances from points to the nearest of others.
class Nearest {
 public:
  void add(const glm::vec3& point) {
    x_.push_back(point.x);
    y_.push_back(point.y);
    z_.push_back(point.z);
    least_.push_back(std::numeric_limits<float>::max());
  }

  // Points in the inner loop, so that several lie in one register.
  void hold_against(std::span<const glm::vec3> others) {
    for (const glm::vec3& other : others) {
      for (std::size_t k = 0; k < least_.size(); ++k) {
        const float x = x_[k] - other.x, y = y_[k] - other.y, z = z_[k] - other.z, square = x * x + y * y + z * z;
        least_[k] = square < least_[k] ? square : least_[k];
      }
    }
  }

  double distance(std::size_t k) const { return std::sqrt(static_cast<double>(least_[k])); }

 private:
  std::vector<float> x_, y_, z_, least_;
};

double gap_of(const DisplayMesh& display, const Level& finest, std::size_t i) {
  return glm::length(glm::dvec3(display.vertices[i]) - place_of(display, finest, i));
}

// mm, how far `away` from a place in a face leads along the face, towards a corner farther from the place than `least`
// mm. None of the place that is nearest.
double along_face(const Level& level, const glm::uvec3& face, const glm::dvec3& place, const glm::dvec3& away,
                  double least) {
  double farthest = 0;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 side = glm::dvec3(level.vertices[face[k]]) - place;
    const double length = glm::length(side);
    if (length > least) farthest = std::max(farthest, glm::dot(away, side) / length);
  }
  return farthest;
}

void check_gaps(const DisplayMesh& display, const Level& finest, double size, const std::string& file) {
  for (std::size_t i = 0; i < display.vertices.size(); ++i) {
    const glm::dvec3 place = place_of(display, finest, i), away = glm::dvec3(display.vertices[i]) - place;
    if (glm::dot(away, away) > largest_gap * size * largest_gap * size) {
      fail_format(file, "display/vertices",
                  "row " + std::to_string(i) + ": " + of_mm(glm::length(away)) +
                      " from its place in its face, allowed are " + of_mm(largest_gap * size));
    }
    const double along = along_face(finest, finest.faces[display.face[i]], place, away, node_tolerance * size);
    if (along > node_tolerance * size) {
      fail_format(file, "display/vertices",
                  "row " + std::to_string(i) + ": its place is not the nearest in its face, which goes on for " +
                      of_mm(along) + " towards it");
    }
  }
}

// Of the display vertices of one body, against the faces of that body.
void check_nearest(const DisplayMesh& display, const Level& finest, std::uint32_t body, double size,
                   const std::string& file) {
  std::vector<glm::vec3> nodes;
  for (std::uint32_t f = 0; f < finest.face_count(); ++f) {
    if (finest.body_of_face(f) == body) nodes.push_back(finest.nodes[finest.tets.size() + f]);
  }
  const std::size_t count = display.vertices.size(), step = step_for(count, most_held);
  Nearest nearest;
  std::vector<std::size_t> held;
  for (std::size_t i = 0; i < count; i += step) {
    if (finest.body_of_face(display.face[i]) != body) continue;
    nearest.add(display.vertices[i]);
    held.push_back(i);
  }
  nearest.hold_against(nodes);
  for (std::size_t k = 0; k < held.size(); ++k) {
    const double gap = gap_of(display, finest, held[k]), least = nearest.distance(k);
    if (gap <= least + gap_tolerance * size) continue;
    fail_format(
        file, "display/face",
        "row " + std::to_string(held[k]) + ": " + of_mm(gap) + " from the vertex, a face lies within " + of_mm(least));
  }
}

// What a body is in is closed: the area vectors add up to 0.
void check_closed(const DisplayMesh& display, const std::string& file) {
  glm::dvec3 sum(0);
  double area = 0;
  for (const glm::uvec3& t : display.triangles) {
    const glm::dvec3 a(display.vertices[t.x]);
    const glm::dvec3 twice = glm::cross(glm::dvec3(display.vertices[t.y]) - a, glm::dvec3(display.vertices[t.z]) - a);
    sum += twice;
    area += glm::length(twice);
  }
  if (glm::length(sum) <= largest_open * area) return;
  fail_format(file, "display/triangles",
              "do not close: the sum of their area vectors is " +
                  number_text(static_cast<float>(glm::length(sum) / area)) + " of their area, allowed is " +
                  number_text(static_cast<float>(largest_open)));
}

void check_agreement(const DisplayMesh& display, const Level& finest, const std::string& file) {
  double normals = 0, triangles = 0, area = 0;
  const auto outward = [&](std::size_t i) { return direction(face_vector(finest, finest.faces[display.face[i]])); };
  const std::size_t count = display.vertices.size(), step = step_for(count, most_averaged);
  for (std::size_t i = 0; i < count; i += step) normals += glm::dot(glm::dvec3(display.normals[i]), outward(i));
  for (std::size_t i = 0; i < display.triangles.size(); i += step_for(display.triangles.size(), most_averaged)) {
    const glm::uvec3& t = display.triangles[i];
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
  require("display/normals", normals / static_cast<double>((count + step - 1) / step));
  require("display/triangles", area > 0 ? triangles / area : 0);
}

// Whether a point lies on the inner side of all faces of a positive tet.
bool inside(const Level& level, const glm::uvec4& tet, const glm::dvec3& point) {
  const glm::dvec3 a = glm::dvec3(level.vertices[tet[0]]) - point, b = glm::dvec3(level.vertices[tet[1]]) - point,
                   c = glm::dvec3(level.vertices[tet[2]]) - point, d = glm::dvec3(level.vertices[tet[3]]) - point;
  const glm::dvec3 ab = glm::cross(a, b), cd = glm::cross(c, d);
  return glm::dot(b, cd) >= 0 && glm::dot(a, cd) <= 0 && glm::dot(d, ab) >= 0 && glm::dot(c, ab) <= 0;
}

// mm, the farthest that a point lies outside of the planes of a tet's faces.
double farthest_outside(const Level& level, const glm::uvec4& tet, const glm::dvec3& point) {
  double farthest = 0;
  for (int k = 0; k < 4; ++k) {
    const glm::uvec3 face = outward_face(tet, k);
    const glm::dvec3 vector = face_vector(level, face);
    farthest = std::max(farthest, glm::dot(vector, point - glm::dvec3(level.vertices[face.x])) / glm::length(vector));
  }
  return farthest;
}

}  // namespace

void validate_size(std::span<const glm::vec3> vertices, const std::string& file, const std::string& section) {
  const Box box = box_of(vertices);
  const glm::dvec3 sides = glm::dvec3(box.high) - glm::dvec3(box.low);
  const glm::vec3 reach = glm::max(glm::abs(box.low), glm::abs(box.high));
  const double longest = std::max({sides.x, sides.y, sides.z}), far = std::max({reach.x, reach.y, reach.z});
  if (longest >= least_size && longest <= largest_size && far <= largest_size) return;
  fail_format(
      file, section,
      "longest side " + of_mm(longest) + ", at most " + of_mm(far) + " from 0 found, allowed are 0.0001 to 1e7 mm");
}

void validate_tets(const Level& level, const std::string& file, std::uint32_t index) {
  const std::string prefix = "level" + std::to_string(index) + "/";
  std::optional<double> allowed;
  const auto lies_outside = [&](std::size_t t, const glm::dvec3& node) {
    if (!allowed) allowed = node_tolerance * box_of(level.vertices).size();
    return !(farthest_outside(level, level.tets[t], node) <= *allowed);
  };
  for (std::size_t t = 0; t < level.tets.size(); ++t) {
    const auto row = [&] { return "row " + std::to_string(t) + ": "; };
    if (!(tet_determinant(level, level.tets[t]) > 0)) {
      fail_format(file, prefix + "tets", row() + "not positively oriented");
    }
    const glm::dvec3 node(level.nodes[t]);
    if (inside(level, level.tets[t], node) || !lies_outside(t, node)) continue;
    fail_format(file, prefix + "nodes", row() + "lies outside of its tet");
  }
}

void validate_surface_nodes(const Level& level, const std::string& file, std::uint32_t index) {
  const double allowed = node_tolerance * box_of(level.vertices).size();
  for (std::size_t f = 0; f < level.faces.size(); ++f) {
    const glm::dvec3 off = glm::dvec3(level.nodes[level.tets.size() + f]) - centroid(level, level.faces[f]);
    if (glm::dot(off, off) <= allowed * allowed) continue;
    fail_format(file, "level" + std::to_string(index) + "/nodes",
                "row " + std::to_string(level.tets.size() + f) + ": " + of_mm(glm::length(off)) +
                    " from the centroid of its face");
  }
}

void validate_display_place(const DisplayMesh& display, const Level& finest, const std::string& file) {
  const double size = box_of(finest.vertices).size();
  check_gaps(display, finest, size, file);
  const auto last = std::ranges::max_element(finest.tet_bodies);
  const std::uint32_t bodies = last == finest.tet_bodies.end() ? 1 : *last + 1u;
  for (std::uint32_t body = 0; body < bodies; ++body) check_nearest(display, finest, body, size, file);
  check_closed(display, file);
  check_agreement(display, finest, file);
}

void validate_places(std::span<const Level> levels, const DisplayMesh& display, const std::string& file) {
  for (std::uint32_t i = 0; i < levels.size(); ++i) {
    validate_surface_nodes(levels[i], file, i);
    validate_seen_again(levels[i], file, i);
  }
  if (!levels.empty()) validate_display_place(display, levels[0], file);
}

}  // namespace quadgraph
