#include "engine/render/converging.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/render/picture/frame_offsets.h"
#include "engine/solve/transport_correction.h"

namespace quadgraph {
namespace {

using Clock = std::chrono::steady_clock;

// Points of a draw over those of a solve that is alone: the rest of a solve takes as long, and noise falls with their
// root.
constexpr std::uint32_t more_points = 4;

// Sweeps of each solve: where a second one changes nothing that is known too; and at most.
constexpr std::uint32_t least_sweeps = 2, most_sweeps = 6;

// Sweeps are added where what they leave is more than this share of the error that is asked for, as long as the last
// one added has taken so much of the change.
constexpr double share_of_sweeps = 0.3, least_fall = 0.8;

// Of the error that is asked for, or of the least that can be had where that is larger: less than this share is not
// worth more solves.
constexpr double least_gain = 0.1;

ErrorEstimate or_none(const std::optional<ErrorEstimate>& part) {
  return part.value_or(ErrorEstimate{});
}

}  // namespace

Converging::Converging(Engine& engine, const ConvergingStart& start)
    : engine_(engine),
      view_(start.view),
      render_(start.render),
      solve_(start.solve),
      began_(Clock::now()),
      frames_(frame_count(start.view, start.render)),
      first_seed_(start.solve.sweep_seed) {
  found_.solve = start.report;
  const CorrectionReport& done = *start.report.correction;
  const auto sweeps = static_cast<std::uint32_t>(done.sweeps.size());
  found_.wanted = render_.converge;
  found_.reached = start.error.whole <= found_.wanted;
  found_.steps.push_back({.sweeps = sweeps,
                          .points = done.sweeps.back().points,
                          .samples = frames_ * samples_per_frame,
                          .error = start.error});
  solve_.sweeps = std::max(sweeps, least_sweeps);
  solve_.sweep_points =
      std::min(more_points * solve_.sweep_points, static_cast<std::uint32_t>(sweep_points_range.high));
  solve_.error = solve_.certify = 0;
  render_.samples = static_cast<std::uint32_t>(samples_range.high);  // so that frames go on from solve to solve
  change_before_ = std::numeric_limits<double>::infinity();
}

void Converging::advance(const std::function<void()>& check) {
  if (!solved_) {
    SolveOptions next = solve_;
    next.sweep_seed = first_seed_ + made_ + 1;
    next.mean_of = solves_ + 1;
    found_.solve = engine_.solve(next, check);
    solved_ = true;
  }
  shown_ = &engine_.draw_frame(view_, render_, solves_ * frames_ + drawn_);
  if (++drawn_ < frames_) return;
  drawn_ = 0;
  solved_ = false;
  ++made_;
  ++solves_;
  judge();
}

// What is stated of the picture, with what its own noise is more than what is stated of that.
void Converging::judge() {
  const CorrectionReport& done = *found_.solve.correction;
  noise_.add(read_picture(engine_.device(), *shown_));
  const std::optional<ErrorEstimate> stated = engine_.picture_error();
  if (!stated) throw InputError("converge: the error of the picture is not known any more");
  ConvergenceStep step{.solves = solves_,
                       .sweeps = static_cast<std::uint32_t>(done.sweeps.size()),
                       .points = done.sweeps.back().points,
                       .samples = solves_ * frames_ * samples_per_frame,
                       .seconds = std::chrono::duration<double>(Clock::now() - began_).count(),
                       .error = *stated,
                       .noise = noise_.relative()};
  const double unstated = step.noise * step.noise - std::pow(noise_of(done, solves_).whole, 2);
  step.error.whole = std::hypot(stated->whole, std::sqrt(std::max(0.0, unstated)));
  found_.steps.push_back(step);
  metadata_ = engine_.metadata();
  const ErrorEstimate left = left_by_sweeps(done);
  const auto all = [](double a, double b, double c, double d, double e) {
    return std::hypot(a, b, std::hypot(c, d, e));
  };
  found_.least = picture_error_of(by_parts(all, left, or_none(found_.solve.mesh_error), or_none(found_.solve.algebraic),
                                           light_left(), or_none(found_.solve.phase_error)));
  found_.reached = step.error.whole <= found_.wanted;
  if (found_.reached) return;
  const double gain = step.error.whole - found_.least;
  if (solves_ > 1 && !sweep_more(left.whole) && gain <= least_gain * std::max(found_.wanted, found_.least)) {
    found_.limit = limit(step.error.whole);
  } else if (out_of_time()) {
    found_.out_of_time = true;
    found_.limit = "no time is left: " + percent_text(step.error.whole) + " is reached";
  }
}

// Begins anew with one sweep more where that is worth it.
bool Converging::sweep_more(double left) {
  const CorrectedSweep& last = found_.solve.correction->sweeps.back();
  const double change = last.change.whole;
  if (left <= share_of_sweeps * found_.wanted || change <= last.noise.whole || solve_.sweeps >= most_sweeps ||
      change > least_fall * change_before_) {
    return false;
  }
  change_before_ = change;
  ++solve_.sweeps;
  solves_ = 0;
  noise_ = {};
  return true;
}

double Converging::picture_error_of(const ErrorEstimate& exitance) const {
  const auto error = engine_.picture_error(exitance);
  return error ? error->whole : 0;
}

// The rays of light from all around are others in every solve; the maps of other lights are the same.
ErrorEstimate Converging::light_left() const {
  const std::vector<Light> lights = engine_.present_scene().lights;
  return std::all_of(lights.begin(), lights.end(), from_all_around) ? ErrorEstimate{}
                                                                    : or_none(found_.solve.light_error);
}

std::string Converging::limit(double whole) const {
  const auto without = [](double all, double part) { return std::sqrt(std::max(0.0, all * all - part * part)); };
  const double always = picture_error_of({}), medium = engine_.medium_of_picture(), angle = without(always, medium);
  const auto of_picture = [&](const ErrorEstimate& part) { return without(picture_error_of(part), always); };
  const double mesh = std::hypot(of_picture(or_none(found_.solve.mesh_error)), medium);
  const double light = of_picture(light_left());
  const double sweeps = of_picture(left_by_sweeps(*found_.solve.correction)), noise = found_.steps.back().noise;
  const std::string said =
      percent_text(whole) + " is reached, and more sweeps and samples would leave " + percent_text(found_.least) + ": ";
  const double phase = of_picture(or_none(found_.solve.phase_error));
  const double most = std::max({mesh, light, sweeps, noise, angle, phase});
  if (most == phase) {
    return said + "what scattering forwards changes is " + percent_text(phase) +
           ", of which sweeps know two moments alone";
  }
  if (most == mesh) {
    return said + "the mesh's part is " + percent_text(mesh) +
           "; a finer file has less: of bake --for-material where the material changes in space, or of more vertices";
  }
  if (most == light)
    return said + "the light's part is " + percent_text(light) + "; fewer lights have finer shadow maps";
  if (most == sweeps)
    return said + "what sweeps leave is " + percent_text(sweeps) + ", and further ones change no less";
  if (most == noise) return said + "the noise is " + percent_text(noise);
  return said + "what is not known of the angle at which light leaves is " + percent_text(angle) +
         ", and nothing lowers that statement";
}

// Whether another solve, which takes as long as the last one, would end too late.
bool Converging::out_of_time() const {
  const std::vector<ConvergenceStep>& steps = found_.steps;
  const double now = steps.back().seconds, last = now - steps[steps.size() - 2].seconds;
  return render_.time_limit > 0 && now + last > render_.time_limit;
}

Picture Converging::picture() const {
  Picture picture = read_picture(engine_.device(), *shown_);
  picture.error = found_.steps.back().error;
  picture.standard_error = noise_.standard_error();
  return picture;
}

Picture converged(Engine& engine, const ConvergingStart& start, Picture first,
                  const std::function<void(const ConvergenceStep&)>& told) {
  Converging more(engine, start);
  const std::vector<ConvergenceStep>& steps = more.found().steps;
  if (told) told(steps.back());
  while (!more.ended()) {
    const std::size_t known = steps.size();
    while (steps.size() == known) more.advance();
    if (told) told(steps.back());
  }
  const bool better = steps.back().error.whole < steps.front().error.whole;
  Picture picture = better ? more.picture() : std::move(first);
  picture.convergence = more.found();
  return picture;
}

}  // namespace quadgraph
