#include "engine/derivative/inside.h"

#include "engine/derivative/lights.h"
#include "engine/reference/view_ray.h"

namespace quadgraph {
namespace {

// The light at a vertex of all beams; `again` gives what enters again as numbers.
template <class Numbers, class Again>
UncollidedLight<typename Numbers::Real> light_at(const Follower<Numbers>& follower, const Numbers& numbers,
                                                 std::uint32_t v, const Entering& light, const Again& again) {
  UncollidedLight<typename Numbers::Real> sum;
  for (std::size_t i = 0; i < light.lights.size(); ++i) {
    add(sum, follower.at(v, light.lights[i].beam, GivenLight(numbers, light.lights[i].quarters, i)));
  }
  if (light.check) light.check();
  if (!light.again.empty()) add(sum, follower.at(v, {gpu::BEAM_MEAN, {}, {}, {}}, again));
  return sum;
}

struct PlainFields {
  const InsideFields& fields;

  InsideValues<double> at(std::uint32_t v, int c) const {
    return {fields.phi[v][c], fields.entry[v][c], fields.depth[v][c]};
  }
};

struct DualFields {
  const InsideFields &fields, &change;

  InsideValues<Dual> at(std::uint32_t v, int c) const {
    return {{fields.phi[v][c], change.phi[v][c]},
            {fields.entry[v][c], change.entry[v][c]},
            {fields.depth[v][c], change.depth[v][c]}};
  }
};

struct TracedFields {
  const InsideFields& fields;
  InsideFields& by;

  InsideValues<Traced> at(std::uint32_t v, int c) const {
    Tape& tape = Tape::active();
    return {tape.input(fields.phi[v][c], by.phi[v][c]), tape.input(fields.entry[v][c], by.entry[v][c]),
            tape.input(fields.depth[v][c], by.depth[v][c])};
  }
};

// Calls take(sample, radiance) for each.
template <class Numbers, class Fields, class Take>
void gather_all(const Inside& inside, const Numbers& numbers, const Fields& fields, std::span<const ViewSample> samples,
                const Take& take) {
  ViewRay ray(inside.level, inside.problem, numbers, fields, {}, {differentiable_end, differentiable_end});
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Inward inward = inward_of(inside.level, inside.problem.eta, samples[i].face, samples[i].outside);
    auto radiance = ray.run(samples[i].face, samples[i].barycentric, inward.direction);
    for (auto& channel : radiance) channel = channel * inward.leaves;
    take(i, radiance);
  }
}

}  // namespace

void Inside::uncollided(const Entering& light, InsideFields& fields) const {
  const PlainNumbers numbers(at);
  const Follower follower(level, problem, numbers, shape);
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    const auto here = light_at(follower, numbers, v, light, AgainLight<double>{light.again});
    fields.entry[v] = {here.entry[0], here.entry[1], here.entry[2]};
    fields.depth[v] = {here.depth[0], here.depth[1], here.depth[2]};
  }
}

void Inside::uncollided_tangent(const Parameters& along, const Entering& light, std::span<const glm::dvec3> again,
                                InsideFields& fields) const {
  const DualNumbers numbers(at, along);
  const Follower follower(level, problem, numbers, shape);
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    const auto here = light_at(follower, numbers, v, light, DualAgainLight{light.again, again});
    fields.entry[v] = {here.entry[0].slope, here.entry[1].slope, here.entry[2].slope};
    fields.depth[v] = {here.depth[0].slope, here.depth[1].slope, here.depth[2].slope};
  }
}

void Inside::uncollided_adjoint(const InsideFields& weights, const Entering& light, Parameters& gradient,
                                std::span<glm::dvec3> by_again) const {
  Tape tape;
  const Tape::Recording recording(tape);
  const TracedNumbers numbers(at, gradient);
  const Follower follower(level, problem, numbers, shape);
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    if (weights.entry[v] == glm::dvec3(0) && weights.depth[v] == glm::dvec3(0)) continue;
    const auto here = light_at(follower, numbers, v, light, TracedAgainLight{light.again, by_again});
    for (std::size_t c = 0; c < 3; ++c) {
      tape.weigh(here.entry[c], weights.entry[v][static_cast<int>(c)]);
      tape.weigh(here.depth[c], weights.depth[v][static_cast<int>(c)]);
    }
    tape.back();
    tape.clear();
  }
}

std::vector<glm::dvec3> Inside::gathered(const InsideFields& fields, std::span<const ViewSample> samples) const {
  std::vector<glm::dvec3> result(samples.size());
  gather_all(*this, PlainNumbers(at), PlainFields{fields}, samples,
             [&](std::size_t i, const auto& radiance) { result[i] = {radiance[0], radiance[1], radiance[2]}; });
  return result;
}

std::vector<glm::dvec3> Inside::gathered_tangent(const InsideFields& fields, const Parameters& along,
                                                 const InsideFields& change,
                                                 std::span<const ViewSample> samples) const {
  std::vector<glm::dvec3> result(samples.size());
  gather_all(*this, DualNumbers(at, along), DualFields{fields, change}, samples,
             [&](std::size_t i, const auto& radiance) {
               result[i] = {radiance[0].slope, radiance[1].slope, radiance[2].slope};
             });
  return result;
}

void Inside::gathered_adjoint(const InsideFields& fields, std::span<const glm::dvec3> weights,
                              std::span<const ViewSample> samples, Parameters& gradient,
                              InsideFields& by_fields) const {
  Tape tape;
  const Tape::Recording recording(tape);
  gather_all(*this, TracedNumbers(at, gradient), TracedFields{fields, by_fields}, samples,
             [&](std::size_t i, const auto& radiance) {
               for (std::size_t c = 0; c < 3; ++c) tape.weigh(radiance[c], weights[i][static_cast<int>(c)]);
               tape.back();
               tape.clear();
             });
}

}  // namespace quadgraph
