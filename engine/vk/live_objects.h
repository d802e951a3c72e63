// How many objects of vk/ there are now, by kind and by context: what a test looks at to find what was left behind.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <map>
#include <string>

namespace quadgraph::vk {

// Numbers by kind, without the kinds of which there are none: "context"; what Unique owns (handle.h), as "buffer" or
// "pipeline"; "allocation", memory that a buffer or an image has of its own or in an arena, and "allocated byte".
// Command buffers and descriptor sets live and die with their pools, which are counted.
using LiveObjects = std::map<std::string, std::uint64_t>;

// Contexts made so far in this process: the number of the next one.
std::uint64_t contexts_made();

// Objects of the contexts from number `first` on, those among them that have outlived their context.
LiveObjects live_objects(std::uint64_t first = 0);

// Books for Context, Unique and Allocation; from any thread. What is counted of a device belongs to the context that
// was opened last on a device of that handle.
void count_opened(VkDevice device);
void count_closed(VkDevice device) noexcept;
void count_made(VkDevice device, const char* kind, std::uint64_t number = 1);
void count_gone(VkDevice device, const char* kind, std::uint64_t number = 1) noexcept;

}  // namespace quadgraph::vk
