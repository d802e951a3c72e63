#include "engine/render/verdict.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "engine/base/text.h"

namespace quadgraph {
namespace {

// Share of the light that single precision leaves unaccounted for on large meshes.
constexpr double least_unbalanced = 5e-4;
constexpr std::size_t most_named = 4;  // lights in a sentence

bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool finite(const std::optional<ErrorEstimate>& e) {
  return !e || (std::isfinite(e->whole) && std::isfinite(e->unlit) && std::isfinite(e->dimmest));
}

double largest(const ErrorEstimate& e) {
  return std::max({e.whole, e.unlit, e.dimmest});
}

// What is printed of the error: all of it, or where the mesh's is not known the other parts together.
double printed_error(const SolveReport& report) {
  if (report.error) return largest(*report.error);
  const double solver = report.algebraic ? largest(*report.algebraic) : 0;
  return std::hypot(solver, report.model_error ? largest(*report.model_error) : 0);
}

std::string not_finite(const SolveReport& report) {
  const Energy& energy = report.energy;
  const std::pair<const char*, glm::dvec3> parts[] = {{"entered", energy.entered},
                                                      {"entered again", energy.re_entered},
                                                      {"left", energy.scattered_out},
                                                      {"was absorbed", energy.absorbed},
                                                      {"left unscattered", energy.unscattered_out}};
  for (const auto& [what, power] : parts) {
    if (finite(power)) continue;
    return "not finite: the power that " + std::string(what) +
           " is beyond single precision; weaker light, or a smaller or less remote body, is within it";
  }
  for (const auto& estimate :
       {report.error, report.mesh_error, report.algebraic, report.model_error, report.light_error}) {
    if (!finite(estimate)) return "not finite: the estimate of the error is no number";
  }
  return "";
}

std::string out_of_balance(const SolveReport& report) {
  // Of all channels together, as the error is.
  const glm::dvec3& entered = report.energy.entered;
  const double lost = glm::length(report.energy.balance() * entered) / std::max(glm::length(entered), 1e-300);
  const double printed = printed_error(report);
  if (lost <= std::max(printed, least_unbalanced)) return "";
  const std::string method(name_of(report.method));
  return "out of balance: " + percent_text(lost) + " of the light is unaccounted for, the printed error is " +
         percent_text(printed) +
         (conserves(report.method) ? "; a smaller --tolerance or other light may settle it"
                                   : "; " + method + " does not conserve energy, --method fem or quadgraph-fv does");
}

// "light 2 (point) is".
std::string named(std::span<const Light> lights, const std::vector<bool>& which) {
  std::string text;
  std::size_t found = 0;
  for (std::size_t i = 0; i < which.size(); ++i) {
    if (!which[i] || ++found > most_named) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(i + 1) + " (" + std::string(form_of(lights[i].kind).name) + ")";
  }
  const std::string more = found > most_named ? " and " + std::to_string(found - most_named) + " more" : "";
  return found == 1 ? "light " + text + " is" : "lights " + text + more + " are";
}

bool is_on(const Light& light) {
  return light.power != glm::vec3(0);
}

std::string unlit(const SolveReport& report, std::span<const Light> lights, const std::vector<bool>& inside) {
  std::vector<bool> on(lights.size());
  std::transform(lights.begin(), lights.end(), on.begin(), is_on);
  if (std::find(on.begin(), on.end(), true) == on.end()) return "";
  const bool dark = report.path ? report.path->lit == 0 : report.energy.entered == glm::dvec3(0);
  if (!dark) return "";
  std::vector<bool> outside(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) outside[i] = on[i] && !inside[i];
  std::string why;
  if (std::find(inside.begin(), inside.end(), true) != inside.end()) why = named(lights, inside) + " in the body";
  if (std::find(outside.begin(), outside.end(), true) != outside.end()) {
    why += (why.empty() ? "" : ", ") + named(lights, outside) + " aimed past it or too far away";
  }
  return "not lit: no light enters the body: " + why + "; move or turn lights so that they shine on it";
}

}  // namespace

bool is_inside(const Level& level, const glm::vec3& point) {
  // The solid angle of all faces is 4 pi seen from inside and 0 from outside (Van Oosterom and Strackee 1983).
  double angle = 0;
  for (const glm::uvec3& face : level.faces) {
    const glm::dvec3 at(point);
    const glm::dvec3 a = glm::dvec3(level.vertices[face.x]) - at, b = glm::dvec3(level.vertices[face.y]) - at,
                     c = glm::dvec3(level.vertices[face.z]) - at;
    const double x = glm::length(a), y = glm::length(b), z = glm::length(c);
    angle += 2 * std::atan2(glm::dot(a, glm::cross(b, c)),
                            x * y * z + glm::dot(a, b) * z + glm::dot(b, c) * x + glm::dot(c, a) * y);
  }
  return angle > 2 * std::numbers::pi;
}

void judge(SolveReport& report, std::span<const Light> lights, const std::vector<bool>& inside) {
  if (std::find(inside.begin(), inside.end(), true) != inside.end()) {
    report.light_warning =
        named(lights, inside) + " in the body, which is lit from outside alone: no light comes from there";
  }
  std::string wrong = unlit(report, lights, inside);
  if (!report.path) {
    if (wrong.empty()) wrong = not_finite(report);
    if (wrong.empty()) wrong = out_of_balance(report);
  }
  if (wrong.empty()) return;
  report.stopped += (report.stopped.empty() ? "" : "; ") + wrong;
  if (!report.levels.empty()) report.levels.back().converged = false;
}

}  // namespace quadgraph
