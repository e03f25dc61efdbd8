"""Lets the tests import the tools: pytest tools/tests"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))


def pytest_collection_modifyitems(items):
    """Starts the validation book first: it takes longest, and tests that run in parallel then end together."""
    items.sort(key=lambda item: item.path.name != "test_validate.py")
