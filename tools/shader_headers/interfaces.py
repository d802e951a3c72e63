"""What C++ sees of the shaders: their push constants as structs, their code, and where members of all structs lie that
both see.
"""

import re
from dataclasses import dataclass
from pathlib import PurePosixPath

from native import asks_derivatives, kernel_name, locations, native_shader, stage_variables
from shader_text import STAGES, Struct, Texts, elements_of, name_of, references_of, structs_of, with_includes

PUSH_BLOCK = re.compile(r"uniform Block \{ (\w+) \w+; \}")


@dataclass(frozen=True)
class Shader:
    file: str  # below shaders/
    folder: str  # that it lies in
    name: str  # in C++
    codes: tuple[str, ...]  # NAME.STAGE; for MOMENTS 1 and, where it makes a difference and the text allows it, for 2
    push: str  # type of its push constants
    type: str  # of engine/device/shader.h


def shader_of(texts: Texts, file: str) -> Shader:
    """ValueError if it has no push constants."""
    path = PurePosixPath(file)
    parts = with_includes(texts, file)
    pushes = [found[1] for part in parts if (found := PUSH_BLOCK.search(texts[part]))]
    if len(pushes) != 1:
        raise ValueError(f"{file} has {len(pushes)} blocks of push constants")
    # The .h files do not count: what they declare for both variants is used through the .glsl files of solver/.
    moments = any("MOMENTS" in texts[part] for part in parts if not part.endswith(".h"))
    both = moments and "#define MOMENTS 1\n" not in texts[file]
    entries = "solver/stored_entries.glsl" in parts
    return Shader(
        file=file,
        folder=path.parent.as_posix(),
        name=name_of(file),
        codes=(path.name, f"{path.stem}_sp3{path.suffix}") if both else (path.name,),
        push=pushes[0],
        type="EntryShader" if entries else "ModelShader" if moments else "Shader",
    )


def shaders_of(texts: Texts) -> list[Shader]:
    return [shader_of(texts, file) for file in texts if PurePosixPath(file).suffix in STAGES]


def struct_in_cpp(text: str, name: str, references: set[str]) -> str:
    """The struct with the comment before it; empty where the text does not declare it. A buffer reference is the
    address of its first element.
    """
    found = re.search(rf"(?:^//.*\n)*^struct {name} \{{\n(?:.*\n)*?\}};\n", text, re.M)
    if found is None:
        return ""
    member = re.compile(r"^  (\w+)(?= )", re.M)
    return member.sub(lambda m: "  std::uint64_t" if m[1] in references else m[0], found[0])


def is_cpp(texts: Texts, file: str) -> bool:
    return file.endswith(".h") and "namespace quadgraph::gpu" in texts[file]


def interface_of(texts: Texts, shader: Shader) -> str:
    headers = [part for part in with_includes(texts, shader.file) if is_cpp(texts, part)]
    includes = "".join(f'#include "shaders/{part}"\n' for part in headers)
    push = struct_in_cpp(texts[shader.file], shader.push, references_of(texts))
    if push:
        push = f"namespace quadgraph::gpu {{\n\n{push}\n}}  // namespace quadgraph::gpu\n\n"
    return f"""// Made from shaders/{shader.file}.
#pragma once

#include "engine/device/shader.h"
{includes}
{push}namespace quadgraph::shader {{
extern const device::{shader.type} {shader.name};
}}
"""


KINDS_OF_KERNEL = {".comp": "compute", ".vert": "vertex", ".frag": "fragment"}
SIGNATURES = {
    ".comp": "(const void*, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t)",
    ".vert": "(const void*, const std::uint32_t*, std::uint32_t, float*, std::uint32_t)",
    ".frag": "(const void*, bool, const float*, const float*, const float*, std::uint32_t, float*, bool*, "
    "std::uint32_t)",
}


def cpu_code(shader: Shader, moments: int, levels: list[str]) -> str:
    """Its device::CpuCode."""
    if moments > len(shader.codes):
        return "{}"
    kernels = ", ".join(f"cpu::{level}::{kernel_name(shader.file, moments)}" for level in levels)
    return f"{{.{KINDS_OF_KERNEL[PurePosixPath(shader.file).suffix]} = {{{kernels}}}}}"


def kernels_of(shader: Shader, levels: list[str]) -> str:
    signature = SIGNATURES[PurePosixPath(shader.file).suffix]
    return "".join(
        f"namespace cpu::{level} {{\nvoid {kernel_name(shader.file, moments)}{signature};\n}}\n"
        for level in levels
        for moments in range(1, len(shader.codes) + 1)
    )


def stage_facts(texts: Texts, shader: Shader) -> str:
    text = texts[shader.file]
    if shader.file.endswith(".frag"):
        discards = "discard;" in text
        asks = asks_derivatives(texts[shader.file])
        return f", .derivatives = {str(asks).lower()}, .discards = {str(discards).lower()}"
    if not shader.file.endswith(".vert"):
        return ""
    variables = stage_variables(text, "out")
    flat = sum(1 << at for at, _, _, is_flat in variables if is_flat)
    return f", .locations = {locations(variables)}, .flat = {flat}"


def definition_of(texts: Texts, shader: Shader, spirv: bool, levels: list[str]) -> str:
    code = ["::" + code.replace(".", "_") for code in shader.codes if spirv] + ["{}", "{}"]
    cpu = [cpu_code(shader, moments, levels) for moments in (1, 2)]
    values = (
        f'{{.name = "{shader.name}", .code = {code[0]}, .sp3 = {code[1]}, .cpu = {cpu[0]}, .cpu_sp3 = {cpu[1]}, '
        f".push_size = sizeof(gpu::{shader.push}){stage_facts(texts, shader)}}}"
    )
    if shader.type != "Shader":
        values = f"{{{values}}}"
    if shader.type == "EntryShader":
        values = f"{{{values}}}"
    return f"const device::{shader.type} {shader.name}{values};\n"


def folder_of(texts: Texts, shaders: list[Shader], folder: str, spirv: bool, levels: list[str]) -> str:
    own = [shader for shader in shaders if shader.folder == folder]
    includes = "".join(f'#include "interface/{shader.file}.h"\n' for shader in own)
    includes += "".join(f'#include "spirv/{code}.h"\n' for shader in own for code in shader.codes if spirv)
    kernels = "".join(kernels_of(shader, levels) for shader in own)
    definitions = "".join(definition_of(texts, shader, spirv, levels) for shader in own)
    return f"""{includes}
namespace quadgraph {{

{kernels}
namespace shader {{

{definitions}
}}  // namespace shader
}}  // namespace quadgraph
"""


def structs_in_memory(texts: Texts, shaders: list[Shader]) -> list[Struct]:
    """Push constants and elements of arrays, and what they hold, where C++ knows them: what is held comes first."""
    known = {s.name: s for file in texts if is_cpp(texts, file) for s in structs_of(texts[file], True, 1)}
    pushes = {shader.push for shader in shaders}
    for shader in shaders:
        own = structs_of(texts[shader.file], True, 1)
        known |= {struct.name: struct for struct in own if struct.name == shader.push}
    found: dict[str, Struct] = {}

    def add(name: str) -> None:
        if name in known and name not in found:
            for member in known[name].members:
                add(member.type)
            found[name] = known[name]

    for name in sorted(pushes | elements_of(texts)):
        add(name)
    return list(found.values())


def layout_of(struct: Struct) -> str:
    members = ", ".join(f'{{"{m.name}", offsetof(gpu::{struct.name}, {m.name})}}' for m in struct.members)
    return f'    {{"{struct.name}", sizeof(gpu::{struct.name}), {{{members}}}}},\n'


def all_shaders(texts: Texts, shaders: list[Shader]) -> str:
    structs = structs_in_memory(texts, shaders)
    includes = "".join(f'#include "interface/{shader.file}.h"\n' for shader in shaders)
    names = "".join(f"    &shader::{shader.name},\n" for shader in shaders)
    return f"""// All shaders, and the structs that lie in memory which they share with C++.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

{includes}
namespace quadgraph {{

struct StructLayout {{
  std::string name;
  std::size_t size;
  std::vector<std::pair<std::string, std::size_t>> offsets;
}};

inline const std::vector<const device::Shader*> all_shaders = {{
{names}}};

inline const std::vector<StructLayout> struct_layouts = {{
{"".join(map(layout_of, structs))}}};

}}  // namespace quadgraph
"""


def interfaces(texts: Texts, spirv: bool, levels: list[str]) -> dict[str, str]:
    """Generated files. interface/FOLDER/NAME.STAGE.h per shader: its device::Shader (engine/device/shader.h),
    quadgraph::shader::NAME of a compute shader and NAME_STAGE of others, and as quadgraph::gpu::XPush the push
    constants that the shader itself declares. interface/FOLDER.cpp defines the shaders, if `spirv` from
    spirv/NAME.STAGE.h, and from native/CODE.cpp, which is compiled for each of `levels` of instructions;
    interface/cpu_levels.h names these.
    interface/all_shaders.h is for tests, interface/variants.txt says what is compiled: file, MOMENTS, name.
    """
    shaders = shaders_of(texts)
    files = {f"interface/{shader.file}.h": interface_of(texts, shader) for shader in shaders}
    for folder in {shader.folder for shader in shaders}:
        files[f"interface/{folder}.cpp"] = folder_of(texts, shaders, folder, spirv, levels)
    files["interface/all_shaders.h"] = all_shaders(texts, shaders)
    files["interface/variants.txt"] = "".join(
        f"{shader.file} {moments} {code}\n" for shader in shaders for moments, code in enumerate(shader.codes, 1)
    )
    for shader in shaders:
        for moments, code in enumerate(shader.codes, 1):
            files[f"native/{code}.cpp"] = native_shader(texts, shader.file, moments)
    names = ", ".join(f'"{level}"' for level in levels)
    files[
        "interface/cpu_levels.h"
    ] = f"""// The levels of instructions that shaders were compiled for (engine/device/shader.h).
#pragma once

inline constexpr const char* cpu_level_names[] = {{{names}}};
"""
    return files
