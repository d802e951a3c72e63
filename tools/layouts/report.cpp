#include "tools/layouts/report.h"

#include <cstdio>
#include <nlohmann/json.hpp>

namespace quadgraph::layouts {
namespace {

using Json = nlohmann::ordered_json;

double GBps(const Times& times) {
  return 1e-6 * static_cast<double>(times.bytes) / times.best_ms;
}

template <typename... Values>
std::string formatted(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

// What variants are compared by.
double cost(const Times& times) {
  return times.cpu_ms > 0 ? times.cpu_ms : times.best_ms;
}

// What a variant's speed is relative to: the first of its group; for products the present one.
const Result& first_of(const Study& study, const std::string& group) {
  const std::string other = group == "entries" || group == "vectors" ? "rows" : group;
  for (const Result& result : study.results) {
    if (result.variant.group == other) return result;
  }
  return study.results.front();
}

std::string line_of(const Study& study, const Result& result, double copy_GBps) {
  const std::string name = formatted("  %-58s", result.variant.name.c_str());
  if (!result.refused.empty()) return name + "skipped: " + result.refused + "\n";
  const double speed = cost(first_of(study, result.variant.group).times) / cost(result.times);
  const double entries = static_cast<double>(study.entries);
  std::string line = name + formatted("%7.3f %7.3f %7.3f %5.2f %6.1f %7.1f %4.0f%% %5.2f %8.1e %8.1e",
                                      result.times.best_ms, result.times.median_ms, result.times.cpu_ms, speed,
                                      static_cast<double>(result.times.bytes) / entries, GBps(result.times),
                                      100 * GBps(result.times) / copy_GBps, result.slots_per_entry, result.rounding,
                                      result.difference);
  if (result.conservation > 0) line += formatted(" %8.1e", result.conservation);
  if (result.exitance) {
    line += formatted("  exitance %.1e whole %.1e unlit", result.exitance->whole, result.exitance->unlit);
    line += result.least ? formatted(", least eigenvalue %.1e", *result.least) : ", not positive definite";
  }
  return line + "\n";
}

Json json_of(const Layout& layout) {
  return {{"rows", layout.rows},       {"slice", layout.slice},     {"window", layout.window},
          {"entries", layout.entries}, {"columns", layout.columns}, {"coefficients", layout.coefficients},
          {"vectors", layout.vectors}};
}

Json json_of(const Result& result, double copy_GBps) {
  Json json = {{"group", result.variant.group},
               {"name", result.variant.name},
               {"kernel", result.variant.kernel},
               {"layout", json_of(result.variant.layout)}};
  if (!result.refused.empty()) {
    json["skipped"] = result.refused;
    return json;
  }
  json["best_ms"] = result.times.best_ms;
  json["median_ms"] = result.times.median_ms;
  if (result.times.cpu_ms > 0) json["cpu_ms"] = result.times.cpu_ms;
  json["bytes"] = result.times.bytes;
  json["GBps"] = GBps(result.times);
  json["share_of_copy"] = GBps(result.times) / copy_GBps;
  json["slots_per_entry"] = result.slots_per_entry;
  json["rounding"] = result.rounding;
  json["difference"] = result.difference;
  json["conservation"] = result.conservation;
  if (result.exitance) {
    json["exitance_error"] = {{"whole", result.exitance->whole}, {"unlit", result.exitance->unlit}};
    json["least_eigenvalue"] = result.least ? Json(*result.least) : Json("not positive definite");
  }
  return json;
}

}  // namespace

std::string text_of(const Study& study, double copy_GBps) {
  std::string text = study.options.material + ", " + std::string(name_of(study.options.model)) + ": " +
                     std::to_string(study.rows) + " rows, " + std::to_string(study.entries) +
                     " entries off the diagonal\n";
  text += formatted("  %-58s%7s %7s %7s %5s %6s %7s %5s %5s %8s %8s %8s\n", "", "best ms", "median", "cpu ms", "speed",
                    "B/entry", "GB/s", "copy", "slots", "rounding", "against", "sum");
  std::string group;
  for (const Result& result : study.results) {
    if (result.variant.group != group) text += result.variant.group + "\n";
    group = result.variant.group;
    text += line_of(study, result, copy_GBps);
  }
  return text;
}

std::string json_of(const Record& record) {
  Json json = {{"commit", record.commit},
               {"device", record.device},
               {"driver", record.driver},
               {"subgroup_size", record.subgroup_size},
               {"file", record.file},
               {"level", record.level},
               {"copy", {{"bytes", record.copy_bytes}, {"GBps", record.copy_GBps}}}};
  for (const Study& study : record.studies) {
    Json one = {{"material", study.options.material},
                {"model", name_of(study.options.model)},
                {"repeats", study.options.repeats},
                {"copies", study.options.copies},
                {"rows", study.rows},
                {"entries", study.entries},
                {"least_eigenvalue", study.least}};
    for (const Result& result : study.results) one["variants"].push_back(json_of(result, record.copy_GBps));
    json["studies"].push_back(one);
  }
  return json.dump(1) + "\n";
}

}  // namespace quadgraph::layouts
