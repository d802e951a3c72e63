// Which devices Vulkan finds, without opening one.
#pragma once

#include <string>
#include <vector>

namespace quadgraph::vk {

struct Surveyed {
  std::string name;
  std::string driver;     // name and version
  bool software = false;  // computes on the processor
  std::string lacks;      // empty: the engine can run on it
};

// In the order in which the engine prefers them. Throws DeviceError where there is no loader or it finds no driver.
std::vector<Surveyed> survey();

}  // namespace quadgraph::vk
