"""The machine code of functions whose speed depends on how they are compiled.

The tests' build is optimized less than a release: memory that it does not fill in advance, a release does not either.
"""

import os
import re
import shutil
import subprocess

import pytest

# Bytes of the stack of a walk through a tree (src/shape/bvh/stack.rs), alone and with its height beside it.
STACKS = {2048, 2056}
FUNCTION = re.compile(r"^[0-9a-f]+ <(.*)>:$")
LENGTH = re.compile(r"mov\s+\$(0x[0-9a-f]+),%edx$")


def fills(listing):
    """Yields function name and number of bytes of every memset of constant length."""
    name, length = "", None
    for line in listing:
        if found := FUNCTION.match(line):
            name, length = found[1], None
        elif found := LENGTH.search(line):
            length = int(found[1], 16)
        elif "call" in line:
            if "memset" in line and length is not None:
                yield name, length
            length = None


def walks_that_fill(listing):
    """Returns functions of the library that fill the stack of a walk in advance.

    Excludes functions that run third-party decoders. The JPEG decoder has a list of equal length for the pieces of a
    color profile, and may be inlined into its callers."""
    decoders = ("scene::decode", "film::decoder_guard")
    own = lambda name: "abbe" in name and not any(decoder in name for decoder in decoders)
    return [name for name, length in fills(listing) if length in STACKS and own(name)]


def test_memsets_are_found_in_a_listing():
    listing = [
        "0000000000001000 <abbe::walk>:",
        "    1000:\tmov    $0x808,%edx",
        "    1005:\txor    %esi,%esi",
        "    1007:\tcall   *0x10(%rip)        # 2000 <memset@GLIBC_2.2.5>",
        "    100d:\tmov    $0x10,%edx",
        "    1012:\tcall   3000 <memcpy>",
        "    1017:\tcall   *0x10(%rip)        # 2000 <memset@GLIBC_2.2.5>",
    ]
    assert list(fills(listing)) == [("abbe::walk", 2056)]
    assert walks_that_fill(listing) == ["abbe::walk"]
    assert walks_that_fill(line.replace("walk", "film::decoder_guard::guarded") for line in listing) == []


def test_the_stack_of_a_walk_is_not_filled_in_advance():
    if os.uname().machine != "x86_64" or shutil.which("objdump") is None:
        pytest.skip("reads x86-64 code with objdump (package binutils)")
    command = ["objdump", "--disassemble", "--demangle", "--no-show-raw-insn", os.environ["RENDER"]]
    listing = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    assert any("abbe::" in line for line in listing), "no function of the library is named"
    assert walks_that_fill(listing) == []
