// One object, its material, lights and picture on one device: what the executable and the Python module drive.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/names.h"
#include "engine/base/range.h"
#include "engine/deform/body_poses.h"
#include "engine/deform/cut.h"
#include "engine/deform/deformer.h"
#include "engine/device/device.h"
#include "engine/file/graph.h"
#include "engine/optics/certainty.h"
#include "engine/optics/optical_grid.h"
#include "engine/render/body_material.h"
#include "engine/render/display/camera.h"
#include "engine/render/display/normal_map.h"
#include "engine/render/display/pick.h"
#include "engine/render/display/surface_roughness.h"
#include "engine/render/inside/show.h"
#include "engine/render/light/lights.h"
#include "engine/render/picture/picture.h"
#include "engine/render/picture/picture_buffers.h"
#include "engine/render/picture/pixel_filter.h"
#include "engine/render/picture/radiance_probe.h"
#include "engine/solve/simulation.h"

namespace quadgraph {

// How radiance leaves the surface.
enum class Radiance {
  gathered,    // one more step of transport along every view ray, scaled to the exitance; where that is possible
  lambertian,  // the same from every side but for Fresnel
  single,      // that, and light scattered once along the view ray, as the polygrid paper adds it
  automatic,   // "auto": gathered, else lambertian
};

template <>
struct Names<Radiance> {
  static constexpr std::string_view what = "radiance";
  static constexpr auto values = std::to_array<Named<Radiance>>(
      {{Radiance::gathered, "gathered", "one more step of transport along every view ray, scaled to the exitance"},
       {Radiance::lambertian, "lambertian", "the same from every side but for Fresnel"},
       {Radiance::single, "single",
        "as lambertian, and light scattered once along the refracted view ray (Jensen et al. 2001, Eq. 6)"},
       {Radiance::automatic, "auto", "gathered where it can be (fem and polygrids, buried), else lambertian"}});
};

inline constexpr Range side_range{.low = 1, .high = 16384};  // of a picture, pixels
inline constexpr Range samples_range{.low = 0, .high = 65536};

struct RenderOptions {
  std::uint32_t width = 1024, height = 1024;  // pixels, in side_range
  // Of a pixel, which is their mean, in samples_range, by whole frames of four; 0: as many as its edges need, or the
  // blur of the lens.
  std::uint32_t samples = 0;
  PixelFilter filter = PixelFilter::box;  // of more than four samples
  // Alpha of the GGX distribution of the surface, in roughness_range (engine/optics/material.h); empty: that of the
  // material.
  std::optional<float> roughness{};
  // The same of the surface for light that comes through it, in transmission_range; empty: the same.
  std::optional<float> transmission_roughness{};
  // By which light goes in and out in the solve of such a picture (Engine::set_light_roughness).
  std::optional<float> light_roughness() const { return transmission_roughness ? transmission_roughness : roughness; }
  Radiance radiance = Radiance::automatic;
  Show show{};                // what is to be seen
  bool ground = false;        // with a shadow where the body stands, which counts as coverage without light
  bool surroundings = false;  // environment lights are seen behind the body
  // Of Engine::render: the error of the picture, in converge_range, down to which corrections and samples run on
  // (engine/render/converging.h), and seconds that they may take, in time_limit_range; 0: no error is asked for, and
  // no limit.
  double converge = 0, time_limit = 0;
  std::optional<RoughnessMap> roughness_map{};
  std::optional<NormalMap> normal_map{};

  bool operator==(const RenderOptions&) const = default;
};

// Throws InputError naming what is out of range.
void check_options(const RenderOptions& options);

// How many frames of 2 x 2 samples a pixel a picture is made of.
std::uint32_t frame_count(const View& view, const RenderOptions& options);

// What has been set on an engine, as far as a bake can have measured it.
struct PresentScene {
  std::string file;      // name of the body's file
  std::string material;  // the text that was set, or in words what was set instead
  std::vector<Light> lights{};
  bool as_baked = true;  // the body is at rest, has no edits, and light enters as by its file
};

// Serves one thread at a time: another one that asks meanwhile, and a process forked later, get InputError.
class Engine {
 public:
  // Loads a .qgraph onto a device. Throws FormatError, InputError, DeviceError.
  explicit Engine(const std::filesystem::path& path, const device::DeviceOptions& device = {});
  Engine(const std::filesystem::path& path, std::shared_ptr<device::Device> device);
  // Of what has been loaded from there.
  Engine(std::shared_ptr<const QuadGraph> body, const std::filesystem::path& path,
         std::shared_ptr<device::Device> device);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  const QuadGraph& graph() const;
  const std::shared_ptr<const QuadGraph>& shared_graph() const;
  device::Device& device() const;
  Simulation& simulation();      // throws InputError where the file is a surface without levels
  const Sphere& bounds() const;  // of the display mesh in its present shape

  // Text as parse_material reads it, or a material. Throws InputError.
  void set_material(std::string_view text);
  void set_material(const gpu::Material& material, const Finish& finish = {.roughness = default_roughness});

  // A material for each body of a file that names them, in its order. Throws InputError where they are not as many, or
  // of several indices of refraction.
  void set_materials(std::span<const BodyMaterial> materials);

  // Coefficients instead of a material, as Simulation::set_optical.
  void set_optical(std::uint32_t level, std::span<const gpu::Optical> optical, float eta,
                   std::span<const gpu::Optical> elsewhere = {}, const Coat& coat = {});

  // Coefficients on a grid instead of a material; shortest-path takes them, other methods those of nodes. Throws
  // InputError.
  void set_optical(const OpticalGrid& grid, const Coat& coat = {});

  // How well the present coefficients are known at the vertices of level 0, for views of it; another material drops it.
  // Throws InputError unless there is one number for each vertex, or none.
  void set_certainty(Certainty certainty);

  const Certainty& certainty() const;

  // Edits of the material, see Simulation::set_edits.
  void set_edits(std::span<const Edit> edits);

  // What is cut away, in the shape as it is shown; only shortest-path can. Throws InputError naming the cut and as
  // check_cut.
  void set_cuts(std::span<const BodyCut> cuts);

  // Reads the images of lights that have them, unless that has been done. Throws InputError as check_light and
  // read_image do.
  void set_lights(std::vector<Light> lights);

  // By which facets light enters: those of this map; none: of the file's own normal texture, where it has one.
  // A strength of 0 is none of either. Throws InputError as check_options.
  void set_normal_map(const std::optional<NormalMap>& map);

  // GGX alpha of the surface by which light goes in and out in solves to come, in transmission_range, 0 for a smooth
  // one, as it is at first; empty: as the material says, default_roughness where it says none. Shortest paths know
  // smooth ones alone. Throws InputError as check_options.
  void set_light_roughness(std::optional<float> alpha);

  PresentScene present_scene() const;

  // Moves the body and what is shown of it by a list of deformers from where it lies in the file; an empty list puts it
  // back there exactly. Bounds, shadows and what the body sees of itself follow; the material stays with the body.
  // Light given by set_irradiance stays. There is no solution until the next solve. Throws InputError, and moves
  // nothing, as check_deformer does, or for shapes of another body.
  void set_deformation(std::span<const Deformer> list);

  // Puts bodies of a file that names several elsewhere, each as a rigid whole, before the deformation moves them all;
  // those without a pose lie as in the file. Where two come to overlap, solves say so (SolveReport::deformed). Else as
  // set_deformation. Throws InputError as rigid_moves.
  void set_placements(const BodyPoses& poses);

  // Both at once.
  void set_shape(std::span<const Deformer> list, const BodyPoses& poses);

  // Irradiance given instead of computed from lights, as Simulation::set_irradiance; wanted for every level, and kept
  // until set_lights.
  void set_irradiance(std::uint32_t level, std::span<const glm::vec3> q,
                      const std::optional<glm::vec3>& direction = std::nullopt);

  // Shadow maps and q on every level from the present lights and material. Throws InputError without a material.
  void update_irradiance();

  // Allocates what a solve with these options and a picture of it need, which later ones find: memory() then tells what
  // they take. Calls update_irradiance if lights or material changed since. Throws as `solve`.
  void make_room(const SolveOptions& options = {});

  // Calls update_irradiance if lights or material changed since, then solves. Throws as Simulation::solve.
  SolveReport solve(const SolveOptions& options = {}, const std::function<void()>& check = {});

  // Level 0 of the last solve. Throws InputError after one by shortest-path.
  SurfaceField surface_field() const;

  // What leaves the surface at points, mm, W/mm^2, by the last solve with shortest-path. Throws InputError otherwise.
  std::vector<glm::vec3> exitance_at(std::span<const glm::vec3> points) const;

  // The last solve seen from `view`, left on the device until the next one. Throws InputError before a solve, on an
  // option out of range, or if radiance is to be gathered and cannot be.
  const PictureBuffers& draw(const View& view, const RenderOptions& options = {});

  // The same frame by frame, `index` from 0 to below frame_count in this order, between which nothing may change: the
  // mean of those so far.
  const PictureBuffers& draw_frame(const View& view, const RenderOptions& options, std::uint32_t index);

  // What the scattered light of the last one is off by (engine/render/picture/picture_error.h), read back from the
  // device; empty where it was not gathered of a corrected solve.
  std::optional<ErrorEstimate> picture_error();

  // What it would be off by with another error of the exitance.
  std::optional<ErrorEstimate> picture_error(const ErrorEstimate& exitance) const;

  // Of that, the part of a material that changes within tets (engine/render/picture/picture_error.h).
  double medium_of_picture() const;

  // What the colours of the last one mean; nothing if it shows the body as it looks.
  const std::optional<Legend>& legend() const;

  // Draws as `draw` does and reads the picture back, with the legend in it and its error. Where an error is asked for,
  // goes on from the last solve until it is reached or cannot be, and says so (Picture::convergence); told: after each
  // step. Then it throws InputError where the error of the picture is not known.
  Picture render(const View& view, const RenderOptions& options = {},
                 const std::function<void(const ConvergenceStep&)>& told = {});

  // What a picture of this view and shape (width / height) shows at `at` (engine/render/display/pick.h).
  std::optional<Picked> pick(const View& view, float aspect, const glm::vec2& at) const;

  // Gathered radiance of the last solve that leaves the centroids of outside faces of level 0 along unit directions.
  // Throws InputError as `render` and as RadianceProbe::run.
  Leaving leaving(std::span<const std::uint32_t> face, std::span<const glm::vec3> direction);

  // Passes of the last set_deformation that the last solve followed, update_irradiance, solve and render, in this
  // order.
  std::vector<PassStats> passes() const;

  // Device memory now and at most so far, bytes, and the present one by purpose (engine/device/memory.h).
  std::uint64_t device_bytes() const;
  const std::map<std::string, std::uint64_t>& memory() const;

  // Allocations of device memory ever made.
  std::uint64_t allocation_count() const;
  std::uint64_t peak_device_bytes() const;

  // What the last picture was made with: source, material, lights, camera, method, solver, tolerance, units, device,
  // iterations, residual, energy balance, error estimate.
  Metadata metadata() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace quadgraph
