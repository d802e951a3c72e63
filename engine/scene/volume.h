// Coefficients on a grid in space, from a file: what was measured of a body, or made elsewhere.
#pragma once

#include <array>
#include <filesystem>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/optics/certainty.h"
#include "engine/optics/material.h"
#include "engine/render/engine.h"

namespace quadgraph {

struct Volume {
  std::array<std::size_t, 3> cells{};  // along x, y, z
  std::vector<gpu::Optical> optical;   // at the middles of the cells, x fastest
  glm::dvec3 spacing{1};               // mm
  std::optional<glm::dvec3> origin;    // mm, the middle of the first cell; without one the grid is centred on the body
  float eta = default_eta;
  Certainty certainty{};  // of the cells, each 0 to most_stated()

  // Where the middle of the first cell lies in a body around `centre`, mm.
  glm::dvec3 first(const glm::dvec3& centre) const;

  // At each point, mm, of a body around `centre`: linear between the middles of cells, beside them the nearest cell's.
  std::vector<gpu::Optical> at(std::span<const glm::vec3> points, const glm::dvec3& centre) const;

  // The same of how well they are known, as far as that is stated.
  Certainty certainty_at(std::span<const glm::vec3> points, const glm::dvec3& centre) const;
};

// The mean of the channels of one place; nothing where one is negative or no number.
std::optional<float> stated_of(Knowledge knowledge, const glm::dvec3& channels);

// A material's text, or the name of such a file, as far as that can be told without reading it. Throws InputError as
// parse_material.
void check_material_text(std::string_view text);

// Reads a .npz of `sigma_s_prime` and `sigma_a`, (nz, ny, nx) or (nz, ny, nx, 3) in 1/mm, and `spacing`, one number or
// three in mm along x, y, z; `origin`, `eta`, and what certainty.h names, of their coefficients' shapes, if
// they are there. Throws InputError naming file, field, what was found and what is allowed.
Volume read_volume(const std::filesystem::path& path);

// A volume's coefficients on all levels and, for shortest-path, on its own grid; their certainty on the finest level.
// Throws InputError.
void set_material(Engine& engine, const Volume& volume, const Coat& coat = {});

// A material, or coefficients on all levels from such a file, carried into the body as its name says
// (engine/scene/material_map.h); returns what is to be said of that, nothing where none is carried. Throws InputError
// as parse_material, read_volume or mapped.
std::string set_material(Engine& engine, std::string_view text);

// The same of a file of several bodies: `materials` by their names, and `material` for the others; where none is named
// it is that of the whole file. Throws InputError also for a body that the file does not have, and for a map.
std::string set_materials(Engine& engine, std::string_view material,
                          const std::map<std::string, std::string>& materials);

}  // namespace quadgraph
