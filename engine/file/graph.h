// A loaded .qgraph file: views into one owned, 64-byte aligned block of bytes. Immutable and move-only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace quadgraph {

// Row r of the target takes sum_k weight[r*width + k] * source[index[r*width + k]]. Weights are >= 0 and sum to 1.
struct Transfer {
  std::span<const std::uint32_t> index;
  std::span<const float> weight;
  std::uint32_t width = 0;  // entries per row; 0 where there is no coarser level
};

// Kinds of outside faces: light passes an open one; a reflecting one is a wall of symmetry, a perfect mirror.
inline constexpr std::uint32_t face_open = 0;
inline constexpr std::uint32_t face_reflecting = 1;

inline constexpr std::uint32_t grid_link_count = 6;

// One level of detail. The sections of docs/qgraph-format.md, all rules checked.
struct Level {
  std::span<const glm::vec3> vertices;        // mm; the first surface_vertex_count lie on the surface
  std::span<const glm::uvec4> tets;           // positively oriented
  std::span<const glm::uvec3> faces;          // outside triangles, counter-clockwise from outside
  std::span<const std::uint32_t> face_tets;   // the tet behind each outside face
  std::span<const glm::uvec4> links;          // entry k across the face opposite vertex k; >= n_t: surface node
  std::span<const glm::vec3> nodes;           // mm; inner nodes, then surface nodes
  std::span<const std::uint32_t> face_kinds;  // FaceKind of each outside face; empty: all are open
  std::span<const std::uint8_t> tet_bodies;   // the body of each tet, by QuadGraph::bodies; empty: there is one
  // Links of a polygrid, else empty: six for each vertex below the surface, in pairs of opposite ones; the last of
  // six may be the vertex itself, for none. A surface vertex is named once, by its one neighbour. Vertices are in order
  // of their layers, the fewest links from the surface.
  std::span<const std::uint32_t> grid_links;
  // Where light that leaves one part enters another; at most one level has it. Rays that met face g of those sent out
  // from face f: entries g in seen[seen[f]] ... seen[seen[f + 1] - 1], ascending, one for each ray. Empty: not baked.
  std::span<const std::uint32_t> seen;
  std::uint32_t seen_rays = 0;  // rays from each face; those without an entry met the sky
  Transfer inner;               // inverse distance, inner nodes from inner nodes of the next level
  Transfer surface;             // inverse distance, surface nodes from surface nodes of the next level
  Transfer barycentric;         // clamped barycentric, vertices from vertices of the next level
  std::uint32_t surface_vertex_count = 0;

  bool reflecting(std::uint32_t face) const { return !face_kinds.empty() && face_kinds[face] == face_reflecting; }
  std::uint32_t body_of_tet(std::uint32_t tet) const { return tet_bodies.empty() ? 0 : tet_bodies[tet]; }
  std::uint32_t body_of_face(std::uint32_t face) const { return body_of_tet(face_tets[face]); }
  // Link k of vertex v below the surface.
  std::uint32_t grid_link(std::uint32_t v, std::uint32_t k) const {
    return grid_links[std::size_t{grid_link_count} * (v - surface_vertex_count) + k];
  }
  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(vertices.size()); }
  std::uint32_t tet_count() const { return static_cast<std::uint32_t>(tets.size()); }
  std::uint32_t face_count() const { return static_cast<std::uint32_t>(faces.size()); }
  std::uint32_t node_count() const { return static_cast<std::uint32_t>(nodes.size()); }
};

inline constexpr std::uint32_t most_texture_side = 4096;  // texels

// The surface that is drawn, tied to the outside faces of level 0 where there is one.
struct DisplayMesh {
  std::span<const glm::vec3> vertices;  // mm
  std::span<const glm::vec3> normals;   // unit
  std::span<const glm::uvec3> triangles;
  std::span<const std::uint32_t> face;     // per vertex: outside face of level 0
  std::span<const glm::vec3> barycentric;  // per vertex: position in that face
  // A normal map by coordinates of the mesh; empty where there is none. Per vertex the place in the picture, which is
  // repeated beyond 0 to 1, the second downwards; and 1 where it lies, else 0.
  std::span<const glm::vec3> texture_places{};
  std::span<const std::uint8_t> normal_texture{};  // RGB of rows, the first at 0
  std::uint32_t texture_columns = 0, texture_rows = 0;
};

class QuadGraph {
 public:
  // Reads and validates a whole file. Throws FormatError naming `path`, the section and the broken rule; InputError if
  // the file cannot be read.
  static QuadGraph load(const std::filesystem::path& path);

  // Reads and validates a file's bytes in memory; `name` stands for the file in messages. Throws FormatError.
  static QuadGraph parse(std::span<const std::byte> bytes, const std::string& name);

  // Validates a file's bytes where they lie, which must be at a multiple of four. Throws FormatError.
  static void check(std::span<const std::byte> bytes, const std::string& name);

  const std::vector<Level>& levels() const { return levels_; }  // finest first; empty: a surface alone
  const DisplayMesh& display() const { return display_; }
  // Names of the bodies that Level::tet_bodies counts; empty: one body without a name.
  const std::vector<std::string>& bodies() const { return bodies_; }
  // Of each body the one that it lies within and shares its surface with; its own number where it lies in none.
  const std::vector<std::uint32_t>& hosts() const { return hosts_; }
  // Of each body the outermost around it, whose surface is that of them all; its own number where it lies in none.
  const std::vector<std::uint32_t>& outermost() const { return outermost_; }
  const std::string& metadata() const { return metadata_; }  // JSON text, checked to be an object
  float front() const { return front_; }  // degrees about y from where it is shown when nobody says so
  std::size_t byte_size() const { return byte_size_; }

 private:
  struct AlignedDelete {
    void operator()(std::byte* p) const;
  };

  QuadGraph() = default;
  std::span<std::byte> allocate(std::size_t size);
  void read(std::span<const std::byte> bytes, const std::string& name);
  void validate(const std::string& name);

  std::unique_ptr<std::byte[], AlignedDelete> bytes_;
  std::size_t byte_size_ = 0;
  std::vector<Level> levels_;
  DisplayMesh display_;
  std::string metadata_;
  std::vector<std::string> bodies_;
  std::vector<std::uint32_t> hosts_, outermost_;
  float front_ = 0;
};

}  // namespace quadgraph
