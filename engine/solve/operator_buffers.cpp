#include "engine/solve/operator_buffers.h"

#include "engine/graph/operator.h"
#include "engine/solve/row_structure.h"

namespace quadgraph {
namespace {

template <typename T>
vk::Buffer upload(vk::Context& context, const std::vector<T>& values, const std::string& name) {
  return vk::upload<T>(context, values, name);
}

}  // namespace

OperatorBuffers::OperatorBuffers(vk::Context& context, const Level& level, std::uint32_t index, Method method)
    : count(carrier_count(level, method)) {
  const std::string prefix = "level " + std::to_string(index) + " " + std::string(name_of(method)) + " ";
  const auto vector = [&](std::uint64_t elements, const char* name) {
    return vk::Buffer(context, elements * sizeof(glm::vec3), vk::Place::device, prefix + name);
  };
  FemStructure fem;
  if (method == Method::fem) {
    fem = fem_structure(level);
    tet_offset = upload(context, fem.tets.offset, prefix + "tet_offset");
    tet_incidence = upload(context, fem.tets.element, prefix + "tet_incidence");
    to_phi = upload(context, std::vector<glm::vec3>(count, glm::vec3(1)), prefix + "to_phi");
  } else {
    fem.columns = node_columns(level);
    to_phi = vector(count, "to_phi");
  }
  if (method == Method::fem || index == 0) {
    const Incidence faces = quadgraph::face_incidence(level, method == Method::fem ? &fem.columns : nullptr);
    face_offset = upload(context, faces.offset, prefix + "face_offset");
    face_incidence = upload(context, faces.element, prefix + "face_incidence");
  }
  entries = static_cast<std::uint32_t>(fem.columns.column.size());
  slices = static_cast<std::uint32_t>(fem.columns.slice_offset.size() - 1);
  slice_offset = upload(context, fem.columns.slice_offset, prefix + "slice_offset");
  column = upload(context, fem.columns.column, prefix + "column");
  weight = vector(entries, "weight");
  diagonal = vector(count, "diagonal");
  b = vector(count, "b");
  x = vector(count, "x");
  r = vector(count, "r");
  p = vector(count, "p");
  product = vector(count, "product");
  state = vk::Buffer(context, sizeof(gpu::SolveState), vk::Place::device, prefix + "state");
  damping = vector(1, "damping");
}

gpu::RowsRef OperatorBuffers::rows() const {
  return {slice_offset.address(), column.address(), weight.address(), diagonal.address()};
}

std::uint64_t OperatorBuffers::product_bytes() const {
  return std::uint64_t{entries} * (sizeof(std::uint32_t) + 2 * sizeof(glm::vec3)) +
         (slices + 1) * sizeof(std::uint32_t);
}

}  // namespace quadgraph
