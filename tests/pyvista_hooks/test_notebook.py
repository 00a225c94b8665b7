"""The example notebook runs, and shows pictures."""

import base64
import io
import sys
from pathlib import Path

import numpy as np
import pytest

NOTEBOOK = Path(__file__).parents[2] / "examples" / "live" / "pyvista_notebook.ipynb"


def pictures(notebook):
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    data = [output.get("data", {}) for output in outputs]
    return [base64.b64decode(d["image/png"]) for d in data if "image/png" in d]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_the_notebook_shows_pictures(tmp_path):
    for module in ("nbclient", "nbformat", "ipykernel", "trame_pyvista"):
        pytest.importorskip(module, reason="the notebook needs vtkmcvr[viewer,test]")
    import nbformat
    from nbclient import NotebookClient
    from PIL import Image

    notebook = nbformat.read(NOTEBOOK, as_version=4)
    kernel = tmp_path / "kernels" / "here"
    kernel.mkdir(parents=True)
    (kernel / "kernel.json").write_text(
        f'{{"argv": ["{sys.executable}", "-m", "ipykernel_launcher", "-f", "{{connection_file}}"],'
        ' "display_name": "here", "language": "python"}'
    )
    client = NotebookClient(notebook, timeout=400, kernel_name="here", resources={})
    client.create_kernel_manager().kernel_spec_manager.kernel_dirs.insert(
        0, str(tmp_path / "kernels")
    )
    client.execute()
    shown = [np.array(Image.open(io.BytesIO(p)).convert("RGB"), float) for p in pictures(notebook)]
    assert len(shown) >= 2
    assert all(image.std() > 10 for image in shown)
    assert "16 samples" in str(notebook.cells[-1].outputs)
    assert (tmp_path / "kernels").exists()
