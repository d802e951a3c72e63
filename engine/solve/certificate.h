// Random walks of the light through the tets: what a corrected exitance is off by, measured by what shares nothing with
// the solution but the tets, their coefficients and the light on the faces.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "engine/reference/solution.h"
#include "engine/solve/beams.h"
#include "engine/solve/level_buffers.h"
#include "engine/solve/patch_sums.h"
#include "engine/solve/workspace.h"
#include "shaders/solver/solve_shared.h"

namespace quadgraph {

// The solution, on the finest level.
struct CertifiedSolution {
  Workspace& work;
  const LevelBuffers& level;
  const BeamBuffers& beams;
  const device::Buffer& field;  // TransportFieldRef
  const SurfaceField& surface;  // position and normal are not looked at
  gpu::Scale scale;             // of the light
  glm::dvec3 entered;           // W
  glm::vec3 g;                  // mean cosine of the angle by which light scatters
  std::span<const glm::vec3>
      importance;  // per vertex, as of importance.h, above zero: guides walks; empty: nothing does
};

class Certifier {
 public:
  // `level`: the finest, whose faces stay what they are.
  Certifier(device::Device& device, const Level& level);

  // Walks for about so long; 0: a number of them that does not depend on the machine. `check` is called every half a
  // second at the latest; what it throws ends it.
  Certificate run(const CertifiedSolution& solution, double seconds, std::uint32_t seed,
                  const std::function<void()>& check);

  // By the walks of the last run.
  WalkedExitance exitance(device::Device& device) const;

 private:
  // Walks that were made: what the sums of `batch` are of, in walks that each stand for the unit.
  struct Made {
    std::array<double, walk_batches> weight{};
    double walks = 0, segments = 0;
    glm::dvec3 given_up{0};  // W, of all of them
    double seconds = 0;
  };

  // What to do: for about so long, or a number.
  struct Task {
    bool guided = false;
    double seconds = 0;
    std::uint32_t seed = 0;
    const std::function<void()>& check;
  };

  void round(const CertifiedSolution& solution, const Task& task, double walks, std::uint32_t number, Made& made);
  void forget(Workspace& work);
  // Walks in rounds, behind one that tells how fast they are.
  Made measure(const CertifiedSolution& solution, const Task& task);
  // The whole surface, its unlit part and its dimmest third.
  std::array<PatchSums, 3> parts_of(const CertifiedSolution& solution, const Made& made) const;

  std::vector<std::uint32_t> patch_;  // per face
  std::vector<float> area_;           // per face, mm^2, of the last run, as what follows
  std::array<double, walk_batches> weight_{};
  glm::dvec3 scale_{0};
  device::Buffer importance_;  // vec3 per vertex, where walks are guided
  device::Buffer leaving_;     // fixed point, per batch and face
  device::Buffer sums_, sums_on_host_;
};

// Says where what is stated of a report's error is less than what its certificate measured, by more than three standard
// errors and what the estimate leaves open (mesh_error.h).
void state_disagreement(SolveReport& report);

// States what walks that knew of g have found beyond all that is stated, and adds it to that.
void add_phase_error(SolveReport& report);

}  // namespace quadgraph
