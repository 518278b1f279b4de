"""The notebooks of the examples run as they are given away: without outputs."""

import subprocess
import sys

import nbformat
import pytest
from support import HANG_S, ROOT


@pytest.mark.parametrize(
    ("name", "figures", "told"),
    [
        ("identify", 3, "friction identified from the cable forces"),
        ("discover", 2, "The model lacks stribeck; with it, what is left is noise."),
    ],
)
def test_a_notebook_runs(tmp_path, name, figures, told):
    path = ROOT / "examples" / f"{name}.ipynb"
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    code_cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in code_cells)
    done = tmp_path / "done.ipynb"
    # In a process of its own: what Jupyter warns of is not about fric.
    code = f"""
import nbclient, nbformat
notebook = nbformat.read({str(path)!r}, as_version=4)
nbclient.NotebookClient(notebook, timeout={HANG_S}, resources={{"metadata": {{"path": {str(path.parent)!r}}}}}).execute()
nbformat.write(notebook, {str(done)!r})
"""
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    outputs = [output for cell in nbformat.read(done, as_version=4).cells for output in cell.get("outputs", [])]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == figures
    assert any(told in output.get("text", "") for output in outputs)
    assert not any(output.get("name") == "stderr" for output in outputs)
