#include "engine/cpu/processor.h"

#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "engine/base/error.h"
#include "engine/cpu/objects.h"
#include "engine/cpu/recording.h"
#include "engine/device/live_objects.h"
#include "interface/cpu_levels.h"

namespace quadgraph::cpu {
namespace {

// Room behind every buffer, and multiple that every address is of: a vector of the widest instructions.
constexpr std::size_t alignment = 64;

// Memory of several of these lies in large pages, where the system has them.
constexpr std::size_t large_page = std::size_t{1} << 21;

bool has_level([[maybe_unused]] const std::string& level) {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (level == "v2") return __builtin_cpu_supports("x86-64-v2") != 0;
  if (level == "v3") return __builtin_cpu_supports("x86-64-v3") != 0;
  if (level == "v4") return __builtin_cpu_supports("x86-64-v4") != 0;
#endif
  return level == "portable";
}

// QUADGRAPH_CPU_LEVEL of the environment names one to take.
std::size_t best_level() {
  const char* wanted = std::getenv("QUADGRAPH_CPU_LEVEL");
  for (std::size_t k = std::size(cpu_level_names); k-- > 0;) {
    const bool meant = wanted == nullptr || cpu_level_names[k] == std::string(wanted);
    if (meant && has_level(cpu_level_names[k])) return k;
  }
  std::string all;
  for (const char* name : cpu_level_names) all += std::string(all.empty() ? "" : ", ") + name;
  throw DeviceError("device cpu: shaders were compiled for the levels of instructions " + all +
                    ", and this processor has none of them" +
                    (wanted == nullptr ? "" : " that QUADGRAPH_CPU_LEVEL='" + std::string(wanted) + "' allows"));
}

unsigned wanted_threads(unsigned threads) {
  const char* text = std::getenv("QUADGRAPH_THREADS");
  if (threads > 0 || text == nullptr) return threads;
  char* end = nullptr;
  const long number = std::strtol(text, &end, 10);
  if (*text == '\0' || *end != '\0' || number < 1 || number > 1024) {
    throw InputError("QUADGRAPH_THREADS is '" + std::string(text) + "'; allowed are 1 to 1024");
  }
  return static_cast<unsigned>(number);
}

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "processor";
}

std::uint64_t physical_memory() {
  return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
}

void* take_memory(std::uint64_t bytes) {
  const bool large = bytes >= 2 * large_page;
  const std::size_t unit = large ? large_page : alignment, whole = (bytes + unit - 1) / unit * unit;
  void* memory = std::aligned_alloc(unit, whole);
  if (memory == nullptr) throw DeviceError("no memory for " + std::to_string(bytes) + " bytes");
#ifdef MADV_HUGEPAGE
  if (large) madvise(memory, whole, MADV_HUGEPAGE);
#endif
  return memory;
}

}  // namespace

void Freed::operator()(void* memory) const {
  std::free(memory);
}

Bytes bytes(std::uint64_t count) {
  return Bytes(take_memory(count));
}

Processor::Processor(const ProcessorOptions& options)
    : level_(best_level()), threads_(wanted_threads(options.threads)) {
  info_ = {processor_name(), "quadgraph cpu " + std::string(cpu_level_names[level_]), true};
  max_buffer_bytes_ = physical_memory();
  max_image_side_ = 16384;
  one_by_one_ = true;
  max_workgroups_ = 0xffffffffu;
  device::count_opened(books_);
}

Processor::~Processor() {
  device::count_closed(books_);
}

void Processor::run(std::uint32_t count, std::uint32_t part,
                    const std::function<void(std::uint32_t, std::uint32_t)>& work, const std::function<void()>& last) {
  const auto caller = std::this_thread::get_id();
  std::atomic<bool> given_up = false;
  std::exception_ptr why;
  const auto run_part = [&](std::uint32_t begin, std::uint32_t end) {
    if (given_up.load(std::memory_order_relaxed)) return;
    work(begin, end);
    if (std::this_thread::get_id() != caller) return;
    try {
      heed();
    } catch (...) {
      why = std::current_exception();
      given_up.store(true, std::memory_order_relaxed);
    }
  };
  threads_.run(count, part, run_part, last);
  if (why) std::rethrow_exception(why);
}

// Linux grants more than there is, and ends the process when it is used.
void Processor::check_room(std::uint64_t size) const {
  if (size <= max_buffer_bytes() && allocated_bytes() <= max_buffer_bytes() - size) return;
  throw DeviceError("no memory for " + std::to_string(size) + " bytes: this machine has " +
                    std::to_string(max_buffer_bytes()));
}

std::unique_ptr<device::Memory> Processor::allocate(std::uint64_t size, device::Place, const std::string&) {
  check_room(size);
  return std::make_unique<BufferMemory>((size + alignment) / alignment * alignment + alignment);
}

std::unique_ptr<device::ImageMemory> Processor::allocate(const device::ImageOptions& options, const std::string&) {
  check_room(ImageMemory::bytes_of(options));
  return std::make_unique<ImageMemory>(options);
}

std::unique_ptr<device::Pipeline> Processor::compile(const device::Shader& shader,
                                                     const device::ComputeOptions& options, const std::string&) {
  const device::CpuCode& code = options.sp3 ? shader.cpu_sp3 : shader.cpu;
  return std::make_unique<ComputePipeline>(code.compute[level_], options.variant);
}

std::unique_ptr<device::Pipeline> Processor::compile(const device::GraphicsOptions& options, const std::string&) {
  return std::make_unique<GraphicsPipeline>(options, level_);
}

std::unique_ptr<device::Recording> Processor::record(std::uint32_t) {
  return std::make_unique<Recording>(*this);
}

}  // namespace quadgraph::cpu
