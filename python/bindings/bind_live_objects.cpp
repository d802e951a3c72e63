// What the engine has on devices now, for tests that look for what was left behind.
#include <pybind11/stl.h>

#include "engine/device/live_objects.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {

void bind_live_objects(py::module_& module) {
  module.def(
      "live_objects", &device::live_objects, py::arg("first") = 0,
      "Numbers of objects by kind (engine/device/live_objects.h), of the devices from number `first` on; kinds of "
      "which there are none are left out.");
  module.def("devices_opened", &device::devices_opened, "Devices opened so far, which is the number of the next one.");
}

}  // namespace quadgraph::python
