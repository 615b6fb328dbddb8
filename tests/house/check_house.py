#!/usr/bin/env python3
"""The house keeps its edges: who includes whom, how long files are, and which structs host and device share.

    check_house.py SOURCE

Reads the sources below SOURCE and prints one line a violation, as file:line: message. Exit code: 0 when there is none.
"""
import re
import sys
from pathlib import Path

FOLDERS = ("host", "include", "kernels", "tests", "tools", "bench", "samples", "python")
SOURCES = {".cpp", ".h", ".cl", ".py", ".sh"}
LINES = {"kernels": 250}  # a file, at most; 400 elsewhere

# What each folder of host/ may include of the others.
HOST_EDGES = {
    "base": "",
    "microfacet": "base",
    "image": "base",
    "surface": "base image",
    "device": "base",
    "reference": "base surface",
    "methods": "base microfacet surface device reference",
    "verify": "base surface device reference methods",
    "scene": "base microfacet image surface",
    "job": "base microfacet image surface methods scene",
    "render": "base microfacet image surface device reference methods scene job",
    "gbuffer": "base microfacet image surface device methods scene job render",
    "tables": "base surface",
    "measure": "base microfacet image surface device reference methods scene job render",
    "report": "base image surface device methods scene job render measure",
    "library": "base microfacet image surface device reference methods scene job render gbuffer",
    "app": "base microfacet image surface device reference methods scene job render gbuffer tables verify measure report",
    "main.cpp": "base app",
}
# What the public headers hide: whoever includes them needs none of these.
PRIVATE = re.compile(r"^(CL/|embree|toml|OpenImageIO|Eigen|host/|kernels/)")
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^">]+)[">]')
STRUCT = re.compile(r"typedef struct \{(.*?)\} (\w+);", re.S)


class House:
    def __init__(self, root):
        self.root = root
        self.violations = []
        self.files = {
            path.relative_to(root).as_posix(): path.read_text().splitlines()
            for folder in FOLDERS
            for path in sorted((root / folder).rglob("*"))
            if path.suffix in SOURCES
        }
        self.includes = {name: list(self.includes_of(name)) for name in self.files}

    def complain(self, name, line, message):
        self.violations.append(f"{name}:{line}: {message}")

    def includes_of(self, name):
        """(line, what is written, the file that it is or None) of each include."""
        places = ["", "include", "kernels", Path(name).parent.as_posix()]
        for number, text in enumerate(self.files[name], 1):
            match = INCLUDE.match(text)
            if match:
                found = [f"{place}/{match[1]}".lstrip("/") for place in places]
                yield number, match[1], next((file for file in found if file in self.files), None)

    def check_edges(self):
        for name, includes in self.includes.items():
            parts = name.split("/")
            if parts[0] == "host" and parts[1] not in HOST_EDGES:
                self.complain(name, 1, f"host/{parts[1]} is no room of the house")
                continue
            for line, written, file in includes:
                target = (file or written).split("/")
                if parts[0] == "host":
                    self.check_host_edge(name, line, parts[1], written, target)
                elif parts[0] in ("include", "python") and PRIVATE.match(file or written):
                    self.complain(name, line, f"includes {written}; the library's face and the module on it hide that")
                elif parts[0] == "kernels" and target[0] in ("host", "include"):
                    self.complain(name, line, f"a kernel includes {written}")
                elif target[:2] == ["host", "app"]:
                    self.complain(name, line, f"includes {written}; nobody includes the command")

    def check_host_edge(self, name, line, folder, written, target):
        if target[0] == "host" and target[1] not in [folder, *HOST_EDGES[folder].split()]:
            self.complain(name, line, f"host/{folder} includes {written}; it may include: {HOST_EDGES[folder] or '-'}")
        elif target[0] == "kernels" and (folder == "reference" or not re.search(r"(types|struct_layout)\.h$", written)):
            self.complain(name, line, f"host/{folder} includes {written}; host and kernels share *types.h alone")

    def check_cycles(self):
        done, path = set(), []

        def visit(name):
            if name in path:
                self.complain(name, 1, "includes itself: " + " -> ".join([*path[path.index(name):], name]))
            elif name not in done:
                path.append(name)
                for _, _, file in self.includes[name]:
                    if file:
                        visit(file)
                path.pop()
                done.add(name)

        for name in self.files:
            visit(name)

    def check_lengths(self):
        for name, lines in self.files.items():
            limit = LINES.get(name.split("/")[0], 400)
            if len(lines) > limit:
                self.complain(name, limit + 1, f"has {len(lines)} lines; {limit} are allowed")

    def check_layout(self):
        """kernels/struct_layout.h names every struct of every *types.h with every field."""
        layout = "kernels/struct_layout.h"
        listed = re.findall(r"^  (SIZE|OFFSET)\((\w+)(?:, (\w+))?\)", "\n".join(self.files[layout]), re.M)
        expected = []
        for name in self.files:
            if not (name.startswith("kernels/") and name.endswith("types.h")):
                continue
            text = "\n".join(self.files[name])
            for struct in STRUCT.finditer(text):
                line = text.count("\n", 0, struct.end()) + 1
                fields = re.findall(r"(\w+)\s*[,;]", re.sub(r"//[^\n]*", "", struct[1]))
                for entry in [("SIZE", struct[2], ""), *(("OFFSET", struct[2], field) for field in fields)]:
                    expected.append(entry)
                    if entry not in listed:
                        what = ".".join(filter(None, entry[1:]))
                        self.complain(name, line, f"{layout} lacks {entry[0]} of {what}")
        for entry in listed:
            if entry not in expected:
                self.complain(layout, 1, f"has {entry[0]} of {'.'.join(entry[1:])}, which no *types.h defines")
        if not expected:
            self.complain(layout, 1, "found no shared struct in any kernels/**/*types.h")


def main():
    house = House(Path(sys.argv[1]))
    if not house.files:
        sys.exit(f"{sys.argv[1]}: found no sources")
    house.check_edges()
    house.check_cycles()
    house.check_lengths()
    house.check_layout()
    print("\n".join(house.violations) or f"{len(house.files)} files keep the rules of the house")
    sys.exit(1 if house.violations else 0)


if __name__ == "__main__":
    main()
