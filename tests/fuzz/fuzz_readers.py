"""Feed damaged files to the readers until time is up; keep those that break the promise.

    python tests/fuzz/fuzz_readers.py [SECONDS] [SEED] [FOLDER]

The promise: a file is read, or refused with VolumeReadError, within ten seconds and without more
memory than a few times the volume. Whatever does something else is kept in FOLDER. Each file is
read in a worker process, so that a crash of a decoder is seen and does not end the run.
"""

from __future__ import annotations

import multiprocessing
import random
import resource
import shutil
import struct
import sys
import tempfile
import time
import traceback
import zipfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "reading"))

LIMIT_SECONDS = 10.0
LIMIT_MEMORY = 6 << 30
WORDS = [b"0", b"-1", b"1e308", b"nan", b"inf", b"99999999999", b"65535", b"", b"%d", b"../x", b"("]
NUMBERS = [0, 1, 127, 255, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFF]


def seeds(folder: Path) -> list[Path]:
    """Write one small whole file of each kind."""
    import numpy as np
    import pyvista
    import SimpleITK
    from made_dicom import positions, write_multiframe, write_series
    from made_volumes import VOXELS, nrrd_text, save
    from test_other_formats import slc

    for name in ("a.nrrd", "a.nii", "a.nii.gz", "a.mha"):
        save(folder / name)
    save(folder / "packed.nrrd", gz=True)
    save(folder / "packed.mha", gz=True)
    place = {"space": "LPS", "space_directions": "(1,0,0) (0,1,0) (0,0,1)"}
    text = " ".join(map(str, VOXELS.ravel())).encode()
    (folder / "text.nrrd").write_bytes(nrrd_text(encoding="ascii", **place) + text)
    image = pyvista.wrap(np.abs(VOXELS))
    image.save(folder / "a.vti")
    image.save(folder / "a.vtk")
    np.save(folder / "a.npy", VOXELS)
    np.savez_compressed(folder / "a.npz", VOXELS)
    (folder / "a.slc").write_bytes(slc(True, np.abs(VOXELS).astype(np.uint8)))
    stack = SimpleITK.GetImageFromArray(np.abs(VOXELS).astype(np.uint16))
    SimpleITK.WriteImage(stack, str(folder / "a.tif"))
    write_multiframe(folder / "frames.dcm", positions(5))
    series = write_series(folder / "series")
    with zipfile.ZipFile(folder / "a.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        for file in series.iterdir():
            archive.write(file, file.name)
    files = [path for path in sorted(folder.iterdir()) if path.is_file()]
    folders = [series, *_packed_series(folder)]
    return [*files, *(file for place in folders for file in sorted(place.iterdir()))]


def _packed_series(folder: Path) -> list[Path]:
    """Write two slices each of the packed images that come with pydicom."""
    import pydicom
    from pydicom.data import get_testdata_file

    places = []
    for name in ("RLE", "jp2klossless", "jpeg_ls_lossless"):
        dataset = pydicom.dcmread(get_testdata_file(f"MR_small_{name}.dcm"))
        place = folder / f"series-{name}"
        place.mkdir()
        for number in (0, 1):
            dataset.SOPInstanceUID = f"1.2.{number + 1}"
            dataset.ImagePositionPatient = [0, 0, number]
            dataset.ImageOrientationPatient = [1, 0, 0, 0, 1, 0]
            dataset.save_as(place / f"{number}.dcm")
        places.append(place)
    return places


def damaged(data: bytes, source: random.Random) -> bytes:
    """Return `data` with one to four changes, more of them near the beginning."""
    changed = bytearray(data)
    for _ in range(source.randint(1, 4)):
        if not changed:
            break
        at = int(len(changed) * source.random() ** source.choice((1, 3)))
        kind = source.randrange(6)
        if kind == 0:
            changed[at] = source.randrange(256)
        elif kind == 1:
            del changed[at : at + source.randint(1, 64)]
        elif kind == 2:
            changed[at:at] = bytes(source.randrange(256) for _ in range(source.randint(1, 16)))
        elif kind == 3:
            width = source.choice("BHI")
            limit = (1 << 8 * struct.calcsize(width)) - 1
            number = struct.pack(source.choice("<>") + width, min(source.choice(NUMBERS), limit))
            changed[at : at + len(number)] = number
        elif kind == 4:
            changed[at : at + source.randint(0, 5)] = source.choice(WORDS)
        else:
            del changed[at:]
    return bytes(changed)


def work(connection: object) -> None:
    """Read the files whose names arrive, and answer with what went wrong."""
    resource.setrlimit(resource.RLIMIT_AS, (LIMIT_MEMORY, LIMIT_MEMORY))
    import warnings

    warnings.simplefilter("ignore")
    from vtkmcvr.readers import VolumeReadError, read_labels, read_vtk

    while path := connection.recv():
        try:
            read_vtk(path)
            if not path.endswith((".vti", ".vtk")):
                read_labels(path)
            answer = ""
        except VolumeReadError as error:
            answer = "" if str(error).startswith(path) else f"names another file: {error}"
        except BaseException:
            answer = traceback.format_exc()
        connection.send(answer)


class Worker:
    """A process that reads files, replaced when it dies or hangs."""

    def __init__(self) -> None:
        self.start()

    def start(self) -> None:
        ours, theirs = multiprocessing.Pipe()
        self.pipe = ours
        self.process = multiprocessing.get_context("spawn").Process(
            target=work, args=(theirs,), daemon=True
        )
        self.process.start()
        theirs.close()

    def read(self, path: Path) -> str:
        """Return what went wrong, empty if nothing did."""
        try:
            self.pipe.send(str(path))
            if self.pipe.poll(LIMIT_SECONDS if self.process.pid else None):
                return self.pipe.recv()
            problem = f"no answer within {LIMIT_SECONDS:g} s"
        except (EOFError, BrokenPipeError, ConnectionResetError):
            self.process.join(1)
            problem = f"the process died with {self.process.exitcode}"
        self.process.kill()
        self.start()
        return problem


def main(seconds: float, seed: int, keep: Path) -> int:
    """Fuzz for so many seconds; return the number of failures."""
    source = random.Random(seed)
    failures: dict[str, int] = {}
    tried = 0
    with tempfile.TemporaryDirectory() as root:
        folder = Path(root)
        (folder / "seeds").mkdir()
        whole = [(path, path.read_bytes()) for path in seeds(folder / "seeds")]
        worker = Worker()
        first = folder / "first.npy"
        first.write_bytes(b"")
        while worker.read(first):
            pass
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            path, data = source.choice(whole)
            place = folder / f"{tried}"
            target = place / path.name
            place.mkdir()
            if path.parent.name.startswith("series"):
                # One damaged slice among whole ones; the folder is read.
                for other in path.parent.iterdir():
                    (place / other.name).write_bytes(other.read_bytes())
            target.write_bytes(damaged(data, source))
            problem = worker.read(place if path.parent.name.startswith("series") else target)
            tried += 1
            if problem:
                key = problem.strip().splitlines()[-1][:120]
                failures[key] = failures.get(key, 0) + 1
                if failures[key] == 1:
                    keep.mkdir(parents=True, exist_ok=True)
                    (keep / f"{seed}-{tried}-{path.name}").write_bytes(target.read_bytes())
                    print(f"{path.name}: {problem}", flush=True)
            shutil.rmtree(place)
        worker.process.kill()
    print(f"{tried} files in {seconds:g} s, seed {seed}: {sum(failures.values())} failures")
    for key, count in failures.items():
        print(f"{count:6} x {key}")
    return len(failures)


if __name__ == "__main__":
    given = sys.argv[1:]
    sys.exit(
        min(
            main(
                float(given[0]) if given else 600.0,
                int(given[1]) if len(given) > 1 else 1,
                Path(given[2] if len(given) > 2 else "fuzz-failures"),
            ),
            1,
        )
    )
