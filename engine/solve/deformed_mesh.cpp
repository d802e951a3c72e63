#include "engine/solve/deformed_mesh.h"

#include "engine/solve/moved_bytes.h"
#include "interface/deform/deform.comp.h"

namespace quadgraph {
namespace {

bool has_control(DeformerKind kind) {
  using enum DeformerKind;
  return kind == lattice || kind == cage || kind == displaced || kind == placed;
}

bool has_weights(DeformerKind kind) {
  return kind == DeformerKind::cage || kind == DeformerKind::placed;
}

bool same_cage(const Deformer& a, const Deformer& b) {
  return a.kind == DeformerKind::cage && b.kind == DeformerKind::cage && a.cage == b.cage && a.triangles == b.triangles;
}

}  // namespace

void DeformedMesh::upload_control(device::Device& device, const Deformer& deformer, Data& data) const {
  std::vector<glm::vec3> control;
  if (deformer.kind == DeformerKind::displaced) {
    control = shape_displacements(deformer, number_, rest_.size());
  } else {
    for (const glm::dvec3& d : control_displacements(deformer)) control.emplace_back(d);
  }
  if (data.control.size() != control.size() * vec3_bytes) {
    data.control = {device, control.size() * vec3_bytes, device::Place::device, purpose_ + "/displacements"};
  }
  device::write_bytes(device, data.control, std::as_bytes(std::span(control)));
}

DeformedMesh::Data& DeformedMesh::data_of(device::Device& device, std::size_t place, const Deformer& deformer) {
  if (data_.size() <= place) data_.resize(place + 1);
  Data& data = data_[place];
  if (!has_control(deformer.kind) || data.of == deformer) return data;
  if (deformer.kind == DeformerKind::cage && !same_cage(data.of, deformer)) {
    data.weight = device::upload<float>(device, cage_weights(deformer, rest_), purpose_ + "/weights of a cage");
  }
  if (deformer.kind == DeformerKind::placed && data.of.bodies != deformer.bodies) {
    const auto bodies = bodies_of(deformer, number_);
    const std::vector<float> numbers(bodies.begin(), bodies.end());
    data.weight = device::upload<float>(device, numbers, purpose_ + "/bodies of vertices");
  }
  upload_control(device, deformer, data);
  data.of = deformer;
  return data;
}

void DeformedMesh::record(Workspace& work, std::span<const Deformer> list, const RestBox& box,
                          const device::Buffer& target) {
  device::Device& device = work.recorder.device();
  for (std::size_t k = 0; k < list.size(); ++k) data_of(device, k, list[k]);
  if (rest_on_device_.size() == 0) rest_on_device_ = device::upload(device, rest_, purpose_ + "/rest");
  const device::Buffer* source = &rest_on_device_;
  for (std::size_t k = 0; k < list.size(); ++k) {
    gpu::DeformPush push{.record = deform_record(list[k], box),
                         .source = source->address(),
                         .target = target.address(),
                         .count = static_cast<std::uint32_t>(rest_.size())};
    std::uint64_t bytes = 2 * rest_.size() * vec3_bytes;
    if (has_control(list[k].kind)) {
      push.record.control = data_[k].control.address();
      bytes += data_[k].control.size();
    }
    if (has_weights(list[k].kind)) {
      push.record.weight = data_[k].weight.address();
      bytes += data_[k].weight.size();
    }
    work.recorder.dispatch(work.passes.of(shader::deform), push, push.count, "deform", bytes);
    source = &target;
  }
}

void DeformedMesh::put_back(device::Device& device, const device::Buffer& target) const {
  device::write_bytes(device, target, std::as_bytes(rest_));
}

}  // namespace quadgraph
