// The entries of an operator as packing.h stores them: reading and writing.
#ifndef QUADGRAPH_STORED_ENTRIES_GLSL
#define QUADGRAPH_STORED_ENTRIES_GLSL

#include "solver/packing.h"
#include "solver/solve_shared.h"

layout(constant_id = 1) const uint ENTRIES = ENTRIES_PACKED;

// Words of an entry; of packed ones the rest is unused. Of plain ones of diffusion the column is the last word, of SP3
// the first.
#if MOMENTS == 1
#define PACKED_WORDS 2u
#define PLAIN_WORDS 4u
#else
#define PACKED_WORDS 4u
#define PLAIN_WORDS 10u
#endif
#if UNPACKED_ENTRIES
struct StoredEntry {
  uint column;
  vec3 a11;
};

StoredEntry stored_entry(RowsRef rows, uint e) {
  uvec2 entries = uvec2(rows.entry);
  return StoredEntry(Uvec4s(entries).at[e].w, Vec4s(entries).at[e].xyz);
}

uint column_of(StoredEntry stored) {
  return stored.column;
}

Entry entry_in(StoredEntry stored) {
  return Entry(stored.a11);
}

// Leaves the column as it is; returns what is stored.
Entry store_entry(RowsRef rows, uint e, Entry entry) {
  if (ENTRIES == ENTRIES_PACKED) {
    PackedBlock block = pack(entry.a11, DIFFUSION_BITS);
    entry.a11 = unpack(block.number, block.exponent);
  }
  for (uint k = 0u; k < 3u; ++k) rows.entry.at[PLAIN_WORDS * e + k] = floatBitsToUint(entry.a11[k]);
  return entry;
}
#else
struct StoredEntry {
  uint word[PLAIN_WORDS];
};
QG_ALIGNED_ARRAY(AlignedUvec2s, uvec2, 8);
QG_ALIGNED_ARRAY(AlignedUvec4s, uvec4, 16);

StoredEntry stored_entry(RowsRef rows, uint e) {
  StoredEntry stored;
  if (ENTRIES == ENTRIES_PLAIN) {
    for (uint k = 0u; k < PLAIN_WORDS; ++k) stored.word[k] = rows.entry.at[PLAIN_WORDS * e + k];
    return stored;
  }
#if MOMENTS == 1
  uvec2 words = AlignedUvec2s(uvec2(rows.entry)).at[e];
#else
  uvec4 words = AlignedUvec4s(uvec2(rows.entry)).at[e];
#endif
  for (uint k = 0u; k < PACKED_WORDS; ++k) stored.word[k] = words[k];
  return stored;
}

vec3 plain_block(StoredEntry stored, uint first) {
  return uintBitsToFloat(uvec3(stored.word[first], stored.word[first + 1u], stored.word[first + 2u]));
}

void store_plain(RowsRef rows, uint first, vec3 block) {
  uvec3 words = floatBitsToUint(block);
  for (uint k = 0u; k < 3u; ++k) rows.entry.at[first + k] = words[k];
}

#if MOMENTS == 1
uint column_of(StoredEntry stored) {
  if (ENTRIES == ENTRIES_PLAIN) return stored.word[3];
  return (stored.word[0] & 0xfffffu) | (stored.word[1] & 3u) << 20u;
}

Entry entry_in(StoredEntry stored) {
  if (ENTRIES == ENTRIES_PLAIN) return Entry(plain_block(stored, 0u));
  uint first = stored.word[0], second = stored.word[1];
  ivec3 number = ivec3(uvec3(first, second << 12u, second)) >> 20;  // the upper twelve bits, with their sign
  return Entry(unpack(number, (second >> 2u) & 63u));
}

// Leaves the column as it is; returns what is stored.
Entry store_entry(RowsRef rows, uint e, Entry entry) {
  if (ENTRIES == ENTRIES_PLAIN) {
    store_plain(rows, PLAIN_WORDS * e, entry.a11);
    return entry;
  }
  PackedBlock block = pack(entry.a11, DIFFUSION_BITS);
  uvec3 number = uvec3(block.number) & 0xfffu;
  uint first = 2u * e, second = first + 1u;
  rows.entry.at[first] = (rows.entry.at[first] & 0xfffffu) | number.x << 20u;
  rows.entry.at[second] = (rows.entry.at[second] & 3u) | block.exponent << 2u | number.y << 8u | number.z << 20u;
  return Entry(unpack(block.number, block.exponent));
}
#else
uint column_of(StoredEntry stored) {
  if (ENTRIES == ENTRIES_PLAIN) return stored.word[0];
  return stored.word[0] & 0x3fffffu;
}

Entry entry_of_words(uvec4 words) {
  Sp3Block block = unpack_sp3(words);
  return Entry(block.a11, SP3_SHARE12 * block.a11 + block.rest12, SP3_SHARE22 * block.a11 + block.rest22);
}

Entry entry_in(StoredEntry stored) {
  if (ENTRIES == ENTRIES_PLAIN) {
    return Entry(plain_block(stored, 1u), plain_block(stored, 4u), plain_block(stored, 7u));
  }
  return entry_of_words(uvec4(stored.word[0], stored.word[1], stored.word[2], stored.word[3]));
}

Entry store_sp3(RowsRef rows, uint e, Sp3Block block) {
  uvec4 words = pack_sp3(rows.entry.at[4u * e] & 0x3fffffu, block);
  for (uint k = 0u; k < 4u; ++k) rows.entry.at[4u * e + k] = words[k];
  return entry_of_words(words);
}

// Leaves the column as it is; returns what is stored.
Entry store_entry(RowsRef rows, uint e, Entry entry) {
  if (ENTRIES == ENTRIES_PLAIN) {
    store_plain(rows, 10u * e + 1u, entry.a11);
    store_plain(rows, 10u * e + 4u, entry.a12);
    store_plain(rows, 10u * e + 7u, entry.a22);
    return entry;
  }
  return store_sp3(rows, e, Sp3Block(entry.a11, entry.a12 - SP3_SHARE12 * entry.a11,
                                     entry.a22 - SP3_SHARE22 * entry.a11));
}
#endif
#endif

Entry load_entry(RowsRef rows, uint e) {
  return entry_in(stored_entry(rows, e));
}

#endif
