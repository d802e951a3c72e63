#include "tools/layouts/bench.h"

#include <algorithm>
#include <ctime>

#include "tools/layouts/kernels.h"

namespace quadgraph::layouts {
namespace {

constexpr double least_pass_ms = 15;  // of one timed pass
constexpr std::uint32_t most_executions = 400;

device::Buffer words(vk::Context& context, const std::vector<std::uint32_t>& values, const char* name) {
  return device::upload<std::uint32_t>(context, values, name);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

}  // namespace

Subgroups::Subgroups(const vk::Context& context) {
  VkPhysicalDeviceSubgroupProperties properties{};
  properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES;
  VkPhysicalDeviceProperties2 all{};
  all.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
  all.pNext = &properties;
  vkGetPhysicalDeviceProperties2(context.physical_device(), &all);
  size = properties.subgroupSize;
  arithmetic = (properties.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0 &&
               (properties.supportedOperations & VK_SUBGROUP_FEATURE_ARITHMETIC_BIT) != 0;
}

struct Bench::Resident {
  device::Buffer offset, column, weight, row_sum, diagonal, order, coefficients, constants;
  device::Buffer x, y, b, d;
  std::uint32_t width;
  std::uint64_t slots, product_bytes, diagonal_bytes;

  Resident(vk::Context& context, const Packed& packed, const Vectors& vectors, Model model, int kind)
      : offset(words(context, packed.offset, "offset")),
        column(words(context, packed.column, "column")),
        weight(words(context, packed.weight, "weight")),
        row_sum(words(context, packed.row_sum, "row_sum")),
        diagonal(words(context, packed.diagonal, "diagonal")),
        order(words(context, packed.order, "order")),
        coefficients(words(context, packed.coefficients, "coefficients")),
        constants(device::upload<gpu::LayoutConstants>(context, {&packed.constants, 1}, "constants")),
        x(words(context, pack_fields(vectors.x, model, kind), "x")),
        y(context, x.size(), device::Place::device, "y"),
        b(words(context, pack_fields(vectors.b, model, VECTORS_PACKED), "b")),
        d(words(context, pack_fields(vectors.d, model, kind), "d")),
        width(packed.width),
        slots(packed.slots),
        product_bytes(packed.product_bytes()),
        diagonal_bytes(packed.diagonal_bytes()) {}
};

struct Bench::Dispatch {
  const device::ComputePass* kernel;
  gpu::LayoutPush push;
  std::uint64_t invocations;
};

Bench::Bench(vk::Context& context, const Matrix& matrix, Vectors vectors)
    : context_(context),
      matrix_(matrix),
      vectors_(std::move(vectors)),
      subgroups_(context),
      total_(context, sizeof(glm::vec3), device::Place::device, "total"),
      scratch_(context, matrix.count() * field_bytes(matrix.model, VECTORS_PACKED), device::Place::device, "scratch") {
  const std::size_t groups = matrix.count() / WORKGROUP_SIZE + 1;
  reduction_ = words(context, std::vector<std::uint32_t>(1 + 3 * groups), "reduction");
}

Bench::~Bench() = default;

std::string Bench::refused(const Variant& variant) const {
  if (variant.subgroups && !subgroups_.arithmetic) return "the device has no subgroup arithmetic in compute shaders";
  return layouts::refused(matrix_, variant.layout);
}

Bench::Resident& Bench::resident(const Layout& layout) {
  std::unique_ptr<Resident>& found = residents_[layout];
  if (!found) {
    found = std::make_unique<Resident>(context_, pack(matrix_, layout), vectors_, matrix_.model, layout.vectors);
  }
  return *found;
}

const device::ComputePass& Bench::kernel(const std::string& name) {
  std::unique_ptr<device::ComputePass>& found = kernels_[name];
  if (!found) {
    const device::Spirv code = kernel_code(name, matrix_.model);
    found = std::make_unique<device::ComputePass>(context_, device::Shader{.name = name.c_str(),
                                                                           .code = code,
                                                                           .sp3 = {},
                                                                           .cpu = {},
                                                                           .cpu_sp3 = {},
                                                                           .push_size = sizeof(gpu::LayoutPush)});
  }
  return *found;
}

gpu::LayoutPush Bench::push_of(const Layout& layout) {
  const Resident& r = resident(layout);
  return {.offset = r.offset.address(),
          .column = r.column.address(),
          .weight = r.weight.address(),
          .row_sum = r.row_sum.address(),
          .diagonal = r.diagonal.address(),
          .order = r.order.address(),
          .coefficients = r.coefficients.address(),
          .constants = r.constants.address(),
          .x = r.x.address(),
          .y = r.y.address(),
          .b = r.b.address(),
          .d = r.d.address(),
          .reduction = reduction_.address(),
          .count = matrix_.count(),
          .width = r.width,
          .c0 = step_c0,
          .c1 = step_c1,
          .c2 = step_c2};
}

std::vector<Bench::Dispatch> Bench::dispatches(const Variant& variant) {
  const std::uint64_t count = matrix_.count();
  gpu::LayoutPush push = push_of(variant.layout), other = push;
  const device::ComputePass* main = &kernel(variant.kernel);
  switch (variant.operation) {
    case Operation::product: {
      const bool wide = variant.layout.rows == ROWS_CSR_SUBGROUP;
      return {{main, push, wide ? count * subgroups_.size : count}};
    }
    case Operation::product_dot:
      push.d = total_.address();
      return {{main, push, count}};
    case Operation::product_then_dot:
      other.d = total_.address();
      other.count = static_cast<std::uint32_t>((count + WORKGROUP_SIZE - 1) / WORKGROUP_SIZE);
      return {{main, push, count}, {&kernel("reduce_partials"), other, 1}};
    case Operation::smooth:
    case Operation::smooth_zero:
      return {{main, push, count}};
    case Operation::residual_update:
      push.y = scratch_.address();
      other.b = scratch_.address();
      return {{main, push, count}, {&kernel("update"), other, count}};
    case Operation::start_smooth:
      other.y = scratch_.address();
      push.x = scratch_.address();
      return {{&kernel("start"), other, count}, {main, push, count}};
  }
  return {};
}

void Bench::record(device::Commands& commands, const std::vector<Dispatch>& all) {
  for (const Dispatch& one : all) commands.dispatch(*one.kernel, one.push, one.invocations);
}

Outcome Bench::run(const Variant& variant) {
  const Resident& r = resident(variant.layout);
  const auto d = pack_fields(vectors_.d, matrix_.model, variant.layout.vectors);
  device::write_bytes(context_, r.d, std::as_bytes(std::span(d)));
  device::Commands commands(context_);
  record(commands, dispatches(variant));
  commands.submit_and_wait();
  const auto y = device::download<std::uint32_t>(context_, r.y);
  return {unpack_fields(y, matrix_.count(), matrix_.model, variant.layout.vectors),
          glm::dvec3(device::download<glm::vec3>(context_, total_)[0])};
}

// Time of one execution.
Bench::Timed Bench::execute(const Variant& variant, std::uint32_t times) {
  const std::vector<Dispatch> all = dispatches(variant);
  const bool cpu = context_.info().cpu;
  const std::clock_t start = std::clock();
  device::Commands commands(context_, 1);
  commands.begin_pass(variant.name);
  for (std::uint32_t k = 0; k < times; ++k) record(commands, all);
  commands.end_pass();
  const double ms = commands.submit_and_wait()[0].time_ms;
  const double cpu_ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return {ms / times, cpu ? cpu_ms / times : 0.0};
}

std::vector<Times> Bench::time(const std::vector<Variant>& variants, std::uint32_t repeats) {
  std::vector<std::uint32_t> executions;
  for (const Variant& variant : variants) {
    execute(variant, 1);
    const double one_ms = execute(variant, 1).ms;
    executions.push_back(static_cast<std::uint32_t>(std::clamp(least_pass_ms / one_ms, 1.0, double{most_executions})));
  }
  std::vector<std::vector<double>> ms(variants.size()), cpu_ms(variants.size());
  for (std::uint32_t k = 0; k < repeats; ++k) {
    for (std::size_t v = 0; v < variants.size(); ++v) {
      const Timed timed = execute(variants[v], executions[v]);
      ms[v].push_back(timed.ms);
      cpu_ms[v].push_back(timed.cpu_ms);
    }
  }
  std::vector<Times> times;
  for (std::size_t v = 0; v < variants.size(); ++v) {
    times.push_back({.best_ms = std::ranges::min(ms[v]),
                     .median_ms = median(ms[v]),
                     .cpu_ms = std::ranges::min(cpu_ms[v]),
                     .bytes = bytes(variants[v])});
  }
  return times;
}

std::uint64_t Bench::bytes(const Variant& variant) {
  const Resident& r = resident(variant.layout);
  const std::uint64_t field = matrix_.count() * field_bytes(matrix_.model, variant.layout.vectors);
  const std::uint64_t b = matrix_.count() * field_bytes(matrix_.model, VECTORS_PACKED);
  const std::uint64_t groups = (matrix_.count() + WORKGROUP_SIZE - 1) / WORKGROUP_SIZE;
  const std::uint64_t partials = 2 * groups * sizeof(glm::vec3);
  const std::uint64_t smooth = r.product_bytes + r.diagonal_bytes + b + 4 * field;  // x, d read; d, y written
  switch (variant.operation) {
    case Operation::product:
      return r.product_bytes + 2 * field;
    case Operation::product_dot:
    case Operation::product_then_dot:
      return r.product_bytes + 2 * field + partials;
    case Operation::smooth:
      return smooth;
    case Operation::residual_update:
      return smooth + 2 * field;  // the residual, written and read
    case Operation::smooth_zero:
      return r.product_bytes + r.diagonal_bytes + b + 2 * field;
    case Operation::start_smooth:
      return smooth + r.diagonal_bytes + b + 2 * field;
  }
  return 0;
}

void Bench::forget() {
  residents_.clear();
}

std::uint64_t Bench::slots(const Layout& layout) {
  return resident(layout).slots;
}

}  // namespace quadgraph::layouts
