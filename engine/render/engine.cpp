#include "engine/render/engine.h"

#include <algorithm>

#include "engine/graph/error.h"
#include "engine/graph/material.h"
#include "engine/render/display_faces.h"
#include "engine/render/display_motion.h"
#include "engine/render/ground.h"
#include "engine/render/hidden_sky.h"
#include "engine/render/inside.h"
#include "engine/render/irradiance.h"
#include "engine/render/legend.h"
#include "engine/render/metadata.h"
#include "engine/render/rasteriser.h"
#include "engine/render/surroundings.h"
#include "engine/render/text.h"

namespace quadgraph {
namespace {

constexpr float least_roughness = 0.02f;

// Adds to the entry of the same name.
void add(std::vector<PassStats>& passes, const PassStats& more) {
  auto same = std::find_if(passes.begin(), passes.end(), [&](const auto& p) { return p.name == more.name; });
  if (same == passes.end()) same = passes.insert(passes.end(), {.name = more.name});
  same->time_ms += more.time_ms;
  same->bytes += more.bytes;
  same->count += more.count;
}

void check_roughness(float roughness) {
  if (roughness >= least_roughness && roughness <= 1) return;
  throw InputError("roughness: found " + number_text(roughness) + ", expected " + number_text(least_roughness) +
                   " to 1");
}

constexpr std::pair<Radiance, std::string_view> radiance_names[] = {
    {Radiance::gathered, "gathered"}, {Radiance::lambertian, "lambertian"}, {Radiance::automatic, "auto"}};

}  // namespace

struct Engine::Implementation {
  Implementation(const std::filesystem::path& path, const vk::ContextOptions& device)
      : source(path.filename().string()),
        graph(QuadGraph::load(path)),
        bounds(bounding_sphere(graph.display().vertices)),
        context(device),
        simulation(context, graph),
        mesh(upload_display(context, graph.display())),
        motion(graph.display()),
        images(context),
        shadows(context),
        irradiance(context),
        rasteriser(context) {
    shadows.update(mesh, {{}, bounds});
  }

  std::string source;
  QuadGraph graph;
  Sphere bounds;
  vk::Context context;
  Simulation simulation;
  DisplayBuffers mesh;
  DisplayMotion motion;
  LightImages images;
  ShadowMaps shadows;
  IrradiancePass irradiance;
  std::optional<HiddenSky> hidden;  // where there is an environment, made at first use
  Rasteriser rasteriser;

  std::string material;
  std::vector<Light> lights;
  bool irradiance_stale = false;
  SolveOptions options;
  std::optional<SolveReport> report;
  std::optional<View> view;
  Radiance radiance = Radiance::automatic;  // of the last picture
  std::optional<RadianceProbe> probe;       // made at first use
  vk::Buffer triangle_face;                 // display_faces.h, made at first use
  std::vector<PassStats> deformation_passes, irradiance_passes, gather_passes, render_passes;
  bool deformed = false;                                // since the last solve
  std::string deformation;                              // in words
  std::optional<Ground> ground;                         // made at first use
  std::optional<Surroundings> surroundings;             // made at first use
  std::shared_ptr<const ImagePyramid> roughness_image;  // of the last picture
  vk::Buffer roughness_texels, rest_vertices;           // at first use
  std::optional<Legend> legend;                         // of the last picture
  FalseColours false_colours;                           // the same

  void draw_inside(const Camera& camera, const RenderOptions& render) {
    const Inside inside = inside_of({context, simulation, graph, *report, options, bounds, camera.eye}, render.show);
    false_colours = {};  // two need not fit beside each other
    false_colours = upload_false_colours(context, inside.mesh, inside.plane, inside.legend.diverging);
    legend = inside.legend;
    render_passes = rasteriser.run(false_colours, camera, render.width, render.height);
  }

  PlacedRoughness placed_roughness(const RoughnessMap& map) {
    if (rest_vertices.size() == 0) {
      rest_vertices = vk::upload<glm::vec3>(context, graph.display().vertices, "display/at rest");
    }
    if (roughness_image != map.image) {
      roughness_texels = vk::upload<glm::vec3>(context, map.image->texels, "picture/roughness image");
      roughness_image = map.image;
    }
    return {roughness_texels,
            rest_vertices,
            image_box(map.placement),
            {0, map.image->columns, map.image->rows, map.image->levels},
            map.roughness};
  }

  const GatherField& gather() {
    std::vector<PassStats> passes;
    const GatherField& field = simulation.gather(passes);
    if (!passes.empty()) gather_passes = std::move(passes);
    display_room();
    return field;
  }

  void display_room() {
    if (triangle_face.size() > 0) return;
    triangle_face = vk::upload<std::uint32_t>(context, display_faces(graph.display(), graph.levels()[0]),
                                              "display/faces of triangles");
  }
};

void check_options(const RenderOptions& options) {
  for (std::uint32_t side : {options.width, options.height}) {
    if (side < 1 || side > largest_side) {
      throw InputError("size: found " + std::to_string(options.width) + "x" + std::to_string(options.height) +
                       ", expected 1 to " + std::to_string(largest_side) + " pixels a side");
    }
  }
  check_roughness(options.roughness);
  if (!options.roughness_map) return;
  if (!options.roughness_map->image) throw InputError("roughness_map, image: found none");
  check_roughness(options.roughness_map->roughness);
  check_placement(options.roughness_map->placement);
}

Radiance radiance_from_name(std::string_view name) {
  for (const auto& [radiance, text] : radiance_names) {
    if (text == name) return radiance;
  }
  throw InputError("radiance '" + std::string(name) + "': allowed are gathered, lambertian, auto");
}

std::string_view name_of(Radiance radiance) {
  return std::find_if(std::begin(radiance_names), std::end(radiance_names),
                      [&](const auto& entry) { return entry.first == radiance; })
      ->second;
}

Engine::Engine(const std::filesystem::path& path, const vk::ContextOptions& device)
    : implementation_(std::make_unique<Implementation>(path, device)) {}

Engine::~Engine() = default;

const QuadGraph& Engine::graph() const {
  return implementation_->graph;
}

vk::Context& Engine::context() const {
  return implementation_->context;
}

Simulation& Engine::simulation() {
  return implementation_->simulation;
}

const Sphere& Engine::bounds() const {
  return implementation_->bounds;
}

void Engine::set_material(std::string_view text) {
  set_material(parse_material(text));
  implementation_->material = text;
}

void Engine::set_material(const gpu::Material& material) {
  auto& self = *implementation_;
  self.simulation.set_material(material);
  self.material = material_text(material);
  self.irradiance_stale = self.irradiance_stale || !self.lights.empty();
}

void Engine::set_optical(std::uint32_t level, std::span<const gpu::Optical> optical, float eta) {
  auto& self = *implementation_;
  self.simulation.set_optical(level, optical, eta);
  self.material = "coefficients per node, eta=" + number_text(eta);
  self.irradiance_stale = self.irradiance_stale || !self.lights.empty();
}

void Engine::set_edits(std::span<const Edit> edits) {
  implementation_->simulation.set_edits(edits);
}

void Engine::set_lights(std::vector<Light> lights) {
  for (const Light& light : lights) check_light(light);
  implementation_->images.load(lights);
  implementation_->lights = std::move(lights);
  implementation_->irradiance_stale = true;
}

void Engine::set_deformation(std::span<const Deformer> list) {
  auto& self = *implementation_;
  for (const Deformer& deformer : list) check_deformer(deformer);
  check_shapes(list, self.graph);
  const auto also = [&](Workspace& work) { self.motion.record(work, list, self.mesh); };
  if (!self.simulation.set_deformation(list, self.motion.rest_box(), also)) return;
  self.bounds = list.empty() ? bounding_sphere(self.graph.display().vertices) : self.motion.bounds();
  self.irradiance_stale = self.irradiance_stale || !self.lights.empty();
  self.deformed = true;
  self.deformation = summary_of(list);
  if (self.ground) self.ground->invalidate();
  self.report.reset();
}

void Engine::set_irradiance(std::uint32_t level, std::span<const glm::vec3> q,
                            const std::optional<glm::vec3>& direction) {
  auto& self = *implementation_;
  self.simulation.set_irradiance(level, q, direction);
  if (!self.lights.empty()) self.shadows.update(self.mesh, {{}, self.bounds});
  self.lights.clear();
  self.irradiance_stale = false;
}

void Engine::update_irradiance() {
  auto& self = *implementation_;
  if (self.material.empty()) throw InputError("irradiance: set a material first; the light that enters depends on eta");
  self.images.set_eta(self.simulation.eta());
  const LightSet lights(self.lights, self.bounds, &self.images);
  self.irradiance_passes = {self.shadows.update(self.mesh, lights)};
  self.simulation.set_beams(lights.beams);
  if (lights.environments > 0) {
    if (!self.hidden) self.hidden.emplace(self.context, self.graph);
    self.irradiance_passes.push_back(
        self.hidden->run(self.simulation, self.shadows, lights.environments, self.simulation.eta()));
  }
  for (std::uint32_t level = 0; level < self.simulation.level_count(); ++level) {
    add(self.irradiance_passes,
        self.irradiance.run(self.simulation.level(level), level, self.shadows, self.simulation.eta(),
                            self.hidden ? self.hidden->hidden(level) : 0));
  }
  self.simulation.irradiance_changed();
  self.irradiance_stale = false;
}

void Engine::make_room(const SolveOptions& options) {
  auto& self = *implementation_;
  if (self.irradiance_stale) update_irradiance();
  const bool gathered = options.method == Method::fem && options.source == Source::buried;
  self.simulation.make_room(options, gathered);
  if (gathered) self.display_room();
}

SolveReport Engine::solve(const SolveOptions& options) {
  auto& self = *implementation_;
  if (self.irradiance_stale) update_irradiance();
  self.gather_passes.clear();
  self.deformation_passes.clear();
  if (self.deformed) self.deformation_passes = self.simulation.deformation_passes();
  self.deformed = false;
  self.report = self.simulation.solve(options);
  self.options = options;
  return *self.report;
}

SurfaceField Engine::surface_field() const {
  return implementation_->simulation.surface_field();
}

const PictureBuffers& Engine::draw(const View& view, const RenderOptions& options) {
  auto& self = *implementation_;
  check_options(options);
  if (!self.report) throw InputError("render: solve first; there is no exitance to show");
  const Camera camera =
      place_camera(view, self.bounds, static_cast<float>(options.width) / static_cast<float>(options.height));
  self.view = view;
  if (options.show.quantity != Quantity::picture) {
    self.draw_inside(camera, options);
    return self.rasteriser.picture();
  }
  self.legend.reset();
  std::optional<GatherView> gather;
  if (options.radiance == Radiance::gathered ||
      (options.radiance == Radiance::automatic && self.simulation.can_gather())) {
    const GatherField& field = self.gather();
    gather.emplace(field, self.triangle_face);
  }
  const auto& map = options.roughness_map;
  self.images.set_roughness(options.roughness, map ? map->roughness : 0);
  std::optional<PlacedRoughness> placed;
  if (map) placed.emplace(self.placed_roughness(*map));
  self.render_passes = self.rasteriser.run({.mesh = self.mesh,
                                            .finest = self.simulation.level(0),
                                            .vertex_exitance = self.simulation.vertex_exitance(),
                                            .vertex_unscattered = self.simulation.vertex_unscattered(),
                                            .shadows = self.shadows,
                                            .eta = self.simulation.eta(),
                                            .roughness = options.roughness,
                                            .placed_roughness = placed ? &*placed : nullptr,
                                            .gather = gather ? &*gather : nullptr},
                                           camera, options.width, options.height);
  self.radiance = gather ? Radiance::gathered : Radiance::lambertian;
  if (options.ground) {
    if (!self.ground) self.ground.emplace(self.context);
    self.render_passes.push_back(self.ground->run(self.mesh, self.bounds, view, camera, self.rasteriser.picture()));
  }
  if (options.surroundings) {
    if (!self.surroundings) self.surroundings.emplace(self.context);
    PictureBuffers& picture = self.rasteriser.picture();
    PassStats pass;
    picture.has_surroundings = self.surroundings->run(self.lights, view, camera, picture, pass);
    if (picture.has_surroundings) self.render_passes.push_back(pass);
  }
  return self.rasteriser.picture();
}

Picture Engine::render(const View& view, const RenderOptions& options) {
  Picture picture = read_picture(implementation_->context, draw(view, options));
  if (const auto& shown = legend()) draw_legend(picture, *shown);
  return picture;
}

const std::optional<Legend>& Engine::legend() const {
  return implementation_->legend;
}

std::optional<Picked> Engine::pick(const View& view, float aspect, const glm::vec2& at) const {
  auto& self = *implementation_;
  const auto vertices = vk::download<glm::vec3>(self.context, self.mesh.vertices);
  return quadgraph::pick(self.graph.display(), vertices, place_camera(view, self.bounds, aspect), view.vertical_fov,
                         aspect, at);
}

Leaving Engine::leaving(std::span<const std::uint32_t> face, std::span<const glm::vec3> direction) {
  auto& self = *implementation_;
  if (!self.report) throw InputError("radiance: solve first");
  const GatherField& field = self.gather();
  if (!self.probe) self.probe.emplace(self.context);
  return self.probe->run(self.simulation.present_level(), field, self.simulation.eta(), face, direction);
}

std::vector<PassStats> Engine::passes() const {
  const auto& self = *implementation_;
  std::vector<PassStats> all;
  for (const auto* passes : {&self.deformation_passes, &self.irradiance_passes, &self.simulation.passes(),
                             &self.gather_passes, &self.render_passes}) {
    all.insert(all.end(), passes->begin(), passes->end());
  }
  return all;
}

std::uint64_t Engine::device_bytes() const {
  return implementation_->context.allocated_bytes();
}

const std::map<std::string, std::uint64_t>& Engine::memory() const {
  return implementation_->context.allocated_by_purpose();
}

std::uint64_t Engine::allocation_count() const {
  return implementation_->context.allocation_count();
}

std::uint64_t Engine::peak_device_bytes() const {
  return implementation_->context.peak_allocated_bytes();
}

Metadata Engine::metadata() const {
  const auto& self = *implementation_;
  if (!self.report) return {};
  return describe({self.source, self.material, self.lights, self.deformation, self.options, *self.report, self.view,
                   name_of(self.radiance), self.context.info()});
}

}  // namespace quadgraph
