"""The kinds of light: one class each, in the module of its name, and one row each in the table (lights.table)."""
