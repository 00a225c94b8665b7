"""Label maps: names, colours, and the grid of a volume."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import pyvista
from made_dicom import NORMAL, positions, shared_groups, write_slice
from made_volumes import ORIGIN, SPACING, VOXELS, affine, nrrd_text, real, save, voxels
from pydicom.dataset import Dataset
from pydicom.uid import SegmentationStorage

from vtkmcvr.readers import Segment, VolumeReadError, notes, read, read_labels, segments

LABELS = (np.abs(VOXELS) % 4).astype(np.uint8)
GEOMETRY = {
    "space": "left-posterior-superior",
    "space_directions": "(0.7,0,0) (0,1.1,0) (0,0,2.5)",
    "space_origin": "(1,2,3)",
}


def slicer_file(path: Path, values: np.ndarray, lines: dict[str, str], **fields: str) -> Path:
    pairs = "".join(f"{key}:={value}\n" for key, value in lines.items())
    header = nrrd_text(type="uint8", endian="", **GEOMETRY | fields)[:-1] + pairs.encode()
    path.write_bytes(header + b"\n" + values.tobytes())
    return path


def test_segments_of_slicer(tmp_path: Path) -> None:
    lines = {
        "Segment0_ID": "s1", "Segment0_LabelValue": "2", "Segment0_Name": "liver",
        "Segment0_Color": "0.8 0.4 0.2", "Segment0_Layer": "0",
        "Segment1_ID": "s2", "Segment1_LabelValue": "3", "Segment1_Name": "spleen",
        "Segment1_Color": "0 1 0.5", "Segment1_Layer": "0",
    }  # fmt: skip
    image = read_labels(slicer_file(tmp_path / "a.seg.nrrd", LABELS, lines))
    found = {segment.value: segment for segment in segments(image)}
    assert found[2] == Segment(2, "liver", (0.8, 0.4, 0.2))
    assert found[3] == Segment(3, "spleen", (0.0, 1.0, 0.5))
    # A label without a segment gets its number as name.
    assert found[1].name == "1"
    np.testing.assert_array_equal(voxels(image), LABELS)
    assert voxels(image).dtype == np.uint8


def test_layers_of_slicer_become_one_map(tmp_path: Path) -> None:
    layers = np.zeros((5, 6, 7, 2), np.uint8)
    layers[1:4, ..., 0] = 1
    layers[2:5, ..., 1] = 1
    lines = {
        "Segment0_LabelValue": "1", "Segment0_Name": "body", "Segment0_Layer": "0",
        "Segment1_LabelValue": "1", "Segment1_Name": "heart", "Segment1_Layer": "1",
    }  # fmt: skip
    path = slicer_file(
        tmp_path / "a.seg.nrrd", layers, lines, dimension="4", sizes="2 7 6 5",
        kinds="list domain domain domain",
        space_directions="none (0.7,0,0) (0,1.1,0) (0,0,2.5)",
    )  # fmt: skip
    image = read_labels(path)
    assert [segment.name for segment in segments(image)] == ["body", "heart"]
    expected = np.zeros((5, 6, 7), np.uint8)
    expected[1:4], expected[2:5] = 1, 2
    np.testing.assert_array_equal(voxels(image), expected)
    assert "segments overlap in 84 voxels, which belong to the later one" in notes(image)


TABLES = {
    "a.ctbl": "# Color table\n1 left_lung 255 128 0 255\n2 right lung 0 255 0 255\n",
    "a.txt": "1 left_lung 2001\n2 right_lung 2002\n",
    "a.label": '0 0 0 0 0 0 0 "Clear"\n1 255 128 0 1 1 1 "left_lung"\n2 0 255 0 1 1 1 "right"\n',
    "a.tsv": "index\tname\tcolor\n1\tleft_lung\t#ff8000\n2\tright\t#00ff00\n",
    "a.json": json.dumps({"labels": {"background": 0, "left_lung": 1, "right": 2}}),
    "b.json": json.dumps({"1": "left_lung", "2": "right"}),
    "c.json": json.dumps(
        [{"value": 1, "name": "left_lung", "color": [255, 128, 0]}, {"id": 2, "name": "right"}]
    ),
}


@pytest.mark.parametrize("name", TABLES)
def test_tables_of_labels(tmp_path: Path, name: str) -> None:
    path = save(tmp_path / "labels.nii.gz", LABELS)
    table = tmp_path / name
    table.write_text(TABLES[name])
    beside = {segment.value: segment for segment in segments(read_labels(path, table=table))}
    assert beside[1].name == "left_lung"
    assert beside[2].name.startswith("right")
    if "255" in TABLES[name] or "ff8000" in TABLES[name]:
        np.testing.assert_allclose(beside[1].colour, (1, 128 / 255, 0))
    # Of the same name beside the file, it is found without being given.
    table.rename(tmp_path / f"labels{table.suffix}")
    assert segments(read_labels(path))[0].name == "left_lung"


def test_bad_tables_and_values(tmp_path: Path) -> None:
    path = save(tmp_path / "a.nrrd", LABELS)
    table = tmp_path / "x.json"
    for text in ("{", "[]", "[" * 10_000, '{"labels": 3}'):
        table.write_text(text)
        with pytest.raises(VolumeReadError, match=r"table of labels|names no label"):
            read_labels(path, table=table)
    for values in (VOXELS, LABELS * 0.5, LABELS.astype(np.int32) * 70_000):
        with pytest.raises(VolumeReadError, match="labels are whole numbers from 0 to 65535"):
            read_labels(save(tmp_path / "b.nrrd", values))
    colours = save(tmp_path / "c.nrrd", np.stack([LABELS] * 3, -1), vector=True)
    with pytest.raises(VolumeReadError, match="3 components are no labels"):
        read_labels(colours)


def test_labels_lie_at_their_place_on_another_grid(tmp_path: Path) -> None:
    path = save(tmp_path / "a.nrrd", LABELS)
    source = read(path)
    like = pyvista.ImageData(dimensions=(9, 8, 11), spacing=(0.5, 1.7, 1.0), origin=ORIGIN)
    image = read_labels(path, like=like)
    assert image.dimensions == like.dimensions
    np.testing.assert_allclose(affine(image), affine(like))
    index = np.stack(np.indices(like.dimensions), -1).reshape(-1, 3)
    world = index * like.spacing + like.origin
    inside = (world - source.origin) @ np.linalg.inv(affine(source)[:3, :3]).T
    near = np.rint(inside).astype(int)
    # A point halfway between two voxels may go either way.
    clear = np.abs(np.abs(inside - near) - 0.5).min(axis=1) > 1e-3
    known = np.all((near >= 0) & (near < source.dimensions), axis=1)
    expected = np.zeros(len(index), int)
    i, j, k = near[known].T
    expected[known] = LABELS[k, j, i]
    found = voxels(image).transpose(2, 1, 0).ravel()
    np.testing.assert_array_equal(found[clear], expected[clear])
    assert known.any()
    assert found.any()


def test_labels_on_the_same_grid_are_untouched() -> None:
    image = read(real("nifti/example_ct.nii.gz"))
    labels = read_labels(real("nifti/example_ct_labels.nii.gz"), like=image)
    np.testing.assert_array_equal(
        voxels(labels), voxels(read(real("nifti/example_ct_labels.nii.gz")))
    )
    names = {segment.value: segment.name for segment in segments(labels)}
    assert len(names) == 117
    assert (names[1], names[5]) == ("spleen", "liver")
    # Each liver voxel holds soft tissue.
    liver = voxels(image)[voxels(labels) == 5]
    assert 40 < np.median(liver) < 180


def test_table_beside_a_real_atlas() -> None:
    names = {s.value: s.name for s in segments(read_labels(real("nifti/aal.nii.gz")))}
    assert len(names) == 116
    assert names[1] == "Precentral_L"


# DICOM SEG


def segmentation(path: Path, places: list[tuple[int, int]], masks: np.ndarray) -> Path:
    """Write a SEG of bits whose frame n is segment places[n][0] at slice places[n][1]."""
    frames = []
    for segment, place in places:
        frame, position, identity = Dataset(), Dataset(), Dataset()
        position.ImagePositionPatient = positions(10)[place]
        identity.ReferencedSegmentNumber = segment
        frame.PlanePositionSequence = [position]
        frame.SegmentIdentificationSequence = [identity]
        frames.append(frame)
    shared = shared_groups()
    shared.PixelMeasuresSequence[0].SpacingBetweenSlices = 2.5
    described = []
    for number in sorted({segment for segment, _ in places}):
        item = Dataset()
        item.SegmentNumber, item.SegmentLabel = number, f"organ {number}"
        item.RecommendedDisplayCIELabValue = [65535, 32896, 32896]
        described.append(item)
    elsewhere = ("PixelSpacing", "ImageOrientationPatient", "RescaleSlope", "RescaleIntercept")
    packed = np.packbits(masks.ravel(), bitorder="little")
    attributes = dict.fromkeys(elsewhere) | {
        "SOPClassUID": SegmentationStorage, "Modality": "SEG", "NumberOfFrames": len(places),
        "SegmentSequence": described, "SharedFunctionalGroupsSequence": [shared],
        "PerFrameFunctionalGroupsSequence": frames, "BitsAllocated": 1, "BitsStored": 1,
        "HighBit": 0, "Rows": 6, "Columns": 7, "PixelRepresentation": 0,
    }  # fmt: skip
    data = np.append(packed, np.zeros(len(packed) % 2, np.uint8))[None]
    write_slice(path, data, None, **attributes)
    return path


def test_sparse_frames_are_put_at_their_place(tmp_path: Path) -> None:
    masks = np.random.default_rng(4).integers(0, 2, (4, 6, 7)).astype(np.uint8)
    path = segmentation(tmp_path / "a.dcm", [(1, 6), (1, 3), (2, 3), (2, 4)], masks)
    image = read(path)
    expected = np.zeros((4, 6, 7), np.uint8)
    expected[3][masks[0] > 0] = 1
    expected[0][masks[1] > 0] = 1
    expected[0][masks[2] > 0] = 2
    expected[1][masks[3] > 0] = 2
    np.testing.assert_array_equal(voxels(image), expected)
    np.testing.assert_allclose(image.spacing, SPACING)
    np.testing.assert_allclose(image.origin, positions(10)[3])
    np.testing.assert_allclose(np.asarray(image.direction_matrix)[:, 2], NORMAL, atol=1e-6)
    first, second = segments(image)
    assert (first.name, second.name) == ("organ 1", "organ 2")
    # L* 100 with a* and b* near 0 is white.
    np.testing.assert_allclose(first.colour, (1, 1, 1), atol=0.01)
    assert any("segments overlap" in note for note in notes(image))


def test_a_lone_frame_is_a_volume(tmp_path: Path) -> None:
    mask = np.ones((1, 6, 7), np.uint8)
    image = read(segmentation(tmp_path / "a.dcm", [(1, 3)], mask))
    assert voxels(image).sum(axis=(1, 2)).tolist() == [0, 42, 0]
    np.testing.assert_allclose(affine(image)[:3] @ [0, 0, 1, 1], positions(10)[3], atol=1e-6)


def test_segmentation_on_the_grid_of_its_images() -> None:
    image = read(real("dicom/pt_headneck"))
    labels = read_labels(real("dicom/seg_headneck"), like=image)
    assert labels.dimensions == image.dimensions
    own = read(real("dicom/seg_headneck"))
    for value in (1, 2):
        assert np.count_nonzero(voxels(labels) == value) == np.count_nonzero(voxels(own) == value)
    # The tumour takes up more than its surroundings.
    tumour = voxels(image)[voxels(labels) == 1]
    assert np.median(tumour) > 4 * np.median(voxels(image)[voxels(image) > 0])
    assert [segment.name for segment in segments(labels)] == [
        "Neoplasm, Primary",
        "Neoplasm, Secondary",
    ]
