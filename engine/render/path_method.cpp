#include "engine/render/path_method.h"

#include <array>
#include <optional>
#include <utility>

#include "engine/optics/surface_boundary.h"
#include "engine/path/cell_costs.h"
#include "engine/path/exit_field.h"
#include "engine/path/path_pass.h"
#include "engine/path/path_relaxation.h"
#include "interface/path/path_enter.comp.h"
#include "interface/path/path_enter_cut.comp.h"
#include "shaders/path/path_light_shared.h"

namespace quadgraph {

struct PathMethod::Parts {
  Voxels voxels;
  CellCosts costs;
  PathRelaxation paths;
  ExitField field;
  std::array<std::optional<device::ComputePass>, 2> enter,
      enter_cut;  // without shaped lights and with; made at first use

  explicit Parts(device::Device& device) : voxels(device), costs(device), paths(device), field(device) {}

  const device::ComputePass& enter_pass(device::Device& device, bool cuts, bool shaped) {
    auto& pass = (cuts ? enter_cut : enter)[shaped ? 1 : 0];
    if (pass) return *pass;
    return pass.emplace(device, cuts ? shader::path_enter_cut : shader::path_enter,
                        device::ComputeOptions{.variant = shaped ? 1u : 0u});
  }
};

PathMethod::PathMethod(device::Device& device) : device_(device) {}

PathMethod::~PathMethod() = default;

void PathMethod::set(const gpu::Material& material) {
  clear();
  material_ = material;
}

void PathMethod::set(const OpticalGrid& grid) {
  clear();
  grid_ = GivenGrid{grid, {grid.optical.begin(), grid.optical.end()}};
}

void PathMethod::set(std::function<GivenGrid()> grid) {
  clear();
  make_grid_ = std::move(grid);
}

void PathMethod::clear() {
  material_.reset();
  grid_.reset();
  make_grid_ = nullptr;
  stale_ = true;
}

void PathMethod::set(std::span<const Edit> edits) {
  edits_.assign(edits.begin(), edits.end());
  stale_ = true;
}

void PathMethod::set(std::span<const BodyCut> cuts) {
  const std::vector<gpu::PathTool> tools = path_tools(cuts);
  body_.reset();
  tool_count_ = static_cast<std::uint32_t>(tools.size());
  device::rewrite<gpu::PathTool>(device_, tools, "path/cuts", tools_);
}

void PathMethod::start_over() {
  parts_.reset();
  passes_.clear();
  stale_ = true;
  body_.reset();
}

PathMethod::Parts& PathMethod::parts() {
  if (!parts_) parts_ = std::make_unique<Parts>(device_);
  if (!stale_) return *parts_;
  if (make_grid_) {
    grid_ = make_grid_();
    make_grid_ = nullptr;
  }
  parts_->costs.clear();
  if (material_) parts_->costs.set(*material_);
  if (grid_) {
    grid_->grid.optical = grid_->optical;
    parts_->costs.set(grid_->grid);
  }
  parts_->costs.set(edits_);
  stale_ = false;
  body_.reset();
  return *parts_;
}

void PathMethod::light(const DisplayBuffers& mesh, const ShadowMaps& shadows, const OpticalSurface& surface) {
  Parts& own = *parts_;
  const std::uint32_t stripes = Voxels::stripes({mesh.vertices, mesh.triangles, 0, mesh.triangle_count});
  const gpu::PathEnterPush push{.grid = own.voxels.grid(),
                                .triangle_count = mesh.triangle_count,
                                .vertices = mesh.vertices.address(),
                                .triangles = mesh.triangles.address(),
                                .flags = own.voxels.cells().flags.address(),
                                .entering = own.paths.entering().address(),
                                .lights = shadows.lights().address(),
                                .shapes = shadows.shapes().address(),
                                .views = shadows.views().address(),
                                .stripes = stripes,
                                .light_count = shadows.light_count(),
                                .eta = static_cast<float>(surface.eta),
                                .coat_eta = surface.coat.eta,
                                .coat = surface.coat.share,
                                .diffuse_transmittance = static_cast<float>(diffuse_transmittance(surface)),
                                .tools = tools()};
  run_pass(
      device_, "path light", mesh.triangles.size() + 36ull * mesh.triangle_count, passes_,
      [&](device::Commands& commands) {
        commands.fill(own.paths.entering(), 0);
        commands.dispatch(own.enter_pass(device_, false, shadows.shaped()), push, 3ull * stripes * mesh.triangle_count);
        if (tool_count_ == 0) return;
        commands.dispatch(own.enter_pass(device_, true, shadows.shaped()), push, gpu::cell_count(own.voxels.grid()));
      });
}

void PathMethod::make_body(const PathMesh& mesh, const device::Buffer* rest, const PathOptions& options) {
  Parts& own = *parts_;
  if (body_ && body_->cells == options.cells && body_->cost == options.cost) return;
  body_.reset();
  own.voxels.update(mesh, options.cells, tools(), passes_);
  own.paths.make_room(own.voxels.grid());
  own.costs.run(own.voxels, mesh, rest, options.cost, own.paths.cost(), passes_);
  body_ = options;
}

PathReport PathMethod::solve(const DisplayBuffers& mesh, const device::Buffer* rest, const ShadowMaps& shadows,
                             const OpticalSurface& surface, const PathOptions& options) {
  Parts& own = parts();
  passes_.clear();
  make_body({mesh.vertices, mesh.triangles, mesh.vertex_count, mesh.triangle_count}, rest, options);
  light(mesh, shadows, surface);
  own.paths.solve(own.voxels.cells(), options.solver, passes_);
  own.field.run(own.voxels, own.paths, tools(), passes_);
  return {.options = options,
          .size = own.voxels.grid().size,
          .cell = static_cast<double>(own.voxels.grid().cell),
          .solid = own.voxels.solid(),
          .lit = own.paths.lit(),
          .rounds = own.paths.rounds()};
}

const device::Buffer& PathMethod::field() const {
  return parts_->field.field();
}

std::vector<glm::vec3> PathMethod::exitance_at(std::span<const glm::vec3> points) const {
  return parts_->field.at(points);
}

}  // namespace quadgraph
