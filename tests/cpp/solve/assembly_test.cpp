// The rows and right-hand sides that the shaders assemble are those of the CPU.
#include "engine/solve/assembly.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "engine/file/geometry.h"
#include "engine/reference/operator.h"
#include "engine/solve/level_upload.h"
#include "engine/solve/row_structure.h"
#include "shaders/assemble/assembly_shared.h"
#include "shaders/solver/packing.h"
#include "tests/cpp/fixtures/one_body.h"
#include "tests/cpp/fixtures/solve_fixtures.h"

using namespace quadgraph;

namespace {

// Single precision: a weight is a sum over up to some ten elements, each from differences of coordinates and a
// quotient of products; measured against the diagonal of its row.
constexpr double row_tolerance = 2e-6;

// The veined material, with every seventh face a wall.
struct Assembled {
  CheckedContext device;
  OwnedLevel owned = split_at_corners(box_level(3, 6.0f, 0.15f));
  Level level;
  std::vector<gpu::Optical> optical;
  Problem problem;
  OneBody refractions;
  LevelBuffers buffers;
  LevelElements elements{0};
  OperatorBuffers op;
  Workspace work;

  // `even`: the homogeneous material instead.
  Assembled(Method method, Model model, bool even = false)
      : level(with_walls(owned)),
        optical(evaluate_material(level, even ? homogeneous() : veined())),
        problem{method, Source::diffuse, model, optical, veined().eta},
        refractions(device.context, veined().eta),
        buffers(upload_level(device.context, level, 0, refractions)),
        op(device.context, level, elements, 0, method, model, format_of(level, method)),
        work(device.context, level.node_count()) {
    upload_graph(device.context, level, 0, buffers);
    buffers.optical = device::upload<gpu::Optical>(device.context, optical, "optical");
    op.make_room(device.context, level, even, false);
    record_assembly(work, buffers, method, boundaries(), even, op);
    work.recorder.submit();
  }

  const BodyBoundaries& boundaries() { return refractions.boundaries(problem.method, problem.source, problem.model); }

  static Level with_walls(OwnedLevel& owned) {
    for (std::size_t f = 0; f < owned.faces.size(); ++f) {
      owned.face_kinds.push_back(f % 7 == 0 ? face_reflecting : face_open);
    }
    return owned.view();
  }

  template <typename T>
  std::vector<T> get(const device::Buffer& buffer) {
    return device::download<T>(device.context, buffer);
  }

  std::vector<StoredEntry> entries() {
    const auto words = get<std::uint32_t>(op.entry);
    std::vector<StoredEntry> result;
    for (std::size_t e = 0; e < op.entries; ++e) result.push_back(stored_entry(words, e, op.model, op.stored));
    return result;
  }

  // The blocks of rows that are stored as one record (shaders/solver/stored_rows.glsl).
  std::vector<Block> compact(double masses, double area, bool stiffness) {
    const auto v = get<float>(op.row_sum);
    const Boundary boundary = problem.boundaries().of(0);
    const auto three = [&](std::size_t k) { return glm::dvec3(v[k], v[k + 1], v[k + 2]); };
    std::vector<Block> result;
    constexpr std::size_t head = 3, row = sizeof(gpu::Sp3Row) / sizeof(float);
    for (std::size_t k = head; k < v.size(); k += row) {
      result.push_back(block_of({.stiffness = stiffness ? three(k) : glm::dvec3(0),
                                 .absorption = masses * three(k + 3),
                                 .relaxation = masses * three(k + 6),
                                 .boundary = glm::dvec3(area * v[k + 9])},
                                op.model, boundary));
    }
    return result;
  }

  std::vector<Block> row_sums() { return op.compact_rows() ? compact(1, 1, false) : blocks(op.row_sum); }
  std::vector<Block> diagonals() { return op.compact_rows() ? compact(0.4, 0.5, true) : blocks(op.diagonal); }

  // Blocks as the CPU has them, and the same for fields.
  std::vector<Block> blocks(const device::Buffer& buffer) {
    const auto values = get<glm::vec3>(buffer);
    std::vector<Block> result;
    const std::size_t size = op.block_bytes() / sizeof(glm::vec3);
    for (std::size_t i = 0; i < values.size(); i += size) {
      Block block{glm::dvec3(values[i])};
      if (size == 3) block = {glm::dvec3(values[i]), glm::dvec3(values[i + 1]), glm::dvec3(values[i + 2])};
      result.push_back(block);
    }
    return result;
  }

  std::vector<Field> fields(const device::Buffer& buffer) {
    const auto values = get<glm::vec3>(buffer);
    std::vector<Field> result;
    const std::size_t size = op.field_bytes() / sizeof(glm::vec3);
    for (std::size_t i = 0; i < values.size(); i += size) {
      result.push_back({glm::dvec3(values[i]), size == 2 ? glm::dvec3(values[i + 1]) : glm::dvec3(0)});
    }
    return result;
  }
};

double largest(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

double largest_difference(const Block& a, const Block& b) {
  return std::max({largest(a.a11 - b.a11), largest(a.a12 - b.a12), largest(a.a22 - b.a22)});
}

bool is_zero(const Block& block) {
  return largest_difference(block, {}) == 0;
}

constexpr std::array<Model, 2> both_models = {Model::diffusion, Model::sp3};

// Whether `a` is `b` as it is stored, up to `noise`.
bool within(const Block& a, const Block& b, EntryFormat format, Model model, double noise) {
  if (format == EntryFormat::plain) return largest_difference(a, b) <= noise;
  if (model != Model::sp3) return largest(a.a11 - b.a11) <= 0x1p-11 * largest(b.a11) + noise;
  const auto rest12 = [](const Block& block) { return block.a12 - 2.0 / 3.0 * block.a11; };
  const auto rest22 = [](const Block& block) { return block.a22 - 55.0 / 63.0 * block.a11; };
  const double all = largest(b.a11);
  return largest(a.a11 - b.a11) <= 0x1p-12 * all + noise &&
         largest(rest12(a) - rest12(b)) <= 0x1p-7 * largest(rest12(b)) + 0x1p-14 * all + noise &&
         largest(rest22(a) - rest22(b)) <= 0x1p-8 * largest(rest22(b)) + 0x1p-14 * all + noise;
}

// Methods, and whether the material is homogeneous: linear elements are then assembled in another way.
constexpr std::array<std::pair<Method, bool>, 4> ways = {
    {{Method::fem, false}, {Method::fem, true}, {Method::quadgraph_fv, false}, {Method::quadgraph_fdm, false}}};

}  // namespace

TEST_CASE("rows on the GPU equal those of the CPU with walls, in a heterogeneous material and a homogeneous one") {
  for (const auto& [method, even] : ways) {
    for (Model model : both_models) {
      CAPTURE(name_of(method));
      CAPTURE(name_of(model));
      CAPTURE(even);
      Assembled gpu_side(method, model, even);
      const Rows rows = assemble(gpu_side.level, gpu_side.problem);
      const std::uint32_t side = gpu_side.op.slice_rows;
      const auto slice_offset = gpu_side.get<std::uint32_t>(gpu_side.op.slice_offset);
      const std::vector<StoredEntry> entry = gpu_side.entries();
      const auto diagonal = gpu_side.diagonals();
      const auto row_sum = gpu_side.row_sums();
      std::vector<glm::vec3> to_phi(rows.size(), glm::vec3(1));
      if (method != Method::fem) to_phi = gpu_side.get<glm::vec3>(gpu_side.op.to_phi);
      REQUIRE(diagonal.size() == rows.size());
      const EntryFormat format = gpu_side.op.format;
      CHECK((format == EntryFormat::packed) == (method == Method::fem));
      double worst = 0;
      for (std::uint32_t i = 0; i < rows.size(); ++i) {
        std::map<std::uint32_t, Block> expected;
        Block sum = rows.diagonal[i];
        for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) {
          expected[rows.column[k]] = rows.weight[k];
          sum += rows.weight[k];
        }
        const double scale = largest(rows.diagonal[i].a11);
        worst = std::max(worst, largest_difference(row_sum[i], sum) / scale);
        worst = std::max(worst, largest(glm::dvec3(to_phi[i]) / rows.to_phi[i] - 1.0));
        std::size_t found = 0;
        for (std::uint32_t e = slice_offset[i / side] + i % side; e < slice_offset[i / side + 1]; e += side) {
          if (entry[e].column == i) {
            CHECK(is_zero(entry[e].weight));
            continue;
          }
          ++found;
          REQUIRE(expected.count(entry[e].column) == 1);
          const Block& exact = expected[entry[e].column];
          CHECK(within(entry[e].weight, exact, format, model, row_tolerance * scale));
          sum = sum - entry[e].weight;
        }
        if (gpu_side.op.compact_rows()) {
          // A compact row holds the rounding of a11 alone, as if the stiffness were another.
          const glm::dvec3 rounded = sum.a11 - rows.diagonal[i].a11;
          sum = rows.diagonal[i];
          sum += {rounded, 2.0 / 3.0 * rounded, 55.0 / 63.0 * rounded};
        }
        worst = std::max(worst, largest_difference(diagonal[i], sum) / scale);
        REQUIRE(found == expected.size());
      }
      CAPTURE(worst);
      CHECK(worst < row_tolerance);
      CHECK(worst > 0);
    }
  }
}

TEST_CASE("weights are symmetric bit for bit, so that the flux from i to j is that from j to i") {
  for (const auto& [method, even] : ways) {
    for (Model model : both_models) {
      Assembled gpu_side(method, model, even);
      const std::uint32_t side = gpu_side.op.slice_rows;
      const auto slice_offset = gpu_side.get<std::uint32_t>(gpu_side.op.slice_offset);
      const std::vector<StoredEntry> entry = gpu_side.entries();
      std::map<std::pair<std::uint32_t, std::uint32_t>, Block> at;
      for (std::uint32_t i = 0; i < gpu_side.op.count; ++i) {
        for (std::uint32_t e = slice_offset[i / side] + i % side; e < slice_offset[i / side + 1]; e += side) {
          if (entry[e].column != i) at[{i, entry[e].column}] = entry[e].weight;
        }
      }
      for (const auto& [place, block] : at) {
        REQUIRE(at.count({place.second, place.first}) == 1);
        CHECK(largest_difference(block, at[{place.second, place.first}]) == 0);
      }
    }
  }
}

TEST_CASE("right-hand sides of the diffuse source on the GPU equal those of the CPU") {
  for (Method method : all_methods) {
    for (Model model : both_models) {
      CAPTURE(name_of(method));
      CAPTURE(name_of(model));
      Assembled gpu_side(method, model);
      std::vector<glm::vec3> q;
      for (std::uint32_t f = 0; f < gpu_side.level.face_count(); ++f) {
        q.push_back(glm::vec3(0.001f, 0.3f, 70.0f) * static_cast<float>(f % 5));
      }
      device::write_bytes(gpu_side.device.context, gpu_side.buffers.q, std::as_bytes(std::span(q)));
      record_scale(gpu_side.work, gpu_side.buffers);
      record_diffuse_load(gpu_side.work, gpu_side.buffers, method, gpu_side.boundaries(), gpu_side.op);
      gpu_side.work.recorder.submit();
      const std::vector<Field> b = gpu_side.fields(gpu_side.op.b);
      const glm::dvec3 scale(gpu_side.get<gpu::Scale>(gpu_side.work.scale)[0].scale);
      const auto state = gpu_side.get<gpu::SolveState>(gpu_side.op.state)[0];
      const auto expected = diffuse_load(gpu_side.level, gpu_side.problem, q);
      const Rows rows = assemble(gpu_side.level, gpu_side.problem);
      glm::dvec3 norm{0}, peak{0};
      for (const Field& field : expected) peak = glm::max(peak, field.phi);
      for (std::size_t i = 0; i < b.size(); ++i) {
        CHECK(largest((b[i].phi * scale - expected[i].phi) / peak) < 1e-6);
        CHECK(largest((b[i].phi2 * scale - expected[i].phi2) / peak) < 1e-6);
        const Field scaled = 1.0 / scale * expected[i];
        norm += dot(scaled, solve(rows.diagonal[i], scaled));
      }
      for (int c = 0; c < 3; ++c) CHECK(state.norm[c] == doctest::Approx(norm[c]).epsilon(1e-5));
    }
  }
}

namespace {

using EdgeEnds = std::pair<std::uint32_t, std::uint32_t>;

// The vertices that an entry couples: row and column.
EdgeEnds ends_of(const SlicedColumns& columns, std::uint32_t entry) {
  const auto after = std::upper_bound(columns.slice_offset.begin(), columns.slice_offset.end(), entry) - 1;
  const auto slice = static_cast<std::uint32_t>(after - columns.slice_offset.begin());
  return {slice * columns.slice_rows + (entry - *after) % columns.slice_rows, columns.column[entry]};
}

template <typename Corners>
bool has(const Corners& corners, std::uint32_t v) {
  for (int k = 0; k < corners.length(); ++k) {
    if (corners[k] == v) return true;
  }
  return false;
}

struct FemStructure : FemRings {
  SlicedColumns columns;
  TetIncidence tets;
};

FemStructure fem_structure(const Level& level) {
  const Neighbours rows = vertex_neighbours(level);
  const SlicedColumns columns = slice(rows, SLICE_ROWS);
  return {fem_rings(level, rows, columns), columns, tet_incidence(level)};
}

OwnedLevel with_a_wall(std::uint32_t wall) {
  OwnedLevel owned = split_at_centroids(box_level(3, 6.0f));
  owned.face_kinds.assign(owned.faces.size(), face_open);
  owned.face_kinds[wall] = face_reflecting;
  return owned;
}

}  // namespace

TEST_CASE("every row has each neighbour once, and every entry belongs to one edge") {
  const OwnedLevel owned = with_a_wall(4);
  const FemStructure fem = fem_structure(owned.view());
  std::size_t entries = 0;
  for (std::uint32_t e = 0; e < fem.columns.column.size(); ++e) {
    const auto [row, column] = ends_of(fem.columns, e);
    if (row < owned.vertices.size() && row != column) ++entries;
  }
  CHECK(entries == 2 * fem.edge_entry.size());
  std::set<EdgeEnds> seen;
  for (const glm::uvec2& both : fem.edge_entry) {
    const auto [a, b] = ends_of(fem.columns, both.x);
    CHECK(a != b);
    CHECK(ends_of(fem.columns, both.y) == EdgeEnds(b, a));
    CHECK(seen.insert({std::min(a, b), std::max(a, b)}).second);
  }
}

TEST_CASE("around every edge lie its tets, then its open faces, and at every vertex its own") {
  constexpr std::uint32_t wall = 4;
  const OwnedLevel owned = with_a_wall(wall);
  const Level level = owned.view();
  const FemStructure fem = fem_structure(level);
  constexpr std::array<std::array<int, 2>, 6> edges = {{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
  std::size_t tet_edges = 0, face_edges = 0;
  for (std::uint32_t i = 0; i < fem.edge_entry.size(); ++i) {
    const auto [a, b] = ends_of(fem.columns, fem.edge_entry[i].x);
    bool faces_began = false;
    for (std::uint32_t k = fem.ring_offset[i]; k < fem.ring_offset[i + 1]; ++k) {
      const std::uint32_t index = fem.ring[k] / 8, edge = fem.ring[k] % 8;
      if (edge == gpu::RING_FACE) {
        CHECK(index != wall);
        CHECK((has(level.faces[index], a) && has(level.faces[index], b)));
        faces_began = true;
        ++face_edges;
      } else {
        const EdgeEnds ends(level.tets[index][edges[edge][0]], level.tets[index][edges[edge][1]]);
        CHECK((ends == EdgeEnds(a, b) || ends == EdgeEnds(b, a)));
        CHECK(!faces_began);
        ++tet_edges;
      }
    }
  }
  CHECK(tet_edges == 6 * level.tets.size());
  CHECK(face_edges == 3 * (level.faces.size() - 1));
  CHECK(fem.tets.tet.size() == 4 * level.tets.size());
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    for (std::uint32_t k = fem.tets.offset[v]; k < fem.tets.offset[v + 1]; ++k) {
      CHECK(has(level.tets[fem.tets.tet[k]], v));
    }
  }
  const FaceIncidence faces = face_incidence(level);
  CHECK(faces.face.size() == 3 * (level.faces.size() - 1));
  for (std::uint32_t v = 0; v < level.surface_vertex_count; ++v) {
    for (std::uint32_t k = faces.offset[v]; k < faces.offset[v + 1]; ++k) CHECK(has(level.faces[faces.face[k]], v));
  }
}

TEST_CASE("what the rows of a level are made of is found in pieces, and given up between two") {
  const OwnedLevel owned = box_level(16, 16.0f);
  const Level level = owned.view();
  const Neighbours rows = vertex_neighbours(level);
  const SlicedColumns columns = slice(rows, SLICE_ROWS);
  struct Enough {};
  std::uint32_t calls = 0;
  const auto in_pieces = [&](const auto& make) {
    calls = 0;
    make([&] { ++calls; });
    CHECK(calls >= level.tet_count() / 4096);
    CHECK_THROWS_AS(make([] { throw Enough(); }), Enough);
  };
  in_pieces([&](const Listener& listener) { CHECK(vertex_neighbours(level, listener).column == rows.column); });
  in_pieces([&](const Listener& listener) { fem_shape(level, rows, columns, listener); });
  in_pieces([&](const Listener& listener) { fem_rings(level, rows, columns, listener); });
  in_pieces([&](const Listener& listener) { tet_incidence(level, listener); });
}
