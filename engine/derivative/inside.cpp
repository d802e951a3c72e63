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

// As inputs of the active tape.
struct TracedFields {
  const InsideFields& fields;
  RecordedInputs phi, entry, depth;

  InsideValues<Traced> at(std::uint32_t v, int c) const {
    Tape& tape = Tape::active();
    return {tape.input(fields.phi[v][c], phi[v][c]), tape.input(fields.entry[v][c], entry[v][c]),
            tape.input(fields.depth[v][c], depth[v][c])};
  }
};

// Of three channels of a result, one row.
template <class Values>
void record(Tape& tape, const Values& values, RowRecorder& recorder, SparseRows& rows) {
  for (const Traced& channel : values) tape.weigh(channel, 1);
  tape.back();
  recorder.end_row(rows);
}

// Calls take(sample, radiance) for each.
template <class Numbers, class Fields, class Take>
void gather_all(const Inside& inside, const Numbers& numbers, const Fields& fields, std::span<const ViewSample> samples,
                const Take& take) {
  ViewRay ray(inside.level, inside.problem, numbers, fields, {}, {differentiable_end, differentiable_end});
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Inward inward = inward_of(inside.level, inside.problem.eta.of(0), samples[i].face, samples[i].outside);
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

SparseRows Inside::uncollided_rows(const Entering& light) const {
  const InsideInputs inputs(at, light.again.size());
  RowRecorder recorder(inputs.count());
  const RecordedParameters by{{recorder, 0}, {recorder, inputs.tets}, {recorder, 2 * inputs.tets}};
  const RecordedInputs by_again{recorder, 2 * inputs.tets + inputs.lights};
  Tape tape;
  const Tape::Recording recording(tape);
  const TracedNumbers numbers(at, by);
  const Follower follower(level, problem, numbers, shape);
  SparseRows rows;
  for (std::uint32_t v = 0; v < level.vertex_count(); ++v) {
    const auto here = light_at(follower, numbers, v, light, TracedAgainLight{light.again, by_again});
    record(tape, here.entry, recorder, rows);
    record(tape, here.depth, recorder, rows);
    recorder.forget();
    tape.clear();
  }
  return rows;
}

std::vector<glm::dvec3> Inside::gathered(const InsideFields& fields, std::span<const ViewSample> samples) const {
  std::vector<glm::dvec3> result(samples.size());
  gather_all(*this, PlainNumbers(at), PlainFields{fields}, samples,
             [&](std::size_t i, const auto& radiance) { result[i] = {radiance[0], radiance[1], radiance[2]}; });
  return result;
}

SparseRows Inside::gathered_rows(const InsideFields& fields, std::span<const ViewSample> samples) const {
  const std::size_t tets = at.scattering.size(), vertices = fields.phi.size();
  RowRecorder recorder(2 * tets + 3 * vertices);
  const RecordedParameters by{{recorder, 0}, {recorder, tets}, {recorder, 0}};  // a ray reads no power
  const auto field = [&](std::size_t number) { return RecordedInputs{recorder, 2 * tets + number * vertices}; };
  Tape tape;
  const Tape::Recording recording(tape);
  SparseRows rows;
  gather_all(*this, TracedNumbers(at, by), TracedFields{fields, field(0), field(1), field(2)}, samples,
             [&](std::size_t, const auto& radiance) {
               record(tape, radiance, recorder, rows);
               recorder.forget();
               tape.clear();
             });
  return rows;
}

std::vector<glm::dvec3> InsideInputs::joined(const Parameters& parameters, std::span<const glm::dvec3> q) const {
  std::vector<glm::dvec3> all;
  all.reserve(count());
  for (const auto* part : {&parameters.scattering, &parameters.absorption, &parameters.power}) {
    all.insert(all.end(), part->begin(), part->end());
  }
  all.insert(all.end(), q.begin(), q.end());
  return all;
}

void InsideInputs::add(std::span<const glm::dvec3> inputs, Parameters& parameters, std::span<glm::dvec3> q) const {
  for (std::size_t t = 0; t < tets; ++t) {
    parameters.scattering[t] += inputs[t];
    parameters.absorption[t] += inputs[tets + t];
  }
  for (std::size_t i = 0; i < lights; ++i) parameters.power[i] += inputs[2 * tets + i];
  for (std::size_t f = 0; f < again; ++f) q[f] += inputs[2 * tets + lights + f];
}

}  // namespace quadgraph
