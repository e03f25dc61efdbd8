"""The validation book: scenes with a known closed-form answer, one module of rows per group (tools/validate.py)."""
