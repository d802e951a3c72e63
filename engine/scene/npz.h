// Arrays of numbers in a file of NumPy's savez.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace quadgraph {

struct NpzArray {
  std::string type;                  // as NumPy's descr, "<f8"
  std::vector<std::uint64_t> shape;  // empty: a single number
  std::vector<double> values;        // in C order; none if it does not hold numbers

  bool numbers() const { return !values.empty() || type[1] == 'f' || type[1] == 'i' || type[1] == 'u'; }
};

// All of them by name, compressed or not; those of other names than `known` are refused unread. Throws InputError
// naming the file and what is wrong with it.
std::map<std::string, NpzArray> read_npz(const std::filesystem::path& path, std::span<const std::string_view> known);

}  // namespace quadgraph
