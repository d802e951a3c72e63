// What an engine holds.
#pragma once

#include "engine/base/error.h"
#include "engine/devices/open_device.h"
#include "engine/optics/material.h"
#include "engine/reference/tet_locator.h"
#include "engine/render/body_roughness.h"
#include "engine/render/display/display_faces.h"
#include "engine/render/display/display_motion.h"
#include "engine/render/engine.h"
#include "engine/render/in_use.h"
#include "engine/render/inside/inside.h"
#include "engine/render/light/hidden_sky.h"
#include "engine/render/light/irradiance.h"
#include "engine/render/light/light_samples.h"
#include "engine/render/path_method.h"
#include "engine/render/picture/frame_offsets.h"
#include "engine/render/picture/ground.h"
#include "engine/render/picture/picture_mean.h"
#include "engine/render/picture/rasteriser.h"
#include "engine/render/picture/surface_maps.h"
#include "engine/render/picture/surroundings.h"
#include "engine/render/verdict.h"

namespace quadgraph {

struct Engine::Implementation {
  Implementation(std::shared_ptr<const QuadGraph> body, const std::filesystem::path& path,
                 std::shared_ptr<device::Device> shared)
      : source(path.filename().string()),
        shared_graph(std::move(body)),
        graph(*shared_graph),
        bounds(bounds_of(graph)),
        owned(std::move(shared)),
        device(*owned),
        simulation(graph.levels().empty() ? nullptr : std::make_unique<Simulation>(device, graph)),
        mesh(upload_display(device, graph.display())),
        motion(graph.display()),
        images(device),
        shadows(device),
        irradiance(device),
        light_samples(device),
        rasteriser(device),
        maps(device, graph),
        paths(device) {
    shadows.update(mesh, {{}, bounds});
  }

  InUse in_use{"engine"};
  std::string source;
  std::shared_ptr<const QuadGraph> shared_graph;
  const QuadGraph& graph;
  Sphere bounds;
  std::shared_ptr<device::Device> owned;
  device::Device& device;
  std::unique_ptr<Simulation> simulation;  // none of a surface without levels
  DisplayBuffers mesh;
  DisplayMotion motion;
  LightImages images;
  ShadowMaps shadows;
  IrradiancePass irradiance;
  LightSamples light_samples;
  std::optional<HiddenSky> hidden;  // where there is an environment, made at first use
  Rasteriser rasteriser;
  SurfaceMaps maps;

  std::string material;
  gpu::Material of_text{};                      // what `material` says, where it is the text of one
  Certainty certainty;                          // of it, at the vertices of level 0
  std::optional<BodyRoughness> body_roughness;  // of the materials of several bodies
  std::string index_warning;                    // the same, of the report
  std::vector<Light> lights;
  std::vector<OpticalSurface> said_surfaces{1};  // by the material, or those of all bodies
  std::optional<float> light_roughness = 0.0f;   // in place of what these say
  std::vector<OpticalSurface> surfaces{1};       // so
  bool shadows_stale = false;                    // they are not those of the present lights and shape
  bool irradiance_stale = false;                 // nor is q on the levels
  bool irradiance_rough = false;                 // q is that of a frame in motion
  bool irradiance_given = false;                 // q is not that of lights
  std::optional<NormalMap> facets_said;          // by which light is to enter
  bool facets_stale = true;                      // faces do not lean by it yet
  SolveOptions options;
  std::optional<SolveOptions> again;  // what was asked for, where the last solve is one of those of a mean
  std::optional<SolveReport> report;
  std::optional<View> view;
  Radiance radiance = Radiance::automatic;   // of the last picture
  std::optional<ErrorEstimate> shown_error;  // the same, where it was asked for
  double focus = 1;                          // of the last picture, mm
  bool averaged = false;                     // it is one of several frames
  std::optional<PictureMean> mean;           // made at first use
  std::optional<RadianceProbe> probe;        // made at first use
  device::Buffer triangle_face;              // display_faces.h, made at first use
  std::vector<PassStats> deformation_passes, irradiance_passes, light_passes, gather_passes, render_passes;
  bool deformed = false;        // since the last solve
  std::string deformation;      // in words
  std::vector<Deformer> steps;  // of the deformation, without the poses of bodies
  BodyPoses poses;
  std::shared_ptr<const VertexBodies> vertices_of_bodies;  // made at first use
  std::optional<TetLocator> locator;                       // the same, of level 0 at rest
  std::optional<std::string> overlaps;                     // what is said of overlaps of the present poses, once asked
  std::optional<Ground> ground;                            // made at first use
  std::optional<Surroundings> surroundings;                // made at first use
  std::optional<Legend> legend;                            // of the last picture
  FalseColours false_colours;                              // the same
  PathMethod paths;
  std::optional<Workspace> motion_work;      // of a surface without levels, made at first use
  std::vector<gpu::PathTool> cut_tools;      // what is cut away
  std::optional<std::vector<bool>> in_body;  // of the present lights and shape, at first use
  bool moved = false;                        // the display mesh is not at rest
  bool edited = false;                       // the material has edits

  static Sphere bounds_of(const QuadGraph& at_rest) {
    const auto& vertices = at_rest.display().vertices;
    Sphere sphere = bounding_sphere(vertices);
    sphere.outline = std::make_shared<const std::vector<glm::vec3>>(vertices.begin(), vertices.end());
    return sphere;
  }

  Sphere moved_bounds() const {
    Sphere sphere = motion.bounds();
    sphere.outline = std::make_shared<const std::vector<glm::vec3>>(device::download<glm::vec3>(device, mesh.vertices));
    return sphere;
  }

  // engine_shape.cpp
  std::vector<Deformer> checked(std::span<const Deformer> list, const BodyPoses& wanted);
  void set_shape(std::span<const Deformer> list, const BodyPoses& wanted);
  void add_overlaps(SolveReport& of);

  // Throws InputError where there are none.
  Simulation& levels() const {
    if (simulation) return *simulation;
    throw InputError(source + ": a surface without levels, which only the method shortest-path can show; " +
                     "'quadgraph bake' makes the others' levels");
  }

  // Does what the device's check may end half-way. Then what was set is kept, and nothing that was derived from it.
  template <typename Work>
  auto interruptible(const Work& work) -> decltype(work()) {
    const device::Interruptible scope(device);
    try {
      return work();
    } catch (...) {
      if (scope.given_up()) start_over();
      throw;
    }
  }

  void start_over() {
    if (simulation) simulation->start_over();
    paths.start_over();
    hidden.reset();
    probe.reset();
    ground.reset();
    report.reset();
    shadows.forget();
    stale();
  }

  void stale() {
    shadows_stale = true;
    in_body.reset();
    irradiance_stale = irradiance_stale || !lights.empty();
  }

  // Of the material. What enters the surface depends on these alone.
  void set_surfaces(std::vector<OpticalSurface> found) {
    said_surfaces = found;
    std::vector<Finish> finishes;
    for (OpticalSurface& surface : found) {
      surface.roughness = light_roughness.value_or(surface.roughness);
      finishes.push_back(surface);
    }
    if (simulation) simulation->set_finishes(finishes);
    if (found == surfaces) return;
    surfaces = std::move(found);
    stale();
  }

  // Shadow maps of the present lights.
  LightSet cast_shadows() {
    images.set_surfaces(different_surfaces(surfaces));
    LightSet set(lights, bounds, &images);
    irradiance_passes.clear();
    if (const PassStats drawn = shadows.update(mesh, set); drawn.count > 0) irradiance_passes.push_back(drawn);
    shadows_stale = false;
    return set;
  }

  bool irradiance_behind(const SolveOptions& wanted) const {
    return irradiance_stale || (irradiance_rough && !wanted.mean_rays);
  }

  // Light whose way to the surface depends on what faces see of each other.
  bool sky_shines() const { return std::ranges::any_of(lights, from_all_around); }

  void check_irradiance() const {
    if (material.empty()) throw InputError("irradiance: set a material first; the light that enters depends on eta");
    levels();
  }

  void update_irradiance(bool rough) {
    check_irradiance();
    interruptible([&] { run_irradiance(rough); });
  }

  // engine_facets.cpp
  void lean_facets();   // as said, or as the file does
  void lean_nothing();  // until lights are there again

  void run_irradiance(bool rough) {
    lean_facets();
    const LightSet set = cast_shadows();
    simulation->set_beams(set.beams);
    if (set.environments > 0) {
      if (!hidden) hidden.emplace(device, graph);
      irradiance_passes.push_back(hidden->run(*simulation, shadows, set.environments));
    }
    const std::uint32_t count = simulation->level_count();
    device::Commands commands(device, count);
    PassStats pass{.name = "irradiance", .count = count};
    for (std::uint32_t level = 0; level < count; ++level) {
      pass.bytes += irradiance.record(commands, simulation->level(level), level, shadows,
                                      hidden ? hidden->hidden(level) : 0, rough);
    }
    for (const device::PassTime& time : commands.submit_and_wait()) pass.time_ms += time.time_ms;
    irradiance_passes.push_back(pass);
    simulation->irradiance_changed();
    irradiance_stale = false;
    irradiance_rough = rough;
  }

  // Of the report, which is of a correction at rest.
  void state_light_error(const SolveOptions& wanted) {
    const LightRoom room = simulation->light_room(wanted);
    light_passes = {light_samples.run(simulation->level(0), shadows, room)};
    simulation->state_light_error(wanted, *report);
  }

  // Which of the lights stand in the body. Only those are asked for that stand within its bounds.
  const std::vector<bool>& lights_inside() {
    if (in_body) return *in_body;
    in_body.emplace(lights.size());
    for (std::size_t i = 0; i < lights.size() && simulation; ++i) {
      if (!has_position(lights[i]) || glm::distance(lights[i].position, bounds.centre) > bounds.radius) continue;
      (*in_body)[i] = is_inside(simulation->present_level(), lights[i].position);
    }
    return *in_body;
  }

  SolveReport solve_paths(const SolveOptions& wanted) {
    check_options(wanted);
    if (irradiance_given) throw InputError("shortest-path: the irradiance has been given; it needs lights instead");
    if (material.empty()) throw InputError("no material has been set");
    if (shadows_stale) cast_shadows();
    SolveReport found;
    found.method = Method::shortest_path;
    found.path = paths.solve(mesh, moved ? &motion.rest() : nullptr, shadows, surfaces[0].smooth(), wanted.path);
    return found;
  }

  // The last picture.
  const PictureBuffers& shown() const { return averaged ? mean->picture() : rasteriser.picture(); }

  // mm before the eye: what is sharp.
  double focus_of(const View& from, const Camera& camera) const {
    if (from.focus) return double{*from.focus};
    const auto vertices = device::download<glm::vec3>(device, mesh.vertices);
    const auto nearest = quadgraph::pick(graph.display(), vertices, camera, glm::vec2(0), cut_tools);
    if (!nearest) return camera.distance;
    return glm::dot(camera.eye - glm::dvec3(nearest->position), glm::dvec3(camera.backward));
  }

  void draw_frame(const View& from, const Camera& camera, const RenderOptions& render, std::uint32_t index) {
    const std::uint32_t count = frame_count(from, render);
    averaged = count > 1;
    const FrameOffset offset = frame_offset({index, count}, render.filter);
    const glm::dvec2 lens = 0.5 * double{from.aperture} * offset.lens;
    const Camera there =
        quadgraph::moved(camera, 2.0 * offset.pixel / glm::dvec2(render.width, render.height), lens, focus);
    render.show.quantity == Quantity::picture ? draw_picture(from, there, render, {index, count})
                                              : draw_inside(there, render, index == 0);
    if (!averaged) return;
    if (!mean) mean.emplace(device);
    add(render_passes, mean->add(rasteriser.picture(), index));
  }

  void add_frame(const View& from, const RenderOptions& render, std::uint32_t index) {
    if (!report) throw InputError("render: solve first; there is no exitance to show");
    const Camera camera =
        place_camera(from, bounds, static_cast<float>(render.width) / static_cast<float>(render.height));
    view = from;
    shown_error.reset();
    if (index == 0) {
      render_passes.clear();
      focus = from.aperture > 0 ? focus_of(from, camera) : 1;
    }
    interruptible([&] { draw_frame(from, camera, render, index); });
  }

  // fresh: another view than that of the last picture.
  void draw_inside(const Camera& camera, const RenderOptions& render, bool fresh) {
    if (report->path)
      throw InputError("show: with shortest-path only 'picture', found '" + to_string(render.show) + "'");
    if (fresh) {
      const Inside inside =
          inside_of({device, levels(), graph, *report, options, certainty, bounds, camera.seen_from()}, render.show);
      false_colours = {};  // two need not fit beside each other
      false_colours = upload_false_colours(device, inside.mesh, inside.plane, inside.legend.diverging);
      legend = inside.legend;
    }
    add_all(rasteriser.run(false_colours, camera, render.width, render.height));
  }

  void add_all(const std::vector<PassStats>& passes) {
    for (const PassStats& pass : passes) add(render_passes, pass);
  }

  const GatherField& gather(Gather what) {
    std::vector<PassStats> passes;
    const GatherField& field = levels().gather(what, passes);
    if (!passes.empty()) gather_passes = std::move(passes);
    display_room();
    return field;
  }

  // Each body's own, unless the picture says one for all, or places one itself.
  const BodyRoughness* own_roughness(const RenderOptions& render) const {
    return body_roughness && !render.roughness && !render.roughness_map ? &*body_roughness : nullptr;
  }

  float roughness(const RenderOptions& render) const {
    if (render.roughness) return *render.roughness;
    return body_roughness ? body_roughness->least() : stated_roughness(material).value_or(default_roughness);
  }

  // Of the roughest coat, by which environments are mirrored in all; 0 where there is none.
  float coat_roughness() const {
    float most = 0;
    for (const OpticalSurface& surface : surfaces) {
      if (surface.coat.share > 0) most = std::max(most, surface.coat.roughness);
    }
    return most;
  }

  // The picture's, or the file's own.
  const std::optional<NormalMap>& normals(const RenderOptions& render) {
    return render.normal_map ? render.normal_map : maps.own_normals();
  }

  // Alphas of the two pictures of an environment that are mixed to what is mirrored; the second is 0 where all of the
  // surface is as rough.
  glm::vec2 mirrored(const RenderOptions& render) {
    const BodyRoughness* own = own_roughness(render);
    const glm::vec2 found{roughness(render), render.roughness_map ? render.roughness_map->roughness
                                             : own                ? own->most()
                                                                  : 0};
    const std::optional<NormalMap>& map = normals(render);
    if (!map) return found;
    const float least = found.y > 0 ? std::min(found.x, found.y) : found.x, most = std::max(found.x, found.y);
    return {least, std::min(std::sqrt(most * most + map->spread()), 1.0f)};
  }

  // engine_picture.cpp
  // The body as it looks; how its radiance left, never automatic.
  Radiance draw_surface(const Camera& camera, const RenderOptions& render, const PictureFrame& frame);
  void draw_picture(const View& from, const Camera& camera, const RenderOptions& render, const PictureFrame& frame);

  // None of shortest paths, which know no faces.
  std::optional<GroundSource> ground_source() const {
    if (report->path) return std::nullopt;
    return GroundSource{graph.levels()[0], simulation->level(0), simulation->exitance()};
  }

  void display_room() {
    if (triangle_face.size() > 0) return;
    const auto faces = display_faces(graph.display(), graph.levels()[0], [this] { device.heed(); });
    triangle_face = device::upload<std::uint32_t>(device, faces, "display/faces of triangles");
  }
};

}  // namespace quadgraph
