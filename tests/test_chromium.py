"""What the tests' browser leaves behind."""

import tempfile
from pathlib import Path

from chromium import open_chromium


def test_nothing_is_left_of_a_browser(monkeypatch):
    with tempfile.TemporaryDirectory(prefix="rtron-") as folder:  # a short path, for its socket
        monkeypatch.setenv("TMPDIR", folder)
        monkeypatch.setattr(tempfile, "tempdir", None)
        with open_chromium() as browser:
            browser.get("about:blank")
            assert list(Path(folder).iterdir())
        assert list(Path(folder).iterdir()) == []
