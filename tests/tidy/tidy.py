#!/usr/bin/env python3
"""House rules that a machine can check: who includes whom, what must not stand in a run, sizes.

Usage: tidy.py ROOT          checks the tree
       tidy.py ROOT --self   checks that the rules find planted violations
"""
import re
import subprocess
import sys
from pathlib import Path

# A room may include itself, what is named here, and what these may include.
MAY_INCLUDE = {
    "sim/math": [],
    "sim/kernel": ["sim/math"],
    "sim/world": ["sim/kernel", "sim/math"],
    "sim/record": ["sim/kernel"],
    "net": ["sim/kernel", "sim/math"],
    "net/live": ["net", "filters", "sim/kernel", "sim/math"],
    "filters": ["sim/math", "sim/kernel/error.hpp"],
    "agents": ["net", "filters", "sim/world", "sim/kernel", "sim/math"],
    "scenarios": ["agents", "net", "filters", "sim/world", "sim/kernel", "sim/math"],
    "tools": ["scenarios", "agents", "net", "filters", "sim"],
    "tests": ["tools", "scenarios", "agents", "net", "filters", "sim"],
    "examples": ["tools", "agents"],
}
# Who may know that there is a network.
MAY_INCLUDE_LIVE = ["net/live", "tools", "tests"]
# Third parties that a room may name in an include, by the start of the header's path.
THIRD_PARTIES = {
    "sim/math": ["sleef.h"],
    "sim/kernel": ["Random123/"],
    "sim/world": ["png.h"],
    "sim/record": ["SQLiteCpp/", "sqlite3.h", "xxhash.h", "xxh_x86dispatch.h", "fmt/"],
    "net/live": ["dds/", "hearsay/idl/", "sys/eventfd.h", "unistd.h"],
    "filters": ["Eigen/"],
    "agents": ["Eigen/"],
    "scenarios": ["toml++/", "boost/tokenizer.hpp", "fmt/"],
}
RUN_ROOMS = ["sim", "net", "filters", "agents", "scenarios"]
# What may not stand in code that computes a run, and where it may all the same.
FORBIDDEN = [
    (r"system_clock|steady_clock|high_resolution_clock|random_device|mt19937|\brand\(", "a clock or foreign randomness", []),
    (r"std::(normal|uniform_real|uniform_int|exponential|poisson|bernoulli|discrete)_distribution",
     "a distribution whose draws depend on the library", []),
    (r"unordered_(map|set)", "iteration in hash order", []),
    (r"std::(exp|expm1|log|log1p|log2|log10|pow|sin|cos|tan|asin|acos|atan|atan2|tanh|hypot|lgamma|tgamma|erf|cbrt)\(",
     "a function of the C library whose bits depend on the CPU", []),
    (r"(?<![\w:.])(exp|log|pow|sin|cos|tan|atan2|hypot|lgamma)\(", "an unqualified C library function",
     ["sim/math/"]),
    (r"\.array\(\)\.(exp|log|sin|cos|pow|tanh)\(|Rotation2D|AngleAxis", "Eigen transcendentals", []),
    (r"catch \(\.\.\.\) *\{ *\}", "an exception swallowed", []),
    (r"\bthread_local\b|^\s*static (?!constexpr|const |inline)[\w:<>]+ \w+( =|;|\{)", "a global or hidden state", []),
]
AWAIT = re.compile(r"\bco_await\b")
AWAIT_OK = re.compile(r"^\s*((const )?auto&? \w+ = )?co_await [\w.:\->()]+\((.*)\);$")


def sources(root):
    listed = subprocess.run(["git", "-C", root, "ls-files", "-co", "--exclude-standard"],
                            capture_output=True, text=True, check=True).stdout.split("\n")
    return [f for f in listed if f.endswith((".cpp", ".hpp")) and (Path(root) / f).exists()]


def room_of(path):
    rooms = [room for room in MAY_INCLUDE if path.startswith(room + "/")]
    return max(rooms, key=len) if rooms else None


def code_lines(text):
    """Lines without comments and string contents, numbered from 1."""
    for number, line in enumerate(text.split("\n"), 1):
        line = re.sub(r'"(\\.|[^"\\])*"', '""', line)
        yield number, re.sub(r"//.*", "", line)


def includes(path, text, room):
    own = room.split("/")[0] if room == "tools" else room
    for number, line in enumerate(text.split("\n"), 1):
        quoted = re.match(r'#include "([^"]+)"', line)
        if quoted:
            target = quoted[1]
            beside = room == "tests" and "/" not in target
            known = [own, *MAY_INCLUDE[room]]
            live = target.startswith("net/live/") and room not in MAY_INCLUDE_LIVE
            if live or (not beside and not any(target.startswith(a + "/") or target == a for a in known)):
                yield number, f"{room} may not include {target}"
        angled = re.match(r"#include <([^>]+)>", line)
        if angled and room in THIRD_PARTIES.keys() | {"net"}:
            header = angled[1]
            if ("/" in header or header.endswith(".h")) and not any(
                    header.startswith(t) for t in THIRD_PARTIES.get(room, [])):
                if not header.startswith(("sys/", "unistd", "fcntl")) or room != "sim/record":
                    yield number, f"{room} may not include <{header}>"


def check(path, text):
    room = room_of(path)
    if room is None:
        return
    yield from includes(path, text, room)
    lines = text.split("\n")
    if len(lines) > 450:
        yield len(lines), "more than 450 lines"
    for number, line in enumerate(lines, 1):
        if len(line) > 100:
            yield number, "more than 100 columns"
    if path.split("/")[0] in RUN_ROOMS:
        for number, line in code_lines(text):
            for pattern, why, allowed in FORBIDDEN:
                if any(path.startswith(a) for a in allowed):
                    continue
                if re.search(pattern, line):
                    yield number, why
    if path.split("/")[0] in RUN_ROOMS + ["examples"]:
        for number, line in code_lines(text):
            bare = re.sub(r"^\s*(for|while|if) \(.*?\) (?=co_await)", "", line)
            if AWAIT.search(line) and not (AWAIT_OK.match(bare) and "{" not in bare and "[" not in bare):
                yield number, "co_await outside the forms that gcc 12 compiles rightly"


def self_test():
    planted = {
        "filters/a.cpp": '#include "net/radio.hpp"\n',
        "sim/kernel/a.cpp": "auto t = std::chrono::steady_clock::now();\n",
        "net/a.cpp": "double y = std::exp(x);\n",
        "agents/a.cpp": "std::unordered_map<int, int> m;\n",
        "agents/b.cpp": "  f(co_await g(x));\n",
        "agents/c.cpp": "  co_await g([&] { return 1; });\n",
        "agents/d.cpp": "  co_await g({1, 2});\n",
        "scenarios/a.cpp": "#include <CLI/CLI.hpp>\n",
        "net/c.cpp": "#include <dds/dds.h>\n",
        "agents/e.cpp": '#include "net/live/port.hpp"\n',
        "net/d.cpp": '#include "net/live/port.hpp"\n',
        "net/live/a.cpp": '#include "agents/agent.hpp"\n',
        "net/b.cpp": "// " + "x" * 100 + "\n",
        "sim/world/a.cpp": "static int counter = 0;\n",
    }
    clean = {
        "agents/f.cpp": "  co_await sleep(1_s);\n  auto x = co_await box.receive();\n",
        "net/e.cpp": '#include "sim/kernel/time.hpp"\n// std::exp( in a comment\n',
        "net/live/b.cpp": '#include <dds/dds.h>\n#include "filters/gaussian/codec.hpp"\n',
        "tools/live/a.cpp": '#include "net/live/port.hpp"\n',
        "filters/b.cpp": "double y = math::exp(x);\nstatic constexpr int n = 3;\n",
    }
    bad = [p for p, t in planted.items() if not list(check(p, t))]
    bad += [p for p, t in clean.items() if list(check(p, t))]
    for path in bad:
        print(f"self-test: rule fails on {path}")
    return 1 if bad else 0


def main():
    root = sys.argv[1]
    if "--self" in sys.argv:
        return self_test()
    found = 0
    for path in sources(root):
        text = (Path(root) / path).read_text()
        for number, what in check(path, text):
            print(f"{path}:{number}: {what}")
            found += 1
    print(f"{found} violations")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
