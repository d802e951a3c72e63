#include "engine/render/light/leaning.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "engine/render/display/display_faces.h"

namespace quadgraph {
namespace {

// Slopes of a face in the shape at rest: the direction that its height grows in, by how much a mm.
using Slopes = std::vector<glm::vec3>;

constexpr std::uint32_t rows = 4;  // of samples on a face, rows * rows in all

struct Triangle {
  glm::vec3 a, ab, ac;

  float area() const { return 0.5f * glm::length(glm::cross(ab, ac)); }
};

Triangle triangle_of(std::span<const glm::vec3> vertices, const glm::uvec3& ids) {
  const glm::vec3& a = vertices[ids.x];
  return {a, vertices[ids.y] - a, vertices[ids.z] - a};
}

gpu::ImageLevels levels_of(const ImagePyramid& image) {
  return {0, image.columns, image.rows, image.levels};
}

glm::vec2 read(const ImagePyramid& image, const glm::vec2& place, float texels, bool repeated) {
  const gpu::ImageTap tap = gpu::tap_of(levels_of(image), place, texels, repeated);
  const auto& all = image.texels;
  return glm::vec2(
      gpu::mixed(tap, all[tap.upper_left], all[tap.upper_right], all[tap.lower_left], all[tap.lower_right]));
}

// The mean over rows * rows equal parts of a face, each of which a texel of its width stands for.
glm::vec3 slope_in_box(const NormalMap& map, const gpu::ImageBox& box, const Triangle& face) {
  const float width = std::sqrt(face.area()) / static_cast<float>(rows);
  const float texels = gpu::texels_across(box, levels_of(*map.slopes), width);
  glm::vec2 sum(0);
  for (std::uint32_t i = 0; i < rows; ++i) {
    for (std::uint32_t j = 0; i + j < rows; ++j) {
      for (const float third : {1.0f, 2.0f}) {  // an upright part, and beside it an inverted one where the row has room
        if (third > 1 && i + j + 1 == rows) continue;
        const glm::vec2 place = (glm::vec2(i, j) + third / 3) / static_cast<float>(rows);
        const glm::vec3 inside = gpu::in_box(box, face.a + place.x * face.ab + place.y * face.ac);
        if (glm::any(glm::greaterThan(glm::abs(inside), box.half_size))) continue;
        sum += read(*map.slopes, gpu::in_picture(box, inside), texels, false);
      }
    }
  }
  const glm::vec2 slopes = map.strength / static_cast<float>(rows * rows) * sum;
  return slopes.x * box.right + slopes.y * box.up;
}

// As textured_normal of shaders/display/shading_normal.glsl, over a triangle of the display mesh as a whole.
glm::vec3 slope_by_mesh(const NormalMap& map, const DisplayMesh& mesh, const glm::uvec3& ids) {
  const Triangle here = triangle_of(mesh.vertices, ids), there = triangle_of(mesh.texture_places, ids);
  const glm::vec2 right(there.ab), below(there.ac);
  const float area = right.x * below.y - below.x * right.y;
  const glm::vec3 normal = glm::cross(here.ab, here.ac);
  const glm::vec3 along = (area < 0 ? -1.0f : 1.0f) * (below.y * here.ab - right.y * here.ac);
  const glm::vec3 place = there.a + (there.ab + there.ac) / 3.0f;
  if (place.z < 0.5f || area == 0 || glm::length(along) == 0 || glm::length(normal) == 0) return glm::vec3(0);
  const glm::vec2 texels(map.slopes->columns, map.slopes->rows);
  const float width = std::max(glm::length(texels * right), glm::length(texels * below));
  const glm::vec2 slopes = map.strength * read(*map.slopes, glm::vec2(place), width, true);
  const glm::vec3 unit = glm::normalize(along);
  glm::vec3 top = glm::cross(glm::normalize(normal), unit);
  if (area * glm::dot(top, right.x * here.ac - below.x * here.ab) > 0) top = -top;
  return slopes.x * unit + slopes.y * top;
}

// Of the finest level, the mean over the triangles that lie on each face.
Slopes slopes_by_mesh(const QuadGraph& graph, const NormalMap& map) {
  const DisplayMesh& mesh = graph.display();
  const Level& finest = graph.levels()[0];
  const std::vector<std::uint32_t> face_of = display_faces(mesh, finest);
  Slopes slopes(finest.faces.size(), glm::vec3(0));
  std::vector<float> area(finest.faces.size(), 0.0f);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const float own = triangle_of(mesh.vertices, mesh.triangles[t]).area();
    slopes[face_of[t]] += own * slope_by_mesh(map, mesh, mesh.triangles[t]);
    area[face_of[t]] += own;
  }
  for (std::size_t f = 0; f < slopes.size(); ++f) slopes[f] /= std::max(area[f], 1e-30f);
  return slopes;
}

// Of the faces of the next level, the mean over those that these are interpolated to.
Slopes coarser(const Level& level, const Slopes& slopes, std::size_t faces) {
  Slopes coarse(faces, glm::vec3(0));
  std::vector<float> all(faces, 0.0f);
  for (std::size_t k = 0; k < level.surface.index.size(); ++k) {
    const std::uint32_t to = level.surface.index[k];
    coarse[to] += level.surface.weight[k] * slopes[k / level.surface.width];
    all[to] += level.surface.weight[k];
  }
  for (std::size_t f = 0; f < faces; ++f) coarse[f] /= std::max(all[f], 1e-30f);
  return coarse;
}

std::vector<Slopes> all_slopes(const QuadGraph& graph, const NormalMap& map, bool own) {
  const std::vector<Level>& levels = graph.levels();
  std::vector<Slopes> all;
  if (own) {
    all.push_back(slopes_by_mesh(graph, map));
    while (all.size() < levels.size()) {
      all.push_back(coarser(levels[all.size() - 1], all.back(), levels[all.size()].faces.size()));
    }
    return all;
  }
  const gpu::ImageBox box = image_box(map.placement ? *map.placement : around(graph.display().vertices, graph.front()));
  for (const Level& level : levels) {
    Slopes& slopes = all.emplace_back();
    for (const glm::uvec3& ids : level.faces) {
      slopes.push_back(slope_in_box(map, box, triangle_of(level.vertices, ids)));
    }
  }
  return all;
}

}  // namespace

std::vector<std::vector<glm::vec2>> leaning_faces(const QuadGraph& graph, const NormalMap& map, bool own) {
  std::vector<std::vector<glm::vec2>> leaning;
  const std::vector<Slopes> slopes = all_slopes(graph, map, own);
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const Level& level = graph.levels()[i];
    auto& faces = leaning.emplace_back();
    for (std::size_t f = 0; f < slopes[i].size(); ++f) {
      const Triangle face = triangle_of(level.vertices, level.faces[f]);
      faces.emplace_back(glm::dot(slopes[i][f], face.ab), glm::dot(slopes[i][f], face.ac));
    }
  }
  return leaning;
}

}  // namespace quadgraph
