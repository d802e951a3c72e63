#include "engine/scene/npz.h"

#include <zip.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <memory>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/regular_file.h"
#include "engine/base/text.h"

namespace quadgraph {
namespace {

constexpr std::uint64_t largest_array = std::uint64_t{4} << 30;  // bytes
// What a member may take beyond its packed bytes, and how often those: a volume that is the same all over packs well,
// and so does one that is made to fill memory.
constexpr std::uint64_t free_bytes = std::uint64_t{128} << 20, most_packed = 20;
// The same for numbers, which are read as double precision however few bytes they have in the file.
constexpr std::uint64_t free_numbers = free_bytes / sizeof(float);
constexpr std::size_t most_axes = 8;

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
  const std::uint64_t packed = std::min<std::uint64_t>(about.comp_size, bytes_of_regular_file(path));
  if (about.size > packed * most_packed + free_bytes) {
    fail(path, std::string(about.name) + " has " + std::to_string(about.size) + " bytes, packed in " +
                   std::to_string(packed) + "; more than 128 MiB are allowed up to 20 times the packed ones");
  }
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

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == std::string_view::npos ? "" : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

// What follows `key` in a header; empty if it is not there.
std::string_view after(std::string_view header, std::string_view key) {
  const std::size_t at = header.find(key);
  return at == std::string_view::npos ? "" : trimmed(header.substr(at + key.size()));
}

// What stands between a first character and the next `end`, if that is what a text begins with.
std::optional<std::string_view> between(std::string_view text, char begin, char end) {
  const std::size_t last = text.starts_with(begin) ? text.find(end, 1) : std::string_view::npos;
  if (last == std::string_view::npos) return std::nullopt;
  return text.substr(1, last - 1);
}

// A type of NumPy is short.
std::optional<std::string_view> quoted(std::string_view text) {
  const auto type = between(text, '\'', '\'');
  return type && type->size() > 1 && type->size() < 16 ? type : std::nullopt;
}

std::optional<std::string_view> in_brackets(std::string_view text) {
  return between(text, '(', ')');
}

std::uint64_t extent(std::string_view word, const std::string& name, const std::filesystem::path& path) {
  std::uint64_t value = 0;
  const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
  if (read.ec != std::errc() || read.ptr != word.data() + word.size()) fail(path, name + " has a header that is none");
  return value;
}

// https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
NpzArray parsed(const Bytes& bytes, const std::string& name, const std::filesystem::path& path) {
  const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i])); };
  if (bytes.size() < 12 || std::string(bytes.data(), 6) != "\x93NUMPY") fail(path, name + " is no array");
  const std::size_t start = byte(6) == 1 ? 10 : 12;
  std::size_t length = byte(8) | byte(9) << 8;
  if (start == 12) length |= byte(10) << 16 | byte(11) << 24;
  if (bytes.size() < start + length) fail(path, name + " is cut off");
  const std::string_view header(bytes.data() + start, length);
  const auto type = quoted(after(header, "'descr':"));
  const auto sizes = in_brackets(after(header, "'shape':"));
  const std::string_view order = after(header, "'fortran_order':");
  if (!type || !sizes || !(order.starts_with("True") || order.starts_with("False"))) {
    fail(path, name + " has a header that is none");
  }
  NpzArray array{.type = std::string(*type), .shape = {}, .values = {}};
  std::uint64_t count = 1;
  for (std::string_view word : split(*sizes, ',')) {
    word = trimmed(word);
    if (word.empty()) continue;
    if (array.shape.size() == most_axes) fail(path, name + " has more than " + std::to_string(most_axes) + " axes");
    array.shape.push_back(extent(word, name, path));
    count *= std::min(array.shape.back(), largest_array);
    if (count > largest_array) fail(path, name + " is too large");
  }
  const Convert as_numbers = convert_of(array.type);
  if (!as_numbers) return array;
  if (order.starts_with("True") && array.shape.size() > 1) {
    fail(path, name + " is in Fortran order; numpy.ascontiguousarray brings it into C order");
  }
  const std::uint64_t item = static_cast<std::uint64_t>(array.type[2] - '0');
  if (bytes.size() - start - length != count * item) fail(path, name + " is cut off");
  const std::uint64_t most_numbers = free_numbers + bytes_of_regular_file(path) * most_packed / sizeof(double);
  if (count > most_numbers) {
    fail(path, name + " has " + std::to_string(count) + " numbers, a file of its size may have " +
                   std::to_string(most_numbers) + " an array; write a coarser grid");
  }
  array.values.resize(count);
  as_numbers(bytes.data() + start + length, array.values);
  return array;
}

void check_name(const std::string& name, std::span<const std::string_view> known, const std::filesystem::path& path) {
  constexpr std::size_t shown = 60;  // characters
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  std::string all;
  for (std::string_view each : known) all += (all.empty() ? "" : ", ") + std::string(each);
  throw InputError(path.string() + ": " + name.substr(0, shown) + ": not known; allowed are " + all);
}

}  // namespace

std::map<std::string, NpzArray> read_npz(const std::filesystem::path& path, std::span<const std::string_view> known) {
  bytes_of_regular_file(path);
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
    const char* stored = zip_get_name(archive.get(), static_cast<zip_uint64_t>(i), 0);
    if (!stored) fail(path, "a member without a name");
    std::string name = stored;
    if (name.ends_with(".npy")) name.resize(name.size() - 4);
    check_name(name, known, path);
    arrays[name] = parsed(content(archive.get(), static_cast<zip_uint64_t>(i), path), name, path);
  }
  return arrays;
}

}  // namespace quadgraph
