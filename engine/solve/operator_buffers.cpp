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
device::Buffer upload(device::Device& device, const std::vector<T>& values, const std::string& name) {
  return device::upload<T>(device, values, name);
}

// Where layers end: of ascending numbers from 0 on, how many are at most 0, 1, ...
std::vector<std::uint32_t> ends_of(const std::vector<std::uint32_t>& layers) {
  std::vector<std::uint32_t> ends(layers.back() + 1, 0);
  for (std::uint32_t v = 0; v < layers.size(); ++v) ends[layers[v]] = v + 1;
  return ends;
}

}  // namespace

OperatorBuffers::OperatorBuffers(device::Device& device, const Level& level, LevelElements& elements_in,
                                 std::uint32_t index, Method method, Model model_in, EntryFormat format_in)
    : model(model_in),
      format(format_in),
      count(carrier_count(level, method)),
      elements(&elements_in),
      method_(method),
      prefix_("level " + std::to_string(index) + " " + std::string(name_of(method)) + " " +
              std::string(name_of(model)) + " ") {
  const auto buffer = [&](std::uint64_t bytes, const std::string& purpose, const char* name) {
    return device::Buffer(device, bytes, device::Place::device, purpose + prefix_ + name);
  };
  const auto block = [&](const char* name) {
    const std::uint64_t head = compact_rows() ? sizeof(gpu::Sp3Head) : 0;
    return buffer(head + count * block_bytes(), "operator/", name);
  };
  const auto field = [&](const char* name) { return buffer(count * field_bytes(), "solver/", name); };
  const std::string rows = "operator/", vectors = "solver/";
  const bool fem = method == Method::fem;
  const bool unpacked = device.one_by_one() && model != Model::sp3;  // UNPACKED_ENTRIES of packing.h
  stored = unpacked ? EntryFormat::plain : format;
  slice_rows = device.one_by_one() ? 1 : SLICE_ROWS;
  const SlicedColumns columns = fem               ? slice(elements->around(device, level), slice_rows)
                                : on_grid(method) ? grid_columns(level, slice_rows)
                                                  : node_columns(level, slice_rows);
  device.heed();
  if (on_grid(method)) layer_ends = ends_of(grid_layers(level));
  if (!fem) to_phi = buffer(count * sizeof(glm::vec3), rows, "to_phi");
  entries = static_cast<std::uint32_t>(columns.column.size());
  slices = static_cast<std::uint32_t>(columns.slice_offset.size() - 1);
  slice_offset = upload(device, columns.slice_offset, rows + prefix_ + "slice_offset");
  entry = upload(device, stored_columns(columns.column, model, stored), rows + prefix_ + "entry");
  row_sum = block("row_sum");
  if (!compact_rows()) diagonal = block("diagonal");
  b = field("b");
  x = field("x");
  r = field("r");
  p = field("p");
  product = field("product");
  if (fem) z = field("z");
  if (fem) majorant = buffer(count * majorant_bytes(), rows, "majorant");
  if (index > 0) before = field("x before");
  unit = buffer(sizeof(glm::vec3), vectors, "unit of x");
  surface_first = on_vertices(method) ? 0 : level.tet_count();
  surface_count = on_vertices(method) ? level.surface_vertex_count : level.face_count();
  surface_share = buffer(surface_count * sizeof(gpu::SurfaceShare), vectors, "surface share");
  surface_before = buffer(surface_count * sizeof(glm::vec3), vectors, "exitance before");
  surface_start = buffer(surface_count * sizeof(glm::vec3), vectors, "exitance of the start");
  state = buffer(sizeof(gpu::SolveState), vectors, "state");
  state_on_host = {device, sizeof(gpu::SolveState), device::Place::host, vectors + prefix_ + "state, read back"};
  damping = buffer(sizeof(glm::vec3), vectors, "damping");
}

void OperatorBuffers::make_room(device::Device& device, const Level& level, bool even, bool two_steps) {
  if (on_grid(method_) && grid_optical.size() == 0) {
    elements->make_tets(device, level);
    const std::string prefix = "assembly/" + prefix_;
    grid_optical = {device, count * sizeof(gpu::Optical), device::Place::device, prefix + "optical at vertices"};
    grid_volume = {device, count * sizeof(float), device::Place::device, prefix + "volume at vertices"};
  }
  if (method_ != Method::fem) return;
  if (two_steps && other.size() == 0) {
    other = {device, count * field_bytes(), device::Place::device, "solver/" + prefix_ + "other z"};
  }
  if (by_entry(even)) {
    elements->make_shapes(device, level, slice_rows);
  } else {
    elements->make_rings(device, level, slice_rows);
  }
}

std::uint64_t OperatorBuffers::block_bytes() const {
  if (compact_rows()) return sizeof(gpu::Sp3Row);
  return (model == Model::sp3 ? 3 : 1) * sizeof(glm::vec3);
}

gpu::RowsRef OperatorBuffers::rows() const {
  return {slice_offset.address(), entry.address(), row_sum.address(), (compact_rows() ? row_sum : diagonal).address()};
}

gpu::RightHandSideRef OperatorBuffers::right_hand_side(const device::Buffer& reduction) const {
  return {rows().diagonal, b.address(), state.address(), reduction.address()};
}

std::uint64_t OperatorBuffers::product_bytes() const {
  return std::uint64_t{entries} * (entry_bytes() + field_bytes()) + (slices + 1) * sizeof(std::uint32_t);
}

}  // namespace quadgraph
