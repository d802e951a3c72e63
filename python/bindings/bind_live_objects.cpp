// What the engine has on devices now, for tests that look for what was left behind.
#include <pybind11/stl.h>

#include "engine/vk/live_objects.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {

void bind_live_objects(py::module_& module) {
  module.def("live_objects", &vk::live_objects, py::arg("first") = 0,
             "Numbers of Vulkan objects by kind (engine/vk/live_objects.h), of the contexts from number `first` on; "
             "kinds of which there are none are left out.");
  module.def("contexts_made", &vk::contexts_made, "Contexts made so far, which is the number of the next one.");
}

}  // namespace quadgraph::python
