"""Code size, and the deepest stack that calls from the entry can reach, of a Thumb-2 program: bare_metal.py PROGRAM

A function's stack is what its `push`, `vpush` and `sub sp` take, all of them added up; calls are its `bl` and `b.w`. Words that
are data are skipped by the linker's mapping symbols. A call through a register or a recursion would make the figure
meaningless: both are errors.
"""

import struct
import sys
from pathlib import Path

THUMB, DATA = b"$t", b"$d"


def read(program):
    """Sections by name as (address, bytes), and symbols as (name, address, size, type)."""
    at, step, count, names = struct.unpack_from("<I10xHHH", program, 32)
    headers = [struct.unpack_from("<10I", program, at + step * index) for index in range(count)]

    def text(table, offset):
        return program[headers[table][4] + offset :].split(b"\0", 1)[0]

    sections = {text(names, header[0]): (header[3], program[header[4] : header[4] + header[5]]) for header in headers}
    symbols = []
    for header in headers:
        if header[1] == 2:  # SHT_SYMTAB
            for offset in range(header[4], header[4] + header[5], 16):
                name, value, size, info = struct.unpack_from("<IIIB", program, offset)
                symbols.append((text(header[6], name), value, size, info & 15))
    return sections, symbols


def signed(value, bits):
    return value - (1 << bits) if value >> (bits - 1) else value


def wide_immediate(first, second):
    """The modified immediate of Thumb-2."""
    code = (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xFF
    if code >> 10 == 0:
        byte = code & 0xFF
        return (byte, byte << 16 | byte, byte << 24 | byte << 8, byte * 0x01010101)[code >> 8]
    turns = code >> 7
    value = 0x80 | code & 0x7F
    return (value >> turns | value << (32 - turns)) & 0xFFFFFFFF


def function(code, base, start, end, is_data):
    """Bytes of stack and the addresses that it calls or jumps to."""
    stack, targets, at = 0, set(), start
    while at + 2 <= end:
        if is_data(at):
            at += 2
            continue
        (first,) = struct.unpack_from("<H", code, at - base)
        if first >> 11 < 0b11101:
            if first & 0xFE00 == 0xB400:  # push
                stack += 4 * (first & 0x1FF).bit_count()
            elif first & 0xFF80 == 0xB080:  # sub sp
                stack += 4 * (first & 0x7F)
            elif first & 0xFF87 == 0x4780:  # blx register
                sys.exit(f"a call through a register at {at:#x}")
            at += 2
            continue
        (second,) = struct.unpack_from("<H", code, at + 2 - base)
        if first == 0xE92D:  # push
            stack += 4 * second.bit_count()
        elif first == 0xF84D and second & 0x0FFF == 0x0D04:  # push of one
            stack += 4
        elif first & 0xFFBF == 0xED2D:  # vpush
            stack += 4 * (second & 0xFF)
        elif first & 0xFBEF == 0xF1AD and second & 0x8F00 == 0x0D00:  # sub sp
            stack += wide_immediate(first, second)
        elif first & 0xFBFF == 0xF2AD and second & 0x8F00 == 0x0D00:  # subw sp
            stack += (first >> 10 & 1) << 11 | (second >> 12 & 7) << 8 | second & 0xFF
        elif first & 0xF800 == 0xF000 and second & 0x9000 == 0x9000:  # bl, b.w
            sign, one, two = first >> 10 & 1, second >> 13 & 1, second >> 11 & 1
            offset = sign << 24 | (one ^ sign ^ 1) << 23 | (two ^ sign ^ 1) << 22 | (first & 0x3FF) << 12 | (second & 0x7FF) << 1
            targets.add(at + 4 + signed(offset, 25))
        at += 4
    return stack, targets


def main(path):
    sections, symbols = read(Path(path).read_bytes())
    base, code = sections[b".text"]
    marks = sorted((value, name[:2]) for name, value, _, _ in symbols if name[:2] in (THUMB, DATA))

    def is_data(address):
        kind = THUMB
        for value, name in marks:
            if value > address:
                break
            kind = name
        return kind == DATA

    functions = {value & ~1: (name, size) for name, value, size, kind in symbols if kind == 2 and size > 0}
    parts = {at: function(code, base, at, at + size, is_data) for at, (_, size) in functions.items()}

    def deepest(at, above):
        if at in above:
            sys.exit(f"{functions[at][0]} calls itself")
        stack, targets = parts[at]
        inner = [deepest(target, above | {at}) for target in targets if target in functions and target != at]
        return max(((stack + size, [(at, stack), *way]) for size, way in inner), default=(stack, [(at, stack)]))

    entry = next(at for at, (name, _) in functions.items() if name == b"step")
    stack, way = deepest(entry, frozenset())
    constants = sum(len(content) for name, (_, content) in sections.items() if name.startswith(b".rodata"))
    print(f"code {len(code)} bytes, constants {constants} bytes, stack {stack} bytes:")
    for at, size in way:
        print(f"  {size:6} {functions[at][0].decode()}")


if __name__ == "__main__":
    main(sys.argv[1])
