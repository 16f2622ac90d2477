"""Pages as a browser shows them."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def browsed(page: Path, options: str, size: str) -> str:
    """The document of a page after its scripts have run in a window of a size, such as 1400,1000."""
    assert CHROMIUM is not None
    command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={page.parent / 'profile'}"]
    command += ["--virtual-time-budget=1000", f"--window-size={size}", "--dump-dom", f"file://{page}#{options}"]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout
