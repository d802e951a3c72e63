// Devices as they are found, none of them opened.
#include <pybind11/stl.h>

#include "engine/devices/vulkan.h"
#include "python/bindings/bindings.h"

namespace py = pybind11;

namespace quadgraph::python {

void bind_devices(py::module_& module) {
  module.def(
      "vulkan_devices",
      [] {
        py::list all;
        for (const vk::Surveyed& found : survey_vulkan()) {
          py::dict d;
          d["name"] = found.name;
          d["driver"] = found.driver;
          d["software"] = found.software;
          d["lacks"] = found.lacks;
          all.append(d);
        }
        return all;
      },
      "Vulkan devices in the order in which they are preferred, each a dict: name, driver, software (it computes on "
      "the processor) and lacks (empty where the engine can run on it). Raises DeviceError where there are none.");
}

}  // namespace quadgraph::python
