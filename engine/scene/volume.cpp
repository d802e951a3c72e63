#include "engine/scene/volume.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <map>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/optics/fresnel.h"
#include "engine/optics/material.h"
#include "engine/render/light/lights.h"
#include "engine/scene/material_map.h"
#include "engine/scene/npz.h"
#include "shaders/material/optics.h"

namespace quadgraph {
namespace {

// The arrays of a file, and complaints about them.
class Fields {
 public:
  explicit Fields(const std::filesystem::path& path) : path_(path), arrays_(read_npz(path, known)) {}

  [[noreturn]] void refuse(const std::string& name, const std::string& what) const {
    throw InputError(path_.string() + ": " + name + ": " + what);
  }

  bool has(const std::string& name) const { return arrays_.contains(name); }

  const NpzArray& numbers(const std::string& name) const {
    const auto found = arrays_.find(name);
    if (found == arrays_.end()) refuse(name, "not there; sigma_s_prime, sigma_a, spacing are wanted");
    if (!found->second.numbers()) refuse(name, found->second.type + " found, numbers wanted");
    return found->second;
  }

  // One number or `count`.
  std::vector<double> few(const std::string& name, std::size_t least, std::size_t most) const {
    const NpzArray& array = numbers(name);
    const std::size_t found = array.values.size();
    const bool finite =
        std::all_of(array.values.begin(), array.values.end(), [](double v) { return std::isfinite(v); });
    if (array.shape.size() > 1 || (found != least && found != most) || !finite) {
      const std::string wanted = std::to_string(least) + (most > least ? " or " + std::to_string(most) : "");
      const std::string given = found > shown ? std::to_string(found) + " numbers" : listed(array.values);
      refuse(name, given + " found, " + wanted + " finite number(s) wanted");
    }
    return array.values;
  }

  static std::string listed(const std::vector<double>& values) {
    std::string text;
    for (double value : values) text += (text.empty() ? "" : ", ") + number_text(value);
    return "[" + text + "]";
  }

  static std::string shape_text(const std::vector<std::uint64_t>& shape) {
    std::string text;
    for (std::uint64_t size : shape) text += (text.empty() ? "" : ", ") + std::to_string(size);
    return "(" + text + ")";
  }

 private:
  static constexpr std::size_t shown = 8;  // numbers that an error repeats
  static constexpr auto known = [] {
    std::array<std::string_view, 5 + knowledge_names.size()> names = {"sigma_s_prime", "sigma_a", "spacing", "origin",
                                                                      "eta"};
    std::copy(knowledge_names.begin(), knowledge_names.end(), names.begin() + 5);
    return names;
  }();

  std::filesystem::path path_;
  std::map<std::string, NpzArray> arrays_;
};

const NpzArray& coefficient(const Fields& fields, const std::string& name) {
  const NpzArray& array = fields.numbers(name);
  const std::size_t axes = array.shape.size();
  if ((axes != 3 && axes != 4) || array.values.empty() || (axes == 4 && array.shape[3] != 3)) {
    fields.refuse(name, "shape " + Fields::shape_text(array.shape) + " found, (nz, ny, nx) or (nz, ny, nx, 3) wanted");
  }
  for (std::size_t i = 0; i < array.values.size(); ++i) {
    const double value = array.values[i];
    if (value >= 0 && value <= gpu::COEFFICIENT_MAX) continue;
    fields.refuse(name, number_text(value) + " found in number " + std::to_string(i) + ", allowed are 0 to 1e6 (1/mm)");
  }
  return array;
}

// Of the cells; empty where the file has none.
std::vector<float> stated_in(const Fields& fields, Knowledge knowledge) {
  const std::string name(knowledge_names[static_cast<std::size_t>(knowledge)]);
  if (!fields.has(name)) return {};
  const std::string coefficient_name = name.substr(0, name.rfind('_'));
  const NpzArray &array = fields.numbers(name), &of = fields.numbers(coefficient_name);
  if (array.shape != of.shape) {
    fields.refuse(name, "shape " + Fields::shape_text(array.shape) + " found, that of " + coefficient_name + ", " +
                            Fields::shape_text(of.shape) + ", wanted");
  }
  const std::size_t channels = of.shape.size() == 4 ? 3 : 1;
  std::vector<float> values;
  for (std::size_t i = 0; i < array.values.size(); i += channels) {
    const auto channel = [&](std::size_t c) { return array.values[i + c % channels]; };
    const std::optional<float> value = stated_of(knowledge, {channel(0), channel(1), channel(2)});
    if (!value)
      fields.refuse(name, "negative or no number in cell " + std::to_string(values.size()) + ", 0 or more allowed");
    values.push_back(*value);
  }
  return values;
}

glm::vec3 cell_of(const NpzArray& array, std::size_t cell) {
  if (array.shape.size() == 3) return glm::vec3(static_cast<float>(array.values[cell]));
  const double* v = &array.values[3 * cell];
  return glm::vec3(glm::dvec3(v[0], v[1], v[2]));
}

float mixed(float a, float b, float t) {
  return glm::mix(a, b, t);
}

glm::dvec3 last_cell(const Volume& volume) {
  return {static_cast<double>(volume.cells[0] - 1), static_cast<double>(volume.cells[1] - 1),
          static_cast<double>(volume.cells[2] - 1)};
}

// Of values at the middles of the cells, as Volume::at.
template <class Value>
std::vector<Value> sampled(const Volume& volume, const std::vector<Value>& values, std::span<const glm::vec3> points,
                           const glm::dvec3& centre) {
  const auto& cells = volume.cells;
  const glm::dvec3 last = last_cell(volume), first = volume.first(centre);
  const auto cell = [&](std::size_t x, std::size_t y, std::size_t z) -> const Value& {
    return values[x + cells[0] * (y + cells[1] * z)];
  };
  std::vector<Value> found;
  found.reserve(points.size());
  for (const glm::vec3& point : points) {
    const glm::dvec3 place = glm::clamp((glm::dvec3(point) - first) / volume.spacing, glm::dvec3(0), last);
    std::array<std::size_t, 3> low{}, high{};
    glm::vec3 t;
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      low[k] = static_cast<std::size_t>(place[axis]);
      high[k] = std::min(low[k] + 1, cells[k] - 1);
      t[axis] = static_cast<float>(place[axis] - static_cast<double>(low[k]));
    }
    const auto row = [&](std::size_t y, std::size_t z) { return mixed(cell(low[0], y, z), cell(high[0], y, z), t.x); };
    found.push_back(mixed(mixed(row(low[1], low[2]), row(high[1], low[2]), t.y),
                          mixed(row(low[1], high[2]), row(high[1], high[2]), t.y), t.z));
  }
  return found;
}

}  // namespace

std::optional<float> stated_of(Knowledge knowledge, const glm::dvec3& channels) {
  const double most{most_stated(knowledge)};
  float sum = 0;
  for (int c = 0; c < 3; ++c) {
    if (!(channels[c] >= 0)) return std::nullopt;
    sum += static_cast<float>(std::min(channels[c], most));
  }
  return sum / 3;
}

void check_material_text(std::string_view text) {
  if (!volume_name(text)) parse_material(text);
}

Volume read_volume(const std::filesystem::path& path) {
  const Fields fields(path);
  const NpzArray &scattering = coefficient(fields, "sigma_s_prime"), &absorption = coefficient(fields, "sigma_a");
  const std::vector<std::uint64_t> grid(scattering.shape.begin(), scattering.shape.begin() + 3);
  if (!std::equal(grid.begin(), grid.end(), absorption.shape.begin())) {
    const std::vector<std::uint64_t> other(absorption.shape.begin(), absorption.shape.begin() + 3);
    fields.refuse("sigma_s_prime and sigma_a", "shapes " + Fields::shape_text(grid) + " and " +
                                                   Fields::shape_text(other) + " found, the same are wanted");
  }
  Volume volume;
  volume.cells = {grid[2], grid[1], grid[0]};
  const std::size_t count = grid[0] * grid[1] * grid[2];
  volume.optical.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    volume.optical.push_back({cell_of(scattering, i), cell_of(absorption, i)});
  }
  const std::vector<double> spacing = fields.few("spacing", 1, 3);
  for (int axis = 0; axis < 3; ++axis) {
    volume.spacing[axis] = spacing[spacing.size() == 3 ? static_cast<std::size_t>(axis) : 0];
    if (!(volume.spacing[axis] > 0 && volume.spacing[axis] <= largest_length)) {
      fields.refuse("spacing", Fields::listed(spacing) + " found, more than 0 and at most " +
                                   number_text(largest_length) + " mm allowed");
    }
  }
  if (fields.has("origin")) {
    const std::vector<double> origin = fields.few("origin", 3, 3);
    for (double place : origin) {
      if (std::abs(place) <= largest_length) continue;
      fields.refuse("origin",
                    Fields::listed(origin) + " found, at most " + number_text(largest_length) + " mm from 0 allowed");
    }
    volume.origin = glm::dvec3(origin[0], origin[1], origin[2]);
  }
  if (fields.has("eta")) {
    const double eta = fields.few("eta", 1, 1)[0];
    if (!(eta >= min_eta && eta <= max_eta)) fields.refuse("eta", number_text(eta) + " found, 1 to 3 allowed");
    volume.eta = static_cast<float>(eta);
  }
  for (std::size_t i = 0; i < knowledge_names.size(); ++i) {
    volume.certainty.stated[i] = stated_in(fields, static_cast<Knowledge>(i));
  }
  return volume;
}

glm::dvec3 Volume::first(const glm::dvec3& centre) const {
  return origin.value_or(centre - 0.5 * spacing * last_cell(*this));
}

std::vector<gpu::Optical> Volume::at(std::span<const glm::vec3> points, const glm::dvec3& centre) const {
  return sampled(*this, optical, points, centre);
}

Certainty Volume::certainty_at(std::span<const glm::vec3> points, const glm::dvec3& centre) const {
  Certainty found;
  for (std::size_t i = 0; i < certainty.stated.size(); ++i) {
    if (!certainty.stated[i].empty()) found.stated[i] = sampled(*this, certainty.stated[i], points, centre);
  }
  return found;
}

}  // namespace quadgraph
