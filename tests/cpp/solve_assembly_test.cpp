// The rows and right-hand sides that the shaders assemble are those of the CPU.
#include <doctest/doctest.h>

#include "engine/graph/geometry.h"
#include "engine/graph/operator.h"
#include "engine/solve/assembly.h"
#include "engine/solve/level_upload.h"
#include "engine/solve/row_structure.h"
#include "tests/cpp/solve_fixtures.h"

using namespace quadgraph;

namespace {

// Single precision: a weight is a sum over up to some ten elements, each from differences of coordinates and a
// quotient of products; measured against the diagonal of its row.
constexpr double row_tolerance = 2e-6;

struct Assembled {
  CheckedContext device;
  OwnedLevel owned = split_at_centroids(box_level(3, 6.0f, 0.15f));
  Level level = owned.view();
  std::vector<gpu::Optical> optical = evaluate_material(level, veined());
  LevelBuffers buffers = upload_level(device.context, level, 0);
  OperatorBuffers op;
  Workspace work;

  explicit Assembled(Method method) : op(device.context, level, 0, method), work(device.context, level.node_count()) {
    vk::write_bytes(device.context, buffers.optical, std::as_bytes(std::span(optical)));
    record_assembly(work, buffers, method, veined().eta, op);
    work.recorder.submit();
  }

  template <typename T>
  std::vector<T> get(const vk::Buffer& buffer) {
    return vk::download<T>(device.context, buffer);
  }
};

double largest(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace

TEST_CASE("rows on the GPU equal those of the CPU in a heterogeneous material") {
  for (Method method : all_methods) {
    CAPTURE(name_of(method));
    Assembled gpu_side(method);
    const Rows rows =
        assemble(gpu_side.level, {method, Source::diffuse, Model::diffusion, gpu_side.optical, veined().eta});
    const auto slice_offset = gpu_side.get<std::uint32_t>(gpu_side.op.slice_offset);
    const auto column = gpu_side.get<std::uint32_t>(gpu_side.op.column);
    const auto weight = gpu_side.get<glm::vec3>(gpu_side.op.weight);
    const auto diagonal = gpu_side.get<glm::vec3>(gpu_side.op.diagonal);
    const auto to_phi = gpu_side.get<glm::vec3>(gpu_side.op.to_phi);
    REQUIRE(diagonal.size() == rows.size());
    double worst = 0;
    for (std::uint32_t i = 0; i < rows.size(); ++i) {
      std::map<std::uint32_t, glm::dvec3> expected;
      for (std::uint32_t k = rows.offset[i]; k < rows.offset[i + 1]; ++k) expected[rows.column[k]] = rows.weight[k].a11;
      const double scale = largest(rows.diagonal[i].a11);
      worst = std::max(worst, largest(glm::dvec3(diagonal[i]) - rows.diagonal[i].a11) / scale);
      worst = std::max(worst, largest(glm::dvec3(to_phi[i]) / rows.to_phi[i] - 1.0));
      std::size_t found = 0;
      for (std::uint32_t e = slice_offset[i / SLICE_ROWS] + i % SLICE_ROWS; e < slice_offset[i / SLICE_ROWS + 1];
           e += SLICE_ROWS) {
        if (column[e] == i) {
          CHECK(weight[e] == glm::vec3(0));
          continue;
        }
        ++found;
        REQUIRE(expected.count(column[e]) == 1);
        worst = std::max(worst, largest(glm::dvec3(weight[e]) - expected[column[e]]) / scale);
      }
      REQUIRE(found == expected.size());
    }
    CAPTURE(worst);
    CHECK(worst < row_tolerance);
    CHECK(worst > 0);
  }
}

TEST_CASE("right-hand sides on the GPU equal those of the CPU") {
  for (Method method : all_methods) {
    CAPTURE(name_of(method));
    Assembled gpu_side(method);
    std::vector<glm::vec3> q;
    for (std::uint32_t f = 0; f < gpu_side.level.face_count(); ++f) {
      q.push_back(glm::vec3(0.001f, 0.3f, 70.0f) * static_cast<float>(f % 5));
    }
    vk::write_bytes(gpu_side.device.context, gpu_side.buffers.q, std::as_bytes(std::span(q)));
    record_scale(gpu_side.work, gpu_side.buffers);
    record_right_hand_side(gpu_side.work, gpu_side.buffers, method, veined().eta, gpu_side.op);
    gpu_side.work.recorder.submit();
    const auto b = gpu_side.get<glm::vec3>(gpu_side.op.b);
    const auto scale = gpu_side.get<gpu::Scale>(gpu_side.work.scale)[0];
    const auto state = gpu_side.get<gpu::SolveState>(gpu_side.op.state)[0];
    const auto expected =
        diffuse_load(gpu_side.level, {method, Source::diffuse, Model::diffusion, gpu_side.optical, veined().eta}, q);
    const Rows rows =
        assemble(gpu_side.level, {method, Source::diffuse, Model::diffusion, gpu_side.optical, veined().eta});
    glm::dvec3 norm{0}, peak{0};
    for (std::size_t i = 0; i < b.size(); ++i) peak = glm::max(peak, expected[i].phi);
    for (std::size_t i = 0; i < b.size(); ++i) {
      CHECK(largest((glm::dvec3(b[i]) * glm::dvec3(scale.scale) - expected[i].phi) / peak) < 1e-6);
      const glm::dvec3 scaled = expected[i].phi / glm::dvec3(scale.scale);
      norm += scaled * scaled / rows.diagonal[i].a11;
    }
    for (int c = 0; c < 3; ++c) {
      CHECK(state.norm[c] == doctest::Approx(norm[c]).epsilon(1e-5));
      CHECK(scale.scale[c] * scale.inverse[c] == 1.0f);
      double power = 0;
      for (std::uint32_t f = 0; f < gpu_side.level.face_count(); ++f) {
        power += face_area(gpu_side.level, gpu_side.level.faces[f]) * q[f][c];
      }
      CHECK(power <= scale.scale[c]);
      CHECK(power > 0.5 * scale.scale[c]);
    }
  }
}

TEST_CASE("the structure has each neighbour once and every incidence in its place") {
  const OwnedLevel owned = split_at_centroids(box_level(3, 6.0f));
  const Level level = owned.view();
  const FemStructure fem = fem_structure(level);
  const Incidence faces = face_incidence(level, &fem.columns);
  const auto column = [&](std::uint32_t row, std::uint32_t place) {
    return fem.columns.column[fem.columns.slice_offset[row / SLICE_ROWS] + row % SLICE_ROWS + place * SLICE_ROWS];
  };
  std::size_t tet_corners = 0;
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    for (std::uint32_t i = fem.tets.offset[v]; i < fem.tets.offset[v + 1]; ++i, ++tet_corners) {
      const glm::uvec4& tet = level.tets[fem.tets.element[i].x / 4];
      const auto own = static_cast<int>(fem.tets.element[i].x % 4);
      REQUIRE(tet[own] == v);
      std::uint32_t places = fem.tets.element[i].y;
      for (int k = 0; k < 4; ++k) {
        if (k == own) continue;
        CHECK(column(v, places & 1023u) == tet[k]);
        places >>= 10;
      }
    }
  }
  CHECK(tet_corners == 4 * level.tets.size());
  std::size_t face_corners = 0;
  for (std::uint32_t v = 0; v < level.surface_vertex_count; ++v) {
    for (std::uint32_t i = faces.offset[v]; i < faces.offset[v + 1]; ++i, ++face_corners) {
      const glm::uvec3& face = level.faces[faces.element[i].x];
      const int own = face[0] == v ? 0 : face[1] == v ? 1 : 2;
      REQUIRE(face[own] == v);
      CHECK(column(v, faces.element[i].y & 1023u) == face[(own + 1) % 3]);
      CHECK(column(v, faces.element[i].y >> 10) == face[(own + 2) % 3]);
    }
  }
  CHECK(face_corners == 3 * level.faces.size());
}
