// Studies as a table and as JSON.
#pragma once

#include <string>
#include <vector>

#include "tools/layouts/study.h"

namespace quadgraph::layouts {

struct Record {
  std::string commit, file, device, driver;
  std::uint32_t level = 0;
  std::uint32_t subgroup_size = 0;
  std::uint64_t copy_bytes = 0;
  double copy_GBps = 0;
  std::vector<Study> studies;
};

std::string text_of(const Study& study, double copy_GBps);
std::string json_of(const Record& record);

}  // namespace quadgraph::layouts
