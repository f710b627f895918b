"""Writes what urdfdom and libsdformat read from files, for the ignored test `foreign`.

    apt-get install g++ pkg-config liburdfdom-dev libsdformat-dev
    python values.py FOLDER_OR_FILE... > values.txt
    FOREIGN_VALUES=values.txt cargo test -p lin-canny-robot --test foreign -- --ignored --nocapture

A library that is not installed is skipped by its name. MODELS is a folder of models that worlds include.
A file that ends the library's process has an error.
"""

import pathlib
import subprocess
import sys
import tempfile

LIBRARIES = {
    "urdfdom": (["urdfdom"], (".urdf",)),
    "sdformat": (["sdformat14", "sdformat13", "sdformat12"], (".sdf", ".world")),
}


def build(name, packages, folder):
    """Returns the program of a library and its version; None without the library."""
    for package in packages:
        try:
            flags = subprocess.run(["pkg-config", "--cflags", "--libs", package], capture_output=True, text=True)
        except FileNotFoundError:
            return None
        if flags.returncode == 0:
            version = subprocess.run(["pkg-config", "--modversion", package], capture_output=True, text=True).stdout
            program, source = f"{folder}/{name}", pathlib.Path(__file__).with_name(f"{name}.cc")
            subprocess.run(["c++", "-std=c++17", source, "-o", program, *flags.stdout.split()], check=True)
            return program, f"{package} {version.strip()}"
    return None


def main():
    with tempfile.TemporaryDirectory() as folder:
        for name, (packages, endings) in LIBRARIES.items():
            built = build(name, packages, folder)
            if built is None:
                print(f"skipped {name}: not installed")
                continue
            program, version = built
            print(f"library {version}")
            for argument in map(pathlib.Path, sys.argv[1:]):
                files = sorted(argument.rglob("*")) if argument.is_dir() else [argument]
                for file in (file for file in files if file.suffix in endings and file.is_file()):
                    done = subprocess.run([program, file], capture_output=True, text=True, errors="replace")
                    text = done.stdout if done.returncode == 0 else f"file {file}\nerror\n"
                    print(text, end="", flush=True)


main()
