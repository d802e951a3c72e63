#include "engine/base/closest_name.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <numeric>
#include <vector>

namespace quadgraph {
namespace {

constexpr std::size_t longest = 40;  // characters of what may be a slip

std::string plain(std::string_view name) {
  std::string letters;
  for (const char c : name) {
    if (c == '-' || c == '_' || c == ' ') continue;
    letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return letters;
}

// Letters put in, left out, changed or swapped with the next (optimal string alignment).
std::size_t slips(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, changed});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) now[j] = std::min(now[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, now);
  }
  return last[b.size()];
}

}  // namespace

std::string meant(std::string_view found, std::span<const std::string_view> names) {
  if (found.empty() || found.size() > longest) return "";
  const std::string written = plain(found);
  const std::size_t allowed = written.size() / 3;  // none in names of one or two letters
  std::size_t least = allowed + 2;
  std::string_view closest;
  for (const std::string_view name : names) {
    const std::string other = plain(name);
    const std::size_t distance = slips(written, other);
    const bool same_start = allowed > 0 && other.starts_with(written.front());
    if (distance >= least || distance > allowed + (same_start ? 1 : 0)) continue;
    least = distance;
    closest = name;
  }
  return closest.empty() ? "" : " (did you mean '" + std::string(closest) + "'?)";
}

}  // namespace quadgraph
