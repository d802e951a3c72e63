// The shortest-path method: what the display mesh, the material and the lights are now, to what leaves the surface
// (docs/shortest-path.md).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/deform/cut.h"
#include "engine/optics/edit.h"
#include "engine/optics/optical_grid.h"
#include "engine/path/voxels.h"
#include "engine/reference/solution.h"
#include "engine/render/body_grid.h"
#include "engine/render/display/display_buffers.h"
#include "engine/render/light/shadow_maps.h"

namespace quadgraph {

// Makes what it needs of the device at the first solve.
class PathMethod {
 public:
  explicit PathMethod(device::Device& device);
  ~PathMethod();

  // Coefficients and edits, see CellCosts.
  void set(const gpu::Material& material);
  void set(const OpticalGrid& grid);
  // A grid that is made at the next solve; what that throws, the solve does.
  void set(std::function<GivenGrid()> grid);
  void clear();
  void set(std::span<const Edit> edits);

  // What is cut away from now on; checked before.
  void set(std::span<const BodyCut> cuts);

  // Work of the device was given up half-way: keeps what was set, and nothing that was derived from it.
  void start_over();

  // The mesh is no longer what it was at the last solve.
  void set_moved() { body_.reset(); }

  // Voxels and costs of the mesh as it is now, if anything about them has changed since the last solve, light and
  // paths. `rest`: its vertices at rest, null where they are there. Throws InputError as CellCosts and check_options,
  // SolverError as PathRelaxation.
  PathReport solve(const DisplayBuffers& mesh, const device::Buffer* rest, const ShadowMaps& shadows,
                   const OpticalSurface& surface, const PathOptions& options);

  // Results of the last solve.
  const std::vector<PassStats>& passes() const { return passes_; }
  const device::Buffer& field() const;                                          // gpu::PathField
  std::vector<glm::vec3> exitance_at(std::span<const glm::vec3> points) const;  // W/mm^2

 private:
  struct Parts;

  gpu::PathTools tools() const { return {tools_.address(), tool_count_}; }
  Parts& parts();
  void make_body(const PathMesh& mesh, const device::Buffer* rest, const PathOptions& options);
  void light(const DisplayBuffers& mesh, const ShadowMaps& shadows, const OpticalSurface& surface);

  device::Device& device_;
  std::vector<Edit> edits_;
  std::optional<gpu::Material> material_;
  std::optional<GivenGrid> grid_;
  std::function<GivenGrid()> make_grid_;  // as long as it has not been
  device::Buffer tools_;                  // gpu::PathTool
  std::uint32_t tool_count_ = 0;
  bool stale_ = true;                // the parts do not know the present coefficients
  std::optional<PathOptions> body_;  // of which voxels and costs are; none: not of the present body
  std::unique_ptr<Parts> parts_;
  std::vector<PassStats> passes_;
};

}  // namespace quadgraph
