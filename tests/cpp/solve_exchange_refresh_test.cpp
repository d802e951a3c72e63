// What the faces see of each other, cast anew on the GPU when the shape changes, against brute force on the CPU.
#include <functional>
#include <set>

#include "engine/graph/error.h"
#include "engine/graph/face_tree.h"
#include "engine/solve/exchange_matrix.h"
#include "engine/solve/level_upload.h"
#include "tests/cpp/exchange_fixtures.h"
#include "tests/cpp/solve_fixtures.h"

using namespace quadgraph;

namespace {

constexpr std::uint32_t rays = 100;  // not a multiple of a workgroup

using Motion = std::function<glm::vec3(const glm::vec3&)>;

glm::vec3 turned(const glm::vec3& p) {
  const float c = std::cos(0.7f), s = std::sin(0.7f);
  const glm::vec3 q(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
  return glm::vec3(q.x, c * q.y - s * q.z, s * q.y + c * q.z) + glm::vec3(3, -7, 20);
}

// Bends two slabs towards each other at their ends.
glm::vec3 bent(const glm::vec3& p) {
  const float x = p.x - 5.0f;
  return p + glm::vec3(0, -(p.y > 0 ? 1.0f : -1.0f) * 0.03f * x * x, 0);
}

OwnedLevel moved(OwnedLevel level, const Motion& motion) {
  for (glm::vec3& p : level.vertices) p = motion(p);
  const auto& v = level.vertices;
  level.nodes.clear();
  for (const glm::uvec4& t : level.tets) level.nodes.push_back((v[t[0]] + v[t[1]] + v[t[2]] + v[t[3]]) / 4.0f);
  for (const glm::uvec3& f : level.faces) level.nodes.push_back((v[f.x] + v[f.y] + v[f.z]) / 3.0f);
  return level;
}

OwnedLevel baked(OwnedLevel level) {
  bake_seen(level, rays);
  return level;
}

// A matrix on the device.
struct Cast {
  CheckedContext device;
  OwnedLevel level;
  Level view;
  LevelBuffers buffers;
  Workspace work;
  ExchangeMatrix matrix;

  explicit Cast(OwnedLevel owned)
      : level(std::move(owned)),
        view(level.view()),
        buffers(upload_level(device.context, view, 0)),
        work(device.context, buffers.node_count),
        matrix(view) {
    matrix.make_room(device.context);
  }

  void move(const Motion& motion) {
    const OwnedLevel now = moved(level, motion);
    vk::write_bytes(device.context, buffers.vertices, std::as_bytes(std::span(now.vertices)));
    matrix.moved();
  }

  std::uint32_t refresh(std::uint32_t count = 0) {
    const std::uint32_t done = matrix.record_refresh(work, buffers, count);
    work.recorder.submit();
    return done;
  }

  // Every row ascending.
  std::vector<std::vector<std::uint32_t>> rows() {
    const auto entries = vk::download<std::uint32_t>(device.context, matrix.entries());
    std::vector<std::vector<std::uint32_t>> result;
    for (const glm::uvec2& row : vk::download<glm::uvec2>(device.context, matrix.rows())) {
      result.emplace_back(entries.begin() + row.x, entries.begin() + row.y);
      std::sort(result.back().begin(), result.back().end());
    }
    return result;
  }
};

std::vector<std::vector<std::uint32_t>> rows_of(const OwnedLevel& level) {
  std::vector<std::vector<std::uint32_t>> rows;
  for (std::size_t f = 0; f < level.faces.size(); ++f) {
    rows.emplace_back(level.seen.begin() + level.seen[f], level.seen.begin() + level.seen[f + 1]);
  }
  return rows;
}

// Entries of one that the other has not.
std::size_t differences(const std::vector<std::vector<std::uint32_t>>& a,
                        const std::vector<std::vector<std::uint32_t>>& b) {
  REQUIRE(a.size() == b.size());
  std::size_t count = 0;
  for (std::size_t f = 0; f < a.size(); ++f) {
    std::vector<std::uint32_t> apart;
    std::set_symmetric_difference(a[f].begin(), a[f].end(), b[f].begin(), b[f].end(), std::back_inserter(apart));
    count += apart.size();
  }
  return count;
}

// Rays that graze an edge go either way in single precision: of all rays, at most this share.
constexpr double grazing = 1e-3;

void check_same(Cast& cast, const OwnedLevel& expected) {
  const auto rows = rows_of(expected);
  std::size_t entries = 0;
  for (const auto& row : rows) entries += row.size();
  CHECK(entries > expected.faces.size() * rays / 20);
  const std::size_t apart = differences(cast.rows(), rows);
  MESSAGE("entries: ", entries, ", different: ", apart);
  CHECK(static_cast<double>(apart) <= grazing * static_cast<double>(expected.faces.size() * rays));
}

std::vector<OwnedLevel> shapes() {
  return {facing_slabs(3, 10.0f, 2.0f, 2.0f), shell_level(4, 2, 3.0, 5.0)};
}

}  // namespace

TEST_CASE("rays cast on the GPU for the shape of the bake find what the bake found") {
  for (const OwnedLevel& shape : shapes()) {
    Cast cast(baked(shape));
    CHECK(cast.refresh() == 0);
    check_same(cast, cast.level);
    CHECK(differences(cast.rows(), rows_of(cast.level)) == 0);  // as uploaded
    cast.move([](const glm::vec3& p) { return p; });
    CHECK(cast.refresh() == shape.faces.size());
    check_same(cast, cast.level);
  }
}

TEST_CASE("a rigid motion leaves what the faces see, a deformation makes it what a fresh bake finds") {
  for (const OwnedLevel& shape : shapes()) {
    Cast cast(baked(shape));
    cast.move(turned);
    cast.refresh();
    check_same(cast, cast.level);
    check_same(cast, baked(moved(shape, turned)));
  }
  Cast cast(baked(facing_slabs(4, 10.0f, 2.0f, 4.0f)));
  const OwnedLevel expected = baked(moved(cast.level, bent));
  CHECK(differences(rows_of(expected), rows_of(cast.level)) > expected.faces.size());
  cast.move(bent);
  cast.refresh();
  check_same(cast, expected);
}

TEST_CASE("rows refreshed some at a time come to the whole, and their age is known") {
  Cast whole(baked(facing_slabs(3, 10.0f, 2.0f, 4.0f))), parts(whole.level);
  const auto faces = static_cast<std::uint32_t>(whole.level.faces.size());
  whole.move(bent);
  whole.refresh();
  CHECK(whole.matrix.age() == 0);
  parts.refresh();
  parts.refresh();
  CHECK(parts.matrix.age() == 0);
  parts.move(bent);
  const std::uint32_t count = 50, solves = (faces + count - 1) / count;
  std::size_t before = differences(parts.rows(), whole.rows());
  CHECK(before > 0);
  for (std::uint32_t solve = 1; solve < solves; ++solve) {
    CHECK(parts.refresh(count) == count);
    CHECK(parts.matrix.age() == solve);
    const std::size_t now = differences(parts.rows(), whole.rows());
    CHECK(now <= before);
    before = now;
  }
  CHECK(parts.refresh(count) == faces - count * (solves - 1));
  CHECK(parts.matrix.age() == 0);
  CHECK(parts.rows() == whole.rows());
  CHECK(parts.refresh(count) == 0);
  // In motion the oldest rows come first, and no row is older than a round.
  for (std::uint32_t solve = 1; solve < 3 * solves; ++solve) {
    parts.move(bent);
    parts.refresh(count);
    CHECK(parts.matrix.age() == std::min(solve, solves - 1));
  }
}

TEST_CASE("every face is in the tree once, in leaves of at most four") {
  const OwnedLevel shape = shell_level(5, 2, 3.0, 5.0);
  const FaceTree tree = face_tree(shape.view());
  CHECK(std::set(tree.order.begin(), tree.order.end()).size() == shape.faces.size());
  CHECK(tree.order.size() == shape.faces.size());
  CHECK((tree.leaves() & (tree.leaves() - 1)) == 0);
  CHECK(tree.leaf_begin.front() == 0);
  CHECK(tree.leaf_begin.back() == shape.faces.size());
  for (std::uint32_t j = 0; j < tree.leaves(); ++j) {
    CHECK(tree.leaf_begin[j + 1] >= tree.leaf_begin[j]);
    CHECK(tree.leaf_begin[j + 1] - tree.leaf_begin[j] <= 4);
  }
}

namespace {

struct Body {
  CheckedContext device;
  QuadGraph graph;
  Simulation simulation;
  glm::vec3 down{0, -1, 0};

  explicit Body(const std::vector<OwnedLevel>& levels)
      : graph(QuadGraph::parse(graph_of(levels), "body")), simulation(device.context, graph) {
    simulation.set_material(veined());
  }

  void move(const Motion& motion) {
    for (std::uint32_t i = 0; i < simulation.level_count(); ++i) {
      std::vector<glm::vec3> positions;
      for (const glm::vec3& p : graph.levels()[i].vertices) positions.push_back(motion(p));
      simulation.set_vertices(i, positions);
    }
  }

  // Light on what is the upper side of the slabs at rest, straight from above. (Lambertian light would not do: its rays
  // do not turn with the body.)
  void light() {
    for (std::uint32_t i = 0; i < simulation.level_count(); ++i) {
      const Level& level = graph.levels()[i];
      std::vector<glm::vec3> q;
      for (std::uint32_t f = 0; f < level.face_count(); ++f) {
        q.emplace_back(level.nodes[level.tet_count() + f].y > 3.99f ? 1.0f : 0.0f);
      }
      simulation.set_irradiance(i, q, down);
    }
  }

  SurfaceField solve(const SolveOptions& options) {
    light();
    const SolveReport report = simulation.solve(options);
    CHECK(report.inter_reflection);
    CHECK(report.energy.re_entered.x > 0.01 * report.energy.entered.x);
    for (int c = 0; c < 3; ++c) CHECK(std::abs(report.energy.balance()[c]) < 1e-4);
    return simulation.surface_field();
  }
};

const std::vector<OwnedLevel>& two_levels() {
  static const std::vector<OwnedLevel> levels = {facing_slabs(3, 10.0f, 2.0f, 4.0f),
                                                 baked(facing_slabs(2, 10.0f, 2.0f, 4.0f))};
  return levels;
}

SolveOptions accurate(Method method) {
  return {.method = method, .model = Model::diffusion, .tolerance = 1e-6};
}

}  // namespace

TEST_CASE("a body whose vertices have moved answers as one baked in that shape") {
  const OwnedLevel shape = two_levels()[1];  // alone: transfers stay those of the rest
  for (const Method method : {Method::fem, Method::quadgraph_fv}) {
    CAPTURE(name_of(method));
    Body body({shape});
    const SurfaceField rest = body.solve(accurate(method));
    body.move([](const glm::vec3& p) { return p; });
    CHECK(relative_difference(body.solve(accurate(method)).exitance, rest.exitance) < 1e-4);
    body.move(turned);
    body.down = turned({0, -1, 0}) - turned({0, 0, 0});
    CHECK(relative_difference(body.solve(accurate(method)).exitance, rest.exitance) < 1e-4);
    body.move(bent);
    body.down = {0, -1, 0};
    const SurfaceField found = body.solve(accurate(method));
    CHECK(relative_difference(found.exitance, rest.exitance) > 1e-2);

    // The same shape from its own file. Its material stands still, so it gets that of the nodes at rest.
    Body fresh({baked(moved(shape, bent))});
    fresh.simulation.set_optical(0, evaluate_material(body.graph.levels()[0], veined()), veined().eta);
    fresh.simulation.set_irradiance(0, vk::download<glm::vec3>(body.device.context, body.simulation.level(0).q),
                                    body.down);
    fresh.simulation.solve(accurate(method));
    const SurfaceField expected = fresh.simulation.surface_field();
    CHECK(relative_difference(found.position, expected.position) < 1e-6);
    CHECK(relative_difference(found.exitance, expected.exitance) < 1e-4);
  }
}

TEST_CASE("in motion the matrix is refreshed in parts, and comes to rest with the body") {
  Body body(two_levels());
  body.move(bent);
  SolveOptions options = accurate(Method::fem);
  const SurfaceField expected = body.solve(options);
  CHECK(pass_count(body.simulation, "exchange rays") == 1);
  body.move([](const glm::vec3& p) { return p; });
  body.solve(options);
  body.move(bent);
  options.exchange_rows = 40;
  options.bounces = 1;
  body.light();
  std::uint32_t solves = 0;
  while (body.simulation.solve(options).exchange_age > 0) REQUIRE(++solves < 100);
  CHECK(solves == (two_levels()[1].faces.size() - 1) / 40);
  for (int k = 0; k < 6; ++k) body.simulation.solve(options);
  CHECK(pass_count(body.simulation, "exchange rays") == 0);
  CHECK(relative_difference(body.simulation.surface_field().exitance, expected.exitance) < 1e-4);
}

TEST_CASE("positions that make no body are refused, and nothing moves") {
  Body body(two_levels());
  const Level& level = body.graph.levels()[0];
  const std::vector<glm::vec3> good(level.vertices.begin(), level.vertices.end());
  const auto refused = [&](std::uint32_t number, const std::vector<glm::vec3>& positions, const char* word) {
    CHECK_THROWS_WITH_AS(body.simulation.set_vertices(number, positions), doctest::Contains(word), InputError);
  };
  refused(2, good, "there are 2");
  refused(0, {good.begin(), good.end() - 1}, "one for each");
  std::vector<glm::vec3> bad = good;
  bad[3].y = std::numeric_limits<float>::quiet_NaN();
  refused(0, bad, "vertex 3");
  bad = good;
  for (glm::vec3& p : bad) p.z = -p.z;
  refused(0, bad, "tet 0");
  CHECK(vk::download<glm::vec3>(body.device.context, body.simulation.level(0).vertices) == good);
}
