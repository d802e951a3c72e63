// The rules of docs/qgraph-format.md about what sections contain. All throw FormatError naming file and section.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/file/graph.h"

namespace quadgraph {

// Everything about level `index` alone and its transfers into `coarser` (null for the coarsest level).
void validate_level(const Level& level, const Level* coarser, const std::string& file, std::uint32_t index);

// The links of level `index` as a polygrid, if it has any; surface_vertex_count is known.
void validate_grid(const Level& level, const std::string& file, std::uint32_t index);

// All levels have such links, or none.
void validate_grid_everywhere(std::span<const Level> levels, const std::string& file);

// At most one level has rows of what its faces see.
void validate_seen_once(std::span<const Level> levels, const std::string& file);

// Largest vertex index in `faces` plus one.
std::uint32_t count_surface_vertices(const Level& level);

// `finest` null: a surface alone.
void validate_display(const DisplayMesh& display, const Level* finest, const std::string& file);

}  // namespace quadgraph
