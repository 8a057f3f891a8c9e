"""What a fragment shader costs before it runs: instructions of its optimised SPIR-V.

The same shader gives the same number every time, which no clock does.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from pydantic import BaseModel, ConfigDict

PACKAGES = {
    "glslangValidator": "glslang-tools",
    "spirv-opt": "spirv-tools",
    "spirv-dis": "spirv-tools",
}
"""The Debian package of each program."""

TRANSCENDENTAL = frozenset(
    "Sqrt InverseSqrt Exp Exp2 Log Log2 Pow Sin Cos Tan Asin Acos Atan Atan2 Normalize Length "
    "Distance".split()
)
TEXTURE = re.compile(r"OpImage(Sparse)?(Sample|Fetch|Gather|DrefGather|Read)")
ARITHMETIC = re.compile(
    r"Op(F(?!unction)|I(Add|Sub|Mul|Equal|NotEqual|sNan|sInf)|[SU](Div|Mod|Rem|Negate|Less|Greater)"
    r"|Dot|VectorTimes|MatrixTimes|OuterProduct|Transpose|Select$|Logical|Convert|Bit|Shift|Not|Any|All|DPd)"
)
FIXED_LENGTH = re.compile(r"OpSLessThan %bool %\w+ %int_(\d+)")


class StaticCost(BaseModel):
    """Instructions of a fragment shader; one on a vector counts once.

    Attributes:
        alu: Arithmetic, comparisons and conversions.
        transcendental: Roots, powers, exponentials, logarithms and angles.
        texture: Texture reads.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    alu: int = 0
    transcendental: int = 0
    texture: int = 0


def missing_packages() -> list[str]:
    """Debian packages whose programs are not installed; nothing can be counted without them."""
    missing = {package for name, package in PACKAGES.items() if shutil.which(name) is None}
    return sorted(missing)


def static_cost(fragment_shader: str) -> StaticCost:
    """Count the instructions of a WebGL 2 fragment shader.

    Args:
        fragment_shader: GLSL ES 3.00 as WebGL compiled it.

    Raises:
        RuntimeError: It does not compile to SPIR-V.
    """
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        (work / "shader.frag").write_text(_for_glslang(fragment_shader), "utf-8")
        glslang = "glslangValidator -G --auto-map-locations --auto-map-bindings -S frag"
        for command in (
            f"{glslang} -o shader.spv shader.frag",
            "spirv-opt --loop-unroll -O shader.spv -o optimised.spv",
            "spirv-dis --no-color optimised.spv -o shader.txt",
        ):
            done = subprocess.run(command.split(), cwd=work, capture_output=True, text=True)
            if done.returncode != 0:
                raise RuntimeError(f"{command}: {done.stdout}{done.stderr}")
        return count_instructions((work / "shader.txt").read_text("utf-8"))


def _for_glslang(source: str) -> str:
    """The shader in GLSL ES 3.10, which glslang takes to SPIR-V."""
    source = source.replace(
        "#version 300 es",
        "#version 310 es\n#extension GL_EXT_control_flow_attributes : require",
        1,
    )
    # Vulkan's and OpenGL's SPIR-V have no boolean uniforms.
    source = re.sub(r"^\s*uniform bool (\w+);", r"const bool \1 = false;", source, flags=re.M)
    # glslang knows a built-in function of that name, three defines one.
    source = re.sub(r"\baverage\b", "average3", source)
    return re.sub(r"\bfor\s*\(", "[[unroll]] for (", source)


def count_instructions(disassembly: str) -> StaticCost:
    """Count by kind, each instruction as often as the loops around it run.

    A loop counts with its length where that is fixed in the shader, once where a pixel decides it.

    Args:
        disassembly: What spirv-dis prints, in the order of structured control flow.
    """
    counts = dict.fromkeys(StaticCost.model_fields, 0)
    lines = disassembly.splitlines()
    ends: list[tuple[str, int]] = []  # label after each open loop, and its length
    for number, line in enumerate(lines):
        words = line.split()
        if not words:
            continue
        result, words = (words[0], words[2:]) if words[1:2] == ["="] else ("", words)
        while ends and words[0] == "OpLabel" and result == ends[-1][0]:
            ends.pop()
        if words[0] == "OpLoopMerge":
            fixed = FIXED_LENGTH.search(lines[number - 1])
            ends.append((words[1], int(fixed[1]) if fixed else 1))
        kind = _kind(words)
        if kind:
            times = 1
            for _, length in ends:
                times *= length
            counts[kind] += times
    return StaticCost(**counts)


def _kind(words: list[str]) -> str | None:
    if words[0] == "OpExtInst":
        return "transcendental" if words[3] in TRANSCENDENTAL else "alu"
    if TEXTURE.match(words[0]):
        return "texture"
    return "alu" if ARITHMETIC.match(words[0]) else None
