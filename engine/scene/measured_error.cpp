#include "engine/scene/measured_error.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "engine/base/text.h"
#include "engine/file/section_table.h"
#include "engine/optics/material.h"
#include "engine/render/picture/metadata.h"
#include "engine/scene/json_field.h"
#include "engine/solve/asked_error.h"

namespace quadgraph {
namespace {

// Most cycles of any setting that a bake tries.
constexpr std::uint32_t most_cycles = 256;

constexpr auto most_sweeps = static_cast<std::uint32_t>(sweeps_range.high);
constexpr std::uint32_t most_vertices = std::numeric_limits<std::uint32_t>::max();
constexpr double largest = std::numeric_limits<double>::max();

// One setting, measured on one file.
struct Trial {
  std::uint32_t surface_vertices, levels;  // of the file
  Model model;
  std::uint32_t cycles, sweeps;
  double cost;   // bytes a frame reads and writes
  double error;  // relative RMS of the exitance, the largest of all lights and parts
  double share;  // of an error that is asked for: no more than this of it was kept with certainty
};

struct Record {
  std::string material;
  std::optional<std::vector<Light>> lights{};  // none: usual ones stood for any
  std::size_t usual_lights = 0;                // sets of them
  bool inter_reflection = false;               // else the file does not say what the faces see
  std::vector<Trial> trials{};                 // on the file that was kept
};

// At least one.
std::vector<JsonField> some_members(const JsonField& field, const std::string& allowed) {
  if (field.value().empty()) field.refuse(allowed);
  return field.members(allowed);
}

double largest_error(const JsonField& errors) {
  double most = 0;
  for (const JsonField& light : some_members(errors, "an object of the errors under one light or more")) {
    for (const JsonField& part : some_members(light, "an object of the errors of one part or more")) {
      most = std::max(most, part.number(0, largest));
    }
  }
  return most;
}

Model measured_model(const JsonField& field) {
  const std::string name = field.text();
  if (name != name_of(Model::diffusion) && name != name_of(Model::sp3)) field.refuse("\"diffusion\" or \"sp3\"");
  return from_name<Model>(name);
}

Trial trial_from(const JsonField& field) {
  if (!field.value().is_object()) field.refuse("an object");
  const auto share = field.find("share");
  return {.surface_vertices = field.at("surface_vertices").whole(0, most_vertices),
          .levels = field.at("levels").whole(1, qgraph_max_levels),
          .model = measured_model(field.at("model")),
          .cycles = field.at("cycles").whole(1, most_cycles),
          .sweeps = field.at("sweeps").whole(0, most_sweeps),
          .cost = field.at("cost").number(0, largest),
          .error = largest_error(field.at("errors")),
          .share = share ? share->number(0, 1) : usual_measured_share};
}

std::vector<Light> lights_from(const JsonField& field) {
  std::vector<Light> lights;
  for (const JsonField& text : field.items()) {
    const std::string light = text.text();
    lights.push_back(text.within([&] { return parse_light(light); }));
  }
  return lights;
}

// The record of a bake, with the trials on the file that was kept alone.
Record record_from(const JsonField& field) {
  if (!field.value().is_object()) field.refuse("an object");
  Record record{.material = field.at("material").text()};
  const JsonField lights = field.at("lights");
  if (field.at("lights_given").truth()) {
    if (!lights.value().is_object()) lights.refuse("an object with \"given\"");
    record.lights = lights_from(lights.at("given"));
  } else {
    record.usual_lights = some_members(lights, "an object of one set of lights or more").size();
  }
  record.inter_reflection = field.at("inter_reflection").truth();
  const std::uint32_t vertices = field.at("surface_vertices").whole(0, most_vertices);
  const std::size_t levels = field.at("levels").items().size();
  const JsonField trials = field.at("trials");
  for (const JsonField& trial : trials.items()) {
    const Trial found = trial_from(trial);
    if (found.surface_vertices == vertices && found.levels == levels) record.trials.push_back(found);
  }
  if (record.trials.empty()) trials.refuse("one of this file's " + std::to_string(vertices) + " vertices, or more");
  return record;
}

// A direction that has been written and read again may have other last digits.
bool same_light(Light a, const Light& b) {
  constexpr float last_digits = 1e-6f;
  if (glm::all(glm::lessThan(glm::abs(a.direction - b.direction), glm::vec3(last_digits)))) a.direction = b.direction;
  return a == b;
}

bool same_lights(const std::vector<Light>& a, const std::vector<Light>& b) {
  return std::is_permutation(a.begin(), a.end(), b.begin(), b.end(), same_light);
}

// A material's text with all that it leaves out; that of coefficients on a grid as it is.
std::string in_full(const std::string& material) {
  try {
    return material_text(parse_material(material));
  } catch (const InputError&) {
    return material;
  }
}

// Why the record tells nothing of these options in this scene; empty if it does.
std::string other_than_measured(const Record& record, const SolveOptions& options, const PresentScene& scene) {
  if (in_full(scene.material) != in_full(record.material)) return record.material + ", not " + scene.material;
  if (record.lights && !same_lights(*record.lights, scene.lights)) return "under other light";
  if (!scene.as_baked) return "the body at rest and without edits or a normal map";
  if (record.inter_reflection && !options.inter_reflection) return "inter-reflection, too";
  const bool measured = options.method == Method::fem && options.source == Source::buried &&
                        options.solver == SolverKind::fmg_pcg && options.cycles == 0;
  if (!measured) return "fem with the buried source and fmg-pcg";
  const bool usual =
      options.sweep_points == SolveOptions{}.sweep_points && options.sweep_seed == SolveOptions{}.sweep_seed;
  return usual ? "" : "sweeps of the usual points and seed";
}

// Whether a solve with these options may be one of that setting: a model or sweeps that are asked for are as asked.
bool may_be(const Trial& trial, const SolveOptions& options) {
  const bool model = options.model == Model::automatic || options.model == trial.model;
  const bool sweeps = options.correction ? options.sweeps == 0 || options.sweeps == trial.sweeps : trial.sweeps == 0;
  return model && sweeps;
}

// The cheapest that keeps the error.
const Trial* cheapest(const Record& record, const SolveOptions& options) {
  const Trial* best = nullptr;
  for (const Trial& trial : record.trials) {
    if (!may_be(trial, options) || trial.error > trial.share * options.error) continue;
    if (best == nullptr || trial.cost < best->cost) best = &trial;
  }
  return best;
}

// What it measured instead of a setting that keeps the error.
std::string least_error(const Record& record, const SolveOptions& options) {
  double least = largest;
  for (const Trial& trial : record.trials) {
    if (may_be(trial, options)) least = std::min(least, trial.error);
  }
  return least < largest ? "no less than " + percent_text(least) + " on this file" : "other models or sweeps";
}

std::string asked(const SolveOptions& options) {
  return "error " + percent_text(options.error) + ": ";
}

// The options as they are, for the bake measured something else.
MeasuredOptions left(const SolveOptions& options, const std::string& measured) {
  return {options, asked(options) + "the bake measured " + measured + ": the solve's own estimate decides"};
}

MeasuredOptions taken(const Record& record, const SolveOptions& options, const PresentScene& scene) {
  const std::string other = other_than_measured(record, options, scene);
  if (!other.empty()) return left(options, other);
  const Trial* best = cheapest(record, options);
  if (best == nullptr) return left(options, least_error(record, options));
  MeasuredOptions found{options, ""};
  found.options.error = 0;
  found.options.tolerance = algebraic_share * options.error;
  found.options.model = best->model;
  found.options.cycles = best->cycles;
  found.options.sweeps = best->sweeps;
  found.options.correction = best->sweeps > 0;
  const std::string lights =
      record.lights ? "in this light" : "under " + std::to_string(record.usual_lights) + " usual sets of lights";
  found.sentence = asked(options) + "kept, the bake measured " + percent_text(best->error) + " " + lights + " with " +
                   std::string(name_of(best->model)) + " and " + std::to_string(best->cycles) + " cycles";
  if (best->sweeps > 0) found.sentence += ", sweeps of the transport equation: " + std::to_string(best->sweeps);
  return found;
}

}  // namespace

MeasuredOptions with_measured(const SolveOptions& options, const std::string& metadata, const PresentScene& scene) {
  check_options(options);
  if (options.error == 0 || options.method == Method::shortest_path) return {options, ""};
  const Json json = Json::parse(metadata, nullptr, false);
  try {
    const auto budget = JsonField(json, "").find("budget");
    if (!budget) return {options, ""};
    if (budget->value().is_object() && !budget->find("inter_reflection")) {
      return left(options, "against SP3 alone, being of an earlier version (bake again)");
    }
    return taken(record_from(*budget), options, scene);
  } catch (const InputError& error) {
    fail_format(scene.file, "metadata", error.what());
  }
}

SolveReport solve_measured(Engine& engine, const SolveOptions& options, const std::function<void()>& check) {
  const MeasuredOptions measured = with_measured(options, engine.graph().metadata(), engine.present_scene());
  SolveReport report = engine.solve(measured.options, check);
  report.budget = measured.sentence;
  return report;
}

}  // namespace quadgraph
