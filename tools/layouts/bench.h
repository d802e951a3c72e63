// Runs the variants on a device, for their results and for their times.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "engine/device/commands.h"
#include "engine/device/memory.h"
#include "engine/device/pipeline.h"
#include "engine/vk/context.h"
#include "tools/layouts/variants.h"

namespace quadgraph::layouts {

// Coefficients of the Chebyshev steps that are measured.
inline constexpr float step_c0 = 0.6f, step_c1 = 0.3f, step_c2 = 0.5f;

// What the steps act on.
struct Vectors {
  std::vector<Field> x, b, d;
};

// What came of one execution.
struct Outcome {
  std::vector<Field> y;
  glm::dvec3 dot{0};  // of Operation::product_dot and product_then_dot
};

struct Times {
  double best_ms = 0, median_ms = 0;
  // On a device of type CPU the least time that all threads of the process took together, which other processes
  // disturb less than the time on the clock; else 0.
  double cpu_ms = 0;
  std::uint64_t bytes = 0;  // every array read or written once
};

struct Subgroups {
  std::uint32_t size = 0;
  bool arithmetic = false;  // in compute shaders

  explicit Subgroups(const vk::Context& context);
};

class Bench {
 public:
  Bench(vk::Context& context, const Matrix& matrix, Vectors vectors);
  ~Bench();
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  // Why the variant cannot run here; empty if it can.
  std::string refused(const Variant& variant) const;

  // Executes the variant once.
  Outcome run(const Variant& variant);

  // Times all variants in turn, `repeats` times, each over so many executions that a submission does not matter. All
  // must be allowed.
  std::vector<Times> time(const std::vector<Variant>& variants, std::uint32_t repeats);

  // Frees the layouts that were run.
  void forget();

  std::uint64_t bytes(const Variant& variant);
  std::uint64_t slots(const Layout& layout);  // entries stored, padding included

 private:
  struct Resident;  // a layout on the device
  struct Dispatch;
  struct Timed {
    double ms, cpu_ms;
  };

  Resident& resident(const Layout& layout);
  const device::ComputePass& kernel(const std::string& name);
  gpu::LayoutPush push_of(const Layout& layout);
  std::vector<Dispatch> dispatches(const Variant& variant);
  void record(device::Commands& commands, const std::vector<Dispatch>& dispatches);
  Timed execute(const Variant& variant, std::uint32_t times);

  vk::Context& context_;
  const Matrix& matrix_;
  Vectors vectors_;
  Subgroups subgroups_;
  device::Buffer reduction_, total_, scratch_;
  std::map<Layout, std::unique_ptr<Resident>> residents_;
  std::map<std::string, std::unique_ptr<device::ComputePass>> kernels_;
};

}  // namespace quadgraph::layouts
