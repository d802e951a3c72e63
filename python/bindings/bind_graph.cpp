// The loaded file as read-only NumPy views, and the byte layout for comparison with the Python writer.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "engine/file/graph.h"
#include "engine/file/qgraph_layout.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {
namespace {

// A level together with the graph that owns its memory.
struct LevelHandle {
  py::object graph;
  const Level* level;
};

template <typename Vector>
py::array rows(std::span<const Vector> values, py::handle owner) {
  using Scalar = typename Vector::value_type;
  return view(reinterpret_cast<const Scalar*>(values.data()),
              {static_cast<py::ssize_t>(values.size()), static_cast<py::ssize_t>(Vector::length())}, owner);
}

template <typename Scalar>
py::array flat(std::span<const Scalar> values, py::handle owner) {
  return view(values.data(), {static_cast<py::ssize_t>(values.size())}, owner);
}

py::object transfer(const Transfer& t, py::handle owner) {
  if (t.width == 0) return py::none();
  const std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(t.index.size() / t.width),
                                          static_cast<py::ssize_t>(t.width)};
  return py::make_tuple(view(t.index.data(), shape, owner), view(t.weight.data(), shape, owner));
}

void bind_level(py::module_& module) {
  py::class_<LevelHandle>(module, "Level", "One level of detail; arrays are read-only views into the file.")
      .def_property_readonly("vertices", [](const LevelHandle& h) { return rows(h.level->vertices, h.graph); })
      .def_property_readonly("tets", [](const LevelHandle& h) { return rows(h.level->tets, h.graph); })
      .def_property_readonly("faces", [](const LevelHandle& h) { return rows(h.level->faces, h.graph); })
      .def_property_readonly("face_tets", [](const LevelHandle& h) { return flat(h.level->face_tets, h.graph); })
      .def_property_readonly(
          "face_kinds", [](const LevelHandle& h) { return flat(h.level->face_kinds, h.graph); },
          "0 open, 1 reflecting; empty if all are open.")
      .def_property_readonly(
          "seen", [](const LevelHandle& h) { return flat(h.level->seen, h.graph); },
          "What faces see: beginnings of rows, then faces met; empty if this level has none.")
      .def_property_readonly(
          "seen_rays", [](const LevelHandle& h) { return h.level->seen_rays; }, "Rays from each face behind `seen`.")
      .def_property_readonly(
          "tet_bodies", [](const LevelHandle& h) { return flat(h.level->tet_bodies, h.graph); },
          "(n_t,) which of the bodies each tet is of; empty if there is one.")
      .def_property_readonly("links", [](const LevelHandle& h) { return rows(h.level->links, h.graph); })
      .def_property_readonly("nodes", [](const LevelHandle& h) { return rows(h.level->nodes, h.graph); })
      .def_property_readonly(
          "inner", [](const LevelHandle& h) { return transfer(h.level->inner, h.graph); },
          "Inverse-distance transfer (index, weight), each (n_t, 8); None on the coarsest level.")
      .def_property_readonly(
          "surface", [](const LevelHandle& h) { return transfer(h.level->surface, h.graph); },
          "Inverse-distance transfer (index, weight), each (n_f, 4); None on the coarsest level.")
      .def_property_readonly(
          "barycentric", [](const LevelHandle& h) { return transfer(h.level->barycentric, h.graph); },
          "Clamped barycentric transfer (index, weight), each (n_v, 4); None on the coarsest level.")
      .def_property_readonly("surface_vertex_count",
                             [](const LevelHandle& h) { return h.level->surface_vertex_count; });
}

py::dict layout() {
  const auto field = [](const char* name, std::size_t offset, std::size_t size) {
    return py::make_tuple(name, offset, size);
  };
#define QG_FIELD(Struct, name) field(#name, offsetof(Struct, name), sizeof(Struct::name))
  py::dict d;
  d["header"] =
      py::make_tuple(QG_FIELD(QgraphHeader, magic), QG_FIELD(QgraphHeader, version), QG_FIELD(QgraphHeader, byte_order),
                     QG_FIELD(QgraphHeader, section_count), QG_FIELD(QgraphHeader, table_crc32),
                     QG_FIELD(QgraphHeader, file_size), QG_FIELD(QgraphHeader, reserved));
  d["section"] =
      py::make_tuple(QG_FIELD(QgraphSection, name), QG_FIELD(QgraphSection, type), QG_FIELD(QgraphSection, rank),
                     QG_FIELD(QgraphSection, shape), QG_FIELD(QgraphSection, offset), QG_FIELD(QgraphSection, size),
                     QG_FIELD(QgraphSection, crc32), QG_FIELD(QgraphSection, reserved));
#undef QG_FIELD
  d["header_size"] = sizeof(QgraphHeader);
  d["section_size"] = sizeof(QgraphSection);
  d["magic"] = py::bytes(reinterpret_cast<const char*>(qgraph_magic.data()), qgraph_magic.size());
  d["version"] = qgraph_version;
  d["byte_order"] = qgraph_byte_order;
  d["alignment"] = qgraph_alignment;
  return d;
}

void check(const py::buffer& buffer, const std::string& name) {
  const py::buffer_info info = buffer.request();
  const std::span bytes(static_cast<const std::byte*>(info.ptr), static_cast<std::size_t>(info.size * info.itemsize));
  const py::gil_scoped_release release;
  if (reinterpret_cast<std::uintptr_t>(info.ptr) % 4 == 0) {
    QuadGraph::check(bytes, name);
  } else {
    QuadGraph::parse(bytes, name);
  }
}

}  // namespace

void bind_graph(py::module_& module) {
  bind_level(module);
  py::class_<QuadGraph>(module, "QuadGraph", "A loaded .qgraph file (docs/qgraph-format.md).")
      .def_property_readonly(
          "levels",
          [](py::object self) {
            py::list levels;
            for (const Level& level : self.cast<const QuadGraph&>().levels()) levels.append(LevelHandle{self, &level});
            return levels;
          },
          "Levels of detail, finest first.")
      .def_property_readonly(
          "display",
          [](py::object self) {
            const DisplayMesh& mesh = self.cast<const QuadGraph&>().display();
            py::dict d;
            d["vertices"] = rows(mesh.vertices, self);
            d["normals"] = rows(mesh.normals, self);
            d["triangles"] = rows(mesh.triangles, self);
            d["face"] = flat(mesh.face, self);
            d["barycentric"] = rows(mesh.barycentric, self);
            return d;
          },
          "The display mesh: vertices, normals, triangles, face, barycentric.")
      .def_property_readonly("bodies", &QuadGraph::bodies, "Names of the bodies; empty: one without a name.")
      .def_property_readonly("hosts", &QuadGraph::hosts,
                             "Of each body the number of the one that it lies within; its own where there is none.")
      .def_property_readonly("metadata", &QuadGraph::metadata, "JSON text.")
      .def_property_readonly("front", &QuadGraph::front,
                             "Azimuth in degrees about y from where the body is shown when nobody says so.")
      .def_property_readonly("byte_size", &QuadGraph::byte_size);
  module.def("load", &QuadGraph::load, py::arg("path"),
             "Read and validate a .qgraph file. Raises FormatError naming the section and the broken rule, InputError "
             "if the file cannot be read.");
  module.def(
      "parse",
      [](const py::bytes& bytes, const std::string& name) {
        const std::string_view text = bytes;
        return QuadGraph::parse(std::as_bytes(std::span(text)), name);
      },
      py::arg("bytes"), py::arg("name") = "<bytes>", "The same from bytes in memory.");
  module.def("check_qgraph", &check, py::arg("bytes"), py::arg("name"),
             "Hold a .qgraph file's bytes against every rule of docs/qgraph-format.md. Raises FormatError naming the "
             "section and the broken rule, its message beginning with `name`.");
  module.def("qgraph_layout", &layout, "Names, offsets and sizes of the header's and the section table's fields.");
}

}  // namespace quadgraph::python
