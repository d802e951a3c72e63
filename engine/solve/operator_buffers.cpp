#include "engine/solve/operator_buffers.h"

#include "engine/file/polygrid.h"
#include "engine/reference/operator.h"
#include "engine/solve/row_structure.h"
#include "shaders/assemble/assembly_shared.h"
#include "shaders/solver/packing.h"
#include "shaders/surface/surface_shared.h"

namespace quadgraph {
namespace {

template <typename T>
vk::Buffer upload(vk::Context& context, const std::vector<T>& values, const std::string& name, vk::Place place) {
  return vk::upload<T>(context, values, name, place);
}

// Of ascending numbers from 0 on: how many are at most 0, 1, ...
std::vector<std::uint32_t> ends_of(const std::vector<std::uint32_t>& layers) {
  std::vector<std::uint32_t> ends(layers.back() + 1, 0);
  for (std::uint32_t v = 0; v < layers.size(); ++v) ends[layers[v]] = v + 1;
  return ends;
}

}  // namespace

OperatorBuffers::OperatorBuffers(vk::Context& context, const Level& level, std::uint32_t index, Method method,
                                 Model model_in, EntryFormat format_in)
    : model(model_in),
      format(format_in),
      count(carrier_count(level, method)),
      method_(method),
      prefix_("level " + std::to_string(index) + " " + std::string(name_of(method)) + " " +
              std::string(name_of(model)) + " ") {
  const auto buffer = [&](std::uint64_t bytes, const std::string& purpose, const char* name,
                          vk::Place place = vk::Place::read) {
    return vk::Buffer(context, bytes, place, purpose + prefix_ + name);
  };
  const auto block = [&](const char* name) {
    const std::uint64_t head = compact_rows() ? gpu::SP3_ROWS_HEAD * sizeof(float) : 0;
    return buffer(head + count * block_bytes(), "operator/", name, vk::Place::rows);
  };
  const auto field = [&](const char* name) {
    return buffer(count * field_bytes(), "solver/", name, vk::Place::fields);
  };
  const std::string rows = "operator/", vectors = "solver/";
  const bool fem = method == Method::fem;
  const SlicedColumns columns = fem               ? slice(vertex_neighbours(level))
                                : on_grid(method) ? grid_columns(level)
                                                  : node_columns(level);
  if (on_grid(method)) layer_ends = ends_of(grid_layers(level));
  if (!fem) to_phi = buffer(count * sizeof(glm::vec3), rows, "to_phi");
  entries = static_cast<std::uint32_t>(columns.column.size());
  slices = static_cast<std::uint32_t>(columns.slice_offset.size() - 1);
  slice_offset = upload(context, columns.slice_offset, rows + prefix_ + "slice_offset", vk::Place::rows);
  entry = upload(context, stored_columns(columns.column, model, format), rows + prefix_ + "entry", vk::Place::rows);
  row_sum = block("row_sum");
  if (!compact_rows()) diagonal = block("diagonal");
  b = field("b");
  x = field("x");
  r = field("r");
  p = field("p");
  product = field("product");
  if (fem) z = field("z");
  if (index > 0) before = field("x before");
  unit = buffer(sizeof(glm::vec3), vectors, "unit of x");
  surface_first = on_vertices(method) ? 0 : level.tet_count();
  surface_count = on_vertices(method) ? level.surface_vertex_count : level.face_count();
  surface_share = buffer(surface_count * sizeof(gpu::SurfaceShare), vectors, "surface share");
  surface_before = buffer(surface_count * sizeof(glm::vec3), vectors, "exitance before");
  surface_start = buffer(surface_count * sizeof(glm::vec3), vectors, "exitance of the start");
  state = buffer(sizeof(gpu::SolveState), vectors, "state");
  state_on_host = {context, sizeof(gpu::SolveState), vk::Place::host, vectors + prefix_ + "state, read back"};
  damping = buffer(sizeof(glm::vec3), vectors, "damping");
}

void OperatorBuffers::make_room(vk::Context& context, const Level& level, bool even, bool two_steps) {
  if (on_grid(method_) && grid_optical.size() == 0) upload_grid(context, level);
  if (method_ != Method::fem) return;
  if (two_steps && other.size() == 0) {
    other = {context, count * field_bytes(), vk::Place::fields, "solver/" + prefix_ + "other z"};
  }
  if (by_entry(even)) {
    if (row_shape.size() == 0) upload_shape(context, level);
  } else {
    if (ring.size() == 0) upload_rings(context, level);
  }
}

void OperatorBuffers::upload_shape(vk::Context& context, const Level& level) {
  const Neighbours rows = vertex_neighbours(level);
  const FemShape shape = fem_shape(level, rows, slice(rows));
  const std::string prefix = "assembly/" + prefix_;
  entry_shape = upload(context, shape.entry, prefix + "entry_shape", vk::Place::assembly);
  entry_area = upload(context, shape.area, prefix + "entry_area", vk::Place::assembly);
  row_shape = upload(context, shape.row, prefix + "row_shape", vk::Place::assembly);
}

void OperatorBuffers::upload_rings(vk::Context& context, const Level& level) {
  const Neighbours rows = vertex_neighbours(level);
  const FemRings rings = fem_rings(level, rows, slice(rows));
  const std::string prefix = "assembly/" + prefix_;
  edge_count = static_cast<std::uint32_t>(rings.edge_entry.size());
  edge_entry = upload(context, rings.edge_entry, prefix + "edge_entry", vk::Place::assembly);
  ring_offset = upload(context, rings.ring_offset, prefix + "ring_offset", vk::Place::assembly);
  ring = upload(context, rings.ring, prefix + "ring", vk::Place::assembly);
  tet_offset = upload(context, rings.tets.offset, prefix + "tet_offset", vk::Place::assembly);
  tet_incidence = upload(context, rings.tets.tet, prefix + "tet_incidence", vk::Place::assembly);
  tet_shape = {context, std::uint64_t{gpu::TET_SHAPE} * level.tet_count() * sizeof(float), vk::Place::assembly,
               prefix + "tet_shape"};
  face_area = {context, level.face_count() * sizeof(float), vk::Place::assembly, prefix + "face_area"};
}

void OperatorBuffers::upload_grid(vk::Context& context, const Level& level) {
  const TetIncidence tets = quadgraph::tet_incidence(level);
  const std::string prefix = "assembly/" + prefix_;
  tet_offset = upload(context, tets.offset, prefix + "tet_offset", vk::Place::assembly);
  tet_incidence = upload(context, tets.tet, prefix + "tet_incidence", vk::Place::assembly);
  grid_optical = {context, count * sizeof(gpu::Optical), vk::Place::fields, prefix + "optical at vertices"};
  grid_volume = {context, count * sizeof(float), vk::Place::assembly, prefix + "volume at vertices"};
}

std::uint64_t OperatorBuffers::block_bytes() const {
  if (compact_rows()) return gpu::SP3_ROW_FLOATS * sizeof(float);
  return (model == Model::sp3 ? 3 : 1) * sizeof(glm::vec3);
}

gpu::RowsRef OperatorBuffers::rows() const {
  return {slice_offset.address(), entry.address(), row_sum.address(), (compact_rows() ? row_sum : diagonal).address()};
}

std::uint64_t OperatorBuffers::product_bytes() const {
  return std::uint64_t{entries} * (entry_bytes() + field_bytes()) + (slices + 1) * sizeof(std::uint32_t);
}

}  // namespace quadgraph
