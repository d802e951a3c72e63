// Layout of the structs in a SPIR-V module, as the compiler decorated them.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace quadgraph {

struct SpirvLayout {
  std::map<std::string, std::map<std::string, std::uint32_t>> offset;  // struct, member: bytes
  std::map<std::string, std::uint32_t> stride;                         // element struct of a runtime array: bytes
  std::map<std::string, std::uint32_t> block_stride;                   // block that ends in a runtime array: bytes

  explicit SpirvLayout(std::span<const std::uint32_t> code) {
    std::map<std::uint32_t, std::string> names;
    std::map<std::uint32_t, std::map<std::uint32_t, std::string>> member_names;
    std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> offsets;
    std::map<std::uint32_t, std::uint32_t> strides, elements, last_members;
    // Five words of header, then instructions: word count in the high half, opcode in the low half.
    for (std::size_t i = 5; i < code.size(); i += code[i] >> 16) {
      const auto* op = &code[i];
      const auto text = [&](std::size_t word) { return std::string(reinterpret_cast<const char*>(op + word)); };
      switch (op[0] & 0xffffu) {
        case 5:  // OpName target, name
          names[op[1]] = text(2);
          break;
        case 6:  // OpMemberName type, member, name
          member_names[op[1]][op[2]] = text(3);
          break;
        case 29:  // OpTypeRuntimeArray result, element
          elements[op[1]] = op[2];
          break;
        case 30:  // OpTypeStruct result, members
          if (op[0] >> 16 > 2) last_members[op[1]] = op[(op[0] >> 16) - 1];
          break;
        case 71:  // OpDecorate target, decoration, value
          if (op[2] == 6) strides[op[1]] = op[3];
          break;
        case 72:  // OpMemberDecorate type, member, decoration, value
          if (op[3] == 35) offsets[op[1]][op[2]] = op[4];
          break;
        default:
          break;
      }
    }
    for (const auto& [type, members] : offsets) {
      for (const auto& [member, bytes] : members) offset[names[type]][member_names[type][member]] = bytes;
    }
    for (const auto& [type, member] : last_members) {
      if (strides.count(member) > 0) block_stride[names[type]] = strides[member];
    }
    for (const auto& [array, bytes] : strides) stride[names[elements[array]]] = bytes;
  }
};

}  // namespace quadgraph
