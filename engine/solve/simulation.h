// The diffusion solve on the GPU: every level's geometry, material, operator and solution as storage buffers.
//
// Per frame: (material) -> coefficients at the nodes -> operator rows on every level -> right-hand side from the light
// -> solve, coarsest level first -> exitance. Only what changed since the last solve is done again: a new material
// re-assembles and walks the source anew, new light only walks it.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/pass_stats.h"
#include "engine/deform/deformer.h"
#include "engine/device/device.h"
#include "engine/device/memory.h"
#include "engine/file/graph.h"
#include "engine/optics/edit.h"
#include "engine/optics/material.h"
#include "engine/reference/solution.h"
#include "engine/solve/level_buffers.h"
#include "engine/solve/level_light.h"
#include "shaders/shared/body_shared.h"
#include "shaders/solver/solve_shared.h"

namespace quadgraph {

class Etendue;
class GatherField;
struct PerturbedSolution;
struct Workspace;

// What view rays gather.
enum class Gather {
  scaled,  // all light scattered once more, scaled to the exitance
  single,  // light that is scattered once in all, beside the exitance of a diffuser
};

// What samples of the light on level 0 are taken with, all of it on the device, in the present shape.
struct LightRoom {
  const device::Buffer& beams;       // gpu::Beam, in the order of set_beams
  const device::Buffer& difference;  // to be written (engine/solve/light_error.h)
  gpu::TreeRef tree;
  std::uint32_t rays;  // a face, of light from all around
  float sky_share;     // of the noise of these, what a mean of solves has
};

class Simulation {
 public:
  // `graph` is copied to the device; it must stay alive (its spans are used to set up row structures lazily).
  Simulation(device::Device& device, const QuadGraph& graph);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  std::uint32_t level_count() const;
  const LevelBuffers& level(std::uint32_t level) const;

  double chord() const;  // mean chord in the present shape, mm

  // What faces see of each other in the present shape, as far as solves have brought that up to date; none where no
  // face sees another, or where the file does not say. Made at first use.
  std::optional<SeenRows> seen();

  // Throws InputError as check_material does.
  void set_material(const gpu::Material& material);

  // Coefficients instead of a material, one per node of `level` (inner, then surface); wanted for every level, and kept
  // until set_material. `elsewhere`: of the finest level, one at each of points_in_tets, by which the error of having
  // one value in each tet is told; none where they are not known. Throws InputError on a wrong size or value.
  void set_optical(std::uint32_t level, std::span<const gpu::Optical> optical, float eta,
                   std::span<const gpu::Optical> elsewhere = {});

  // The same with an index of refraction for each body.
  void set_optical(std::uint32_t level, std::span<const gpu::Optical> optical, std::span<const float> eta,
                   std::span<const gpu::Optical> elsewhere = {});

  // Squares of the indices of refraction over those of the outermost bodies around, by body; all 1, or none, until this
  // is set, and after set_material. Where another it is set behind set_optical on all levels.
  void set_etendue(std::span<const float> by_body);

  // What the surface of each body is like, one for all, or none, which is bare and smooth; whatever is set besides
  // leaves it. Throws InputError on another number of them.
  void set_finishes(std::span<const Finish> finishes);

  // By which angles light scatters, of what set_optical has set on all levels.
  void set_angles(const ScatteringAngles& angles);

  // Edits of the material or the coefficients, one after the other, in place of those before; kept for what is set
  // later. Throws InputError naming the edit and as check_edit.
  void set_edits(std::span<const Edit> edits);

  // The surfaces of what was set, by body; throws InputError as `eta`.
  std::span<const OpticalSurface> surfaces() const;
  // Indices of refraction of what was set, by body. Throws InputError before that, or if a level of set_optical is
  // missing.
  std::vector<float> eta() const;

  // The beams that light is made of, whose offsets need not be set. level.beam_q then has room for what they store;
  // whoever fills beam_q and q on the device calls irradiance_changed. Both are zero after a change of that room.
  void set_beams(std::span<const gpu::Beam> beams);

  // To be called by whoever wrote q and beam_q of all levels on the device.
  void irradiance_changed();

  // Leans facets of the outside faces of a level, two numbers for each as shaders/source/leaning.glsl reads them: light
  // that enters from then on goes by these; none: by the faces.
  void set_leaning(std::uint32_t level, std::span<const glm::vec2> leaning);

  // Transmitted irradiance q >= 0, one per surface node of `level`, as the only beam: along `direction`, the way light
  // travels outside, or, without it, Lambertian. The direction given last holds for all levels. Throws InputError on a
  // wrong size or value.
  void set_irradiance(std::uint32_t level, std::span<const glm::vec3> q,
                      const std::optional<glm::vec3>& direction = std::nullopt);

  // Moves the vertices of `level`, mm, one per vertex; the material moves with the body. Lights see the new shape when
  // they are evaluated next. There is no solution until the next solve. Throws InputError, and moves nothing, on a
  // wrong size or value or where a tet would be turned inside out.
  void set_vertices(std::uint32_t level, std::span<const glm::vec3> positions);

  // Moves all levels by a list of deformers from where they lie in the file, on the device; an empty one puts them back
  // there exactly. `rest`: the box of the display mesh. `also` records what else is to run with it, unless nothing has
  // changed: false is returned then. What set_vertices did is gone. There is no solution until the next solve.
  bool set_deformation(std::span<const Deformer> list, const RestBox& rest,
                       const std::function<void(Workspace&)>& also = {});

  // Whether all vertices are where they are in the file.
  bool at_rest() const;

  // Passes of the last set_deformation that changed anything.
  const std::vector<PassStats>& deformation_passes() const;

  // Level 0 in its present shape; valid until the next motion.
  const Level& present_level() const;

  // Allocates all that `solve` with these options needs for the present coefficients and light, and with `gather` what
  // view rays gather; later solves like it allocate nothing. Throws InputError as `solve`.
  void make_room(const SolveOptions& options, bool gather);

  // Solves for the present coefficients and light, all levels. Throws InputError before they are set, SolverError when
  // conjugate gradients break down or a value is not finite. `check` is called between two draws of points of a
  // correction at rest; what it throws ends the solve, and there is no solution. Later solves go on from what it did,
  // unlike where the device's own check gives its work up. `light` is called before light is looked at, with whether
  // what faces see of each other and of the sky has changed, and may set it.
  SolveReport solve(
      const SolveOptions& options, const std::function<void()>& check = {},
      const std::function<void(bool)>& light = [](bool) {});

  // Where to say how far q is off, after a solve with these options that was corrected and is not warm.
  LightRoom light_room(const SolveOptions& options);

  // The error of the light, of what was said there, and with it all that `report`, of that solve, says of its error.
  void state_light_error(const SolveOptions& options, SolveReport& report);

  // Whether `certify` is wanted of such a solve: it was asked for, or the material says its g.
  bool certifies(const SolveOptions& options) const;

  // Random walks for options.certify seconds, or a number of them, after all else is said of the error in `report`, of
  // that solve. `check` as of `solve`.
  // `importance`: per vertex of level 0, above zero, that guides them, as light that enters meets 1 on average; empty:
  // the solution's own, where options.guided_walks want one (importance.h).
  void certify(const SolveOptions& options, SolveReport& report, const std::function<void()>& check,
               std::span<const glm::vec3> importance = {});

  // To be called where work of the device was given up half-way (device::Interruptible): keeps what was set, and
  // nothing that was derived from it.
  void start_over();

  // Passes of the last solve.
  const std::vector<PassStats>& passes() const;

  // Results of the last solve, level 0.
  SurfaceField surface_field() const;
  std::vector<glm::vec3> phi() const;        // per carrier of the method
  std::vector<glm::vec3> basic_phi() const;  // the same, of the basic fluence
  const Etendue& etendue() const;

  // What the walks found that certified the last solve. Throws InputError where none did.
  WalkedExitance walked_exitance() const;

  // The exitance that the last solve found on a level, W/mm^2 per outside face, scattered. Throws InputError if it did
  // not go over that level.
  std::vector<glm::vec3> exitance_on(std::uint32_t level);

  // The beams of the last solve's light on any level, without what enters again. Throws InputError before a solve and
  // where there is no such level.
  std::vector<LevelBeam> light_on(std::uint32_t level);

  // vec3 per outside face of level 0, W/mm^2, scattered.
  const device::Buffer& exitance() const;

  // vec3 per surface vertex of level 0, W/mm^2, for display: of scattered light, and of light that was not.
  const device::Buffer& vertex_exitance() const;
  const device::Buffer& vertex_unscattered() const;

  // SurfaceShare per surface vertex of level 0, of a last solve that was corrected; null otherwise.
  const device::Buffer* surface_share() const;

  // Optical at each of points_in_tets of level 0, of a last solve whose error has a part of the medium; null otherwise.
  const device::Buffer* elsewhere() const;

  // Whether all of the last solve's radiance can be gathered along view rays (see gathers).
  bool can_gather() const;

  // What view rays gather in the last solve, computed when it is first asked for; `passes` gets what that took. Throws
  // InputError for Gather::scaled unless can_gather.
  const GatherField& gather(Gather what, std::vector<PassStats>& passes);

 private:
  void state_medium_error(const SolveOptions& options, SolveReport& report);
  void perturb(const SolveOptions& options, SolveReport& report,
               const std::function<void(const PerturbedSolution&)>& state);

  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace quadgraph
