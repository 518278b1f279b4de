"""The notebook of the examples runs as it is given away: without outputs."""

import subprocess
import sys

import nbformat
from support import ROOT

NOTEBOOK = ROOT / "examples" / "identify.ipynb"


def test_the_notebook_runs(tmp_path):
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbformat.validate(notebook)
    code_cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in code_cells)
    done = tmp_path / "done.ipynb"
    # In a process of its own: what Jupyter warns of is not about fric.
    code = f"""
import nbclient, nbformat
notebook = nbformat.read({str(NOTEBOOK)!r}, as_version=4)
nbclient.NotebookClient(notebook, timeout=120, resources={{"metadata": {{"path": {str(NOTEBOOK.parent)!r}}}}}).execute()
nbformat.write(notebook, {str(done)!r})
"""
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    outputs = [output for cell in nbformat.read(done, as_version=4).cells for output in cell.get("outputs", [])]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 3
    assert any("friction identified from the cable forces" in output.get("text", "") for output in outputs)
    assert not any(output.get("name") == "stderr" for output in outputs)
