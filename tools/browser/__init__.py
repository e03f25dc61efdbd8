"""A headless Chromium for the report's tests: `python tools/browser.py`."""
