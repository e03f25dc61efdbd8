"""The validation book: scenes whose answer is known in closed form, one module of rows per group. Run
tools/validate.py."""
