# SPDX-License-Identifier: BSD-3-Clause
"""snapshot_members_test.py SOURCE_TREE: a snapshot of the mapper leaves out no member.

Each class that has a persist() names all its members there, but mutable ones, which are made anew,
and those listed here. Prints every other; exits 1.
"""
import os
import re
import sys

# Told anew by the configuration, or made anew at each use.
NOT_KEPT = {
    "Album": "rig_ max_bytes_",
    "BeamTimes": "range_sd_m_ gap_max_s_",
    "Degradation": "has_camera_",
    "ExistenceFilter": "config_ p_base_laser_",
    "MapState": "config",
    "MapperNode": "config_ antenna_base_m_ laser_ blind_ has_camera_ object_width_max_m_ has_reflectors_ "
                  "has_readers_",
    "ModeCache": "few_",
    "ObservationStore": "memory_",
    "PointGrid": "cells_per_m_",
    "PoseTrack": "gap_max_us_",
    # the snapshot's own book-keeping
    "JournaledMapper": "config_ config_hash_ place_ snapshot_period_ memory_ journal_ before_new_map_ "
                       "journal_number_ num_since_snapshot_ num_rebuilt_ is_flushed_ notes_",
}
# Structs without a persist() of their own, and whose it is.
KEPT_BY = {"MapState": "Mapper"}
NO_MEMBER = re.compile(r"^(using|static|friend|enum|struct|class|template|typedef|explicit|virtual|mutable)\b")


def sources(root, ending):
    for part in ("lib", "procs"):
        for folder, _, names in os.walk(os.path.join(root, part)):
            for name in sorted(names):
                if name.endswith(ending):
                    yield os.path.join(folder, name)


def text_of(path):
    """A file without comments."""
    with open(path) as file:
        return re.sub(r"//[^\n]*", "", file.read())


def block(text, begin):
    """The end of the block whose { stands at begin."""
    depth = 0
    for at in range(begin, len(text)):
        depth += (text[at] == "{") - (text[at] == "}")
        if depth == 0:
            return at
    return len(text)


def without_blocks(text):
    """A class's own level: every inner block becomes {}; one that ends no declaration ends it."""
    out, at = "", 0
    while at < len(text):
        if text[at] == "{":
            end = block(text, at)
            after = text[end + 1:].lstrip()[:1]
            out += "{}" if after in (";", ",") else "{};"
            at = end
        else:
            out += text[at]
        at += 1
    return out


def members(body):
    """Names of a class's data members that a snapshot should know."""
    found = []
    for statement in without_blocks(body).split(";"):
        words = re.sub(r"\b(public|private|protected)\s*:(?!:)", "", statement).strip()
        plain = re.sub(r"(=|\{).*", "", words, flags=re.S)
        if not words or NO_MEMBER.match(words) or "(" in plain or "operator" in plain:
            continue
        while re.search(r"<[^<>]*>", words):
            words = re.sub(r"<[^<>]*>", " ", words)
        names = [re.sub(r"=.*", "", part, flags=re.S).split() for part in words.replace("{}", " ").split(",")]
        if len(names[0]) < 2:  # a type and a name
            continue
        found += [re.sub(r"[*&]|\[.*", "", part[-1]) for part in names if part]
    return [name for name in found if re.fullmatch(r"[A-Za-z_]\w*", name)]


def classes(text):
    """(name, body) of every class and struct, inner ones too."""
    for match in re.finditer(r"\b(?:class|struct)\s+(\w+)[^;{}()]*\{", text):
        yield match.group(1), text[match.end():block(text, match.end() - 1)]


def own_persist(body):
    """The text of a persist() that stands in this class itself, "" for one that is only declared."""
    for match in re.finditer(r"\bpersist\([^)]*\)\s*(;|\{)", body):
        depth = body[:match.start()].count("{") - body[:match.start()].count("}")
        if depth == 0 and re.search(r"\bvoid\s+$", body[:match.start()]):
            end = block(body, match.end() - 1) if match.group(1) == "{" else match.end()
            return body[match.end():end] if match.group(1) == "{" else ""
    return None


def main():
    root, failed, num = sys.argv[1], False, 0
    code = "\n".join(text_of(path) for path in sources(root, ".cpp"))
    for path in sources(root, ".hpp"):
        for name, body in classes(text_of(path)):
            keeper = KEPT_BY.get(name, name)
            said = own_persist(body) if keeper == name else ""
            if said == "":
                definition = re.search(rf"\b{keeper}::persist\([^)]*\)\s*\{{", code)
                said = code[definition.end():block(code, definition.end() - 1)] if definition else ""
            if said is None:
                continue
            num += 1
            for member in members(body):
                if member in NOT_KEPT.get(name, "").split() or re.search(rf"\b{member}\b", said):
                    continue
                print(f"{os.path.relpath(path, root)}: {name}::persist() leaves out {member}")
                failed = True
    if num == 0:
        print("no class with persist() was found")
    return 1 if failed or num == 0 else 0


sys.exit(main())
