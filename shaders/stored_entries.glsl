// The entries of an operator as packing.h stores them: reading and writing.
#include "packing.h"

layout(constant_id = 1) const uint ENTRIES = ENTRIES_PACKED;

// Words of an entry; of packed ones the rest is unused.
#if MOMENTS == 1
#define PACKED_WORDS 2u
#define PLAIN_WORDS 4u
#else
#define PACKED_WORDS 5u
#define PLAIN_WORDS 10u
#endif
struct StoredEntry {
  uint word[PLAIN_WORDS];
};
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer AlignedUvec2s {
  uvec2 at[];
};

StoredEntry stored_entry(RowsRef rows, uint e) {
  StoredEntry stored;
  if (ENTRIES == ENTRIES_PLAIN) {
    for (uint k = 0u; k < PLAIN_WORDS; ++k) stored.word[k] = load_row_uint(rows.entry, PLAIN_WORDS * e + k);
    return stored;
  }
#if MOMENTS == 1
  if (!ROW_TEXELS) {
    uvec2 words = AlignedUvec2s(uvec2(rows.entry)).at[e];
    stored.word[0] = words.x;
    stored.word[1] = words.y;
    return stored;
  }
#endif
  for (uint k = 0u; k < PACKED_WORDS; ++k) stored.word[k] = load_row_uint(rows.entry, PACKED_WORDS * e + k);
  return stored;
}

vec3 plain_block(StoredEntry stored, uint first) {
  return uintBitsToFloat(uvec3(stored.word[first], stored.word[first + 1u], stored.word[first + 2u]));
}

void store_plain(RowsRef rows, uint first, vec3 block) {
  uvec3 words = floatBitsToUint(block);
  for (uint k = 0u; k < 3u; ++k) rows.entry.at[first + k] = words[k];
}

int first_number(uint word) {
  return int(word << 13u) >> 19;
}

int second_number(uint word) {
  return int(word) >> 19;
}

#if MOMENTS == 1
uint column_of(StoredEntry stored) {
  if (ENTRIES == ENTRIES_PLAIN) return stored.word[0];
  return (stored.word[0] & 0xfffffu) | (stored.word[1] & 3u) << 20u;
}

Entry entry_in(StoredEntry stored) {
  if (ENTRIES == ENTRIES_PLAIN) return Entry(plain_block(stored, 1u));
  uint first = stored.word[0], second = stored.word[1];
  ivec3 number = ivec3(int(first) >> 20, int(second << 12u) >> 20, int(second) >> 20);
  return Entry(unpack(number, (second >> 2u) & 63u));
}

// Leaves the column as it is; returns what is stored.
Entry store_entry(RowsRef rows, uint e, Entry entry) {
  if (ENTRIES == ENTRIES_PLAIN) {
    store_plain(rows, 4u * e + 1u, entry.a11);
    return entry;
  }
  PackedBlock block = pack(entry.a11, 12);
  uvec3 number = uvec3(block.number) & 0xfffu;
  uint first = 2u * e, second = first + 1u;
  rows.entry.at[first] = (rows.entry.at[first] & 0xfffffu) | number.x << 20u;
  rows.entry.at[second] = (rows.entry.at[second] & 3u) | block.exponent << 2u | number.y << 8u | number.z << 20u;
  return Entry(unpack(block.number, block.exponent));
}
#else
uint column_of(StoredEntry stored) {
  if (ENTRIES == ENTRIES_PLAIN) return stored.word[0];
  return (stored.word[0] & 0x7ffffu) | (stored.word[1] & 63u) << 19u;
}

Entry entry_in(StoredEntry stored) {
  if (ENTRIES == ENTRIES_PLAIN) {
    return Entry(plain_block(stored, 1u), plain_block(stored, 4u), plain_block(stored, 7u));
  }
  uint a = stored.word[1], b = stored.word[2], c = stored.word[3], d = stored.word[4];
  ivec3 a11 = ivec3(second_number(stored.word[0]), first_number(a), second_number(a));
  ivec3 a12 = ivec3(first_number(b), second_number(b), first_number(c));
  ivec3 a22 = ivec3(second_number(c), first_number(d), second_number(d));
  return Entry(unpack(a11, b & 63u), unpack(a12, c & 63u), unpack(a22, d & 63u));
}

uint packed(uint low, int first, int second) {
  return low | (uint(first) & 0x1fffu) << 6u | uint(second) << 19u;
}

// Leaves the column as it is; returns what is stored.
Entry store_entry(RowsRef rows, uint e, Entry entry) {
  if (ENTRIES == ENTRIES_PLAIN) {
    store_plain(rows, 10u * e + 1u, entry.a11);
    store_plain(rows, 10u * e + 4u, entry.a12);
    store_plain(rows, 10u * e + 7u, entry.a22);
    return entry;
  }
  PackedBlock a11 = pack(entry.a11, 13), a12 = pack(entry.a12, 13), a22 = pack(entry.a22, 13);
  uint at = 5u * e;
  rows.entry.at[at] = (rows.entry.at[at] & 0x7ffffu) | uint(a11.number.x) << 19u;
  rows.entry.at[at + 1u] = packed(rows.entry.at[at + 1u] & 63u, a11.number.y, a11.number.z);
  rows.entry.at[at + 2u] = packed(a11.exponent, a12.number.x, a12.number.y);
  rows.entry.at[at + 3u] = packed(a12.exponent, a12.number.z, a22.number.x);
  rows.entry.at[at + 4u] = packed(a22.exponent, a22.number.y, a22.number.z);
  return Entry(unpack(a11.number, a11.exponent), unpack(a12.number, a12.exponent), unpack(a22.number, a22.exponent));
}
#endif

Entry load_entry(RowsRef rows, uint e) {
  return entry_in(stored_entry(rows, e));
}
