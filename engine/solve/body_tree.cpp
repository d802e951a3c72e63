#include "engine/solve/body_tree.h"

#include "engine/file/face_tree.h"
#include "interface/exchange/exchange_boxes.comp.h"
#include "shaders/exchange/exchange_shared.h"

namespace quadgraph {

BodyTree::BodyTree(device::Device& device, const Level& level, const std::string& purpose) : purpose_(purpose) {
  const FaceTree tree = face_tree(level, [&] { device.heed(); });
  leaves_ = tree.leaves();
  order_ = device::upload<std::uint32_t>(device, tree.order, purpose + "/faces of the tree");
  leaf_begin_ = device::upload<std::uint32_t>(device, tree.leaf_begin, purpose + "/leaves of the tree");
  boxes_ = {device, nodes() * sizeof(gpu::Box), device::Place::device, purpose + "/boxes of the tree"};
}

void BodyTree::record(Workspace& work, const LevelBuffers& level) {
  if (!behind_) return;
  behind_ = false;
  gpu::ExchangeBoxesPush push{.vertices = level.vertices.address(),
                              .faces = level.faces.address(),
                              .order = order_.address(),
                              .leaf_begin = leaf_begin_.address(),
                              .boxes = boxes_.address(),
                              .first = 0,
                              .count = 0,
                              .leaf_count = leaves_};
  constexpr std::uint64_t face_bytes = sizeof(std::uint32_t) + sizeof(glm::uvec3) + 3 * sizeof(glm::vec3);
  std::uint64_t bytes = level.face_count * face_bytes;
  upwards([&](std::uint32_t first, std::uint32_t count) {
    push.first = first;
    push.count = count;
    work.recorder.dispatch(work.passes.of(shader::exchange_boxes), push, count, purpose_ + " boxes",
                           bytes + count * sizeof(gpu::Box));
    bytes = count * sizeof(gpu::Box);  // children
  });
}

gpu::TreeRef BodyTree::ref() const {
  return {
      .order = order_.address(), .leaf_begin = leaf_begin_.address(), .boxes = boxes_.address(), .leaf_count = leaves_};
}

}  // namespace quadgraph
