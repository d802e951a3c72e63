// The diffusion solve on the GPU: every level's geometry, material, operator and solution as storage buffers.
//
// Per frame: (material) -> coefficients at the nodes -> operator rows on every level -> right-hand side from the light
// -> solve, coarsest level first -> exitance. Only what changed since the last solve is done again: a new material
// re-assembles and walks the source anew, new light only walks it.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/graph/deformer.h"
#include "engine/graph/edit.h"
#include "engine/graph/graph.h"
#include "engine/graph/solution.h"
#include "engine/vk/context.h"
#include "engine/vk/memory.h"
#include "shaders/solve_shared.h"

namespace quadgraph {

// One kind of pass in a frame.
struct PassStats {
  std::string name;
  double time_ms = 0;       // device time, all dispatches together
  std::uint64_t bytes = 0;  // bytes the algorithm reads and writes, all dispatches together
  std::uint32_t count = 0;  // dispatches that did work
};

// Geometry and fields of one level on the device. Counts as in Level.
struct LevelBuffers {
  std::uint32_t vertex_count = 0, tet_count = 0, face_count = 0, node_count = 0, surface_vertex_count = 0;
  vk::Buffer vertices;   // vec3, mm
  vk::Buffer tets;       // uvec4
  vk::Buffer faces;      // uvec3
  vk::Buffer face_tets;  // uint
  vk::Buffer face_kind;  // uint; 0 open, 1 reflecting
  // The open faces at surface vertex v: face_incidence[k], k from face_offset[v] to face_offset[v + 1].
  vk::Buffer face_offset, face_incidence;
  vk::Buffer links;       // uvec4; for the graph methods, made at first use
  vk::Buffer nodes;       // vec3, mm; inner nodes, then surface nodes; for the graph methods, made at first use
  vk::Buffer rest;        // the same where the file has them, as far as optical goes: the material moves with the body
  vk::Buffer optical;     // Optical per node; of the tets alone, or one for all (Coefficients), where that is enough
  bool even = false;      // optical is the same everywhere, and read from the first
  gpu::LeastTet least{};  // of the tets in the present shape
  bool inverted = false;  // some of them are turned inside out
  vk::Buffer q;           // vec3 per face, W/mm^2: written by the lights or by set_irradiance
  vk::Buffer beam_q;      // float, per beam (BeamBuffers) gpu::Beam::floats per face: what q is made of
  vk::Buffer sky;         // float per face: share of even light from outside that no other part of the body hides

  // Where the last beam begins in beam_q, that of light that enters again, bytes.
  std::uint64_t beam_again() const { return beam_q.size() - face_count * gpu::BEAM_RGB * sizeof(float); }
};

// What the faces of one level see of each other, on the device: per face the first of its entries and one past the
// last, uvec2; entries, the faces that `rays` cosine-weighted rays met (docs/qgraph-format.md).
struct SeenRows {
  std::uint32_t level;
  const vk::Buffer& rows;
  const vk::Buffer& entries;
  std::uint32_t rays;
};

class GatherField;
struct Workspace;

// What view rays gather.
enum class Gather {
  scaled,  // all light scattered once more, scaled to the exitance
  single,  // light that is scattered once in all, beside the exitance of a diffuser
};

class Simulation {
 public:
  // `graph` is copied to the device; it must stay alive (its spans are used to set up row structures lazily).
  Simulation(vk::Context& context, const QuadGraph& graph);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  std::uint32_t level_count() const;
  const LevelBuffers& level(std::uint32_t level) const;

  // Of the present shape, as far as solves have brought them up to date; none where no face sees another, or where the
  // file does not say. Made at first use.
  std::optional<SeenRows> seen();

  // Throws InputError as check_material does.
  void set_material(const gpu::Material& material);

  // Coefficients instead of a material, one per node of `level` (inner, then surface); wanted for every level, and kept
  // until set_material. Throws InputError on a wrong size or value.
  void set_optical(std::uint32_t level, std::span<const gpu::Optical> optical, float eta);

  // Edits of the material or the coefficients, one after the other, in place of those before; kept for what is set
  // later. Throws InputError naming the edit and as check_edit.
  void set_edits(std::span<const Edit> edits);

  // Index of refraction of what was set. Throws InputError before that, or if a level of set_optical is missing.
  float eta() const;

  // The beams that light is made of, whose offsets need not be set. level.beam_q then has room for what they store;
  // whoever fills beam_q and q on the device calls irradiance_changed. Both are zero after a change of that room.
  void set_beams(std::span<const gpu::Beam> beams);

  // To be called by whoever wrote q and beam_q of all levels on the device.
  void irradiance_changed();

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
  // conjugate gradients break down or a value is not finite.
  SolveReport solve(const SolveOptions& options);

  // Passes of the last solve.
  const std::vector<PassStats>& passes() const;

  // Results of the last solve, level 0.
  SurfaceField surface_field() const;
  std::vector<glm::vec3> phi() const;  // per carrier of the method

  // The exitance that the last solve found on a level, W/mm^2 per outside face, scattered. Throws InputError if it did
  // not go over that level.
  std::vector<glm::vec3> exitance_on(std::uint32_t level);

  // vec3 per surface vertex of level 0, W/mm^2, for display: of scattered light, and of light that was not.
  const vk::Buffer& vertex_exitance() const;
  const vk::Buffer& vertex_unscattered() const;

  // Whether all of the last solve's radiance can be gathered along view rays (see gathers).
  bool can_gather() const;

  // What view rays gather in the last solve, computed when it is first asked for; `passes` gets what that took. Throws
  // InputError for Gather::scaled unless can_gather.
  const GatherField& gather(Gather what, std::vector<PassStats>& passes);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace quadgraph
