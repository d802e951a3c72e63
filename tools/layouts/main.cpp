// quadgraph-layouts: times every way to store the fem operator on a device, and says what each costs in accuracy.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "engine/base/error.h"
#include "engine/device/copy_bandwidth.h"
#include "engine/vk/context.h"
#include "tools/layouts/report.h"

using namespace quadgraph;

namespace {

struct Options {
  std::string file;
  std::vector<std::string> materials = {"marble"}, models = {"diffusion", "sp3"};
  std::uint32_t level = 0, repeats = 7, copies = 1;
  std::string device, json, commit = "unknown";
  bool validation = false;
};

void declare(CLI::App& app, Options& options) {
  app.add_option("file", options.file, "a baked object, FILE.qgraph")->required();
  app.add_option(
         "--material", options.materials,
         "as for quadgraph-engine, or checker:CONTRAST (10 mm cells of marble and of marble that absorbs CONTRAST "
         "times as much); may be repeated")
      ->allow_extra_args(false)
      ->capture_default_str();
  app.add_option("--model", options.models, "diffusion or sp3; may be repeated")
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"diffusion", "sp3"}))
      ->capture_default_str();
  app.add_option("--level", options.level, "of detail; 0 is the finest")->capture_default_str();
  app.add_option("--copies", options.copies, "bodies beside each other, to outgrow the device's cache")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--repeats", options.repeats, "rounds through all variants")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--device", options.device, "part of the Vulkan device's name");
  app.add_flag("--validation", options.validation, "load the Vulkan validation layer; any message is an error");
  app.add_option("--json", options.json, "file to write the record to");
  app.add_option("--commit", options.commit, "what to call the source in the record");
}

void refuse_messages(const vk::Context& context) {
  const auto& messages = context.validation_messages();
  if (!messages.empty()) {
    throw DeviceError(std::to_string(messages.size()) + " validation messages, the first: " + messages.front());
  }
}

void write(const std::string& path, const std::string& text) {
  const std::string part = path + ".part";
  std::ofstream out(part);
  out << text;
  out.close();
  std::error_code failed;
  if (out) std::filesystem::rename(part, path, failed);
  if (!out || failed) {
    std::filesystem::remove(part, failed);
    throw InputError("json: cannot write '" + path + "'");
  }
}

void run(const Options& options) {
  const QuadGraph graph = QuadGraph::load(options.file);
  if (options.level >= graph.levels().size()) {
    throw InputError("level: found " + std::to_string(options.level) + ", " + options.file + " has levels 0 to " +
                     std::to_string(graph.levels().size() - 1));
  }
  vk::Context context({.validation = options.validation, .device = options.device});
  layouts::Record record{.commit = options.commit,
                         .file = std::filesystem::path(options.file).filename().string(),
                         .device = context.info().name,
                         .driver = context.info().driver,
                         .level = options.level,
                         .subgroup_size = layouts::Subgroups(context).size,
                         .copy_bytes = device::default_copy_bytes(context),
                         .copy_GBps = 0,
                         .studies = {}};
  record.copy_GBps = device::copy_bandwidth(context, record.copy_bytes).gb_per_s;
  std::cout << record.device << ", subgroups of " << record.subgroup_size << ", copy of " << (record.copy_bytes >> 20)
            << " MiB at " << record.copy_GBps << " GB/s\n";
  for (const std::string& material : options.materials) {
    for (const std::string& model : options.models) {
      record.studies.push_back(layouts::study(context, graph.levels()[options.level],
                                              {.material = material,
                                               .model = from_name<Model>(model),
                                               .repeats = options.repeats,
                                               .copies = options.copies}));
      std::cout << layouts::text_of(record.studies.back(), record.copy_GBps) << std::flush;
    }
  }
  refuse_messages(context);
  if (!options.json.empty()) write(options.json, layouts::json_of(record));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    CLI::App app("Times every way to store the fem operator on a Vulkan device, and says what each costs in accuracy.",
                 "quadgraph-layouts");
    app.footer(
        "Columns: best and median time of one step; speed against the first of its group (entries and vectors: of "
        "rows); "
        "bytes per entry, every array counted once; GB/s and their share of a copy's; stored entries over entries; "
        "error "
        "of the result against double precision with what the layout keeps, and with the operator as assembled; error "
        "of "
        "the sum over all rows. exitance: error of the solution where the layout changes the operator.");
    Options options;
    declare(app, options);
    CLI11_PARSE(app, argc, argv);
    run(options);
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::string line = error.what();
    std::replace(line.begin(), line.end(), '\n', ' ');
    std::cerr << "quadgraph-layouts: " << line << "\n";
    return EXIT_FAILURE;
  }
}
