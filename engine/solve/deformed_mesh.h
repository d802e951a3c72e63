// The vertices of one mesh on the device, moved by a list of deformers from where they lie at rest.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/deform/deform.h"
#include "engine/device/memory.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

class DeformedMesh {
 public:
  // `rest`, mm, must stay alive. Nothing is uploaded before the first motion. `purpose`: what its memory counts for.
  DeformedMesh(MeshNumber number, std::span<const glm::vec3> rest, std::string purpose)
      : number_(number), rest_(rest), purpose_(std::move(purpose)) {}

  // Writes all vertices of `target` (vec3, mm). `list` has been checked, shapes too. What it needs per vertex is made
  // on the CPU where it is new: the weights of a cage at rest, the sum of weighted shapes.
  void record(Workspace& work, std::span<const Deformer> list, const RestBox& box, const device::Buffer& target);

  const device::Buffer& rest() const { return rest_on_device_; }  // vec3, mm; after `record`

  // Writes the vertices at rest; waits.
  void put_back(device::Device& device, const device::Buffer& target) const;

 private:
  // What one deformer of the list needs on the device, and of which value it is.
  struct Data {
    Deformer of;
    device::Buffer control, weight;
  };

  Data& data_of(device::Device& device, std::size_t place, const Deformer& deformer);
  void upload_control(device::Device& device, const Deformer& deformer, Data& data) const;

  MeshNumber number_;
  std::span<const glm::vec3> rest_;
  std::string purpose_;
  device::Buffer rest_on_device_;
  std::vector<Data> data_;  // by place in the list
};

}  // namespace quadgraph
