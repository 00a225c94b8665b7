"""A disk that is full, and a deflated bomb: an error in one sentence, nothing half-written."""

import os
import subprocess
import sys
import time
import zlib
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
# No file may grow beyond 2 kB: the same error path as of a full disk, which needs no mount
FULL = """
import resource, signal, sys
from pathlib import Path
sys.path[:0] = [sys.argv[1]]
from scenes import blob, render, scene
picture = render(scene(blob(), size=(64, 64)), 1)
picture.rgba
target = Path(sys.argv[2])
target.write_bytes(b"the picture that was there")
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))
try:
    picture.save(target)
except OSError as error:
    print("OSError", str(error).splitlines()[0])
"""


@pytest.mark.parametrize("suffix", [".png", ".npz", ".vti", ".exr"])
def test_a_full_disk_leaves_the_picture_that_was_there(tmp_path, suffix):
    target = tmp_path / f"a{suffix}"
    done = subprocess.run(
        [sys.executable, "-c", FULL, str(REPOSITORY / "tests"), str(target)], cwd=REPOSITORY,
        capture_output=True, text=True, timeout=300, env=dict(os.environ),
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"OSError cannot write {target}"), done.stdout + done.stderr
    assert target.read_bytes() == b"the picture that was there"
    assert [path.name for path in tmp_path.iterdir()] == [target.name]


def deflated(path, size):
    """A DICOM file whose data set is deflated zeros after a whole header."""
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.uid import CTImageStorage, DeflatedExplicitVRLittleEndian

    dataset = Dataset()
    dataset.file_meta = FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = DeflatedExplicitVRLittleEndian
    dataset.file_meta.MediaStorageSOPClassUID = CTImageStorage
    dataset.file_meta.MediaStorageSOPInstanceUID = "1.2.3"
    dataset.SOPClassUID, dataset.SOPInstanceUID = CTImageStorage, "1.2.3"
    dataset.Rows = dataset.Columns = 4
    dataset.save_as(path, enforce_file_format=True)
    whole = path.read_bytes()
    start = 144 + int.from_bytes(whole[140:144], "little")
    inner = zlib.decompress(whole[start:], -zlib.MAX_WBITS)
    pack = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    data = whole[:start] + pack.compress(inner)
    chunk = bytes(1 << 20)
    for _ in range(size >> 20):
        data += pack.compress(chunk)
    path.write_bytes(data + pack.flush())


def test_a_deflated_bomb_is_refused_before_it_is_unpacked(tmp_path, monkeypatch):
    import resource

    from vtkmcvr.readers import VolumeReadError, read

    path = tmp_path / "a.dcm"
    deflated(path, 256 << 20)
    assert path.stat().st_size < 2 << 20
    monkeypatch.setattr("vtkmcvr.reading.dicom_deflated.free_memory", lambda: 40 << 20)
    before, start = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.monotonic()
    with pytest.raises(VolumeReadError, match=r"unpacks to more than .* free memory") as caught:
        read(path)
    assert str(caught.value).startswith(str(path))
    assert time.monotonic() - start < 30
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000
