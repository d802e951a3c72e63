// What the faces see of each other, cast anew on the GPU when the shape changes, against brute force on the CPU.
#include <set>

#include "engine/file/face_tree.h"
#include "engine/solve/exchange_matrix.h"
#include "engine/solve/level_upload.h"
#include "tests/cpp/fixtures/exchange_fixtures.h"
#include "tests/cpp/fixtures/one_body.h"
#include "tests/cpp/fixtures/solve_fixtures.h"

using namespace quadgraph;

namespace {

// A matrix on the device.
struct Cast {
  CheckedContext device;
  OwnedLevel level;
  Level view;
  OneBody refractions{device.context, 1};
  LevelBuffers buffers;
  Workspace work;
  ExchangeMatrix matrix;

  explicit Cast(OwnedLevel owned)
      : level(std::move(owned)),
        view(level.view()),
        buffers(upload_level(device.context, view, 0, refractions)),
        work(device.context, buffers.node_count),
        matrix(view) {
    matrix.make_room(device.context);
  }

  void move(const Motion& motion) {
    const OwnedLevel now = moved(level, motion);
    device::write_bytes(device.context, buffers.vertices, std::as_bytes(std::span(now.vertices)));
    matrix.moved();
  }

  std::uint32_t refresh(std::uint32_t count = 0) {
    const std::uint32_t done = matrix.record_refresh(work, buffers, count);
    work.recorder.submit();
    return done;
  }

  // Every row ascending.
  std::vector<std::vector<std::uint32_t>> rows() {
    const auto entries = device::download<std::uint32_t>(device.context, matrix.entries());
    std::vector<std::vector<std::uint32_t>> result;
    for (const glm::uvec2& row : device::download<glm::uvec2>(device.context, matrix.rows())) {
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
  CHECK(entries > expected.faces.size() * baked_rays / 20);
  const std::size_t apart = differences(cast.rows(), rows);
  MESSAGE("entries: ", entries, ", different: ", apart);
  CHECK(static_cast<double>(apart) <= grazing * static_cast<double>(expected.faces.size() * baked_rays));
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
