"""The shaders as C++ for the processor: each file line by line, so that errors and debuggers point into the shader.

What the text becomes part of is in engine/cpu/glsl.h (types and functions of GLSL) and engine/cpu/kernel.h (how a
shader is run). A shader is a struct: its globals, `shared` variables and push constants are members, its functions
member functions. A struct that lies in memory and holds a vec3 has a twin packed_NAME, which is what lies there: a vec3
that is computed with takes a register of four. Push constants of one letter are reached through `push` alone.
Derivatives are of `in` variables alone, and globals keep their values from one invocation to the next.
"""

import re
from pathlib import PurePosixPath

from shader_text import STAGES, Texts, elements_of, members_of, name_of, with_includes

# "0.5", "1e-3", "2." outside of names and numbers that have a suffix.
FLOAT = re.compile(r"(?<![\w.])((?:\d+\.\d*|\.\d+)(?:[eE][-+]?\d+)?|\d+[eE][-+]?\d+)(?![\w.])")
SWIZZLE = re.compile(r"(?<=[\w)\]])(?<!\bpush)\.([xyzw]{1,4})\b")
CHANGED = re.compile(r"(\batomic\w+\([^,]*)\.([xyzw]),")
ASSIGNED = re.compile(r"(?<=[\w)\]])\.([xyzw])(?= *[-+*/&|^]?=(?!=))")
LOST = re.compile(r"(?<=[\w)\]])\.[xyzw]{2,4}(?= *[-+*/&|^]?=(?!=))")  # several components are a copy in C++
OUT_PARAMETER = re.compile(r"\b(?:inout|out) (\w+) (?=\w+[,)\[])")
STAGE_VARIABLE = re.compile(r"^layout\(location = (\d+)\) (?:flat )?(in|out) (?:flat )?(\w+) (\w+);")
PUSH = re.compile(r"^layout\(push_constant, scalar\) uniform Block \{ (\w+) ", re.M)
IN_MEMORY = re.compile(r"^QG_(?:\w+_)?ARRAY\(|^layout\(push_constant")
PROTOTYPE = re.compile(r"^\w+ \w+\([^()]*\);$")

# Lines as a whole, in this order; what matches none stays as it is.
LINES = [
    (re.compile(r"^#(?:version|extension)\b.*"), ""),
    (re.compile(r'^#include "(.+)"'), r'#include "native/\1"'),
    (
        re.compile(r"^layout\(push_constant, scalar\) uniform Block \{ (\w+) (\w+); \};"),
        r"\1 \2; \1& push_constants() { return \2; }",
    ),
    (re.compile(r"^layout\(local_size[^)]*\) in;"), ""),
    (
        re.compile(r"^layout\(constant_id = 1\) const (\w+) (\w+) = [^;]*;"),
        r"static constexpr \1 \2 = VARIANT_OF_PASS;",
    ),
    (STAGE_VARIABLE, r"\3 \4;"),
    (re.compile(r"^const (u?int|float|bool) "), r"static constexpr \1 "),
    (re.compile(r"^const (\w+) "), r"static inline const \1 "),
    (re.compile(r"^shared "), ""),
    (re.compile(r"^#define WORKGROUP_SIZE .*"), "#define WORKGROUP_SIZE INVOCATIONS_OF_GROUP"),
    (PROTOTYPE, ""),
]
WORDS = [
    (re.compile(r"\bdiscard;"), "{ kept = false; return; }"),
    (re.compile(r"\bprecise "), ""),
    (FLOAT, r"\1f"),
    (CHANGED, r"\1.ref_\2(),"),
    (ASSIGNED, r".ref_\1()"),
    (SWIZZLE, r".\1()"),
    (OUT_PARAMETER, r"\1& "),
]
DIRECTIVE = re.compile(r"^#(?!define\b)")


def native_line(line: str) -> str:
    """One line as C++; its comment stays."""
    code, slashes, comment = line.partition("//")
    code = code.replace("__cplusplus", "QG_HOST")
    for pattern, replacement in LINES:
        code, count = pattern.subn(replacement, code)
        if count:
            break
    if LOST.search(code):
        raise ValueError(f"assigns to several components, which C++ would lose: {line.strip()}")
    if not DIRECTIVE.match(code):
        for pattern, replacement in WORDS:
            code = pattern.sub(replacement, code)
    return code + slashes + comment


def packed(line: str, stored: set[str]) -> str:
    """A line with the types of what lies in memory."""
    return re.sub(r"\b\w+\b", lambda word: f"packed_{word[0]}" if word[0] in stored else word[0], line)


def twin_of(name: str, body: list[str], stored: set[str]) -> list[str]:
    """A struct as it lies in memory, which turns into the one that is computed with and back; `body`: its lines."""

    def copies(target: str, source: str) -> list[str]:
        lines = []
        for line in body:
            if line.startswith("#"):
                lines.append(line)
                continue
            for member in members_of(line):
                loop, at = (f"for (uint k = 0; k < {member.count}; ++k) ", "[k]") if member.count else ("", "")
                lines.append(f"{loop}{target}{member.name}{at} = {source}{member.name}{at};")
        return lines

    members = [line if line.startswith("#") else packed(native_line(line), stored) for line in body]
    return [
        f"struct packed_{name} {{",
        *members,
        f"packed_{name}& operator=(const {name}& other) {{",
        *copies("", "other."),
        f"return *this; }} operator {name}() const {{ {name} other;",
        *copies("other.", ""),
        "return other; } };",
    ]


def native_text(file: str, text: str, stored: set[str]) -> str:
    """All of a file; blocks that are reached through addresses, and the macros that make them, are in glsl.h.
    `stored`: types that are not in memory as they are computed with.
    """
    lines, end = [f'#line 1 "shaders/{file}"'], None  # of what is left out: its last line matches
    struct, body = "", []
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("layout(buffer_reference"):
            end = re.compile(r"^\};")
        elif re.match(r"#define QG_(?:\w+_)?ARRAY", line):
            end = re.compile(r".*[^\\]$")
        lines.append(native_line(packed(line, stored) if IN_MEMORY.match(line) else line) if end is None else "")
        if end and end.match(line):
            end = None
        if begin := re.match(r"struct (\w+) \{", line):
            struct, body = begin[1], []
        elif struct in stored and line.startswith("};"):
            lines += [*twin_of(struct, body, stored), f"#line {number + 1}"]
            struct = ""
        else:
            body.append(line)
    return "\n".join(lines) + "\n"


def stored_types(texts: Texts) -> set[str]:
    """vec3, which is padded where it is computed with, and the structs in memory that hold one."""
    all_text = "\n".join(texts.values())
    members = {
        found[1]: set(re.findall(r"^ +(\w+) \w", found[2], re.M))
        for found in re.finditer(r"^struct (\w+) \{\n(.*?)^\};", all_text, re.M | re.S)
    }
    reached = elements_of(texts) | set(PUSH.findall(all_text))
    while found := {each for name in reached for each in members.get(name, ())} - reached:
        reached |= found
    stored = {"vec3"}
    while found := {name for name in reached if members.get(name, set()) & stored} - stored:
        stored |= found
    return stored


def runs_in_groups(texts: Texts, file: str) -> bool:
    """Whether invocations of a workgroup know of each other: then one of them does the work of all."""
    return "EACH(" in texts[file] or any("barrier()" in texts[part] for part in with_includes(texts, file))


def stage_variables(text: str, way: str) -> list[tuple[int, str, str, bool]]:
    """Location, type, name, and whether it is flat, of the in or out variables of a stage."""
    found = [m for line in text.splitlines() if (m := STAGE_VARIABLE.match(line)) and m[2] == way]
    return sorted((int(m[1]), m[3], m[4], " flat " in f" {m[0]}") for m in found)


def locations(variables: list[tuple[int, str, str, bool]]) -> int:
    return 1 + max((at for at, *_ in variables), default=-1)


def table_of(text: str, way: str) -> str:
    words = {"float": 1, "vec2": 2, "vec3": 3, "vec4": 4, "uint": 1}
    rows = [f"{{{at}, offsetof(Shader, {name}), {words[kind]}}}" for at, kind, name, _ in stage_variables(text, way)]
    values = "{{" + ", ".join(rows) + "}}"
    return f"static constexpr std::array<StageVariable, {len(rows)}> {way}s() {{ return {values}; }}\n"


def stage_members(texts: Texts, file: str) -> str:
    """What engine/cpu/kernel.h wants to know of a vertex or fragment shader."""
    text, stage = texts[file], PurePosixPath(file).suffix[1:]
    if stage == "comp":
        return ""
    way = "out" if stage == "vert" else "in"
    members = f"static constexpr uint locations = {locations(stage_variables(text, way))};\n" + table_of(text, "out")
    if stage == "frag":
        members += table_of(text, "in")
        members += f"static constexpr bool derivatives = {str(asks_derivatives(text)).lower()};\n"
    return members


def asks_derivatives(text: str) -> bool:
    """Whether a fragment shader does."""
    return re.search(r"\b(?:dFd[xy]|fwidth)\(", text) is not None


def kernel_name(file: str, moments: int) -> str:
    return f"{name_of(file)}_{moments}_kernel"


def native_shader(texts: Texts, file: str, moments: int) -> str:
    """A shader as a C++ file: kernel_name() of it is a function as engine/device/shader.h says."""
    stage = PurePosixPath(file).suffix[1:]
    grouped = runs_in_groups(texts, file)
    name = name_of(file)
    arguments = f"{name}, {str(grouped).lower()}" if stage == "comp" else name
    return f"""#include "engine/cpu/glsl.h"
#include "engine/cpu/kernel.h"
#include "engine/cpu/pending_add.h"

#define QG_PROCESSOR
#define MOMENTS {moments}
#define INVOCATIONS_OF_GROUP {"1u" if grouped else "256u"}

namespace quadgraph::cpu::QG_LEVEL {{
namespace {{
template <uint VARIANT_OF_PASS>
struct Shader : {stage.capitalize()}Invocation {{
{native_text(file, texts[file], stored_types(texts))}
{stage_members(texts, file)}}};
}}  // namespace
QG_{stage.upper()}_KERNEL({arguments})
}}  // namespace quadgraph::cpu::QG_LEVEL
"""


def native(texts: Texts) -> dict[str, str]:
    """Generated files: native/FILE of what shaders include."""
    stored = stored_types(texts)
    return {
        f"native/{file}": native_text(file, text, stored)
        for file, text in texts.items()
        if PurePosixPath(file).suffix not in STAGES
    }
