#include "engine/render/inside/inside.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

constexpr double decades = 1e3;                          // of a logarithmic bar
constexpr double brightest_quantile = 0.995;             // a few elements at sharp edges are far above the rest
constexpr double least_percent = 1, most_percent = 100;  // of deviations, the same for all bodies

const std::string power_unit = "W/mm²";

float mean(const glm::vec3& rgb) {
  return (rgb.x + rgb.y + rgb.z) / 3;
}

std::vector<float> means(const std::vector<glm::vec3>& values) {
  std::vector<float> result;
  for (const glm::vec3& value : values) result.push_back(mean(value));
  return result;
}

double quantile(std::vector<float> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return static_cast<double>(*at);
}

Legend legend_of(const std::string& title, const std::string& unit, const std::vector<float>& values,
                 bool logarithmic) {
  const double high = std::max(quantile(values, brightest_quantile), 1e-12);
  return {
      .title = title, .unit = unit, .low = logarithmic ? high / decades : 0, .high = high, .logarithmic = logarithmic};
}

std::vector<float> placed(const Legend& legend, const std::vector<float>& values) {
  std::vector<float> places;
  for (const float value : values) places.push_back(legend.place(static_cast<double>(value)));
  return places;
}

const Level& level_of(const InsideInput& input, std::uint32_t number) {
  const auto& levels = input.graph.levels();
  if (number >= levels.size()) {
    throw InputError("show, level: found " + std::to_string(number) + ", expected 0 to " +
                     std::to_string(levels.size() - 1));
  }
  return levels[number];
}

// In the present shape.
std::vector<glm::vec3> vertices_of(const InsideInput& input, std::uint32_t level) {
  return device::download<glm::vec3>(input.device, input.simulation.level(level).vertices);
}

Plane plane_of(const InsideInput& input, const Show& show) {
  glm::vec3 normal(0);
  normal[show.axis] = 1;
  const float height = glm::dot(normal, input.bounds.centre) + show.offset;
  if (glm::dot(normal, glm::vec3(input.eye)) < input.eye.w * height) return {-normal, -height};
  return {normal, height};
}

// The surface behind the cut, so that one sees what has been cut.
void add_rest(const InsideInput& input, FalseMesh& mesh) {
  const Level& level = input.graph.levels()[0];
  const auto vertices = vertices_of(input, 0);
  add_faces(mesh, vertices, level.faces, std::vector<float>(level.face_count(), 0.0f),
            gpu::FALSE_PLAIN | gpu::FALSE_SHADED | gpu::FALSE_BEHIND);
}

Inside surface(const InsideInput& input, const Legend& legend, const std::vector<float>& values) {
  Inside inside{.legend = legend};
  add_faces(inside.mesh, vertices_of(input, 0), input.graph.levels()[0].faces, placed(legend, values),
            gpu::FALSE_SHADED);
  return inside;
}

std::vector<float> exitance_of(const SurfaceField& field) {
  std::vector<float> values = means(field.exitance);
  for (std::size_t f = 0; f < values.size(); ++f) values[f] += mean(field.unscattered[f]);
  return values;
}

double weighted(const std::vector<float>& values, const std::vector<float>& area, int power) {
  double sum = 0, total = 0;
  for (std::size_t f = 0; f < values.size(); ++f) {
    const auto a = static_cast<double>(area[f]);
    sum += a * std::pow(static_cast<double>(values[f]), power);
    total += a;
  }
  return sum / total;
}

// Where the two finest levels differ, scaled to the error that is estimated of the whole: the estimate says how much,
// the difference where.
Inside error(const InsideInput& input) {
  if (!input.report.error || input.report.finest != 0 || input.graph.levels().size() < 2) {
    throw InputError(
        "show error: the error of a single level, or of a coarse one with a target, is not known by place");
  }
  const SurfaceField field = input.simulation.surface_field();
  const std::vector<glm::vec3> coarse = input.simulation.exitance_on(1);
  const Transfer& carry = input.graph.levels()[0].surface;
  std::vector<float> scattered = means(field.exitance), values;
  for (std::size_t f = 0; f < field.area.size(); ++f) {
    float carried = 0;
    for (std::size_t k = f * carry.width; k < (f + 1) * carry.width; ++k) {
      carried += carry.weight[k] * mean(coarse[carry.index[k]]);
    }
    values.push_back(std::abs(scattered[f] - carried));
  }
  const double size = std::sqrt(weighted(scattered, field.area, 2)),
               difference = std::sqrt(weighted(values, field.area, 2));
  const double scale = 100 * input.report.error->whole * size / std::max(difference, 1e-300) /
                       std::max(weighted(scattered, field.area, 1), 1e-300);
  for (float& value : values) value *= static_cast<float>(scale);
  return surface(input, legend_of("estimated error of the exitance", "% of its mean", values, true), values);
}

Inside difference(const InsideInput& input, const Show& show) {
  const SurfaceField ours = input.simulation.surface_field();
  SolveOptions options = input.options;
  options.method = show.other;
  options.error = 0;
  if (show.other != Method::fem) options.solver = symmetric(show.other) ? SolverKind::dpcg : SolverKind::cascade;
  if (published(show.other)) options.source = Source::diffuse;
  options.warm = false;
  options.cycles = 0;
  options.active_layers = 0;
  input.simulation.solve(options);
  std::vector<float> values = exitance_of(input.simulation.surface_field());
  input.simulation.solve(input.options);
  const std::vector<float> own = exitance_of(ours);
  const double size = std::max(weighted(own, ours.area, 1), 1e-300);
  std::vector<float> sizes;
  for (std::size_t f = 0; f < values.size(); ++f) {
    values[f] = static_cast<float>(100 * static_cast<double>(values[f] - own[f]) / size);
    sizes.push_back(std::abs(values[f]));
  }
  const double most = std::max(quantile(sizes, 0.98), 1e-6);
  const Legend legend{.title = "exitance by " + std::string(name_of(show.other)) + " less that by " +
                               std::string(name_of(input.report.method)),
                      .unit = "% of the mean",
                      .low = -most,
                      .high = most,
                      .diverging = true};
  return surface(input, legend, values);
}

float edge_length(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return (glm::distance(a, b) + glm::distance(b, c) + glm::distance(c, a)) / 3;
}

std::string level_text(std::uint32_t number, std::uint32_t count, const char* what) {
  return "level " + std::to_string(number) + ", " + std::to_string(count) + " " + what;
}

Inside level_surface(const InsideInput& input, const Show& show) {
  const Level& level = level_of(input, show.level);
  const auto vertices = vertices_of(input, show.level);
  std::vector<float> lengths;
  for (const glm::uvec3& f : level.faces) lengths.push_back(edge_length(vertices[f.x], vertices[f.y], vertices[f.z]));
  Inside inside{.legend =
                    legend_of(level_text(show.level, level.face_count(), "faces: their edges"), "mm", lengths, false)};
  add_faces(inside.mesh, vertices, level.faces, placed(inside.legend, lengths),
            gpu::FALSE_SHADED | gpu::FALSE_EDGE | gpu::FALSE_EDGE << 1 | gpu::FALSE_EDGE << 2);
  return inside;
}

// Of values at the vertices of level 0.
Inside vertices_on_plane(const InsideInput& input, const Show& show, const Legend& legend,
                         const std::vector<float>& values) {
  const Level& level = input.graph.levels()[0];
  Inside inside{.legend = legend, .plane = plane_of(input, show)};
  const std::vector<float> places = placed(legend, values);
  add_cuts(inside.mesh, vertices_of(input, 0), level.tets, inside.plane, false, [&](std::uint32_t t) {
    const glm::uvec4& tet = level.tets[t];
    return glm::vec4(places[tet.x], places[tet.y], places[tet.z], places[tet.w]);
  });
  add_rest(input, inside.mesh);
  return inside;
}

Inside knowledge_on_plane(const InsideInput& input, const Show& show) {
  const std::string_view name = name_of(show.quantity);
  const Knowledge knowledge = *knowledge_of(show.quantity);
  std::vector<float> values = input.certainty.of(knowledge);
  const bool length = is_length(knowledge);
  if (values.empty()) {
    throw InputError("show " + std::string(name) + ": no " + (length ? "resolution lengths" : "deviations") +
                     " in this material; those that 'quadgraph acquire" + (length ? " --volume'" : "'") +
                     " writes (.npz) have them");
  }
  const std::string of(name.starts_with("sigma_a") ? "sigma_a" : "sigma_s'");
  if (length) {
    // From the best resolved places on to what is no better known than the body as a whole.
    const double whole = 2 * static_cast<double>(input.bounds.radius);
    const Legend legend{.title = "resolution length of " + of,
                        .unit = "mm",
                        .low = std::clamp(quantile(values, 1 - brightest_quantile), 1e-3 * whole, 0.9 * whole),
                        .high = whole,
                        .logarithmic = true};
    return vertices_on_plane(input, show, legend, values);
  }
  for (float& value : values) value *= 100;
  const Legend legend{.title = "standard deviation of " + of,
                      .unit = "%",
                      .low = least_percent,
                      .high = most_percent,
                      .logarithmic = true};
  return vertices_on_plane(input, show, legend, values);
}

// Per carrier: at the vertices for elements, else at the nodes, those inside the tets first.
Inside phi_on_plane(const InsideInput& input, const Show& show) {
  if (input.report.finest != 0) throw InputError("show phi: with an error as target the finest level was not solved");
  const Level& level = input.graph.levels()[0];
  const std::vector<float> phi = means(input.simulation.phi());
  const Legend legend = legend_of("fluence φ", power_unit, phi, true);
  if (on_vertices(input.report.method)) return vertices_on_plane(input, show, legend, phi);
  Inside inside{.legend = legend, .plane = plane_of(input, show)};
  const std::vector<float> places = placed(legend, phi);
  add_cuts(inside.mesh, vertices_of(input, 0), level.tets, inside.plane, false,
           [&](std::uint32_t t) { return glm::vec4(places[t]); });
  add_rest(input, inside.mesh);
  return inside;
}

float edge_length(const std::vector<glm::vec3>& vertices, const glm::uvec4& tet) {
  float sum = 0;
  for (int a = 0; a < 4; ++a) {
    for (int b = a + 1; b < 4; ++b) sum += glm::distance(vertices[tet[a]], vertices[tet[b]]);
  }
  return sum / 6;
}

Inside tets_on_plane(const InsideInput& input, const Show& show) {
  const Level& level = level_of(input, show.level);
  const auto vertices = vertices_of(input, show.level);
  std::vector<float> lengths;
  for (const glm::uvec4& tet : level.tets) lengths.push_back(edge_length(vertices, tet));
  Inside inside{
      .legend = legend_of(level_text(show.level, level.tet_count(), "tets: their edges"), "mm", lengths, false),
      .plane = plane_of(input, show)};
  const std::vector<float> places = placed(inside.legend, lengths);
  add_cuts(inside.mesh, vertices, level.tets, inside.plane, true,
           [&](std::uint32_t t) { return glm::vec4(places[t]); });
  add_rest(input, inside.mesh);
  return inside;
}

// A line from `a` to `b` as a strip that faces the eye, thinner than the tets are wide.
void add_line(FalseMesh& mesh, const glm::vec3& a, const glm::vec3& b, const glm::vec4& eye, float width,
              const glm::vec2& values) {
  const glm::vec3 across = glm::cross(b - a, gpu::towards_eye(eye, a));
  const float length = glm::length(across);
  if (!(length > 0)) return;
  const glm::vec3 side = (0.5f * width / length) * across;
  add_triangle(mesh, {a - side, b - side, b + side}, {values.x, values.y, values.y}, 0);
  add_triangle(mesh, {a - side, b + side, a + side}, {values.x, values.y, values.x}, 0);
}

// A small diamond that faces the eye.
void add_dot(FalseMesh& mesh, const glm::vec3& at, const glm::vec4& eye, float width, float value) {
  const glm::vec3 towards = gpu::towards_eye(eye, at);
  const glm::vec3 other = std::abs(towards.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::vec3 right = 0.5f * width * glm::normalize(glm::cross(other, towards));
  const glm::vec3 up = 0.5f * width * glm::normalize(glm::cross(towards, right));
  const glm::vec3 lifted = at + 0.05f * width * towards;
  add_triangle(mesh, {lifted - right, lifted - up, lifted + right}, {value, value, value}, 0);
  add_triangle(mesh, {lifted - right, lifted + right, lifted + up}, {value, value, value}, 0);
}

// Nodes in their tets and on their faces, in the present shape.
std::vector<glm::vec3> nodes_of(const Level& level, const std::vector<glm::vec3>& vertices) {
  std::vector<glm::vec3> nodes;
  for (const glm::uvec4& t : level.tets) {
    nodes.push_back(0.25f * (vertices[t.x] + vertices[t.y] + vertices[t.z] + vertices[t.w]));
  }
  for (const glm::uvec3& f : level.faces) nodes.push_back((vertices[f.x] + vertices[f.y] + vertices[f.z]) / 3.0f);
  return nodes;
}

// Nodes of the tets that the plane cuts, and their links to all neighbours behind the plane or on it.
Inside links_at_plane(const InsideInput& input, const Show& show) {
  const Level& level = level_of(input, show.level);
  const auto vertices = vertices_of(input, show.level);
  const std::vector<glm::vec3> nodes = nodes_of(level, vertices);
  const Plane plane = plane_of(input, show);
  std::vector<float> lengths;
  std::vector<std::uint32_t> cut;
  for (std::uint32_t t = 0; t < level.tet_count(); ++t) {
    const glm::uvec4& tet = level.tets[t];
    if (cut_of({vertices[tet.x], vertices[tet.y], vertices[tet.z], vertices[tet.w]}, plane).count == 0) continue;
    cut.push_back(t);
    for (int k = 0; k < 4; ++k) lengths.push_back(glm::distance(nodes[t], nodes[level.links[t][k]]));
  }
  Inside inside{
      .legend = legend_of(level_text(show.level, level.node_count(), "nodes: their links"), "mm", lengths, false),
      .plane = plane};
  const auto width = static_cast<float>(0.12 * quantile(lengths, 0.5));
  for (std::size_t i = 0; i < cut.size(); ++i) {
    const glm::vec3& here = nodes[cut[i]];
    for (int k = 0; k < 4; ++k) {
      const float place = inside.legend.place(static_cast<double>(lengths[4 * i + static_cast<std::size_t>(k)]));
      add_line(inside.mesh, here, nodes[level.links[cut[i]][k]], input.eye, width, glm::vec2(place));
    }
    add_dot(inside.mesh, here, input.eye, 3.5f * width, 1.0f);
  }
  add_rest(input, inside.mesh);
  return inside;
}

}  // namespace

Inside inside_of(const InsideInput& input, const Show& show) {
  switch (show.quantity) {
    case Quantity::q: {
      const std::vector<float> q = means(input.simulation.surface_field().q);
      return surface(input, legend_of("irradiance that enters, q", power_unit, q, false), q);
    }
    case Quantity::exitance: {
      const std::vector<float> exitance = exitance_of(input.simulation.surface_field());
      return surface(input, legend_of("exitance", power_unit, exitance, true), exitance);
    }
    case Quantity::error:
      return error(input);
    case Quantity::difference:
      return difference(input, show);
    case Quantity::levels:
      return level_surface(input, show);
    case Quantity::phi:
      return phi_on_plane(input, show);
    case Quantity::tets:
      return tets_on_plane(input, show);
    case Quantity::links:
      return links_at_plane(input, show);
    case Quantity::sigma_s_prime_deviation:
    case Quantity::sigma_a_deviation:
    case Quantity::sigma_s_prime_resolution:
    case Quantity::sigma_a_resolution:
      return knowledge_on_plane(input, show);
    case Quantity::picture:
      break;
  }
  throw InputError("show: a picture is not a view of the inside");
}

}  // namespace quadgraph
