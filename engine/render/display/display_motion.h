// The display mesh as a list of deformers moves it, with its normals, and the sphere around it.
#pragma once

#include <span>

#include "engine/deform/deform.h"
#include "engine/render/display/camera.h"
#include "engine/render/display/display_buffers.h"
#include "engine/solve/deformed_mesh.h"
#include "engine/solve/workspace.h"

namespace quadgraph {

class DisplayMotion {
 public:
  // `mesh` must stay alive. Nothing is uploaded before the first motion.
  explicit DisplayMotion(const DisplayMesh& mesh);

  const RestBox& rest_box() const { return box_; }

  // Vertices and normals of `buffers`; an empty list puts back those of the file.
  void record(Workspace& work, std::span<const Deformer> list, const DisplayBuffers& buffers);

  // vec3 per vertex, mm; after a list that was not empty has been recorded.
  const device::Buffer& rest() const { return vertices_.rest(); }

  // Bounding sphere of the moved mesh, once the recorded motion has run; its list of deformers was not empty.
  Sphere bounds() const;

 private:
  void make_room(device::Device& device);

  const DisplayMesh& mesh_;
  RestBox box_;
  DeformedMesh vertices_;
  device::Buffer rest_normals_;
  device::Buffer offset_, incidence_;  // the triangles at every vertex
  device::Buffer sphere_, sphere_on_host_;
};

}  // namespace quadgraph
