#include "engine/scene/harmonic_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "engine/base/all_cores.h"
#include "engine/base/error.h"
#include "engine/file/geometry.h"
#include "engine/reference/tet_locator.h"
#include "engine/scene/harmonic.h"

namespace quadgraph {
namespace {

constexpr double map_tolerance = 1e-12;
constexpr int most_rounds = 3000;  // of a sphere

using Places = std::vector<glm::dvec3>;

// Where the vertices of the body lie once its box is the source's.
Places fitted(const SourceDomain& source, const BodySurface& body) {
  const glm::dvec3 fit = source.fit(body);
  Places places;
  for (const glm::vec3& vertex : body.level().vertices) {
    places.push_back(source.middle() + (glm::dvec3(vertex) - body.middle()) * fit);
  }
  return places;
}

std::size_t turned_faces(const Level& level, const Places& on_sphere) {
  return static_cast<std::size_t>(std::count_if(level.faces.begin(), level.faces.end(), [&](const glm::uvec3& f) {
    return glm::dot(on_sphere[f.x], glm::cross(on_sphere[f.y], on_sphere[f.z])) <= 0;
  }));
}

// Vertices of the surface on the unit sphere: as they are seen from the middle, and where folds of the surface lie
// behind each other moved to the mean of those around until none does.
Places on_sphere(const Level& level, const Places& places, const glm::dvec3& middle) {
  const std::uint32_t count = level.surface_vertex_count;
  Places found(count);
  for (std::uint32_t v = 0; v < count; ++v) found[v] = unit(places[v] - middle);
  for (int round = 0; round < most_rounds && turned_faces(level, found) > 0; ++round) {
    Places sums(count, glm::dvec3(0));
    for (const glm::uvec3& f : level.faces) {
      for (int k = 0; k < 3; ++k) sums[f[k]] += found[f[(k + 1) % 3]];  // every edge once from each end
    }
    glm::dvec3 mean(0);
    for (std::uint32_t v = 0; v < count; ++v) {
      const double length = glm::length(sums[v]);
      if (length > 0) found[v] = sums[v] / length;
      mean += found[v] / static_cast<double>(count);
    }
    for (glm::dvec3& place : found) place = unit(place - mean);  // else all would gather in one point
  }
  return found;
}

// Onto the faces of the block, along rays from its middle.
void onto_block(const SourceDomain& source, const Level& level, Places& places) {
  const Places directions = on_sphere(level, places, source.middle());
  const glm::dvec3 half = 0.5 * source.size();
  for (std::size_t v = 0; v < directions.size(); ++v) {
    const glm::dvec3 share = glm::abs(directions[v]) / half;
    places[v] = source.middle() + directions[v] / std::max({share.x, share.y, share.z});
  }
}

void onto_body(const BodySurface& surface, std::uint32_t count, Places& places) {
  on_all_cores(count, [&](std::size_t v) { places[v] = surface.find(places[v]).point; });
}

// Gradients of the four linear functions of a tet, 1/mm, times six times its volume.
std::array<glm::dvec3, 4> gradients(const Level& level, const glm::uvec4& tet) {
  std::array<glm::dvec3, 4> found{};
  for (int k = 0; k < 4; ++k) found[static_cast<std::size_t>(k)] = -face_vector(level, outward_face(tet, k));
  return found;
}

// Linear elements' own weights, by which a map that is linear is harmonic.
WeightedGraph elements_graph(const Level& level) {
  std::vector<std::array<double, 2>> edges;  // the two ends as one number, and a weight
  const double count = level.vertex_count();
  for (const glm::uvec4& tet : level.tets) {
    const std::array<glm::dvec3, 4> along = gradients(level, tet);
    const double volume = tet_determinant(level, tet);
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        if (a == b) continue;
        const double weight = -glm::dot(along[static_cast<std::size_t>(a)], along[static_cast<std::size_t>(b)]);
        edges.push_back({tet[a] * count + tet[b], weight / volume});
      }
    }
  }
  std::sort(edges.begin(), edges.end());
  WeightedGraph graph;
  graph.begin.assign(level.vertices.size() + 1, 0);
  double last = -1;
  for (const auto& [ends, weight] : edges) {
    if (ends == last) {
      graph.weight.back() += weight;
      continue;
    }
    last = ends;
    const double from = std::floor(ends / count);
    graph.to.push_back(static_cast<std::uint32_t>(ends - from * count));
    graph.weight.push_back(weight);
    graph.begin[static_cast<std::size_t>(from) + 1] = graph.to.size();
  }
  for (std::size_t v = 1; v < graph.begin.size(); ++v) graph.begin[v] = std::max(graph.begin[v], graph.begin[v - 1]);
  return graph;
}

void fill_inside(const Level& level, Places& places) {
  const WeightedGraph graph = elements_graph(level);
  std::vector<char> fixed(places.size(), 0);
  std::fill_n(fixed.begin(), level.surface_vertex_count, char{1});
  on_all_cores(3, [&](std::size_t axis) {
    std::vector<double> values;
    for (const glm::dvec3& place : places) values.push_back(place[static_cast<int>(axis)]);
    make_harmonic(graph, fixed, values, map_tolerance);
    for (std::size_t v = 0; v < values.size(); ++v) places[v][static_cast<int>(axis)] = values[v];
  });
}

glm::dmat3 edges_of(const glm::uvec4& tet, const auto& vertices) {
  const glm::dvec3 first(vertices[tet[0]]);
  return {glm::dvec3(vertices[tet[1]]) - first, glm::dvec3(vertices[tet[2]]) - first,
          glm::dvec3(vertices[tet[3]]) - first};
}

void measure(const Level& level, const Places& places, int axes, MapReport& report) {
  StretchCount count(axes);
  for (const glm::uvec4& tet : level.tets) {
    const glm::dmat3 there = edges_of(tet, places);
    if (glm::determinant(there) <= 0) ++report.flipped_tets;
    count.add(there * glm::inverse(edges_of(tet, level.vertices)), tet_volume(level, tet));
  }
  report.tets = level.tets.size();
  report.stretch = count.percentiles();
}

// Linear in every tet, and outside in the one at the nearest face.
class TetMap {
 public:
  TetMap(const BodySurface& body, const Places& places)
      : body_(body), level_(body.level()), locator_(level_), places_(places) {}

  glm::dvec3 at(const glm::dvec3& point) const {
    const auto found = locator_.find(point);  // whose own coordinates are held within the tet
    const glm::uvec4& tet = level_.tets[found ? found->tet : level_.face_tets[body_.find(point).face]];
    const glm::dvec3 w = glm::inverse(edges_of(tet, level_.vertices)) * (point - glm::dvec3(level_.vertices[tet[0]]));
    return mixed(tet, {1 - w.x - w.y - w.z, w.x, w.y, w.z});
  }

 private:
  glm::dvec3 mixed(const glm::uvec4& tet, const glm::dvec4& weights) const {
    glm::dvec3 sum(0);
    for (int k = 0; k < 4; ++k) sum += weights[k] * places_[tet[k]];
    return sum;
  }

  const BodySurface& body_;
  const Level& level_;
  TetLocator locator_;
  const Places& places_;
};

std::string handles_text(const BodySurface::Topology& found) {
  return std::to_string(found.pieces) + " piece(s) with " + std::to_string(found.handles) + " handle(s)";
}

void check_topology(const SourceDomain& source, const BodySurface& body) {
  if (body.level().tets.empty()) {
    throw InputError("map: volume: found a body without tets, allowed is one that was baked; or take box or shell");
  }
  if (source.axes() < 3) {
    throw InputError(
        "map: volume: found a volume of one cell along an axis, allowed are two or more along each; take "
        "box or shell");
  }
  const BodySurface::Topology found = body.topology(), wanted = source.surface()
                                                                    ? source.surface()->topology()
                                                                    : BodySurface::Topology{.handles = 0, .pieces = 1};
  if (found.handles != wanted.handles || found.pieces != wanted.pieces) {
    throw InputError("map: volume: found a body of " + handles_text(found) + ", allowed is that of the source, " +
                     handles_text(wanted) + ": no map without a tear joins them; take box or shell");
  }
}

}  // namespace

MappedVolume harmonically_mapped(const SourceDomain& source, const BodySurface& body) {
  check_topology(source, body);
  const Level& level = body.level();
  Places places = fitted(source, body);
  if (source.surface()) {
    onto_body(*source.surface(), level.surface_vertex_count, places);
  } else {
    onto_block(source, level, places);
  }
  fill_inside(level, places);
  MappedVolume made;
  measure(level, places, source.axes(), made.report);
  const TetMap tets(body, places);
  const glm::dvec3 fit = 1.0 / source.fit(body);
  const CellGrid grid =
      grid_around(body.low(), body.high(), body.middle() + fit * (source.cells().low() - source.middle()),
                  fit * source.cells().grid().spacing, made.report.coarser);
  const std::size_t channels = source.cells().channels();
  std::vector<float> values(grid.count() * channels, 0);
  on_all_cores(grid.count(), [&](std::size_t cell) {
    source.cells().add(tets.at(grid.place(cell)), 1, std::span(values).subspan(cell * channels, channels));
  });
  made.volume = source.cells().volume_of(grid, values, std::cbrt(fit.x * fit.y * fit.z));
  return made;
}

}  // namespace quadgraph
