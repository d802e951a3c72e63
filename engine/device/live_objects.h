// How many objects of devices there are now, by kind and by device: what a test looks at to find what was left behind.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace quadgraph::device {

// Numbers by kind, without the kinds of which there are none: "device"; "allocation" of a buffer or an image, and
// "allocated byte"; of Vulkan devices what vk::Unique owns too (engine/vk/handle.h), as "pipeline". Command buffers and
// descriptor sets live and die with their pools, which are counted.
using LiveObjects = std::map<std::string, std::uint64_t>;

// Devices opened so far in this process: the number of the next one.
std::uint64_t devices_opened();

// Objects of the devices from number `first` on, those among them that have outlived their device.
LiveObjects live_objects(std::uint64_t first = 0);

// Books of what devices make; from any thread. What is counted of a device belongs to the one that was opened last at
// that address.
void count_opened(const void* device);
void count_closed(const void* device) noexcept;
void count_made(const void* device, const char* kind, std::uint64_t number = 1);
void count_gone(const void* device, const char* kind, std::uint64_t number = 1) noexcept;

}  // namespace quadgraph::device
