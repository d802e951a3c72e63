// Options made of members of the scene: kind, choices, reading and writing follow from the type of the member.
#pragma once

#include <type_traits>
#include <utility>

#include "engine/base/text.h"
#include "engine/scene/options.h"

namespace quadgraph {

// The number of shortest text, so that files and help have 0.3 and not 0.30000001.
inline double as_written(float value) {
  return parse_number(number_text(value), "number");
}

template <typename T>
OptionValue value_of(const T& value) {
  if constexpr (HasNames<T>) {
    return std::string(name_of(value));
  } else if constexpr (std::is_same_v<T, float>) {
    return as_written(value);
  } else if constexpr (std::is_same_v<T, std::optional<float>>) {
    return value ? OptionValue(as_written(*value)) : OptionValue();
  } else {
    return value;
  }
}

template <typename T>
T member_from(const OptionValue& value) {
  if constexpr (HasNames<T>) {
    return from_name<T>(std::get<std::string>(value));
  } else if constexpr (std::is_same_v<T, float> || std::is_same_v<T, std::optional<float>>) {
    return static_cast<float>(std::get<double>(value));
  } else {
    return std::get<T>(value);
  }
}

// The options of a scene while they are put together.
class OptionTable {
 public:
  // Heading of the options that follow.
  void group(std::string_view name) { group_ = name; }

  // An option that is the member at the end of `steps`, pointers to members from Scene on.
  template <auto... steps>
  SceneOption& member(SceneOption option) {
    using T = std::remove_cvref_t<decltype((std::declval<Scene&>().*....*steps))>;
    option.kind = HasNames<T>                        ? OptionKind::choice
                  : std::is_same_v<T, bool>          ? OptionKind::flag
                  : std::is_same_v<T, std::uint32_t> ? OptionKind::whole
                                                     : OptionKind::number;
    if constexpr (HasNames<T>) {
      for (const Named<T>& named : Names<T>::values) option.choices.push_back({named.name, named.help});
    }
    option.get = [](const Scene& scene) { return value_of((scene.*....*steps)); };
    option.set = [](Scene& scene, const OptionValue& value) { (scene.*....*steps) = member_from<T>(value); };
    return add(std::move(option));
  }

  // One that is a text of several members.
  SceneOption& text(OptionKind kind, SceneOption option, std::function<OptionValue(const Scene&)> get,
                    std::function<void(Scene&, const OptionValue&)> set) {
    option.kind = kind;
    option.get = std::move(get);
    option.set = std::move(set);
    return add(std::move(option));
  }

  std::vector<SceneOption> take() { return std::move(all_); }

 private:
  SceneOption& add(SceneOption option) {
    option.group = group_;
    if (option.metavar.empty()) option.metavar = option.kind == OptionKind::whole ? "N" : "X";
    return all_.emplace_back(std::move(option));
  }

  std::string_view group_;
  std::vector<SceneOption> all_;
};

}  // namespace quadgraph
