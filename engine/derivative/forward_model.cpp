#include "engine/derivative/forward_model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "engine/base/error.h"
#include "engine/derivative/again.h"
#include "engine/derivative/elements_by_tet.h"
#include "engine/derivative/source.h"
#include "engine/derivative/surface.h"
#include "engine/file/geometry.h"
#include "engine/optics/surface_boundary.h"
#include "engine/reference/row_solver.h"
#include "shaders/material/optics.h"

namespace quadgraph {
namespace {

using Vectors = std::vector<glm::dvec3>;

constexpr std::uint32_t most_bounces = 256;
constexpr double most_power = 1e15;  // of a factor of a light
constexpr double least_unit = 1e-6;  // how far from 1 a length or a sum may be

double size_of(const Vectors& values) {
  double sum = 0;
  for (const glm::dvec3& value : values) sum += glm::dot(value, value);
  return std::sqrt(sum);
}

double distance(const Vectors& a, const Vectors& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += glm::dot(a[i] - b[i], a[i] - b[i]);
  return std::sqrt(sum);
}

Vectors scaled(Vectors values, double factor) {
  for (glm::dvec3& value : values) value *= factor;
  return values;
}

void check_size(const std::string& name, std::size_t found, std::size_t wanted) {
  if (found != wanted) {
    throw InputError(name + ": " + std::to_string(found) + " entries, wanted are " + std::to_string(wanted));
  }
}

void check_values(const std::string& name, const Vectors& values, double most) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      if (!(values[i][c] >= 0 && values[i][c] <= most)) {
        throw InputError(name + "[" + std::to_string(i) + "]: " + std::to_string(values[i][c]) + ", allowed is 0 to " +
                         std::to_string(most));
      }
    }
  }
}

}  // namespace

struct ForwardModel::State {
  State(const Level& of, Parameters parameters, std::vector<BeamLight> given, std::vector<ViewSample> views,
        const ForwardOptions& asked)
      : level(of),
        at(std::move(parameters)),
        lights(std::move(given)),
        samples(std::move(views)),
        options(asked),
        problem{Method::fem, Source::buried, asked.model, {}, asked.eta},
        outgoing(of.faces.size(), samples.size()) {
    check();
    rows = assemble_elements(level, elements_of(at), options.model, problem.boundaries());
    if (sees_itself()) again.emplace(level, problem, at);
    solve();
  }

  void check() const {
    check_sizes(at);
    check_values("sigma_s_prime", at.scattering, gpu::COEFFICIENT_MAX);
    check_values("sigma_a", at.absorption, gpu::COEFFICIENT_MAX);
    check_values("power", at.power, most_power);
    check_eta(options.eta);
    if (options.model == Model::automatic) throw InputError("model 'auto': name one");
    for (const BeamLight& light : lights) check_size("light", light.quarters.size(), level.faces.size());
    for (std::size_t i = 0; i < samples.size(); ++i) check_sample(i);
  }

  void check_sample(std::size_t i) const {
    const std::uint32_t f = samples[i].face;
    if (f >= level.face_count() || level.reflecting(f)) {
      throw InputError("samples[" + std::to_string(i) + "]: face " + std::to_string(f) + ", allowed are open ones of " +
                       std::to_string(level.face_count()));
    }
    if (!(glm::dot(samples[i].outside, frame_of(level, f).normal) > 0)) {
      throw InputError("samples[" + std::to_string(i) + "]: a direction into the body, allowed is one out of it");
    }
    if (!(std::abs(glm::length(samples[i].outside) - 1) <= least_unit)) {
      throw InputError("samples[" + std::to_string(i) + "]: a direction of length " +
                       std::to_string(glm::length(samples[i].outside)) + ", allowed is 1");
    }
    const glm::dvec3& place = samples[i].barycentric;
    if (!(std::min({place.x, place.y, place.z}) >= 0 && std::abs(place.x + place.y + place.z - 1) <= least_unit)) {
      throw InputError("samples[" + std::to_string(i) + "]: barycentric " + std::to_string(place.x) + ", " +
                       std::to_string(place.y) + ", " + std::to_string(place.z) +
                       ", allowed are numbers >= 0 that sum to 1");
    }
  }

  void check_sizes(const Parameters& parameters) const {
    check_size("sigma_s_prime", parameters.scattering.size(), level.tets.size());
    check_size("sigma_a", parameters.absorption.size(), level.tets.size());
    check_size("power", parameters.power.size(), lights.size());
  }

  Boundary boundary() const { return problem.boundaries().of(0); }
  bool sees_itself() const { return options.bounces && level.seen.size() > level.faces.size() + 1; }
  double entering() const { return diffuse_transmittance(options.eta); }
  Entering entering_light() const { return {lights, again_q, options.check}; }

  std::vector<Field> solved(const std::vector<Field>& b) const {
    SolveOptions how = {.solver = SolverKind::dpcg, .model = options.model, .tolerance = options.tolerance};
    how.max_iterations = 100000;
    LevelReport report;
    std::vector<Field> answer = solve_rows(rows, b, how, report, options.check);
    if (!report.converged) {
      throw SolverError("a solve ended at a residual of " + std::to_string(report.residual) + ", not at the tolerance");
    }
    return answer;
  }

  static std::vector<Field> load(const Vectors& scattered) {
    std::vector<Field> b(scattered.size());
    for (std::size_t i = 0; i < b.size(); ++i) b[i].phi = scattered[i];
    return b;
  }

  Vectors flux_of(const std::vector<Field>& fluence) const {
    const Boundary k = boundary();
    Vectors flux;
    for (const Field& value : fluence) flux.push_back(k.k11 * value.phi + k.k12 * value.phi2);
    return flux;
  }

  // W per face over its area.
  Vectors per_area(Vectors power) const {
    for (std::uint32_t f = 0; f < level.face_count(); ++f) power[f] /= face_area(level, level.faces[f]);
    return power;
  }

  // Goes on with bounces until one changes E by little: `bounce` makes the next E of the last.
  template <class Bounce>
  void settle(Vectors& e, const Bounce& bounce) const {
    for (std::uint32_t k = 0; k < most_bounces; ++k) {
      Vectors next = bounce(e);
      const double change = distance(next, e);
      e = std::move(next);
      if (change <= options.tolerance * size_of(e)) return;
    }
    throw SolverError("inter-reflection did not settle in " + std::to_string(most_bounces) + " bounces");
  }

  void solve() {
    const Walked own = walk(level, problem, at, {lights, {}, options.check});
    Walked all = own;
    const auto answer = [&](const Vectors& e) {
      all = own;
      if (again) again->add(scaled(e, entering()), all);
      x = solved(load(all.scattered));
      return surface_light(level, flux_of(x), e, 1 - entering());
    };
    if (again) {
      received.assign(level.faces.size(), glm::dvec3(0));
      settle(received, [&](const Vectors& e) { return answer(e).received; });
      again_q = scaled(received, entering());
    }
    outgoing.exitance = answer(received).exitance;
    outgoing.unscattered = per_area(all.unscattered);
    surface.emplace(level, flux_of(x), received, 1 - entering());
    if (samples.empty()) return;
    shape.emplace(level, vertex_starts(level));
    fields = InsideFields(level.vertices.size());
    for (std::size_t v = 0; v < x.size(); ++v) fields.phi[v] = x[v].phi;
    inside().uncollided(entering_light(), fields);
    outgoing.radiance = inside().gathered(fields, samples);
  }

  Inside inside() const { return {level, problem, at, *shape}; }

  // What view rays gather, and the light that they meet, by what both depend on: made for the first derivative.
  struct Seen {
    InsideInputs inputs;
    SparseRows uncollided, gathered;
  };

  const Seen& seen() {
    std::call_once(seen_once, [&] {
      seen_rows.emplace(Seen{InsideInputs(at, again_q.size()), inside().uncollided_rows(entering_light()),
                             inside().gathered_rows(fields, samples)});
    });
    return *seen_rows;
  }

  const WalkedRays& walked_rays() {
    std::call_once(walked_once, [&] { rays.emplace(level, problem, at, entering_light()); });
    return *rays;
  }

  // How radiances change with the parameters, what enters again, and the fluence.
  Vectors seen_tangent(const Parameters& along, const Vectors& again_change, const std::vector<Field>& fluence) {
    const Seen& kept = seen();
    const std::size_t vertices = fluence.size(), tets = kept.inputs.tets;
    const Vectors outer = kept.inputs.joined(along, again_change);
    Vectors inner(outer.begin(), outer.begin() + static_cast<std::ptrdiff_t>(2 * tets));
    inner.resize(2 * tets + 3 * vertices);
    for (std::size_t v = 0; v < vertices; ++v) {
      inner[2 * tets + v] = fluence[v].phi;
      inner[2 * tets + vertices + v] = kept.uncollided.times(2 * v, outer);
      inner[2 * tets + 2 * vertices + v] = kept.uncollided.times(2 * v + 1, outer);
    }
    Vectors change(samples.size());
    for (std::size_t i = 0; i < change.size(); ++i) change[i] = kept.gathered.times(i, inner);
    return change;
  }

  // Of weighted radiances: adds to the gradient, unless it is to be that of the operator alone, and to what belongs to
  // light that enters again; returns the derivatives by the fluence at the vertices.
  Vectors seen_adjoint(const Vectors& weights, Dependence dependence, Parameters& gradient, Vectors& by_again) {
    const Seen& kept = seen();
    const std::size_t vertices = level.vertices.size(), tets = kept.inputs.tets;
    Vectors inner(2 * tets + 3 * vertices, glm::dvec3(0));
    for (std::size_t i = 0; i < weights.size(); ++i) kept.gathered.add_transposed(i, weights[i], inner);
    const auto of_field = [&](std::size_t number) {
      const auto first = inner.begin() + static_cast<std::ptrdiff_t>(2 * tets + number * vertices);
      return Vectors(first, first + static_cast<std::ptrdiff_t>(vertices));
    };
    if (dependence == Dependence::all) {
      const Vectors entry = of_field(1), depth = of_field(2);
      Vectors outer(inner.begin(), inner.begin() + static_cast<std::ptrdiff_t>(2 * tets));
      outer.resize(kept.inputs.count());
      for (std::size_t v = 0; v < vertices; ++v) {
        kept.uncollided.add_transposed(2 * v, entry[v], outer);
        kept.uncollided.add_transposed(2 * v + 1, depth[v], outer);
      }
      kept.inputs.add(outer, gradient, by_again);
    }
    return of_field(0);
  }

  const Level& level;
  Parameters at;
  std::vector<BeamLight> lights;
  std::vector<ViewSample> samples;
  ForwardOptions options;
  Problem problem;
  Rows rows;
  std::optional<AgainMatrix> again;
  std::vector<Field> x;
  Vectors received, again_q;  // W/mm^2 per face; empty where the body sees nothing of itself
  std::optional<Surface> surface;
  std::optional<FollowedShape> shape;  // where there are samples
  InsideFields fields{0};
  Outgoing outgoing;
  std::once_flag seen_once, walked_once;
  std::optional<Seen> seen_rows;
  std::optional<WalkedRays> rays;
};

ForwardModel::ForwardModel(const Level& level, Parameters at, std::vector<BeamLight> lights,
                           std::vector<ViewSample> samples, const ForwardOptions& options)
    : state_(std::make_unique<State>(level, std::move(at), std::move(lights), std::move(samples), options)) {}

ForwardModel::~ForwardModel() = default;

const Parameters& ForwardModel::at() const {
  return state_->at;
}

const Outgoing& ForwardModel::outgoing() const {
  return state_->outgoing;
}

Outgoing ForwardModel::tangent(const Parameters& along) const {
  State& s = *state_;
  s.check_sizes(along);
  const Walked own = s.walked_rays().tangent(s.level, along);
  const Rows change = assemble_elements(s.level, elements_along(s.at, along), s.options.model, {{Boundary{}}});
  const std::vector<Field> moved = quadgraph::apply(change, s.x);
  Walked all = own;
  std::vector<Field> change_of_x;
  const auto answer = [&](const Vectors& e) {
    all = own;
    if (s.again) s.again->add(scaled(e, s.entering()), all);
    std::vector<Field> b = State::load(all.scattered);
    for (std::size_t i = 0; i < b.size(); ++i) b[i] = b[i] - moved[i];
    change_of_x = s.solved(b);
    return s.surface->tangent(s.flux_of(change_of_x), e);
  };
  Vectors received;
  if (s.again) {
    received.assign(s.level.faces.size(), glm::dvec3(0));
    s.settle(received, [&](const Vectors& e) { return answer(e).received; });
  }
  Outgoing result(s.level.faces.size(), s.samples.size());
  result.exitance = answer(received).exitance;
  result.unscattered = s.per_area(all.unscattered);
  if (s.samples.empty()) return result;
  result.radiance = s.seen_tangent(along, scaled(received, s.entering()), change_of_x);
  return result;
}

Parameters ForwardModel::adjoint(const Outgoing& weights, Dependence dependence) const {
  State& s = *state_;
  check_size("exitance", weights.exitance.size(), s.level.faces.size());
  check_size("unscattered", weights.unscattered.size(), s.level.faces.size());
  check_size("radiance", weights.radiance.size(), s.samples.size());
  Parameters gradient(s.level.tets.size(), s.lights.size());
  Vectors by_phi(s.level.vertices.size(), glm::dvec3(0)), by_again(s.again_q.size(), glm::dvec3(0));
  if (!s.samples.empty()) by_phi = s.seen_adjoint(weights.radiance, dependence, gradient, by_again);
  Walked by_walked(s.level);
  by_walked.unscattered = s.per_area(weights.unscattered);
  std::vector<Field> by_load;
  const Boundary k = s.boundary();
  // Of the derivatives by E of the bounce after, those by E of the bounce before.
  const auto back = [&](const Vectors& by_received) {
    const Surface::Inputs by = s.surface->adjoint({weights.exitance, by_received});
    std::vector<Field> by_fluence(by.flux.size());
    for (std::size_t i = 0; i < by.flux.size(); ++i) {
      by_fluence[i] = {k.k11 * by.flux[i] + by_phi[i], k.k12 * by.flux[i]};
    }
    by_load = s.solved(by_fluence);
    for (std::size_t i = 0; i < by_load.size(); ++i) by_walked.scattered[i] = by_load[i].phi;
    Vectors before = by.received;
    if (s.again) {
      const Vectors by_q = s.again->transposed(by_walked);
      for (std::size_t f = 0; f < before.size(); ++f) before[f] += s.entering() * (by_q[f] + by_again[f]);
    }
    return before;
  };
  Vectors by_received;
  if (s.again) {
    by_received.assign(s.level.faces.size(), glm::dvec3(0));
    s.settle(by_received, back);
  }
  back(by_received);
  if (dependence == Dependence::all) s.walked_rays().adjoint(by_walked, gradient);
  add_by_elements(s.at, element_products(s.level, by_load, s.x, s.options.model), -1.0, gradient);
  return gradient;
}

}  // namespace quadgraph
