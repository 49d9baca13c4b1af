#!/usr/bin/env bash
# Includes go one way. A folder knows those of the lines above its own, and within a line nobody but itself:
#   core
#   physics, transport, config, rtps, messages, topics, host (core only)
#   security (knows topics), node, command_line
#   dds, records (knows node)
#   cut
#   setup, steering, process, launch (each knows those before it)
#   overseer, agent (knows overseer; neither knows process and launch)
#   import (core, physics and config only)
#   cli
#   lab (not the processes of a run: only setup and what stands above it)
#   client (what programs of others are linked with: knows none of the others) <- python, agent
# and each library stays behind the folder that wraps it; core knows Eigen and the standard library only.
# Within a folder there is no circle: x.h and x.cpp are one unit, and no unit includes one that includes it, directly
# or through others. (Not yet in config.)
#   scripts/check_includes.sh [SRC]      SRC: the folder to check (src)
set -euo pipefail
cd "${1:-$(dirname "${BASH_SOURCE[0]}")/../src}"

mapfile -t files < <(find . -mindepth 1 \( -name '*.h' -o -name '*.cpp' \) -printf '%P\n' | LC_ALL=C sort)
[[ ${#files[@]} -gt 0 ]] || { echo "check_includes.sh: no source files in $PWD" >&2; exit 1; }

awk '
  BEGIN {
    allow("core", "core")
    allow("topics", "core topics")
    allow("security", "core topics security")
    allow("messages", "core messages")
    allow("physics", "core physics")
    allow("transport", "core transport")
    allow("config", "core config")
    allow("rtps", "core rtps")
    allow("dds", "core topics security transport config rtps messages dds")
    allow("node", "core physics transport node")
    allow("records", "core physics transport node records")
    allow("host", "core host")
    allow("command_line", "config host command_line")
    allow("cut", "core security physics config messages host cut")
    below = "core topics security physics transport config rtps messages dds node records host command_line cut setup"
    allow("setup", below)
    allow("steering", below " steering")
    allow("process", below " steering process")
    allow("launch", below " steering process launch")
    allow("overseer", below " steering overseer")
    allow("agent", below " steering overseer client agent")
    allow("import", "core physics config import")
    allow("client", "client")
    allow("python", "python")
    allow("cli", below " steering process launch overseer agent import cli")
    # The laboratory is a program of its own: no folder of the product knows it.
    allow("lab", below " lab")

    wrap("physics", "BulletCollision BulletDynamics LinearMath bullet")
    wrap("messages", "fastdds fastrtps fastcdr")
    wrap("dds", "fastdds fastrtps fastcdr")
    wrap("config", "yaml-cpp assimp")
    wrap("command_line", "CLI")
    wrap("setup", "CLI")
    wrap("overseer", "CLI")
    wrap("cli", "CLI")
    wrap("security", "openssl")
    wrap("overseer", "boost openssl")
    wrap("python", "pybind11")
    wrap("import", "sdf ignition mujoco tinyxml2.h yaml-cpp assimp")

  }

  function allow(folder, others,    list, n, i) {
    known[folder] = 1
    n = split(others, list, " ")
    for (i = 1; i <= n; ++i) allowed[folder, list[i]] = 1
  }

  function wrap(folder, libraries,    list, n, i) {
    n = split(libraries, list, " ")
    for (i = 1; i <= n; ++i) wrapper[list[i]] = wrapper[list[i]] " " folder
  }

  function refuse(why) {
    printf "src/%s:%d: includes %s: %s\n", FILENAME, FNR, included, why
    ++refused
  }

  # "folder/file.h", from the root of src.
  function check_own(name,    parts) {
    if (name ~ /^(aurasim|ros2)[A-Za-z]*\.h$/) {  # generated from idl/
      if (folder != "messages" && folder != "dds") refuse("only messages and dds know the wire types")
      return
    }
    split(name, parts, "/")
    if (!(parts[1] in known) || name !~ /\//) refuse("write the path from src, as in \"core/ids.h\"")
    else if (!((folder, parts[1]) in allowed)) refuse(folder " may not know " parts[1])
    else if (parts[1] == folder && folder != "config") note_arrow(unit_of(FILENAME), unit_of(name))
  }

  function check_library(name,    parts, library) {
    if (folder == "core" && name !~ /^Eigen\// && name !~ /^[a-z_0-9]+$/) {
      refuse("core knows Eigen and the standard library only")
      return
    }
    split(name, parts, "/")
    library = name ~ /^bt[A-Z]/ ? "bullet" : parts[1]
    if (library in wrapper && index(" " wrapper[library] " ", " " folder " ") == 0) {
      refuse("only " wrapper[library] " may know this library")
    }
  }

  function unit_of(name) {
    sub(/\.(h|cpp)$/, "", name)
    return name
  }

  function note_arrow(from, to) {
    if (from == to || (from, to) in arrow) return
    arrow[from, to] = FILENAME ":" FNR
    targets[from] = targets[from] " " to
  }

  # Takes away what includes nothing that is left, until nothing more can be: what is left leads into a circle.
  function refuse_circles(    unit, list, n, i, left, again, path) {
    do {
      again = 0
      for (unit in targets) {
        left = ""
        n = split(targets[unit], list, " ")
        for (i = 1; i <= n; ++i) if (list[i] in targets) left = left " " list[i]
        if (left == "") {
          delete targets[unit]
          again = 1
        } else {
          targets[unit] = left
        }
      }
    } while (again)
    for (unit in targets) {
      path = ""
      for (split("", seen); !(unit in seen); unit = list[1]) {
        seen[unit] = 1
        split(targets[unit], list, " ")
        path = path "\n  src/" arrow[unit, list[1]] ": " unit " -> " list[1]
      }
      printf "a circle of includes, or the way into one:%s\n", path
      ++refused
      return
    }
  }

  FNR == 1 {
    folder = FILENAME
    sub(/\/.*/, "", folder)
    if (!(folder in known)) {
      printf "src/%s: in no folder whose includes are known; add it to scripts/check_includes.sh\n", FILENAME
      ++refused
    }
  }

  /^[ \t]*#[ \t]*include[ \t]*["<]/ && folder in known {
    included = $0
    sub(/^[^"<]*/, "", included)
    quoted = included ~ /^"/
    name = substr(included, 2)
    name = substr(name, 1, index(name, quoted ? "\"" : ">") - 1)
    included = substr(included, 1, length(name) + 2)
    if (quoted) check_own(name)
    else check_library(name)
  }

  END {
    refuse_circles()
    if (refused) exit 1
    printf "includes: %d files\n", ARGC - 1
  }
' "${files[@]}"
