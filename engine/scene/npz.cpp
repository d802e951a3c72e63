#include "engine/scene/npz.h"

#include <zip.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <regex>

#include "engine/base/error.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t largest_array = std::uint64_t{4} << 30;  // bytes: what a broken header may ask for

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw InputError(path.string() + ": cannot be read as .npz: " + what);
}

struct CloseArchive {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
struct CloseMember {
  void operator()(zip_file_t* member) const { zip_fclose(member); }
};

using Bytes = std::vector<char>;

Bytes content(zip_t* archive, zip_uint64_t index, const std::filesystem::path& path) {
  zip_stat_t about;
  if (zip_stat_index(archive, index, 0, &about) != 0 || about.size > largest_array) fail(path, "a broken member");
  Bytes bytes(about.size);
  const std::unique_ptr<zip_file_t, CloseMember> member(zip_fopen_index(archive, index, 0));
  if (!member || zip_fread(member.get(), bytes.data(), about.size) != static_cast<zip_int64_t>(about.size)) {
    fail(path, std::string(about.name) + " is cut off or corrupt");
  }
  return bytes;
}

template <typename T>
void convert(const char* from, std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    T value;
    std::memcpy(&value, from + i * sizeof(T), sizeof(T));
    values[i] = static_cast<double>(value);
  }
}

using Convert = void (*)(const char*, std::vector<double>&);

Convert convert_of(const std::string& type) {
  static const std::map<std::string, Convert> known = {
      {"f4", convert<float>},         {"f8", convert<double>},        {"i1", convert<std::int8_t>},
      {"i2", convert<std::int16_t>},  {"i4", convert<std::int32_t>},  {"i8", convert<std::int64_t>},
      {"u1", convert<std::uint8_t>},  {"u2", convert<std::uint16_t>}, {"u4", convert<std::uint32_t>},
      {"u8", convert<std::uint64_t>},
  };
  const auto found = type.size() == 3 && type[0] != '>' ? known.find(type.substr(1)) : known.end();
  return found == known.end() ? nullptr : found->second;
}

// https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
NpzArray parsed(const Bytes& bytes, const std::string& name, const std::filesystem::path& path) {
  const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i])); };
  if (bytes.size() < 12 || std::string(bytes.data(), 6) != "\x93NUMPY") fail(path, name + " is no array");
  const std::size_t start = byte(6) == 1 ? 10 : 12;
  std::size_t length = byte(8) | byte(9) << 8;
  if (start == 12) length |= byte(10) << 16 | byte(11) << 24;
  if (bytes.size() < start + length) fail(path, name + " is cut off");
  const std::string header(bytes.data() + start, length);
  std::smatch type, shape;
  const bool understood = std::regex_search(header, type, std::regex("'descr': *'([^']+)'")) &&
                          std::regex_search(header, shape, std::regex("'shape': *\\(([0-9, ]*)\\)")) &&
                          std::regex_search(header, std::regex("'fortran_order': *(True|False)"));
  if (!understood) fail(path, name + " has a header that is none");
  NpzArray array{.type = type[1].str(), .shape = {}, .values = {}};
  const std::string sizes = shape[1].str();
  const std::regex number("[0-9]+");
  std::uint64_t count = 1;
  for (std::sregex_iterator at(sizes.begin(), sizes.end(), number), end; at != end; ++at) {
    if (at->str().size() > 10) fail(path, name + " has a header that is none");
    array.shape.push_back(std::stoull(at->str()));
    count *= std::min(array.shape.back(), largest_array);
    if (count > largest_array) fail(path, name + " is too large");
  }
  const Convert as_numbers = convert_of(array.type);
  if (!as_numbers) return array;
  if (header.find("'fortran_order': True") != std::string::npos && array.shape.size() > 1) {
    fail(path, name + " is in Fortran order; numpy.ascontiguousarray brings it into C order");
  }
  const std::uint64_t item = static_cast<std::uint64_t>(array.type[2] - '0');
  if (bytes.size() - start - length != count * item) fail(path, name + " is cut off");
  array.values.resize(count);
  as_numbers(bytes.data() + start + length, array.values);
  return array;
}

}  // namespace

std::map<std::string, NpzArray> read_npz(const std::filesystem::path& path) {
  int code = 0;
  const std::unique_ptr<zip_t, CloseArchive> archive(zip_open(path.c_str(), ZIP_RDONLY, &code));
  if (!archive) {
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    const std::string text = zip_error_strerror(&error);
    zip_error_fini(&error);
    fail(path, text);
  }
  std::map<std::string, NpzArray> arrays;
  for (zip_int64_t i = 0; i < zip_get_num_entries(archive.get(), 0); ++i) {
    std::string name = zip_get_name(archive.get(), static_cast<zip_uint64_t>(i), 0);
    if (name.ends_with(".npy")) name.resize(name.size() - 4);
    arrays[name] = parsed(content(archive.get(), static_cast<zip_uint64_t>(i), path), name, path);
  }
  return arrays;
}

}  // namespace quadgraph
