#include "engine/solve/level_upload.h"

#include "engine/device/commands.h"
#include "engine/reference/sky.h"
#include "engine/solve/row_structure.h"

namespace quadgraph {
namespace {

// A transfer by columns: the entries of column r, from offset[r] to offset[r + 1].
struct Transposed {
  std::vector<std::uint32_t> offset;
  std::vector<gpu::TransposedEntry> entry;
};

Transposed transposed(const Transfer& transfer, std::uint32_t columns) {
  Transposed back;
  back.offset.assign(columns + 1, 0);
  for (std::size_t k = 0; k < transfer.index.size(); ++k) {
    if (transfer.weight[k] > 0) ++back.offset[transfer.index[k] + 1];
  }
  for (std::uint32_t i = 0; i < columns; ++i) back.offset[i + 1] += back.offset[i];
  back.entry.resize(back.offset.back());
  std::vector<std::uint32_t> next(back.offset.begin(), back.offset.end() - 1);
  for (std::size_t k = 0; k < transfer.index.size(); ++k) {
    if (transfer.weight[k] == 0) continue;
    const auto row = static_cast<std::uint32_t>(k / transfer.width);
    back.entry[next[transfer.index[k]]++] = {row, transfer.weight[k]};
  }
  return back;
}

// With the address of how facets lean, or 0.
std::vector<std::uint32_t> face_words(const Level& level, const Refractions& refractions, std::uint64_t leaning) {
  std::vector<std::uint32_t> words = refractions.head(level.face_count());
  for (std::uint32_t f = 0; f < level.face_count(); ++f) {
    const std::uint32_t kind = level.reflecting(f) ? gpu::FACE_REFLECTING : gpu::FACE_OPEN;
    words.push_back(kind | level.body_of_face(f) << gpu::FACE_BODY);
  }
  words.push_back(static_cast<std::uint32_t>(leaning));
  words.push_back(static_cast<std::uint32_t>(leaning >> 32));
  return words;
}

}  // namespace

LevelBuffers upload_level(device::Device& device, const Level& level, std::uint32_t number,
                          const Refractions& refractions) {
  const std::string prefix = "geometry/level " + std::to_string(number) + " ";
  LevelBuffers buffers;
  buffers.vertex_count = level.vertex_count();
  buffers.tet_count = level.tet_count();
  buffers.face_count = level.face_count();
  buffers.node_count = level.node_count();
  buffers.surface_vertex_count = level.surface_vertex_count;
  buffers.vertices = device::upload(device, level.vertices, prefix + "vertices");
  buffers.tets = device::upload(device, level.tets, prefix + "tets");
  buffers.faces = device::upload(device, level.faces, prefix + "faces");
  buffers.face_tets = device::upload(device, level.face_tets, prefix + "face_tets");
  buffers.face_kind = device::upload<std::uint32_t>(device, face_words(level, refractions, 0), prefix + "face_kind");
  const FaceIncidence incidence = face_incidence(level);
  buffers.face_offset = device::upload<std::uint32_t>(device, incidence.offset, prefix + "face_offset");
  buffers.face_incidence = device::upload<std::uint32_t>(device, incidence.face, prefix + "face_incidence");
  buffers.q = device::Buffer(device, level.faces.size() * sizeof(glm::vec3), device::Place::device,
                             "light/level " + std::to_string(number) + " q");
  device::Commands commands(device);
  commands.fill(buffers.q, 0);
  commands.submit_and_wait();
  return buffers;
}

std::vector<LevelBuffers> upload_levels(device::Device& device, const std::vector<Level>& levels,
                                        const Refractions& refractions) {
  std::vector<LevelBuffers> buffers;
  const auto sky = sky_of_levels(levels);
  for (std::uint32_t i = 0; i < levels.size(); ++i) {
    buffers.push_back(upload_level(device, levels[i], i, refractions));
    buffers[i].sky = device::upload<float>(device, sky[i], "geometry/sky");
  }
  return buffers;
}

void lean_faces(device::Device& device, const Level& level, std::uint32_t number, const Refractions& refractions,
                std::span<const glm::vec2> leaning, LevelBuffers& buffers) {
  if (leaning.empty()) {
    buffers.leaning = {};
  } else {
    device::rewrite(device, leaning, "light/level " + std::to_string(number) + " leaning", buffers.leaning);
  }
  const std::vector<std::uint32_t> words = face_words(level, refractions, buffers.leaning.address());
  device::write_bytes(device, buffers.face_kind, std::as_bytes(std::span(words)));
}

void upload_graph(device::Device& device, const Level& level, std::uint32_t number, LevelBuffers& buffers) {
  if (buffers.nodes.size() > 0) return;
  const std::string prefix = "geometry/level " + std::to_string(number) + " ";
  buffers.links = device::upload(device, level.links, prefix + "links");
  buffers.nodes = device::upload(device, level.nodes, prefix + "nodes");
}

TransferBuffers::TransferBuffers(device::Device& device, const Level& level, const Level& coarse, std::uint32_t number,
                                 Method method) {
  const std::string prefix = "transfers/level " + std::to_string(number) + " ";
  const auto add = [&](const Transfer& t, const std::string& name, std::uint32_t first, std::uint32_t coarse_first) {
    parts.push_back({device::upload(device, t.index, prefix + name + "_index"),
                     device::upload(device, t.weight, prefix + name + "_weight"), t.width, first, coarse_first,
                     static_cast<std::uint32_t>(t.index.size() / t.width)});
  };
  if (on_vertices(method)) {
    add(level.barycentric, "barycentric", 0, 0);
    const Transposed back = transposed(level.barycentric, coarse.vertex_count());
    back_offset = device::upload<std::uint32_t>(device, back.offset, prefix + "barycentric_back_offset");
    back_entry = device::upload<gpu::TransposedEntry>(device, back.entry, prefix + "barycentric_back_entry");
  } else {
    add(level.inner, "inner", 0, 0);
    add(level.surface, "surface", level.tet_count(), coarse.tet_count());
  }
}

}  // namespace quadgraph
