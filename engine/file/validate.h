// The rules of docs/qgraph-format.md about what sections contain. All throw FormatError naming file and section.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/file/graph.h"

namespace quadgraph {

// Shapes, finite numbers and indices of level `index`, so that all others may go by them.
void validate_indices(const Level& level, const std::string& file, std::uint32_t index);

// Tets, links, and the transfers into `coarser` (null for the coarsest level).
void validate_level(const Level& level, const Level* coarser, const std::string& file, std::uint32_t index);

// The links of level `index` as a polygrid, if it has any; surface_vertex_count is known.
void validate_grid(const Level& level, const std::string& file, std::uint32_t index);

// All levels have such links, or none.
void validate_grid_everywhere(std::span<const Level> levels, const std::string& file);

// The rows of what faces see, if there are any: where they begin and end, and what indices they hold.
void validate_seen(const Level& level, const std::string& file, std::uint32_t index);

// Some of these rows, spread evenly over the faces, are what their rays meet when they are cast again.
void validate_seen_again(const Level& level, const std::string& file, std::uint32_t index);

// At most one level has rows of what its faces see.
void validate_seen_once(std::span<const Level> levels, const std::string& file);

// Which body each tet is of: said on all levels or, of one body without a name, `bodies` 0, on none; each body has a
// tet on every level. Indices of levels and display mesh are valid.
void validate_bodies(std::span<const Level> levels, std::size_t bodies, const std::string& file);

// No link, transfer or triangle of the display mesh joins two bodies, of levels that keep all other rules, but where
// one lies within the other: `hosts`, as body_hosts has them, say so. Such have no part of the surface.
void validate_bodies_apart(std::span<const Level> levels, const DisplayMesh& display,
                           const std::vector<std::uint32_t>& hosts, const std::string& file);

// The box around them is neither too small nor too large for single precision.
void validate_size(std::span<const glm::vec3> vertices, const std::string& file, const std::string& section);

// Tets are positively oriented, and inner nodes lie in them.
void validate_tets(const Level& level, const std::string& file, std::uint32_t index);

// Surface nodes lie at the centroids of their faces.
void validate_surface_nodes(const Level& level, const std::string& file, std::uint32_t index);

// Vertices of the display mesh lie where their faces are, and nothing is inside out.
void validate_display_place(const DisplayMesh& display, const Level& finest, const std::string& file);

// All that says where things lie, of valid indices, but tets: surface nodes, what faces see, the display mesh.
void validate_places(std::span<const Level> levels, const DisplayMesh& display, const std::string& file);

// Largest vertex index in `faces` plus one.
std::uint32_t count_surface_vertices(const Level& level);

// Shapes, numbers and indices; `finest` null: a surface alone.
void validate_display(const DisplayMesh& display, const Level* finest, const std::string& file);

}  // namespace quadgraph
