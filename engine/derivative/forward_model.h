// What a body answers to light as a function of what it is made of, with its exact derivatives: J v and J^T w.
//
// The function is that of the CPU reference for linear elements and the buried source (engine/reference/reference.h),
// on one level, with the inter-reflection of exchange.h and the gathered radiance of radiance.h, but without what is
// done to them for display (even_exitance.h, gather_scale.h, smooth normals):
//
//   b = rays of the lights and of q,   A x = b,   M = positive(k11 phi + k12 phi2),   E = received(M + (1 - T_d) E),
//   q = T_d E,   L = gathered(phi, rays back from the vertices to the lights and to q)
//
// Tangent and adjoint solve the same symmetric A with other right-hand sides, once for every bounce; all that lies
// between is differentiated by the numbers that the reference's own kernels run on (dual.h, traced.h), once, and kept
// for all products (sparse_rows.h, source.h).
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "engine/derivative/inside.h"
#include "engine/derivative/parameters.h"
#include "engine/file/graph.h"
#include "engine/reference/operator.h"
#include "engine/reference/uncollided.h"

namespace quadgraph {

// By what weights are differentiated: by all, or by the operator alone, while the light that enters and what view rays
// meet on their way are held fixed, as the continuous adjoint equation of inverse diffusion does [PG Eq. 5 to 7].
enum class Dependence { all, only_operator };

struct ForwardOptions {
  Model model = Model::sp3;  // not `automatic`
  double eta = 1;
  bool bounces = true;       // light that leaves the body and meets it again
  double tolerance = 1e-12;  // of solves and bounces
  // Called now and then while something is computed; what it throws ends that.
  std::function<void()> check = {};
};

class ForwardModel {
 public:
  // Solves at `at`, whose arrays have one entry per tet and per light. `level` and what `lights` refer to must stay
  // alive. Throws InputError on a wrong size, a value out of range, or a sample that does not leave an open face, and
  // as solve_reference does.
  ForwardModel(const Level& level, Parameters at, std::vector<BeamLight> lights, std::vector<ViewSample> samples,
               const ForwardOptions& options);
  ~ForwardModel();
  ForwardModel(const ForwardModel&) = delete;
  ForwardModel& operator=(const ForwardModel&) = delete;

  const Parameters& at() const;
  const Outgoing& outgoing() const;

  // J v: how what leaves changes along a direction. Throws InputError on a wrong size.
  Outgoing tangent(const Parameters& along) const;

  // J^T w: the derivative of the sum of all that leaves, times its weight, by every parameter. Throws InputError on a
  // wrong size.
  Parameters adjoint(const Outgoing& weights, Dependence dependence = Dependence::all) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace quadgraph
